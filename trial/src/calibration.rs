//! What a stretch without contact tells an estimator.

use crate::LogWrench;

/// Tare and noise of one estimator on one robot, from a stretch in which nobody touched it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Wrench that was reported although there was none, force then moment [N, Nm]: a payload that nobody entered, mostly.
    pub tare: [f64; 6],
    /// Factor on the stated noise with which the 95 % intervals hold what was reported, all axes together.
    pub noise_factor: f64,
    /// Further factor on the interval of each axis, half way to that with which it does so on its own; force then moment.
    pub axis_factor: [f64; 6],
}

/// Nobody's calibration.
impl Default for Calibration {
    fn default() -> Self {
        Self { tare: [0.0; 6], noise_factor: 1.0, axis_factor: [1.0; 6] }
    }
}

/// Smallest and largest noise factor.
const FACTORS: [f64; 2] = [0.02, 20.0];
/// Bisections: the factor is right to 3 %.
const BISECTIONS: usize = 8;
/// Share of samples and axes that the interval is to hold.
const COVERAGE: f64 = 0.95;
/// Time between two samples that know nothing of each other (s).
const INDEPENDENT_EVERY_S: f64 = 0.5;

impl Calibration {
    /// The calibration of an estimator that `run` takes over the contact-free stretch with a given noise factor.
    ///
    /// The tare is the mean wrench. The noise factor is that of the narrowest 95 % intervals which hold 95 % of what is left, and
    /// moves only what is noise in them: the doubt about friction at rest stays. What one factor leaves uneven between the
    /// axes is a quantile of error over half-width as of a split-conformal interval, 0.95 (1 + 1/n) for n samples that know
    /// nothing of each other. Friction forgets in half a second, so n is twice the seconds of the stretch. One motion does not
    /// load the axes as the next one does, and a standstill not at all as a motion: axis by axis, the factor is the geometric
    /// mean of the quantile and of 1, what all axes share.
    ///
    /// The arm must move in it: what a standing joint shows is one value of its stiction.
    ///
    /// # Errors
    /// Those of `run`.
    pub fn of_free_stretch<E>(run: impl Fn(f64) -> Result<LogWrench, E>) -> Result<Self, E> {
        let tare = run(1.0)?.mean();
        let tared = |factor: f64| {
            let mut log = run(factor)?;
            log.tare(&tare);
            Ok::<LogWrench, E>(log)
        };
        let done = |noise_factor: f64, log: &LogWrench| {
            let share = (COVERAGE * (1.0 + INDEPENDENT_EVERY_S / log.duration_s())).min(1.0);
            let own = log.half_widths_from_zero(share).map(|factor| factor.clamp(FACTORS[0], FACTORS[1]));
            let axis_factor = own.map(f64::sqrt);
            Self { tare, noise_factor, axis_factor }
        };
        let holds = |log: &LogWrench| log.share_inside(&[0.0; 6]) >= COVERAGE;
        let [mut low, mut high] = FACTORS.map(f64::ln);
        let narrowest = tared(low.exp())?;
        if holds(&narrowest) {
            return Ok(done(low.exp(), &narrowest));
        }
        let mut held = None;
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            let log = tared(middle.exp())?;
            if holds(&log) {
                (high, held) = (middle, Some(log));
            } else {
                low = middle;
            }
        }
        let log = held.map_or_else(|| tared(high.exp()), Ok)?;
        Ok(done(high.exp(), &log))
    }

    /// Takes the tare off a wrench and widens its intervals.
    pub fn apply(&self, log: &mut LogWrench) {
        log.tare(&self.tare);
        log.widen(&self.axis_factor);
    }
}
