//! The tick allocates nothing.
//!
//! A counting allocator (crate `allocation-counter`, one counter per thread) watches a thousand ticks of the whole loop
//! (sense, wrench filter, controller, limits, plant) for every truth and velocity source, then a thousand ticks after a
//! fault. There is no tolerance: one allocation in two thousand ticks is a failure.

use nalgebra::SVector;
use tribo_control::{PAPER_PHASES_RAD, SinusoidReference};
use tribo_friction::{Compensator, JointEffects, VelocitySource};
use tribo_robot::presets;
use tribo_sim::{BoxFrictionPlant, Sensors, Truth, WrenchPulses};
use tribo_tests::{TamperedPlant, all_effects, five_truths, loop_with, ready_flange};

/// Ticks watched before and after the fault.
const TICKS: u64 = 1000;

/// The guard itself can fail: a single boxed number is seen.
#[test]
fn the_counter_sees_one_allocation() {
    let seen = allocation_counter::measure(|| {
        std::hint::black_box(Box::new(1.0_f64));
    });
    assert_eq!(seen.count_total, 1);
}

#[test]
fn no_tick_allocates_healthy_or_faulted() {
    for (name, truth) in five_truths() {
        watch(name, &truth, [JointEffects::default(); 7]);
    }
}

/// The same with a compensator that believes every effect it knows, presliding and its bristle included.
#[test]
fn no_tick_allocates_with_effects() {
    watch("effects", &Truth::panda_coulomb_viscous(), all_effects());
}

fn watch(name: &str, truth: &Truth<7>, effects: [JointEffects; 7]) {
    for velocity in [VelocitySource::Measured, VelocitySource::Reference, VelocitySource::Hybrid] {
        let plant = BoxFrictionPlant::new(truth.clone(), Sensors::default(), presets::panda_ready_pose(), 1)
            .with_pulses(WrenchPulses::each_axis(15.0, 2.5, 0.1, 0.1, 0.05));
        let mut plant = TamperedPlant::new(plant, |tick, mut frame| {
            if tick >= TICKS {
                frame.q = SVector::repeat(f64::NAN);
            }
            frame
        });
        let reference = SinusoidReference::paper(ready_flange(), PAPER_PHASES_RAD);
        let compensator = Compensator::new(truth.friction, velocity).with_effects(effects);
        let mut control = loop_with(reference, compensator);
        let mut faulted = 0;
        for (part, expected_faults) in [("healthy", 0), ("faulted", TICKS)] {
            let seen = allocation_counter::measure(|| {
                for _ in 0..TICKS {
                    let record = std::hint::black_box(control.tick(&mut plant));
                    faulted += u64::from(record.fault.is_some());
                }
            });
            assert_eq!(faulted, expected_faults, "{name} {velocity:?} {part}");
            assert_eq!(seen.count_total, 0, "{name} {velocity:?} {part}: {seen:?}");
        }
    }
}
