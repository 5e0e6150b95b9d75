//! Arms that nobody builds: axes askew, parallel, almost parallel, almost at right angles.
//!
//! The algorithms turn and slide the frames of links until as many numbers as possible are zero. Witnesses that do without:
//! transforms multiplied one after the other, forward dynamics in the frames that the arm is described in, differences of poses.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Matrix3, SVector, Vector3};
use tribo_robot::{
    Arm, ControlTerms, JointPlacement, Kinematics, bias_torque, forward_dynamics, gravity_torque, mass_matrix, presets,
    rnea, so3,
};

type Joints = SVector<f64, 7>;

/// Numbers without pattern in −1..1, the same in every run.
fn number(k: usize) -> f64 {
    2.0 * (0.37 + 0.618_034 * k as f64 + 0.1 * (k as f64 * 1.7).sin()).fract() - 1.0
}

fn vector(k: usize) -> Vector3<f64> {
    Vector3::new(number(k), number(k + 1), number(k + 2))
}

/// A Panda's weights on joints of which every other pair has its axes `angle` apart, about an axis anywhere across.
fn arm(angle: f64, seed: usize) -> Arm<7> {
    let arm = presets::panda().altered(|mechanism| {
        for (k, placement) in mechanism.placements.iter_mut().enumerate() {
            let about_z = |u: f64| so3::exp(&(Vector3::z() * 3.0 * u));
            let across = so3::exp(&(Vector3::x() * if k % 2 == 1 { angle } else { 2.0 * number(seed + k) }));
            let rotation = about_z(number(seed + 3 * k)) * across * about_z(number(seed + 5 * k));
            *placement = JointPlacement { rotation, translation: vector(seed + 7 * k) * 0.4 };
        }
        mechanism.link_from_flange_rotation = so3::exp(&(vector(seed) * 2.0));
        mechanism.link_from_flange_translation = vector(seed + 1) * 0.2;
    });
    Arm { gravity_m_s2: vector(seed + 2) * 9.81, ..arm }
}

/// What holds of any arm in any state.
fn check(arm: &Arm<7>, what: &str) {
    for k in 0..10 {
        let state = |from: usize, scale: f64| Joints::from_fn(|j, _| scale * number(from + 11 * k + 3 * j));
        let (q, qd, qdd) = (state(0, PI), state(1, 2.0), state(2, 10.0));
        let kinematics = Kinematics::at(arm, &q);
        let close = |name: &str, off: f64, tolerance: f64| assert!(off < tolerance, "{what}, {name}: {off:e}");

        let (mut rotation, mut origin) = (Matrix3::identity(), Vector3::zeros());
        for j in 0..7 {
            let placement = &arm.placements[j];
            origin += rotation * placement.translation;
            rotation = rotation * placement.rotation * so3::exp(&(Vector3::z() * q[j]));
            let (ours, at) = kinematics.link(arm, j);
            close("frame of a link", (ours - rotation).amax().max((at - origin).amax()), 1e-14);
            close("axis", (kinematics.axis(j) - rotation.column(2)).amax(), 1e-14);
        }
        origin += rotation * arm.link_from_flange_translation;
        rotation *= arm.link_from_flange_rotation;
        let flange = kinematics.base_from_flange();
        close("flange", (flange.translation.vector - origin).amax(), 1e-14);
        close("flange's turn", (flange.rotation.matrix() - rotation).amax(), 1e-14);

        let h = 1e-6;
        let [plus, minus] = [h, -h].map(|h| Kinematics::at(arm, &(q + qd * h)));
        let linear = (plus.flange_origin - minus.flange_origin) / (2.0 * h);
        let angular = so3::log(&(plus.flange_rotation * minus.flange_rotation.transpose())) / (2.0 * h);
        let twist = kinematics.jacobian() * qd;
        close(
            "twist",
            (twist.fixed_rows::<3>(0) - angular).amax().max((twist.fixed_rows::<3>(3) - linear).amax()),
            1e-8,
        );
        let drift = (plus.jacobian() - minus.jacobian()) / (2.0 * h) * qd;
        close("drift", (kinematics.jdot_qd(&qd) - drift).amax(), 1e-7);

        let tau = rnea(arm, &q, &qd, &qdd);
        close("forward dynamics", (forward_dynamics(arm, &q, &qd, &tau) - qdd).amax(), 1e-11);
        let (m, bias) = (mass_matrix(arm, &q), bias_torque(arm, &q, &qd));
        close("M qdd + bias", (m * qdd + bias - tau).amax(), 1e-11);
        close("weight", (gravity_torque(arm, &q) - rnea(arm, &q, &Joints::zeros(), &Joints::zeros())).amax(), 1e-11);

        let terms = ControlTerms::at(arm, &q, &qd);
        close("terms' M", (terms.mass_matrix - m).amax(), 1e-12);
        close("terms' bias", (terms.bias_nm() - bias).amax(), 1e-11);
        close("terms' weight", (terms.gravity_nm - gravity_torque(arm, &q)).amax(), 1e-11);
        close("terms' J", (terms.jacobian - kinematics.jacobian()).amax(), 1e-14);
        close("terms' drift", (terms.jdot_qd - kinematics.jdot_qd(&qd)).amax(), 1e-11);
        close("terms' pose", (terms.base_from_flange.to_homogeneous() - flange.to_homogeneous()).amax(), 1e-14);
    }
}

#[test]
fn algorithms_agree_whatever_the_angle_between_two_axes() {
    for near in [0.0, FRAC_PI_2, PI] {
        for off in [0.0, 1e-17, 1e-15, 1e-14, 1e-9, 1e-6, 1e-3, 0.1, -1e-16, -1e-9, -1e-3, -0.1] {
            for seed in [5, 100, 1000] {
                check(&arm(near + off, seed), &format!("{near} + {off:e}, seed {seed}"));
            }
        }
    }
}

/// A joint that is moved along its own axis, with its link, is the same arm.
#[test]
fn a_frame_may_slide_along_its_axis() {
    let arm = presets::panda();
    let slid = arm.clone().altered(|mechanism| {
        mechanism.placements[4].translation += mechanism.placements[4].rotation.column(2) * 0.3;
        mechanism.links[4].com_m.z -= 0.3;
        mechanism.placements[5].translation.z -= 0.3;
    });
    for k in 0..10 {
        let state = |from: usize| Joints::from_fn(|j, _| number(from + 11 * k + 3 * j));
        let (q, qd, qdd) = (state(0), state(1), state(2));
        assert!((rnea(&arm, &q, &qd, &qdd) - rnea(&slid, &q, &qd, &qdd)).amax() < 1e-12);
        assert!((mass_matrix(&arm, &q) - mass_matrix(&slid, &q)).amax() < 1e-13);
    }
}
