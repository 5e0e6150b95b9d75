//! Colours and spacing of everything that is drawn.

use egui::{Color32, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Theme, Visuals};
use tribo_figure::SHADES;

/// Space between figures (px).
pub const GAP: f32 = 10.0;
/// Narrowest figure that is readable (px).
pub const NARROWEST: f32 = 400.0;
/// Height of a figure (px).
pub const FIGURE_HEIGHT: f32 = 224.0;

/// Colour `ink` of the palette, in the shade that reads on this background.
pub fn ink(ink: usize, dark: bool) -> Color32 {
    let [red, green, blue] = SHADES[usize::from(dark)][ink % 8];
    Color32::from_rgb(red, green, blue)
}

/// Lines behind the data.
pub fn grid(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(0x2e, 0x34, 0x3b) } else { Color32::from_rgb(0xe2, 0xe5, 0xe9) }
}

/// Text of what went wrong.
pub fn bad(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(0xff, 0x8f, 0x52) } else { Color32::from_rgb(0xa8, 0x3f, 0x00) }
}

/// Text of what went well.
pub fn good(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(0x4f, 0xd1, 0xa5) } else { Color32::from_rgb(0x00, 0x69, 0x4d) }
}

/// The look of both themes: paper of the report, quiet frames, text that is never below 12 px.
pub fn install(ctx: &egui::Context) {
    for (theme, mut visuals) in [(Theme::Light, Visuals::light()), (Theme::Dark, Visuals::dark())] {
        let dark = theme == Theme::Dark;
        let [page, card, text, soft, line] = if dark {
            [0x15_181c, 0x1d_2126, 0xe8_eaed, 0xb4_bbc3, 0x36_3c44]
        } else {
            [0xff_ffff, 0xf6_f7f9, 0x1c_1f23, 0x50_575f, 0xd9_dde2]
        };
        visuals.panel_fill = rgb(page);
        visuals.window_fill = rgb(page);
        visuals.extreme_bg_color = rgb(if dark { 0x10_1316 } else { 0xff_ffff });
        visuals.faint_bg_color = rgb(card);
        visuals.text_edit_bg_color = Some(rgb(card));
        visuals.widgets.inactive.bg_stroke = Stroke::new(1.0, rgb(line));
        visuals.widgets.noninteractive.fg_stroke = Stroke::new(1.0, rgb(text));
        visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, rgb(line));
        visuals.widgets.inactive.fg_stroke = Stroke::new(1.0, rgb(text));
        visuals.weak_text_color = Some(rgb(soft));
        visuals.selection.bg_fill = ink(0, false);
        visuals.selection.stroke = Stroke::new(1.0, Color32::WHITE);
        visuals.hyperlink_color = ink(0, dark);
        visuals.window_corner_radius = CornerRadius::same(8);
        ctx.set_visuals_of(theme, visuals);
    }
    ctx.all_styles_mut(|style| {
        style.spacing.item_spacing = egui::vec2(8.0, 6.0);
        style.spacing.button_padding = egui::vec2(8.0, 4.0);
        for (text, size) in
            [(TextStyle::Small, 12.0), (TextStyle::Body, 14.0), (TextStyle::Button, 14.0), (TextStyle::Heading, 19.0)]
        {
            style.text_styles.insert(text, FontId::new(size, FontFamily::Proportional));
        }
    });
}

fn rgb(hex: u32) -> Color32 {
    let [_, red, green, blue] = hex.to_be_bytes();
    Color32::from_rgb(red, green, blue)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance and contrast of WCAG 2.2.
    fn contrast(a: Color32, b: Color32) -> f64 {
        let luminance = |colour: Color32| -> f64 {
            let linear = |value: u8| {
                let share = f64::from(value) / 255.0;
                if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
            };
            0.2126 * linear(colour.r()) + 0.7152 * linear(colour.g()) + 0.0722 * linear(colour.b())
        };
        let (high, low) = (luminance(a).max(luminance(b)), luminance(a).min(luminance(b)));
        (high + 0.05) / (low + 0.05)
    }

    #[test]
    fn text_reads_on_its_paper() {
        let ctx = egui::Context::default();
        install(&ctx);
        for theme in [Theme::Light, Theme::Dark] {
            let (visuals, dark) = (ctx.style_of(theme).visuals.clone(), theme == Theme::Dark);
            for text in [visuals.text_color(), visuals.weak_text_color(), bad(dark), good(dark)] {
                assert!(contrast(text, visuals.panel_fill) >= 4.5, "{theme:?} {text:?}");
                assert!(contrast(text, visuals.faint_bg_color) >= 4.5, "{theme:?} {text:?}");
            }
        }
    }
}
