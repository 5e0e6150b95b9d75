//! What a better model is worth in the loop.

use rayon::prelude::*;
use serde_json::{Value, json};
use tribo_control::{ImpedanceSettings, PAPER_PHASES_RAD, ReferenceModel, SinusoidReference};
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_friction::{JointEffects, VelocitySource};
use tribo_model::{ControllerModel, Model, not_cancelled_sentences};
use tribo_robot::Kinematics;
use tribo_sim::{DEFAULT_SUB_STEPS, Sensors, WrenchPulses};

use crate::{AbortReason, CostMeasure, PenaltyLimits, Trial, TrialOutcome, run_trial_observed};

/// The same trial on a plant that obeys the extended model, with a controller that believes the nominal model (before)
/// and one that believes the extended (after).
///
/// Tracking is against the motion that the impedance would make without disturbance, so that the lag the impedance is
/// meant to have counts for nothing; RMS over the judged part, of the true flange.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedLoopGain {
    /// J of roveda2022, penalty included, with the nominal model [N + Nm].
    pub cost_before: f64,
    /// The same with the extended model.
    pub cost_after: f64,
    /// RMS position error with the nominal model (mm).
    pub tracking_rms_mm_before: f64,
    /// The same with the extended model.
    pub tracking_rms_mm_after: f64,
    /// RMS orientation error with the nominal model (mrad).
    pub tracking_rms_mrad_before: f64,
    /// The same with the extended model.
    pub tracking_rms_mrad_after: f64,
    /// Why the trial with the nominal model was stopped, if it was.
    pub aborted_before: Option<AbortReason>,
    /// The same with the extended model.
    pub aborted_after: Option<AbortReason>,
    /// Effects of the extended model that the controller cannot cancel, one sentence each.
    pub not_cancelled: Vec<String>,
}

impl ClosedLoopGain {
    /// The gain as an entry of `tribo.diagnosis/1`.
    pub fn to_json(&self) -> Value {
        json!({
            "cost_before": self.cost_before,
            "cost_after": self.cost_after,
            "tracking_rms_mm_before": self.tracking_rms_mm_before,
            "tracking_rms_mm_after": self.tracking_rms_mm_after,
            "tracking_rms_mrad_before": self.tracking_rms_mrad_before,
            "tracking_rms_mrad_after": self.tracking_rms_mrad_after,
            "reason_before": self.aborted_before,
            "reason_after": self.aborted_after,
        })
    }
}

/// Runs both trials: the paper's reference at the ready pose, hybrid velocity, default gains, sensors and limits.
/// `seed` feeds the sensor noise of both.
///
/// A link-side model says nothing of motors; the plant and both controllers get the robot's rotor inertia.
pub fn closed_loop_gain<const N: usize>(nominal: &Model<N>, extended: &Model<N>, seed: u64) -> ClosedLoopGain {
    let (before, after) = (ControllerModel::by_controller(nominal), ControllerModel::by_controller(extended));
    let runs: Vec<Run<N>> =
        [&before, &after].par_iter().map(|controller_model| run(controller_model, extended, seed)).collect();
    ClosedLoopGain {
        cost_before: runs[0].outcome.cost.total(),
        cost_after: runs[1].outcome.cost.total(),
        tracking_rms_mm_before: runs[0].rms_mm,
        tracking_rms_mm_after: runs[1].rms_mm,
        tracking_rms_mrad_before: runs[0].rms_mrad,
        tracking_rms_mrad_after: runs[1].rms_mrad,
        aborted_before: runs[0].outcome.aborted,
        aborted_after: runs[1].outcome.aborted,
        not_cancelled: not_cancelled_sentences(&after.not_cancelled, &after.arm.joint_names),
    }
}

/// One trial.
struct Run<const N: usize> {
    outcome: TrialOutcome<N>,
    rms_mm: f64,
    rms_mrad: f64,
}

fn run<const N: usize>(controller_model: &ControllerModel<N>, truth: &Model<N>, seed: u64) -> Run<N> {
    let start = truth.robot.poses_rad[0];
    let centre = Kinematics::at(&controller_model.arm, &start).base_from_flange();
    let trial = Trial {
        truth: truth.to_truth(),
        sensors: Sensors::default(),
        sub_steps: DEFAULT_SUB_STEPS,
        pulses: WrenchPulses::default(),
        model: controller_model.arm.clone(),
        gears_nm_per_rad: controller_model.joint_stiffness_nm_per_rad(),
        effects: [JointEffects::default(); N],
        start,
        impedance: ImpedanceSettings::default(),
        reference: SinusoidReference::paper(centre, PAPER_PHASES_RAD).scaled(truth.robot.path_times_panda()),
        velocity: VelocitySource::Hybrid,
        guard: None,
        limits: PenaltyLimits::default(),
        measure: CostMeasure::Paper,
        stopped_at_s: None,
        dt_s: 1e-3,
    }
    .with_controller_model(controller_model);
    let mut ideal = ReferenceModel::at_rest(&trial.reference.at(0.0));
    let (mut sum_m2, mut sum_rad2, mut count) = (0.0, 0.0, 0_u64);
    let estimator = WrenchEkf::new(WrenchEkfSettings::default());
    let outcome = run_trial_observed(&trial, &controller_model.friction, estimator, seed, |record, plant| {
        // The plant has moved on by one period, and so does the ideal.
        ideal.step(&trial.impedance, &record.reference, trial.dt_s);
        if record.frame.time_s >= trial.reference.pre_roll_s() {
            let pose = Kinematics::at(&trial.truth.arm, plant.q()).base_from_flange();
            let difference = ideal.pose().inverse() * pose;
            sum_m2 += difference.translation.vector.norm_squared();
            sum_rad2 += difference.rotation.angle().powi(2);
            count += 1;
        }
    });
    let rms = |sum: f64| 1e3 * (sum / count.max(1) as f64).sqrt();
    Run { outcome, rms_mm: rms(sum_m2), rms_mrad: rms(sum_rad2) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_sim::{Effect, TorqueSide};

    /// A better model is cheaper and tracks better, on either side of the gears; no news changes nothing.
    #[test]
    fn the_true_model_gains_and_the_same_model_does_not() {
        for side in [TorqueSide::Motor, TorqueSide::Link] {
            let nominal = Model::panda(side);
            let effects = vec![
                Effect::Payload { mass_kg: 0.5, com_m: [0.0, 0.0, 0.05], inertia_kg_m2: [0.0; 6] },
                Effect::Coulomb { joint: 3, delta_coulomb_nm: 0.5 },
                Effect::LoadFriction { joint: 1, load_coefficient: 0.02 },
                Effect::TorqueRipple { joint: 5, cycles_per_rev: 20.0, amplitude_nm: 0.2, phase_rad: 0.3 },
                Effect::Presliding { joint: 3, presliding_distance_rad: 2e-3, amplitude_nm: None },
                Effect::Backlash { joint: 6, half_gap_rad: 0.0 },
            ];
            let extended = Model { effects, ..nominal.clone() };
            let gain = closed_loop_gain(&nominal, &extended, 1);
            println!("{gain:?}");
            assert!(gain.cost_after < 0.4 * gain.cost_before);
            assert!(gain.tracking_rms_mm_after < 0.4 * gain.tracking_rms_mm_before);
            assert!(gain.tracking_rms_mrad_after < gain.tracking_rms_mrad_before);
            assert_eq!(gain.not_cancelled.len(), 1);
            let same = closed_loop_gain(&nominal, &nominal, 1);
            assert_eq!(same.cost_before, same.cost_after);
        }
    }
}
