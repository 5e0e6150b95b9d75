//! Figures as files.

use std::path::{Path, PathBuf};

use egui::{Context, Id};
use tribo_figure::{Figure, csv, svg};

use crate::picture::{picture, write_png};
use crate::plot::{self, Look};

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

/// Size of an exported picture (px).
const PICTURE: [usize; 2] = [1120, 640];

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

/// Writes a figure into a directory, under its title.
///
/// # Errors
/// What could not be written, as a sentence.
pub fn write(directory: &Path, Request { figure, format }: &Request, dark: bool) -> Result<PathBuf, String> {
    let path = directory.join(format!("{}.{}", file_stem(&figure.title), format.name().to_lowercase()));
    let told = |error: std::io::Error| format!("{}: {error}", path.display());
    std::fs::create_dir_all(directory).map_err(told)?;
    match format {
        Format::Svg => std::fs::write(&path, svg(figure)).map_err(told)?,
        Format::Csv => std::fs::write(&path, csv(figure)).map_err(told)?,
        Format::Png => {
            let look = Look { height: PICTURE[1] as f32 - 60.0, ..Look::default() };
            let drawn = picture(PICTURE, dark, |ui| plot::show(ui, figure, look));
            write_png(&path, &drawn).map_err(|error| error.to_string())?;
        }
    }
    Ok(path)
}

/// `Cost of every trial` → `cost-of-every-trial`.
fn file_stem(title: &str) -> String {
    let letters = title.chars().map(|letter| if letter.is_alphanumeric() { letter.to_ascii_lowercase() } else { ' ' });
    let words = letters.collect::<String>();
    words.split_whitespace().collect::<Vec<_>>().join("-")
}
