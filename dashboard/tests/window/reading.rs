//! What a reader does with figures: points at them, zooms, hides a curve, compares, leaves and comes back.

use std::path::{Path, PathBuf};

use egui::{Event, Shape, pos2};
use egui_kittest::kittest::Queryable;
use tribo_dashboard::{LogSource, Options, View};
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_logs::write_parquet;
use tribo_model::ModelChoice;
use tribo_trial::simulate_log;

use crate::common::{Window, campaign, options, settings};

/// A log of an arm whose friction nobody cancels.
fn log(directory: &Path) -> PathBuf {
    let tune = settings(1).validate::<7>().expect("settings");
    let estimator = WrenchEkf::new(WrenchEkfSettings::default());
    let friction = tune.space.friction(&tune.space.zero());
    let (_, log) = simulate_log(&tune.trial, &friction, estimator, 1).expect("a log");
    let path = directory.join("log.parquet");
    write_parquet(&path, &log).expect("a file");
    path
}

/// Everything that is written in the window, in and outside of figures.
fn texts(window: &Window) -> Vec<String> {
    fn of(shape: &Shape, texts: &mut Vec<String>) {
        match shape {
            Shape::Text(text) => texts.push(text.galley.text().to_owned()),
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| of(shape, texts)),
            _ => {}
        }
    }
    let mut texts = Vec::new();
    window.harness.output().shapes.iter().for_each(|clipped| of(&clipped.shape, &mut texts));
    texts
}

/// The middle of the axes below the first figure's title: figures of a log are 400 px wide and more.
const IN_THE_FIRST_FIGURE: egui::Pos2 = pos2(250.0, 330.0);

/// The pointer in one figure reads out its curves there, with unit and interval.
#[test]
fn pointing_reads_out() {
    let dir = tempfile::tempdir().unwrap();
    let path = log(dir.path());
    let mut window = Window::open(options(dir.path(), Some(&path), View::Log));
    window.must_show("against O_F_ext");
    assert!(!texts(&window).iter().any(|text| text.contains("time of the log [s]: ")));
    window.harness.event(Event::PointerMoved(IN_THE_FIRST_FIGURE));
    window.frames(3);
    let all = texts(&window);
    let told = all.iter().find(|text| text.contains("time of the log [s]: ")).expect("a read-out");
    assert!(told.starts_with("force x [N], base axes") && told.contains("Kalman filter: "), "{told}");
    assert!(told.contains(" to ") && told.contains("O_F_ext of the log: 0"), "{told}");
}

/// Zooming one figure zooms the time of all: the last tick leaves all six.
#[test]
fn time_axes_move_together() {
    let dir = tempfile::tempdir().unwrap();
    let path = log(dir.path());
    let mut window = Window::open(options(dir.path(), Some(&path), View::Log));
    let last_ticks = |window: &Window| texts(window).iter().filter(|text| *text == "30").count();
    assert_eq!(last_ticks(&window), 6);
    window.harness.event(Event::PointerMoved(IN_THE_FIRST_FIGURE));
    window.harness.event(Event::Zoom(4.0));
    window.frames(4);
    assert_eq!(last_ticks(&window), 0);
}

/// Every estimator can be chosen on a log; one that lacks a sensor says so in place of a wrench.
#[test]
fn estimators_of_a_log() {
    let dir = tempfile::tempdir().unwrap();
    let path = log(dir.path());
    let mut window = Window::open(options(dir.path(), Some(&path), View::Log));
    window.must_show("mean NIS");
    window.click("momentum observer");
    window.must_show("against O_F_ext");
    assert!(!window.shows("mean NIS"), "an observer has no innovation");
    assert!(texts(&window).iter().any(|text| text == "momentum observer"));

    window.click("Compare");
    window.must_show("Estimators side by side");
    window.wait_for("RMSE force [N]");
    let rows = |window: &Window, name: &str| texts(window).iter().filter(|text| *text == name).count();
    // A box to tick, a row of the table, six legends.
    for name in ["Kalman filter", "momentum observer", "friction-band programme", "thermal sensor"] {
        assert_eq!(rows(&window, name), 8, "{name}");
    }
    assert_eq!(rows(&window, "two encoders"), 1, "this log has one encoder per joint");
    window.harness.get_all_by_label("thermal sensor").next().unwrap().click();
    window.frames(4);
    assert_eq!(rows(&window, "thermal sensor"), 1);
}

/// A click on a name in the legend hides the curve.
#[test]
fn a_legend_hides_and_shows() {
    let dir = tempfile::tempdir().unwrap();
    let one = campaign(&dir.path().join("one"), settings(2));
    let mut window = Window::open(options(dir.path(), Some(&one), View::Trial));
    window.must_show("Trial");
    let drawn = |window: &Window| window.harness.output().shapes.len();
    let all = drawn(&window);
    window.harness.get_all_by_label("no compensation").next().unwrap().click();
    window.frames(4);
    assert!(drawn(&window) < all, "{} of {all}", drawn(&window));
    window.harness.get_all_by_label("no compensation").next().unwrap().click();
    window.frames(4);
    assert_eq!(drawn(&window), all);
}

/// Who comes back finds view, theme and campaign as they were left.
#[test]
fn the_layout_is_remembered() {
    let dir = tempfile::tempdir().unwrap();
    let one = campaign(&dir.path().join("one"), settings(1));
    let layout = Some(dir.path().join("config/dashboard.json"));
    let mut window =
        Window::open(Options { layout: layout.clone(), ..options(dir.path(), Some(&one), View::Campaign) });
    window.click("Arm");
    let dark = window.shows("Light");
    window.harness.key_press(egui::Key::T);
    window.frames(3);
    drop(window);
    let mut window = Window::open(Options { layout, view: None, ..options(dir.path(), None, View::Campaign) });
    assert_ne!(window.shows("Light"), dark);
    window.click("Open");
    window.must_show("panda, trial 0");
}

/// What was open is in a menu, a log with the robot that it was opened with.
#[test]
fn recent_logs_come_back_with_their_robot() {
    let dir = tempfile::tempdir().unwrap();
    let (log, one) = (log(dir.path()), campaign(&dir.path().join("one"), settings(1)));
    let layout = Some(dir.path().join("config/dashboard.json"));
    let fr3 = ModelChoice { robot: Some("fr3".to_owned()), ..ModelChoice::default() };
    let open = Some(LogSource { path: log.clone(), model: fr3, ..LogSource::default() });
    let window = Window::open(Options { open, layout: layout.clone(), ..options(dir.path(), None, View::Log) });
    window.must_show("the bare fr3");
    drop(window);

    let mut window = Window::open(Options { layout, ..options(dir.path(), Some(&one), View::Campaign) });
    window.must_show("1 of 1 trials");
    window.click("Recent");
    window.must_show(&one.display().to_string());
    window.click(&log.display().to_string());
    window.must_show("the bare fr3");
}
