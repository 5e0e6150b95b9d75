//! The simulated plant keeps the promises of velocity-level box friction (moreau1988): it sticks truly, it dissipates,
//! and its answer does not depend on the step length.
//!
//! Tolerances: the bars of the prototype (J within 0.2 % from 1 to 50 sub-steps, |qd| < 1e-9 rad/s in stick),
//! rounding where the scheme is exact (impulse balance), first order in the period where it is not (energy).

use nalgebra::{Matrix3, SVector, Vector3};
use tribo_friction::law::{Asymmetric, CoulombViscous};
use tribo_friction::{FrictionModel, JointFriction, VelocitySource};
use tribo_robot::{
    Arm, JointNames, JointPlacement, Kinematics, Limits, LinkInertia, Mechanism, ModifiedDh, Plant, Wrench,
    gravity_torque, presets, rnea,
};
use tribo_sim::{BoxFrictionPlant, Pulse, Sensors, TorqueSide, Truth, WrenchPulses};
use tribo_tests::{Joints, default_ekf, no_friction, tuning_trial};
use tribo_trial::run_trial;

use crate::dynamics_identities::energy;

/// Directional friction on every joint: 0.6 Nm forwards, 0.4 Nm backwards.
fn asymmetric_truth() -> Truth<7> {
    let law = Asymmetric {
        coulomb_positive_nm: 0.6,
        coulomb_negative_nm: 0.4,
        viscous_positive_nm_s_per_rad: 1.0,
        viscous_negative_nm_s_per_rad: 1.5,
    };
    Truth { friction: FrictionModel::uniform(law.into()), ..Truth::panda_frictionless() }
}

/// The set of torques (Nm) that a joint at rest balances.
fn stick_interval(law: &JointFriction) -> (f64, f64) {
    let at_rest = law.set_valued(0.0);
    (at_rest.lower_nm, at_rest.upper_nm)
}

/// Largest joint speed [rad/s] over 200 periods under gravity compensation plus `extra` (Nm).
fn fastest_under(truth: &Truth<7>, extra: &Joints, sub_steps: usize) -> f64 {
    let q = presets::panda_ready_pose();
    let mut plant = BoxFrictionPlant::new(truth.clone(), Sensors::noise_free(), q, 1).with_sub_steps(sub_steps);
    let tau = gravity_torque(&truth.arm, &q) + extra;
    (0..200).fold(0.0_f64, |fastest, _| {
        plant.actuate(&tau);
        fastest.max(plant.qd().amax())
    })
}

/// Noise-free encoders, as for the prototype's table: encoder noise alone moves J by 2–3 % near the optimum.
#[test]
fn cost_does_not_depend_on_the_sub_steps() {
    let truth = Truth::panda_coulomb_viscous();
    let oracle = truth.friction;
    for (velocity, friction) in
        [(VelocitySource::Hybrid, oracle), (VelocitySource::Reference, oracle), (VelocitySource::Hybrid, no_friction())]
    {
        let cost = |sub_steps: usize| {
            let mut trial = tuning_trial(truth.clone(), velocity);
            trial.sensors = Sensors::noise_free();
            trial.sub_steps = sub_steps;
            run_trial(&trial, &friction, default_ekf(), 1).cost.total()
        };
        let costs = [1, 5, 50].map(cost);
        println!("{velocity:?}: J at 1/5/50 sub-steps {costs:.5?}");
        for j in costs {
            assert!((j / costs[2] - 1.0).abs() <= 2e-3, "{velocity:?} {costs:?}");
        }
    }
}

/// Just inside the stick interval nothing moves, one joint at a time or all at once; just outside it does.
#[test]
fn a_joint_inside_its_stick_interval_stays_put() {
    for truth in [Truth::panda_coulomb_viscous(), Truth::panda_stribeck(), asymmetric_truth()] {
        let intervals = truth.friction.joints.map(|law| stick_interval(&law));
        for sub_steps in [1, 5, 50] {
            for (j, (lower, upper)) in intervals.into_iter().enumerate() {
                for bound in [lower, upper] {
                    let push = |fraction: f64| {
                        let mut extra = Joints::zeros();
                        extra[j] = fraction * bound;
                        fastest_under(&truth, &extra, sub_steps)
                    };
                    assert!(push(0.99) < 1e-9, "joint {j} creeps at {:e} rad/s", push(0.99));
                    assert!(push(1.01) > 1e-6, "joint {j} is glued: {:e} rad/s", push(1.01));
                }
            }
            let all = |side: fn((f64, f64)) -> f64| Joints::from_fn(|j, _| 0.99 * side(intervals[j]));
            assert!(fastest_under(&truth, &all(|i| i.0), sub_steps) < 1e-9);
            assert!(fastest_under(&truth, &all(|i| i.1), sub_steps) < 1e-9);
        }
    }
}

/// The same truth with joints that turn without end: an inelastic stop would eat energy too.
fn without_stops(mut truth: Truth<7>) -> Truth<7> {
    truth.arm.limits.q_min_rad.fill(f64::NEG_INFINITY);
    truth.arm.limits.q_max_rad.fill(f64::INFINITY);
    truth
}

/// Energy drift [J] of the undriven frictionless arm thrown from the ready pose, over 0.4 s.
fn free_drift_j(dt_s: f64) -> f64 {
    let truth = without_stops(Truth::panda_frictionless());
    let mut plant = BoxFrictionPlant::new(truth.clone(), Sensors::noise_free(), presets::panda_ready_pose(), 1)
        .with_period(dt_s)
        .with_velocity(Joints::repeat(0.3));
    let before = energy(&truth.arm, plant.q(), plant.qd());
    for _ in 0..(0.4 / dt_s).round() as usize {
        plant.actuate(&Joints::zeros());
    }
    energy(&truth.arm, plant.q(), plant.qd()) - before
}

/// M and bias are frozen for one period, so the drift is of first order in it.
#[test]
fn without_friction_energy_is_kept_to_first_order() {
    let drifts = [2e-3, 1e-3, 0.5e-3].map(free_drift_j);
    println!("energy drift at 2/1/0.5 ms: {drifts:.6?} J");
    assert!(drifts[1].abs() < 0.1, "{drifts:?}");
    for pair in drifts.windows(2) {
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.2, "{drifts:?}");
    }
}

/// Energy [J] taken by friction from the thrown arm over 0.4 s, and what is missing from the balance; checks
/// `tau_f·qd ≥ 0` at the new velocity, joint by joint, which one sub-step per period makes exact.
fn dissipation_j(truth: &Truth<7>, dt_s: f64) -> (f64, f64) {
    let mut plant = BoxFrictionPlant::new(truth.clone(), Sensors::noise_free(), presets::panda_ready_pose(), 1)
        .with_sub_steps(1)
        .with_period(dt_s)
        .with_velocity(Joints::from_fn(|j, _| if j % 2 == 0 { 0.3 } else { -0.2 }));
    let before = energy(&truth.arm, plant.q(), plant.qd());
    let mut dissipated = 0.0;
    for tick in 0..(0.4 / dt_s).round() as usize {
        let qd_before = *plant.qd();
        plant.actuate(&Joints::zeros());
        let power = plant.friction_torque().component_mul(plant.qd());
        assert!(power.min() >= 0.0, "tick {tick}: friction feeds {:e} W", power.min());
        dissipated += plant.friction_torque().dot(&((qd_before + plant.qd()) * 0.5)) * dt_s;
    }
    (dissipated, energy(&truth.arm, plant.q(), plant.qd()) - before + dissipated)
}

/// Friction only takes; what remains of the energy balance is the integrator's first-order drift: below 1 % of what was
/// dissipated, and halved with the period (within 10 %, since joints stop and start at other instants).
#[test]
fn friction_only_dissipates() {
    for truth in [Truth::panda_coulomb_viscous(), Truth::panda_stribeck(), asymmetric_truth()].map(without_stops) {
        let [(taken, coarse), (_, fine)] = [1e-3, 0.5e-3].map(|dt_s| dissipation_j(&truth, dt_s));
        println!("dissipated {taken:.4} J, balance off by {coarse:.5} J at 1 ms, {fine:.5} J at 0.5 ms");
        assert!(taken > 0.1 && coarse.abs() < 0.01 * taken);
        assert!((coarse / fine - 2.0).abs() < 0.2, "{coarse} {fine}");
    }
}

/// One joint of 0.5 kg m² about the vertical: the equation of motion has a closed form.
fn turntable(law: JointFriction) -> Truth<1> {
    let one = SVector::<f64, 1>::repeat;
    let arm = Arm {
        name: "turntable".to_owned(),
        joint_names: JointNames::default(),
        mechanism: Mechanism {
            placements: [JointPlacement::from(ModifiedDh { a_m: 0.0, d_m: 0.0, alpha_rad: 0.0 })],
            links: [LinkInertia { mass_kg: 1.0, com_m: Vector3::zeros(), inertia_kg_m2: Matrix3::identity() * 0.4 }],
            link_from_flange_rotation: Matrix3::identity(),
            link_from_flange_translation: Vector3::zeros(),
        }
        .into(),
        rotor_inertia_kg_m2: one(0.1),
        limits: Limits {
            q_min_rad: one(-0.5),
            q_max_rad: one(0.7),
            qd_max_rad_s: one(10.0),
            tau_max_nm: one(50.0),
            tau_rate_max_nm_s: one(1e4),
        },
        gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
    };
    Truth::new(arm, FrictionModel { joints: [law] })
}

/// Closed form: `v(t) = (tau − Fc±)/Fv± (1 − exp(−Fv± t/B))` in each direction; implicit Euler errs by h Fv/(2B) < 0.1 %.
#[test]
fn asymmetric_friction_slides_as_the_closed_form() {
    let law = Asymmetric {
        coulomb_positive_nm: 0.6,
        coulomb_negative_nm: 0.4,
        viscous_positive_nm_s_per_rad: 1.0,
        viscous_negative_nm_s_per_rad: 2.0,
    };
    for (tau, coulomb, viscous) in [(0.9, 0.6, 1.0), (-0.9, -0.4, 2.0)] {
        let mut plant =
            BoxFrictionPlant::new(turntable(law.into()), Sensors::noise_free(), SVector::zeros(), 1).with_sub_steps(5);
        for tick in 1..=1500 {
            plant.actuate(&SVector::from([tau]));
            let t = f64::from(tick) * 1e-3;
            let expected = (tau - coulomb) / viscous * (1.0 - (-viscous * t / 0.5_f64).exp());
            // The first sub-step still sees the slope of the other direction at most once.
            assert!(
                (plant.qd()[0] - expected).abs() < 1e-3 * expected.abs() + 1e-6,
                "{t} {} {expected}",
                plant.qd()[0]
            );
        }
    }
}

/// A joint driven into its stop goes no further than one sub-step's travel, rests there, and leaves when pulled back.
#[test]
fn hard_stops_hold() {
    let law: JointFriction = CoulombViscous { coulomb_nm: 0.1, viscous_nm_s_per_rad: 0.5 }.into();
    for sub_steps in [1, 5, 50] {
        for (drive, stop) in [(2.0, 0.7), (-2.0, -0.5)] {
            let mut plant = BoxFrictionPlant::new(turntable(law), Sensors::noise_free(), SVector::zeros(), 1)
                .with_sub_steps(sub_steps);
            let mut fastest = 0.0_f64;
            for _ in 0..2000 {
                plant.actuate(&SVector::from([drive]));
                fastest = fastest.max(plant.qd()[0].abs());
            }
            let beyond = (plant.q()[0] - stop) * f64::signum(drive);
            let travel = fastest * 1e-3 / sub_steps as f64;
            assert!((0.0..=travel).contains(&beyond), "{beyond:e} rad beyond the stop, one sub-step is {travel:e}");
            assert_eq!(plant.qd()[0], 0.0);
            for _ in 0..50 {
                plant.actuate(&SVector::from([-drive]));
            }
            assert!(plant.qd()[0] * drive < 0.0, "glued to the stop");
        }
    }
}

/// `tau_link = tau_motor − tau_f − Ir qdd`, and that is what the link-side arm needs for the motion it made:
/// `tau_link = RNEA_link(q, qd, qdd) + Jᵀ h`. Exact to rounding for the state at the start of the period.
#[test]
fn link_torque_is_motor_torque_less_friction_and_rotor() {
    for truth in [Truth::panda_coulomb_viscous(), Truth::panda_lugre(), Truth::panda_gaz(), asymmetric_truth()] {
        let push = Wrench::from_force_moment(&[8.0, -5.0, 3.0, 0.7, -0.4, 0.2]);
        let pulse = Pulse { wrench_base: push, start_s: -1.0, end_s: 10.0, ramp_s: 0.0 };
        let plant_with = |torque_side| {
            let sensors = Sensors { torque_side, ..Sensors::noise_free() };
            BoxFrictionPlant::new(truth.clone(), sensors, presets::panda_ready_pose(), 1)
                .with_pulses(WrenchPulses { pulses: vec![pulse] })
        };
        let (mut link, mut motor) = (plant_with(TorqueSide::Link), plant_with(TorqueSide::Motor));
        let (arm, link_arm) = (presets::panda(), presets::panda().link_side());
        for tick in 0..500 {
            let (q, qd) = (*link.q(), *link.qd());
            let wave = Joints::from_fn(|j, _| 3.0 * (0.02 * f64::from(tick) + j as f64).sin());
            let tau = gravity_torque(&arm, &q) + wave;
            link.actuate(&tau);
            motor.actuate(&tau);
            let qdd = (link.qd() - qd) / 1e-3;
            let tau_link = link.sample().tau;
            let relation = tau - link.friction_torque() - arm.rotor_inertia_kg_m2.component_mul(&qdd);
            assert!((tau_link - relation).amax() < 1e-12);
            let jt_h = Kinematics::at(&arm, &q).jacobian().transpose() * push.to_vector();
            let needed = rnea(&link_arm, &q, &qd, &qdd) + jt_h;
            assert!((tau_link - needed).amax() < 1e-8, "tick {tick}: {:e}", (tau_link - needed).amax());
            assert!((motor.sample().tau - tau).amax() < 1e-12);
        }
    }
}
