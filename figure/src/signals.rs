//! Long recordings, ready to be looked at.

use std::ops::Range;

use crate::MinMaxPyramid;

/// One channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Name: `q_0`.
    pub name: String,
    /// Quantity with unit: `position [rad]`. Channels of one quantity share a plot.
    pub quantity: String,
    samples: Vec<f32>,
    pyramid: MinMaxPyramid,
}

impl Signal {
    /// A channel; NaN is a gap.
    pub fn new(name: impl Into<String>, quantity: impl Into<String>, samples: Vec<f32>) -> Self {
        let pyramid = MinMaxPyramid::new(&samples);
        Self { name: name.into(), quantity: quantity.into(), samples, pyramid }
    }

    /// The samples.
    pub fn samples(&self) -> &[f32] {
        &self.samples
    }
}

/// Channels on one time axis, in single precision: a screen shows no more, and an hour of sixty channels fits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signals {
    time_s: Vec<f64>,
    channels: Vec<Signal>,
}

/// Which samples fall on which pixel; the same for all channels, so it is found once per frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    rows: Range<usize>,
    /// Middle (s) and rows of each pixel column; none where every sample is drawn.
    pixels: Option<Vec<(f64, Range<usize>)>>,
}

impl Signals {
    /// Channels on increasing time stamps (s); a channel that is shorter ends early.
    pub fn new(time_s: Vec<f64>, channels: Vec<Signal>) -> Self {
        Self { time_s, channels }
    }

    /// The channels.
    pub fn channels(&self) -> &[Signal] {
        &self.channels
    }

    /// The time stamps (s).
    pub fn time_s(&self) -> &[f64] {
        &self.time_s
    }

    /// First and last time stamp (s); nothing has the range 0 to 1.
    pub fn span_s(&self) -> [f64; 2] {
        match (self.time_s.first(), self.time_s.last()) {
            (Some(first), Some(last)) if last > first => [*first, *last],
            _ => [0.0, 1.0],
        }
    }

    /// The pixel columns of a plot that shows `[from_s, to_s]` in `width` pixels. Their edges lie on multiples of the
    /// column's width, so that a peak stays the same peak while it is dragged.
    pub fn columns(&self, [from_s, to_s]: [f64; 2], width: usize) -> Columns {
        let at = |time_s: f64| self.time_s.partition_point(|t| *t < time_s);
        // One sample more at either end: the curve leaves the frame.
        let rows = at(from_s).saturating_sub(1)..(at(to_s) + 1).min(self.time_s.len());
        let step = (to_s - from_s) / width.max(1) as f64;
        if rows.len() <= 2 * width || !(step > 0.0 && step.is_finite()) {
            return Columns { rows, pixels: None };
        }
        let first = (from_s / step).floor();
        let (mut from, mut guess) = (at(first * step), 0);
        let pixels = (0..=width)
            .map(|k| {
                // At a steady rate the next column is as long as this one.
                let to = self.row_from(guess, (first + (k + 1) as f64) * step).max(from);
                guess = to + (to - from);
                let column = ((first + k as f64 + 0.5) * step, from..to);
                from = to;
                column
            })
            .collect();
        Columns { rows, pixels: Some(pixels) }
    }

    /// The first row that is not before `time_s`, searched for outwards from a guess.
    fn row_from(&self, guess: usize, time_s: f64) -> usize {
        let (time, last) = (&self.time_s, self.time_s.len());
        let (mut low, mut step) = (guess.min(last), 1);
        let mut high = low;
        while low > 0 && time[low - 1] >= time_s {
            (high, low, step) = (low - 1, low.saturating_sub(step), 2 * step);
        }
        step = 1;
        while high < last && time[high] < time_s {
            (low, high, step) = (high + 1, (high + step).min(last), 2 * step);
        }
        low + time[low..high].partition_point(|t| *t < time_s)
    }

    /// The row whose time stamp is nearest to `time_s`; none without samples.
    pub fn row_at(&self, time_s: f64) -> Option<usize> {
        let after = self.time_s.partition_point(|t| *t < time_s);
        let nearer = |a: usize, b: usize| (self.time_s[a] - time_s).abs() < (self.time_s[b] - time_s).abs();
        match after {
            0 => (!self.time_s.is_empty()).then_some(0),
            after if after == self.time_s.len() || nearer(after - 1, after) => Some(after - 1),
            after => Some(after),
        }
    }

    /// Curve of a channel over these columns: every sample, or the least and the greatest of each column. NaN is a gap.
    pub fn curve(&self, channel: usize, columns: &Columns) -> Vec<[f64; 2]> {
        let Some(signal) = self.channels.get(channel) else { return Vec::new() };
        let Some(pixels) = &columns.pixels else {
            let rows = columns.rows.start..columns.rows.end.min(signal.samples.len()).max(columns.rows.start);
            return rows.map(|k| [self.time_s[k], f64::from(signal.samples[k])]).collect();
        };
        let mut curve = Vec::with_capacity(2 * pixels.len());
        let mut upwards = true;
        for (time_s, rows) in pixels {
            match signal.pyramid.extremes_about(&signal.samples, rows.start, rows.end) {
                Some([low, high]) => {
                    // Up in one column and down in the next: no line crosses a column twice.
                    let ends = if upwards { [low, high] } else { [high, low] };
                    curve.extend(ends.map(|value| [*time_s, f64::from(value)]));
                    upwards = !upwards;
                }
                None => curve.push([*time_s, f64::NAN]),
            }
        }
        curve
    }

    /// Middle (s), least and greatest value of each column, as a band without holes where the signal jumps from one column
    /// to the next; NaN is a gap. None where every sample is drawn.
    pub fn band(&self, channel: usize, columns: &Columns) -> Option<Vec<[f64; 3]>> {
        let (signal, pixels) = (self.channels.get(channel)?, columns.pixels.as_ref()?);
        let mut band: Vec<[f64; 3]> = Vec::with_capacity(pixels.len());
        for (time_s, rows) in pixels {
            let found = signal.pyramid.extremes_about(&signal.samples, rows.start, rows.end);
            let [mut low, mut high] = found.map_or([f64::NAN; 2], |ends| ends.map(f64::from));
            // Comparisons with a gap are false.
            if let Some([_, low_before, high_before]) = band.last() {
                if low > *high_before {
                    low = *high_before;
                } else if high < *low_before {
                    high = *low_before;
                }
            }
            band.push([*time_s, low, high]);
        }
        Some(band)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(rows: usize) -> Signals {
        let time_s: Vec<f64> = (0..rows).map(|k| k as f64 * 1e-3).collect();
        let mut samples: Vec<f32> = (0..rows).map(|k| (k as f32 * 1e-3).sin()).collect();
        samples[rows / 3] = 9.0;
        Signals::new(time_s, vec![Signal::new("q_0", "position [rad]", samples)])
    }

    /// A single sample among millions shows at every zoom, at its time to a pixel.
    #[test]
    fn no_peak_is_lost() {
        let signals = recording(1_000_000);
        for (range, width) in
            [([0.0, 1000.0], 300), ([0.0, 1000.0], 1900), ([300.0, 400.0], 640), ([333.3, 333.4], 640)]
        {
            let curve = signals.curve(0, &signals.columns(range, width));
            assert!(curve.len() <= 2 * (width + 1), "{}", curve.len());
            let peak = curve.iter().find(|point| point[1] == 9.0).expect("the peak");
            let pixel = (range[1] - range[0]) / width as f64;
            assert!((peak[0] - 333.333).abs() <= pixel.max(1e-3), "{peak:?}");
        }
    }

    /// The search from a guess is the search from nowhere, whatever the guess and the time stamps.
    #[test]
    fn a_guess_does_not_matter() {
        let time_s: Vec<f64> = (0..500).map(|k| f64::from(k) + if k % 90 < 40 { 0.0 } else { 37.5 }).collect();
        let mut time_s = time_s;
        time_s.sort_by(f64::total_cmp);
        let signals = Signals::new(time_s.clone(), Vec::new());
        for wanted in (-10..600).map(|k| 0.9 * f64::from(k)) {
            let plain = time_s.partition_point(|t| *t < wanted);
            for guess in [0, 1, plain.saturating_sub(1), plain, plain + 1, 250, 499, 500, 9000] {
                assert_eq!(signals.row_from(guess, wanted), plain, "{wanted} from {guess}");
            }
            let row = signals.row_at(wanted).expect("a row");
            assert!(time_s.iter().all(|t| (t - wanted).abs() >= (time_s[row] - wanted).abs()), "{wanted}");
        }
        assert_eq!(Signals::default().row_at(0.0), None);
    }

    /// A jump between two columns is drawn.
    #[test]
    fn a_band_has_no_holes() {
        let time_s: Vec<f64> = (0..100_000).map(|k| f64::from(k) * 1e-3).collect();
        let steps = (0..100_000).map(|k| if (k / 5000) % 2 == 0 { 0.0 } else { 10.0 }).collect();
        let signals = Signals::new(time_s, vec![Signal::new("x", "x", steps)]);
        let band = signals.band(0, &signals.columns([0.0, 100.0], 200)).expect("columns");
        let inside: Vec<&[f64; 3]> = band.iter().filter(|column| column[1].is_finite()).collect();
        assert!(inside.windows(2).all(|pair| pair[1][1] <= pair[0][2] && pair[0][1] <= pair[1][2]), "{inside:?}");
        assert!(signals.band(0, &signals.columns([0.0, 0.1], 200)).is_none());
    }

    #[test]
    fn few_samples_are_drawn_as_they_are() {
        let signals = recording(1000);
        let curve = signals.curve(0, &signals.columns([0.1, 0.2], 500));
        assert_eq!(curve.first().map(|point| point[0]), Some(0.099));
        assert_eq!(curve.len(), 102);
    }

    /// A pause in the recording is a gap in the curve, and a curve outside the recording is empty.
    #[test]
    fn pauses_are_gaps() {
        let time_s: Vec<f64> = (0..4000).map(|k| f64::from(k) * 1e-3 + if k < 2000 { 0.0 } else { 4.0 }).collect();
        let signals = Signals::new(time_s, vec![Signal::new("x", "x", vec![1.0; 4000])]);
        let curve = signals.curve(0, &signals.columns([0.0, 8.0], 100));
        assert!(curve.iter().any(|point| point[1].is_nan() && (2.1..5.9).contains(&point[0])));
        assert!(curve.iter().all(|point| point[1].is_nan() || !(2.1..5.9).contains(&point[0])));
        assert!(signals.curve(0, &signals.columns([50.0, 60.0], 100)).iter().all(|point| point[0] < 8.1));
        assert!(signals.curve(1, &signals.columns([0.0, 8.0], 100)).is_empty());
    }
}
