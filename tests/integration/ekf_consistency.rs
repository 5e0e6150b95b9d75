//! The wrench filter is honest: on data drawn from its own model its errors have the covariance it claims.
//!
//! Truth: the filter's model exactly — known input plus white acceleration noise, a random-walk wrench with the filter's
//! densities, encoder noise seen through J — along a moving arm. Everything that is signed enters through
//! [`WrenchEstimator::step`] (motor torque, friction believed, gravity, J̇ qd); the truth forms its acceleration by another
//! route (articulated bodies, ABA).
//!
//! Bounds: NEES of 18 and 6 degrees of freedom in [16, 20] and [5.5, 6.5] (the prototype); a sample every 50 ms (two delays of
//! the filter) over 16 seeds of 4 s makes about 1100 nearly independent ones, so the standard errors are 0.18 and 0.10.
//! NIS of a matched filter is white: 4 standard errors of a chi-square mean over all ticks.

use nalgebra::{Cholesky, Matrix6, Rotation3, SMatrix, SVector, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use tribo_ekf::{AugmentedCovariance, MeasurementNoise, WrenchEkf, WrenchEkfSettings};
use tribo_robot::{
    ControlTerms, EstimatorInput, Kinematics, Pose, SensorFrame, Twist, Wrench, WrenchEstimator, forward_dynamics,
    presets, so3,
};
use tribo_tests::{DT_S, Joints};

const SEEDS: u64 = 16;
const TICKS: usize = 4000;
/// Ticks until the start is forgotten.
const BURN_IN: usize = 500;
/// Ticks between two samples of the NEES.
const STRIDE: usize = 50;
/// Deviation of the true encoders (rad).
const ENCODER_SD_RAD: f64 = 1e-5;

/// The arm's motion: ±0.25 rad at 0.4 Hz on every joint, phases apart.
fn arm_state(time_s: f64) -> (Joints, Joints) {
    let omega = 2.0 * std::f64::consts::PI * 0.4;
    let wave = |f: fn(f64) -> f64, scale: f64| Joints::from_fn(|j, _| scale * f(omega * time_s + j as f64));
    (presets::panda_ready_pose() + wave(f64::sin, 0.25), wave(f64::cos, 0.25 * omega))
}

/// What really happens in the filter's own world.
struct World {
    rng: Pcg64,
    twist: Vector6<f64>,
    position: Vector3<f64>,
    rotation: SMatrix<f64, 3, 3>,
    wrench: Vector6<f64>,
}

impl World {
    /// Drawn from the filter's initial covariance about its initial estimate.
    fn around(ekf: &WrenchEkf, pose: &Pose, seed: u64) -> Self {
        let mut world = Self {
            rng: Pcg64::seed_from_u64(seed),
            twist: Vector6::zeros(),
            position: pose.translation.vector,
            rotation: *pose.rotation.matrix(),
            wrench: Vector6::zeros(),
        };
        let p = ekf.covariance();
        world.twist = world.normal(&p.vv.diagonal().map(f64::sqrt));
        world.wrench = world.normal(&p.hh.diagonal().map(f64::sqrt));
        let offset = world.normal(&p.xx.diagonal().map(f64::sqrt));
        world.displace(&offset);
        world
    }

    fn normal(&mut self, sd: &Vector6<f64>) -> Vector6<f64> {
        sd.map(|sd| sd * self.rng.sample::<f64, _>(StandardNormal))
    }

    fn displace(&mut self, motion: &Vector6<f64>) {
        self.rotation = so3::exp(&motion.fixed_rows::<3>(0).into_owned()) * self.rotation;
        self.position += motion.fixed_rows::<3>(3);
    }

    /// `v̇ = a + w_a`, `ẋ = v`, `ḣ = w_h` over one period.
    fn advance(&mut self, acceleration: &Vector6<f64>, s: &WrenchEkfSettings) {
        let (r, m) = (s.acceleration_noise_rad_s2, s.acceleration_noise_m_s2);
        let (moment, force) = (s.moment_walk_nm, s.force_walk_n);
        self.displace(&(self.twist * DT_S + acceleration * (0.5 * DT_S * DT_S)));
        let kick = self.normal(&(Vector6::new(r, r, r, m, m, m) * DT_S.sqrt()));
        let walk = self.normal(&(Vector6::new(moment, moment, moment, force, force, force) * DT_S.sqrt()));
        self.twist += acceleration * DT_S + kick;
        self.wrench += walk;
    }

    fn pose(&self) -> Pose {
        Pose::from_parts(self.position.into(), Rotation3::from_matrix_unchecked(self.rotation))
    }

    /// The pose as noisy encoders show it, `x ⊕ J n`.
    fn measured(&mut self, jacobian: &SMatrix<f64, 6, 7>) -> Pose {
        let n = Joints::from_fn(|_, _| ENCODER_SD_RAD * self.rng.sample::<f64, _>(StandardNormal));
        let shift = jacobian * n;
        let rotation = so3::exp(&shift.fixed_rows::<3>(0).into_owned()) * self.rotation;
        let position = self.position + shift.fixed_rows::<3>(3);
        Pose::from_parts(position.into(), Rotation3::from_matrix_unchecked(rotation))
    }
}

/// Means of what consistency is judged by.
#[derive(Clone, Copy, Debug)]
struct Evidence {
    nees: f64,
    nees_wrench: f64,
    nis: f64,
}

/// Mean evidence over all seeds of a filter with these settings in its own world (encoder noise is always the true one).
fn evidence(settings: WrenchEkfSettings) -> Evidence {
    let arm = presets::panda();
    let (mut nees, mut nees_wrench, mut nis, mut samples, mut updates) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for seed in 0..SEEDS {
        let mut ekf = WrenchEkf::new(settings);
        let frame_at = |time_s: f64| {
            let (q, qd) = arm_state(time_s);
            SensorFrame { time_s, q, qd, tau: Joints::zeros(), theta: None }
        };
        let start = frame_at(0.0);
        let terms = ControlTerms::at(&arm, &start.q, &start.qd);
        ekf.reset(&start, &terms);
        let mut world = World::around(&ekf, &terms.base_from_flange, seed);
        for tick in 1..=TICKS {
            let frame = frame_at(tick as f64 * DT_S);
            let mut terms = ControlTerms::at(&arm, &frame.q, &frame.qd);
            // The drive shakes the tool at several m/s² and some joints rub in a way that is known.
            let phase = |j: usize, hz: f64| 2.0 * std::f64::consts::PI * hz * frame.time_s + 2.0 * j as f64;
            let shake = Joints::from_fn(|j, _| 6.0 * phase(j, 1.7).sin());
            let tau_friction = Joints::from_fn(|j, _| 1.5 * phase(j, 0.6).cos());
            let tau_motor = terms.bias_nm() + terms.mass_matrix * shake + tau_friction;
            let contact = terms.jacobian.transpose() * world.wrench;
            let qdd = forward_dynamics(&arm, &frame.q, &frame.qd, &(tau_motor - tau_friction - contact));
            world.advance(&(terms.jacobian * qdd + terms.jdot_qd), &settings);
            terms.base_from_flange = world.measured(&terms.jacobian);
            ekf.step(&EstimatorInput {
                frame: &frame,
                terms: &terms,
                tau_motor: &tau_motor,
                tau_friction: &tau_friction,
                acceleration_command: &Vector6::zeros(),
                dt_s: DT_S,
            });
            if tick >= BURN_IN {
                nis += ekf.innovation().expect("an update").nis;
                updates += 1.0;
            }
            if tick >= BURN_IN && tick % STRIDE == 0 {
                let (twist, wrench) = (Twist::from_vector(&world.twist), Wrench::from_vector(&world.wrench));
                let e = ekf.error(&twist, &world.pose(), &wrench);
                let e_wrench: Vector6<f64> = e.fixed_rows::<6>(12).into_owned();
                let p = ekf.covariance();
                let whole = Cholesky::new(p.to_dense()).expect("a positive definite covariance");
                nees += e.dot(&whole.solve(&e));
                nees_wrench += e_wrench.dot(&Cholesky::new(p.hh).expect("positive definite").solve(&e_wrench));
                samples += 1.0;
            }
        }
    }
    Evidence { nees: nees / samples, nees_wrench: nees_wrench / samples, nis: nis / updates }
}

fn matched() -> WrenchEkfSettings {
    WrenchEkfSettings {
        measurement: MeasurementNoise::Encoder { sd_rad: ENCODER_SD_RAD },
        ..WrenchEkfSettings::default()
    }
}

#[test]
fn a_matched_filter_is_consistent() {
    let found = evidence(matched());
    println!("matched: {found:.3?}");
    assert!((16.0..=20.0).contains(&found.nees), "{found:?}");
    assert!((5.5..=6.5).contains(&found.nees_wrench), "{found:?}");
    let updates = SEEDS as f64 * (TICKS - BURN_IN) as f64;
    assert!((found.nis - 6.0).abs() < 4.0 * (12.0 / updates).sqrt(), "{found:?}");
}

/// Power check: a filter that takes its encoders to be twice as good as they are is found out by every statistic
/// (prototype: NEES 38.7 and 8.3).
#[test]
fn overconfidence_is_found_out() {
    let settings =
        WrenchEkfSettings { measurement: MeasurementNoise::Encoder { sd_rad: 0.5 * ENCODER_SD_RAD }, ..matched() };
    let found = evidence(settings);
    println!("encoders believed twice as good: {found:.3?}");
    assert!(found.nees > 24.0 && found.nees_wrench > 7.0 && found.nis > 9.0, "{found:?}");
}

type Dense = SMatrix<f64, 18, 18>;

/// Second algorithm: the covariance of 400 steps along the arm is that of the textbook's dense filter with the exact
/// transition `F = exp(A dt)`, `K = P Cᵀ S⁻¹`, `P ← (I − K C) P`. Tolerance 1e-7 of √(P_ii P_jj): the dense short form loses
/// digits where the filter's does not.
#[test]
fn the_covariance_is_the_textbooks() {
    let arm = presets::panda();
    let settings = matched();
    let mut ekf = WrenchEkf::new(settings);
    let mut p: Dense = ekf.covariance().to_dense();
    for tick in 1..=400 {
        let (q, qd) = arm_state(tick as f64 * DT_S);
        let terms = ControlTerms::at(&arm, &q, &qd);
        let j = terms.jacobian;
        let lambda_inverse: Matrix6<f64> = j * terms.mass_matrix.try_inverse().expect("regular") * j.transpose();
        let r = j * j.transpose() * (ENCODER_SD_RAD * ENCODER_SD_RAD);

        let mut a = Dense::zeros();
        a.fixed_view_mut::<6, 6>(0, 12).copy_from(&-lambda_inverse);
        a.fixed_view_mut::<6, 6>(6, 0).copy_from(&Matrix6::identity());
        let f = Dense::identity() + a * DT_S + a * a * (0.5 * DT_S * DT_S); // a³ = 0
        p = f * p * f.transpose();
        for i in 0..3 {
            p[(i, i)] += settings.acceleration_noise_rad_s2.powi(2) * DT_S;
            p[(3 + i, 3 + i)] += settings.acceleration_noise_m_s2.powi(2) * DT_S;
            p[(12 + i, 12 + i)] += settings.moment_walk_nm.powi(2) * DT_S;
            p[(15 + i, 15 + i)] += settings.force_walk_n.powi(2) * DT_S;
        }
        ekf.predict(&Vector6::zeros(), &lambda_inverse, DT_S);
        assert_close(ekf.covariance(), &p, tick);

        let s = p.fixed_view::<6, 6>(6, 6) + r;
        let k = p.fixed_columns::<6>(6) * s.try_inverse().expect("regular");
        let p_x = p.fixed_rows::<6>(6).into_owned();
        p -= k * p_x;
        p = (p + p.transpose()) * 0.5;
        assert!(ekf.update(&Kinematics::at(&arm, &q).base_from_flange(), &r));
        assert_close(ekf.covariance(), &p, tick);
    }
}

fn assert_close(covariance: &AugmentedCovariance, expected: &Dense, tick: usize) {
    let difference = covariance.to_dense() - expected;
    for r in 0..18 {
        for c in 0..18 {
            let scale = (expected[(r, r)] * expected[(c, c)]).sqrt();
            let relative = difference[(r, c)].abs() / scale;
            assert!(relative < 1e-7, "tick {tick}, element ({r}, {c}) is off by {relative:e}");
        }
    }
}

/// The error that the consistency test weighs has the sign and frame its doc says.
#[test]
fn the_reported_error_is_truth_less_estimate() {
    let mut ekf = WrenchEkf::new(matched());
    let turn = SVector::<f64, 3>::new(0.2, -0.5, 0.3);
    let pose = Pose::from_parts(Vector3::new(0.1, 0.2, 0.3).into(), Rotation3::from_matrix_unchecked(so3::exp(&turn)));
    let twist = Twist { angular_rad_s: Vector3::new(1.0, 2.0, 3.0), linear_m_s: Vector3::new(4.0, 5.0, 6.0) };
    let wrench = Wrench { moment_nm: Vector3::new(7.0, 8.0, 9.0), force_n: Vector3::new(10.0, 11.0, 12.0) };
    let e = ekf.error(&twist, &pose, &wrench);
    let expected = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.2, -0.5, 0.3, 0.1, 0.2, 0.3, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0];
    assert!((e - SVector::<f64, 18>::from(expected)).amax() < 1e-12);
    // And the innovation of a filter at the origin is that same difference.
    assert!(ekf.update(&pose, &(Matrix6::identity() * 1e-10)));
    let innovation = ekf.innovation().expect("an update").innovation;
    assert!((innovation - e.fixed_rows::<6>(6)).amax() < 1e-12);
}
