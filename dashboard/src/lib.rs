#![doc = include_str!("../README.md")]
//!
//! ```text
//! journal, logs → Source (threads) → Snapshot (immutable) → views → egui → window | picture | test
//! ```
//!
//! [`Dashboard`] is the whole interface as a function of egui's input; [`run`] puts it into a window, [`screenshot()`] draws it
//! into a PNG without display or graphics card, the tests click its labels. Views are handed an immutable [`Snapshot`] and
//! write nothing. A campaign that is started here runs in a thread and is watched like any other: through its directory.
//! Figures are those of the HTML report ([`tribo_watch`]).
//!
//! ```
//! use tribo_dashboard::{Dashboard, Options, picture};
//!
//! let here = std::env::temp_dir();
//! let mut dashboard = Dashboard::new(Options {
//!     open: None,
//!     live: None,
//!     compare: None,
//!     view: None,
//!     clock: || "2000-01-01T00:00:00.000000+00:00".to_owned(),
//!     immediate: true,
//!     layout: None,
//!     exports: here.clone(),
//!     campaigns: here,
//! });
//! let drawn = picture([800, 600], false, |ui| dashboard.ui(ui));
//! assert_eq!(drawn.size, [800, 600]);
//! ```

mod app;
mod diagnosis_snapshot;
mod export;
mod export_request;
mod help;
mod jobs;
mod layout;
mod live_feed;
mod live_record;
mod live_sample;
mod live_snapshot;
mod log_snapshot;
mod picture;
mod plot;
mod raster;
mod runner;
mod screenshot;
mod shell;
mod snapshot;
mod source;
mod theme;
mod view;
mod views;
mod wrench_snapshot;

pub use app::{Dashboard, Options};
pub use diagnosis_snapshot::DiagnosisSnapshot;
pub use layout::Layout;
pub use live_feed::{LiveFeed, LiveTitle};
pub use live_record::LiveRecord;
pub use live_sample::LiveSample;
pub use live_snapshot::LiveSnapshot;
pub use log_snapshot::{LogSnapshot, LogSource};
pub use picture::{PictureError, picture, write_png};
pub use screenshot::screenshot;
pub use shell::{NoWindow, run};
pub use snapshot::Snapshot;
pub use source::Source;
pub use view::View;
pub use views::channels;
pub use wrench_snapshot::WrenchSnapshot;
