//! Pictures of a user interface, drawn in memory.

use std::io::BufWriter;
use std::path::Path;

use egui::{ColorImage, Context, Pos2, RawInput, Rect, Theme, vec2};

use crate::raster::Raster;
use crate::theme;

/// Frames until a window shows what it will show: sizes are known after one, scroll bars after two, and what one frame asks
/// for comes with the next, four times over.
const FRAMES: usize = 6;
/// Time between two of them (s), past the animations.
const FRAME_S: f64 = 0.5;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file cannot be written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: std::path::PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The picture cannot be encoded.
    #[error("PNG: {0}")]
    Png(#[from] png::EncodingError),
}

/// Runs an interface for a few frames of `size` (px) and draws the last. The same interface gives the same pixels.
pub fn picture(size: [usize; 2], dark: bool, mut ui: impl FnMut(&mut egui::Ui)) -> ColorImage {
    let ctx = Context::default();
    theme::install(&ctx);
    ctx.set_theme(if dark { Theme::Dark } else { Theme::Light });
    let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, vec2(size[0] as f32, size[1] as f32)));
    let mut raster = Raster::default();
    let mut drawn = ColorImage::filled(size, egui::Color32::BLACK);
    for frame in 0..FRAMES {
        let time = Some(frame as f64 * FRAME_S);
        let output = ctx.run_ui(RawInput { screen_rect, time, ..RawInput::default() }, &mut ui);
        raster.update(&output.textures_delta);
        if frame + 1 == FRAMES {
            let primitives = ctx.tessellate(output.shapes, output.pixels_per_point);
            let paper = ctx.global_style().visuals.panel_fill;
            drawn = raster.draw(&primitives, size, output.pixels_per_point, paper);
        }
    }
    drawn
}

/// Writes a picture as PNG.
pub fn write_png(path: &Path, picture: &ColorImage) -> Result<(), PictureError> {
    let io = |source| PictureError::Io { path: path.to_owned(), source };
    let file = std::fs::File::create(path).map_err(io)?;
    let [width, height] = picture.size.map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    let mut encoder = png::Encoder::new(BufWriter::new(file), width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let bytes: Vec<u8> = picture.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(())
}
