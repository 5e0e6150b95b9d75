//! Watching changes nothing, and pictures need nothing.

use crate::common::{Window, campaign, clock, options, settings};
use tribo_campaign::strategy::StrategyName;
use tribo_campaign::{Campaign, StopBelow, TuneConfig};
use tribo_dashboard::{LiveFeed, LiveSample, LiveTitle, Options, View, screenshot};
use tribo_robot::presets;

/// The journal of a campaign that a window watches is that of one that nobody watches, to the last byte.
#[test]
fn a_watched_campaign_writes_the_same_journal() {
    let dir = tempfile::tempdir().unwrap();
    let config = || TuneConfig { strategy: StrategyName::GreyBox, stop_below: Some(StopBelow::Never), ..settings(6) };
    // One thread: with more, designs that run side by side end in any order, watched or not.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let alone = pool.install(|| campaign(&dir.path().join("alone"), config()));
    let watched = dir.path().join("watched");
    let running = Campaign::create(&watched, config().validate::<7>().unwrap(), clock).unwrap();
    let thread = std::thread::spawn(move || pool.install(|| running.run(&mut ()).unwrap()));
    let mut window = Window::open(options(dir.path(), Some(&watched), View::Campaign));
    window.wait_for("6 of 6 trials");
    thread.join().unwrap();
    for file in ["journal.log", "tuned.yaml", "campaign.yaml", "trials/0005.parquet"] {
        assert_eq!(std::fs::read(alone.join(file)).unwrap(), std::fs::read(watched.join(file)).unwrap(), "{file}");
    }
}

/// The same picture twice, of the asked size, with letters on it.
#[test]
fn pictures_are_reproducible() {
    let dir = tempfile::tempdir().unwrap();
    let one = campaign(&dir.path().join("one"), settings(3));
    let draw = |name: &str, view: View, dark: bool| {
        let out = dir.path().join(name);
        screenshot(options(dir.path(), Some(&one), view), [960, 640], dark, &out).unwrap();
        std::fs::read(out).unwrap()
    };
    let first = draw("a.png", View::Campaign, false);
    assert_eq!(first, draw("b.png", View::Campaign, false));
    assert_ne!(first, draw("c.png", View::Campaign, true));
    assert_ne!(first, draw("d.png", View::Arm, false));
    let decoded = png::Decoder::new(std::io::Cursor::new(first)).read_info().unwrap();
    assert_eq!(decoded.info().size(), (960, 640));
}

/// A robot that lives: what it sends is shown as it comes, a picture that is held stands still, and an end says why.
#[test]
fn a_robot_that_lives_is_shown() {
    let dir = tempfile::tempdir().unwrap();
    let title = LiveTitle { host: "127.0.0.1".to_owned(), robot: "panda".to_owned(), estimator: "momentum".to_owned() };
    let feed = LiveFeed::new(title, presets::panda());
    let live = Some(feed.clone());
    let mut window = Window::open(Options { live, ..options(dir.path(), None, View::Live) });
    window.must_show("Nothing has come yet");
    let push = |first: i32| {
        for k in first..first + 1000 {
            let time_s = f64::from(k) * 1e-3;
            let wrench = Some([5.0 * time_s.sin(); 6]);
            feed.push(LiveSample {
                time_s,
                q_rad: presets::panda_ready_pose().iter().copied().collect(),
                dq_rad_s: vec![0.0; 7],
                tau_j_nm: vec![1.0; 7],
                wrench,
                limits95: Some([[-6.0; 6], [6.0; 6]]),
                own_wrench: [1.0; 6],
                since_last_ms: if k % 100 == 0 { 3.0 } else { 1.0 },
                estimator_us: 4.0,
            });
        }
    };
    push(0);
    push(1003);
    feed.tell("Guiding".to_owned());
    window.frames(3);
    window.must_show("panda at 127.0.0.1");
    window.must_show("Guiding; 2000 states, 3 lost; estimator: momentum");
    window.must_show("force x [N], base axes");
    window.must_show("q [rad]: 0.000, −0.785");
    window.click("Joints");
    window.must_show("measured joint torque [Nm]");
    window.click("Loop times");
    window.must_show("time between two states [ms]: 50 % 1.00, 99.9 % 3.00, longest 3.00");
    window.click("Hold");
    push(2003);
    window.frames(3);
    window.must_show("2000 states");
    window.click("Hold");
    window.must_show("3000 states");
    feed.end("the network".to_owned());
    window.frames(3);
    window.must_show("no more states come: the network");
}
