//! The window as a picture, without display or graphics card.
//!
//! `cargo run --release -p tribo-dashboard --example picture_of_the_window -- [window.png]`

use tribo_dashboard::{Dashboard, Options, picture, write_png};

/// Time stamps of the journals of campaigns that the window starts; a real clock goes here.
fn long_ago() -> String {
    "2000-01-01T00:00:00.000000+00:00".to_owned()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let here = std::env::current_dir()?;
    let mut dashboard = Dashboard::new(Options {
        open: None, // or a campaign, or a log
        live: None,
        compare: None,
        view: None,
        clock: long_ago,
        immediate: true,
        layout: None,
        exports: here.clone(),
        campaigns: here.join("campaigns"),
    });
    let drawn = picture([1000, 700], false, |ui| dashboard.ui(ui));
    let mut colours = drawn.pixels.clone();
    colours.sort_unstable_by_key(|colour| colour.to_array());
    colours.dedup();
    println!("{} x {} pixels, more than twenty colours: {}", drawn.size[0], drawn.size[1], colours.len() > 20);
    match std::env::args().nth(1) {
        Some(path) => Ok(write_png(path.as_ref(), &drawn)?),
        None => Ok(()),
    }
}
