//! Whether the logs are those of a simulator: friction that is a soft constraint, see [`tribo_sim::SoftFriction`].

use crate::fit::{Fit, fit};
use crate::joint_term::JointTerm;
use crate::prior::Family;
use crate::problem::{NormalEquations, Place, Problem};
use crate::selection::LEAST_NATS;

/// Standard deviations by which the friction of a joint must lead its velocity.
const SURE: f64 = 2.0;

/// Whether dry friction leads the velocity in more than half of the joints, and the logs are likelier by 10 nat for it.
///
/// A physics engine gives such friction to every joint, a gear has none: on the real logs of four arms evidence alone was drawn into
/// it by what bends elsewhere, with leads of either sign.
pub fn soft_friction(problem: &Problem, equations: &NormalEquations, parts: &[usize], all: &Fit) -> bool {
    let fitted = |families: Vec<Family>| fit(problem, equations, parts, &all.lend(problem, families));
    let families = all.start.families.clone();
    let more = families.iter().copied().chain([Family::Lead]).collect();
    let (Some(without), Some(with)) = (fitted(families), fitted(more)) else { return false };
    let leads = |joint: &usize| {
        let terms = JointTerm::LEAD.into_iter();
        let index: Vec<usize> = terms.filter_map(|term| problem.index(Place::Own(*joint, term))).collect();
        let (sum, sd) = with.sum(&index);
        sum > SURE * sd
    };
    let leading = (0..problem.joints()).filter(leads).count();
    2 * leading > problem.joints() && with.log_evidence > without.log_evidence + LEAST_NATS
}
