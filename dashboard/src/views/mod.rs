//! One file per view; each shows a snapshot and keeps no more than what the user has chosen in it.

mod arm;
mod campaign;
mod compare;
mod diagnosis;
mod log;
mod memo;
mod start;
mod trial;

pub use arm::ArmView;
pub use campaign::CampaignView;
pub use compare::CompareView;
pub use diagnosis::DiagnosisView;
pub use log::{LogView, channels};
pub use start::StartView;
pub use trial::TrialView;

use egui::{RichText, Ui};

/// A view that has nothing to show yet, and what to do about it.
fn empty(ui: &mut Ui, what: &str, todo: &str) {
    ui.add_space(60.0);
    ui.vertical_centered(|ui| {
        ui.heading(what);
        ui.add_space(6.0);
        ui.label(todo);
    });
}

/// A row to choose a joint from.
fn joint_row(ui: &mut Ui, joint: &mut usize) {
    ui.label("Joint");
    for j in 0..7 {
        ui.selectable_value(joint, j, RichText::new(format!("{j}")));
    }
}
