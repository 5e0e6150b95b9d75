//! The friction published by gaz2019.

use tribo_friction::{FrictionModel, JointFriction};
use tribo_sim::panda_gaz_joints;

/// The friction published by gaz2019 for one real Panda; none of an arm with another number of joints.
pub fn published_gaz<const N: usize>() -> Option<FrictionModel<N>> {
    let joints: [JointFriction; 7] = panda_gaz_joints().map(Into::into);
    Some(FrictionModel { joints: joints.as_slice().try_into().ok()? })
}
