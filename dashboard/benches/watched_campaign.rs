//! A campaign alone and the same campaign watched, in turns: what does looking at it cost?
//!
//! ```text
//! slowdown = (median of watched) / (median of alone) − 1
//! ```
//!
//! `cargo bench -p tribo-dashboard --bench watched_campaign` prints it for the time on the wall, for the CPU time of the
//! campaign's threads and for that of the whole process, the window's work included. It fails above 5 % of CPU time of the
//! process: the one figure that other programs of the computer change little. The window is the real interface, drawn into
//! triangles whenever it asks for a frame; what a graphics driver adds is not in it. `TRIALS` and `PAIRS` in the environment
//! change the length.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use egui::{Context, Pos2, RawInput, Rect, ViewportId, vec2};
use tribo_campaign::{Campaign, TuneConfig};
use tribo_dashboard::{Dashboard, LogSource, Options, View};

/// What a watched campaign may cost more than one alone.
const MOST: f64 = 0.05;

/// Times of one campaign (s).
#[derive(Clone, Copy)]
struct Spent {
    wall: f64,
    campaign: f64,
    process: f64,
}

fn main() -> ExitCode {
    let number = |name: &str, usual: usize| {
        std::env::var(name).ok().and_then(|text| text.parse().ok()).filter(|n| *n > 0).unwrap_or(usual)
    };
    let (trials, pairs) = (number("TRIALS", 50), number("PAIRS", 5));
    let scratch = std::env::temp_dir().join(format!("tribo-watched-{}", std::process::id()));
    // What the first campaign pays alone, pages and caches, is nobody's slowdown.
    run(&scratch.join("warm"), trials.min(10), false);
    let (mut alone, mut watched) = (Vec::new(), Vec::new());
    for pair in 0..pairs {
        // Alone first in every other pair: a computer that gets busier does not look like a slowdown.
        for watching in if pair % 2 == 0 { [false, true] } else { [true, false] } {
            let spent = run(&scratch.join(format!("{pair}-{watching}")), trials, watching);
            let name = if watching { "watched" } else { "alone  " };
            println!(
                "{name}: {:.2} s on the wall; CPU: campaign {:.2} s, process {:.2} s",
                spent.wall, spent.campaign, spent.process
            );
            if watching { watched.push(spent) } else { alone.push(spent) }
        }
    }
    // What cannot be removed stays in the system's temporary directory.
    let _ = std::fs::remove_dir_all(&scratch);
    let slowdown = |of: fn(&Spent) -> f64| median(&watched, of) / median(&alone, of) - 1.0;
    let process = slowdown(|spent| spent.process);
    println!(
        "{trials} trials, medians of {pairs} pairs: watching costs {:+.1} % on the wall, {:+.1} % of the campaign's CPU time, \
         {:+.1} % of the process's (allowed: {:.0} %)",
        100.0 * slowdown(|spent| spent.wall),
        100.0 * slowdown(|spent| spent.campaign),
        100.0 * process,
        100.0 * MOST
    );
    if process <= MOST { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn median(all: &[Spent], of: fn(&Spent) -> f64) -> f64 {
    let mut values: Vec<f64> = all.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
}

/// Runs one campaign to its end, with or without a window on it.
fn run(directory: &Path, trials: usize, watching: bool) -> Spent {
    let config = TuneConfig { trials, ..TuneConfig::default() };
    let tune = config.validate::<7>().expect("default settings are valid");
    let pool = rayon::ThreadPoolBuilder::new().build().expect("threads of the trials");
    let campaign = Campaign::create(directory, tune, clock).expect("a fresh directory");
    let ended = Arc::new(AtomicBool::new(false));
    let window = watching.then(|| {
        let (directory, ended) = (directory.to_owned(), Arc::clone(&ended));
        std::thread::spawn(move || watch(&directory, &ended))
    });
    let (started, process) = (Instant::now(), process_s());
    let threads = |pool: &rayon::ThreadPool| pool.broadcast(|_| thread_s()).iter().sum::<f64>();
    let before = threads(&pool);
    pool.install(|| campaign.run(&mut ())).expect("a campaign that runs");
    let wall = started.elapsed().as_secs_f64();
    let spent = Spent { wall, campaign: threads(&pool) - before, process: process_s() - process };
    ended.store(true, Ordering::SeqCst);
    if let Some(window) = window {
        window.join().expect("the window's thread");
    }
    spent
}

/// Draws a frame whenever the interface asks for one, until the campaign has ended.
fn watch(directory: &Path, ended: &AtomicBool) {
    let mut dashboard = Dashboard::new(Options {
        open: Some(LogSource { path: directory.to_owned(), ..LogSource::default() }),
        live: None,
        compare: None,
        view: Some(View::Campaign),
        clock,
        immediate: false,
        layout: None,
        exports: directory.to_owned(),
        campaigns: directory.to_owned(),
    });
    let (ctx, started) = (Context::default(), Instant::now());
    let (wake, woken) = channel();
    ctx.set_request_repaint_callback(move |info| {
        // After the last frame nobody listens.
        let _ = wake.send(info.delay);
    });
    while !ended.load(Ordering::SeqCst) {
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, vec2(1280.0, 800.0))),
            time: Some(started.elapsed().as_secs_f64()),
            ..RawInput::default()
        };
        let output = ctx.run_ui(input, |ui| dashboard.ui(ui));
        let asked = output.viewport_output.get(&ViewportId::ROOT).map(|viewport| viewport.repaint_delay);
        drop(ctx.tessellate(output.shapes, output.pixels_per_point));
        let mut due = Instant::now() + asked.unwrap_or(Duration::MAX).min(Duration::from_secs(5));
        // A job that has ended may ask for an earlier frame.
        while !ended.load(Ordering::SeqCst) && Instant::now() < due {
            let pause = due.saturating_duration_since(Instant::now()).min(Duration::from_millis(50));
            if let Ok(delay) = woken.recv_timeout(pause) {
                due = due.min(Instant::now() + delay);
            }
        }
    }
}

fn clock() -> String {
    "2026-01-01T00:00:00.000000+00:00".to_owned()
}

/// CPU time of this thread (s).
fn thread_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split_whitespace().next().and_then(|first| first.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
}

/// CPU time of this process, user and system, with the threads that have ended (s).
fn process_s() -> f64 {
    /// Unit of these figures on Linux, whatever its kernel's own clock does.
    const TICKS_PER_S: f64 = 100.0;
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name of the program, in brackets, may hold spaces; `utime` and `stime` are the 12th and 13th word after it.
    let words = text.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(2);
    words.filter_map(|word| word.parse::<f64>().ok()).sum::<f64>() / TICKS_PER_S
}
