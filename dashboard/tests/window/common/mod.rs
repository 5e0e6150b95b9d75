//! Campaigns, windows and clicks of the stories.

#![allow(clippy::unwrap_used, clippy::panic, reason = "test helpers")]

use std::path::{Path, PathBuf};
use std::time::Duration;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tribo_campaign::strategy::StrategyName;
use tribo_campaign::{Campaign, TuneConfig};
use tribo_dashboard::{Dashboard, LogSource, Options, View};
use tribo_trial::PenaltyLimits;

/// Time that passes from frame to frame (s).
pub const FRAME_S: f32 = 0.1;

/// A clock that stands still: journals of equal campaigns are equal to the last byte.
pub fn clock() -> String {
    "2026-01-01T00:00:00.000000+00:00".to_owned()
}

/// Random search of a few trials.
pub fn settings(trials: usize) -> TuneConfig {
    TuneConfig { trials, strategy: StrategyName::Random, ..TuneConfig::default() }
}

/// Settings under which every trial is stopped at once: no error is allowed.
pub fn strict(trials: usize) -> TuneConfig {
    TuneConfig { limits: PenaltyLimits { error_m: 1e-4, ..PenaltyLimits::default() }, ..settings(trials) }
}

/// A finished campaign.
pub fn campaign(directory: &Path, config: TuneConfig) -> PathBuf {
    Campaign::create(directory, config.validate::<7>().unwrap(), clock).unwrap().run(&mut ()).unwrap();
    directory.to_owned()
}

/// Options of a window on `open`, with everything it writes below `scratch`.
pub fn options(scratch: &Path, open: Option<&Path>, view: View) -> Options {
    Options {
        open: open.map(|path| LogSource { path: path.to_owned(), ..LogSource::default() }),
        live: None,
        compare: None,
        view: Some(view),
        clock,
        immediate: true,
        layout: None,
        exports: scratch.join("exports"),
        campaigns: scratch.join("campaigns"),
    }
}

/// A window without display.
pub struct Window {
    /// The window.
    pub harness: Harness<'static, Dashboard>,
}

impl Window {
    /// Opens it and lets it settle.
    pub fn open(options: Options) -> Self {
        let builder =
            Harness::builder().with_size([1280.0, 1000.0]).with_step_dt(FRAME_S).with_accessibility_check(false);
        let harness = builder.build_ui_state(|ui, dashboard: &mut Dashboard| dashboard.ui(ui), Dashboard::new(options));
        let mut window = Self { harness };
        window.frames(6);
        window
    }

    /// Lets frames pass.
    pub fn frames(&mut self, count: usize) {
        self.harness.run_steps(count);
    }

    /// Clicks what has this label.
    #[track_caller]
    pub fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.frames(4);
    }

    /// Whether something with this label, or a part of it, is there.
    pub fn shows(&self, part: &str) -> bool {
        self.harness.query_all_by_label_contains(part).next().is_some()
    }

    /// The window must show this.
    #[track_caller]
    pub fn must_show(&self, part: &str) {
        assert!(self.shows(part), "“{part}” is not shown");
    }

    /// Lets frames pass until something is shown that a thread brings.
    #[track_caller]
    pub fn wait_for(&mut self, part: &str) {
        for _ in 0..2400 {
            if self.shows(part) {
                return;
            }
            std::thread::sleep(Duration::from_millis(50));
            self.frames(3);
        }
        panic!("“{part}” never came");
    }
}
