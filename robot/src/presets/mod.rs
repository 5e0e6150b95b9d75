//! Arms whose numbers are published, each with its source.

mod panda;

pub use panda::{PANDA_JOINT_STIFFNESS_NM_PER_RAD, panda, panda_ready_pose};
