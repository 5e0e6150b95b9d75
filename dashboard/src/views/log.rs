//! Channels and wrench of a log, of any length.

use egui::{Id, RichText, ScrollArea, Ui, Vec2b};
use egui_plot::{FilledArea, Line, Plot, PlotPoint, PlotPoints};
use tribo_figure::number::significant;
use tribo_figure::{Columns, Figure, Layer, Scale, Signals};

use crate::export::{Format, request};
use crate::log_snapshot::LogSnapshot;
use crate::plot::{legend, marks, tick};
use crate::source::Source;
use crate::theme::{self, GAP, NARROWEST, ink};

/// What the user has chosen.
#[derive(Debug, Default)]
pub struct LogView {
    channels: bool,
}

/// One name for the abscissa of all figures.
const TIME: &str = "time of the log [s]";

impl LogView {
    /// The view.
    pub fn ui(&mut self, ui: &mut Ui, source: &mut Source) {
        let Some(log) = source.snapshot().log.clone() else {
            let todo = "Give a robot log above: canonical CSV (.gz), Parquet or a public data set; or start with: tribo dashboard LOG.";
            super::empty(ui, "No log is open", todo);
            return;
        };
        head(ui, &log);
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.channels, false, "Wrench");
            ui.selectable_value(&mut self.channels, true, "Channels");
        });
        ui.add_space(4.0);
        ScrollArea::vertical()
            .auto_shrink(false)
            .show(ui, |ui| if self.channels { channels(ui, &log.signals) } else { wrench(ui, &log) });
    }
}

fn head(ui: &mut Ui, log: &LogSnapshot) {
    let [first, last] = log.signals.span_s();
    ui.label(RichText::new(log.source.path.display().to_string()).heading());
    let model = log.source.model.as_ref().map_or("the bare Panda".to_owned(), |path| path.display().to_string());
    ui.label(format!(
        "{} samples over {} s, {} channels; model: {model}; estimator: ekf with its friction",
        log.log.rows(),
        significant(last - first, 4),
        log.signals.channels().len()
    ));
    let summary = &log.summary;
    let against = summary.against_reference.map_or(String::new(), |errors| {
        format!(
            "; against O_F_ext: RMSE {} N, {} Nm",
            significant(errors.rmse_force_n, 3),
            significant(errors.rmse_moment_nm, 3)
        )
    });
    if let Some(nis) = summary.mean_nis {
        ui.label(format!("mean NIS {} (6 where model and noise fit the log){against}", significant(nis, 3)));
    }
}

/// Six components, each with its band; the reference where the log has one.
fn wrench(ui: &mut Ui, log: &LogSnapshot) {
    let labels: Vec<&str> = log.wrench.channels().iter().step_by(3).map(|channel| channel.quantity.as_str()).collect();
    let reference: Vec<usize> = (0..log.signals.channels().len())
        .filter(|k| log.signals.channels()[*k].quantity.starts_with("reference wrench"))
        .collect();
    cells(ui, labels.len(), |ui, k, height| {
        let mut curves =
            vec![Curve { name: "estimate", ink: 0, of: (&log.wrench, 3 * k), band: Some((3 * k + 1, 3 * k + 2)) }];
        if let Some(channel) = reference.get(k) {
            curves.push(Curve { name: "O_F_ext of the log", ink: 1, of: (&log.signals, *channel), band: None });
        }
        signal_plot(ui, labels[k], &curves, height);
    });
}

/// Channels of one quantity in one plot.
pub fn channels(ui: &mut Ui, signals: &Signals) {
    let mut quantities: Vec<&str> = Vec::new();
    for channel in signals.channels() {
        if quantities.last() != Some(&channel.quantity.as_str()) {
            quantities.push(&channel.quantity);
        }
    }
    cells(ui, quantities.len(), |ui, k, height| {
        let members = signals.channels().iter().enumerate().filter(|(_, channel)| channel.quantity == quantities[k]);
        let curves: Vec<Curve<'_>> = members
            .enumerate()
            .map(|(ink, (at, channel))| Curve { name: &channel.name, ink, of: (signals, at), band: None })
            .collect();
        signal_plot(ui, quantities[k], &curves, height);
    });
}

fn cells(ui: &mut Ui, count: usize, mut show: impl FnMut(&mut Ui, usize, f32)) {
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
struct Curve<'a> {
    name: &'a str,
    ink: usize,
    of: (&'a Signals, usize),
    band: Option<(usize, usize)>,
}

impl Curve<'_> {
    /// What the legend shows of it.
    fn legend(&self) -> Vec<Layer> {
        let mut layers = vec![Layer::line(self.name, self.ink, Vec::new(), Vec::new())];
        if self.band.is_some() {
            layers.push(Layer::band("95 %", self.ink, Vec::new(), Vec::new(), Vec::new()));
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

/// A plot whose curves are made anew for the pixels and the range that it shows.
fn signal_plot(ui: &mut Ui, label: &str, curves: &[Curve<'_>], height: f32) {
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
    let link = Id::unique("time of the log");
    let plot = Plot::new(("signal", label))
        .height(height)
        .x_axis_label(RichText::new(TIME).small())
        .y_axis_label(RichText::new(label).small())
        .allow_scroll(Vec2b::FALSE)
        .grid_color(theme::grid(dark))
        .grid_fade(0.0)
        .x_grid_spacer(|input| marks(input, 7.0, false, false))
        .y_grid_spacer(|input| marks(input, 5.0, false, false))
        .x_axis_formatter(|mark, _| tick(mark, false))
        .y_axis_formatter(|mark, _| tick(mark, false))
        .include_x(span[0])
        .include_x(span[1])
        .link_axis(link, Vec2b::new(true, false))
        .link_cursor(link, Vec2b::new(true, false))
        .label_formatter(move |position| {
            let (name, at) = match position {
                egui_plot::HoverPosition::NearDataPoint { plot_name, position, .. } => (*plot_name, position),
                egui_plot::HoverPosition::Elsewhere { position } => ("", position),
            };
            Some(format!("{name}\n{TIME}: {}\n{label}: {}", significant(at.x, 6), significant(at.y, 4)))
        });
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
            draw(plot, curve, &columns, dark);
            found = Some((signals, columns));
        }
        range
    });
    if let Some(format) = save {
        request(ui.ctx(), figure(label, curves, shown.inner, width), format);
    }
}

fn draw(plot: &mut egui_plot::PlotUi<'_>, curve: &Curve<'_>, columns: &Columns, dark: bool) {
    let (signals, channel) = curve.of;
    let edges = curve.limits(columns);
    for run in edges.split(|edge| edge.iter().any(|value| !value.is_finite())).filter(|run| run.len() > 1) {
        let [x, low, high] = [0, 1, 2].map(|k| run.iter().map(|edge| edge[k]).collect::<Vec<f64>>());
        let colour = ink(curve.ink, dark).gamma_multiply(0.25);
        plot.add(FilledArea::new("95 %", &x, &low, &high).fill_color(colour).allow_hover(false));
    }
    let points = signals.curve(channel, columns);
    for run in points.split(|point| !point[1].is_finite()).filter(|run| !run.is_empty()) {
        let run = run.iter().map(|[x, y]| PlotPoint::new(*x, *y)).collect();
        plot.line(Line::new(curve.name, PlotPoints::Owned(run)).color(ink(curve.ink, dark)).width(1.2));
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
            figure.layers.push(Layer::band("95 %", curve.ink, x, low, high));
        }
        let (x, y) = split(channel);
        figure.layers.push(Layer::line(curve.name, curve.ink, x, y));
    }
    figure
}
