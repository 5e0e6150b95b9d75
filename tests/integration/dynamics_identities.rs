//! Dynamics against other algorithms and conserved quantities, with and without rotor inertia and payload.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use tribo_robot::{
    Arm, ControlTerms, Kinematics, Payload, bias_torque, forward_dynamics, gravity_torque, inverse_dynamics_regressor,
    link_regressor, mass_matrix, presets, rnea, so3,
};

type Joints = SVector<f64, 7>;

fn arms() -> [Arm<7>; 3] {
    let payload = Payload {
        mass_kg: 1.3,
        com_m: Vector3::new(0.02, -0.03, 0.08),
        inertia_kg_m2: Matrix3::from_diagonal(&Vector3::new(0.004, 0.005, 0.003)),
    };
    let mut tilted = presets::panda().with_payload(&payload);
    tilted.gravity_m_s2 = Vector3::new(2.0, -1.0, -9.3);
    [presets::panda(), presets::panda().link_side(), tilted]
}

fn draw(rng: &mut Pcg64, low: &Joints, high: &Joints) -> Joints {
    Joints::from_fn(|i, _| rng.random_range(low[i]..high[i]))
}

fn for_random_states(mut check: impl FnMut(&Arm<7>, Joints, Joints, Joints)) {
    let mut rng = Pcg64::seed_from_u64(7);
    for arm in arms() {
        for _ in 0..50 {
            let l = &arm.limits;
            let q = draw(&mut rng, &l.q_min_rad, &l.q_max_rad);
            let qd = draw(&mut rng, &-l.qd_max_rad_s, &l.qd_max_rad_s);
            let qdd = draw(&mut rng, &Joints::repeat(-10.0), &Joints::repeat(10.0));
            check(&arm, q, qd, qdd);
        }
    }
}

#[test]
fn mass_matrix_times_acceleration_plus_bias_is_rnea() {
    for_random_states(|arm, q, qd, qdd| {
        let m = mass_matrix(arm, &q);
        assert!((m - m.transpose()).amax() < 1e-14);
        let direct = m * qdd + bias_torque(arm, &q, &qd);
        assert!((direct - rnea(arm, &q, &qd, &qdd)).amax() < 1e-11);
    });
}

#[test]
fn forward_dynamics_inverts_rnea() {
    for_random_states(|arm, q, qd, qdd| {
        let back = forward_dynamics(arm, &q, &qd, &rnea(arm, &q, &qd, &qdd));
        assert!((back - qdd).amax() < 1e-9, "{:e}", (back - qdd).amax());
    });
}

#[test]
fn regressor_times_parameters_is_rnea() {
    for_random_states(|arm, q, qd, qdd| {
        let blocks = inverse_dynamics_regressor(arm, &q, &qd, &qdd);
        let mut tau = arm.rotor_inertia_kg_m2.component_mul(&qdd);
        for (block, link) in blocks.iter().zip(&arm.links) {
            tau += block * link.parameters();
        }
        assert!((tau - rnea(arm, &q, &qd, &qdd)).amax() < 1e-11);
        for (link, block) in blocks.iter().enumerate() {
            assert_eq!(link_regressor(arm, &q, &qd, &qdd, link), *block, "link {link}");
        }
    });
}

#[test]
fn jacobian_is_the_derivative_of_the_pose() {
    let h = 1e-6;
    for_random_states(|arm, q, qd, _| {
        let j = Kinematics::at(arm, &q).jacobian();
        let (plus, minus) = (Kinematics::at(arm, &(q + qd * h)), Kinematics::at(arm, &(q - qd * h)));
        let linear = (plus.flange_origin - minus.flange_origin) / (2.0 * h);
        let angular = so3::log(&(plus.flange_rotation * minus.flange_rotation.transpose())) / (2.0 * h);
        let twist = j * qd;
        assert!((twist.fixed_rows::<3>(0) - angular).amax() < 1e-8);
        assert!((twist.fixed_rows::<3>(3) - linear).amax() < 1e-8);
    });
}

#[test]
fn jdot_qd_is_the_derivative_of_the_twist_at_constant_qd() {
    let h = 1e-6;
    for_random_states(|arm, q, qd, _| {
        let twist = |s: f64| Kinematics::at(arm, &(q + qd * s)).jacobian() * qd;
        let difference: Vector6<f64> = (twist(h) - twist(-h)) / (2.0 * h);
        assert!((difference - Kinematics::at(arm, &q).jdot_qd(&qd)).amax() < 1e-7);
    });
}

/// Kinetic energy ½ qdᵀ M qd plus potential −Σ m gᵀ c.
pub(crate) fn energy(arm: &Arm<7>, q: &Joints, qd: &Joints) -> f64 {
    let kinematics = Kinematics::at(arm, q);
    let potential: f64 = (0..7)
        .map(|k| {
            let (rotation, origin) = kinematics.link(arm, k);
            let com = origin + rotation * arm.links[k].com_m;
            -arm.links[k].mass_kg * arm.gravity_m_s2.dot(&com)
        })
        .sum();
    0.5 * qd.dot(&(mass_matrix(arm, q) * qd)) + potential
}

#[test]
fn power_of_the_joints_is_the_rate_of_energy() {
    let h = 1e-6;
    for_random_states(|arm, q, qd, qdd| {
        let at = |s: f64| energy(arm, &(q + qd * s + qdd * (0.5 * s * s)), &(qd + qdd * s));
        let rate = (at(h) - at(-h)) / (2.0 * h);
        let power = qd.dot(&rnea(arm, &q, &qd, &qdd));
        assert!((rate - power).abs() < 1e-6 * power.abs().max(100.0), "{rate} {power}");
    });
}

#[test]
fn free_motion_conserves_energy_to_fourth_order() {
    let arm = presets::panda();
    let rate = |q: &Joints, qd: &Joints| forward_dynamics(&arm, q, qd, &Joints::zeros());
    let drift = |h: f64| {
        let (mut q, mut qd) = (presets::panda_ready_pose(), Joints::repeat(0.3));
        let before = energy(&arm, &q, &qd);
        for _ in 0..(0.5 / h).round() as usize {
            let (k1q, k1v) = (qd, rate(&q, &qd));
            let (k2q, k2v) = (qd + k1v * (h / 2.0), rate(&(q + k1q * (h / 2.0)), &(qd + k1v * (h / 2.0))));
            let (k3q, k3v) = (qd + k2v * (h / 2.0), rate(&(q + k2q * (h / 2.0)), &(qd + k2v * (h / 2.0))));
            let (k4q, k4v) = (qd + k3v * h, rate(&(q + k3q * h), &(qd + k3v * h)));
            q += (k1q + k2q * 2.0 + k3q * 2.0 + k4q) * (h / 6.0);
            qd += (k1v + k2v * 2.0 + k3v * 2.0 + k4v) * (h / 6.0);
        }
        (energy(&arm, &q, &qd) - before).abs()
    };
    let (coarse, fine) = (drift(0.01), drift(0.005));
    assert!(coarse < 1e-3 && fine < coarse / 10.0, "coarse {coarse:e} fine {fine:e}");
}

/// Second algorithm: the terms go through base axes, the single calls from link to link.
#[test]
fn control_terms_are_the_single_calls() {
    for_random_states(|arm, q, qd, _| {
        let terms = ControlTerms::at(arm, &q, &qd);
        let kinematics = Kinematics::at(arm, &q);
        let jacobian: SMatrix<f64, 6, 7> = kinematics.jacobian();
        let zero = SVector::zeros();
        assert!((terms.jacobian - jacobian).amax() < 1e-14);
        assert!((terms.mass_matrix - mass_matrix(arm, &q)).amax() < 1e-13);
        assert_eq!(terms.mass_matrix, terms.mass_matrix.transpose());
        assert!((terms.bias_nm() - bias_torque(arm, &q, &qd)).amax() < 1e-12);
        assert!((terms.gravity_nm - bias_torque(arm, &q, &zero)).amax() < 1e-12);
        assert!((gravity_torque(arm, &q) - bias_torque(arm, &q, &zero)).amax() < 1e-12);
        assert!((terms.jdot_qd - kinematics.jdot_qd(&qd)).amax() < 1e-12);
    });
}
