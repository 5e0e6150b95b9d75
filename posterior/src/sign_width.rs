//! How sharply dry friction turns round: a width of the smooth sign below the model's, where the log shows one.
//!
//! ```text
//! r_j = y − (1 + g)(τ0 + A μ) of all families but presliding,   d_j(w) = f_j(qd; w) − f_j(qd; ε),   f = Fc tanh(qd/w)
//! nats(w) = Σ_j (n_j/2κ_j) ln(Σ r_j² / Σ (r_j − d_j(w))²)
//! ```
//!
//! ε is a constant of the model and none of the arm: nobody measured it. Where friction turns round faster, all joints that creep miss most of
//! their friction, which presliding over a tenth of a milliradian or a Stribeck peak then explains. Fc is what the joint shows in motion, so
//! nothing is fitted near rest; a wider sign is no candidate, since presliding and a simulator's soft friction have laws of their own.

use tribo_regression::{Nominal, RegressionData};

use crate::fit::{Fit, Start, posterior};
use crate::joint_term::JointTerm;
use crate::prior::Family;
use crate::problem::{Place, Problem};
use crate::selection::LEAST_NATS;
use crate::tempering::{correlation_time, spectral_peak};

/// Each width over the one before.
const STEP: f64 = 0.5;
/// Widths that are tried.
const WIDTHS: usize = 6;
/// Least width over the noise of a joint's velocity in the band: below it, noise decides the sign.
const LEAST_OVER_NOISE: f64 = 3.0;

/// The model with the width of the smooth sign, sharper than its own and common to all joints, that makes the log likeliest; `None` where none
/// makes it likelier by 10 nat, nor that of most joints that say anything.
pub fn sharper_sign<const N: usize>(data: &RegressionData<N>, problem: &Problem) -> Option<Nominal<N>> {
    let parts = problem.all_parts();
    // Presliding over a short distance is nearly a sharper sign: it would take what is asked for.
    let without = |family: &Family| *family != Family::Presliding;
    let families: Vec<Family> = Family::of_gears(problem.scale.link_side).filter(without).collect();
    let least_rad_s = LEAST_OVER_NOISE * data.velocity_sd_in_band_rad_s.max();
    let own_rad_s = data.nominal.smoothing_rad_s;
    let widths: Vec<f64> = std::iter::successors(Some(STEP * own_rad_s), |width| Some(STEP * width))
        .take(WIDTHS)
        .take_while(|width| *width > least_rad_s)
        .collect();
    if widths.is_empty() {
        return None;
    }
    let (all, _) = posterior(problem, &parts, &Start::of(&families))?;
    let nats: Vec<Vec<f64>> = (0..N)
        .map(|j| {
            let friction = data.nominal.sliding_friction(j);
            let more_nm = more_coulomb_nm(problem, &all, j);
            let torque = |width: f64| -> Vec<f64> {
                let friction = friction.with_sign(width, more_nm);
                data.motion.iter().map(|at| friction.torque_nm(at.qd[j])).collect()
            };
            let own = torque(own_rad_s);
            let beyond_own = |width: &f64| {
                let sharper = torque(*width).into_iter().zip(&own).map(|(sharper, own)| sharper - own);
                let mut beyond: Vec<f64> = sharper.collect();
                // A joint that sticks has no velocity that a sign could be of.
                let stops = data.short_rests[j].iter().filter(|_| data.nominal.sticks);
                stops.for_each(|rest| beyond[rest.clone()].fill(0.0));
                beyond
            };
            likelier(data, problem, &all, j, widths.iter().map(beyond_own))
        })
        .collect();
    let sum = |k: usize| nats.iter().map(|joint| joint[k]).sum::<f64>();
    let best = (0..widths.len()).max_by(|a, b| sum(*a).total_cmp(&sum(*b)))?;
    let of_best: Vec<f64> = nats.iter().map(|joint| joint[best]).collect();
    is_shown(&of_best).then(|| data.nominal.with_sign(widths[best]))
}

/// Coulomb friction (Nm) that a joint has beyond the model's.
pub(super) fn more_coulomb_nm(problem: &Problem, all: &Fit, joint: usize) -> f64 {
    problem.index(Place::Own(joint, JointTerm::Coulomb)).map_or(0.0, |i| all.state[i])
}

/// By how much the log of a joint becomes likelier (nat) with each of some changes of its torque (Nm, fine grid).
pub(super) fn likelier<const N: usize>(
    data: &RegressionData<N>,
    problem: &Problem,
    all: &Fit,
    joint: usize,
    changes: impl IntoIterator<Item = Vec<f64>>,
) -> Vec<f64> {
    let left = problem.residual_along(&all.state, joint, &problem.all_parts());
    // What a wrong width leaves comes again in every cycle: that is what is asked for, and no other error of the model.
    let count = left.len() as f64 / correlation_time(&left).max(spectral_peak(&left));
    let square: f64 = left.iter().map(|r| r * r).sum();
    let weights = problem.columns.row_weights(joint);
    let nats = |column: Vec<f64>| {
        let weighted = column.iter().zip(weights).map(|(x, weight)| x * weight);
        let without: f64 = left.iter().zip(weighted).map(|(r, x)| (r - x).powi(2)).sum();
        0.5 * count * (square.max(f64::MIN_POSITIVE) / without.max(f64::MIN_POSITIVE)).ln()
    };
    data.filter_own_all(changes).into_iter().map(nats).collect()
}

/// Whether a change makes the log likelier by 10 nat in all, and most of the joints that say anything.
pub(super) fn is_shown(nats: &[f64]) -> bool {
    let says = |sign: f64| nats.iter().filter(|nats| sign * **nats > 1.0).count();
    nats.iter().sum::<f64>() > LEAST_NATS && says(1.0) > says(-1.0)
}
