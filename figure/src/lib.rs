#![doc = include_str!("../README.md")]
//!
//! ```text
//! Figure = title + two scales (quantity, unit, frame) + layers   →   SVG, CSV, the page of a report
//! signal → min/max pyramid → two values per pixel, whatever the length
//! ```
//!
//! A [`Figure`] is immutable and computes nothing. The same figure is drawn by [`svg()`] in reports and by the window, so
//! that both show the same. [`Signals`] holds long recordings and hands out what a plot of a given width can show.
//!
//! ```
//! use tribo_figure::{Figure, Layer, Scale, csv, svg};
//!
//! let figure = Figure::new("Decay", Scale::of("time [s]"), Scale::of("torque [Nm]"))
//!     .with(Layer::line("joint 0", 0, vec![0.0, 1.0, 2.0], vec![4.0, 2.0, 1.0]));
//! assert!(svg(&figure).contains("torque [Nm]"));
//! assert!(csv(&figure).starts_with("layer,time [s],torque [Nm]"));
//! ```

mod axis;
mod csv;
mod decimate;
pub mod escape;
mod figure;
pub mod number;
pub mod page;
mod palette;
mod pyramid;
mod signals;
mod svg;

pub use axis::Axis;
pub use csv::csv;
pub use decimate::{MOST_POINTS, decimated};
pub use figure::{Figure, Layer, Mark, Scale, Symbol};
pub use palette::{Ink, PALETTE, SHADES};
pub use pyramid::MinMaxPyramid;
pub use signals::{Columns, Signal, Signals};
pub use svg::svg;
