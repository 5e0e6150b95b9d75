//! A wrench estimator of your own beside two of Tribo's, on the same samples.
//!
//! `cargo run --release -p tribo-residual --example own_estimator`
//!
//! Yours implements [`WrenchEstimator`]; the loop, the logs and the tuning cost take any that does. This one inverts the Jacobian at rest,
//! as many a controller's first attempt does, and believes that there is no friction.

use nalgebra::{Matrix6, SVector, Vector6};
use tribo_friction::{FrictionBand, JointBand};
use tribo_residual::{MomentumEstimator, MomentumSettings, QpEstimator, QpSettings, diagonal_prior};
use tribo_robot::{ControlTerms, EstimatorInput, SensorFrame, Wrench, WrenchEstimate, WrenchEstimator, presets};

/// `h = (J Jᵀ)⁻¹ J (tau_motor − g)`, for an arm at rest, with the covariance of a torque noise of 0.1 Nm.
struct AtRest;

impl<const N: usize> WrenchEstimator<N> for AtRest {
    fn reset(&mut self, _frame: &SensorFrame<N>, _terms: &ControlTerms<N>) {}

    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate {
        let jacobian = &input.terms.jacobian;
        let Some(inverse) = (jacobian * jacobian.transpose()).try_inverse() else {
            return WrenchEstimate::none_yet();
        };
        let h = inverse * (jacobian * (input.tau_motor - input.terms.gravity_nm));
        let covariance: Matrix6<f64> = inverse * 0.01;
        WrenchEstimate { wrench_base: Wrench::from_vector(&h), covariance, ..WrenchEstimate::none_yet() }
    }

    fn delay_s(&self) -> f64 {
        0.0
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A standing Panda is pushed by −12 N along z; its motors send weight and reaction, and friction of up to 0.6 Nm hides some of it.
    let (arm, q) = (presets::panda(), presets::panda_ready_pose());
    let frame = SensorFrame { time_s: 0.0, q, qd: q * 0.0, tau: q * 0.0, theta: None };
    let terms = ControlTerms::at(&arm, &q, &frame.qd);
    let pushed = Wrench::from_force_moment(&[0.0, 0.0, -12.0, 0.0, 0.0, 0.0]);
    let hidden_nm = SVector::from([0.3, -0.3, 0.2, 0.4, 0.1, -0.1, 0.0]);
    let tau_motor = terms.gravity_nm + terms.jacobian.transpose() * pushed.to_vector() + hidden_nm;

    let band = FrictionBand::new([JointBand::coulomb_viscous(0.6, 1.0, 3e-3, 0.1); 7])?;
    let qp = QpSettings { prior: diagonal_prior(15.0, 1.5), ..QpSettings::new(band) };
    let mut estimators: [(&str, Box<dyn WrenchEstimator<7>>); 3] = [
        ("at rest", Box::new(AtRest)),
        ("momentum", Box::new(MomentumEstimator::new(MomentumSettings::new(band)))),
        ("qp", Box::new(QpEstimator::new(qp))),
    ];
    println!("estimator   Fz N      95 % interval N       holds the truth, −12 N");
    for (name, estimator) in &mut estimators {
        estimator.reset(&frame, &terms);
        let mut estimate = WrenchEstimate::none_yet();
        for tick in 1..=1000 {
            let frame = SensorFrame { time_s: f64::from(tick) * 1e-3, ..frame };
            estimate = estimator.step(&EstimatorInput {
                frame: &frame,
                terms: &terms,
                tau_motor: &tau_motor,
                tau_friction: &SVector::zeros(),
                acceleration_command: &Vector6::zeros(),
                dt_s: 1e-3,
            });
        }
        let (limits, seen) = (estimate.interval95(), estimate.wrench_base.force_n.z);
        let (low, high) = (limits.lower.force_n.z, limits.upper.force_n.z);
        let holds = if limits.contain(&pushed)[5] { "yes" } else { "no" };
        println!("{name:9} {seen:8.2}   [{low:7.2}, {high:7.2}]   {holds}");
    }
    Ok(())
}
