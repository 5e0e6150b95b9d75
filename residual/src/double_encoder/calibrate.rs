//! From rests to a model.

use tribo_robot::{Arm, Kinematics};

use super::deflection_gp::DeflectionGp;
use super::model::input_row;
use super::stiffness_fit::{LoadSample, fit_stiffness};
use super::{CalibrationError, DoubleEncoderModel, Rests, StiffnessCurve, ValidDoubleEncoder};

/// Fewest rests without load: below, a length-scale per joint is guesswork.
pub const FEWEST_POSES: usize = 40;

/// Stiffness of every joint from the loaded rests, then its process from the free ones (uhlmann2023, section 3).
///
/// `arm` supplies the Jacobian and, for [`super::DeflectionMean::RigidBody`], gravity. `seed` feeds further starts of the
/// fits; the default fit has one start and does not depend on it.
///
/// # Errors
/// [`CalibrationError`], whichever is met first: too few rests or loads, loads without a lever, a stiffness that is not
/// positive.
pub fn calibrate<const N: usize>(
    arm: &Arm<N>,
    rests: &Rests<N>,
    settings: ValidDoubleEncoder,
    seed: u64,
) -> Result<DoubleEncoderModel<N>, CalibrationError> {
    if rests.free.len() < FEWEST_POSES {
        return Err(CalibrationError::TooFewPoses { need: FEWEST_POSES, got: rests.free.len() });
    }
    let mut curves = [StiffnessCurve::linear(1.0, 0.0); N];
    let mut loads: [Vec<LoadSample>; N] = std::array::from_fn(|_| Vec::with_capacity(rests.loaded.len()));
    for rest in &rests.loaded {
        let (free, loaded) = (&rest.free, &rest.loaded);
        let torque = Kinematics::at(arm, &loaded.q).jacobian().transpose() * rest.wrench_base.to_vector();
        for (j, loads) in loads.iter_mut().enumerate() {
            let (from, to) = (free.deflection_rad[j], loaded.deflection_rad[j]);
            loads.push(LoadSample {
                from_rad: if settings.preload { from } else { 0.0 },
                to_rad: if settings.preload { to } else { to - from },
                torque_nm: torque[j],
                direction_change: loaded.direction[j] - free.direction[j],
                loading_change: loaded.loading[j] - free.loading[j],
            });
        }
    }
    for j in 0..N {
        curves[j] = fit_stiffness(j, &loads[j], [settings.direction_input, settings.loading_input])?;
    }
    let rotor_inertia_kg_m2 = arm.rotor_inertia_kg_m2;
    let mut model =
        DoubleEncoderModel { settings, curves, processes: Vec::new(), misfit_nm2: [0.0; N], rotor_inertia_kg_m2 };
    let gravity: Vec<_> = rests.free.iter().map(|rest| Kinematics::at(arm, &rest.q).gravity_torque(arm)).collect();
    let mut processes = Vec::with_capacity(N);
    for j in 0..N {
        let rows: Vec<Vec<f64>> = rests.free.iter().map(|rest| input_row(&settings, j, rest)).collect();
        let mean = |k: usize| match settings.mean {
            super::DeflectionMean::Zero => 0.0,
            super::DeflectionMean::RigidBody => model.mean_rad(j, gravity[k][j]),
        };
        let targets: Vec<f64> =
            rests.free.iter().enumerate().map(|(k, rest)| rest.deflection_rad[j] - mean(k)).collect();
        let process = DeflectionGp::fit(&settings, &rows, &targets, seed)
            .map_err(|source| CalibrationError::Regression { joint: j, source })?;
        // A load is the difference of two rests, each of which repeats to σ_n.
        let repeat_nm = curves[j].slopes_nm_per_rad.mean() * process.noise_rad();
        model.misfit_nm2[j] = (curves[j].rms_nm.powi(2) - 2.0 * repeat_nm * repeat_nm).max(0.0);
        processes.push(process);
    }
    model.processes = processes;
    Ok(model)
}
