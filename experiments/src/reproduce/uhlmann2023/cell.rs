//! The measurements of the paper's cell, on the simulated arm.

use nalgebra::{SVector, UnitQuaternion, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use tribo_residual::{Approach, LoadedRest, Rest, Rests, ValidDoubleEncoder};
use tribo_robot::{Arm, Kinematics, Wrench, presets};
use tribo_sim::{QuasiStaticArm, Transmission};

use super::Uhlmann2023;

type Joints = SVector<f64, 7>;

/// Everything measured with one arm. Rests carry readings of both encoders and what the estimator remembers of the way.
#[derive(Clone, Debug)]
pub struct Measurements {
    /// Calibration: random poses without load, and known loads.
    pub rests: Rests<7>,
    /// Random poses not in the calibration.
    pub test: Vec<Rest<7>>,
    /// The circle without the air spring.
    pub circle_free: Vec<Rest<7>>,
    /// The circle with it, and the wrench by the robot on the environment.
    pub circle_loaded: Vec<(Rest<7>, Wrench)>,
}

/// Middle of the workspace (rad) and half its width: random poses are drawn from it, the circle lies inside.
const CENTRE_RAD: [f64; 7] = [0.0, -0.1, 0.0, -1.9, 0.0, 1.8, 0.8];
const HALF_RANGE_RAD: [f64; 7] = [1.2, 0.8, 0.7, 0.7, 0.8, 0.8, 1.0];
/// Steps of a way from pose to pose.
const STEPS: usize = 120;
/// Steps between neighbours on the circle.
const CIRCLE_STEPS: usize = 30;
/// Loads per way from none to the largest.
const LOADS: usize = 8;
/// Middle of the circle (m), base axes: the fixed end of the air spring.
const CIRCLE_CENTRE_M: [f64; 3] = [0.5, 0.0, 0.45];

/// The simulated arm with the memory that a user of both encoders would keep.
struct Cell {
    arm: QuasiStaticArm<7>,
    approach: Approach<7>,
}

impl Cell {
    fn new(config: &Uhlmann2023, settings: &ValidDoubleEncoder, theta: Joints, seed: u64) -> Self {
        let mut rng = Pcg64::seed_from_u64(seed ^ 0x6765_6172);
        let spread = config.gear_spread;
        let gears = Transmission::panda().map(|gear| gear.scaled(|| 1.0 + spread * rng.random_range(-1.0..=1.0)));
        let arm = QuasiStaticArm::new(presets::panda(), gears, theta, seed);
        Self { arm, approach: Approach::new(settings.direction_travel_rad, settings.loading_travel_rad) }
    }

    fn move_to(&mut self, theta: &Joints, wrench: impl Fn(f64) -> Wrench, steps: usize) {
        let approach = &mut self.approach;
        self.arm.move_to(theta, wrench, steps, |theta, q| approach.push(q, &(theta - q)));
    }

    /// After some time at rest, when stiction has relaxed.
    fn rest(&mut self, wrench: &Wrench) -> Rest<7> {
        self.arm.rest(wrench);
        self.reading()
    }

    fn reading(&mut self) -> Rest<7> {
        let [theta, q] = self.arm.read();
        self.approach.push(&q, &(theta - q));
        let (direction, loading) = (self.approach.direction(), self.approach.loading());
        Rest { q, deflection_rad: theta - q, direction, loading }
    }
}

impl Uhlmann2023 {
    /// Takes every measurement of one seed: gears, poses, loads and noise are drawn from it.
    pub fn measure(&self, settings: &ValidDoubleEncoder, seed: u64) -> Measurements {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut random_pose =
            || -> Joints { Joints::from_fn(|j, _| CENTRE_RAD[j] + HALF_RANGE_RAD[j] * rng.random_range(-1.0..1.0)) };
        let mut last_way = Pcg64::seed_from_u64(seed ^ 0x6c61_7374);
        let none = Wrench::default();
        let mut cell = Cell::new(self, settings, Joints::from(CENTRE_RAD), seed);
        let mut free = Vec::new();
        for _ in 0..self.training_poses + self.test_poses {
            let pose = random_pose();
            let last = Joints::from_fn(|_, _| self.last_way_rad * last_way.random_range(-1.0..1.0));
            cell.move_to(&(pose - last), |_| none, STEPS);
            cell.move_to(&pose, |_| none, CIRCLE_STEPS);
            free.push(cell.rest(&none));
        }
        let test = free.split_off(self.training_poses);
        let poses: Vec<Joints> = (0..self.load_poses).map(|_| random_pose()).collect();
        let loaded = poses.iter().flat_map(|pose| self.load(&mut cell, pose, &mut rng)).collect();

        let circle = self.circle();
        let (mut circle_free, mut circle_loaded) = (Vec::new(), Vec::new());
        for spring_n in [0.0, self.spring_force_n] {
            cell.move_to(&circle[circle.len() - 1], |_| none, STEPS);
            // One lap to forget how the arm came to the circle.
            for lap in 0..2 {
                for k in 0..circle.len() {
                    let before = self.spring(circle.len() + k - 1, spring_n);
                    let here = self.spring(k, spring_n);
                    let between = |part: f64| Wrench::from_vector(&before.to_vector().lerp(&here.to_vector(), part));
                    cell.move_to(&circle[k], between, CIRCLE_STEPS);
                    let rest = cell.rest(&here);
                    match (lap, spring_n > 0.0) {
                        (1, false) => circle_free.push(rest),
                        (1, true) => circle_loaded.push((rest, here)),
                        _ => {}
                    }
                }
            }
        }
        Measurements { rests: Rests { free, loaded }, test, circle_free, circle_loaded }
    }

    /// Loading, unloading, loading, unloading at one pose, by a screw in a random direction with a random lever.
    fn load(&self, cell: &mut Cell, pose: &Joints, rng: &mut Pcg64) -> Vec<LoadedRest<7>> {
        let none = Wrench::default();
        cell.move_to(pose, |_| none, STEPS);
        let free = cell.rest(&none);
        let mut direction = || Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0_f64)).normalize();
        let force_n = direction() * self.load_force_n;
        let moment_nm = (direction() * self.lever_m).cross(&force_n);
        let whole = Wrench { force_n, moment_nm }.to_vector();
        let mut loaded = Vec::new();
        let mut at = 0.0;
        for k in (1..=LOADS).chain((1..LOADS).rev()).cycle().take(4 * LOADS - 3) {
            let next = k as f64 / LOADS as f64;
            cell.move_to(pose, |part| Wrench::from_vector(&(whole * (at + (next - at) * part))), 10);
            let wrench_base = Wrench::from_vector(&(whole * next));
            loaded.push(LoadedRest { free, loaded: cell.reading(), wrench_base });
            at = next;
        }
        cell.move_to(pose, |part| Wrench::from_vector(&(whole * (at * (1.0 - part)))), 10);
        loaded
    }

    /// Angle of pose k on the circle (rad).
    fn angle_rad(&self, k: usize) -> f64 {
        std::f64::consts::TAU * k as f64 / self.circle_poses as f64
    }

    /// The air spring pushes the tool outwards, through ball joints: the robot pushes back.
    fn spring(&self, k: usize, force_n: f64) -> Wrench {
        let s = self.angle_rad(k);
        Wrench { force_n: Vector3::new(-s.cos(), -s.sin(), 0.0) * force_n, moment_nm: Vector3::zeros() }
    }

    /// Joint angles along the circle in the X-Y plane, the tool inclined by α sin about X and α cos about Y.
    fn circle(&self) -> Vec<Joints> {
        let arm = presets::panda();
        let mut q = Joints::from(CENTRE_RAD);
        let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let mut poses = Vec::new();
        // The first lap finds a posture that the second repeats.
        for k in 0..2 * self.circle_poses {
            let s = self.angle_rad(k);
            let position = Vector3::from(CIRCLE_CENTRE_M) + Vector3::new(s.cos(), s.sin(), 0.0) * self.circle_radius_m;
            let tilt = self.inclination_rad;
            let inclined = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), tilt * s.sin())
                * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), tilt * s.cos());
            q = reach(&arm, q, &position, &(inclined * down));
            if k >= self.circle_poses {
                poses.push(q);
            }
        }
        poses
    }
}

/// Joint angles that put the flange there, near `q` and drawn towards the middle of the workspace.
fn reach(arm: &Arm<7>, mut q: Joints, position: &Vector3<f64>, orientation: &UnitQuaternion<f64>) -> Joints {
    for _ in 0..60 {
        let kinematics = Kinematics::at(arm, &q);
        let pose = kinematics.base_from_flange();
        let turn = (orientation * pose.rotation.inverse()).scaled_axis();
        let shift = position - pose.translation.vector;
        let error = Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z);
        let jacobian = kinematics.jacobian();
        let Some(inverse) = (jacobian * jacobian.transpose()).try_inverse() else { break };
        let pseudo = jacobian.transpose() * inverse;
        let home = (Joints::from(CENTRE_RAD) - q) * 0.1;
        q += pseudo * error + home - pseudo * (jacobian * home);
    }
    q
}
