//! Judgements counted.

use std::fmt;

use serde::Serialize;

use super::{Kind, Outcome, Strength, wilson95};

/// Counts of one row: a cause at one strength, or one of the other kinds.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Row {
    /// `coulomb/weak`, `pair`, `null`, `outside`.
    pub kind: String,
    /// Cases.
    pub cases: usize,
    /// Cases with any finding.
    pub detected: usize,
    /// Cases whose first finding is a hidden cause at its place.
    pub top_one: usize,
    /// Cases with every hidden cause among the findings.
    pub all_found: usize,
    /// Cases with every hidden cause among findings or alternatives.
    pub all_listed: usize,
    /// Cases with a finding that is not hidden.
    pub false_alarms: usize,
    /// Cases with the verdict `named` and a wrong name.
    pub confidently_wrong: usize,
    /// Median relative error over main parameters of found causes; `None` without any.
    pub parameter_error: Option<f64>,
    /// Median of |gain − gain of the truth|.
    pub gain_error: Option<f64>,
    /// Median time of a diagnosis (s).
    pub diagnosis_s: Option<f64>,
    /// Seeds of cases that went wrong.
    pub wrong_seeds: Vec<u64>,
}

/// A table of rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tally {
    /// Schema of the JSON form.
    pub schema: &'static str,
    /// One row per cause and strength, then pairs, nulls and outsiders, then sums.
    pub rows: Vec<Row>,
}

impl Tally {
    /// Counts.
    pub fn of(outcomes: &[Outcome]) -> Self {
        let mut kinds: Vec<Kind> = Vec::new();
        for label in Kind::causes() {
            kinds.extend(Strength::ALL.map(|strength| Kind::Single(label, strength)));
        }
        kinds.extend([Kind::Pair, Kind::Triple, Kind::Null, Kind::OutsideVocabulary]);
        let of_kind = |kind: &Kind| outcomes.iter().filter(|o| o.kind == *kind).collect::<Vec<_>>();
        let mut rows: Vec<Row> = kinds.iter().map(|kind| Row::of(kind.to_string(), &of_kind(kind))).collect();
        for strength in Strength::ALL {
            let of_strength = |o: &&Outcome| matches!(o.kind, Kind::Single(_, of) if of == strength);
            let name = format!("all causes/{}", strength.name());
            rows.push(Row::of(name, &outcomes.iter().filter(of_strength).collect::<Vec<_>>()));
        }
        rows.retain(|row| row.cases > 0);
        Self { schema: "tribo.hidden_effects/1", rows }
    }
}

impl Row {
    fn of(kind: String, outcomes: &[&Outcome]) -> Self {
        let count = |is: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|o| is(o)).count();
        let wrong = |o: &Outcome| {
            let judgement = &o.judgement;
            match o.kind {
                Kind::OutsideVocabulary => judgement.confidently_wrong,
                _ => !judgement.false_findings.is_empty() || judgement.found.contains(&false),
            }
        };
        Self {
            kind,
            cases: outcomes.len(),
            detected: count(&|o| o.judgement.detected),
            top_one: count(&|o| o.judgement.top_one),
            all_found: count(&|o| o.judgement.found.iter().all(|found| *found)),
            all_listed: count(&|o| o.judgement.listed.iter().all(|listed| *listed)),
            false_alarms: count(&|o| !o.judgement.false_findings.is_empty()),
            confidently_wrong: count(&|o| o.judgement.confidently_wrong),
            parameter_error: median(
                outcomes.iter().flat_map(|o| o.judgement.parameter_errors.iter().map(|(.., error)| *error)),
            ),
            gain_error: median(outcomes.iter().map(|o| (o.judgement.gain - o.judgement.truth_gain).abs())),
            diagnosis_s: median(outcomes.iter().map(|o| o.diagnosis_s)),
            wrong_seeds: outcomes.iter().filter(|o| wrong(o)).map(|o| o.seed).collect(),
        }
    }
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let high = *values.get(middle)?;
    Some(if values.len() % 2 == 1 { high } else { 0.5 * (high + values[middle - 1]) })
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "| kind | n | detected | first right [95 %] | all found [95 %] | listed | false alarms [95 %] | confidently wrong | parameter error | gain error | s |"
        )?;
        writeln!(f, "|---|---|---|---|---|---|---|---|---|---|---|")?;
        for row in &self.rows {
            let share = |hits: usize| {
                let [low, high] = wilson95(hits, row.cases);
                format!("{:.2} [{low:.2}, {high:.2}]", hits as f64 / row.cases as f64)
            };
            let or_none =
                |value: Option<f64>, digits: usize| value.map_or("–".to_owned(), |v| format!("{v:.digits$}"));
            writeln!(
                f,
                "| {} | {} | {:.2} | {} | {} | {:.2} | {} | {} | {} | {} | {} |",
                row.kind,
                row.cases,
                row.detected as f64 / row.cases as f64,
                share(row.top_one),
                share(row.all_found),
                row.all_listed as f64 / row.cases as f64,
                share(row.false_alarms),
                row.confidently_wrong,
                or_none(row.parameter_error, 3),
                or_none(row.gain_error, 3),
                or_none(row.diagnosis_s, 1),
            )?;
        }
        Ok(())
    }
}
