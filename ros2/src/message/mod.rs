//! The messages that go out, in CDR.

mod covariance_array;
mod diagnostic_array;
mod wrench_stamped;

pub use covariance_array::{COVARIANCE_TYPE, covariance_array};
pub use diagnostic_array::{DIAGNOSTIC_TYPE, Level, Status, diagnostic_array};
pub use wrench_stamped::{WRENCH_TYPE, wrench_stamped};
