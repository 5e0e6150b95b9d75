//! Runs a given number of ticks, for a counter of instructions: `ticks tick|period COUNT`.
//!
//! `tick` is the loop on sensor frames recorded before, up to the push into the ring; `period` is the loop and the simulated
//! arm. What comes before does not depend on COUNT: the difference of two counts is the ticks.

use std::process::ExitCode;

use tribo_control::{PAPER_PHASES_RAD, SinusoidReference};
use tribo_friction::{Compensator, VelocitySource};
use tribo_robot::{Plant, SensorFrame, presets};
use tribo_runtime::{ProcessImage, record_ring};
use tribo_sim::{BoxFrictionPlant, Sensors, Truth};
use tribo_tests::{loop_with, ready_flange};

/// Ticks before those that are counted: pre-roll, then motion.
const BEFORE: usize = 3000;
/// Frames that are recorded.
const FRAMES: usize = 2000;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (Some(what), Some(count)) = (arguments.first(), arguments.get(1).and_then(|count| count.parse().ok())) else {
        eprintln!("usage: ticks tick|period COUNT");
        return ExitCode::FAILURE;
    };
    let truth = Truth::panda_coulomb_viscous();
    let compensator = Compensator::new(truth.friction, VelocitySource::Hybrid);
    let mut plant = BoxFrictionPlant::new(truth, Sensors::default(), presets::panda_ready_pose(), 1);
    let mut control = loop_with(SinusoidReference::paper(ready_flange(), PAPER_PHASES_RAD), compensator);
    for _ in 0..BEFORE {
        control.tick(&mut plant);
    }
    match what.as_str() {
        "tick" => {
            let mut recording = control.clone();
            let frames: Vec<SensorFrame<7>> = (0..FRAMES)
                .map(|_| {
                    let mut image = ProcessImage::of(plant.sample());
                    recording.tick(&mut image);
                    plant.actuate(&image.command);
                    image.frame
                })
                .collect();
            let (mut sink, mut drain) = record_ring(16);
            let start = control.clone();
            for (tick, frame) in (0..).zip(frames.iter().cycle().take(count)) {
                // The frames begin again, and so does the loop that was there.
                if tick % FRAMES as u64 == 0 {
                    control = start.clone();
                }
                let record = control.tick(&mut ProcessImage::of(*frame));
                sink.push(tick, *record);
                std::hint::black_box(drain.pop());
            }
        }
        _ => {
            for _ in 0..count {
                std::hint::black_box(control.tick(&mut plant));
            }
        }
    }
    ExitCode::SUCCESS
}
