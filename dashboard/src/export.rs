//! Figures as files.

use std::path::{Path, PathBuf};

use tribo_figure::{csv, svg};

use crate::export_request::{Format, Request};
use crate::picture::{picture, write_png};
use crate::plot::{self, Look};

/// Size of an exported picture (px).
const PICTURE: [usize; 2] = [1120, 640];

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
