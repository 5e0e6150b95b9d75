//! The comparison of strategies.

use serde::Serialize;

use super::{Cell, CellResult, Study, StudyStore, Work, signed_rank_p};
use tribo_model::{FileError, file_name};

/// The campaigns of one case, estimator and strategy, in the order of poses and seeds; costs over the oracle's.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaigns {
    /// Case, estimator and strategy, by index.
    pub place: [usize; 3],
    /// J_0/J_oracle of each campaign.
    pub uncompensated: Vec<f64>,
    /// J/J_oracle of each trial of each campaign.
    pub ratio: Vec<Vec<f64>>,
    /// The least J/J_oracle of the trials so far that were not aborted; infinite before the first.
    pub best: Vec<Vec<f64>>,
    /// J/J_oracle of the trial that is believed best, run again on the noise of the oracle; infinite where there is none.
    pub again: Vec<f64>,
    /// Aborted trials of each campaign.
    pub aborted: Vec<usize>,
}

/// A row of the comparison; quartiles by linear interpolation. What is infinite, because all trials failed, is none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudyRow {
    /// Truth and tuned law.
    pub case: String,
    /// Estimator.
    pub estimator: String,
    /// Strategy.
    pub strategy: String,
    /// Trials per campaign.
    pub trials: usize,
    /// Campaigns.
    pub campaigns: usize,
    /// Median J_0/J_oracle.
    pub uncompensated: Option<f64>,
    /// J/J_oracle of the second trial: median and worst.
    pub second: [Option<f64>; 2],
    /// J/J_oracle of the best trial's parameters, run again: first quartile, median, third quartile, worst.
    pub best: [Option<f64>; 4],
    /// Campaigns where it is within 1.1.
    pub within_1_1: usize,
    /// Aborted trials per campaign, mean.
    pub aborted: f64,
    /// Median over campaigns of that J over that of the study's first strategy on the same robot, motion and noise.
    pub over_first: Option<f64>,
    /// p-value of the signed-rank test on log(that J) against the first strategy, multiplied by the number of such tests in the study
    /// (Bonferroni); none for the first, and where nothing differs.
    pub p: Option<f64>,
}

/// All that a whole study says.
#[derive(Clone, Debug, PartialEq)]
pub struct StudySummary {
    /// One row per case, estimator and strategy.
    pub rows: Vec<StudyRow>,
    /// What is behind each.
    pub campaigns: Vec<Campaigns>,
}

impl StudySummary {
    /// The summary of a study whose cells are all finished; none before.
    ///
    /// # Errors
    /// A cell's file that is damaged.
    pub fn of(study: &Study, store: &StudyStore) -> Result<Option<Self>, FileError> {
        let mut campaigns = Vec::new();
        for case in 0..study.cases.len() {
            for estimator in 0..study.estimators.len() {
                for strategy in 0..study.strategies.len() {
                    match Campaigns::read(study, store, [case, estimator, strategy])? {
                        Some(read) => campaigns.push(read),
                        None => return Ok(None),
                    }
                }
            }
        }
        let tests = campaigns.iter().filter(|campaigns| campaigns.place[2] > 0).count();
        let rows = campaigns
            .iter()
            .map(|row| {
                let [case, estimator, _] = row.place;
                let first = campaigns.iter().find(|other| other.place == [case, estimator, 0]);
                StudyRow::of(study, row, first.unwrap_or(row), tests)
            })
            .collect();
        Ok(Some(Self { rows, campaigns }))
    }

    /// The document of `tribo study --json`.
    pub fn to_json(&self, study: &Study) -> serde_json::Value {
        serde_json::json!({
            "schema": "tribo.study.result/1",
            "tribo_version": env!("CARGO_PKG_VERSION"),
            "seeds": study.seeds,
            "poses": study.poses,
            "rows": self.rows,
        })
    }
}

impl Campaigns {
    fn read(study: &Study, store: &StudyStore, place: [usize; 3]) -> Result<Option<Self>, FileError> {
        let [case, estimator, strategy] = place;
        let mut campaigns =
            Self { place, uncompensated: vec![], ratio: vec![], best: vec![], again: vec![], aborted: vec![] };
        for &pose in &study.poses {
            for seed in 1..=study.seeds {
                let at = |work| Cell { case, estimator, pose, seed, work };
                let references = store.read(study, &at(Work::References))?;
                let campaign = store.read(study, &at(Work::Campaign(strategy)))?;
                let (
                    Some(CellResult::References { uncompensated, oracle, .. }),
                    Some(CellResult::Campaign { cost, aborted, again, .. }),
                ) = (references, campaign)
                else {
                    return Ok(None);
                };
                campaigns.uncompensated.push(uncompensated / oracle);
                campaigns.again.push(again.map_or(f64::INFINITY, |again| again / oracle));
                campaigns.ratio.push(cost.iter().map(|cost| cost / oracle).collect());
                let mut least = f64::INFINITY;
                let best = cost.iter().zip(&aborted).map(|(cost, aborted)| {
                    if aborted.is_none() {
                        least = least.min(cost / oracle);
                    }
                    least
                });
                let mut best: Vec<f64> = best.collect();
                // A campaign that ended early keeps what it had.
                best.resize(study.strategies[strategy].trials, least);
                campaigns.best.push(best);
                campaigns.aborted.push(aborted.iter().flatten().count());
            }
        }
        Ok(Some(campaigns))
    }
}

impl StudyRow {
    fn of(study: &Study, row: &Campaigns, first: &Campaigns, tests: usize) -> Self {
        let [case, estimator, strategy] = row.place;
        let (ends, ends_of_first) = (&row.again, &first.again);
        let second: Vec<f64> = row.ratio.iter().filter_map(|ratio| ratio.get(1).copied()).collect();
        let pairs = || ends.iter().zip(ends_of_first);
        let over_first: Vec<f64> = pairs().map(|(ours, theirs)| ours / theirs).collect();
        let differences: Vec<f64> = pairs().map(|(ours, theirs)| (ours / theirs).ln()).collect();
        Self {
            case: study.cases[case].name(),
            estimator: study.estimators[estimator].as_str().to_owned(),
            strategy: file_name(&study.strategies[strategy].strategy),
            trials: study.strategies[strategy].trials,
            campaigns: ends.len(),
            uncompensated: quantile(&row.uncompensated, 0.5),
            second: [0.5, 1.0].map(|p| quantile(&second, p)),
            best: [0.25, 0.5, 0.75, 1.0].map(|p| quantile(ends, p)),
            within_1_1: ends.iter().filter(|best| **best <= 1.1).count(),
            aborted: row.aborted.iter().sum::<usize>() as f64 / row.aborted.len().max(1) as f64,
            over_first: quantile(&over_first, 0.5).filter(|_| strategy > 0),
            p: signed_rank_p(&differences).filter(|_| strategy > 0).map(|p| (p * tests as f64).min(1.0)),
        }
    }
}

/// The quantile by linear interpolation between order statistics; none of nothing, and where it is not finite.
pub(super) fn quantile(values: &[f64], p: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    sorted.sort_by(f64::total_cmp);
    let place = p * sorted.len().checked_sub(1)? as f64;
    let (low, high) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    let value = if low == high { low } else { low + (high - low) * place.fract() };
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate() {
        assert_eq!(quantile(&[3.0, 1.0, 2.0, 4.0], 0.5), Some(2.5));
        assert_eq!(quantile(&[3.0, 1.0], 1.0), Some(3.0));
        assert_eq!((quantile(&[], 0.5), quantile(&[1.0, f64::INFINITY], 1.0)), (None, None));
        assert_eq!(quantile(&[f64::INFINITY; 2], 0.5), None);
    }
}
