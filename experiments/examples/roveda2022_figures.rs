//! Draws the figures of `01_roveda2022`: cost over trials from `expected.json`, and wrench and tracking error of one
//! campaign before and after compensation.
//!
//! `cargo run --release -p tribo-experiments --example roveda2022_figures -- experiments/01_roveda2022`

use std::error::Error;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use tribo_campaign::strategy::StrategyName;
use tribo_campaign::{Phases, TuneConfig, run_in_memory, run_numbered};
use tribo_experiments::reproduce::CellResult;
use tribo_friction::VelocitySource;
use tribo_trial::TrialLog;
use tribo_trial::scenario::TruthName;

/// Colours that also differ for colour-blind eyes (Okabe & Ito).
const BEFORE: RGBColor = RGBColor(213, 94, 0);
const AFTER: RGBColor = RGBColor(0, 114, 178);
/// Strategies as they are drawn.
const STRATEGIES: [(StrategyName, &str, RGBColor); 4] = [
    (StrategyName::Paper, "paper", RGBColor(213, 94, 0)),
    (StrategyName::Bo, "bo", RGBColor(0, 158, 115)),
    (StrategyName::IterativeLearning, "iterative_learning", RGBColor(204, 121, 167)),
    (StrategyName::GreyBox, "grey_box", RGBColor(0, 114, 178)),
];
/// Shares of the campaigns between which the spread is drawn.
const SPREAD: [f64; 2] = [0.1, 0.9];
/// The campaign of the time series: seed 1 of the experiment at pose 0.
const SEED: u64 = 10;

type Panel<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Points = Vec<(f64, f64)>;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: roveda2022_figures FOLDER")?;
    let folder = Path::new(&folder);
    let document: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(folder.join("expected.json"))?)?;
    let campaigns: Vec<CellResult> = serde_json::from_value(document["campaigns"].clone())?;
    costs(&folder.join("costs.svg"), &campaigns)?;

    let config = TuneConfig {
        seed: SEED,
        trials: 2,
        velocity: VelocitySource::Hybrid,
        phases: Phases::Random,
        ..TuneConfig::default()
    };
    let tune = config.validate::<7>()?;
    let trials = run_in_memory(&tune)?.trials;
    let mut logs = Vec::new();
    for trial in &trials {
        logs.push(run_numbered(&tune, trial.number, &trial.theta)?.log);
    }
    wrench(&folder.join("wrench.svg"), &logs)?;
    tracking(&folder.join("tracking.svg"), &logs)
}

/// Lowest cost so far over trials: median of the campaigns and the spread of the middle four fifths.
fn costs(path: &Path, campaigns: &[CellResult]) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (1000, 1000)).into_drawing_area();
    root.fill(&WHITE)?;
    let truths = [
        (TruthName::CoulombViscous, "Coulomb-viscous truth"),
        (TruthName::Stribeck, "Stribeck truth"),
        (TruthName::Lugre, "LuGre truth"),
    ];
    for (k, (panel, (truth, title))) in root.split_evenly((3, 1)).iter().zip(truths).enumerate() {
        let mut chart = ChartBuilder::on(panel)
            .caption(title, ("sans-serif", 15))
            .margin(8)
            .margin_right(20)
            .x_label_area_size(36)
            .y_label_area_size(60)
            .build_cartesian_2d(1.0..70.0, (0.8..30.0).log_scale())?;
        chart
            .configure_mesh()
            .light_line_style(WHITE.mix(0.0))
            .x_desc("trials of 30 s [-]")
            .y_desc("lowest J / J_oracle [-]")
            .x_label_formatter(&|x| format!("{x:.0}"))
            .y_label_formatter(&|y| format!("{y}"))
            .label_style(("sans-serif", 12))
            .axis_desc_style(("sans-serif", 13))
            .draw()?;
        for (strategy, name, colour) in STRATEGIES {
            let of_row = campaigns.iter().filter(|cell| cell.truth == truth && cell.strategy == strategy);
            let all: Vec<Vec<f64>> = of_row.map(|cell| lowest_so_far(&cell.ratio)).collect();
            let trials = all.iter().map(Vec::len).min().unwrap_or(0);
            let quantile = |share: f64| -> Points {
                (0..trials).map(|t| (t as f64 + 1.0, at_share(all.iter().map(|one| one[t]), share))).collect()
            };
            let outline = quantile(SPREAD[0]).into_iter().chain(quantile(SPREAD[1]).into_iter().rev());
            chart.draw_series([Polygon::new(outline.collect::<Points>(), colour.mix(0.18))])?;
            chart
                .draw_series(LineSeries::new(quantile(0.5), colour.stroke_width(2)))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
        }
        chart.draw_series(LineSeries::new([(1.0, 1.0), (70.0, 1.0)], BLACK.mix(0.5)))?;
        if k == 0 {
            legend(&mut chart)?;
        }
    }
    root.present()?;
    Ok(())
}

fn lowest_so_far(ratio: &[f64]) -> Vec<f64> {
    let lowest = ratio.iter().scan(f64::INFINITY, |least, &r| {
        *least = least.min(r);
        Some(*least)
    });
    lowest.collect()
}

/// The value below which a share of the values lies.
fn at_share(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let place = share * (sorted.len() - 1) as f64;
    let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    below + place.fract() * (above - below)
}

/// The estimated wrench while nobody touches the arm.
fn wrench(path: &Path, logs: &[TrialLog<7>]) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (1000, 860)).into_drawing_area();
    root.fill(&WHITE)?;
    let panels = root.split_evenly((3, 2));
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let force = |log: &TrialLog<7>, k: usize| log.wrench[k][3 + axis];
        let moment = |log: &TrialLog<7>, k: usize| log.wrench[k][axis];
        draw(&panels[2 * axis], &format!("estimated force {name}, base [N]"), logs, &force, axis == 0)?;
        draw(&panels[2 * axis + 1], &format!("estimated moment {name}, base [Nm]"), logs, &moment, false)?;
    }
    root.present()?;
    Ok(())
}

/// Distance to the reference and angle to it.
fn tracking(path: &Path, logs: &[TrialLog<7>]) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (1000, 560)).into_drawing_area();
    root.fill(&WHITE)?;
    let panels = root.split_evenly((2, 1));
    let position = |log: &TrialLog<7>, k: usize| 1e3 * log.error[k].fixed_rows::<3>(3).norm();
    let angle = |log: &TrialLog<7>, k: usize| 1e3 * log.error[k].fixed_rows::<3>(0).norm();
    draw(&panels[0], "position error [mm]", logs, &position, true)?;
    draw(&panels[1], "orientation error [mrad]", logs, &angle, false)?;
    root.present()?;
    for (log, name) in logs.iter().zip(["before", "after"]) {
        let rms = |value: &dyn Fn(&TrialLog<7>, usize) -> f64| {
            let judged = (0..log.len()).filter(|&k| log.time_s[k] >= 0.0);
            let squares: Vec<f64> = judged.map(|k| value(log, k).powi(2)).collect();
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
        };
        println!("{name}: RMS {:.2} mm, {:.2} mrad", rms(&position), rms(&angle));
    }
    Ok(())
}

/// One value over the judged part of both trials.
fn draw(
    panel: &Panel<'_>,
    name: &str,
    logs: &[TrialLog<7>],
    value: &dyn Fn(&TrialLog<7>, usize) -> f64,
    with_legend: bool,
) -> Result<(), Box<dyn Error>> {
    let line = |log: &TrialLog<7>| -> Points {
        // Every second sample: the eye sees no more at this size.
        let judged = (0..log.len()).step_by(2).filter(|&k| log.time_s[k] >= 0.0);
        judged.map(|k| (log.time_s[k], value(log, k))).collect()
    };
    let lines: Vec<Points> = logs.iter().map(line).collect();
    let values = lines.iter().flatten().map(|point| point.1);
    let (low, high) = values.fold((0.0, 0.0), |(a, b): (f64, f64), y| (a.min(y), b.max(y)));
    // Room for the legend above the lines.
    let top = high + if with_legend { 0.3 } else { 0.05 } * (high - low);
    let bottom = if low < 0.0 { low - 0.05 * (high - low) } else { 0.0 };
    let mut chart = ChartBuilder::on(panel)
        .margin(8)
        .margin_right(20)
        .x_label_area_size(34)
        .y_label_area_size(58)
        .build_cartesian_2d(0.0..30.0, bottom..top)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE.mix(0.0))
        .x_desc("time [s], nobody touches the arm")
        .y_desc(name)
        .label_style(("sans-serif", 12))
        .axis_desc_style(("sans-serif", 12))
        .draw()?;
    let styles = [(BEFORE, "trial 1, no compensation"), (AFTER, "trial 2, identified from trial 1")];
    for (points, (colour, label)) in lines.into_iter().zip(styles) {
        chart
            .draw_series(LineSeries::new(points, colour.stroke_width(1)))?
            .label(label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
    }
    if with_legend {
        legend(&mut chart)?;
    }
    Ok(())
}

fn legend<'a, 'b, C>(chart: &mut ChartContext<'a, SVGBackend<'b>, C>) -> Result<(), Box<dyn Error>>
where
    C: CoordTranslate,
    'b: 'a,
{
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .label_font(("sans-serif", 12))
        .draw()?;
    Ok(())
}
