//! From times to an answer.

use serde::Serialize;
use tribo_runtime::{LatencyHistogram, Refusal};

/// Shares of a histogram (µs).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Percentiles {
    /// Mean.
    pub mean: f64,
    /// Median.
    pub p50: f64,
    /// 99 of 100 are no longer.
    pub p99: f64,
    /// 999 of 1000 are no longer.
    pub p999: f64,
    /// The longest.
    pub max: f64,
}

impl From<&LatencyHistogram> for Percentiles {
    fn from(histogram: &LatencyHistogram) -> Self {
        let at = |p| histogram.quantile_us(p);
        Self { mean: histogram.mean_us(), p50: at(0.5), p99: at(0.99), p999: at(0.999), max: histogram.max_us() }
    }
}

/// What the operating system granted the measuring thread, or why not.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rights {
    /// The core it was kept on.
    pub pinned_core: Option<usize>,
    /// Whether it had `SCHED_FIFO`; not asked for without `--realtime`.
    pub fifo: bool,
    /// Whether memory was locked.
    pub memory_locked: bool,
    /// What was refused, in the system's words.
    pub refused: Vec<String>,
}

impl Rights {
    /// Nothing asked for yet.
    pub fn none() -> Self {
        Self { pinned_core: None, fifo: false, memory_locked: false, refused: Vec::new() }
    }

    /// Whether `answer` grants; if not, its reason is kept under this name.
    pub fn granted(&mut self, name: &str, answer: Result<(), Refusal>) -> bool {
        if let Err(reason) = &answer {
            self.refused.push(format!("{name}: {reason}"));
        }
        answer.is_ok()
    }

    /// Keeps the calling thread on the last core that it may use: the first is where most interrupts go.
    pub fn pin(&mut self) {
        let answer = match tribo_runtime::allowed_cores().last() {
            Some(core) => tribo_runtime::run_on_cores(&[*core]).map(|()| self.pinned_core = Some(*core)),
            None => Err("the system does not say which cores there are".to_owned()),
        };
        self.granted("core", answer);
    }
}

/// The answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Fitness {
    /// Nothing comes near the period.
    #[serde(rename = "fit with reserve")]
    FitWithReserve,
    /// It fits in.
    #[serde(rename = "fit for 1 kHz")]
    Fit,
    /// It does not.
    #[serde(rename = "not fit")]
    NotFit,
}

impl std::fmt::Display for Fitness {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::FitWithReserve => "fit with reserve",
            Self::Fit => "fit for 1 kHz",
            Self::NotFit => "not fit",
        })
    }
}

/// The answer with what it rests on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// The answer.
    pub answer: Fitness,
    /// Quantity, percentile, figure and limit.
    pub because: String,
}

/// Share of the period that the 99.9th percentile of a tick may take: sensors, bus and drive need the rest.
const FIT: f64 = 0.5;
/// The same with reserve: other estimators, a slower day, a smaller computer.
const RESERVE: f64 = 0.05;
/// Share of the period that the 99.9th percentile of the response may take with reserve.
const RESPONSE_RESERVE: f64 = 0.1;

impl Verdict {
    /// Of ticks that ran as fast as they could: speed alone, since waking up in time was not asked for.
    ///
    /// With reserve, no single tick is longer than a period; without, one in a thousand may be, and is told.
    pub fn of_ticks(tick: &LatencyHistogram, period_us: f64) -> Self {
        let p999 = tick.quantile_us(0.999);
        let over = tick.count_from(period_us);
        let answer = match p999 {
            p if p <= RESERVE * period_us && over == 0 => Fitness::FitWithReserve,
            p if p <= FIT * period_us => Fitness::Fit,
            _ => Fitness::NotFit,
        };
        let limit = if p999 <= RESERVE * period_us { RESERVE } else { FIT } * period_us;
        let tail = match over {
            0 => String::new(),
            n => {
                format!("; {n} of {} ticks were longer than the period, which the loop would have missed", tick.count())
            }
        };
        Self { answer, because: format!("99.9 % of ticks take {p999:.1} us or less, limit {limit:.0} us{tail}") }
    }

    /// Of a loop on the clock: a missed deadline is not fit.
    pub fn of_response(response: &LatencyHistogram, missed: u64, period_us: f64) -> Self {
        let (p999, limit) = (response.quantile_us(0.999), RESPONSE_RESERVE * period_us);
        let answer = match missed {
            0 if p999 <= limit => Fitness::FitWithReserve,
            0 => Fitness::Fit,
            _ => Fitness::NotFit,
        };
        let because = format!(
            "{missed} deadlines missed, limit 0; 99.9 % of commands are ready {p999:.1} us into the period, {limit:.0} us with reserve"
        );
        Self { answer, because }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(usual_us: u64, rare: u64, rare_us: u64) -> LatencyHistogram {
        let mut histogram = LatencyHistogram::new().expect("valid bounds");
        (0..10_000 - rare).for_each(|_| histogram.record(usual_us * 1000));
        (0..rare).for_each(|_| histogram.record(rare_us * 1000));
        histogram
    }

    #[test]
    fn speed_is_judged_by_one_tick_in_a_thousand() {
        let answer = |histogram| Verdict::of_ticks(&histogram, 1000.0).answer;
        assert_eq!(answer(ticks(8, 5, 300)), Fitness::FitWithReserve);
        assert_eq!(answer(ticks(8, 5, 3000)), Fitness::Fit, "a tick longer than the period is no reserve");
        assert_eq!(answer(ticks(8, 20, 300)), Fitness::Fit);
        assert_eq!(answer(ticks(8, 20, 600)), Fitness::NotFit);
        assert_eq!(answer(ticks(600, 0, 0)), Fitness::NotFit);
        let told = Verdict::of_ticks(&ticks(8, 5, 3000), 1000.0).because;
        assert!(told.contains("5 of 10000 ticks were longer"), "{told}");
    }

    #[test]
    fn on_the_clock_one_missed_deadline_is_not_fit() {
        let answer = |histogram, missed| Verdict::of_response(&histogram, missed, 1000.0).answer;
        assert_eq!(answer(ticks(60, 0, 0), 0), Fitness::FitWithReserve);
        assert_eq!(answer(ticks(60, 20, 700), 0), Fitness::Fit);
        assert_eq!(answer(ticks(60, 1, 1100), 1), Fitness::NotFit);
    }
}
