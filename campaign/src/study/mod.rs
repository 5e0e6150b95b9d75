//! Studies: many campaigns, on one machine or many.

mod cell;
mod page;
mod place;
mod run;
mod settings;
mod shard;
mod signed_rank;
mod store;
mod summary;

pub use cell::CellResult;
pub use page::study_page;
pub use place::{Cell, Work};
pub use run::{StudyProgress, run_shard};
pub use settings::{Budget, Case, Study};
pub use shard::{Shard, ShardError};
pub use signed_rank::signed_rank_p;
pub use store::StudyStore;
pub use summary::{Campaigns, StudyRow, StudySummary};

/// SplitMix64 of a number: a fixed order without pattern.
fn mixed(number: u64) -> u64 {
    crate::noise_seed(number, 0)
}
