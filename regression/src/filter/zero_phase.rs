//! Zero-phase low-pass filter.

use std::f64::consts::PI;

/// One second-order section in transposed direct form II, a0 = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

/// A section with its memory of L signals, which the processor filters side by side.
#[derive(Clone, Copy)]
struct Running<const L: usize> {
    section: Section,
    s1: [f64; L],
    s2: [f64; L],
}

impl<const L: usize> Running<L> {
    /// Started as if `first` had stood for ever. Every section here has unit gain at rest.
    fn at(section: Section, first: [f64; L]) -> Self {
        let s2 = first.map(|first| (section.b[2] - section.a[1]) * first);
        let s1 = std::array::from_fn(|l| (section.b[1] - section.a[0]) * first[l] + s2[l]);
        Self { section, s1, s2 }
    }

    #[inline(always)]
    fn step(&mut self, input: [f64; L]) -> [f64; L] {
        let Section { b, a } = self.section;
        let mut output = [0.0; L];
        for l in 0..L {
            output[l] = b[0] * input[l] + self.s1[l];
            self.s1[l] = b[1] * input[l] - a[0] * output[l] + self.s2[l];
            self.s2[l] = b[2] * input[l] - a[1] * output[l];
        }
        output
    }
}

/// Filters x in place through two sections at a time: a recursion waits for itself, two of them share the wait.
fn run<const L: usize>(sections: &[Section], x: &mut [[f64; L]], way: Way) {
    let first = if way == Way::Forward { x.first() } else { x.last() };
    let Some(&first) = first else { return };
    match sections {
        [] => {}
        [one] => {
            let mut one = Running::at(*one, first);
            each(x, way, |value| *value = one.step(*value));
        }
        [one, two, rest @ ..] => {
            let mut one = Running::at(*one, first);
            let start = { one }.step(first);
            let mut two = Running::at(*two, start);
            each(x, way, |value| *value = two.step(one.step(*value)));
            run(rest, x, way);
        }
    }
}

fn each<const L: usize>(x: &mut [[f64; L]], way: Way, step: impl FnMut(&mut [f64; L])) {
    match way {
        Way::Forward => x.iter_mut().for_each(step),
        Way::Backward => x.iter_mut().rev().for_each(step),
    }
}

/// Which way a pass goes through a signal.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    Forward,
    Backward,
}

/// Signals filtered side by side: a recursion waits for itself, eight of them hardly wait.
pub(crate) const LANES: usize = 8;
/// The same where few are left over.
const FEW_LANES: usize = 4;

/// Butterworth low-pass run forward and backward (gustafsson1996).
///
/// ```text
/// y = F⁻ F⁺ x,   gain(f) = |H(f)|² = 1 / (1 + (tan(πf/fs) / tan(πfc/fs))^2n),   phase(f) = 0
/// ```
///
/// n is the order of one pass and fc its −3 dB frequency, so both passes together are at −6 dB there: the gain is ½.
/// Ends: the signal is continued by its odd reflection 2x₀ − x_k over 3/fc, and each pass starts in the steady state of
/// its first value. Within about 1/fc of an end the output still depends on that guess: trim it.
/// Bilinear transform with prewarping, second-order sections. Leaves out: anything streaming.
#[derive(Clone, Debug, PartialEq)]
pub struct ZeroPhaseLowPass {
    sections: Vec<Section>,
    reflected: usize,
    order: i32,
    cutoff_hz: f64,
    rate_hz: f64,
}

/// Why a filter cannot be designed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// The cut-off lies outside what the sample rate carries.
    #[error("cut-off {cutoff_hz} Hz is outside (0, {}) Hz, half the sample rate", 0.5 * rate_hz)]
    Cutoff {
        /// Cut-off asked for (Hz).
        cutoff_hz: f64,
        /// Sample rate (Hz).
        rate_hz: f64,
    },
    /// The order is outside 1..=8.
    #[error("filter order {order} is outside 1..=8")]
    Order {
        /// Order asked for.
        order: usize,
    },
}

/// Length of the reflected continuation, in periods of the cut-off: a third-order pass has forgotten all but 1e-4.
const REFLECTED_PERIODS: f64 = 3.0;

impl ZeroPhaseLowPass {
    /// The filter of order `order` per pass with cut-off `cutoff_hz` for signals sampled at `rate_hz`.
    ///
    /// # Errors
    /// [`FilterError::Cutoff`] outside (0, rate/2), [`FilterError::Order`] outside 1..=8.
    pub fn butterworth(order: usize, cutoff_hz: f64, rate_hz: f64) -> Result<Self, FilterError> {
        if !(cutoff_hz > 0.0 && cutoff_hz < 0.5 * rate_hz && rate_hz.is_finite()) {
            return Err(FilterError::Cutoff { cutoff_hz, rate_hz });
        }
        if !(1..=8).contains(&order) {
            return Err(FilterError::Order { order });
        }
        let k = (PI * cutoff_hz / rate_hz).tan();

        // A pair of poles on the Butterworth circle: s² + 2 sin(θ) s + 1.
        let pair = |index: usize| {
            let damping = 2.0 * (PI * (2 * index + 1) as f64 / (2 * order) as f64).sin();
            let scale = 1.0 / (1.0 + damping * k + k * k);
            let b = k * k * scale;
            Section { b: [b, 2.0 * b, b], a: [2.0 * (k * k - 1.0) * scale, (1.0 - damping * k + k * k) * scale] }
        };
        let mut sections: Vec<Section> = (0..order / 2).map(pair).collect();

        // The real pole of an odd order: s + 1.
        if order % 2 == 1 {
            let b = k / (1.0 + k);
            sections.push(Section { b: [b, b, 0.0], a: [(k - 1.0) / (1.0 + k), 0.0] });
        }
        let reflected = (REFLECTED_PERIODS * rate_hz / cutoff_hz).ceil() as usize;
        Ok(Self { sections, reflected, order: order as i32, cutoff_hz, rate_hz })
    }

    /// The filtered signal, as long as x.
    pub fn filter(&self, x: &[f64]) -> Vec<f64> {
        self.filter_each([x], <[f64]>::to_vec).pop().unwrap_or_default()
    }

    /// The filtered signals, in order; all have one length. The same bits as one by one, in a fraction of the time.
    ///
    /// # Panics
    /// Where a signal is shorter than the first.
    pub fn filter_all<S: AsRef<[f64]>>(&self, signals: &[S]) -> Vec<Vec<f64>> {
        self.filter_each(signals, <[f64]>::to_vec)
    }

    /// What `keep` makes of each of the filtered signals. Signals are asked for one after the other and none is kept, so that
    /// no more than eight filtered ones are there at a time.
    ///
    /// # Panics
    /// Where a signal is shorter than the first.
    pub fn filter_each<S: AsRef<[f64]>, T>(
        &self,
        signals: impl IntoIterator<Item = S, IntoIter: ExactSizeIterator>,
        keep: impl Fn(&[f64]) -> T,
    ) -> Vec<T> {
        let mut signals = signals.into_iter();
        let mut kept = Vec::with_capacity(signals.len());
        loop {
            match signals.len() {
                0 => return kept,
                1 => self.filter_lanes::<1, S, T>(&mut signals, &keep, &mut kept),
                few if few <= FEW_LANES => self.filter_lanes::<FEW_LANES, S, T>(&mut signals, &keep, &mut kept),
                _ => self.filter_lanes::<LANES, S, T>(&mut signals, &keep, &mut kept),
            }
        }
    }

    /// The next L signals, or those that are left.
    fn filter_lanes<const L: usize, S: AsRef<[f64]>, T>(
        &self,
        signals: &mut impl Iterator<Item = S>,
        keep: &impl Fn(&[f64]) -> T,
        kept: &mut Vec<T>,
    ) {
        let mut y: Vec<[f64; L]> = Vec::new();
        let (mut n, mut reflected, mut used) = (0, 0, 0);
        for (l, x) in signals.take(L).enumerate() {
            let x = x.as_ref();
            if l == 0 {
                n = x.len();
                reflected = self.reflected.min(n.saturating_sub(1));
                y = vec![[0.0; L]; n + 2 * reflected];
            }
            let x = &x[..n];
            for k in 1..=reflected {
                y[reflected - k][l] = 2.0 * x[0] - x[k];
                y[reflected + n - 1 + k][l] = 2.0 * x[n - 1] - x[n - 1 - k];
            }
            y[reflected..reflected + n].iter_mut().zip(x).for_each(|(y, x)| y[l] = *x);
            used = l + 1;
        }
        run(&self.sections, &mut y, Way::Forward);
        run(&self.sections, &mut y, Way::Backward);
        let mut lane = Vec::with_capacity(n);
        for l in 0..used {
            lane.clear();
            lane.extend(y[reflected..reflected + n].iter().map(|y| y[l]));
            kept.push(keep(&lane));
        }
    }

    /// Gain of both passes together at `frequency_hz`, up to half the sample rate.
    pub fn gain(&self, frequency_hz: f64) -> f64 {
        let warped = |f: f64| (PI * f / self.rate_hz).tan();
        1.0 / (1.0 + (warped(frequency_hz) / warped(self.cutoff_hz)).powi(2 * self.order))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sinusoid(frequency_hz: f64, phase: f64) -> Vec<f64> {
        (0..4000).map(|k| (2.0 * PI * frequency_hz * f64::from(k) * 1e-3 + phase).sin()).collect()
    }

    /// Witness: the closed-form gain, which `filter` never evaluates; a phase shift of 0.1 mrad would show.
    #[test]
    fn sinusoid_keeps_its_phase_and_takes_the_known_gain() {
        for order in 1..=5 {
            let low_pass = ZeroPhaseLowPass::butterworth(order, 10.0, 1000.0).unwrap();
            for frequency_hz in [0.3, 2.0, 7.0, 10.0, 14.0] {
                let x = sinusoid(frequency_hz, 0.4);
                let y = low_pass.filter(&x);
                let gain = low_pass.gain(frequency_hz);
                let worst = (1000..3000).map(|k| (y[k] - gain * x[k]).abs()).fold(0.0, f64::max);
                assert!(worst < 1e-5, "order {order}, {frequency_hz} Hz: {worst:e}");
            }
            assert!((low_pass.gain(10.0) - 0.5).abs() < 1e-12);
        }
    }

    #[test]
    fn lines_pass_untouched_to_the_very_ends() {
        let low_pass = ZeroPhaseLowPass::butterworth(3, 10.0, 1000.0).unwrap();
        let line: Vec<f64> = (0..2000).map(|k| 2.0 - 0.01 * f64::from(k)).collect();
        let y = low_pass.filter(&line);
        let worst = line.iter().zip(&y).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-3, "{worst:e}"); // the forgotten 1e-4 of the slope over the delay of a pass
        assert_eq!(y.len(), line.len());
    }

    /// The same signal played backwards gives the same output backwards.
    #[test]
    fn time_has_no_direction() {
        let low_pass = ZeroPhaseLowPass::butterworth(3, 20.0, 1000.0).unwrap();
        let x: Vec<f64> = (0..3000).map(|k| f64::from((k * k) % 97) / 97.0 + (f64::from(k) * 0.003).sin()).collect();
        let forward = low_pass.filter(&x);
        let mut backward = low_pass.filter(&x.iter().rev().copied().collect::<Vec<_>>());
        backward.reverse();
        let worst = (200..2800).map(|k| (forward[k] - backward[k]).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-6, "{worst:e}");
    }

    /// Side by side is the same arithmetic: the same bits, whatever is left over.
    #[test]
    fn many_signals_are_filtered_as_one_by_one() {
        let low_pass = ZeroPhaseLowPass::butterworth(5, 20.0, 1000.0).unwrap();
        for count in 0..18u32 {
            let signals: Vec<Vec<f64>> =
                (0..count).map(|s| (0..400).map(|k| f64::from((k * k + 31 * s) % 97)).collect()).collect();
            let one_by_one: Vec<Vec<f64>> = signals.iter().map(|x| low_pass.filter(x)).collect();
            assert_eq!(low_pass.filter_all(&signals), one_by_one);
        }
    }

    #[test]
    fn short_signals_and_impossible_designs() {
        let low_pass = ZeroPhaseLowPass::butterworth(3, 10.0, 1000.0).unwrap();
        assert!(low_pass.filter(&[]).is_empty());
        assert_eq!(low_pass.filter(&[2.0]).len(), 1);
        assert!(low_pass.filter(&[2.0; 5]).iter().all(|y| (y - 2.0).abs() < 1e-12));
        for cutoff_hz in [0.0, -1.0, 500.0, f64::NAN] {
            assert!(matches!(
                ZeroPhaseLowPass::butterworth(3, cutoff_hz, 1000.0),
                Err(FilterError::Cutoff { rate_hz: 1000.0, .. })
            ));
        }
        assert_eq!(ZeroPhaseLowPass::butterworth(0, 10.0, 1000.0), Err(FilterError::Order { order: 0 }));
    }
}
