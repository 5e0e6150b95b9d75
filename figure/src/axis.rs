//! One axis of a plot: range, ticks at round numbers, and where a value lies.

use crate::number::fixed;

/// Values that span more than this factor, all positive, get a logarithmic axis: on a linear one, all that is common of a
/// campaign with failed trials, whose penalty is 1000, would lie on the floor.
pub(crate) const LOGARITHMIC_SPAN: f64 = 200.0;
/// At most this many decades are shown; what is smaller lies on the edge of the plot.
const MOST_DECADES: f64 = 8.0;

/// `position(v) = (f(v) − f(low)) / (f(high) − f(low))` with f the identity or log10.
///
/// Made for data of any kind: none, one value, constants, infinities.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    low: f64,
    high: f64,
    logarithmic: bool,
    step: f64,
}

impl Axis {
    /// An axis that holds all finite `values` and about `ticks` ticks; `margin` is the free part at either end.
    pub fn of(values: impl Iterator<Item = f64>, ticks: usize, margin: f64, may_be_logarithmic: bool) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| value.is_finite()) {
            low = low.min(value);
            high = high.max(value);
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        if may_be_logarithmic && low > 0.0 && high / low > LOGARITHMIC_SPAN {
            let (low, high) = (low.log10().max(high.log10() - MOST_DECADES), high.log10());
            let free = margin * (high - low);
            let step = ((high - low) / ticks.max(2) as f64).ceil().max(1.0);
            return Self { low: low - free, high: high + free, logarithmic: true, step };
        }
        // A constant gets room on both sides; beyond 1e300 a difference may overflow, so it is clipped there.
        (low, high) = (low.clamp(-1e300, 1e300), high.clamp(-1e300, 1e300));
        if high - low <= 1e-12 * low.abs().max(high.abs()) {
            let room = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
            (low, high) = (low - room, high + room);
        }
        let free = margin * (high - low);
        (low, high) = (low - free, high + free);
        Self { low, high, logarithmic: false, step: round_step((high - low) / ticks.max(2) as f64) }
    }

    /// Makes the axis begin at zero, for bars.
    pub fn from_zero(high: f64, ticks: usize) -> Self {
        let high = if high.is_finite() && high > 0.0 { high } else { 1.0 };
        Self { low: 0.0, high: 1.04 * high, logarithmic: false, step: round_step(high / ticks.max(2) as f64) }
    }

    /// Length of a linear axis.
    pub fn span(&self) -> f64 {
        self.high - self.low
    }

    /// A linear axis of length `span` around the same middle, with about `ticks` ticks.
    pub fn widened(&self, span: f64, ticks: usize) -> Self {
        let middle = 0.5 * (self.low + self.high);
        let (low, high) = (middle - 0.5 * span, middle + 0.5 * span);
        Self { low, high, logarithmic: false, step: round_step(span / ticks.max(2) as f64) }
    }

    /// Where a finite value lies: 0 at the low end, 1 at the high end; clamped to them.
    pub fn position(&self, value: f64) -> f64 {
        let value = match (self.logarithmic, value > 0.0) {
            (true, true) => value.log10(),
            (true, false) => self.low,
            (false, _) => value,
        };
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// Whether zero lies strictly inside.
    pub fn holds_zero(&self) -> bool {
        !self.logarithmic && self.low < 0.0 && self.high > 0.0
    }

    /// Ticks with their labels, ascending.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let (first, last) = ((self.low / self.step).ceil(), (self.high / self.step).floor());
        // A range of full double width has no countable ticks; two steps of slack are enough for rounding.
        if !(last >= first && last - first < 50.0) {
            return Vec::new();
        }
        let count = (last - first) as usize;
        (0..=count).map(|k| (first + k as f64) * self.step).map(|at| self.tick(at)).collect()
    }

    fn tick(&self, at: f64) -> (f64, String) {
        if self.logarithmic {
            let label = match at as i32 {
                decade if self.low >= -2.2 && self.high <= 4.2 => fixed(10f64.powi(decade), -decade),
                decade => format!("10{}", superscript(decade)),
            };
            return (10f64.powf(at), label);
        }
        let largest = self.low.abs().max(self.high.abs());
        if !(1e-4..1e6).contains(&largest) {
            let digits = (largest.log10().floor() - self.step.log10().floor()).clamp(0.0, 6.0) as usize;
            let label = if at == 0.0 { "0".to_owned() } else { format!("{at:.digits$e}").replace('-', "−") };
            return (at, label);
        }
        (at, fixed(at, -(self.step.log10() + 1e-9).floor() as i32))
    }
}

/// `⁻³`.
fn superscript(number: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |digit: char| digit.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    number.to_string().chars().map(raised).collect()
}

/// The smallest of 1, 2, 5 × 10ⁿ that is at least `rough`.
fn round_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    let mantissa = rough / power;
    let round = [1.0, 2.0, 5.0].into_iter().find(|round| mantissa <= round * 1.000_001).unwrap_or(10.0);
    round * power
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(values: &[f64]) -> Vec<String> {
        Axis::of(values.iter().copied(), 5, 0.0, true).ticks().into_iter().map(|tick| tick.1).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(&[-1.03, 1.1]), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(&[0.0, 33.0]), ["0", "10", "20", "30"]);
        assert_eq!(labels(&[1e-4, 20.0]), ["10⁻⁴", "10⁻²", "10⁰"]);
        assert_eq!(labels(&[-2e-6, 2.1e-6]), ["−2e−6", "−1e−6", "0", "1e−6", "2e−6"]);
    }

    #[test]
    fn degenerate_data_have_an_axis_too() {
        let cases: [&[f64]; 7] = [
            &[],
            &[3.0],
            &[0.0, 0.0],
            &[f64::NAN, f64::INFINITY],
            &[-5.0, -5.0],
            &[f64::MIN, f64::MAX],
            &[f64::MIN_POSITIVE, 1.0],
        ];
        for values in cases {
            for logarithmic in [false, true] {
                let axis = Axis::of(values.iter().copied(), 6, 0.05, logarithmic);
                assert!(axis.ticks().len() < 50 && !axis.ticks().is_empty(), "{values:?}: {axis:?}");
                for value in values.iter().filter(|value| value.is_finite()) {
                    assert!((0.0..=1.0).contains(&axis.position(*value)), "{values:?}: {axis:?}");
                }
            }
        }
    }
}
