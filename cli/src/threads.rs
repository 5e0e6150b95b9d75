//! The threads asked for.

use anyhow::Context;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::arguments::Common;

/// The threads of `--threads`.
///
/// # Errors
/// A computer that cannot start them.
pub fn pool(common: &Common) -> anyhow::Result<ThreadPool> {
    ThreadPoolBuilder::new().num_threads(common.threads.into()).build().context("starting the threads")
}
