//! Computing the cells of a slice.

use std::sync::Mutex;

use rayon::prelude::*;

use super::{Cell, Shard, Study, StudyStore};
use crate::CampaignError;

/// Somebody who watches a slice being computed.
pub trait StudyProgress: Send {
    /// The slice: cells in all, and those that were finished before.
    fn begin(&mut self, cells: usize, finished: usize);

    /// A cell is on the disk.
    fn finished(&mut self, cell: &Cell);

    /// Whether no further cell should begin.
    fn stop_requested(&mut self) -> bool;
}

/// Computes the cells of a slice that are not on the disk yet, on the threads of the current rayon pool; false if it was stopped
/// before its end. What a cell gives does not depend on threads, slices or the order of things.
///
/// # Errors
/// The first cell that cannot be computed or written.
pub fn run_shard(
    study: &Study,
    store: &StudyStore,
    shard: Shard,
    progress: &mut dyn StudyProgress,
) -> Result<bool, CampaignError> {
    let cells = shard.cells(study);
    let mut left = Vec::new();
    for cell in &cells {
        if store.read(study, cell)?.is_none() {
            left.push(*cell);
        }
    }
    progress.begin(cells.len(), cells.len() - left.len());
    let progress = Mutex::new(progress);
    let watch = || progress.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let whole = left
        .par_iter()
        .map(|cell| {
            if watch().stop_requested() {
                return Ok(false);
            }
            store.write(study, cell, &cell.run(study)?)?;
            watch().finished(cell);
            Ok::<bool, CampaignError>(true)
        })
        .try_reduce(|| true, |a, b| Ok(a && b))?;
    Ok(whole)
}
