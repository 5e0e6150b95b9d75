//! A signal that comes late.

use nalgebra::SVector;

/// `y_k = (1 − u) x_{k−n} + u x_{k−n−1}`, n + u = delay/dt: linear between samples. Before the first sample it shows that one.
///
/// The buffer has its size from construction on.
#[derive(Clone, Debug)]
pub(crate) struct DelayLine<const N: usize> {
    samples: Vec<SVector<f64, N>>,
    newest: usize,
    share: f64,
    filled: bool,
}

impl<const N: usize> DelayLine<N> {
    /// Late by `delay_s` (s) at a period of `dt_s` (s). A plant cannot know the future: negative delays are none.
    pub fn new(delay_s: f64, dt_s: f64) -> Self {
        let periods = (delay_s / dt_s).max(0.0);
        let samples = vec![SVector::zeros(); periods.floor() as usize + 2];
        Self { samples, newest: 0, share: periods.fract(), filled: false }
    }

    /// Takes the newest sample and returns the late one.
    pub fn push(&mut self, sample: SVector<f64, N>) -> SVector<f64, N> {
        if !self.filled {
            self.samples.fill(sample);
            self.filled = true;
        }
        self.newest = (self.newest + 1) % self.samples.len();
        self.samples[self.newest] = sample;
        // In a ring of n + 2 the oldest follows the newest, and n steps back is one after that.
        let oldest = self.samples[(self.newest + 1) % self.samples.len()];
        let late = self.samples[(self.newest + 2) % self.samples.len()];
        late + (oldest - late) * self.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: a ramp comes out as the ramp of the delayed time, whole periods or not.
    #[test]
    fn a_ramp_comes_late_by_the_delay() {
        for delay in [0.0, 0.4, 1.0, 2.75, 6.0] {
            let mut line = DelayLine::<1>::new(delay * 1e-3, 1e-3);
            for k in 0..30 {
                let y = line.push(SVector::from([k as f64]))[0];
                assert!((y - (k as f64 - delay).max(0.0)).abs() < 1e-9 || (k as f64) < delay + 1.0, "{delay} {k} {y}");
            }
        }
        assert_eq!(DelayLine::<1>::new(0.01, 1e-3).push(SVector::from([7.0]))[0], 7.0);
        assert_eq!(DelayLine::<1>::new(-0.01, 1e-3).push(SVector::from([7.0]))[0], 7.0);
    }
}
