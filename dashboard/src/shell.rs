//! The window of the operating system.

use crate::app::{Dashboard, Options};

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
#[error("no window could be opened; without a display use `tribo report` or `tribo dashboard --screenshot`  ({0})")]
pub struct NoWindow(String);

struct Shell(Dashboard);

impl eframe::App for Shell {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.0.ui(ui);
    }
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// There is no display, or no OpenGL.
pub fn run(options: Options) -> Result<(), NoWindow> {
    let dashboard = Dashboard::new(options);
    let [width, height] = dashboard.layout().size.map(|side| side.clamp(640.0, 8000.0));
    let viewport = egui::ViewportBuilder::default()
        .with_title("Tribo")
        .with_app_id("tribo")
        .with_inner_size([width, height])
        .with_min_inner_size([900.0, 600.0]);
    let native = eframe::NativeOptions { viewport, ..eframe::NativeOptions::default() };
    eframe::run_native("Tribo", native, Box::new(|_| Ok(Box::new(Shell(dashboard)))))
        .map_err(|error| NoWindow(error.to_string()))
}
