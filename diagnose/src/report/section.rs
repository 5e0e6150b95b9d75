//! The sections of the HTML report, each a pure function of the diagnosis; empty text where there is nothing to say.

use tribo_figure::escape::{escape, escape_sentence};
use tribo_figure::number::{
    fixed, percent, percent_with_interval, probability, quantity_and_unit, significant, with_interval,
};
use tribo_figure::page::{raw_table, section, table};
use tribo_figure::{Figure, page};
use tribo_robot::JointNames;

use super::closed_loop::ClosedLoop;
use super::pictures::{held_out_bars, via_points};
use super::sentence::{cause_at, finding_sentence};
use crate::{Diagnosis, Finding, Plot};

/// What was found, each finding with its parameters, rivals and evidence.
pub fn findings(diagnosis: &Diagnosis) -> String {
    if diagnosis.findings.is_empty() {
        return String::new();
    }
    section(
        "What the model lacks",
        &diagnosis.findings.iter().map(|finding| article(finding, &diagnosis.joint_names)).collect::<String>(),
    )
}

fn article(finding: &Finding, names: &JointNames) -> String {
    let rows = finding.said().into_iter().flat_map(|parameter| {
        let (quantity, unit) = quantity_and_unit(parameter.name);
        let ends = |k: usize| parameter.ci95.get(k).copied().unwrap_or([f64::NAN; 2]);
        // Of several joints or links each has its own value, and a row for it.
        let places = finding.places();
        let named = parameter.value.len() > 1 && parameter.value.len() == places.len();
        let of = |k: usize| if named { format!("{}: ", places[k].among(names)) } else { String::new() };
        let values = parameter.value.iter().enumerate().map(|(k, value)| of(k) + &with_interval(*value, ends(k), ""));
        let values = values.collect::<Vec<_>>();
        let cells = if named { values } else { vec![values.join("; ")] };
        let rows = cells.into_iter().enumerate().map(|(k, value)| {
            let quantity = if k == 0 { quantity.clone() } else { String::new() };
            [quantity, value, unit.to_owned()]
        });
        rows.collect::<Vec<_>>()
    });
    let parameters = table(&["parameter", "value [95 % interval]", "unit"], &[0, 1, 2], rows);
    let parameters = if finding.parameters.is_empty() { String::new() } else { parameters };
    let facts = format!(
        "<p>Explains a torque of {} Nm RMS; probability of so much evidence by chance {}; evidence {} (twice the log \
         likelihood gained, less the price of the parameters).</p>\n",
        significant(finding.explained_rms_nm, 3),
        escape(&probability(finding.p_value)),
        significant(finding.evidence, 3)
    );
    let rivals = finding.alternatives.iter().map(|rival| {
        format!(
            "<li><b>{}</b>, {} behind in evidence: {}</li>\n",
            escape(&cause_at(rival.label, rival.location, names)),
            fixed(rival.evidence_gap, 1),
            escape(&rival.why)
        )
    });
    let rivals = match finding.alternatives.is_empty() {
        true => String::new(),
        false => format!("<h4>What else it could be</h4>\n<ul>\n{}</ul>\n", rivals.collect::<String>()),
    };
    let plots = match finding.plots.is_empty() {
        true => String::new(),
        false => format!("<h4>Why this verdict</h4>\n{}", figures(&finding.plots)),
    };
    let heading = escape_sentence(&finding_sentence(finding, names));
    format!("<article>\n<h3>{heading}</h3>\n{parameters}{facts}{rivals}{plots}</article>\n")
}

/// Before and after, per joint, on the log, on unseen blocks, on other logs and in a closed loop.
pub fn worth(diagnosis: &Diagnosis, closed_loop: Option<ClosedLoop>) -> String {
    let (joints, names) = (&diagnosis.joints, &diagnosis.joint_names);
    let bars = page::figures([&held_out_bars(diagnosis)]);
    let header = [
        "joint",
        "RMS before [Nm]",
        "after [Nm]",
        "unseen, before [Nm]",
        "unseen, after [Nm]",
        "noise [Nm]",
        "bias [Nm]",
        "torque unexplained",
    ];
    let rows = joints.iter().enumerate().map(|(j, joint)| {
        let torque = [joint.rms_nm, joint.rms_after_nm, joint.held_out_nm[0], joint.held_out_nm[1]];
        let rest = [joint.noise_floor_nm, joint.bias_nm].map(|value| significant(value, 3));
        let torque = torque.map(|value| significant(value, 3));
        [vec![names.of(j).to_string()], torque.to_vec(), rest.to_vec(), vec![percent(joint.unexplained)]].concat()
    });
    let mut body = bars + &table(&header, &[0], rows);
    if let Some(unseen) = &diagnosis.unseen {
        let rows = (0..unseen.extended_nm.len()).map(|j| {
            let values = [unseen.nominal_nm[j], unseen.extended_nm[j], unseen.plain_nm[j], unseen.full_nm[j]];
            [vec![names.of(j).to_string()], values.map(|value| significant(value, 3)).to_vec()].concat()
        });
        let header =
            ["joint", "model given [Nm]", "extended model [Nm]", "plain least squares [Nm]", "full refit [Nm]"];
        let (name, ratio) = (unseen.better_baseline().0, unseen.ratio());
        let better = if unseen.baseline_is_better() { " The baseline is better." } else { "" };
        body += &format!("<h4>Unseen: {} held out, beside plain fits to the same rest</h4>\n", escape(unseen.split));
        body += &table(&header, &[0], rows);
        body += &format!(
            "<p>The extended model leaves {} of what {} leaves (mean of joints).{better}</p>\n",
            fixed(ratio, 2),
            escape(name)
        );
    }
    if !diagnosis.validation.is_empty() {
        let rows = diagnosis.validation.iter().map(|validation| {
            [
                validation.log.clone(),
                numbers(&validation.before_nm),
                numbers(&validation.after_nm),
                percent_with_interval(validation.gain, validation.gain_ci95),
            ]
        });
        body += "<h4>On logs that no parameter was fitted to</h4>\n";
        body += &table(&["log", "RMS per joint, before [Nm]", "after [Nm]", "gain"], &[0], rows);
    }
    if let Some(closed_loop) = closed_loop {
        let rows = ["the old model", "the extended model"].into_iter().enumerate().map(|(k, model)| {
            let (cost, error) = (closed_loop.cost[k], closed_loop.tracking_rms_mm[k]);
            [model.to_owned(), significant(cost, 4), significant(error, 3)]
        });
        body +=
            "<h4>In a closed loop</h4>\n<p class=\"hint\">Simulated on a plant that obeys the extended model.</p>\n";
        body += &table(&["controller believes", "cost J [N + Nm]", "tracking error [mm RMS]"], &[0], rows);
    }
    section("Gain on unseen data", &body)
}

/// The experiment that would separate the closest rivals.
pub fn next_experiment(diagnosis: &Diagnosis) -> String {
    let Some(next) = &diagnosis.next_experiment else { return String::new() };
    let [a, b] = next.separates.map(|(label, location)| escape(&cause_at(label, location, &diagnosis.joint_names)));
    // What to record is known exactly only of a motion of Tribo's own.
    let worth = if next.via_points.is_empty() {
        String::new()
    } else {
        let (expected, of_this_log) = (next.expected_evidence, next.evidence_of_this_log);
        let [expected, of_this_log] = [expected, of_this_log].map(|evidence| significant(evidence, 3));
        format!(": expected evidence {expected}, against {of_this_log} from a repetition of this log")
    };
    let body = format!(
        "<p>{}</p>\n<p>It separates <b>{a}</b> from <b>{b}</b>{worth}.</p>\n{}",
        escape(&next.instruction),
        page::figures(&via_points(next, &diagnosis.joint_names))
    );
    section("Next experiment", &body)
}

/// What the residual goes with before any cause is named.
pub fn pattern(diagnosis: &Diagnosis) -> String {
    let Some(first) = diagnosis.joints.first() else { return String::new() };
    let header: Vec<&str> = std::iter::once("joint").chain(first.goes_with.iter().map(|(name, _)| *name)).collect();
    let rows = diagnosis.joints.iter().enumerate().map(|(j, joint)| {
        let parts = joint.goes_with.iter().map(|(_, part)| part_cell(*part)).collect::<String>();
        format!("<tr><td class=\"t\">{}</td>{parts}</tr>\n", escape(&diagnosis.joint_names.of(j).to_string()))
    });
    let pattern = &diagnosis.pattern;
    let across = [
        ("one constant wrench: a push or a weight at the tool", pattern.wrench),
        ("another direction of gravity: a tilted base", pattern.gravity),
        ("other link inertias: masses", pattern.inertial),
    ];
    let across =
        across.iter().map(|(what, part)| format!("<tr><td class=\"t\">{what}</td>{}</tr>\n", part_cell(*part)));
    let body = format!(
        "<p class=\"hint\">Part of the residual's variance that goes with each quantity alone, before any cause is named; \
         quantities overlap.</p>\n{}<h4>Across the joints</h4>\n<p class=\"hint\">Part of the residual's energy that a \
         rigid-body map can make.</p>\n{}",
        raw_table(&header, &[0], &rows.collect::<String>()),
        raw_table(&["looks like", "part"], &[0], &across.collect::<String>())
    );
    section("What the residual looks like", &body)
}

/// What was considered and is out.
pub fn rejected(diagnosis: &Diagnosis) -> String {
    if diagnosis.rejected.is_empty() {
        return String::new();
    }
    let rows = diagnosis.rejected.iter().map(|rejected| {
        let evidence = rejected.evidence.map_or("not testable".to_owned(), |evidence| significant(evidence, 3));
        format!(
            "<tr><td class=\"t\">{}</td><td>{evidence}</td><td class=\"t w\">{}</td></tr>\n",
            escape(&cause_at(rejected.label, rejected.location, &diagnosis.joint_names)),
            escape(&rejected.reason)
        )
    });
    let count = diagnosis.rejected.len();
    let table = raw_table(&["cause", "evidence", "why it is out"], &[0, 2], &rows.collect::<String>());
    section(
        "Considered and rejected",
        &format!(
            "<p class=\"hint\">Evidence is given the findings; negative: it does not pay for its parameters.</p>\n\
             <details><summary>{count} {}</summary>\n{table}</details>\n",
            if count == 1 { "candidate" } else { "candidates" }
        ),
    )
}

/// Notes and assumptions.
pub fn small_print(diagnosis: &Diagnosis) -> String {
    let list = |heading: &str, items: &[String]| match items.is_empty() {
        true => String::new(),
        false => {
            let items = items.iter().map(|item| format!("<li>{}</li>\n", escape(item)));
            section(heading, &format!("<ul>\n{}</ul>\n", items.collect::<String>()))
        }
    };
    list("Notes", &diagnosis.notes) + &list("What this rests on", &diagnosis.assumptions)
}

/// The residual in pictures.
pub fn overview(diagnosis: &Diagnosis) -> String {
    if diagnosis.overview.is_empty() {
        return String::new();
    }
    section("The residual in pictures", &figures(&diagnosis.overview))
}

fn figures(plots: &[Plot]) -> String {
    let figures: Vec<Figure> = plots.iter().map(Figure::from).collect();
    page::figures(&figures)
}

fn numbers(values: &[f64]) -> String {
    values.iter().map(|value| significant(*value, 2)).collect::<Vec<_>>().join(", ")
}

fn part_cell(part: f64) -> String {
    let width = if part.is_finite() { 100.0 * part.clamp(0.0, 1.0) } else { 0.0 };
    format!("<td class=\"part\" style=\"--p:{width:.0}%\">{}</td>", percent(part))
}
