//! Draws the figure of experiment 09 from its results.
//!
//! `cargo run --release -p tribo-experiments --example overcompensation_figure -- experiments/09_overcompensation/expected.json docs/overcompensation.svg`

use std::error::Error;

use plotters::prelude::*;
use serde_json::Value;
use tribo_experiments::reproduce::ScaleRow;

/// Two colours that also differ for colour-blind eyes (Okabe & Ito).
const WITHOUT: RGBColor = RGBColor(213, 94, 0);
const WITH: RGBColor = RGBColor(0, 114, 178);
const GREY: RGBColor = RGBColor(110, 110, 110);

fn main() -> Result<(), Box<dyn Error>> {
    const USAGE: &str = "usage: overcompensation_figure RESULTS.json OUT.svg";
    let path = std::env::args().nth(1).ok_or(USAGE)?;
    let out = std::env::args().nth(2).ok_or(USAGE)?;
    let mut document: Value = serde_json::from_str(&std::fs::read_to_string(path)?)?;
    let rows: Vec<ScaleRow> = serde_json::from_value(document["rows"].take())?;
    let mut scales: Vec<f64> = rows.iter().map(|row| row.scale).collect();
    scales.sort_by(f64::total_cmp);
    scales.dedup();
    let worst = |value: &dyn Fn(&ScaleRow) -> f64| -> Vec<(f64, f64)> {
        let at = |scale: &f64| rows.iter().filter(|row| row.scale == *scale).map(value).fold(0.0, f64::max);
        scales.iter().map(|scale| (100.0 * scale, at(scale))).collect()
    };
    let share = |count: &dyn Fn(&ScaleRow) -> usize| -> Vec<(f64, f64)> {
        let at = |scale: &f64| {
            let here: Vec<&ScaleRow> = rows.iter().filter(|row| row.scale == *scale).collect();
            100.0 * here.iter().filter(|row| count(row) > 0).count() as f64 / here.len() as f64
        };
        scales.iter().map(|scale| (100.0 * scale, at(scale))).collect()
    };

    let root = SVGBackend::new(&out, (900, 860)).into_drawing_area();
    root.fill(&WHITE)?;
    let panels = root.split_evenly((3, 1));
    let lines = [
        (WITHOUT, "without guard", [worst(&|row| 1e3 * row.deviation_m[0]), worst(&|row| row.elbow_rad[0])]),
        (WITH, "with guard", [worst(&|row| 1e3 * row.deviation_m[1]), worst(&|row| row.elbow_rad[1])]),
    ];
    for (k, (name, seen)) in
        [("tool off its path, above 1 Hz [mm]", 2.0), ("elbow has slid [rad]", 0.2)].into_iter().enumerate()
    {
        let most = lines.iter().flat_map(|line| line.2[k].iter().map(|point| point.1)).fold(0.0, f64::max);
        let mut chart = chart(&panels[k], name, 1.08 * most)?;
        chart
            .draw_series(DashedLineSeries::new([(0.0, seen), (300.0, seen)], 5, 4, GREY.stroke_width(1)))?
            .label("what one sees")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], GREY.stroke_width(1)));
        for (colour, label, values) in &lines {
            let stroke = colour.stroke_width(2);
            chart
                .draw_series(LineSeries::new(values[k].iter().copied(), stroke))?
                .label(*label)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], stroke));
        }
        legend(&mut chart)?;
    }
    let mut chart = chart(&panels[2], "situations [%]", 105.0)?;
    for (colour, label, values) in [
        (WITHOUT, "somebody would see it", share(&|row| row.visible)),
        (WITH, "the guard trips", share(&|row| row.trips)),
    ] {
        let stroke = colour.stroke_width(2);
        chart
            .draw_series(LineSeries::new(values, stroke))?
            .label(label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], stroke));
    }
    legend(&mut chart)?;
    root.present()?;
    Ok(())
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Chart<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
>;

fn chart<'a, 'b>(panel: &'a Area<'b>, name: &str, top: f64) -> Result<Chart<'a, 'b>, Box<dyn Error>> {
    let mut chart = ChartBuilder::on(panel)
        .margin(8)
        .margin_right(24)
        .x_label_area_size(36)
        .y_label_area_size(58)
        .build_cartesian_2d(0.0..300.0, 0.0..top)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE.mix(0.0))
        .x_desc("compensation, in % of the true friction")
        .y_desc(name)
        .label_style(("sans-serif", 13))
        .axis_desc_style(("sans-serif", 14))
        .draw()?;
    Ok(chart)
}

fn legend<'a, 'b: 'a>(chart: &mut Chart<'a, 'b>) -> Result<(), Box<dyn Error>> {
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.85))
        .label_font(("sans-serif", 13))
        .draw()?;
    Ok(())
}
