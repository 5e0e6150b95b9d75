//! Plots of recordings of any length: their curves are made anew for the pixels and the range that they show.

use egui::{Color32, Id, RichText, Ui, Vec2b};
use egui_plot::{FilledArea, HoverPosition, Line, Plot, PlotPoint, PlotPoints, PlotUi};
use tribo_figure::number::significant;
use tribo_figure::{Columns, Figure, Layer, Scale, Signals};

use crate::export_request::{Format, request};
use crate::plot::{legend, marks, marks_across, tick};
use crate::theme::{self, GAP, NARROWEST, ink};

/// One name for the abscissa of all figures.
const TIME: &str = "time of the log [s]";
/// Name of all confidence bands.
const BAND: &str = "95 %";
/// Width of a curve (px).
const WIDTH: f32 = 1.2;

/// Cells side by side, as many as are readable, which together fill what is left of the view; `show` is handed the number of
/// the cell and the height of its axes (px).
pub fn cells(ui: &mut Ui, count: usize, mut show: impl FnMut(&mut Ui, usize, f32)) {
    let columns = (((ui.available_width() + GAP) / (NARROWEST + GAP)).floor() as usize).clamp(1, 3).min(count.max(1));
    let rows = count.div_ceil(columns).max(1);
    let height = ((ui.available_height() - 8.0) / rows as f32 - 66.0).clamp(150.0, 420.0);
    for row in 0..rows {
        ui.columns(columns, |cells| {
            for (column, cell) in cells.iter_mut().enumerate().filter(|(column, _)| row * columns + column < count) {
                show(cell, row * columns + column, height);
            }
        });
    }
}

/// One channel of a recording, with the channels of its limits.
pub struct Curve<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// Colour.
    pub ink: usize,
    /// The recording and the number of the channel.
    pub of: (&'a Signals, usize),
    /// Channels of the lower and the upper limit.
    pub band: Option<(usize, usize)>,
}

impl Curve<'_> {
    /// What the legend shows of it.
    fn legend(&self) -> Vec<Layer> {
        let mut layers = vec![Layer::line(self.name, self.ink, Vec::new(), Vec::new())];
        if self.band.is_some() {
            layers.push(Layer::band(BAND, self.ink, Vec::new(), Vec::new(), Vec::new()));
        }
        layers
    }

    /// Abscissae, lower and upper limits of the band; of each pixel column the widest.
    fn limits(&self, columns: &Columns) -> Vec<[f64; 3]> {
        let Some((low, high)) = self.band else { return Vec::new() };
        let signals = self.of.0;
        let mut edges: Vec<[f64; 3]> = Vec::new();
        for (low, high) in signals.curve(low, columns).into_iter().zip(signals.curve(high, columns)) {
            match edges.last_mut().filter(|last| last[0] == low[0]) {
                Some(last) => (last[1], last[2]) = (last[1].min(low[1]), last[2].max(high[1])),
                None => edges.push([low[0], low[1], high[1]]),
            }
        }
        edges
    }
}

/// A plot of some channels, with its title, legend, read-out and menu of exports.
pub fn signal_plot(ui: &mut Ui, label: &str, curves: &[Curve<'_>], height: f32) {
    let dark = ui.visuals().dark_mode;
    let width = (ui.available_width().max(64.0) * ui.ctx().pixels_per_point()) as usize;
    let span = curves.first().map_or([0.0, 1.0], |curve| curve.of.0.span_s());
    let mut save = None;
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(label).strong()).truncate());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.menu_button(RichText::new("save").small().weak(), |ui| {
                for format in Format::ALL {
                    if ui.button(format!("{label} as {}", format.name())).clicked() {
                        save = Some(format);
                        ui.close();
                    }
                }
            });
        });
    });
    let names: Vec<Layer> = curves.iter().flat_map(Curve::legend).collect();
    let hidden = legend(ui, label, &names);
    let across = marks_across(ui.available_width());
    let link = Id::unique("time of the log");
    let plot = Plot::new(("signal", label))
        .height(height)
        .x_axis_label(RichText::new(TIME).small())
        .y_axis_label(RichText::new(label).small())
        .allow_scroll(Vec2b::FALSE)
        .grid_color(theme::grid(dark))
        .grid_fade(0.0)
        .x_grid_spacer(move |input| marks(input, across, false, false))
        .y_grid_spacer(|input| marks(input, 5.0, false, false))
        .x_axis_formatter(|mark, _| tick(mark, false))
        .y_axis_formatter(|mark, _| tick(mark, false))
        .include_x(span[0])
        .include_x(span[1])
        .link_axis(link, Vec2b::new(true, false))
        .link_cursor(link, Vec2b::new(true, false))
        .label_formatter(|position| {
            let (HoverPosition::NearDataPoint { position: at, .. } | HoverPosition::Elsewhere { position: at }) =
                position;
            Some(read_out(label, curves, at.x))
        });
    // A constant has no range of its own: the width of its own line would become one.
    let plot = match extremes(curves) {
        Some([low, high]) if high - low <= FLAT * high.abs().max(1.0) => {
            plot.include_y(low - 1.0).include_y(high + 1.0)
        }
        _ => plot,
    };
    let shown = plot.show(ui, |plot| {
        let bounds = plot.plot_bounds();
        // In the first frame there are no bounds yet.
        let range = [bounds.min()[0], bounds.max()[0]];
        let range = if plot.auto_bounds().x || range[0] >= range[1] { span } else { range };
        // The curves of a plot nearly always share one recording: its columns are found once.
        let mut found: Option<(&Signals, Columns)> = None;
        for curve in curves.iter().filter(|curve| !hidden.iter().any(|name| name == curve.name)) {
            let signals = curve.of.0;
            let columns = match found.take().filter(|found| std::ptr::eq(found.0, signals)) {
                Some((_, columns)) => columns,
                None => signals.columns(range, width),
            };
            let band = !hidden.iter().any(|name| name == BAND);
            draw(plot, curve, &columns, band, dark);
            found = Some((signals, columns));
        }
        range
    });
    if let Some(format) = save {
        request(ui.ctx(), figure(label, curves, shown.inner, width), format);
    }
}

/// Range over which a curve counts as constant, relative to its value or 1.
const FLAT: f64 = 1e-9;

/// Smallest and largest value of all curves.
fn extremes(curves: &[Curve<'_>]) -> Option<[f64; 2]> {
    let values = curves.iter().flat_map(|Curve { of: (signals, channel), .. }| {
        let whole = signals.columns(signals.span_s(), 1);
        signals.curve(*channel, &whole).into_iter().map(|[_, y]| y).filter(|y| y.is_finite())
    });
    values.fold(None, |range, y| {
        let [low, high] = range.unwrap_or([y, y]);
        Some([f64::min(low, y), f64::max(high, y)])
    })
}

/// What every curve of a plot shows at a moment.
fn read_out(label: &str, curves: &[Curve<'_>], time_s: f64) -> String {
    let mut lines = vec![label.to_owned(), format!("{TIME}: {}", significant(time_s, 6))];
    for Curve { name, of: (signals, channel), band, .. } in curves {
        let row = signals.row_at(time_s);
        let value = |channel: usize| row.and_then(|row| signals.channels().get(channel)?.samples().get(row).copied());
        let told = |channel: usize| value(channel).map_or("–".to_owned(), |value| significant(f64::from(value), 4));
        let limits = band.map_or(String::new(), |(low, high)| format!(" ({} to {})", told(low), told(high)));
        lines.push(format!("{name}: {}{limits}", told(*channel)));
    }
    lines.join("\n")
}

fn draw(plot: &mut PlotUi<'_>, curve: &Curve<'_>, columns: &Columns, with_band: bool, dark: bool) {
    let ((signals, channel), colour) = (curve.of, ink(curve.ink, dark));
    if with_band {
        area(plot, &curve.limits(columns), colour.gamma_multiply(0.25));
    }
    // Where a column holds many samples, the curve is the area between its ends: a fifth of the triangles of a line.
    if let Some(mut band) = signals.band(channel, columns) {
        let half = 0.5 * f64::from(WIDTH) * plot.transform().dvalue_dpos()[1].abs();
        for [_, low, high] in &mut band {
            (*low, *high) = (*low - half, *high + half);
        }
        area(plot, &band, colour);
        return;
    }
    let points = signals.curve(channel, columns);
    for run in points.split(|point| !point[1].is_finite()).filter(|run| !run.is_empty()) {
        let run = run.iter().map(|[x, y]| PlotPoint::new(*x, *y)).collect();
        plot.line(Line::new(curve.name, PlotPoints::Owned(run)).color(colour).width(WIDTH).allow_hover(false));
    }
}

/// The area between lower and upper limits, interrupted at gaps.
fn area(plot: &mut PlotUi<'_>, edges: &[[f64; 3]], colour: Color32) {
    for run in edges.split(|edge| edge.iter().any(|value| !value.is_finite())).filter(|run| run.len() > 1) {
        let [x, low, high] = [0, 1, 2].map(|k| run.iter().map(|edge| edge[k]).collect::<Vec<f64>>());
        plot.add(FilledArea::new(BAND, &x, &low, &high).fill_color(colour).allow_hover(false));
    }
}

/// What a signal plot shows, as a figure to be saved.
fn figure(label: &str, curves: &[Curve<'_>], range: [f64; 2], width: usize) -> Figure {
    let mut figure = Figure::new(label, Scale::of(TIME), Scale::of(label));
    for curve in curves {
        let (signals, channel) = curve.of;
        let columns = signals.columns(range, width);
        let split = |channel: usize| -> (Vec<f64>, Vec<f64>) {
            signals.curve(channel, &columns).into_iter().map(|[x, y]| (x, y)).unzip()
        };
        if curve.band.is_some() {
            let limits = curve.limits(&columns);
            let [x, low, high] = [0, 1, 2].map(|k| limits.iter().map(|edge| edge[k]).collect::<Vec<f64>>());
            figure.layers.push(Layer::band(BAND, curve.ink, x, low, high));
        }
        let (x, y) = split(channel);
        figure.layers.push(Layer::line(curve.name, curve.ink, x, y));
    }
    figure
}
