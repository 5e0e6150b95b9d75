//! A diagnosis on the terminal: the verdict first, then the evidence.

use comfy_table::{CellAlignment, Table};
use tribo_diagnose::report::number::{
    fixed, percent, percent_with_interval, probability, quantity_and_unit, significant, with_interval,
};
use tribo_diagnose::report::{Extras, cause_at, finding_sentence, verdict_sentence};
use tribo_diagnose::{Diagnosis, Finding, JointMisfit};
use tribo_regression::Location;
use tribo_robot::JointNames;
use tribo_trial::ClosedLoopGain;

use crate::output::{print, table};

/// Width of running text (columns).
const WIDTH: usize = 110;
/// Parts of the variance below this are not worth a word [-].
const NOTABLE_PART: f64 = 0.05;

/// Prints the answer alone.
pub(super) fn verdict(diagnosis: &Diagnosis) {
    paragraph("", &verdict_sentence(diagnosis));
}

/// Prints everything; `verbose` adds what was considered and rejected, and the assumptions.
pub(super) fn show(diagnosis: &Diagnosis, gain: Option<&ClosedLoopGain>, extras: &Extras, verbose: bool) {
    paragraph("", &verdict_sentence(diagnosis));
    if !diagnosis.findings.is_empty() {
        show_findings(diagnosis);
    }
    show_joints(diagnosis);
    show_unseen(diagnosis);
    show_elsewhere(diagnosis, gain, extras);
    show_next(diagnosis);
    if verbose && !diagnosis.rejected.is_empty() {
        show_rejected(diagnosis);
    }
    show_list("Notes", &diagnosis.notes);
    if verbose || diagnosis.findings.is_empty() {
        show_list("Assumptions", &diagnosis.assumptions);
    }
    if !(extras.written.is_empty() && extras.remarks.is_empty()) {
        print("");
    }
    for (_, path) in &extras.written {
        print(format_args!("written {path}"));
    }
    for remark in &extras.remarks {
        print(remark);
    }
}

fn show_findings(diagnosis: &Diagnosis) {
    let (findings, names) = (&diagnosis.findings, &diagnosis.joint_names);
    if findings.len() > 1 || !findings[0].alternatives.is_empty() {
        print("");
        for finding in findings {
            paragraph("- ", &format!("{}.", finding_sentence(finding, names)));
        }
    }
    let mut rows = table(&["cause", "where", "parameter", "value [95 %]", "p", "gain on unseen [95 %]", "rivals"]);
    align(&mut rows, CellAlignment::Left, &[1, 2, 3, 6]);
    for finding in findings {
        let gain = percent_with_interval(finding.held_out_gain, finding.held_out_gain_ci95);
        let rivals: Vec<String> =
            finding.alternatives.iter().map(|rival| cause_at(rival.label, rival.location, names)).collect();
        let mut first = Some((gain, rivals.join(", ")));
        for (name, value) in parameter_rows(finding, names) {
            let (gain, rivals) = first.take().unwrap_or_default();
            let begins = !gain.is_empty();
            let once = |text: String| if begins { text } else { String::new() };
            add(
                &mut rows,
                [
                    once(finding.label.to_string()),
                    once(place(finding, names)),
                    name,
                    value,
                    once(probability(finding.p_value)),
                    gain,
                    rivals,
                ],
            );
        }
    }
    print(format_args!("\n{rows}"));
    for finding in findings {
        for rival in &finding.alternatives {
            let what = cause_at(finding.label, finding.location, names);
            let other = cause_at(rival.label, rival.location, names);
            let gap = fixed(rival.evidence_gap, 1);
            paragraph("", &format!("{what} could also be {other}, {gap} behind in evidence: {}", rival.why));
        }
    }
}

/// Where a finding is.
fn place(finding: &Finding, names: &JointNames) -> String {
    match (finding.joints.len(), finding.links.len()) {
        (0 | 1, 0 | 1) => finding.location.among(names),
        (count, 0) => format!("{count} joints"),
        (_, count) => format!("{count} links"),
    }
}

/// One row per component; a finding without parameters has one row all the same.
fn parameter_rows(finding: &Finding, names: &JointNames) -> Vec<(String, String)> {
    let mut rows = Vec::new();
    for parameter in &finding.said() {
        let unit = quantity_and_unit(parameter.name).1;
        for (k, value) in parameter.value.iter().enumerate() {
            let places = finding.places();
            let index = match parameter.value.len() {
                0 | 1 => String::new(),
                count if count == places.len() => format!(" of {}", places[k].among(names)),
                _ => format!("[{k}]"),
            };
            let ci95 = parameter.ci95.get(k).copied().unwrap_or([f64::NAN; 2]);
            rows.push((format!("{}{index}", parameter.name), with_interval(*value, ci95, unit)));
        }
    }
    if rows.is_empty() {
        rows.push(("signature".to_owned(), finding.signature.clone().unwrap_or_default()));
    }
    rows
}

fn show_joints(diagnosis: &Diagnosis) {
    print(format_args!(
        "\nResidual: measured less model [Nm RMS], {} samples at {} Hz in {} {}, band {} Hz",
        diagnosis.samples,
        significant(diagnosis.rate_hz, 3),
        diagnosis.bursts,
        if diagnosis.bursts == 1 { "burst" } else { "bursts" },
        significant(diagnosis.band_hz, 3)
    ));
    let header = ["joint", "before", "after", "unseen: before", "after", "noise", "bias", "unexplained", "goes with"];
    let mut rows = table(&header);
    align(&mut rows, CellAlignment::Left, &[8]);
    for (j, joint) in diagnosis.joints.iter().enumerate() {
        let [unseen_before, unseen_after] = joint.held_out_nm;
        let torques =
            [joint.rms_nm, joint.rms_after_nm, unseen_before, unseen_after, joint.noise_floor_nm, joint.bias_nm];
        let mut row = vec![diagnosis.joint_names.of(j).to_string()];
        row.extend(torques.map(|value| significant(value, 3)));
        row.extend([percent(joint.unexplained), goes_with(joint)]);
        add(&mut rows, row);
    }
    print(rows);
}

/// The two quantities that most of the residual goes with.
fn goes_with(joint: &JointMisfit) -> String {
    let mut parts: Vec<_> = joint.goes_with.iter().filter(|(_, part)| *part >= NOTABLE_PART).collect();
    parts.sort_by(|a, b| b.1.total_cmp(&a.1));
    let parts: Vec<String> = parts.iter().take(2).map(|(name, part)| format!("{name} {}", percent(*part))).collect();
    if parts.is_empty() { "nothing".to_owned() } else { parts.join(", ") }
}

/// What the extended model and plain fits predict where they have not looked.
fn show_unseen(diagnosis: &Diagnosis) {
    let Some(unseen) = &diagnosis.unseen else { return };
    print(format_args!("\nUnseen, {} held out [Nm RMS]", unseen.split));
    let mut rows = table(&["joint", "model given", "extended model", "plain least squares", "full refit"]);
    for j in 0..unseen.extended_nm.len() {
        let values = [unseen.nominal_nm[j], unseen.extended_nm[j], unseen.plain_nm[j], unseen.full_nm[j]];
        add(
            &mut rows,
            std::iter::once(diagnosis.joint_names.of(j).to_string()).chain(values.map(|value| significant(value, 3))),
        );
    }
    print(rows);
    let (name, _) = unseen.better_baseline();
    let ratio = unseen.ratio();
    let better = if unseen.baseline_is_better() { " The baseline is better." } else { "" };
    paragraph(
        "",
        &format!(
            "On unseen data the extended model leaves {} of what {name} leaves (mean of joints).{better}",
            fixed(ratio, 2)
        ),
    );
}

/// What the extended model is worth on other logs and in the loop.
fn show_elsewhere(diagnosis: &Diagnosis, gain: Option<&ClosedLoopGain>, extras: &Extras) {
    for validation in &diagnosis.validation {
        let gain = percent_with_interval(validation.gain, validation.gain_ci95);
        paragraph("", &format!("\non {}: the findings remove {gain} of the residual", validation.log));
    }
    if let Some(gain) = gain {
        let mut rows = table(&["closed loop", "cost J [N + Nm]", "tracking [mm RMS]", "[mrad RMS]", "state"]);
        let state = |aborted: Option<tribo_trial::AbortReason>| {
            aborted.map_or("complete".to_owned(), |reason| format!("failed: {reason}"))
        };
        let lines = [
            (
                "old model",
                gain.cost_before,
                gain.tracking_rms_mm_before,
                gain.tracking_rms_mrad_before,
                gain.aborted_before,
            ),
            (
                "extended model",
                gain.cost_after,
                gain.tracking_rms_mm_after,
                gain.tracking_rms_mrad_after,
                gain.aborted_after,
            ),
        ];
        for (name, cost, mm, mrad, aborted) in lines {
            let numbers = [significant(cost, 4), significant(mm, 3), significant(mrad, 3)];
            add(&mut rows, [vec![name.to_owned()], numbers.to_vec(), vec![state(aborted)]].concat());
        }
        print(format_args!("\n{rows}"));
    }
    if !extras.not_cancelled.is_empty() {
        show_list("What the compensator cannot cancel", &extras.not_cancelled);
    }
}

fn show_next(diagnosis: &Diagnosis) {
    let Some(next) = &diagnosis.next_experiment else { return };
    let [a, b] = next.separates.map(|(label, location)| cause_at(label, location, &diagnosis.joint_names));
    print("");
    let mut text = format!("Next experiment: {} ({}) It separates {a} from {b}", next.instruction, next.motion);
    if next.via_points.is_empty() {
        text += ".";
    } else {
        let (expected, of_this_log) = (next.expected_evidence, next.evidence_of_this_log);
        text += &format!(
            ": expected evidence {}, against {} from a repetition of this log. --trajectory writes its via points.",
            significant(expected, 3),
            significant(of_this_log, 3)
        );
    }
    paragraph("", &text);
}

fn show_rejected(diagnosis: &Diagnosis) {
    let mut rows = table(&["rejected", "where", "evidence", "why"]);
    align(&mut rows, CellAlignment::Left, &[1, 3]);
    for rejected in &diagnosis.rejected {
        let place = match rejected.location {
            Location::Arm => "arm".to_owned(),
            place => place.among(&diagnosis.joint_names),
        };
        let evidence = rejected.evidence.map_or("-".to_owned(), |evidence| significant(evidence, 3));
        add(&mut rows, [rejected.label.to_string(), place, evidence, rejected.reason.clone()]);
    }
    print(format_args!("\n{rows}"));
}

fn show_list(heading: &str, items: &[String]) {
    if !items.is_empty() {
        print(format_args!("\n{heading}:"));
        items.iter().for_each(|item| paragraph("- ", item));
    }
}

/// Text wrapped at [`WIDTH`], continued under its own beginning.
fn paragraph(bullet: &str, text: &str) {
    let indent = " ".repeat(bullet.len());
    let mut line = bullet.to_owned();
    let mut width = line.chars().count();
    for word in ascii_minus(text).split(' ') {
        let letters = word.chars().count();
        if width > bullet.len() && width + 1 + letters > WIDTH {
            line += "\n";
            line += &indent;
            width = indent.len();
        } else if width > bullet.len() {
            line += " ";
            width += 1;
        }
        line += word;
        width += letters;
    }
    print(line);
}

/// Numbers as other programs read them.
fn ascii_minus(text: &str) -> String {
    text.replace('−', "-")
}

fn align(rows: &mut Table, alignment: CellAlignment, columns: &[usize]) {
    for column in columns {
        if let Some(column) = rows.column_mut(*column) {
            column.set_cell_alignment(alignment);
        }
    }
}

fn add(rows: &mut Table, cells: impl IntoIterator<Item = String>) {
    rows.add_row(cells.into_iter().map(|cell| ascii_minus(&cell)));
}
