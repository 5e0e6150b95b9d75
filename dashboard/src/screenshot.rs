//! The window as a picture, without a window.

use std::path::Path;

use crate::app::{Dashboard, Options};
use crate::picture::{PictureError, picture, write_png};
use crate::view::View;

/// Draws a view of `options.open` and writes it as PNG. All work is done at once, so the same input gives the same pixels.
///
/// # Errors
/// The file cannot be written.
pub fn screenshot(mut options: Options, size: [usize; 2], dark: bool, out: &Path) -> Result<(), PictureError> {
    (options.immediate, options.layout) = (true, None);
    let diagnose = options.view == Some(View::Diagnosis);
    let mut dashboard = Dashboard::new(options);
    let drawn = picture(size, dark, |ui| {
        dashboard.ui(ui);
        dashboard.prepare(ui.ctx(), diagnose);
    });
    write_png(out, &drawn)
}
