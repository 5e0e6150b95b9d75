//! What the wrench filter reports is the wrench by the robot on the environment, plus the friction that was not
//! compensated: `h_hat = h + J̄ᵀ (tau_f − tau_f_hat)`, `J̄ᵀ = Λ J B⁻¹`.
//!
//! The arm follows a prescribed fast motion; recursive Newton–Euler says which motor torque that takes against a known
//! contact and friction; the filter sees exact joint states and that torque. Every sign of the known input is in this
//! story: gravity and Coriolis, motor torque, friction believed, J̇ qd.
//!
//! Tolerance 0.5 N / 0.07 Nm. Noise-free, so what is left (measured up to 0.33 N / 0.052 Nm) is of first order in the
//! period: the filter's model terms are those of the period's end (0.2 N at 1 rad/s), and its 20 ms delay behind a lever
//! that turns. The smallest effect in the story, J̇ qd, makes several newtons.

use nalgebra::{SVector, Vector6};
use tribo_ekf::{KnownInput, WrenchEkf, WrenchEkfSettings};
use tribo_robot::{ControlTerms, EstimatorInput, SensorFrame, WrenchEstimator, presets, rnea};
use tribo_tests::{DT_S, Joints};

const TICKS: usize = 3000;
/// Ticks until the start is forgotten.
const BURN_IN: usize = 500;

/// Fast, so that J̇ qd and C qd matter: ±0.3 rad at 0.6 Hz, speeds to 1.1 rad/s. Position, velocity, acceleration.
fn motion(time_s: f64) -> [Joints; 3] {
    let omega = 2.0 * std::f64::consts::PI * 0.6;
    let wave = |f: fn(f64) -> f64, scale: f64| Joints::from_fn(|j, _| 0.3 * scale * f(omega * time_s + j as f64));
    [presets::panda_ready_pose() + wave(f64::sin, 1.0), wave(f64::cos, omega), wave(f64::sin, -omega * omega)]
}

/// Largest `|h_hat − (h + J̄ᵀ (tau_f − tau_f_hat))|` [Nm; N] after the burn-in.
fn worst_error(known_input: KnownInput, contact: &Vector6<f64>, friction: &Joints, believed: &Joints) -> Vector6<f64> {
    let arm = presets::panda();
    let mut ekf = WrenchEkf::new(WrenchEkfSettings { known_input, ..WrenchEkfSettings::default() });
    let terms_at = |time_s: f64| {
        let [q, qd, _] = motion(time_s);
        (SensorFrame { time_s, q, qd, tau: Joints::zeros(), theta: None }, ControlTerms::at(&arm, &q, &qd))
    };
    let (frame, terms) = terms_at(0.0);
    WrenchEstimator::<7>::reset(&mut ekf, &frame, &terms);
    let mut worst = Vector6::zeros();
    for tick in 1..=TICKS {
        // The torque of a period is that of its middle; the filter learns of it at the end.
        let [q, qd, qdd] = motion((tick as f64 - 0.5) * DT_S);
        let middle = ControlTerms::at(&arm, &q, &qd);
        let tau_motor = rnea(&arm, &q, &qd, &qdd) + middle.jacobian.transpose() * contact + friction;
        let (frame, terms) = terms_at(tick as f64 * DT_S);
        // The acceleration that the tool would have without contact or friction left over.
        let b_inverse = middle.mass_matrix.try_inverse().expect("a regular mass matrix");
        let left_over = middle.jacobian.transpose() * contact + friction - believed;
        let acceleration = middle.jacobian * (qdd + b_inverse * left_over) + middle.jdot_qd;
        let estimate = ekf.step(&EstimatorInput {
            frame: &frame,
            terms: &terms,
            tau_motor: &tau_motor,
            tau_friction: believed,
            acceleration_command: &acceleration,
            dt_s: DT_S,
        });
        let lambda = (middle.jacobian * b_inverse * middle.jacobian.transpose()).try_inverse().expect("regular");
        let expected = contact + lambda * middle.jacobian * b_inverse * (friction - believed);
        if tick >= BURN_IN {
            worst = worst.sup(&(estimate.wrench_base.to_vector() - expected).abs());
        }
    }
    worst
}

#[test]
fn the_filter_reports_contact_and_uncompensated_friction() {
    let contact = Vector6::new(1.0, -0.7, 0.5, 8.0, -6.0, 10.0);
    let friction = SVector::from([1.5, -1.0, 0.8, 1.2, -0.5, 0.4, 0.3]);
    for known_input in [KnownInput::AppliedTorque, KnownInput::CommandedAcceleration] {
        for (name, contact, friction, believed) in [
            ("free", Vector6::zeros(), Joints::zeros(), Joints::zeros()),
            ("contact", contact, Joints::zeros(), Joints::zeros()),
            ("friction", Vector6::zeros(), friction, Joints::zeros()),
            ("friction believed", Vector6::zeros(), friction, friction),
            ("over-compensated contact", contact, friction, friction * 2.0),
        ] {
            let worst = worst_error(known_input, &contact, &friction, &believed);
            let (moment, force) = (worst.fixed_rows::<3>(0).max(), worst.fixed_rows::<3>(3).max());
            println!("{known_input:?} {name}: off by at most {force:.4} N, {moment:.4} Nm");
            assert!(force < 0.5 && moment < 0.07, "{known_input:?} {name}: {force} N {moment} Nm");
        }
    }
}
