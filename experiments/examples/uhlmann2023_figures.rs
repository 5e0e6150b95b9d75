//! Draws the figures of `05_uhlmann2023`: the free deflection and the wrench along the circle.
//!
//! `cargo run --release -p tribo-experiments --example uhlmann2023_figures -- experiments/05_uhlmann2023`

use std::error::Error;

use plotters::coord::Shift;
use plotters::prelude::{
    BLACK, ChartBuilder, Color, DrawingArea, IntoDrawingArea, LineSeries, PathElement, Polygon, RGBColor, SVGBackend,
    SeriesLabelPosition, WHITE,
};
use tribo_experiments::reproduce::uhlmann2023::{Circle, Uhlmann2023, Variant};
use tribo_model::YamlDocument;
use tribo_robot::LAMBDA_95;

/// Two colours that also differ for colour-blind eyes (Okabe & Ito), and black for what was measured.
const PAPER: RGBColor = RGBColor(213, 94, 0);
const EXTENDED: RGBColor = RGBColor(0, 114, 178);

type Panel<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// One estimate along the circle: colour, label, values and half-widths of the 95 % band.
type Band = (RGBColor, &'static str, Vec<(f64, f64)>);

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: uhlmann2023_figures FOLDER")?;
    let text = include_str!("../05_uhlmann2023/config.yaml");
    let config: Uhlmann2023 = YamlDocument::embedded("config.yaml", text).parse()?;
    let [paper, extended] = [Variant::Paper, Variant::Extended].map(|variant| config.circle_of(variant, 1));
    let (paper, extended) = (paper?.1, extended?.1);
    free_deflection(&format!("{folder}/free_deflection.svg"), &paper, &extended)?;
    wrench(&format!("{folder}/wrench.svg"), &paper, &extended)
}

/// Measured and expected deflection without load, joint by joint (mrad).
fn free_deflection(path: &str, paper: &Circle, extended: &Circle) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (1000, 1000)).into_drawing_area();
    root.fill(&WHITE)?;
    let band = |circle: &Circle, j: usize| -> Vec<(f64, f64)> {
        let one = |(_, at): &(_, tribo_residual::RestWrench<7>)| {
            (1e3 * at.free_deflection_rad[j], 1e3 * LAMBDA_95 * at.free_sd_rad[j])
        };
        circle.free.iter().map(one).collect()
    };
    for (j, panel) in root.split_evenly((4, 2)).iter().take(7).enumerate() {
        let truth: Vec<f64> = paper.free.iter().map(|(rest, _)| 1e3 * rest.deflection_rad[j]).collect();
        let bands = [(PAPER, "paper, 95 %", band(paper, j)), (EXTENDED, "extended, 95 %", band(extended, j))];
        draw(panel, &format!("joint {}: deflection without load [mrad]", j + 1), "measured", &truth, &bands, j == 0)?;
    }
    root.present()?;
    Ok(())
}

/// True and estimated force in the plane of the circle (N) and moment about its normal (Nm), base axes.
fn wrench(path: &str, paper: &Circle, extended: &Circle) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (1000, 760)).into_drawing_area();
    root.fill(&WHITE)?;
    let rows = [("force x, base axes [N]", 3), ("force y, base axes [N]", 4), ("moment z, base axes [Nm]", 2)];
    for (panel, (name, i)) in root.split_evenly((3, 1)).iter().zip(rows) {
        let truth: Vec<f64> = paper.loaded.iter().map(|(truth, _)| truth.to_vector()[i]).collect();
        let band = |circle: &Circle| -> Vec<(f64, f64)> {
            let estimates = circle.loaded.iter().map(|(_, at)| at);
            estimates.map(|at| (at.wrench_base.to_vector()[i], LAMBDA_95 * at.covariance[(i, i)].sqrt())).collect()
        };
        let bands = [(PAPER, "paper, 95 %", band(paper)), (EXTENDED, "extended, 95 %", band(extended))];
        draw(panel, name, "applied", &truth, &bands, i == 3)?;
    }
    root.present()?;
    Ok(())
}

fn draw(
    panel: &Panel<'_>,
    name: &str,
    truth_label: &str,
    truth: &[f64],
    bands: &[Band],
    legend: bool,
) -> Result<(), Box<dyn Error>> {
    let edges = bands.iter().flat_map(|(_, _, band)| band.iter().flat_map(|(x, half)| [x - half, x + half]));
    let (low, high) = edges.chain(truth.iter().copied()).fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
    let margin = 0.05 * (high - low);
    let mut chart = ChartBuilder::on(panel)
        .margin(8)
        .margin_right(20)
        .x_label_area_size(34)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..truth.len() as f64, low - margin..high + margin)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE.mix(0.0))
        .x_desc("pose on the circle [-]")
        .y_desc(name)
        .label_style(("sans-serif", 12))
        .axis_desc_style(("sans-serif", 12))
        .draw()?;
    for (colour, label, band) in bands {
        let colour = *colour;
        let upper = band.iter().enumerate().map(|(k, (x, half))| (k as f64, x + half));
        let lower = band.iter().enumerate().map(|(k, (x, half))| (k as f64, x - half)).rev();
        chart.draw_series([Polygon::new(upper.chain(lower).collect::<Vec<_>>(), colour.mix(0.2))])?;
        let line = band.iter().enumerate().map(|(k, (x, _))| (k as f64, *x));
        chart
            .draw_series(LineSeries::new(line, colour.stroke_width(2)))?
            .label(*label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
    }
    let points =
        truth.iter().enumerate().map(|(k, x)| plotters::element::Circle::new((k as f64, *x), 2, BLACK.filled()));
    chart
        .draw_series(points)?
        .label(truth_label)
        .legend(|(x, y)| plotters::element::Circle::new((x + 9, y), 3, BLACK.filled()));
    if legend {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.85))
            .label_font(("sans-serif", 12))
            .draw()?;
    }
    Ok(())
}
