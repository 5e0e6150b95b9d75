//! The tick without its plant: `cargo bench -p tribo-runtime --bench tick`.
//!
//! A recorded second of a tuning trial goes through the loop: sense, estimate, control, limit, record. `with_plant` runs the
//! simulated arm too. Items per second are ticks.

use divan::Bencher;
use divan::counter::ItemsCount;
use nalgebra::SVector;
use tribo_control::{GuardSettings, ImpedanceSettings, PAPER_PHASES_RAD, SinusoidReference};
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_friction::{Compensator, VelocitySource};
use tribo_robot::{Kinematics, Plant, SensorFrame, presets};
use tribo_runtime::{ControlLoop, LoopSettings, ProcessImage, record_ring};
use tribo_sim::{BoxFrictionPlant, Sensors, Truth, TypicalFriction};

/// Ticks before those that are timed: pre-roll, then motion.
const BEFORE: usize = 3000;
/// Ticks per measurement.
const TICKS: usize = 1000;

fn main() {
    divan::main();
}

type Rig<const N: usize> = (ControlLoop<N, WrenchEkf>, BoxFrictionPlant<N>);

fn rig<const N: usize>(truth: Truth<N>, start: SVector<f64, N>) -> Rig<N> {
    let arm = truth.arm.clone();
    let settings = LoopSettings {
        impedance: ImpedanceSettings::default(),
        reference: SinusoidReference::paper(Kinematics::at(&arm, &start).base_from_flange(), PAPER_PHASES_RAD),
        compensator: Compensator::new(truth.friction, VelocitySource::Hybrid),
        guard: Some(GuardSettings::default()),
        dt_s: 1e-3,
    };
    let mut plant = BoxFrictionPlant::new(truth, Sensors::default(), start, 1);
    let mut control = ControlLoop::new(arm, start, settings, WrenchEkf::new(WrenchEkfSettings::default()));
    for _ in 0..BEFORE {
        assert!(control.tick(&mut plant).fault.is_none(), "a trial that runs");
    }
    (control, plant)
}

fn panda() -> Rig<7> {
    rig(Truth::panda_coulomb_viscous(), presets::panda_ready_pose())
}

fn ur10e() -> Rig<6> {
    let start = SVector::from([0.0, -1.57, 1.57, -1.57, -1.57, 0.0]);
    rig(Truth::new(presets::ur10e(), TypicalFriction::ur10e().coulomb_viscous()), start)
}

fn alone<const N: usize>(bencher: Bencher, (control, mut plant): Rig<N>) {
    let mut recording = control.clone();
    let mut image = ProcessImage::of(plant.sample());
    let frames: Vec<SensorFrame<N>> = (0..TICKS)
        .map(|_| {
            let frame = image.frame;
            recording.tick(&mut image);
            plant.actuate(&image.command);
            image.frame = plant.sample();
            frame
        })
        .collect();
    bencher.counter(ItemsCount::new(TICKS)).with_inputs(|| (control.clone(), record_ring(TICKS))).bench_local_values(
        |(mut control, (mut sink, drain))| {
            for (tick, frame) in (0..).zip(&frames) {
                let record = control.tick(&mut ProcessImage::of(*frame));
                sink.push(tick, *record);
            }
            (control, sink, drain)
        },
    );
}

#[divan::bench]
fn seven_joints_1000_ticks(bencher: Bencher) {
    alone(bencher, panda());
}

#[divan::bench]
fn six_joints_1000_ticks(bencher: Bencher) {
    alone(bencher, ur10e());
}

#[divan::bench]
fn seven_joints_1000_ticks_with_plant(bencher: Bencher) {
    let rig = panda();
    bencher.counter(ItemsCount::new(TICKS)).with_inputs(|| rig.clone()).bench_local_values(
        |(mut control, mut plant)| {
            for _ in 0..TICKS {
                divan::black_box(control.tick(&mut plant));
            }
            (control, plant)
        },
    );
}
