//! Serial arms out of trees of links, whatever file the tree is from.
//!
//! ```text
//! base --joint 1--> body 1 --joint 2--> … --joint N--> body N ⊃ flange
//! ```
//!
//! A body is everything that is welded to a link of the chain; its frame is that of its joint, with the axis on z.

mod assumed;
mod error;
pub(crate) mod frame;
pub(crate) mod joint;
mod remark;
mod serial;
pub(crate) mod skeleton;
pub(crate) mod weld;
pub(crate) mod xml;

pub use error::ChainError;
pub use remark::ChainRemark;
pub use serial::{DescribedArm, SerialChain};
pub(crate) use weld::{Source, welded_chain};
