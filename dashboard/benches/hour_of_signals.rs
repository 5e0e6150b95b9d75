//! One hour of sixty channels at 1 kHz, moved and zoomed, without a window: CPU time of a frame and peak memory.
//!
//! `cargo bench -p tribo-dashboard --bench hour_of_signals` prints both and fails if more than one frame in a hundred takes
//! longer than a thirtieth of a second of CPU time, or above 2 GB. The zoom goes from the whole hour to single samples and back.

use std::process::ExitCode;
use std::time::Instant;

use egui::{Context, Event, PointerButton, Pos2, RawInput, Rect, pos2, vec2};
use tribo_dashboard::channels;
use tribo_figure::{Signal, Signals};

const ROWS: usize = 3_600_000;
const QUANTITIES: usize = 9;
const CHANNELS: usize = 60;
const FRAMES: usize = 260;
/// Frames that make the letters.
const WARM: usize = 10;
/// A thirtieth of a second (ms).
const MOST_MS: f64 = 1e3 / 30.0;
const MOST_BYTES: f64 = 2e9;

fn main() -> ExitCode {
    let started = Instant::now();
    let signals = recording();
    println!("{CHANNELS} channels × {ROWS} samples, made ready in {:.1} s", started.elapsed().as_secs_f64());

    let ctx = Context::default();
    let screen = Rect::from_min_size(Pos2::ZERO, vec2(1920.0, 1080.0));
    let middle = pos2(500.0, 150.0);
    let mut times_ms = Vec::new();
    let mut slowest = (0, 0.0);
    for frame in 0..FRAMES {
        let started_s = cpu_s();
        let input = RawInput {
            screen_rect: Some(screen),
            time: Some(frame as f64 / 30.0),
            events: gesture(frame, middle),
            ..RawInput::default()
        };
        let output = ctx.run_ui(input, |ui| channels(ui, &signals));
        let triangles = ctx.tessellate(output.shapes, output.pixels_per_point);
        assert!(!triangles.is_empty());
        times_ms.push((cpu_s() - started_s) * 1e3);
        if frame >= WARM && times_ms[frame] > slowest.1 {
            slowest = (frame, times_ms[frame]);
        }
    }
    let mut settled = times_ms.split_off(WARM);
    settled.sort_by(f64::total_cmp);
    let at = |p: f64| settled[(p * (settled.len() - 1) as f64) as usize];
    let mean_ms = settled.iter().sum::<f64>() / settled.len() as f64;
    let peak = peak_bytes().unwrap_or(0.0);
    println!(
        "CPU time of a frame: mean {mean_ms:.1} ms, median {:.1} ms, 99 % {:.1} ms, longest {:.1} ms (frame {}); peak memory {:.2} GB",
        at(0.5),
        at(0.99),
        at(1.0),
        slowest.0,
        peak * 1e-9
    );
    if at(0.99) <= MOST_MS && peak <= MOST_BYTES { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Drag for a while, zoom in for a while, drag again, zoom out.
fn gesture(frame: usize, middle: Pos2) -> Vec<Event> {
    let modifiers = egui::Modifiers::default();
    let button =
        |pressed: bool, pos: Pos2| Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers };
    match frame {
        0 => vec![Event::PointerMoved(middle)],
        20 | 140 => vec![button(true, middle)],
        21..80 | 141..180 => vec![Event::PointerMoved(middle + vec2((frame % 60) as f32 * 6.0, 0.0))],
        80 | 180 => vec![button(false, middle), Event::PointerMoved(middle)],
        90..140 => vec![Event::Zoom(1.2)],
        190..250 => vec![Event::Zoom(0.84)],
        _ => Vec::new(),
    }
}

/// Sums of sines with noise, seven channels per quantity.
#[allow(clippy::cast_possible_truncation, reason = "a sensor's 24 bits")]
fn recording() -> Signals {
    let time_s: Vec<f64> = (0..ROWS).map(|k| k as f64 * 1e-3).collect();
    let channel = |c: usize| {
        let mut state = c as u32 + 1;
        let samples = time_s.iter().map(|t| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = f64::from(state >> 8) / 16_777_216.0 - 0.5;
            ((0.3 + 0.01 * c as f64) * t).sin() as f32 + 0.2 * noise as f32
        });
        Signal::new(format!("channel {c}"), format!("quantity {} [Nm]", c * QUANTITIES / CHANNELS), samples.collect())
    };
    let channels = (0..CHANNELS).map(channel).collect();
    Signals::new(time_s, channels)
}

/// CPU time of this thread (s): on a busy computer the clock on the wall would measure its other programs.
fn cpu_s() -> f64 {
    let nanoseconds = std::fs::read_to_string("/proc/thread-self/schedstat").ok().and_then(|text| {
        let spent: f64 = text.split_whitespace().next()?.parse().ok()?;
        Some(spent)
    });
    match nanoseconds {
        Some(nanoseconds) => nanoseconds * 1e-9,
        None => START.elapsed().as_secs_f64(),
    }
}

static START: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);

/// `VmHWM` of Linux.
fn peak_bytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kib| kib * 1024.0)
}
