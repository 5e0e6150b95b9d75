//! What a model predicts of the third of the motion that is least like the rest, when it is fitted to the rest.
//!
//! Parts of a log that are held out one after the other are no faster than the rest, and go where the rest goes. What is asked of a model later often
//! is and does: how its errors grow with the motion, only rows that are faster than all that was fitted show, and how they grow from one posture to
//! another, only postures where nothing was fitted.

use crate::band::HeldOut;
use crate::columns::Rows;
use crate::distance::{MotionSpace, distance};
use crate::fit::{Fit, posterior};
use crate::motion::Motion;
use crate::posture::Posture;
use crate::problem::Problem;
use crate::unseen::deviations;

/// Share of the rows that is held out.
const SHARE: f64 = 1.0 / 3.0;
/// Length (s) over which a measure is averaged, so that what is held out are stretches of it.
const STRETCH_S: f64 = 1.0;

/// Residuals of each joint along the fastest third, and along the third of the postures that are farthest from the mean posture, with what a fit to the
/// rest foretells of them; `all` lends its families, scales and noise colour, `rates_hz` are those of the rows of each log. Empty where nothing can be
/// fitted. Logs without payload are never held out.
pub fn extremes(problem: &Problem, all: &Fit, space: &MotionSpace, rates_hz: &[f64]) -> [HeldOut; 2] {
    let parts = problem.all_parts();
    let (motion, posture) = (Motion::of(problem, &parts), Posture::of(problem, &parts));
    [
        largest_third(problem, all, space, rates_hz, &|part| motion.over(problem, part)),
        largest_third(problem, all, space, rates_hz, &|part| posture.over(problem, part)),
    ]
}

/// The same along the third of the rows where a measure, given along a part, is largest.
fn largest_third(
    problem: &Problem,
    all: &Fit,
    space: &MotionSpace,
    rates_hz: &[f64],
    measure: &dyn Fn(usize) -> Vec<f64>,
) -> HeldOut {
    let nothing = || HeldOut { deviations: vec![Vec::new(); problem.joints()], distance: f64::INFINITY };
    let parts = problem.all_parts();
    // Of each log: row and measure about it.
    let about: Vec<Vec<(usize, f64)>> = (0..rates_hz.len())
        .map(|log| {
            let of_log = || parts.iter().filter(|part| problem.columns.parts[**part].log == log);
            let rows = of_log().flat_map(|part| problem.columns.parts[*part].samples.clone());
            let values: Vec<f64> = of_log().flat_map(|part| measure(*part)).collect();
            rows.zip(averaged(&values, (0.5 * STRETCH_S * rates_hz[log]) as usize)).collect()
        })
        .collect();
    let loaded = |log: &usize| !problem.unloaded[*log];
    let mut sorted: Vec<f64> =
        (0..about.len()).filter(loaded).flat_map(|log| about[log].iter().map(|(_, value)| *value)).collect();
    sorted.sort_by(f64::total_cmp);
    let Some(&most) = sorted.get((sorted.len() as f64 * (1.0 - SHARE)) as usize) else { return nothing() };
    let rows = |log: usize, held_out: bool| Rows {
        rows: about[log].iter().filter(|(_, m)| (loaded(&log) && *m > most) == held_out).map(|(row, _)| *row).collect(),
        log,
    };
    let seen: Vec<Rows> = (0..about.len()).map(|log| rows(log, false)).collect();
    let held_out: Vec<Rows> = (0..about.len()).filter(loaded).map(|log| rows(log, true)).collect();
    let first = seen.len();
    let here = problem.over(problem.columns.rearranged(&[seen, held_out].concat()));
    let (seen, held_out): (Vec<usize>, Vec<usize>) = here.all_parts().into_iter().partition(|part| *part < first);
    let Some((fit, _)) = posterior(&here, &seen, &all.lend(problem, all.start.families.clone())) else {
        return nothing();
    };
    let motion = Motion::of(&here, &seen);
    HeldOut {
        deviations: (0..problem.joints()).map(|j| deviations(&here, &fit, &motion, j, &held_out)).collect(),
        distance: distance(&space.points(&here, &held_out), &space.points(&here, &seen)),
    }
}

/// The mean of the values about each, as many on either side.
fn averaged(values: &[f64], half: usize) -> impl Iterator<Item = f64> {
    (0..values.len()).map(move |k| {
        let about = &values[k.saturating_sub(half)..values.len().min(k + half + 1)];
        about.iter().sum::<f64>() / about.len() as f64
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_end_where_the_values_do() {
        let all: Vec<f64> = averaged(&[1.0, 2.0, 6.0, 3.0], 1).collect();
        assert_eq!(all, [1.5, 3.0, 11.0 / 3.0, 4.5]);
        assert_eq!(averaged(&[1.0, 4.0], 0).collect::<Vec<_>>(), [1.0, 4.0]);
    }
}
