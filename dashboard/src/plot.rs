//! A [`Figure`] in the window.

use egui::{Color32, Id, RichText, Stroke, Ui, Vec2b};
use egui_plot::{
    Bar, BarChart, FilledArea, GridInput, GridMark, HLine, HoverPosition, Line, LineStyle, MarkerShape, Plot,
    PlotPoint, PlotPoints, PlotUi, Points, VLine,
};
use tribo_figure::number::significant;
use tribo_figure::{Figure, Layer, Mark, Symbol};

use crate::export_request::{Format, request};
use crate::theme::{self, GAP, NARROWEST, ink};

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

/// Columns in which `count` figures are readable.
pub fn columns(ui: &Ui, count: usize) -> usize {
    let width = ui.available_width();
    (((width + GAP) / (NARROWEST + GAP)).floor() as usize).clamp(1, 3).min(count.max(1))
}

/// Height of the axes of `count` figures that together fill what is left of the view (px).
pub fn filling_height(ui: &Ui, count: usize) -> f32 {
    let rows = count.div_ceil(columns(ui, count)).max(1) as f32;
    ((ui.available_height() - 12.0) / rows - TITLE).clamp(150.0, 640.0)
}

/// Figures side by side, as many as are readable.
pub fn grid(ui: &mut Ui, figures: &[Figure], look: Look) {
    let columns = columns(ui, figures.len());
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
    let hidden = legend(ui, &figure.title, &figure.layers);
    let logarithmic = figure.is_logarithmic();
    let mut plot = Plot::new(&figure.title)
        .height(look.height)
        .x_axis_label(RichText::new(&figure.x.label).size(AXIS_LETTERS))
        .y_axis_label(RichText::new(&figure.y.label).size(AXIS_LETTERS))
        .allow_scroll(Vec2b::FALSE)
        .set_margin_fraction(egui::vec2(0.0, 0.06))
        .grid_color(theme::grid(dark))
        .grid_fade(0.0)
        .y_grid_spacer(move |input| marks(input, look.height / TICK_PX, logarithmic, false))
        .y_axis_formatter(move |mark: GridMark, _| tick(mark, logarithmic))
        .label_formatter(move |position: &HoverPosition<'_>| Some(read_out(figure, position, logarithmic)));
    let categories = &figure.x.categories;
    if categories.is_empty() {
        let (ticks, whole) = (marks_across(ui.available_width()), figure.x.whole);
        plot = plot
            .x_grid_spacer(move |input| marks(input, ticks, false, whole))
            .x_axis_formatter(move |mark: GridMark, _| tick(mark, false));
    } else {
        plot = plot
            .x_grid_spacer(|_| (0..categories.len()).map(|k| GridMark { value: k as f64, step_size: 1.0 }).collect())
            .x_axis_formatter(|mark: GridMark, _| {
                categories.get(mark.value.round() as usize).cloned().unwrap_or_default()
            });
    }
    if figure.to_scale {
        plot = plot.data_aspect(1.0);
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
        for layer in figure.layers.iter().filter(|layer| !hidden.contains(&layer.name)) {
            draw(plot, layer, logarithmic, dark);
        }
        if let Some(cursor) = look.cursor {
            plot.vline(VLine::new("", cursor).color(ink(1, dark)).width(1.0).allow_hover(false));
        }
    });
}

/// Height of title and legend of a figure (px).
const TITLE: f32 = 66.0;
/// Lines of more points than this are drawn as bands where they are dense.
const LONG: usize = 1000;

/// What a logarithmic axis cannot show is a gap.
fn ordinate(y: f64, logarithmic: bool) -> f64 {
    match logarithmic {
        true if y > 0.0 => y.log10(),
        true => f64::NAN,
        false => y,
    }
}

/// Size of the letters along an axis (px): a long quantity fits beside a low figure.
const AXIS_LETTERS: f32 = 11.5;
/// Space from tick to tick (px).
const TICK_PX: f32 = 46.0;

/// Most marks on an abscissa of that width (px): closer ones would lose their labels.
pub fn marks_across(width: f32) -> f32 {
    width / (1.6 * TICK_PX)
}

/// Marks at 1, 2, 5 × 10ⁿ; on a logarithmic axis at 1, 2, 5 of each decade, or at decades where there are many.
pub fn marks(input: GridInput, most: f32, logarithmic: bool, whole: bool) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let span = high - low;
    if !(span > 0.0 && span.is_finite()) {
        return Vec::new();
    }
    if logarithmic && span < 12.0 {
        let leads: &[f64] = if span < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let decades = low.floor() as i32..=high.ceil() as i32;
        let all = decades.flat_map(|decade| leads.iter().map(move |lead| f64::from(decade) + lead.log10()));
        return all.filter(|at| (low..=high).contains(at)).map(|value| GridMark { value, step_size: 1.0 }).collect();
    }
    let rough = span / f64::from(most.clamp(2.0, 20.0));
    let power = 10f64.powf(rough.log10().floor());
    let step = power * [1.0, 2.0, 5.0].into_iter().find(|lead| rough <= lead * power).unwrap_or(10.0);
    let step = if whole { step.max(1.0) } else { step };
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last.min(first + 100)).map(|k| GridMark { value: k as f64 * step, step_size: step }).collect()
}

/// The label of a mark, with as many decimals as tell neighbouring marks apart.
pub fn tick(mark: GridMark, logarithmic: bool) -> String {
    if logarithmic {
        return significant(10f64.powf(mark.value), 1);
    }
    let decimals = (-(mark.step_size.log10() + 1e-9).floor()).clamp(0.0, 9.0) as usize;
    // Adding zero turns −0 into 0.
    format!("{:.decimals$}", mark.value + 0.0).replace('-', "−")
}

/// Names above the axes, where they hide no data; a click hides a layer and shows it again. Returns what is hidden.
pub fn legend(ui: &mut Ui, title: &str, layers: &[Layer]) -> Vec<String> {
    let (id, dark) = (Id::unique(("hidden layers", title)), ui.visuals().dark_mode);
    let mut hidden: Vec<String> = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let mut named: Vec<&Layer> = Vec::new();
    for layer in layers.iter().filter(|layer| !layer.name.is_empty()) {
        if !named.iter().any(|other| other.name == layer.name) {
            named.push(layer);
        }
    }
    if named.is_empty() {
        return hidden;
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(5.0, 0.0);
        for layer in named {
            let off = hidden.contains(&layer.name);
            // A name stays beside its sample.
            let letters = egui::TextStyle::Small.resolve(ui.style());
            let words = ui.painter().layout_no_wrap(layer.name.clone(), letters, Color32::PLACEHOLDER);
            if ui.available_size_before_wrap().x < words.size().x + 26.0 {
                ui.end_row();
            }
            sample(ui, layer, if off { ui.visuals().weak_text_color() } else { ink(layer.ink, dark) });
            let text = RichText::new(&layer.name).small();
            let text = if off { text.weak().strikethrough() } else { text };
            let name = ui.add(egui::Label::new(text).selectable(false).sense(egui::Sense::click()));
            if name.on_hover_text("Hide or show").clicked() {
                if off { hidden.retain(|name| *name != layer.name) } else { hidden.push(layer.name.clone()) }
            }
            ui.add_space(8.0);
        }
    });
    ui.data_mut(|data| data.insert_temp(id, hidden.clone()));
    hidden
}

/// How a layer looks, in small.
fn sample(ui: &mut Ui, layer: &Layer, colour: Color32) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(16.0, 14.0), egui::Sense::hover());
    let (painter, middle) = (ui.painter(), rect.center());
    let across = [rect.left_center(), rect.right_center()];
    match &layer.mark {
        Mark::Line { dashed: false, .. } => drop(painter.line_segment(across, Stroke::new(2.0, colour))),
        Mark::Line { .. } => drop(painter.add(egui::Shape::dashed_line(&across, Stroke::new(2.0, colour), 4.0, 2.0))),
        Mark::Level { .. } => drop(painter.add(egui::Shape::dotted_line(&across, colour, 4.0, 1.0))),
        Mark::Symbols { symbol: Symbol::Cross, .. } => {
            for turn in [egui::vec2(4.0, 4.0), egui::vec2(4.0, -4.0)] {
                painter.line_segment([middle - turn, middle + turn], Stroke::new(1.5, colour));
            }
        }
        Mark::Symbols { symbol: Symbol::Diamond, .. } => {
            let corners = [(0.0, -5.0), (5.0, 0.0), (0.0, 5.0), (-5.0, 0.0)].map(|(x, y)| middle + egui::vec2(x, y));
            painter.add(egui::Shape::convex_polygon(corners.to_vec(), colour, Stroke::NONE));
        }
        Mark::Cloud { .. } | Mark::Symbols { .. } => drop(painter.circle_filled(middle, 3.5, colour)),
        Mark::Band { .. } => drop(painter.rect_filled(rect.shrink(2.0), 1.0, colour.gamma_multiply(0.35))),
        Mark::Bars { .. } => drop(painter.rect_filled(rect.shrink(2.0), 1.0, colour)),
    }
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
                plot.line(
                    Line::new(name, PlotPoints::Owned(run.to_vec()))
                        .color(colour)
                        .width(1.6)
                        .style(style)
                        .allow_band(run.len() > LONG),
                );
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
