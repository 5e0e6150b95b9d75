//! What a figure is made of.

use crate::Ink;

/// One axis: quantity, unit and, where it matters, frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scale {
    /// `force [N], base axes`.
    pub label: String,
    /// Names at 0, 1, 2 … in place of numbers.
    pub categories: Vec<String>,
    /// Whether a logarithm is taken when all values are positive and span more than two decades.
    pub may_be_logarithmic: bool,
    /// Values the axis holds whatever the data are.
    pub holds: Vec<f64>,
    /// Whether only whole numbers mean something: trials.
    pub whole: bool,
}

impl Scale {
    /// A scale that fits its data.
    pub fn of(label: &str) -> Self {
        Self { label: label.to_owned(), ..Self::default() }
    }

    /// Names in place of numbers.
    pub fn categories(label: &str, names: Vec<String>) -> Self {
        let last = names.len() as f64 - 0.5;
        Self { label: label.to_owned(), categories: names, holds: vec![-0.5, last], ..Self::default() }
    }

    /// The same, logarithmic where the data ask for it.
    pub fn or_logarithmic(self) -> Self {
        Self { may_be_logarithmic: true, ..self }
    }

    /// Whole numbers.
    pub fn whole(label: &str) -> Self {
        Self { whole: true, ..Self::of(label) }
    }

    /// The same, with `value` in sight.
    pub fn holding(mut self, value: f64) -> Self {
        self.holds.push(value);
        self
    }
}

/// Shape of a single mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symbol {
    /// A dot.
    Dot,
    /// A cross: something that failed.
    Cross,
    /// A diamond: the best.
    Diamond,
}

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A curve through (x, y); a value that is not finite interrupts it.
    Line {
        /// Abscissae.
        x: Vec<f64>,
        /// Ordinates.
        y: Vec<f64>,
        /// Whether it is dashed.
        dashed: bool,
    },
    /// Many small dots.
    Cloud {
        /// Abscissae.
        x: Vec<f64>,
        /// Ordinates.
        y: Vec<f64>,
    },
    /// Single marks, each with a note that is shown when it is pointed at.
    Symbols {
        /// Abscissae.
        x: Vec<f64>,
        /// Ordinates.
        y: Vec<f64>,
        /// Shape.
        symbol: Symbol,
        /// Notes, one per mark, or none at all.
        notes: Vec<String>,
    },
    /// The area between two curves: a confidence band.
    Band {
        /// Abscissae.
        x: Vec<f64>,
        /// Lower ends.
        low: Vec<f64>,
        /// Upper ends.
        high: Vec<f64>,
    },
    /// Upright bars from `base` to `base + height`.
    Bars {
        /// Middles.
        x: Vec<f64>,
        /// Feet.
        base: Vec<f64>,
        /// Heights.
        height: Vec<f64>,
        /// Width, in units of x.
        width: f64,
    },
    /// A horizontal line across the figure.
    Level {
        /// Its ordinate.
        y: f64,
    },
}

/// A mark with its name and colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Name in the legend; layers of one name share an entry, and an empty name has none.
    pub name: String,
    /// Colour.
    pub ink: Ink,
    /// What is drawn.
    pub mark: Mark,
}

impl Layer {
    /// A solid curve.
    pub fn line(name: &str, ink: Ink, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { name: name.to_owned(), ink, mark: Mark::Line { x, y, dashed: false } }
    }

    /// A dashed curve.
    pub fn dashed(name: &str, ink: Ink, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { name: name.to_owned(), ink, mark: Mark::Line { x, y, dashed: true } }
    }

    /// A cloud of dots.
    pub fn cloud(name: &str, ink: Ink, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { name: name.to_owned(), ink, mark: Mark::Cloud { x, y } }
    }

    /// Single marks.
    pub fn symbols(name: &str, ink: Ink, symbol: Symbol, x: Vec<f64>, y: Vec<f64>, notes: Vec<String>) -> Self {
        Self { name: name.to_owned(), ink, mark: Mark::Symbols { x, y, symbol, notes } }
    }

    /// A band.
    pub fn band(name: &str, ink: Ink, x: Vec<f64>, low: Vec<f64>, high: Vec<f64>) -> Self {
        Self { name: name.to_owned(), ink, mark: Mark::Band { x, low, high } }
    }

    /// Bars on a common foot of zero.
    pub fn bars(name: &str, ink: Ink, x: Vec<f64>, height: Vec<f64>, width: f64) -> Self {
        let base = vec![0.0; x.len()];
        Self { name: name.to_owned(), ink, mark: Mark::Bars { x, base, height, width } }
    }

    /// A horizontal line.
    pub fn level(name: &str, ink: Ink, y: f64) -> Self {
        Self { name: name.to_owned(), ink, mark: Mark::Level { y } }
    }

    /// All points the axes must hold, as (x, y); a level has no abscissa.
    pub fn points(&self) -> Vec<(Option<f64>, f64)> {
        let pairs = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (Some(*x), *y)).collect::<Vec<_>>();
        match &self.mark {
            Mark::Line { x, y, .. } | Mark::Cloud { x, y } | Mark::Symbols { x, y, .. } => pairs(x, y),
            Mark::Band { x, low, high } => [pairs(x, low), pairs(x, high)].concat(),
            Mark::Bars { x, base, height, width } => {
                let top: Vec<f64> = base.iter().zip(height).map(|(base, height)| base + height).collect();
                let edge = |sign: f64| x.iter().map(|x| x + sign * 0.5 * width).collect::<Vec<f64>>();
                [pairs(&edge(-1.0), base), pairs(&edge(1.0), &top)].concat()
            }
            Mark::Level { y } => vec![(None, *y)],
        }
    }
}

/// A figure. Layers are drawn in order, the first at the bottom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// What it shows.
    pub title: String,
    /// Abscissa.
    pub x: Scale,
    /// Ordinate.
    pub y: Scale,
    /// What is drawn.
    pub layers: Vec<Layer>,
    /// Whether one unit is as long on both axes: a drawing of something in space.
    pub to_scale: bool,
}

impl Figure {
    /// An empty figure.
    pub fn new(title: impl Into<String>, x: Scale, y: Scale) -> Self {
        Self { title: title.into(), x, y, layers: Vec::new(), to_scale: false }
    }

    /// The same with units of one length on both axes.
    pub fn to_scale(self) -> Self {
        Self { to_scale: true, ..self }
    }

    /// The same with one more layer on top.
    pub fn with(mut self, layer: Layer) -> Self {
        self.layers.push(layer);
        self
    }

    /// Whether there is a finite point to draw.
    pub fn has_data(&self) -> bool {
        let finite = |point: &(Option<f64>, f64)| point.0.is_some_and(f64::is_finite) && point.1.is_finite();
        self.layers.iter().any(|layer| layer.points().iter().any(finite))
    }

    /// Whether the ordinate is to be drawn logarithmically.
    pub fn is_logarithmic(&self) -> bool {
        if !self.y.may_be_logarithmic {
            return false;
        }
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let values = self.layers.iter().flat_map(Layer::points).map(|point| point.1);
        for value in values.chain(self.y.holds.iter().copied()).filter(|value| value.is_finite()) {
            (low, high) = (low.min(value), high.max(value));
        }
        low > 0.0 && high / low > crate::axis::LOGARITHMIC_SPAN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stacked_bars_reach_their_sum() {
        let mark = Mark::Bars { x: vec![1.0], base: vec![2.0], height: vec![3.0], width: 0.5 };
        let points = Layer { name: String::new(), ink: 0, mark }.points();
        assert_eq!(points, [(Some(0.75), 2.0), (Some(1.25), 5.0)]);
    }

    #[test]
    fn only_wide_positive_ranges_are_logarithmic() {
        let figure = |y: Vec<f64>| {
            let x = (0..y.len()).map(|k| k as f64).collect();
            Figure::new("", Scale::of("x"), Scale::of("y").or_logarithmic()).with(Layer::line("", 0, x, y))
        };
        assert!(figure(vec![1.0, 300.0]).is_logarithmic());
        assert!(!figure(vec![1.0, 150.0]).is_logarithmic() && !figure(vec![0.0, 2000.0]).is_logarithmic());
        assert!(!figure(vec![]).is_logarithmic() && !figure(vec![f64::NAN]).has_data());
    }
}
