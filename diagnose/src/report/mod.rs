//! A diagnosis for people: sentences, and one HTML file with its plots; and for programs: one JSON document.
//!
//! ```text
//! Diagnosis → verdict_sentence, finding_sentence → terminal, report
//!           → html: verdict, findings with evidence, worth per joint, pattern, next experiment, rejected, overview
//! ```
//!
//! The file stands alone: inline SVG and style sheet, no script, no network; light or dark as the reader's system is.
//! Everything that is not ours (file names, reasons, signatures) is escaped. It shows and does not compute: every
//! number is one of the [`Diagnosis`](crate::Diagnosis).

mod closed_loop;
mod document;
mod html;
mod pictures;
#[cfg(test)]
mod sample;
mod section;
mod sentence;

pub use closed_loop::ClosedLoop;
pub use document::{Extras, document};
pub use html::{ReportContext, html};
pub use pictures::{held_out_bars, via_points};
pub use sentence::{cause_at, cause_name, description, finding_sentence, verdict_sentence};
pub use tribo_figure::number;
