//! Draws the figure of `02_linderoth2013`: force of an assembly with its 95 % band, from the static arm and from both.
//!
//! `cargo run --release -p tribo-experiments --example linderoth2013_figures -- experiments/02_linderoth2013`

use std::error::Error;
use std::path::Path;

use plotters::prelude::*;
use tribo_experiments::reproduce::Linderoth2013;
use tribo_model::YamlDocument;

/// Two colours that also differ for colour-blind eyes (Okabe & Ito), and black for the truth.
const STATIC: RGBColor = RGBColor(213, 94, 0);
const BOTH: RGBColor = RGBColor(0, 114, 178);
/// The part of the assembly that is drawn (s).
const SHOWN_S: [f64; 2] = [5.0, 15.0];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: linderoth2013_figures FOLDER")?;
    let folder = Path::new(&folder);
    let config: Linderoth2013 = YamlDocument::read(&folder.join("config.yaml"))?.parse()?;
    let (_, trace) = config.run(1)?;
    let shown: Vec<usize> =
        (0..trace.time_s.len()).filter(|&k| (SHOWN_S[0]..SHOWN_S[1]).contains(&trace.time_s[k])).collect();
    let path = folder.join("figure.svg");
    let root = SVGBackend::new(&path, (1000, 860)).into_drawing_area();
    root.fill(&WHITE)?;
    for (axis, panel) in root.split_evenly((3, 1)).iter().enumerate() {
        let mut chart = ChartBuilder::on(panel)
            .margin(8)
            .margin_right(20)
            .x_label_area_size(34)
            .y_label_area_size(58)
            .build_cartesian_2d(SHOWN_S[0]..SHOWN_S[1], -18.0..18.0)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE.mix(0.0))
            .x_desc("time [s]")
            .y_desc(format!("force {}, base [N]", ["x", "y", "z"][axis]))
            .label_style(("sans-serif", 12))
            .axis_desc_style(("sans-serif", 13))
            .draw()?;
        for (arms, colour, name) in [(0, STATIC, "static arm, 95 %"), (2, BOTH, "both arms, 95 %")] {
            let points = |which: usize| -> Vec<(f64, f64)> {
                shown.iter().map(|&k| (trace.time_s[k], trace.bands_n[arms][k][which][axis])).collect()
            };
            let outline = points(1).into_iter().chain(points(2).into_iter().rev());
            chart.draw_series([Polygon::new(outline.collect::<Vec<_>>(), colour.mix(0.2))])?;
            chart
                .draw_series(LineSeries::new(points(0), colour.stroke_width(1)))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
        }
        let truth = shown.iter().map(|&k| (trace.time_s[k], trace.truth_n[k][axis]));
        chart
            .draw_series(LineSeries::new(truth, BLACK.stroke_width(1)))?
            .label("true")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], BLACK.stroke_width(1)));
        if axis == 0 {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::LowerRight)
                .background_style(WHITE.mix(0.85))
                .label_font(("sans-serif", 12))
                .draw()?;
        }
    }
    root.present()?;
    Ok(())
}
