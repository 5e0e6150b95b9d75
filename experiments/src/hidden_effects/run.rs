//! Cases by number, diagnosed and judged.

use std::time::Instant;

use tribo_diagnose::{DiagnoseSettings, Diagnosis, diagnose};
use tribo_regression::{CauseLabel, DiagnoseError};
use tribo_sim::RecordingError;

use super::{HiddenCase, Judgement, Kind, Strength, World};

/// Which cases seeds stand for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CaseFilter {
    /// One kind of case instead of all in turn; causes of the strength below, or of all strengths in turn.
    pub kind: Option<Kind>,
    /// One cause, where `kind` is `None`.
    pub label: Option<CauseLabel>,
    /// One strength of single causes instead of all in turn.
    pub strength: Option<Strength>,
}

/// Cases without a single cause in a round of all kinds, of each sort.
const OTHERS: u64 = 10;

impl CaseFilter {
    /// From a name: `all`, `null`, `pair`, `outside` or a cause.
    pub fn named(name: &str, strength: Option<Strength>) -> Option<Self> {
        let filter = |kind, label| Some(Self { kind, label, strength });
        match name {
            "all" => filter(None, None),
            "null" => filter(Some(Kind::Null), None),
            "pair" => filter(Some(Kind::Pair), None),
            "triple" => filter(Some(Kind::Triple), None),
            "outside" => filter(Some(Kind::OutsideVocabulary), None),
            _ => filter(None, Some(Kind::causes().find(|label| label.name() == name)?)),
        }
    }

    /// What the seed stands for. In turn: every cause, each of the strengths of a round, then pairs, nulls and outsiders.
    pub fn kind_of(&self, seed: u64) -> Kind {
        if let Some(kind) = self.kind {
            return kind;
        }
        let strengths: Vec<Strength> =
            self.strength.map_or_else(|| Strength::ROUND.to_vec(), |strength| vec![strength]);
        let labels: Vec<CauseLabel> = self.label.map_or_else(|| Kind::causes().collect(), |label| vec![label]);
        let single = (labels.len() * strengths.len()) as u64;
        let others = if self.label.is_none() && self.strength.is_none() { 3 * OTHERS } else { 0 };
        let index = seed % (single + others);
        if index < single {
            let (label, strength) = (index as usize % labels.len(), index as usize / labels.len());
            return Kind::Single(labels[label], strengths[strength]);
        }
        match (index - single) % 3 {
            0 => Kind::Pair,
            1 => Kind::Null,
            _ => Kind::OutsideVocabulary,
        }
    }
}

/// A case, its diagnosis and the judgement.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Seed.
    pub seed: u64,
    /// What was asked for.
    pub kind: Kind,
    /// Name of the torque outside the vocabulary.
    pub extra: Option<&'static str>,
    /// Hidden torque over noise [-].
    pub strength: f64,
    /// Everything hidden in words.
    pub description: String,
    /// The answer.
    pub diagnosis: Diagnosis,
    /// What is right in it.
    pub judgement: Judgement,
    /// Time of the diagnosis alone (s).
    pub diagnosis_s: f64,
}

/// Why a case has no outcome.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The case could not be made.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// No diagnosis.
    #[error(transparent)]
    Diagnosis(#[from] DiagnoseError),
    /// No residual.
    #[error(transparent)]
    Residual(#[from] tribo_regression::ResidualError),
}

/// Draws the case, hands log and nominal model to the diagnosis, and judges the answer.
///
/// # Errors
/// [`CaseError`].
pub fn judged(seed: u64, kind: Kind, world: World) -> Result<Outcome, CaseError> {
    let case = HiddenCase::draw(seed, kind, world)?;
    let start = Instant::now();
    let diagnosis = diagnose(&case.logs, &case.nominal, &[], &DiagnoseSettings::default(), &|_, _| true)?;
    let diagnosis_s = start.elapsed().as_secs_f64();
    let judgement = Judgement::of(&case, &diagnosis)?;
    let HiddenCase { extra, strength, description, .. } = case;
    Ok(Outcome { seed, kind, extra, strength, description, diagnosis, judgement, diagnosis_s })
}

impl Outcome {
    /// One line: what was hidden, what was found, with evidence and alternatives.
    pub fn line(&self) -> String {
        let findings: Vec<String> = self
            .diagnosis
            .findings
            .iter()
            .map(|finding| {
                let rivals: Vec<String> = finding
                    .alternatives
                    .iter()
                    .map(|a| format!("{}@{} −{:.0}", a.label, a.location, a.evidence_gap))
                    .collect();
                let rivals = if rivals.is_empty() { String::new() } else { format!(" [or {}]", rivals.join(", ")) };
                format!("{}@{} {:.0}{rivals}", finding.label, finding.location, finding.evidence)
            })
            .collect();
        let judgement = &self.judgement;
        let right = judgement.found.iter().all(|found| *found) && judgement.false_findings.is_empty();
        let mark = match self.kind {
            Kind::OutsideVocabulary if judgement.confidently_wrong => "WRONG",
            Kind::OutsideVocabulary => "ok   ",
            _ if right => "ok   ",
            _ if !judgement.detected => "MISS ",
            _ if judgement.found.iter().all(|found| *found) => "EXTRA",
            _ => "WRONG",
        };
        let errors: Vec<String> = judgement
            .parameter_errors
            .iter()
            .map(|(_, name, error)| format!("{name} {:.0} %", 100.0 * error))
            .collect();
        format!(
            "{mark} {:>6} {}{} | {} | {} | {} | gain {:.3} truth {:.3} | {:.1} s",
            self.seed,
            self.kind,
            self.extra.map(|name| format!(" {name}")).unwrap_or_default(),
            self.diagnosis.verdict.name(),
            if findings.is_empty() { "–".to_owned() } else { findings.join(" + ") },
            errors.join(", "),
            judgement.gain,
            judgement.truth_gain,
            self.diagnosis_s,
        )
    }
}
