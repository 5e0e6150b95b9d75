//! What a stopped trial would have cost.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use tribo_model::FileError;
use tribo_robot::Wrench;
use tribo_trial::{AbortReason, Cost, CostAccumulator, CostMeasure, TrialLog};

use super::{FinishedTrial, LogSource};

/// Completes the cost of trials that somebody stopped:
///
/// ```text
/// ĉ_k = c_k[0, ξ] · exp( Σ_i ln(c_ik[0, T] / c_ik[0, ξ]) / (n + 1) ),     i = 1 … n: trials that were seen to their end
/// ```
///
/// for each of the twelve parts k of J: a maximum grows while one looks, a mean goes with the motion, and trials of one campaign share the
/// motion. Without this a stopped trial looks some per cent better than it is, and the search settles there. The one in n + 1 is a
/// trial that grew no more after ξ: few trials say little. A trial that ran into a limit is none of these; what it would have cost
/// nobody knows.
pub(super) struct Completion {
    measure: CostMeasure,
    /// By trial; none of a trial without a log.
    courses: Mutex<BTreeMap<usize, Option<Course>>>,
}

/// Part of a trial that tells its cost well enough: its mean is known, and its maxima have most likely been met.
pub(super) const TELLING_PART: f64 = 0.3;
/// Moments of a trial at which its course is known.
const MOMENTS: usize = 50;

/// `ln(c_k[0, T] / c_k[0, ξ])` at ξ = T/50, 2 T/50, …, T; maxima, then means.
type Course = [[f64; 12]; MOMENTS];

impl Completion {
    /// Of costs by this measure.
    pub(super) fn new(measure: CostMeasure) -> Self {
        Self { measure, courses: Mutex::default() }
    }

    /// The trials, those that were stopped late enough to tell with the cost that they would have had; their penalty stays.
    ///
    /// # Errors
    /// A log that cannot be read.
    #[inline(never)]
    pub(super) fn completed<const N: usize>(
        &self,
        finished: &[FinishedTrial],
        logs: &dyn LogSource<N>,
    ) -> Result<Vec<FinishedTrial>, FileError> {
        let mut completed = finished.to_vec();
        for trial in &mut completed {
            let seen = trial.cost.part_seen();
            if trial.aborted == Some(AbortReason::Stopped) && seen >= TELLING_PART {
                self.complete(&mut trial.cost, seen, finished, logs)?;
            }
        }
        Ok(completed)
    }

    fn complete<const N: usize>(
        &self,
        cost: &mut Cost,
        seen: f64,
        finished: &[FinishedTrial],
        logs: &dyn LogSource<N>,
    ) -> Result<(), FileError> {
        let moment = ((seen * MOMENTS as f64).round() as usize).clamp(1, MOMENTS) - 1;
        let mut courses = self.courses.lock().unwrap_or_else(PoisonError::into_inner);
        let (mut sum, mut count) = ([0.0; 12], 0.0);
        for trial in finished.iter().filter(|trial| trial.aborted.is_none()) {
            let course = match courses.get(&trial.number) {
                Some(known) => *known,
                None => {
                    let course = logs.log(trial.number)?.map(|log| self.course(&log));
                    *courses.entry(trial.number).or_insert(course)
                }
            };
            if let Some(course) = course {
                sum.iter_mut().zip(&course[moment]).for_each(|(sum, growth)| *sum += growth);
                count += 1.0;
            }
        }
        for (part, sum) in cost.max.iter_mut().chain(&mut cost.mean).zip(sum) {
            *part *= (sum / (count + 1.0)).exp();
        }
        Ok(())
    }

    fn course<const N: usize>(&self, log: &TrialLog<N>) -> Course {
        let judged: Vec<usize> = (0..log.len()).filter(|&row| log.time_s[row] >= 0.0).collect();
        let parts = |accumulator: CostAccumulator| {
            let Cost { max, mean, .. } = accumulator.finish(None, 1.0);
            let mut parts = max.into_iter().chain(mean);
            std::array::from_fn(|_| parts.next().unwrap_or(0.0))
        };
        let mut accumulator = CostAccumulator::new(self.measure);
        let mut rows = 0;
        let course: Course = std::array::from_fn(|moment| {
            let end = judged.len() * (moment + 1) / MOMENTS;
            for &row in &judged[rows..end] {
                accumulator.add(&Wrench::from_vector(&log.wrench[row]));
            }
            rows = end;
            parts(accumulator.clone())
        });
        let whole = course[MOMENTS - 1];
        course.map(|part| {
            std::array::from_fn(|k| {
                let growth = (whole[k] / part[k]).ln();
                if growth.is_finite() { growth } else { 0.0 }
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector6;

    use super::*;
    use crate::strategy::Origin;

    /// A trial whose force along x is `scale` until the middle and twice that from then on, whose moment about x is -`scale` throughout.
    struct Steps;

    const SCALES: [f64; 4] = [1.0, 2.0, 8.0, 3.0];

    fn rows() -> impl Iterator<Item = f64> {
        (-20..100).map(|row| 0.3 * f64::from(row))
    }

    fn wrench(number: usize, time_s: f64) -> Vector6<f64> {
        let scale = SCALES[number];
        Vector6::new(-scale, 0.0, 0.0, if time_s < 15.0 { scale } else { 2.0 * scale }, 0.0, 0.0)
    }

    impl LogSource<7> for Steps {
        fn log(&self, number: usize) -> Result<Option<TrialLog<7>>, FileError> {
            let time_s: Vec<f64> = rows().collect();
            let wrench = time_s.iter().map(|time_s| wrench(number, *time_s)).collect();
            Ok((number != 1).then(|| TrialLog { period_s: 0.3, time_s, wrench, ..TrialLog::default() }))
        }
    }

    fn trial(number: usize, stopped_at_s: Option<f64>) -> FinishedTrial {
        let mut accumulator = CostAccumulator::new(CostMeasure::Paper);
        for time_s in rows().filter(|time_s| (0.0..stopped_at_s.unwrap_or(30.0)).contains(time_s)) {
            accumulator.add(&Wrench::from_vector(&wrench(number, time_s)));
        }
        FinishedTrial {
            number,
            theta: vec![],
            cost: accumulator.finish(stopped_at_s, 30.0),
            aborted: stopped_at_s.map(|_| AbortReason::Stopped),
            origin: Origin::Design,
        }
    }

    #[test]
    fn a_stopped_trial_grows_as_the_others_did() {
        let completion = Completion::new(CostMeasure::Paper);
        let whole = [trial(0, None), trial(1, None), trial(2, None)];
        let stopped = trial(3, Some(12.0));
        let of = |trials: &[FinishedTrial]| completion.completed(trials, &Steps).expect("logs that can be read");
        // Alone it stays what was seen of it, and so does one that broke a limit.
        assert_eq!(of(std::slice::from_ref(&stopped)), std::slice::from_ref(&stopped));
        let failed = FinishedTrial { aborted: Some(AbortReason::Acceleration), ..stopped.clone() };
        let glimpsed = trial(3, Some(6.0));
        for unchanged in [failed, glimpsed] {
            let trials = [whole[0].clone(), unchanged];
            assert_eq!(of(&trials), trials);
        }
        // Two of the three others have logs: 2^(2/3) for the force, whose mean rose by half; the moment was what it was.
        let trials = [whole.to_vec(), vec![stopped.clone()]].concat();
        let completed = of(&trials);
        assert_eq!(completed[..3], whole);
        let cost = completed[3].cost;
        assert!((cost.max[0] / 3.0 - 2.0_f64.powf(2.0 / 3.0)).abs() < 1e-12, "{cost:?}");
        assert!((cost.mean[0] / 3.0 - 1.5_f64.powf(2.0 / 3.0)).abs() < 1e-12, "{cost:?}");
        assert_eq!((cost.max[3], cost.mean[3], cost.max[1]), (stopped.cost.max[3], stopped.cost.mean[3], 0.0));
        assert_eq!(cost.penalty, stopped.cost.penalty);
        // And again from memory, to the bit.
        assert_eq!(of(&trials), completed);
    }
}
