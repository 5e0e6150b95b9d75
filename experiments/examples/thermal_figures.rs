//! Draws the figures of experiments 03 and 04, seed 1 of each.
//!
//! `cargo run --release -p tribo-experiments --example thermal_figures -- experiments`

use std::error::Error;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use tribo_experiments::reproduce::{ObserverTrace, PolishingTrace, Simoni2017, Simoni2019, Simoni2019Trace};
use tribo_model::YamlDocument;

/// Colours that also differ for colour-blind eyes (Okabe & Ito).
const BLUE: RGBColor = RGBColor(0, 114, 178);
const RED: RGBColor = RGBColor(213, 94, 0);
const GREEN: RGBColor = RGBColor(0, 158, 115);
const PURPLE: RGBColor = RGBColor(204, 121, 167);
const GREY: RGBColor = RGBColor(110, 110, 110);

type Points = Vec<(f64, f64)>;
type Panel<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A line with its name, or points if `dots`.
struct Series {
    name: &'static str,
    colour: RGBColor,
    dots: bool,
    points: Points,
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: thermal_figures EXPERIMENTS_FOLDER")?;
    let folder = Path::new(&folder);
    let config: Simoni2017 = YamlDocument::read(&folder.join("03_simoni2017/config.yaml"))?.parse()?;
    let (_, trace) = config.run(1)?;
    polishing(&folder.join("03_simoni2017/figure.svg"), &trace)?;
    let config: Simoni2019 = YamlDocument::read(&folder.join("04_simoni2019/config.yaml"))?.parse()?;
    let (_, trace) = config.run(1)?;
    warm_joint(&folder.join("04_simoni2019/figure.svg"), &trace, &config)?;
    Ok(())
}

fn series(name: &'static str, colour: RGBColor, points: Points) -> Series {
    Series { name, colour, dots: false, points }
}

fn draw(
    panel: &Panel<'_>,
    title: &str,
    axes: [&str; 2],
    x: [f64; 2],
    y: [f64; 2],
    legend: SeriesLabelPosition,
    all: Vec<Series>,
) -> Result<(), Box<dyn Error>> {
    let mut chart = ChartBuilder::on(panel)
        .caption(title, ("sans-serif", 15))
        .margin(8)
        .margin_right(20)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(x[0]..x[1], y[0]..y[1])?;
    chart
        .configure_mesh()
        .light_line_style(WHITE.mix(0.0))
        .x_desc(axes[0])
        .y_desc(axes[1])
        .label_style(("sans-serif", 12))
        .axis_desc_style(("sans-serif", 13))
        .draw()?;
    for Series { name, colour, dots, points } in all {
        let drawn = if dots {
            chart.draw_series(points.into_iter().map(|p| Circle::new(p, 3, colour.filled())))?
        } else {
            chart.draw_series(LineSeries::new(points, colour.stroke_width(2)))?
        };
        if !name.is_empty() {
            drawn.label(name).legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(3)));
        }
    }
    chart
        .configure_series_labels()
        .position(legend)
        .background_style(WHITE.mix(0.85))
        .label_font(("sans-serif", 12))
        .draw()?;
    Ok(())
}

fn polishing(path: &Path, trace: &PolishingTrace) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (1000, 700)).into_drawing_area();
    root.fill(&WHITE)?;
    let panels = root.split_evenly((2, 2));
    let temperature = |j: usize, which: usize, until: f64| -> Points {
        let rows = trace.time_s.iter().zip(&trace.temperature_c);
        rows.take_while(|(t, _)| **t < until).map(|(t, all)| (*t, all[j][which])).collect()
    };
    let start = vec![
        series("joint 2, true", GREY, temperature(1, 1, 120.0)),
        series("joint 2, estimated", BLUE, temperature(1, 0, 120.0)),
        series("joint 6, estimated", GREEN, temperature(5, 0, 120.0)),
    ];
    let axes = ["time [s]", "temperature [°C]"];
    draw(
        &panels[0],
        "Free motion from a start that is 10 K wrong",
        axes,
        [0.0, 120.0],
        [20.0, 36.0],
        SeriesLabelPosition::LowerRight,
        start,
    )?;
    let hours: Vec<Series> = [(1, "joint 2", BLUE), (3, "joint 4", RED), (5, "joint 6", GREEN)]
        .into_iter()
        .flat_map(|(j, name, colour)| {
            let minutes = |which| temperature(j, which, f64::INFINITY).iter().map(|(t, c)| (t / 60.0, *c)).collect();
            [series("", GREY, minutes(1)), series(name, colour, minutes(0))]
        })
        .collect();
    draw(
        &panels[1],
        "The whole task (grey: true)",
        ["time [min]", axes[1]],
        [0.0, 75.0],
        [20.0, 45.0],
        SeriesLabelPosition::LowerRight,
        hours,
    )?;
    for (panel, cycle, from) in [(&panels[2], 1, 150.0), (&panels[3], 5, 4230.0)] {
        let error = |which: usize| -> Points {
            let inside = trace.force.iter().filter(|row| (from..from + 30.0).contains(&row[0]));
            inside.map(|row| (row[0], row[which] - row[1])).collect()
        };
        let both = vec![series("without temperature", RED, error(3)), series("with temperature", BLUE, error(2))];
        let title = format!("Contact cycle {cycle}: error of the contact force");
        draw(
            panel,
            &title,
            ["time [s]", "error of force z, base [N]"],
            [from, from + 30.0],
            [-2.5, 2.5],
            SeriesLabelPosition::UpperRight,
            both,
        )?;
    }
    root.present()?;
    Ok(())
}

fn warm_joint(path: &Path, trace: &Simoni2019Trace, config: &Simoni2019) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (1000, 700)).into_drawing_area();
    root.fill(&WHITE)?;
    let panels = root.split_evenly((2, 2));
    let table = |pick: &dyn Fn(usize) -> f64| -> Points {
        trace.table.iter().enumerate().map(|(k, row)| (row.minute, pick(k))).collect()
    };
    // The paper's values, in the order of the quantities.
    let quantities = config.quantities();
    let paper = |what: &str| -> Points {
        let of = quantities.iter().filter(|q| q.name.starts_with(what));
        let values: Vec<f64> = of.filter_map(|q| q.paper).collect();
        table(&|k| values[2 * k + 1]).into_iter().chain(table(&|k| values[2 * k])).collect()
    };
    for (panel, title, unit, what, most, pick) in [
        (&panels[0], "Error of the friction torque", "standard deviation [Nm]", "sd of error", 200.0, 0),
        (&panels[1], "Variance not explained", "part of the friction's variance [%]", "unexplained", 110.0, 1),
    ] {
        let value = |k: usize, i: usize| {
            let row = &trace.table[k];
            if pick == 0 { row.sd_nm[i] } else { row.unexplained_percent[i] }
        };
        let all = vec![
            series("without temperature", RED, table(&|k| value(k, 1))),
            series("with temperature", BLUE, table(&|k| value(k, 0))),
            Series { name: "paper's Table 4", colour: GREY, dots: true, points: paper(what) },
        ];
        draw(
            panel,
            title,
            ["time at work [min]", unit],
            [0.0, 280.0],
            [0.0, most],
            SeriesLabelPosition::MiddleRight,
            all,
        )?;
    }
    let estimated = |run: &ObserverTrace| -> Points {
        run.time_s.iter().zip(&run.estimated_c).step_by(10).map(|(t, c)| (*t, *c)).collect()
    };
    let truth = |run: &ObserverTrace| -> Points {
        run.time_s.iter().zip(&run.true_c).step_by(10).map(|(t, c)| (*t, *c)).collect()
    };
    let mut observers = Vec::new();
    let names = ["η = 0.005 K/(Nm s)", "η = 0.05 K/(Nm s)", "η = 0.5 K/(Nm s)", "Kalman"];
    for (k, colour) in [(2, PURPLE), (1, BLUE), (0, GREEN), (3, RED)] {
        observers.push(series(names[k], colour, estimated(&trace.observers[k].1)));
    }
    observers.push(series("right temperature", GREY, truth(&trace.observers[0].1)));
    let axes = ["time [s]", "temperature [°C]"];
    draw(
        &panels[2],
        "Observer switched on after 30 min, N = 40",
        axes,
        [0.0, 300.0],
        [15.0, 60.0],
        SeriesLabelPosition::LowerRight,
        observers,
    )?;
    let disturbed = vec![
        series("always on", RED, estimated(&trace.disturbed[0])),
        series("behind the gate", BLUE, estimated(&trace.disturbed[1])),
        series("right temperature", GREY, truth(&trace.disturbed[0])),
    ];
    let title = format!("{} Nm of disturbance from 120 to 240 s", config.disturbance_nm);
    draw(&panels[3], &title, axes, [0.0, 480.0], [55.0, 80.0], SeriesLabelPosition::UpperRight, disturbed)?;
    root.present()?;
    Ok(())
}
