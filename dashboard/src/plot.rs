//! A [`Figure`] in the window.

use egui::{Color32, Id, RichText, Stroke, Ui, Vec2b};
use egui_plot::{
    Bar, BarChart, FilledArea, GridMark, HLine, HoverPosition, Legend, Line, LineStyle, MarkerShape, Plot, PlotPoint,
    PlotPoints, PlotUi, Points, VLine,
};
use tribo_figure::number::significant;
use tribo_figure::{Figure, Layer, Mark, Symbol};

use crate::export::{Format, request};
use crate::theme::{GAP, NARROWEST, ink};

/// How a figure is shown.
#[derive(Clone, Copy, Debug, Default)]
pub struct Look {
    /// Height of the axes with their labels (px).
    pub height: f32,
    /// Figures of one group share abscissa and cursor.
    pub group: Option<&'static str>,
    /// Where a vertical line marks the moment that other views show.
    pub cursor: Option<f64>,
}

/// Figures side by side, as many as are readable.
pub fn grid(ui: &mut Ui, figures: &[Figure], look: Look) {
    let width = ui.available_width();
    let columns = (((width + GAP) / (NARROWEST + GAP)).floor() as usize).clamp(1, 3).min(figures.len().max(1));
    for row in figures.chunks(columns) {
        ui.columns(columns, |cells| {
            for (cell, figure) in cells.iter_mut().zip(row) {
                show(cell, figure, look);
            }
        });
    }
}

/// One figure: title, menu of exports, axes, legend, read-out.
pub fn show(ui: &mut Ui, figure: &Figure, look: Look) {
    let dark = ui.visuals().dark_mode;
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(&figure.title).strong()).truncate()).on_hover_text(&figure.title);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let button = ui.menu_button(RichText::new("save").small().weak(), |ui| {
                for format in Format::ALL {
                    if ui.button(format!("{} as {}", figure.title, format.name())).clicked() {
                        request(ui.ctx(), figure.clone(), format);
                        ui.close();
                    }
                }
            });
            button.response.on_hover_text("Save this figure as PNG, SVG or CSV");
        });
    });
    if !figure.has_data() {
        let size = egui::vec2(ui.available_width(), look.height);
        ui.allocate_ui(size, |ui| ui.centered_and_justified(|ui| ui.weak("no data")));
        return;
    }
    let logarithmic = figure.is_logarithmic();
    let named = figure.layers.iter().filter(|layer| !layer.name.is_empty()).count();
    let mut plot = Plot::new(&figure.title)
        .height(look.height)
        .x_axis_label(RichText::new(&figure.x.label).small())
        .y_axis_label(RichText::new(&figure.y.label).small())
        .allow_scroll(Vec2b::FALSE)
        .set_margin_fraction(egui::vec2(0.0, 0.06))
        .grid_spacing(egui::Rangef::new(24.0, 220.0))
        .y_axis_formatter(move |mark: GridMark, _| tick(mark, logarithmic))
        .label_formatter(move |position: &HoverPosition<'_>| Some(read_out(figure, position, logarithmic)));
    if named > 0 {
        let corner = egui_plot::Corner::RightTop;
        plot =
            plot.legend(Legend::default().position(corner).text_style(egui::TextStyle::Small).background_alpha(0.75));
    }
    let categories = &figure.x.categories;
    if categories.is_empty() {
        plot = plot.x_axis_formatter(move |mark: GridMark, _| tick(mark, false));
    } else {
        plot = plot
            .x_grid_spacer(|_| (0..categories.len()).map(|k| GridMark { value: k as f64, step_size: 1.0 }).collect())
            .x_axis_formatter(|mark: GridMark, _| {
                categories.get(mark.value.round() as usize).cloned().unwrap_or_default()
            });
    }
    if let Some(group) = look.group {
        let id = Id::unique(group);
        plot = plot.link_axis(id, Vec2b::new(true, false)).link_cursor(id, Vec2b::new(true, false));
    }
    for value in &figure.x.holds {
        plot = plot.include_x(*value);
    }
    for value in &figure.y.holds {
        plot = plot.include_y(ordinate(*value, logarithmic));
    }
    plot.show(ui, |plot| {
        for layer in &figure.layers {
            draw(plot, layer, logarithmic, dark);
        }
        if let Some(cursor) = look.cursor {
            plot.vline(VLine::new("", cursor).color(ink(1, dark)).width(1.0).allow_hover(false));
        }
    });
}

/// What a logarithmic axis cannot show is a gap.
fn ordinate(y: f64, logarithmic: bool) -> f64 {
    match logarithmic {
        true if y > 0.0 => y.log10(),
        true => f64::NAN,
        false => y,
    }
}

fn tick(mark: GridMark, logarithmic: bool) -> String {
    if !logarithmic {
        // As many decimals as tell neighbouring marks apart.
        let decimals = (-mark.step_size.log10()).ceil().clamp(0.0, 9.0) as usize;
        return format!("{:.decimals$}", mark.value + 0.0).replace('-', "−");
    }
    // Only whole decades and, in between, 2 and 5.
    let power = mark.value.floor();
    let lead = 10f64.powf(mark.value - power);
    if (mark.value - mark.value.round()).abs() < 1e-6 || mark.step_size < 0.5 {
        return significant(lead * 10f64.powf(power), 2);
    }
    String::new()
}

fn read_out(figure: &Figure, position: &HoverPosition<'_>, logarithmic: bool) -> String {
    let (name, at, index) = match position {
        HoverPosition::NearDataPoint { plot_name, position, index } => (*plot_name, position, Some(*index)),
        HoverPosition::Elsewhere { position } => ("", position, None),
    };
    let y = if logarithmic { 10f64.powf(at.y) } else { at.y };
    let note = index.and_then(|index| {
        figure.layers.iter().find(|layer| layer.name == name).and_then(|layer| match &layer.mark {
            Mark::Symbols { notes, .. } => notes.get(index),
            _ => None,
        })
    });
    if let Some(note) = note {
        return note.clone();
    }
    let x = match figure.x.categories.get(at.x.round().max(0.0) as usize) {
        Some(category) => category.clone(),
        None => format!("{}: {}", figure.x.label, significant(at.x, 5)),
    };
    let name = if name.is_empty() { String::new() } else { format!("{name}\n") };
    format!("{name}{x}\n{}: {}", figure.y.label, significant(y, 4))
}

fn points(x: &[f64], y: &[f64], logarithmic: bool) -> impl Iterator<Item = PlotPoint> {
    x.iter().zip(y).map(move |(x, y)| PlotPoint::new(*x, ordinate(*y, logarithmic)))
}

fn is_finite(point: &PlotPoint) -> bool {
    point.x.is_finite() && point.y.is_finite()
}

fn draw(plot: &mut PlotUi<'_>, layer: &Layer, logarithmic: bool, dark: bool) {
    let colour = ink(layer.ink, dark);
    let name = layer.name.as_str();
    match &layer.mark {
        Mark::Line { x, y, dashed } => {
            let all: Vec<PlotPoint> = points(x, y, logarithmic).collect();
            for run in all.split(|point| !is_finite(point)).filter(|run| !run.is_empty()) {
                let style = if *dashed { LineStyle::dashed_dense() } else { LineStyle::Solid };
                plot.line(Line::new(name, PlotPoints::Owned(run.to_vec())).color(colour).width(1.6).style(style));
            }
        }
        Mark::Cloud { x, y } => {
            let all = points(x, y, logarithmic).filter(is_finite).collect();
            plot.points(Points::new(name, PlotPoints::Owned(all)).color(colour.gamma_multiply(0.5)).radius(1.2));
        }
        Mark::Symbols { x, y, symbol, .. } => {
            let all = points(x, y, logarithmic).filter(is_finite).collect();
            let (shape, radius) = match symbol {
                Symbol::Dot => (MarkerShape::Circle, 3.0),
                Symbol::Cross => (MarkerShape::Cross, 5.0),
                Symbol::Diamond => (MarkerShape::Diamond, 6.0),
            };
            plot.points(Points::new(name, PlotPoints::Owned(all)).color(colour).shape(shape).radius(radius));
        }
        Mark::Band { x, low, high } => band(plot, name, colour, x, low, high, logarithmic),
        Mark::Bars { x, base, height, width } => {
            let bar = |k: usize| {
                Bar::new(x[k], height[k]).base_offset(base[k]).width(0.97 * width).fill(colour).stroke(Stroke::NONE)
            };
            plot.bar_chart(BarChart::new(name, (0..x.len().min(height.len())).map(bar).collect()).color(colour));
        }
        Mark::Level { y } => {
            let line = HLine::new(name, ordinate(*y, logarithmic)).color(colour).width(1.2);
            plot.hline(line.style(LineStyle::dotted_dense()));
        }
    }
}

fn band(plot: &mut PlotUi<'_>, name: &str, colour: Color32, x: &[f64], low: &[f64], high: &[f64], logarithmic: bool) {
    let edges: Vec<[f64; 3]> = x
        .iter()
        .zip(low.iter().zip(high))
        .map(|(x, (low, high))| [*x, ordinate(*low, logarithmic), ordinate(*high, logarithmic)])
        .collect();
    for run in edges.split(|edge| edge.iter().any(|value| !value.is_finite())).filter(|run| run.len() > 1) {
        let [x, low, high] = [0, 1, 2].map(|k| run.iter().map(|edge| edge[k]).collect::<Vec<f64>>());
        plot.add(FilledArea::new(name, &x, &low, &high).fill_color(colour.gamma_multiply(0.25)).allow_hover(false));
    }
}
