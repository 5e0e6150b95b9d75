//! Keys and gestures.

use egui::{Align2, Context, Grid, RichText, Window};

const KEYS: [(&str, &str); 12] = [
    ("1 … 7", "Campaign, Trial, Arm, Log, Diagnosis, Compare, Live"),
    ("Left, Right", "previous and next trial"),
    ("Space", "play and pause the arm"),
    ("T", "light or dark"),
    ("F1, ?", "this help; Esc closes it"),
    ("drag in a figure", "move it; figures of one time axis move together"),
    ("Ctrl + wheel", "zoom; Shift + wheel or drag on an axis: one axis"),
    ("right button + drag", "zoom into a rectangle"),
    ("double click", "all of it again"),
    ("pointer on a curve", "its values; a failed trial tells its reason"),
    ("name in a legend", "hide and show a curve"),
    ("drop on the window", "open a campaign directory or a log; tune a robot (URDF, MJCF)"),
];

/// The overlay.
pub fn show(ctx: &Context, open: &mut bool) {
    let window = Window::new("Keys and gestures").open(open).collapsible(false).resizable(false);
    window.anchor(Align2::CENTER_CENTER, [0.0, 0.0]).show(ctx, |ui| {
        Grid::new("keys").num_columns(2).spacing([24.0, 8.0]).show(ui, |ui| {
            for (key, what) in KEYS {
                ui.label(RichText::new(key).strong());
                ui.label(what);
                ui.end_row();
            }
        });
    });
}
