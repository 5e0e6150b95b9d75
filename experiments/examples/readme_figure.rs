//! Draws the picture of the README: the wrench felt in free motion before and after tuning.
//!
//! `cargo run --release -p tribo-experiments --example readme_figure -- docs/wrench.svg`

use std::error::Error;

use plotters::prelude::*;
use tribo_campaign::{TuneConfig, run_in_memory, run_numbered};

/// Two colours that also differ for colour-blind eyes (Okabe & Ito).
const BEFORE: RGBColor = RGBColor(213, 94, 0);
const AFTER: RGBColor = RGBColor(0, 114, 178);

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: readme_figure OUT.svg")?;
    let tune = TuneConfig { trials: 2, ..TuneConfig::default() }.validate::<7>()?;
    let trials = run_in_memory(&tune)?.trials;
    let logs: Vec<_> =
        trials.iter().map(|trial| run_numbered(&tune, trial.number, &trial.theta)).collect::<Result<_, _>>()?;

    let root = SVGBackend::new(&path, (900, 420)).into_drawing_area();
    root.fill(&WHITE)?;
    let panels = root.split_evenly((2, 1));
    let rows: [(&str, usize, f64); 2] = [("force z [N]", 5, 10.0), ("moment y [Nm]", 1, 1.2)];
    for (panel, (name, component, range)) in panels.iter().zip(rows) {
        let mut chart = ChartBuilder::on(panel)
            .margin(8)
            .margin_right(24)
            .x_label_area_size(34)
            .y_label_area_size(58)
            .build_cartesian_2d(0.0..30.0, -range..range)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE.mix(0.0))
            .x_desc("time [s], nobody touches the arm")
            .y_desc(format!("estimated {name}"))
            .label_style(("sans-serif", 13))
            .axis_desc_style(("sans-serif", 14))
            .draw()?;
        for (outcome, colour, label) in [
            (&logs[0], BEFORE, format!("trial 1, no compensation: J = {:.1}", logs[0].cost.total())),
            (&logs[1], AFTER, format!("trial 2, identified from trial 1: J = {:.1}", logs[1].cost.total())),
        ] {
            let log = &outcome.log;
            // Every fourth sample: the eye sees no more at this size.
            let line = (0..log.len())
                .step_by(4)
                .filter(|&k| log.time_s[k] >= 0.0)
                .map(|k| (log.time_s[k], log.wrench[k][component]));
            chart
                .draw_series(LineSeries::new(line, colour.stroke_width(1)))?
                .label(label)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
        }
        if component == 5 {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.85))
                .label_font(("sans-serif", 13))
                .draw()?;
        }
    }
    root.present()?;
    Ok(())
}
