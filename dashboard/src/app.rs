//! The window: bars, views, keys. It shows what the source hands it.

use std::path::PathBuf;
use std::time::Duration;

use egui::{CentralPanel, Context, Key, Panel, RichText, Theme, Ui};
use tribo_campaign::journal::Clock;
use tribo_model::ModelChoice;

use crate::export;
use crate::export_request;
use crate::help;
use crate::layout::{Layout, Recent};
use crate::live_feed::LiveFeed;
use crate::log_snapshot::LogSource;
use crate::source::{Needs, Source};
use crate::theme;
use crate::view::View;
use crate::views::{ArmView, CampaignView, CompareView, DiagnosisView, LiveView, LogView, StartView, TrialView};

/// Time between two frames that nobody but a running campaign asks for: where a processor has to draw them (OpenGL in
/// software takes 50 ms and more), the campaign does not feel it.
const LIVE: Duration = Duration::from_secs(2);
/// Time between two frames of a robot that is watched.
const ROBOT: Duration = Duration::from_millis(100);

/// What a window is opened with.
#[derive(Clone, Debug)]
pub struct Options {
    /// Campaign or log to open.
    pub open: Option<LogSource>,
    /// Robot to watch.
    pub live: Option<LiveFeed>,
    /// Second campaign of the view Compare.
    pub compare: Option<PathBuf>,
    /// View to begin with.
    pub view: Option<View>,
    /// Tells the time for journals.
    pub clock: Clock,
    /// Whether all work is done at once: every frame is a function of the input.
    pub immediate: bool,
    /// Where the layout is remembered.
    pub layout: Option<PathBuf>,
    /// Where figures are saved.
    pub exports: PathBuf,
    /// Parent of the directories of new campaigns.
    pub campaigns: PathBuf,
}

/// The whole interface.
#[derive(Debug)]
pub struct Dashboard {
    options: Options,
    source: Source,
    layout: Layout,
    saved: Layout,
    path: String,
    /// Campaign and log that were shown last.
    shown: [Recent; 2],
    help: bool,
    starting: bool,
    installed: bool,
    start: StartView,
    campaign: CampaignView,
    trial: TrialView,
    arm: ArmView,
    log: LogView,
    diagnosis: DiagnosisView,
    compare: CompareView,
    live: LiveView,
}

impl Dashboard {
    /// An interface that has shown nothing yet.
    pub fn new(options: Options) -> Self {
        let mut layout = options.layout.as_deref().map(Layout::read).unwrap_or_default();
        let first = options.view.or(options.live.is_some().then_some(View::Live));
        // A robot that was watched last time is not there again.
        let last = if layout.view == View::Live { View::default() } else { layout.view };
        layout.view = first.unwrap_or(last);
        let path = options.open.as_ref().map_or(layout.path.clone(), |open| open.path.display().to_string());
        Self {
            source: Source::new(options.clock, options.immediate),
            start: StartView::new(&options.campaigns),
            saved: layout.clone(),
            layout,
            path,
            shown: Default::default(),
            help: false,
            starting: options.open.is_none() && options.live.is_none(),
            installed: false,
            campaign: CampaignView::default(),
            trial: TrialView::default(),
            arm: ArmView::default(),
            log: LogView::default(),
            diagnosis: DiagnosisView::default(),
            compare: CompareView::default(),
            live: LiveView::default(),
            options,
        }
    }

    /// Where snapshots come from.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Asks for the work that a picture shows and a user would have to ask for.
    pub(crate) fn prepare(&mut self, ctx: &Context, diagnose: bool) {
        let snapshot = self.source.snapshot();
        if self.layout.view == View::Trial
            && snapshot.trial.is_some()
            && snapshot.loop_times.is_none()
            && self.layout.trial_part == 4
        {
            self.source.measure_loop(ctx);
        } else if diagnose
            && snapshot.log.is_some()
            && snapshot.diagnosis.is_none()
            && self.source.diagnosing().is_none()
        {
            self.source.diagnose(ctx);
        }
    }

    /// What is remembered.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// One frame.
    pub fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.begin(&ctx);
        self.keys(&ctx);
        let now_s = ui.input(|input| input.time);
        let needs = if self.starting { Needs::default() } else { self.layout.view.needs() };
        self.source.update(&ctx, now_s, needs);
        // A picture that is held still leaves what comes in the feed, which forgets by itself.
        if !self.live.held && self.source.hear() {
            ctx.request_repaint_after(ROBOT);
        }
        Panel::top("bar").show(ui, |ui| self.bar(ui));
        Panel::bottom("status").show(ui, |ui| self.status(ui));
        CentralPanel::default().show(ui, |ui| self.view(ui, now_s));
        if self.help {
            help::show(&ctx, &mut self.help);
        }
        for request in export_request::take_requests(&ctx) {
            let dark = ctx.theme() == Theme::Dark;
            self.source.message = match export::write(&self.options.exports, &request, dark) {
                Ok(path) => format!("written {}", path.display()),
                Err(error) => error,
            };
        }
        self.remember(&ctx);
        let live = self.source.snapshot().campaign.as_ref().is_some_and(|campaign| !campaign.is_complete());
        if live || self.source.runner().is_some() {
            ctx.request_repaint_after(LIVE);
        }
    }

    /// What is done in the first frame, when there is a context.
    fn begin(&mut self, ctx: &Context) {
        if std::mem::replace(&mut self.installed, true) {
            return;
        }
        theme::install(ctx);
        if let Some(dark) = self.layout.dark {
            ctx.set_theme(if dark { Theme::Dark } else { Theme::Light });
        }
        if let Some(open) = self.options.open.take() {
            self.source.open(ctx, open);
        }
        if let Some(live) = self.options.live.take() {
            self.source.watch_live(live);
        }
        if let Some(other) = self.options.compare.take() {
            self.compare.open(&mut self.source, &other);
        }
    }

    fn keys(&mut self, ctx: &Context) {
        for file in ctx.input(|input| input.raw.dropped_files.clone()) {
            let path = file.path().display().to_string();
            if self.start.takes(&path) {
                (self.source.problem, self.starting) = (None, true);
            } else {
                self.path = path;
                self.open_path(ctx);
            }
        }
        if ctx.text_edit_focused() {
            return;
        }
        let views = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7];
        let pressed = |key: Key| ctx.input(|input| input.key_pressed(key));
        for (view, key) in View::ALL.into_iter().zip(views) {
            if pressed(key) {
                (self.layout.view, self.starting) = (view, false);
            }
        }
        if pressed(Key::F1) || pressed(Key::Questionmark) {
            self.help = !self.help;
        }
        if pressed(Key::Escape) {
            self.help = false;
        }
        if pressed(Key::T) {
            self.toggle_theme(ctx);
        }
        if pressed(Key::Space) {
            self.arm.playing = !self.arm.playing;
        }
        if pressed(Key::ArrowLeft) || pressed(Key::ArrowRight) {
            self.trial.step(&mut self.source, if pressed(Key::ArrowRight) { 1 } else { -1 });
        }
    }

    fn toggle_theme(&mut self, ctx: &Context) {
        let dark = ctx.theme() != Theme::Dark;
        self.layout.dark = Some(dark);
        ctx.set_theme(if dark { Theme::Dark } else { Theme::Light });
    }

    /// Opens what the field of the path says.
    fn open_path(&mut self, ctx: &Context) {
        self.open(ctx, LogSource { path: PathBuf::from(self.path.trim()), ..LogSource::default() });
    }

    fn open(&mut self, ctx: &Context, source: LogSource) {
        let is_log = !source.path.join("campaign.yaml").exists() && source.path.is_file();
        self.source.open(ctx, source);
        self.starting = false;
        match self.layout.view {
            View::Campaign | View::Trial | View::Compare if is_log => self.layout.view = View::Log,
            View::Log | View::Diagnosis if !is_log => self.layout.view = View::Campaign,
            _ => {}
        }
    }

    fn bar(&mut self, ui: &mut Ui) {
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            for view in View::ALL {
                let tab = egui::Button::selectable(self.layout.view == view && !self.starting, view.name());
                if ui.add(tab).clicked() {
                    (self.layout.view, self.starting) = (view, false);
                }
            }
            ui.separator();
            if ui.button("New campaign").clicked() {
                self.starting = true;
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Help").on_hover_text("Keys and gestures (F1)").clicked() {
                    self.help = !self.help;
                }
                let name = if ui.visuals().dark_mode { "Light" } else { "Dark" };
                if ui.button(name).on_hover_text("Change the theme (T)").clicked() {
                    self.toggle_theme(&ui.ctx().clone());
                }
                if let Some(Recent { path, model }) = self.recent(ui) {
                    let source = LogSource { path: PathBuf::from(&path), model, ..LogSource::default() };
                    self.path = path;
                    self.open(&ui.ctx().clone(), source);
                }
                if ui.button("Open").clicked() {
                    self.open_path(&ui.ctx().clone());
                }
                let hint = "campaign directory or log";
                let width = (ui.available_width() - 8.0).clamp(80.0, 420.0);
                let label = ui.add(egui::TextEdit::singleline(&mut self.path).hint_text(hint).desired_width(width));
                if label.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
                    self.open_path(&ui.ctx().clone());
                }
            });
        });
        ui.add_space(4.0);
    }

    /// The menu of what was open before, and what is chosen of it.
    fn recent(&self, ui: &mut Ui) -> Option<Recent> {
        let mut chosen = None;
        ui.add_enabled_ui(!self.layout.recent.is_empty(), |ui| {
            ui.menu_button("Recent", |ui| {
                for recent in &self.layout.recent {
                    if ui.button(&recent.path).clicked() {
                        chosen = Some(recent.clone());
                        ui.close();
                    }
                }
            });
        });
        chosen
    }

    fn status(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            if self.source.busy() {
                // Nothing that turns: every turn would be a frame, drawn while a campaign needs the computer.
                ui.label(RichText::new("at work").small().strong());
            }
            ui.label(RichText::new(&self.source.message).small());
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(
                    RichText::new("wrenches: by the robot on the environment, base axes · joints count from 0")
                        .small()
                        .weak(),
                );
            });
        });
    }

    fn view(&mut self, ui: &mut Ui, now_s: f64) {
        if let Some(problem) = self.source.problem.clone() {
            self.problem(ui, &problem);
            return;
        }
        if self.starting {
            if self.start.ui(ui, &mut self.source) {
                (self.starting, self.layout.view) = (false, View::Campaign);
            }
            return;
        }
        let (source, layout) = (&mut self.source, &mut self.layout);
        match layout.view {
            View::Campaign => {
                if self.campaign.ui(ui, source, layout) {
                    layout.view = View::Trial;
                }
            }
            View::Trial => self.trial.ui(ui, source, layout, self.arm.cursor_s),
            View::Arm => {
                if source.snapshot().trial.is_none() {
                    source.estimate(ui.ctx(), layout.estimator);
                }
                self.arm.ui(ui, source.snapshot(), layout.estimator, now_s);
            }
            View::Log => self.log.ui(ui, source, layout),
            View::Diagnosis => self.diagnosis.ui(ui, source, &self.options.exports),
            View::Compare => self.compare.ui(ui, source),
            View::Live => self.live.ui(ui, source.snapshot()),
        }
    }

    fn problem(&mut self, ui: &mut Ui, problem: &str) {
        ui.add_space(40.0);
        ui.vertical_centered(|ui| {
            ui.heading("This cannot be shown");
            ui.add_space(8.0);
            ui.label(RichText::new(problem).color(theme::bad(ui.visuals().dark_mode)));
            ui.add_space(8.0);
            ui.label("Give another path above, drop a directory or a log on this window, or start a new campaign.");
            ui.add_space(8.0);
            if ui.button("Start a campaign").clicked() {
                (self.source.problem, self.starting) = (None, true);
            }
        });
    }

    /// Saves the layout when it has changed.
    fn remember(&mut self, ctx: &Context) {
        let (snapshot, of_campaign) = (self.source.snapshot(), ModelChoice::default());
        let campaign = snapshot.campaign.as_ref().map(|campaign| (&campaign.directory, &of_campaign));
        let log = snapshot.log.as_ref().map(|log| (&log.source.path, &log.source.model));
        for (shown, open) in self.shown.iter_mut().zip([campaign, log]) {
            if let Some((path, model)) = open.filter(|(path, model)| !shown.is(path, model)) {
                *shown = Recent { path: path.display().to_string(), model: model.clone() };
                self.layout.opened(shown.clone());
            }
        }
        let size = ctx.content_rect().size();
        self.layout.size = [size.x, size.y];
        if let Some(path) = self.options.layout.as_deref().filter(|_| self.layout != self.saved) {
            self.layout.write(path);
            self.saved = self.layout.clone();
        }
    }
}
