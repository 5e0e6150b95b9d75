//! A cause is hidden in a log, and the diagnosis is handed that log and the nominal model, nothing else.
//!
//! Seeds from 900000 on belong to these tests: nothing was tuned on them. One command draws other ones:
//! `cargo run --release -p tribo-experiments --example diagnosis_confusion -- --seeds 0..87`.

mod believed;
mod nulls;
mod outside;
mod pairs;
mod singles;

use tribo_diagnose::{DiagnoseSettings, Diagnosis, Verdict, diagnose};
use tribo_experiments::hidden_effects::{HiddenCase, Judgement, Kind, World};

/// A case after diagnosis.
struct Examined {
    case: HiddenCase,
    diagnosis: Diagnosis,
    judgement: Judgement,
}

fn examine(seed: u64, kind: Kind) -> Examined {
    let case = HiddenCase::draw(seed, kind, World::Identified).expect("a case that can be simulated");
    let diagnosis =
        diagnose(&case.logs, &case.nominal, &[], &DiagnoseSettings::default(), &|_, _| true).expect("a diagnosis");
    let judgement = Judgement::of(&case, &diagnosis).expect("a residual");
    Examined { case, diagnosis, judgement }
}

impl Examined {
    /// Everything that a failure should show.
    fn told(&self) -> String {
        let findings = self.diagnosis.findings.iter().map(|f| {
            let rivals: Vec<String> = f.alternatives.iter().map(|a| format!("{}@{}", a.label, a.location)).collect();
            format!("  {}@{} evidence {:.0} {:?} or {rivals:?}", f.label, f.location, f.evidence, f.effect)
        });
        let findings: Vec<String> = findings.collect();
        format!(
            "seed {}: {}\nverdict {}\n{}\n{:?}",
            self.case.seed,
            self.case.description,
            self.diagnosis.verdict.name(),
            findings.join("\n"),
            self.judgement
        )
    }

    /// Every hidden cause is found at its place, and nothing else.
    fn assert_found(&self) {
        let judgement = &self.judgement;
        assert!(judgement.found.iter().all(|found| *found), "not found\n{}", self.told());
        assert!(judgement.false_findings.is_empty(), "false finding\n{}", self.told());
        assert!(matches!(self.diagnosis.verdict, Verdict::Named | Verdict::Ambiguous), "{}", self.told());
    }

    /// Main parameters within a relative error, intervals around the estimates.
    fn assert_parameters(&self, tolerance: f64) {
        for (label, name, error) in &self.judgement.parameter_errors {
            assert!(error < &tolerance, "{label} {name} errs by {error:.3}\n{}", self.told());
        }
        for finding in &self.diagnosis.findings {
            for parameter in &finding.parameters {
                for (value, [low, high]) in parameter.value.iter().zip(&parameter.ci95) {
                    assert!(low <= value && value <= high, "{} {low}..{high}\n{}", parameter.name, self.told());
                }
            }
        }
    }

    /// The held-out gain is that of the truth.
    fn assert_gain(&self) {
        let Judgement { gain, truth_gain, .. } = self.judgement;
        assert!((gain - truth_gain).abs() < 0.02 + 0.1 * truth_gain.abs(), "gain\n{}", self.told());
    }
}
