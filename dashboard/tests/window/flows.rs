//! The stories of the window: labels are clicked, time passes by frames.

use std::io::Write;
use std::path::Path;

use egui_kittest::kittest::{NodeT, Queryable};
use tribo_campaign::{TuneConfig, TunedLaw};
use tribo_dashboard::{Options, View};
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_logs::write_parquet;
use tribo_trial::scenario::{ModelError, TruthName};
use tribo_trial::simulate_log;

use crate::common::{FRAME_S, Window, campaign, options, settings, strict};

/// Start → pause → go on → finish → save a figure in every format.
#[test]
fn a_campaign_from_start_to_export() {
    let dir = tempfile::tempdir().unwrap();
    let mut window = Window::open(options(dir.path(), None, View::Campaign));
    window.must_show("Tune the friction compensator");
    window.harness.get_by_label("Trials").set_value_accesskit(3.0);
    window.frames(3);
    window.click("Start");
    window.click("Pause");
    window.must_show("Go on");
    window.click("Go on");
    window.wait_for("3 of 3 trials");
    window.wait_for("the campaign has finished");
    assert!(dir.path().join("campaigns/0001/tuned.yaml").exists());
    // In the cost of every trial, and beside either parameter of the joint.
    assert_eq!(window.harness.get_all_by_label("true friction").count(), 3);

    for format in ["PNG", "SVG", "CSV"] {
        window.harness.get_all_by_label("save").next().unwrap().click();
        window.frames(4);
        window.click(&format!("Cost of every trial as {format}"));
    }
    let exported = |name: &str| std::fs::read(dir.path().join("exports").join(name)).unwrap();
    let csv = String::from_utf8(exported("cost-of-every-trial.csv")).unwrap();
    assert!(csv.lines().count() > 4 && csv.contains("complete,2,"), "{csv}");
    assert!(String::from_utf8(exported("cost-of-every-trial.svg")).unwrap().contains("cost J [N + Nm]"));
    assert!(exported("cost-of-every-trial.png").starts_with(b"\x89PNG"));

    window.click("Write report");
    window.wait_for("report.html");
    assert!(dir.path().join("campaigns/0001/report.html").exists());
}

/// A campaign on a robot that only a file describes; a file that is none is refused with its name.
#[test]
fn a_campaign_on_a_robot_of_ones_own() {
    let dir = tempfile::tempdir().unwrap();
    let urdf = dir.path().join("mine.urdf");
    std::fs::write(&urdf, tribo_robot::urdf::to_urdf(&tribo_robot::presets::xarm6())).unwrap();
    let start = |robot: &str| {
        let mut window = Window::open(options(dir.path(), None, View::Campaign));
        window.harness.get_by_label("Or a robot file").focus();
        window.frames(2);
        window.harness.get_by_label("Or a robot file").type_text(robot);
        window.harness.get_by_label("Trials").set_value_accesskit(1.0);
        window.frames(3);
        window.click("Start");
        window
    };
    start("nowhere.urdf").must_show("nowhere.urdf");
    start(&urdf.display().to_string()).must_show("the friction of this robot is not known");
    let known = std::fs::read_to_string(&urdf).unwrap();
    let known = known.replace("<limit ", "<dynamics damping=\"1\" friction=\"1\"/><limit ");
    std::fs::write(&urdf, known).unwrap();
    start(&urdf.display().to_string()).wait_for("1 of 1 trials");
    let settings = std::fs::read_to_string(dir.path().join("campaigns/0001/campaign.yaml")).unwrap();
    assert!(settings.contains("mine.urdf"), "{settings}");
}

/// Stop leaves a campaign that can be gone on with, to the same result.
#[test]
fn stop_and_resume() {
    let dir = tempfile::tempdir().unwrap();
    let whole = campaign(&dir.path().join("whole"), settings(8));
    let mut window = Window::open(options(dir.path(), None, View::Campaign));
    window.click("New campaign");
    window.harness.get_by_label("Trials").set_value_accesskit(8.0);
    // The strategy of `settings`, by its name in the list.
    window.harness.get_by_label("Strategy").click();
    window.frames(4);
    window.harness.get_by_label_contains("random:").click();
    window.frames(4);
    window.click("Start");
    window.click("Stop");
    window.wait_for("Resume goes on");
    window.click("Resume");
    window.wait_for("8 of 8 trials");
    window.wait_for("the campaign has finished");
    let tuned = |directory: &Path| std::fs::read_to_string(directory.join("tuned.yaml")).unwrap();
    assert_eq!(tuned(&whole), tuned(&dir.path().join("campaigns/0001")));
}

/// A campaign that somebody else runs is followed; a torn last line is said and does no harm.
#[test]
fn a_running_campaign_with_a_torn_journal() {
    let dir = tempfile::tempdir().unwrap();
    let whole = campaign(&dir.path().join("whole"), settings(3));
    let journal = std::fs::read_to_string(whole.join("journal.log")).unwrap();
    // Up to the middle of the line after the first trial's end.
    let end = journal.find("\"op_code\":6").unwrap();
    let cut = end + journal[end..].find('\n').unwrap() + 30;
    let running = dir.path().join("running");
    std::fs::create_dir_all(running.join("trials")).unwrap();
    std::fs::copy(whole.join("campaign.yaml"), running.join("campaign.yaml")).unwrap();
    for entry in std::fs::read_dir(whole.join("trials")).unwrap().flatten() {
        std::fs::copy(entry.path(), running.join("trials").join(entry.file_name())).unwrap();
    }
    std::fs::write(running.join("journal.log"), &journal[..cut]).unwrap();

    let mut window = Window::open(options(dir.path(), Some(&running), View::Campaign));
    window.must_show("1 of 3 trials");
    window.must_show("last line is incomplete");
    window.must_show("Resume");
    let mut file = std::fs::OpenOptions::new().append(true).open(running.join("journal.log")).unwrap();
    file.write_all(&journal.as_bytes()[cut..]).unwrap();
    // Less than the time between two looks at the journal: nothing has been noticed yet.
    window.frames(1);
    window.frames((0.6 / FRAME_S) as usize + 1);
    window.must_show("3 of 3 trials");
    assert!(!window.shows("last line is incomplete"));
}

/// What a campaign learnt of the arm stands above its figures: the law that it went over to, and why it ended.
#[test]
fn what_was_learnt_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let config = TuneConfig { truth: TruthName::Stribeck, ..TuneConfig::default() };
    let ended = campaign(&dir.path().join("ended"), config);
    let window = Window::open(options(dir.path(), Some(&ended), View::Campaign));
    window.must_show("on the friction law is Stribeck: it is expected to lower J from");
    window.must_show("nothing left to gain: ");

    // A payload that nobody told.
    let model_error = ModelError { payload_kg: 0.5, ..ModelError::default() };
    let config = TuneConfig { model_error, trials: 2, ..TuneConfig::default() };
    let laden = campaign(&dir.path().join("laden"), config);
    let window = Window::open(options(dir.path(), Some(&laden), View::Campaign));
    window.must_show(": something else is at work in this robot");
}

/// Failed trials are in sight with their reason, and lead to the trial.
#[test]
fn a_failed_trial_tells_its_reason() {
    let dir = tempfile::tempdir().unwrap();
    let failed = campaign(&dir.path().join("failed"), strict(2));
    let mut window = Window::open(options(dir.path(), Some(&failed), View::Campaign));
    window.must_show("All 2 trials so far have failed");
    window.must_show("2 of 2 trials, 2 failed");
    window.harness.get_by_label_contains("trial 1: tool error at").click();
    window.frames(6);
    window.must_show("Trial 1");
    window.must_show("failed at");
    window.click("Previous");
    window.must_show("Trial 0");
}

/// Scrubbing moves the arm; playing moves it with the time of the frames.
#[test]
fn scrubbing_and_playing() {
    let dir = tempfile::tempdir().unwrap();
    let one = campaign(&dir.path().join("one"), settings(1));
    let mut window = Window::open(options(dir.path(), Some(&one), View::Arm));
    let shown = |window: &Window| -> f64 {
        let slider = window.harness.get_all_by_label("time [s]").last().unwrap();
        slider.value().unwrap().parse().unwrap()
    };
    let configuration = |window: &Window| {
        let line = window.harness.get_by_label_contains("q [rad]:");
        line.value().or_else(|| line.accesskit_node().label()).expect("the angles")
    };
    window.harness.get_all_by_label("time [s]").last().unwrap().set_value_accesskit(5.0);
    window.frames(2);
    assert!((shown(&window) - 5.0).abs() < 1e-6);
    let before = configuration(&window);
    window.harness.get_all_by_label("time [s]").last().unwrap().set_value_accesskit(7.0);
    window.frames(2);
    assert_ne!(configuration(&window), before);
    window.harness.get_by_label("Play").click();
    // The click takes frames of its own; from here on time is counted.
    window.frames(4);
    let from = shown(&window);
    window.frames(10);
    let passed = shown(&window) - from;
    assert!((passed - 10.0 * f64::from(FRAME_S)).abs() < 0.011, "{passed}");
    window.click("Pause");
    let at = shown(&window);
    window.frames(5);
    assert_eq!(shown(&window), at);
}

/// A log is held against the bare arm: verdict, evidence, alternatives, gain.
#[test]
fn a_diagnosis_shows_its_evidence() {
    let dir = tempfile::tempdir().unwrap();
    let tune = settings(1).validate::<7>().unwrap();
    let estimator = WrenchEkf::new(WrenchEkfSettings::default());
    let friction = tune.space.friction(&tune.space.zero());
    let (_, log) = simulate_log(&tune.trial, &friction, estimator, 1).unwrap();
    let path = dir.path().join("log.parquet");
    write_parquet(&path, &log).unwrap();

    let mut window = Window::open(options(dir.path(), Some(&path), View::Log));
    window.must_show("33000 samples");
    window.must_show("against O_F_ext");
    window.click("Channels");
    window.must_show("joint velocity [rad/s]");
    window.click("Diagnosis");
    window.must_show("What does the model get wrong");
    window.click("Diagnose this log");
    window.wait_for("Findings");
    window.must_show("Why this verdict");
    window.must_show("held-out gain");
    window.must_show("dry friction");
    window.must_show("Removes ");
    window.click("Write report");
    window.wait_for("log-diagnosis.html");
    let page = std::fs::read_to_string(dir.path().join("exports/log-diagnosis.html")).unwrap();
    assert!(page.contains("dry friction") && page.contains("the bare panda without friction"));
}

/// What is no campaign and no log is said, with what to do.
#[test]
fn wrong_directories() {
    let dir = tempfile::tempdir().unwrap();
    let mut window = Window::open(options(dir.path(), Some(&dir.path().join("nowhere")), View::Campaign));
    window.must_show("there is no such file or directory");
    window.click("Start a campaign");
    window.must_show("Tune the friction compensator");

    let empty = dir.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    let window = Window::open(options(dir.path(), Some(&empty), View::Campaign));
    window.must_show("holds no campaign.yaml");

    let broken = campaign(&dir.path().join("broken"), settings(1));
    std::fs::write(broken.join("journal.log"), "nonsense\n").unwrap();
    let window = Window::open(options(dir.path(), Some(&broken), View::Campaign));
    window.must_show("corrupt journal");
}

/// Two campaigns beside each other: curves, facts, parameters; of another friction law there are none to compare.
#[test]
fn two_campaigns_side_by_side() {
    let dir = tempfile::tempdir().unwrap();
    let one = campaign(&dir.path().join("one"), settings(2));
    let two = campaign(&dir.path().join("two"), TuneConfig { seed: 2, ..strict(1) });
    let stribeck = TuneConfig { friction: TunedLaw::Stribeck, ..settings(1) };
    let stribeck = campaign(&dir.path().join("stribeck"), stribeck);
    let against = |other: &Path| {
        let options = Options { compare: Some(other.to_owned()), ..options(dir.path(), Some(&one), View::Compare) };
        Window::open(options)
    };

    let window = against(&two);
    window.must_show("2 of 2, 0 failed");
    window.must_show("1 of 1, 1 failed");
    // None of the other's trials came to its end: there is no best one.
    assert!(!window.shows("Best parameters"));

    let mut window = against(&stribeck);
    window.must_show("parameters cannot be compared");
    window.click("Compare both");
    window.must_show("parameters cannot be compared");

    let window = against(&one);
    window.must_show("Best parameters");
    window.must_show("J / J with the true friction");
    let window = against(&dir.path().join("nowhere"));
    window.must_show("nowhere");
    window.must_show("One campaign so far");
}

/// Keys change the view, the theme and the help.
#[test]
fn keys() {
    let dir = tempfile::tempdir().unwrap();
    let one = campaign(&dir.path().join("one"), settings(1));
    let mut window = Window::open(options(dir.path(), Some(&one), View::Campaign));
    window.harness.key_press(egui::Key::F1);
    window.frames(3);
    window.must_show("Keys and gestures");
    window.harness.key_press(egui::Key::Escape);
    window.harness.key_press(egui::Key::Num2);
    window.frames(3);
    assert!(!window.shows("Keys and gestures"));
    window.must_show("Trial 0");
    let dark = window.shows("Light");
    window.harness.key_press(egui::Key::T);
    window.frames(3);
    assert_ne!(window.shows("Light"), dark);
    for (key, shown) in [(egui::Key::Num4, "No log is open"), (egui::Key::Num6, "One campaign so far")] {
        window.harness.key_press(key);
        window.frames(3);
        window.must_show(shown);
    }
}
