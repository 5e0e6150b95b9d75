//! Watching changes nothing, and pictures need nothing.

use crate::common::{Window, campaign, clock, options, settings};
use tribo_campaign::strategy::StrategyName;
use tribo_campaign::{Campaign, StopBelow, TuneConfig};
use tribo_dashboard::{View, screenshot};

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
