//! Arms whose numbers are published, each with its source.

mod panda;

pub use panda::{panda, panda_ready_pose};
