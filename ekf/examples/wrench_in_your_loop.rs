//! The wrench EKF inside a control loop of your own: who pushes the tool, and how sure is the filter?
//!
//! `cargo run --release -p tribo-ekf --example wrench_in_your_loop`
//!
//! The robot is a stand-in: an arm without friction that carries itself, pushed by 10 N along x for half a second. A robot of yours gives
//! `q`, `qd` and the torque that was sent. Whatever friction its controller does not compensate is part of the estimate.

use nalgebra::{SVector, Vector6};
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_robot::{ControlTerms, EstimatorInput, SensorFrame, Wrench, WrenchEstimator, forward_dynamics, presets};

/// Control period (s).
const DT_S: f64 = 1e-3;

fn main() {
    let (arm, mut q) = (presets::panda(), presets::panda_ready_pose());
    let mut qd = SVector::<f64, 7>::zeros();
    let mut ekf = WrenchEkf::new(WrenchEkfSettings::default());
    println!("time s   true Fx N   estimate N   ± 95 % N");
    for tick in 0..1200 {
        let time_s = f64::from(tick) * DT_S;
        let frame = SensorFrame { time_s, q, qd, tau: SVector::zeros(), theta: None };
        let terms = ControlTerms::at(&arm, &q, &qd);

        // What the controller sends: the arm's weight, and damping. No friction is compensated, since there is none.
        let tau_motor = terms.bias_nm() - qd * 5.0;
        let sample = EstimatorInput {
            frame: &frame,
            terms: &terms,
            tau_motor: &tau_motor,
            tau_friction: &SVector::zeros(),
            acceleration_command: &Vector6::zeros(),
            dt_s: DT_S,
        };
        let pushed_n = if (0.3..0.8).contains(&time_s) { 10.0 } else { 0.0 };
        if tick == 0 {
            WrenchEstimator::<7>::reset(&mut ekf, &frame, &terms);
        } else {
            let estimate = ekf.step(&sample);
            if tick % 200 == 150 {
                let (limits, seen_n) = (estimate.interval95(), estimate.wrench_base.force_n.x);
                let half_width_n = limits.upper.force_n.x - seen_n;
                println!("{time_s:6.2}   {pushed_n:9.2}   {seen_n:10.2}   {half_width_n:8.2}");
            }
        }

        // The robot: h is what the arm exerts on the world.
        let h = Wrench::from_force_moment(&[pushed_n, 0.0, 0.0, 0.0, 0.0, 0.0]).to_vector();
        let qdd = forward_dynamics(&arm, &q, &qd, &(tau_motor - terms.jacobian.transpose() * h));
        qd += qdd * DT_S;
        q += qd * DT_S;
    }
    println!("delay {:.0} ms", WrenchEstimator::<7>::delay_s(&ekf) * 1e3);
}
