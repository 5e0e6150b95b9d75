//! One file per view; each shows a snapshot and keeps no more than what the user has chosen in it.

mod arm;
mod campaign;
mod compare;
mod compare_campaigns;
mod compare_estimators;
mod diagnosis;
mod live;
mod log;
mod memo;
mod signal_plot;
mod start;
mod trial;

pub use arm::ArmView;
pub use campaign::CampaignView;
pub use compare::CompareView;
pub use diagnosis::DiagnosisView;
pub use live::LiveView;
pub use log::{LogView, channels};
pub use start::StartView;
pub use trial::TrialView;

use egui::{RichText, Ui};
use tribo_trial::EstimatorName;

/// A view that has nothing to show yet, and what to do about it.
fn empty(ui: &mut Ui, what: &str, todo: &str) {
    ui.add_space(60.0);
    ui.vertical_centered(|ui| {
        ui.heading(what);
        ui.add_space(6.0);
        ui.label(todo);
    });
}

/// The name of an estimator as people read it.
fn estimator_name(name: EstimatorName) -> &'static str {
    match name {
        EstimatorName::Ekf => "Kalman filter",
        EstimatorName::Momentum => "momentum observer",
        EstimatorName::Qp => "friction-band programme",
        EstimatorName::Thermal => "thermal sensor",
        EstimatorName::DoubleEncoder => "two encoders",
    }
}

/// Its name on the command line and its law, in a sentence.
fn estimator_law(name: EstimatorName) -> String {
    let law = match name {
        EstimatorName::Ekf => "augmented-state extended Kalman filter",
        EstimatorName::Momentum => "generalised-momentum observer, joints weighted by their friction band",
        EstimatorName::Qp => "quadratic programme: a wrench and a friction inside its band explain the torque",
        EstimatorName::Thermal => "friction and temperature of every joint observed as one",
        EstimatorName::DoubleEncoder => "link torque from the twist of the gears, without friction",
    };
    format!("{}: {law}", name.as_str())
}

/// A row to choose one of so many joints from.
fn joint_row(ui: &mut Ui, joint: &mut usize, joints: usize) {
    // The choice may come from a robot with more of them.
    *joint = (*joint).min(joints.saturating_sub(1));
    ui.label("Joint");
    for j in 0..joints {
        ui.selectable_value(joint, j, RichText::new(format!("{j}")));
    }
}
