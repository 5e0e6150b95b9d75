//! Plots as SVG: axes with units, ticks at round numbers, the legend above the data.
//!
//! Colours are those of Okabe and Ito, which people with colour-blindness tell apart. They stand in the drawing as
//! attributes and can be overruled by style sheets through the classes `s0` … `s7`, `ink`, `soft` and `grid`.
//! Leaves out: interaction, and everything that needs a font's metrics (widths of text are estimated).

use super::axis::Axis;
use super::decimate::decimated;
use super::escape::escape;
use crate::{Plot, Series};

/// Width and height of a plot (px); it scales with its page.
const SIZE: [f64; 2] = [560.0, 320.0];
const RIGHT: f64 = 16.0;
const BOTTOM: f64 = 46.0;
/// Height of a row of the legend (px).
const LEGEND_ROW: f64 = 18.0;
/// Estimated width of a letter at 12 px (px).
const LETTER: f64 = 6.7;

/// Blue, vermilion, green, purple, orange, sky blue, grey, brown-yellow.
pub const PALETTE: [&str; 8] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#707070", "#B8A800"];

/// A plot of curves and clouds; series without a finite point are left out.
pub fn plot_svg(plot: &Plot) -> String {
    let drawn: Vec<(usize, &Series, Vec<[f64; 2]>)> =
        plot.series.iter().enumerate().map(|(k, series)| (k, series, points(series))).collect();
    let finite = || drawn.iter().flat_map(|(_, _, points)| points.iter()).filter(|point| point[1].is_finite());
    let curves_only = !plot.series.is_empty() && plot.series.iter().all(|series| series.joined);
    let x_axis = Axis::of(finite().map(|point| point[0]), 7, 0.0, false);
    let y_axis = Axis::of(finite().map(|point| point[1]), 5, 0.05, curves_only);
    let entries: Vec<(usize, &str, bool)> =
        drawn.iter().map(|(k, series, _)| (*k, series.name.as_str(), series.joined)).collect();
    let (legend, top) = legend(&entries);
    let frame = Frame::new(&y_axis, top);

    let mut body = legend + &frame.axes(&x_axis, &y_axis, &plot.x_label, &plot.y_label);
    if finite().next().is_none() {
        body += &text(0.5 * (frame.left + frame.right), 0.5 * (frame.top + frame.bottom), "middle", "soft", "no data");
    }
    // Clouds first: a curve explains the cloud behind it.
    for joined in [false, true] {
        for (k, series, points) in drawn.iter().filter(|(_, series, _)| series.joined == joined) {
            let placed = points.iter().map(|point| frame.place(&x_axis, &y_axis, *point));
            body += &if series.joined { curve(*k, placed) } else { cloud(*k, placed) };
        }
    }
    document(&plot.title, &body)
}

/// Bars in groups, one colour per series; `marks` are drawn as short lines across each group.
pub fn bars_svg(
    title: &str,
    y_label: &str,
    groups: &[String],
    series: &[(&str, Vec<f64>)],
    marks: (&str, &[f64]),
) -> String {
    let values = series.iter().flat_map(|(_, values)| values).chain(marks.1).copied();
    let y_axis = Axis::from_zero(values.filter(|value| value.is_finite()).fold(0.0, f64::max), 5);
    let mut entries: Vec<(usize, &str, bool)> =
        series.iter().enumerate().map(|(k, (name, _))| (k, *name, false)).collect();
    entries.push((6, marks.0, true));
    let (legend, top) = legend(&entries);
    let frame = Frame::new(&y_axis, top);
    let mut body = legend + &frame.axes_y(&y_axis, y_label);
    let group = (frame.right - frame.left) / groups.len().max(1) as f64;
    let bar = 0.7 * group / series.len().max(1) as f64;
    for (k, (_, values)) in series.iter().enumerate() {
        let bars =
            values.iter().take(groups.len()).enumerate().filter(|(_, value)| value.is_finite()).map(|(g, value)| {
                let x = frame.left + group * (g as f64 + 0.15) + bar * k as f64;
                let y = frame.y(&y_axis, *value);
                format!(
                    "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
                    bar - 1.0,
                    frame.bottom - y
                )
            });
        body += &format!("<g class=\"f{k}\" fill=\"{}\">{}</g>\n", PALETTE[k % 8], bars.collect::<String>());
    }
    let lines =
        marks.1.iter().take(groups.len()).enumerate().filter(|(_, value)| value.is_finite()).map(|(g, value)| {
            let x = frame.left + group * (g as f64 + 0.08);
            format!("M{x:.1} {:.1}h{:.1}", frame.y(&y_axis, *value), 0.84 * group)
        });
    body += &stroke(6, 2.0, "", &lines.collect::<String>());
    for (g, name) in groups.iter().enumerate() {
        body += &text(frame.left + group * (g as f64 + 0.5), frame.bottom + 18.0, "middle", "ink", name);
    }
    document(title, &body)
}

/// The points that are drawn: decimated; a gap has NaN as ordinate.
fn points(series: &Series) -> Vec<[f64; 2]> {
    let count = series.x.len().min(series.y.len());
    let at = |k: usize| {
        let finite = series.x[k].is_finite() && series.y[k].is_finite();
        [series.x[k], if finite { series.y[k] } else { f64::NAN }]
    };
    decimated(&series.y[..count], series.joined).into_iter().map(at).collect()
}

/// A polyline, interrupted at gaps.
fn curve(k: usize, points: impl Iterator<Item = Option<[f64; 2]>>) -> String {
    let mut path = String::new();
    let mut pen_down = false;
    for point in points {
        if let Some([x, y]) = point {
            // A lone point between gaps shows as a dot: the cap of a line of no length.
            path += &if pen_down { format!("L{x:.1} {y:.1}") } else { format!("M{x:.1} {y:.1}h0") };
        }
        pen_down = point.is_some();
    }
    let dash = if k >= 4 { " stroke-dasharray=\"7 3\"" } else { "" };
    stroke(k, 1.8, dash, &path)
}

/// Dots: round caps of lines of no length.
fn cloud(k: usize, points: impl Iterator<Item = Option<[f64; 2]>>) -> String {
    let path: String = points.flatten().map(|[x, y]| format!("M{x:.1} {y:.1}h0")).collect();
    stroke(k, 2.4, " stroke-opacity=\"0.45\"", &path)
}

fn stroke(k: usize, width: f64, more: &str, path: &str) -> String {
    if path.is_empty() {
        return String::new();
    }
    let colour = PALETTE[k % PALETTE.len()];
    format!(
        "<path class=\"s{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\" \
         stroke-linejoin=\"round\"{more} d=\"{path}\"/>\n",
        k % PALETTE.len()
    )
}

/// Rows of coloured samples with names above the plot, and the height they take (px). One nameless series needs none.
fn legend(entries: &[(usize, &str, bool)]) -> (String, f64) {
    let mut drawing = String::new();
    let (mut x, mut row) = (12.0, 0.0);
    for (k, name, joined) in entries.iter().filter(|(_, name, _)| !name.is_empty()) {
        let width = 42.0 + LETTER * name.chars().count() as f64;
        if x > 12.0 && x + width > SIZE[0] - RIGHT {
            (x, row) = (12.0, row + 1.0);
        }
        let y = 12.0 + row * LEGEND_ROW;
        let (line, thickness) =
            if *joined { (format!("M{x:.1} {y:.1}h18"), 2.5) } else { (format!("M{:.1} {y:.1}h0", x + 9.0), 9.0) };
        drawing += &stroke(*k, thickness, "", &line);
        drawing += &text(x + 24.0, y + 4.0, "start", "ink", name);
        x += width;
    }
    let height = if drawing.is_empty() { 10.0 } else { 12.0 + (row + 1.0) * LEGEND_ROW };
    (drawing, height)
}

/// The rectangle of the data (px).
struct Frame {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Frame {
    fn new(y_axis: &Axis, top: f64) -> Self {
        let widest = y_axis.ticks().iter().map(|(_, label)| label.chars().count()).max().unwrap_or(1);
        Self { left: 34.0 + LETTER * widest as f64, right: SIZE[0] - RIGHT, top, bottom: SIZE[1] - BOTTOM }
    }

    fn x(&self, axis: &Axis, value: f64) -> f64 {
        self.left + axis.position(value) * (self.right - self.left)
    }

    fn y(&self, axis: &Axis, value: f64) -> f64 {
        self.bottom - axis.position(value) * (self.bottom - self.top)
    }

    fn place(&self, x_axis: &Axis, y_axis: &Axis, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        (x.is_finite() && y.is_finite()).then(|| [self.x(x_axis, x), self.y(y_axis, y)])
    }

    fn axes(&self, x_axis: &Axis, y_axis: &Axis, x_label: &str, y_label: &str) -> String {
        let mut drawing = String::new();
        let mut grid = String::new();
        for (at, label) in x_axis.ticks() {
            let x = self.x(x_axis, at);
            grid += &format!("M{x:.1} {:.1}V{:.1}", self.top, self.bottom);
            drawing += &text(x, self.bottom + 18.0, "middle", "ink", &label);
        }
        if x_axis.holds_zero() {
            drawing += &self.zero_line(&format!("M{:.1} {:.1}V{:.1}", self.x(x_axis, 0.0), self.top, self.bottom));
        }
        drawing += &text(0.5 * (self.left + self.right), SIZE[1] - 8.0, "middle", "soft", x_label);
        grid_lines(&grid) + &self.axes_y(y_axis, y_label) + &drawing
    }

    fn axes_y(&self, axis: &Axis, label: &str) -> String {
        let mut drawing = String::new();
        let mut grid = String::new();
        for (at, label) in axis.ticks() {
            let y = self.y(axis, at);
            grid += &format!("M{:.1} {y:.1}H{:.1}", self.left, self.right);
            drawing += &text(self.left - 8.0, y + 4.0, "end", "ink", &label);
        }
        if axis.holds_zero() {
            drawing += &self.zero_line(&format!("M{:.1} {:.1}H{:.1}", self.left, self.y(axis, 0.0), self.right));
        }
        let middle = 0.5 * (self.top + self.bottom);
        drawing += &format!(
            "<text class=\"soft\" fill=\"#555\" text-anchor=\"middle\" transform=\"translate(15 {middle:.1}) rotate(-90)\">{}</text>\n",
            escape(label)
        );
        let edge = format!("M{:.1} {:.1}V{:.1}H{:.1}", self.left, self.top, self.bottom, self.right);
        grid_lines(&grid) + &drawing + &format!("<path class=\"edge\" fill=\"none\" stroke=\"#888\" d=\"{edge}\"/>\n")
    }

    fn zero_line(&self, path: &str) -> String {
        format!("<path class=\"edge\" fill=\"none\" stroke=\"#888\" stroke-width=\"0.8\" d=\"{path}\"/>\n")
    }
}

fn grid_lines(path: &str) -> String {
    format!("<path class=\"grid\" fill=\"none\" stroke=\"#e4e4e4\" d=\"{path}\"/>\n")
}

fn text(x: f64, y: f64, anchor: &str, class: &str, content: &str) -> String {
    let colour = if class == "soft" { "#555" } else { "#222" };
    let content = escape(content);
    format!(
        "<text class=\"{class}\" fill=\"{colour}\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{content}</text>\n"
    )
}

fn document(title: &str, body: &str) -> String {
    let [width, height] = SIZE;
    let title = escape(title);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}\" \
         font-family=\"system-ui, sans-serif\" font-size=\"12\">\n<title>{title}</title>\n{body}</svg>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(series: Vec<(Vec<f64>, Vec<f64>)>, joined: bool) -> Plot {
        let series = series.into_iter().map(|(x, y)| Series { name: "a <b> & \"c\"".to_owned(), x, y, joined });
        Plot {
            title: "t < & >".to_owned(),
            x_label: "velocity [rad/s]".to_owned(),
            y_label: "torque [Nm]".to_owned(),
            series: series.collect(),
        }
    }

    /// Numbers of all paths and coordinates are finite, whatever the data.
    #[test]
    fn degenerate_series_give_clean_drawings() {
        let (nan, infinite) = (f64::NAN, f64::INFINITY);
        let cases = [
            vec![],
            vec![(vec![], vec![])],
            vec![(vec![1.0], vec![2.0])],
            vec![(vec![0.0, 1.0, 2.0], vec![3.0; 3])],
            vec![(vec![1.0; 3], vec![1.0, 2.0, 3.0])],
            vec![(vec![0.0, 1.0, 2.0], vec![1.0, infinite, -infinite])],
            vec![(vec![nan, infinite], vec![nan, 1.0])],
            vec![(vec![0.0, 1.0, 2.0, 3.0], vec![1.0, nan, 2.0, nan])],
            vec![(vec![0.0, 1.0, 2.0], vec![1.0])],
            vec![(vec![f64::MIN, f64::MAX], vec![f64::MAX, f64::MIN])],
            vec![(vec![1e-300, 1e300], vec![1e-320, 1e-310])],
            vec![(
                (0..9000).map(f64::from).collect(),
                (0..9000).map(|k| if k % 7 == 0 { nan } else { f64::from(k).exp() }).collect(),
            )],
        ];
        for (k, case) in cases.into_iter().enumerate() {
            for joined in [false, true] {
                let svg = plot_svg(&plot(case.clone(), joined));
                let bare = svg.replace("translate", "").replace("text-anchor", "");
                for word in ["NaN", "inf", "-0.0\""] {
                    assert!(!bare.contains(word), "case {k}: {word} in {svg}");
                }
                assert!(!svg.contains("a <b>") && svg.contains("t &lt; &amp; &gt;"), "{svg}");
            }
        }
        let svg = plot_svg(&plot(vec![(vec![nan], vec![nan])], true));
        assert!(svg.contains("no data"), "{svg}");
    }

    #[test]
    fn bars_of_nothing_are_clean_too() {
        let names = ["0".to_owned(), "1".to_owned()];
        for values in [vec![], vec![f64::NAN, f64::INFINITY], vec![0.0, 0.0], vec![1.0, -2.0, 3.0]] {
            let svg = bars_svg("t", "torque [Nm]", &names, &[("before", values.clone())], ("noise", &values));
            assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("height=\"-"), "{svg}");
        }
        let svg = bars_svg("t", "torque [Nm]", &[], &[], ("noise", &[]));
        assert!(!svg.contains("NaN"), "{svg}");
    }

    #[test]
    fn long_legends_wrap() {
        let entries: Vec<(usize, &str, bool)> = (0..6).map(|k| (k, "a name of thirty letters or so", true)).collect();
        let (drawing, height) = legend(&entries);
        assert!(height > 3.0 * LEGEND_ROW && drawing.matches("<text").count() == 6, "{drawing}");
    }
}
