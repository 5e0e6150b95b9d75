//! Joint-space motions (`schema: tribo.trajectory/1`).

use tribo_model::{TrajectoryFile, to_yaml};
use tribo_robot::presets;
use tribo_sim::excitation::JointTrajectory;

use super::document::{document, names_the_input, written};

/// A motion is refused with its point, or is within the limits of the Panda wherever it is looked at.
pub fn check(input: &[u8]) {
    let Some(document) = document(input) else { return };
    let file = match document.parse::<TrajectoryFile>() {
        Ok(file) => file,
        Err(error) => return names_the_input(&error),
    };
    let arm = presets::panda();
    match file.validate(&arm) {
        Ok(points) => {
            let text = to_yaml(&file).expect("a motion can be written");
            assert_eq!(written(&text).parse::<TrajectoryFile>().expect("and is read"), file, "{text}");
            let end_s = points.time_s.last().copied().unwrap_or_default();
            let path = points.path();
            for k in 0..=16 {
                let state = path.at(end_s * f64::from(k) / 16.0);
                // The polynomial of a move rounds.
                let within = (0..7).all(|j| {
                    let (low, high) = (arm.limits.q_min_rad[j], arm.limits.q_max_rad[j]);
                    (low - 1e-9..=high + 1e-9).contains(&state.q[j])
                });
                assert!(within && state.qd.iter().all(|qd| qd.is_finite()), "{:?}", state.q);
            }
        }
        Err(error) => names_the_input(&document.explain(error)),
    }
}
