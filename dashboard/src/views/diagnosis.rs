//! What the model gets wrong about a log, and why it says so.

use std::path::Path;

use egui::{CollapsingHeader, Grid, ProgressBar, RichText, ScrollArea, Ui};
use tribo_diagnose::report::number::{
    fixed, percent_with_interval, probability, quantity_and_unit, significant, with_interval,
};
use tribo_diagnose::report::{cause_at, finding_sentence, held_out_bars, verdict_sentence, via_points};
use tribo_diagnose::{Diagnosis, Finding, Verdict};
use tribo_figure::Figure;
use tribo_robot::JointNames;

use super::memo::{Memo, address};
use crate::diagnosis_snapshot::DiagnosisSnapshot;
use crate::plot::{Look, grid};
use crate::source::Source;
use crate::theme;

/// What the user has chosen.
#[derive(Debug, Default)]
pub struct DiagnosisView {
    evidence: Memo,
    worth: Memo,
    overview: Memo,
    finding: usize,
}

impl DiagnosisView {
    /// The view; reports go to the directory `exports`.
    pub fn ui(&mut self, ui: &mut Ui, source: &mut Source, exports: &Path) {
        if let Some(progress) = source.diagnosing() {
            let (stage, part) = progress.now();
            ui.add_space(60.0);
            let mut cancel = false;
            ui.vertical_centered(|ui| {
                ui.heading("Diagnosing");
                ui.add(ProgressBar::new(part).desired_width(360.0).text(stage));
                cancel = ui.button("Cancel").clicked();
            });
            if cancel {
                source.cancel_diagnosis();
            }
            ui.ctx().request_repaint_after(std::time::Duration::from_millis(100));
            return;
        }
        let Some(snapshot) = source.snapshot().diagnosis.clone() else {
            if source.snapshot().log.is_none() {
                super::empty(ui, "No log is open", "Give a robot log above; then it is held against the model here.");
                return;
            }
            super::empty(
                ui,
                "What does the model get wrong about this log?",
                "Every cause is judged on blocks that it was not fitted to. This takes seconds to minutes.",
            );
            ui.vertical_centered(|ui| {
                ui.add_space(8.0);
                if ui.button("Diagnose this log").clicked() {
                    source.diagnose(ui.ctx());
                }
            });
            return;
        };
        let mut write = false;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| write = self.diagnosis(ui, &snapshot));
        if write {
            source.report_diagnosis(ui.ctx(), exports);
        }
    }

    /// The whole diagnosis; true if a report is to be written.
    fn diagnosis(&mut self, ui: &mut Ui, snapshot: &std::sync::Arc<DiagnosisSnapshot>) -> bool {
        let (diagnosis, dark) = (&snapshot.diagnosis, ui.visuals().dark_mode);
        let colour = match diagnosis.verdict {
            Verdict::NothingMissing | Verdict::Named => theme::good(dark),
            Verdict::Ambiguous | Verdict::Unknown => theme::bad(dark),
        };
        ui.label(RichText::new(diagnosis.verdict.name().replace('_', " ")).strong().color(colour));
        ui.label(RichText::new(verdict_sentence(diagnosis)).heading());
        let bursts =
            if diagnosis.bursts == 1 { "one burst".to_owned() } else { format!("{} bursts", diagnosis.bursts) };
        ui.weak(format!(
            "{}; {} samples in {}, torques up to {} Hz; brackets are 95 % intervals",
            snapshot.log.display(),
            diagnosis.samples,
            bursts,
            significant(diagnosis.band_hz, 3)
        ));
        let hint = "One HTML file, as `tribo diagnose --report` writes it";
        let write = ui.button("Write report").on_hover_text(hint).clicked();
        ui.add_space(8.0);
        self.findings(ui, snapshot);
        ui.add_space(8.0);
        ui.label(RichText::new("Gain on unseen data").heading());
        ui.label(format!(
            "Removes {} of the residual on unseen blocks",
            percent_with_interval(diagnosis.gain_heldout, diagnosis.gain_heldout_ci95)
        ));
        let key = (vec![address(Some(snapshot))], vec![]);
        let look = Look { height: 220.0, ..Look::default() };
        grid(ui, self.worth.get(key.clone(), || vec![held_out_bars(diagnosis)]), look);
        next_experiment(ui, diagnosis);
        let figures = self.overview.get(key, || diagnosis.overview.iter().map(Figure::from).collect());
        CollapsingHeader::new("The residual in pictures").show(ui, |ui| grid(ui, figures, look));
        CollapsingHeader::new(format!("Considered and rejected ({})", diagnosis.rejected.len())).show(ui, |ui| {
            for rejected in &diagnosis.rejected {
                ui.label(format!(
                    "{}: {}",
                    cause_at(rejected.label, rejected.location, &diagnosis.joint_names),
                    rejected.reason
                ));
            }
        });
        CollapsingHeader::new("Notes, and what this rests on").show(ui, |ui| {
            for line in diagnosis.notes.iter().chain(&diagnosis.assumptions) {
                ui.label(format!("• {line}"));
            }
        });
        write
    }

    fn findings(&mut self, ui: &mut Ui, snapshot: &std::sync::Arc<DiagnosisSnapshot>) {
        let diagnosis = &snapshot.diagnosis;
        if diagnosis.findings.is_empty() {
            return;
        }
        ui.label(RichText::new("Findings").heading());
        self.finding = self.finding.min(diagnosis.findings.len() - 1);
        ui.horizontal_wrapped(|ui| {
            for (k, finding) in diagnosis.findings.iter().enumerate() {
                ui.selectable_value(
                    &mut self.finding,
                    k,
                    cause_at(finding.label, finding.location, &diagnosis.joint_names),
                );
            }
        });
        let finding = &diagnosis.findings[self.finding];
        let key = (vec![address(Some(snapshot))], vec![self.finding]);
        let figures = self.evidence.get(key, || finding.plots.iter().map(Figure::from).collect());
        ui.label(RichText::new(finding_sentence(finding, &diagnosis.joint_names)).strong());
        let wide = ui.available_width() > 900.0;
        ui.columns(if wide { 2 } else { 1 }, |cells| {
            facts(&mut cells[0], finding, &diagnosis.joint_names);
            let last = &mut cells[usize::from(wide)];
            last.label(RichText::new("Why this verdict").strong());
            grid(last, figures, Look { height: 240.0, ..Look::default() });
        });
    }
}

fn facts(ui: &mut Ui, finding: &Finding, names: &JointNames) {
    Grid::new("parameters").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
        for parameter in &finding.said() {
            let (quantity, unit) = quantity_and_unit(parameter.name);
            for (k, value) in parameter.value.iter().enumerate() {
                let axis = if parameter.value.len() == 3 { format!(" {}", ["x", "y", "z"][k]) } else { String::new() };
                ui.label(format!("{quantity}{axis}"));
                let ends = parameter.ci95.get(k).copied().unwrap_or([f64::NAN; 2]);
                ui.label(with_interval(*value, ends, unit));
                ui.end_row();
            }
        }
        ui.label("held-out gain");
        ui.label(percent_with_interval(finding.held_out_gain, finding.held_out_gain_ci95));
        ui.end_row();
        ui.label("explains");
        ui.label(format!("{} Nm RMS", significant(finding.explained_rms_nm, 3)));
        ui.end_row();
        ui.label("by chance");
        ui.label(format!("p {}", probability(finding.p_value)));
        ui.end_row();
    });
    if let Some(signature) = &finding.signature {
        ui.label(format!("It goes with: {signature}"));
    }
    if !finding.alternatives.is_empty() {
        ui.label(RichText::new("What else it could be").strong());
        for rival in &finding.alternatives {
            ui.label(format!(
                "{} ({} behind in evidence): {}",
                cause_at(rival.label, rival.location, names),
                fixed(rival.evidence_gap, 1),
                rival.why
            ));
        }
    }
}

fn next_experiment(ui: &mut Ui, diagnosis: &Diagnosis) {
    let Some(next) = &diagnosis.next_experiment else { return };
    ui.label(RichText::new("Next experiment").heading());
    ui.label(&next.instruction);
    let [a, b] = next.separates.map(|(label, location)| cause_at(label, location, &diagnosis.joint_names));
    ui.label(format!(
        "It separates {a} from {b}: expected evidence {}, against {} from a repetition of this log.",
        significant(next.expected_evidence, 3),
        significant(next.evidence_of_this_log, 3)
    ));
    let figures: Vec<Figure> = via_points(next, &diagnosis.joint_names).into_iter().collect();
    grid(ui, &figures, Look { height: 220.0, ..Look::default() });
}
