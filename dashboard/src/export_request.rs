//! Figures that somebody wants as files.

use egui::{Context, Id};
use tribo_figure::Figure;

/// Formats of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Pixels.
    Png,
    /// Lines.
    Svg,
    /// Numbers.
    Csv,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 3] = [Self::Png, Self::Svg, Self::Csv];

    /// `PNG`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Svg => "SVG",
            Self::Csv => "CSV",
        }
    }
}

/// A figure that waits to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The figure.
    pub figure: Figure,
    /// Its format.
    pub format: Format,
}

fn waiting() -> Id {
    Id::unique("figures to be written")
}

/// Asks for a file; the views themselves write nothing.
pub fn request(ctx: &Context, figure: Figure, format: Format) {
    ctx.data_mut(|data| data.get_temp_mut_or_default::<Vec<Request>>(waiting()).push(Request { figure, format }));
}

/// What has been asked for since the last call.
pub fn take_requests(ctx: &Context) -> Vec<Request> {
    ctx.data_mut(|data| std::mem::take(data.get_temp_mut_or_default::<Vec<Request>>(waiting())))
}
