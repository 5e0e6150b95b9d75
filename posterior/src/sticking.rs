//! Whether the joints of an arm stick where they stop.
//!
//! ```text
//! r_j = y − (1 + g)(τ0 + A μ) of all families but presliding, delay and curves,   d_j = what sticking changes of joint j (see `short_rests`)
//! nats = Σ_j (n_j/2κ_j) ln(Σ r_j² / Σ (r_j − d_j)²)
//! ```
//!
//! Nothing is fitted: Coulomb friction is what the joint shows in motion. Where joints stick and the model does not know it, friction seems to
//! turn round before the velocity does, which a negative delay or friction that bends then explains.

use tribo_regression::{Nominal, RegressionData, bridge};

use crate::fit::{Start, posterior};
use crate::prior::Family;
use crate::problem::Problem;
use crate::sign_width::{is_shown, likelier, more_coulomb_nm};

/// The model with joints that stick, where that makes the log likelier by 10 nat, and that of most joints that say anything.
pub fn sticking<const N: usize>(data: &RegressionData<N>, problem: &Problem) -> Option<Nominal<N>> {
    if data.nominal.sticks || data.transmission || data.short_rests.iter().all(Vec::is_empty) {
        return None;
    }
    // These would take what is asked for.
    let without = |family: &Family| !matches!(family, Family::Presliding | Family::Delay | Family::Curve);
    let families: Vec<Family> = Family::of_gears(problem.scale.link_side).filter(without).collect();
    let (all, _) = posterior(problem, &problem.all_parts(), &Start::of(&families))?;
    let nats: Vec<f64> = (0..N)
        .filter(|j| !data.short_rests[*j].is_empty())
        .flat_map(|j| {
            let more_nm = more_coulomb_nm(problem, &all, j);
            let friction = data.nominal.sliding_friction(j).with_sign(data.nominal.smoothing_rad_s, more_nm);
            let slides: Vec<f64> = data.motion.iter().map(|at| friction.torque_nm(at.qd[j])).collect();
            let mut change = slides.clone();
            bridge(&mut change, &data.short_rests[j]);
            change.iter_mut().zip(slides).for_each(|(sticks, slides)| *sticks -= slides);
            likelier(data, problem, &all, j, [change])
        })
        .collect();
    is_shown(&nats).then(|| data.nominal.with_sticking())
}
