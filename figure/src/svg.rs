//! Figures as SVG: axes with units, ticks at round numbers, the legend above the data.
//!
//! Colours stand in the drawing as attributes and can be overruled by style sheets through the classes `s0` … `s7`
//! (strokes), `f0` … `f7` (areas), `ink`, `soft` and `grid`.
//! Leaves out: interaction, and everything that needs a font's metrics (widths of text are estimated).

use crate::axis::Axis;
use crate::decimate::{MOST_POINTS, decimated};
use crate::escape::escape;
use crate::{Figure, Ink, Layer, Mark, PALETTE, Scale, Symbol};

/// Width and height of a figure (px); it scales with its page.
const SIZE: [f64; 2] = [560.0, 320.0];
const RIGHT: f64 = 16.0;
const BOTTOM: f64 = 46.0;
/// Height of a row of the legend (px).
const LEGEND_ROW: f64 = 18.0;
/// Estimated width of a letter at 12 px (px).
const LETTER: f64 = 6.7;

/// The figure as one SVG element; what is not finite is left out.
pub fn svg(figure: &Figure) -> String {
    let points: Vec<(Option<f64>, f64)> = figure.layers.iter().flat_map(Layer::points).collect();
    let finite = |point: &&(Option<f64>, f64)| point.1.is_finite() && point.0.is_none_or(f64::is_finite);
    let abscissae = points.iter().filter(finite).filter_map(|point| point.0);
    let ordinates = points.iter().filter(finite).map(|point| point.1);
    let margin = if figure.x.categories.is_empty() { 0.0 } else { 0.001 };
    let x_axis = Axis::of(abscissae.chain(figure.x.holds.iter().copied()), 7, margin, false);
    let y_axis = if stands_on_zero(figure) && ordinates.clone().all(|y| y >= 0.0) {
        Axis::from_zero(ordinates.chain(figure.y.holds.iter().copied()).fold(0.0, f64::max), 5)
    } else {
        Axis::of(ordinates.chain(figure.y.holds.iter().copied()), 5, 0.05, figure.is_logarithmic())
    };
    let (legend, top) = legend(figure);
    let frame = Frame::new(&y_axis, top);
    let (x_axis, y_axis) = if figure.to_scale { frame.to_scale(&x_axis, &y_axis) } else { (x_axis, y_axis) };

    let mut body = legend + &frame.axes(&x_axis, &y_axis, &figure.x, &figure.y.label);
    if !figure.has_data() {
        body += &text(0.5 * (frame.left + frame.right), 0.5 * (frame.top + frame.bottom), "middle", "soft", "no data");
    }
    for layer in &figure.layers {
        body += &frame.draw(&x_axis, &y_axis, layer);
    }
    document(&figure.title, &body)
}

/// Bars are honest only on an axis that begins at zero.
fn stands_on_zero(figure: &Figure) -> bool {
    figure.layers.iter().any(|layer| matches!(layer.mark, Mark::Bars { .. }))
}

/// A polyline, interrupted at gaps.
fn curve(ink: Ink, dashed: bool, points: impl Iterator<Item = Option<[f64; 2]>>) -> String {
    let mut path = String::new();
    let mut pen_down = false;
    for point in points {
        if let Some([x, y]) = point {
            // A lone point between gaps shows as a dot: the cap of a line of no length.
            path += &if pen_down { format!("L{x:.1} {y:.1}") } else { format!("M{x:.1} {y:.1}h0") };
        }
        pen_down = point.is_some();
    }
    stroke(ink, 1.8, if dashed { " stroke-dasharray=\"7 4\"" } else { "" }, &path)
}

/// Dots: round caps of lines of no length.
fn cloud(ink: Ink, points: impl Iterator<Item = Option<[f64; 2]>>) -> String {
    let path: String = points.flatten().map(|[x, y]| format!("M{x:.1} {y:.1}h0")).collect();
    stroke(ink, 2.4, " stroke-opacity=\"0.45\"", &path)
}

/// A symbol around (x, y).
fn symbol_path(symbol: Symbol, [x, y]: [f64; 2]) -> String {
    match symbol {
        Symbol::Dot => format!("M{x:.1} {y:.1}h0"),
        Symbol::Cross => format!("M{:.1} {:.1}l9 9m-9 0l9 -9", x - 4.5, y - 4.5),
        Symbol::Diamond => format!("M{x:.1} {:.1}l6 6l-6 6l-6 -6z", y - 6.0),
    }
}

fn stroke(ink: Ink, width: f64, more: &str, path: &str) -> String {
    if path.is_empty() {
        return String::new();
    }
    let colour = PALETTE[ink % PALETTE.len()];
    format!(
        "<path class=\"s{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\" \
         stroke-linejoin=\"round\"{more} d=\"{path}\"/>\n",
        ink % PALETTE.len()
    )
}

fn area(ink: Ink, more: &str, path: &str) -> String {
    if path.is_empty() {
        return String::new();
    }
    let k = ink % PALETTE.len();
    format!("<path class=\"f{k}\" fill=\"{}\"{more} d=\"{path}\"/>\n", PALETTE[k])
}

/// How a layer is shown in the legend.
fn sample(layer: &Layer, x: f64, y: f64) -> String {
    match &layer.mark {
        Mark::Line { dashed, .. } => stroke(
            layer.ink,
            2.5,
            if *dashed { " stroke-dasharray=\"6 4\"" } else { "" },
            &format!("M{x:.1} {y:.1}h18"),
        ),
        Mark::Level { .. } => stroke(layer.ink, 1.4, " stroke-dasharray=\"2 4\"", &format!("M{x:.1} {y:.1}h18")),
        Mark::Symbols { symbol: symbol @ (Symbol::Cross | Symbol::Diamond), .. } => {
            stroke(layer.ink, 2.0, "", &symbol_path(*symbol, [x + 9.0, y]))
        }
        Mark::Cloud { .. } | Mark::Symbols { .. } => stroke(layer.ink, 9.0, "", &format!("M{:.1} {y:.1}h0", x + 9.0)),
        Mark::Band { .. } => area(layer.ink, " fill-opacity=\"0.25\"", &format!("M{x:.1} {:.1}h18v10h-18z", y - 5.0)),
        Mark::Bars { .. } => area(layer.ink, "", &format!("M{x:.1} {:.1}h18v10h-18z", y - 5.0)),
    }
}

/// Rows of samples with names above the figure, and the height they take (px). One nameless layer needs none.
fn legend(figure: &Figure) -> (String, f64) {
    let mut drawing = String::new();
    let mut named: Vec<&str> = Vec::new();
    let (mut x, mut row) = (12.0, 0.0);
    for layer in figure.layers.iter().filter(|layer| !layer.name.is_empty()) {
        if named.contains(&layer.name.as_str()) {
            continue;
        }
        named.push(&layer.name);
        let width = 42.0 + LETTER * layer.name.chars().count() as f64;
        if x > 12.0 && x + width > SIZE[0] - RIGHT {
            (x, row) = (12.0, row + 1.0);
        }
        let y = 12.0 + row * LEGEND_ROW;
        drawing += &sample(layer, x, y);
        drawing += &text(x + 24.0, y + 4.0, "start", "ink", &layer.name);
        x += width;
    }
    let height = if drawing.is_empty() { 10.0 } else { 12.0 + (row + 1.0) * LEGEND_ROW };
    (drawing, height)
}

/// Abscissae and the ordinates of a band, thinned so that no extreme is lost.
fn thinned_band(x: &[f64], low: &[f64], high: &[f64]) -> Vec<[f64; 3]> {
    let count = x.len().min(low.len()).min(high.len());
    let per = count.div_ceil(MOST_POINTS / 2).max(1);
    (0..count)
        .step_by(per)
        .map(|first| {
            let last = (first + per).min(count);
            // A NaN in the bucket makes a gap.
            let least =
                low[first..last].iter().copied().fold(f64::INFINITY, |a, b| if b.is_nan() { b } else { a.min(b) });
            let most =
                high[first..last].iter().copied().fold(f64::NEG_INFINITY, |a, b| if b.is_nan() { b } else { a.max(b) });
            [x[first], least, most]
        })
        .collect()
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

    /// The axes with the shorter one widened until one unit is as long on both.
    fn to_scale(&self, x_axis: &Axis, y_axis: &Axis) -> (Axis, Axis) {
        let (width, height) = (self.right - self.left, self.bottom - self.top);
        let unit = (x_axis.span() / width).max(y_axis.span() / height);
        (x_axis.widened(unit * width, 7), y_axis.widened(unit * height, 5))
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

    /// One layer.
    fn draw(&self, x_axis: &Axis, y_axis: &Axis, layer: &Layer) -> String {
        let placed = |x: &[f64], y: &[f64], joined: bool| -> Vec<Option<[f64; 2]>> {
            let count = x.len().min(y.len());
            decimated(&y[..count], joined).into_iter().map(|k| self.place(x_axis, y_axis, [x[k], y[k]])).collect()
        };
        match &layer.mark {
            Mark::Line { x, y, dashed } => curve(layer.ink, *dashed, placed(x, y, true).into_iter()),
            Mark::Cloud { x, y } => cloud(layer.ink, placed(x, y, false).into_iter()),
            Mark::Symbols { x, y, symbol, .. } => {
                let width = if *symbol == Symbol::Dot { 6.0 } else { 2.0 };
                let path = x.iter().zip(y).filter_map(|(x, y)| self.place(x_axis, y_axis, [*x, *y]));
                stroke(layer.ink, width, "", &path.map(|at| symbol_path(*symbol, at)).collect::<String>())
            }
            Mark::Band { x, low, high } => {
                let thin = thinned_band(x, low, high);
                let runs = thin.split(|point| point.iter().any(|value| !value.is_finite()));
                let path = runs.filter(|run| run.len() > 1).map(|run| {
                    let edge = |point: &[f64; 3], k: usize| {
                        format!("L{:.1} {:.1}", self.x(x_axis, point[0]), self.y(y_axis, point[k]))
                    };
                    let there = run.iter().map(|point| edge(point, 2)).collect::<String>();
                    let back = run.iter().rev().map(|point| edge(point, 1)).collect::<String>();
                    format!("M{}{back}z", there.get(1..).unwrap_or(""))
                });
                area(layer.ink, " fill-opacity=\"0.25\"", &path.collect::<String>())
            }
            Mark::Bars { x, base, height, width } => {
                let bars = x
                    .iter()
                    .zip(base.iter().zip(height))
                    .filter(|(x, (base, height))| x.is_finite() && base.is_finite() && height.is_finite());
                let path = bars.map(|(x, (base, height))| {
                    let (left, right) = (self.x(x_axis, x - 0.5 * width), self.x(x_axis, x + 0.5 * width));
                    let (foot, top) = (self.y(y_axis, *base), self.y(y_axis, base + height));
                    let gap = if right - left > 4.0 { 1.0 } else { 0.0 };
                    format!("M{left:.1} {foot:.1}V{top:.1}H{:.1}V{foot:.1}z", right - gap)
                });
                area(layer.ink, "", &path.collect::<String>())
            }
            Mark::Level { y } if y.is_finite() => {
                let path = format!("M{:.1} {:.1}H{:.1}", self.left, self.y(y_axis, *y), self.right);
                stroke(layer.ink, 1.4, " stroke-dasharray=\"2 4\"", &path)
            }
            Mark::Level { .. } => String::new(),
        }
    }

    /// Ticks of an axis: round numbers, or names.
    fn x_ticks(axis: &Axis, scale: &Scale) -> Vec<(f64, String)> {
        if scale.categories.is_empty() {
            let meant = |tick: &(f64, String)| !scale.whole || (tick.0 - tick.0.round()).abs() < 1e-9;
            return axis.ticks().into_iter().filter(meant).collect();
        }
        scale.categories.iter().enumerate().map(|(k, name)| (k as f64, name.clone())).collect()
    }

    fn axes(&self, x_axis: &Axis, y_axis: &Axis, x_scale: &Scale, y_label: &str) -> String {
        let mut drawing = String::new();
        let mut grid = String::new();
        for (at, label) in Self::x_ticks(x_axis, x_scale) {
            let x = self.x(x_axis, at);
            if x_scale.categories.is_empty() {
                grid += &format!("M{x:.1} {:.1}V{:.1}", self.top, self.bottom);
            }
            drawing += &text(x, self.bottom + 18.0, "middle", "ink", &label);
        }
        if x_axis.holds_zero() && x_scale.categories.is_empty() {
            drawing += &self.zero_line(&format!("M{:.1} {:.1}V{:.1}", self.x(x_axis, 0.0), self.top, self.bottom));
        }
        drawing += &text(0.5 * (self.left + self.right), SIZE[1] - 8.0, "middle", "soft", &x_scale.label);
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

    type MakeMark = fn(Vec<f64>, Vec<f64>) -> Mark;

    fn figure(series: Vec<(Vec<f64>, Vec<f64>)>, of: MakeMark) -> Figure {
        let scale = Scale::of("torque [Nm]").or_logarithmic();
        let mut figure = Figure::new("t < & >", Scale::of("velocity [rad/s]"), scale);
        for (x, y) in series {
            figure.layers.push(Layer { name: "a <b> & \"c\"".to_owned(), ink: 5, mark: of(x, y) });
        }
        figure
    }

    /// Numbers of all paths and coordinates are finite, whatever the data and the mark.
    #[test]
    fn degenerate_data_give_clean_drawings() {
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
        let marks: [MakeMark; 6] = [
            |x, y| Mark::Line { x, y, dashed: true },
            |x, y| Mark::Cloud { x, y },
            |x, y| Mark::Symbols { x, y, symbol: Symbol::Cross, notes: Vec::new() },
            |x, y| Mark::Band { x, low: y.iter().map(|y| y - 1.0).collect(), high: y },
            |x, y| Mark::Bars { x, base: y.clone(), height: y, width: 0.8 },
            |_, y| Mark::Level { y: y.first().copied().unwrap_or(f64::NAN) },
        ];
        for (k, case) in cases.into_iter().enumerate() {
            for (m, mark) in marks.into_iter().enumerate() {
                let svg = svg(&figure(case.clone(), mark));
                let bare = svg.replace("translate", "").replace("text-anchor", "");
                for word in ["NaN", "inf", "-0.0\""] {
                    assert!(!bare.contains(word), "case {k}, mark {m}: {word} in {svg}");
                }
                assert!(!svg.contains("a <b>") && svg.contains("t &lt; &amp; &gt;"), "{svg}");
            }
        }
        let empty = svg(&figure(vec![(vec![nan], vec![nan])], |x, y| Mark::Cloud { x, y }));
        assert!(empty.contains("no data"), "{empty}");
    }

    /// Twice as high a bar has twice as long a path.
    #[test]
    fn bars_stand_on_zero() {
        let scale = Scale::categories("joint", vec!["0".to_owned(), "1".to_owned()]);
        let bars = Layer::bars("", 0, vec![0.0, 1.0], vec![1000.0, 2000.0], 0.8);
        let drawn = svg(&Figure::new("t", scale, Scale::of("torque [Nm]")).with(bars));
        let path = drawn.split("class=\"f0\"").nth(1).unwrap().split('"').nth(3).unwrap();
        let heights: Vec<f64> = path
            .split('M')
            .skip(1)
            .map(|bar| {
                let foot: f64 = bar.split(['V', ' ']).nth(1).unwrap().parse().unwrap();
                let top: f64 = bar.split(['V', 'H']).nth(1).unwrap().parse().unwrap();
                foot - top
            })
            .collect();
        assert!((heights[1] / heights[0] - 2.0).abs() < 0.01, "{heights:?} in {path}");
    }

    #[test]
    fn long_legends_wrap_and_name_each_layer_once() {
        let mut wide = Figure::default();
        for k in 0..6 {
            let name = format!("a name of thirty letters or so {k}");
            wide.layers.push(Layer::line(&name, k, vec![], vec![]));
            wide.layers.push(Layer::band(&name, k, vec![], vec![], vec![]));
        }
        let (drawing, height) = legend(&wide);
        assert!(height > 3.0 * LEGEND_ROW && drawing.matches("<text").count() == 6, "{drawing}");
    }
}
