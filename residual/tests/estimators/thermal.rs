//! The thermal virtual sensor on a Panda whose joints are warm, at 500 Hz: friction and heat of the truth are written here
//! from the formulas.

use crate::common::prescribed::sway;
use nalgebra::{SVector, Vector6};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use tribo_friction::thermal::{HeatBalance, PolynomialStribeck, TemperatureFactor, ThermalJoint, ThermalLaw};
use tribo_residual::{ContactSettings, ThermalEstimator, ThermalSettings};
use tribo_robot::{
    Arm, ControlTerms, EstimatorInput, SensorFrame, Wrench, WrenchEstimate, WrenchEstimator, presets, rnea,
};

type Joints = SVector<f64, 7>;

const DT_S: f64 = 2e-3;
const ALPHA: f64 = -0.009;
const COULOMB_NM: [f64; 7] = [0.60, 0.90, 0.55, 0.80, 0.40, 0.30, 0.35];
const VISCOUS_NM_S: [f64; 7] = [1.0, 1.4, 0.8, 1.1, 0.5, 0.4, 0.3];
const ROOM_C: f64 = 22.0;
/// Far slower than any run here.
const HEAT: HeatBalance = HeatBalance { conductance_w_per_k: 0.1, capacity_j_per_k: 500.0 };

fn joints() -> [ThermalJoint; 7] {
    std::array::from_fn(|j| {
        let cold = PolynomialStribeck {
            polynomial: [COULOMB_NM[j], VISCOUS_NM_S[j], 0.0, 0.0],
            ..PolynomialStribeck::default()
        };
        let polynomial = TemperatureFactor { slope_per_k: ALPHA, level: 1.0 };
        ThermalJoint::new(ThermalLaw { polynomial, ..ThermalLaw::without_temperature(cold.into()) }, HEAT)
            .expect("a valid joint")
    })
}

/// The truth: temperatures, constant errors of each joint's friction, and noise.
struct Truth {
    arm: Arm<7>,
    temperature_c: Joints,
    friction_factor: Joints,
    more_nm: Joints,
    rng: Pcg64,
}

impl Truth {
    fn new(temperature_c: Joints, seed: u64) -> Self {
        let (arm, rng) = (presets::panda(), Pcg64::seed_from_u64(seed));
        Self { arm, temperature_c, friction_factor: Joints::repeat(1.0), more_nm: Joints::zeros(), rng }
    }

    /// Steps the estimator over the sway from `from_s` to `to_s`; `look` sees every estimate.
    fn run(
        &mut self,
        estimator: &mut ThermalEstimator<7>,
        [from_s, to_s]: [f64; 2],
        wrench: Wrench,
        mut look: impl FnMut(f64, &Self, &ThermalEstimator<7>, &WrenchEstimate),
    ) {
        let noise = |rng: &mut Pcg64, sd: f64| Joints::from_fn(|_, _| sd * rng.sample::<f64, _>(StandardNormal));
        for k in (from_s / DT_S).round() as u64..(to_s / DT_S).round() as u64 {
            let end_s = (k + 1) as f64 * DT_S;
            let [qm, qdm, qddm] = sway(end_s - 0.5 * DT_S);
            let [q, qd, _] = sway(end_s);
            let friction = Joints::from_fn(|j, _| {
                let factor = self.friction_factor[j] * (1.0 + ALPHA * (self.temperature_c[j] - ROOM_C));
                let tau = (COULOMB_NM[j] * qdm[j].signum() + VISCOUS_NM_S[j] * qdm[j]) * factor
                    + self.more_nm[j] * qdm[j].signum();
                let loss = HEAT.conductance_w_per_k * (self.temperature_c[j] - ROOM_C);
                self.temperature_c[j] += (tau * qdm[j] - loss) / HEAT.capacity_j_per_k * DT_S;
                tau
            });
            let jacobian = ControlTerms::at(&self.arm, &qm, &qdm).jacobian;
            let tau = rnea(&self.arm, &qm, &qdm, &qddm) + friction + jacobian.transpose() * wrench.to_vector();
            let tau_motor = tau + noise(&mut self.rng, 0.05);
            let measured_qd = qd + noise(&mut self.rng, 3e-3);
            let terms = ControlTerms::at(&self.arm, &q, &measured_qd);
            let frame = SensorFrame { time_s: end_s, q, qd: measured_qd, tau: tau_motor, theta: None };
            if k == 0 {
                estimator.reset(&frame, &terms);
                continue;
            }
            let estimate = estimator.step(&EstimatorInput {
                frame: &frame,
                terms: &terms,
                tau_motor: &tau_motor,
                tau_friction: &Joints::zeros(),
                acceleration_command: &Vector6::zeros(),
                dt_s: DT_S,
            });
            assert_eq!(estimate.fault, None);
            look(end_s, self, estimator, &estimate);
        }
    }
}

fn push() -> Wrench {
    Wrench::from_force_moment(&[5.0, -3.0, 15.0, 0.0, 0.5, 0.0])
}

/// simoni2017, figure 5: two minutes of free motion take out a start that is wrong by 10 K; contact after that leaves the
/// temperatures alone, although nobody says that there is one.
#[test]
fn two_minutes_find_the_temperature_and_contact_does_not_lose_it() {
    let mut estimator = ThermalEstimator::new(ThermalSettings::new(joints(), ROOM_C)).unwrap();
    let mut truth = Truth::new(Joints::repeat(ROOM_C + 10.0), 1);
    let mut free = 0_u32;
    truth.run(&mut estimator, [0.0, 120.0], Wrench::default(), |_, _, e, _| free += u32::from(e.is_free()));
    let error = estimator.temperatures_c() - truth.temperature_c;
    println!("after 120 s: {error:.2?} K, free {:.3}", f64::from(free) / 60_000.0);
    assert!(error.amax() < 1.5, "{error}");
    assert!((0..7).all(|j| error[j].abs() < 3.0 * estimator.temperature_sd_k()[j]));
    assert!(free > 58_000, "{free} of 60000");

    let before = error;
    let (mut worst_n, mut noticed) = (0.0_f64, 0_u32);
    truth.run(&mut estimator, [120.0, 180.0], push(), |t, _, e, estimate| {
        noticed += u32::from(!e.is_free());
        if t > 121.0 {
            worst_n = worst_n.max((estimate.wrench_base.force_n - push().force_n).norm());
        }
    });
    let moved = estimator.temperatures_c() - truth.temperature_c - before;
    println!("contact moved them by {moved:.2?} K, noticed {:.3}, worst {worst_n:.2} N", f64::from(noticed) / 30_000.0);
    assert!(moved.amax() < 0.3 && noticed > 29_000, "{moved} {noticed}");
}

/// What the gate is for: with it propped open the same contact is taken for warmth.
#[test]
fn without_the_gate_contact_is_taken_for_warmth() {
    let open = ContactSettings { joint_sd: 100.0, wrench_nis: 1e4, hold_s: 0.0 };
    let settings = ThermalSettings { contact: open, ..ThermalSettings::new(joints(), ROOM_C) };
    let mut estimator = ThermalEstimator::new(settings).unwrap();
    let mut truth = Truth::new(Joints::repeat(ROOM_C), 2);
    truth.run(&mut estimator, [0.0, 20.0], push(), |_, _, _, _| {});
    let error = (estimator.temperatures_c() - truth.temperature_c).amax();
    assert!(error > 10.0, "{error}");
}

/// Errors drawn as stated: a start off by N(0, 10 K), friction off by N(0, 3 %) and N(0, 0.05 Nm), and a push. The intervals
/// cover, and temperatures do within theirs.
#[test]
fn intervals_cover_errors_of_the_stated_size() {
    let (mut inside, mut all, mut warm_inside, mut warm_all, mut width) = (0_u32, 0_u32, 0_u32, 0_u32, 0.0);
    for seed in 0..40 {
        let mut rng = Pcg64::seed_from_u64(900 + seed);
        let mut draw = |sd: f64| Joints::from_fn(|_, _| sd * rng.sample::<f64, _>(StandardNormal));
        let mut truth = Truth::new(draw(10.0).add_scalar(ROOM_C), seed);
        truth.friction_factor = draw(0.03).add_scalar(1.0);
        truth.more_nm = draw(0.05);
        let mut estimator = ThermalEstimator::new(ThermalSettings::new(joints(), ROOM_C)).unwrap();
        let mut tick = 0;
        for (span, wrench) in [([0.0, 4.0], Wrench::default()), ([4.0, 7.0], push()), ([7.0, 12.0], Wrench::default())]
        {
            truth.run(&mut estimator, span, wrench, |t, truth, e, estimate| {
                tick += 1;
                // Every 0.2 s, not in the 0.2 s in which the push rises through the observer.
                if tick % 100 != 0 || t - span[0] < 0.2 {
                    return;
                }
                let limits = estimate.interval95();
                inside += limits.contain(&wrench).iter().filter(|&&inside| inside).count() as u32;
                width += (limits.upper.force_n - limits.lower.force_n).norm();
                all += 6;
                let sd = e.temperature_sd_k();
                let error = e.temperatures_c() - truth.temperature_c;
                warm_inside += (0..7).filter(|&j| error[j].abs() < 1.96 * sd[j]).count() as u32;
                warm_all += 7;
            });
        }
    }
    let (coverage, warm) = (f64::from(inside) / f64::from(all), f64::from(warm_inside) / f64::from(warm_all));
    println!("wrench {coverage:.3}, temperature {warm:.3}, mean width {:.2} N", width / f64::from(all / 6));
    // The errors of reversals are bounded, not normal, so they cover more.
    assert!((0.93..=0.998).contains(&coverage), "{coverage}");
    // An error that stays for longer than the stated two seconds ends up in the temperature, which is then surer than right.
    assert!(warm > 0.6, "{warm}");
}

#[test]
fn bad_settings_are_named() {
    let good = ThermalSettings::new(joints(), ROOM_C);
    let field = |settings: ThermalSettings<7>| ThermalEstimator::new(settings).unwrap_err().field;
    assert_eq!(field(ThermalSettings { gain_rad_s: 0.0, ..good }), "gain_rad_s");
    assert_eq!(field(ThermalSettings { ambient_c: f64::NAN, ..good }), "ambient_c");
    assert_eq!(field(ThermalSettings { torque_sd_nm: Joints::repeat(-1.0), ..good }), "torque_sd_nm");
    assert_eq!(field(ThermalSettings { initial_c: Joints::repeat(500.0), ..good }), "initial_c");
    let contact = ContactSettings { hold_s: -1.0, ..good.contact };
    let error = ThermalEstimator::new(ThermalSettings { contact, ..good }).unwrap_err();
    assert_eq!(error.to_string(), "thermal estimator: contact.hold_s is -1; allowed: 0 to 1e3 s");
}
