//! The dynamics as clients download them.

mod c_source;
mod library;
mod urdf;

pub use c_source::c_source;
pub use library::{LibraryError, library};
pub use urdf::urdf;
