//! What of an extended model no compensator cancels.

use tribo_diagnose::Diagnosis;
use tribo_regression::CauseLabel;

use crate::{ControllerModel, Model, not_cancelled_sentences};

/// The effects of `extended` that a controller cannot act on, one sentence per cause and reason: those that the diagnosis names and
/// those that the nominal model had already. (The means of all other parameters are in the extended model too, and are next to
/// nothing.)
pub fn not_cancelled_of<const N: usize>(diagnosis: &Diagnosis, nominal: &Model<N>, extended: &Model<N>) -> Vec<String> {
    let mut left = ControllerModel::by_controller(extended).not_cancelled;
    left.retain(|left| {
        let cause = left.effect.cause();
        is_named(diagnosis, cause) || nominal.effects.iter().any(|effect| effect.cause() == cause)
    });
    not_cancelled_sentences(&left, &diagnosis.joint_names)
}

/// Whether the diagnosis names this cause, or no diagnosis could.
fn is_named(diagnosis: &Diagnosis, cause: &str) -> bool {
    let nameless = CauseLabel::ALL.iter().all(|label| label.name() != cause);
    nameless || diagnosis.findings.iter().any(|finding| finding.label.name() == cause)
}
