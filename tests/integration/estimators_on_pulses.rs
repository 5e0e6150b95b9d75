//! The hand that pushes, seen by the momentum observer and by the friction band: 15 N / 2.5 Nm on each axis in turn.
//!
//! The same trial as `wrench_on_pulses`, one seed, in the loop. Beside the error, the share of (sample, component) pairs
//! whose truth lies in the stated 95 % interval. Bars of the band: the prototype (no compensation: moving 1.2 N / 0.17 Nm,
//! fixed 1.7 / 0.2). The observer is told the band too: it takes the band's mean off, and its interval holds.

use nalgebra::SVector;
use tribo_control::SinusoidReference;
use tribo_friction::{FrictionBand, FrictionModel, JointBand, JointFriction, VelocitySource};
use tribo_residual::{MomentumEstimator, MomentumSettings, QpEstimator, QpSettings, diagonal_prior};
use tribo_robot::WrenchEstimator;
use tribo_sim::{Truth, WrenchPulses};
use tribo_tests::{DT_S, no_friction, ready_flange, tuning_trial};
use tribo_trial::run_trial_observed;

/// Noise of the velocity of the default sensors (rad/s).
const VELOCITY_SD_RAD_S: f64 = 2.9e-3;

#[derive(Clone, Copy, Debug)]
struct Seen {
    force_n: f64,
    moment_nm: f64,
    covered: f64,
}

fn watch<E: WrenchEstimator<7>>(name: &str, friction: &FrictionModel<7>, moving: bool, estimator: E) -> Seen {
    let mut trial = tuning_trial(Truth::panda_coulomb_viscous(), VelocitySource::Hybrid);
    trial.pulses = WrenchPulses::each_axis(15.0, 2.5, 5.0, 2.5, 1.5);
    if !moving {
        trial.reference = SinusoidReference::fixed(ready_flange());
    }
    let (mut force2, mut moment2, mut inside, mut count) = (0.0, 0.0, 0, 0);
    let outcome = run_trial_observed(&trial, friction, estimator, 1, |record, _| {
        let time_s = record.frame.time_s;
        if time_s >= trial.reference.pre_roll_s() {
            let truth = trial.pulses.at(time_s - DT_S);
            assert_eq!(record.estimate.fault, None);
            force2 += (record.estimate.wrench_base.force_n - truth.force_n).norm_squared() / 3.0;
            moment2 += (record.estimate.wrench_base.moment_nm - truth.moment_nm).norm_squared() / 3.0;
            inside += record.estimate.interval95().contain(&truth).iter().filter(|&&inside| inside).count();
            count += 1;
        }
    });
    assert_eq!(outcome.aborted, None);
    let n = f64::from(count);
    let seen =
        Seen { force_n: (force2 / n).sqrt(), moment_nm: (moment2 / n).sqrt(), covered: inside as f64 / (6.0 * n) };
    let motion = if moving { "moving" } else { "fixed" };
    println!(
        "{name}, {motion}: {:.2} N, {:.3} Nm, covered {:.1} %",
        seen.force_n,
        seen.moment_nm,
        100.0 * seen.covered
    );
    seen
}

/// The band of the true friction, as wide at rest as the velocity noise asks for.
fn band() -> FrictionBand<7> {
    let joints = Truth::panda_coulomb_viscous().friction.joints.map(|joint| {
        let JointFriction::CoulombViscous(law) = joint else { unreachable!("the truth is Coulomb and viscous") };
        let band = JointBand::coulomb_viscous(law.coulomb_nm, law.viscous_nm_s_per_rad, VELOCITY_SD_RAD_S, 0.1);
        JointBand { noise_growth_s_per_rad: 5.0, ..band }
    });
    FrictionBand::new(joints).expect("a valid band")
}

fn qp() -> QpEstimator<7> {
    QpEstimator::new(QpSettings { prior: diagonal_prior(8.0, 1.0), ..QpSettings::new(band()) })
}

fn momentum(band: FrictionBand<7>) -> MomentumEstimator<7> {
    let settings = MomentumSettings::new(band);
    MomentumEstimator::new(MomentumSettings { velocity_sd_rad_s: SVector::repeat(VELOCITY_SD_RAD_S), ..settings })
}

/// Where nothing is compensated the band is worth half of the error of an observer that knows of no friction. One that knows
/// the band's mean is as good while the joints slide, and no better than it is where they stand.
#[test]
fn the_band_sees_through_friction_that_is_not_compensated() {
    for (moving, force_bar_n, moment_bar_nm) in [(true, 1.2, 0.17), (false, 1.7, 0.2)] {
        let band = watch("band", &no_friction(), moving, qp());
        let observer = watch("momentum", &no_friction(), moving, momentum(self::band()));
        let unaware = FrictionBand::new([JointBand::frictionless(0.1); 7]).expect("a valid band");
        let unaware = watch("momentum, unaware", &no_friction(), moving, momentum(unaware));
        assert!(band.force_n < force_bar_n && band.moment_nm < moment_bar_nm, "{band:?}");
        assert!(band.force_n < 0.75 * unaware.force_n && band.moment_nm < 0.75 * unaware.moment_nm, "{unaware:?}");
        let part = if moving { 0.6 } else { 1.0 };
        assert!(observer.force_n < part * unaware.force_n, "{observer:?} {unaware:?}");
        assert!(observer.moment_nm < part * unaware.moment_nm, "{observer:?} {unaware:?}");
        // The observer remembers that joints which slid without compensation stand with much friction; 91 % without.
        assert!(band.covered > 0.95 && observer.covered > 0.89, "{band:?} {observer:?}");
    }
}

#[test]
fn intervals_hold_with_compensation_too() {
    let truth = Truth::panda_coulomb_viscous();
    for moving in [true, false] {
        let band = watch("band, compensated", &truth.friction, moving, qp());
        let observer = watch("momentum, compensated", &truth.friction, moving, momentum(self::band()));
        assert!(band.covered > 0.95 && observer.covered > 0.95, "{band:?} {observer:?}");
    }
}
