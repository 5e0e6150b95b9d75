//! What must be true of every preset, whatever its numbers.

use nalgebra::SVector;
use tribo_robot::presets::{self, AnyPreset, Preset};
use tribo_robot::{Kinematics, gravity_torque, mass_matrix};

/// Step of the central differences (rad): their error is about 1e-9 of the torque.
const STEP_RAD: f64 = 1e-5;

fn each(six: fn(&Preset<6>), seven: fn(&Preset<7>)) {
    for name in presets::NAMES {
        match presets::find(name).expect(name) {
            AnyPreset::Six(preset) => six(&preset),
            AnyPreset::Seven(preset) => seven(&preset),
        }
    }
}

/// Configurations all over the range of the joints.
fn configurations<const N: usize>(preset: &Preset<N>) -> Vec<SVector<f64, N>> {
    let limits = &preset.arm.limits;
    let spread = |k: usize| {
        SVector::from_fn(|j, _| {
            let part = (0.37 + 0.618_034 * (k * N + j) as f64).fract();
            limits.q_min_rad[j] + part * (limits.q_max_rad[j] - limits.q_min_rad[j])
        })
    };
    (0..40).map(spread).chain(preset.poses_rad).collect()
}

/// Potential energy (J): `−Σ m_i gravityᵀ c_i`.
fn potential<const N: usize>(preset: &Preset<N>, q: &SVector<f64, N>) -> f64 {
    let at = Kinematics::at(&preset.arm, q);
    let link = |k: usize| {
        let link = &preset.arm.links[k];
        let (rotation, origin) = at.link(&preset.arm, k);
        -link.mass_kg * preset.arm.gravity_m_s2.dot(&(origin + rotation * link.com_m))
    };
    (0..N).map(link).sum()
}

fn gravity_is_the_gradient_of_the_potential<const N: usize>(preset: &Preset<N>) {
    for q in configurations(preset) {
        let ours = gravity_torque(&preset.arm, &q);
        for j in 0..N {
            let moved = |by: f64| {
                let mut q = q;
                q[j] += by;
                potential(preset, &q)
            };
            let slope = (moved(STEP_RAD) - moved(-STEP_RAD)) / (2.0 * STEP_RAD);
            assert!((slope - ours[j]).abs() < 1e-6 * (1.0 + ours.amax()), "{} joint {j}", preset.arm.name);
        }
    }
}

#[test]
fn gravity() {
    each(gravity_is_the_gradient_of_the_potential, gravity_is_the_gradient_of_the_potential);
}

fn bodies_are_possible<const N: usize>(preset: &Preset<N>) {
    let name = &preset.arm.name;
    for (k, link) in preset.arm.links.iter().enumerate() {
        assert!(link.mass_kg > 0.0);
        // Principal moments of any body obey the triangle inequality; tables rounded by their authors miss it by little,
        // the FR3's last link most.
        let mut moments: Vec<f64> = link.inertia_kg_m2.symmetric_eigenvalues().iter().copied().collect();
        moments.sort_by(f64::total_cmp);
        let rounding = 5e-6 + 0.02 * moments[2];
        assert!(moments[0] > -1e-9, "{name} link {k}: {moments:?}");
        assert!(moments[0] + moments[1] >= moments[2] - rounding, "{name} link {k}: {moments:?}");
    }
    for q in configurations(preset) {
        assert!(mass_matrix(&preset.arm.clone().link_side(), &q).cholesky().is_some(), "{name} at {q}");
    }
}

#[test]
fn inertia() {
    each(bodies_are_possible, bodies_are_possible);
}

/// Room that the reference motion of 25 mm and 5° needs in any joint (rad).
const ROOM_RAD: f64 = 0.25;
/// Part of the torque limits that holding a pose may take.
const HOLDING_PART: f64 = 0.75;

fn poses_are_good_ones<const N: usize>(preset: &Preset<N>) {
    let (name, limits) = (&preset.arm.name, &preset.arm.limits);
    for (k, q) in preset.poses_rad.iter().enumerate() {
        for j in 0..N {
            let inside = q[j] - limits.q_min_rad[j] > ROOM_RAD && limits.q_max_rad[j] - q[j] > ROOM_RAD;
            assert!(inside, "{name} pose {k} joint {j}");
        }
        let at = Kinematics::at(&preset.arm, q);
        let jacobian = at.jacobian();
        let manipulability = (jacobian * jacobian.transpose()).determinant().sqrt();
        // Twice the manipulability below which the controller's inverse is damped.
        assert!(manipulability > 0.01, "{name} pose {k}: manipulability {manipulability:.4}");
        assert!(at.flange_origin.z > 0.05, "{name} pose {k}: flange at {:.3}", at.flange_origin);
        let gravity = gravity_torque(&preset.arm, q);
        let held = (0..N).all(|j| gravity[j].abs() < HOLDING_PART * limits.tau_max_nm[j]);
        assert!(held, "{name} pose {k}: gravity {gravity:.1}");
    }
}

#[test]
fn poses() {
    each(poses_are_good_ones, poses_are_good_ones);
}

/// Mass that the vendors' data sheets give for the whole arm (kg), and that of the base, which no preset has: 17.8 and 17.8
/// (Franka), 11.2, 20.6 and 33.5 (UR3e, UR5e, UR10e), 12.2 and 13.7 (xArm 6 and 7), 8.2 (Gen3), 29.9 (iiwa 14). Bases of the UR
/// and the xArm are those of their descriptions, rounded (2, 4, 4 kg: "might be incorrect"; 2.7 kg).
#[test]
fn masses_are_those_of_the_data_sheets() {
    // The Panda's is an identified set that may move mass between links and base.
    for (name, whole_kg, base_kg, tolerance) in [
        ("fr3", 17.8, 2.3966, 0.03),
        ("ur3e", 11.2, 2.0, 0.06),
        ("ur5e", 20.6, 4.0, 0.06),
        ("ur10e", 33.5, 4.0, 0.03),
        ("xarm6", 12.2, 2.7, 0.05),
        ("xarm7", 13.7, 2.7, 0.05),
        ("kinova_gen3", 8.2, 1.697, 0.03),
        ("iiwa14", 29.9, 5.0, 0.03),
    ] {
        let moving: f64 = match presets::find(name).expect(name) {
            AnyPreset::Six(preset) => preset.arm.links.iter().map(|link| link.mass_kg).sum(),
            AnyPreset::Seven(preset) => preset.arm.links.iter().map(|link| link.mass_kg).sum(),
        };
        assert!((moving + base_kg - whole_kg).abs() < tolerance * whole_kg, "{name}: {moving} + {base_kg} kg");
    }
}
