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

use super::fit::{Start, posterior};
use super::joint_term::JointTerm;
use super::prior::Family;
use super::problem::{Place, Problem};
use super::selection::LEAST_NATS;
use super::tempering::{correlation_time, spectral_peak};
use crate::scene::Scene;

/// Each width over the one before.
const STEP: f64 = 0.5;
/// Widths that are tried.
const WIDTHS: usize = 6;
/// Least width over the noise of a joint's velocity in the band: below it, noise decides the sign.
const LEAST_OVER_NOISE: f64 = 3.0;

/// Width of the smooth sign [rad/s], sharper than the model's, that makes the log likeliest, common to all joints; `None` where none makes
/// it likelier by 10 nat, nor most of the joints that say anything.
pub(crate) fn sharper_sign<const N: usize>(scene: &Scene<N>, problem: &Problem) -> Option<f64> {
    let parts = problem.all_parts();
    // Presliding over a short distance is nearly a sharper sign: it would take what is asked for.
    let without = |family: &Family| *family != Family::Presliding;
    let families: Vec<Family> = Family::of_gears(problem.scale.link_side).filter(without).collect();
    let least_rad_s = LEAST_OVER_NOISE * scene.velocity_sd_in_band_rad_s.max();
    let own_rad_s = scene.nominal.smoothing_rad_s;
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
            let left = problem.residual_along(&all.state, j, &parts);
            let friction = scene.nominal.sliding_friction(j);
            let more_nm = problem.index(Place::Own(j, JointTerm::Coulomb)).map_or(0.0, |i| all.state[i]);
            let torque = |width: f64| -> Vec<f64> {
                let friction = friction.with_sign(width, more_nm);
                scene.samples.iter().map(|at| friction.torque_nm(at.qd[j])).collect()
            };
            let own = torque(own_rad_s);
            let beyond_own =
                |width: &f64| torque(*width).iter().zip(&own).map(|(sharper, own)| sharper - own).collect();
            let fine: Vec<Vec<f64>> = widths.iter().map(beyond_own).collect();
            // What a wrong width leaves comes again in every cycle: that is what is asked for, and no other error of the model.
            let count = left.len() as f64 / correlation_time(&left).max(spectral_peak(&left));
            let square: f64 = left.iter().map(|r| r * r).sum();
            let weights = problem.columns.row_weights(j);
            let likelier = |column: Vec<f64>| {
                let weighted = column.iter().zip(weights).map(|(x, weight)| x * weight);
                let without: f64 = left.iter().zip(weighted).map(|(r, x)| (r - x).powi(2)).sum();
                0.5 * count * (square.max(f64::MIN_POSITIVE) / without.max(f64::MIN_POSITIVE)).ln()
            };
            scene.filter_own_all(j, &fine).into_iter().map(likelier).collect()
        })
        .collect();
    let sum = |k: usize| nats.iter().map(|joint| joint[k]).sum::<f64>();
    let best = (0..widths.len()).max_by(|a, b| sum(*a).total_cmp(&sum(*b)))?;
    let says = |sign: f64| nats.iter().filter(|joint| sign * joint[best] > 1.0).count();
    (sum(best) > LEAST_NATS && says(1.0) > says(-1.0)).then_some(widths[best])
}
