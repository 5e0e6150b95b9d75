//! An arm with two encoders per joint that moves from pose to pose.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use tribo_robot::{Arm, Kinematics, Wrench};

use super::transmission::{Transmission, dahl};

/// Slow motion of an arm on yielding gears: no inertia, but every hysteresis on the way.
///
/// Motors go where they are told. Each joint's load is gravity, contact and stiction; its gear deflects by
/// [`Transmission::deflection_rad`]. Once the arm stands, stiction relaxes by a random part up to `relaxation`.
#[derive(Clone, Debug)]
pub struct QuasiStaticArm<const N: usize> {
    arm: Arm<N>,
    gears: [Transmission; N],
    theta: SVector<f64, N>,
    q: SVector<f64, N>,
    load: SVector<f64, N>,
    hysteresis: SVector<f64, N>,
    stiction: SVector<f64, N>,
    encoder_sd_rad: f64,
    relaxation: f64,
    rng: Pcg64,
}

/// Noise of an encoder reading averaged over a rest (rad).
const REST_SD_RAD: f64 = 1e-6;
/// Largest part of the stiction that a standing joint loses.
const RELAXATION: f64 = 0.3;

impl<const N: usize> QuasiStaticArm<N> {
    /// At `theta` (rad), with no history; `seed` feeds encoder noise and relaxation.
    pub fn new(arm: Arm<N>, gears: [Transmission; N], theta: SVector<f64, N>, seed: u64) -> Self {
        let zero = SVector::zeros();
        let mut new = Self {
            arm,
            gears,
            theta,
            q: theta,
            load: zero,
            hysteresis: zero,
            stiction: zero,
            encoder_sd_rad: REST_SD_RAD,
            relaxation: RELAXATION,
            rng: Pcg64::seed_from_u64(seed),
        };
        new.advance(&zero, &Wrench::default());
        new
    }

    /// Motors go straight to `theta` (rad) in `steps`, under the wrench at each part of the way (0, 1]; `observe` gets the
    /// readings (theta, q) on the way.
    pub fn move_to(
        &mut self,
        theta: &SVector<f64, N>,
        wrench: impl Fn(f64) -> Wrench,
        steps: usize,
        mut observe: impl FnMut(&SVector<f64, N>, &SVector<f64, N>),
    ) {
        let step = (theta - self.theta) / steps.max(1) as f64;
        for k in 1..=steps.max(1) {
            self.advance(&step, &wrench(k as f64 / steps.max(1) as f64));
            let [theta, q] = self.read();
            observe(&theta, &q);
        }
    }

    /// The arm stands: stiction relaxes, under a wrench.
    pub fn rest(&mut self, wrench: &Wrench) {
        for j in 0..N {
            self.stiction[j] *= 1.0 - self.relaxation * self.rng.random::<f64>();
        }
        self.advance(&SVector::zeros(), wrench);
    }

    /// Readings of the motor and the link encoders (rad).
    pub fn read(&mut self) -> [SVector<f64, N>; 2] {
        let sd = self.encoder_sd_rad;
        [self.theta, self.q].map(|x| x.map(|x| x + sd * self.rng.sample::<f64, _>(StandardNormal)))
    }

    /// True link angles (rad).
    pub fn q(&self) -> &SVector<f64, N> {
        &self.q
    }

    fn advance(&mut self, step: &SVector<f64, N>, wrench: &Wrench) {
        self.theta += step;
        let kinematics = Kinematics::at(&self.arm, &(self.q + step));
        let outside = kinematics.gravity_torque(&self.arm) + kinematics.jacobian().transpose() * wrench.to_vector();
        for j in 0..N {
            let gear = &self.gears[j];
            let load = outside[j] + gear.stiction_nm * self.stiction[j];
            self.hysteresis[j] = dahl(self.hysteresis[j], load - self.load[j], gear.hysteresis_load_nm);
            self.load[j] = load;
            let q = self.theta[j] - gear.deflection_rad(load, self.hysteresis[j], self.theta[j]);
            self.stiction[j] = dahl(self.stiction[j], q - self.q[j], gear.presliding_rad);
            self.q[j] = q;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector6;
    use tribo_robot::presets;

    fn arm(seed: u64) -> QuasiStaticArm<7> {
        QuasiStaticArm::new(presets::panda(), Transmission::panda(), presets::panda_ready_pose(), seed)
    }

    /// A pose reached from above and from below differs by the stiction and the hysteresis, and by nothing else.
    #[test]
    fn the_way_to_a_pose_is_remembered() {
        let reach = |from: f64| {
            let mut arm = arm(1);
            let ready = presets::panda_ready_pose();
            arm.move_to(&ready.add_scalar(from), |_| Wrench::default(), 200, |_, _| {});
            arm.move_to(&ready, |_| Wrench::default(), 200, |_, _| {});
            arm.load
        };
        let difference = reach(-0.2) - reach(0.2);
        for (j, gear) in Transmission::panda().iter().enumerate() {
            assert!((difference[j] - 2.0 * gear.stiction_nm).abs() < 0.02, "joint {j}: {}", difference[j]);
        }
    }

    /// The load of the gears is gravity, contact and a stiction of at most F.
    #[test]
    fn a_push_arrives_at_the_gears() {
        let mut arm = arm(2);
        let push = Wrench::from_vector(&Vector6::new(1.0, -2.0, 0.5, 20.0, -10.0, 15.0));
        let theta = arm.theta;
        arm.move_to(&theta, |part| Wrench::from_vector(&(push.to_vector() * part)), 50, |_, _| {});
        let kinematics = Kinematics::at(&presets::panda(), &arm.q);
        let expected =
            kinematics.gravity_torque(&presets::panda()) + kinematics.jacobian().transpose() * push.to_vector();
        for (j, gear) in Transmission::panda().iter().enumerate() {
            assert!((arm.load[j] - expected[j]).abs() <= gear.stiction_nm + 1e-2, "joint {j}");
        }
    }
}
