//! What a stretch without contact tells an estimator.

use crate::LogWrench;

/// Tare and noise of one estimator on one robot, from a stretch in which nobody touched it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Wrench that was reported although there was none, force then moment [N, Nm]: a payload that nobody entered, mostly.
    pub tare: [f64; 6],
    /// Factor on the stated noise with which the 95 % interval holds what was reported.
    pub noise_factor: f64,
}

/// Nobody's calibration.
impl Default for Calibration {
    fn default() -> Self {
        Self { tare: [0.0; 6], noise_factor: 1.0 }
    }
}

/// Smallest and largest noise factor.
const FACTORS: [f64; 2] = [0.02, 20.0];
/// Bisections: the factor is right to 3 %.
const BISECTIONS: usize = 8;
/// Share of samples and axes that the interval is to hold.
const COVERAGE: f64 = 0.95;

impl Calibration {
    /// The calibration of an estimator that `run` takes over the contact-free stretch with a given noise factor: the tare is
    /// the mean wrench, the noise that of the narrowest 95 % intervals which hold 95 % of what is left.
    ///
    /// The arm must move in it: what a standing joint shows is one value of its stiction.
    ///
    /// # Errors
    /// Those of `run`.
    pub fn of_free_stretch<E>(run: impl Fn(f64) -> Result<LogWrench, E>) -> Result<Self, E> {
        let tare = run(1.0)?.mean();
        let holds = |factor: f64| {
            let mut log = run(factor)?;
            log.tare(&tare);
            Ok::<bool, E>(log.share_inside(&[0.0; 6]) >= COVERAGE)
        };
        let [mut low, mut high] = FACTORS.map(f64::ln);
        if holds(low.exp())? {
            return Ok(Self { tare, noise_factor: low.exp() });
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if holds(middle.exp())? {
                high = middle;
            } else {
                low = middle;
            }
        }
        Ok(Self { tare, noise_factor: high.exp() })
    }
}
