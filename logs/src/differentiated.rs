//! Velocities of a log that has none.
//!
//! ```text
//! dq_k = slope of the line through q at the rows within 10 ms of row k, two rows each way at least, by least squares
//! ```
//!
//! On regular stamps it is late by nothing; it leaves 99.5 % of an amplitude at 10 Hz. At the ends of a burst the line leans on the
//! rows that there are; a gap is not crossed. Encoder noise of 10 µrad becomes 0.4 mrad/s at 1 kHz.

use tribo_files::LogError;

use crate::bursts::{GAP_TOLERANCE, bursts, median_period_s};
use crate::log::LogColumns;
use crate::quantity::Quantity;

/// Half a window (s), and in rows at least and at most.
const HALF_S: f64 = 0.01;
const HALF_ROWS: [usize; 2] = [2, 50];

/// Whether the positions are there and no velocity is.
pub(crate) fn lacks_velocity(quantities: &[Quantity]) -> bool {
    !quantities.contains(&Quantity::Velocity)
}

impl LogColumns {
    /// Works out `dq_rad_s` from the positions: slopes by least squares over 10 ms each way, never across a gap.
    ///
    /// # Errors
    /// Positions and stamps that are not of one length.
    pub fn differentiate(&mut self) -> Result<(), LogError> {
        let rows = self.rows();
        if let Some((joint, q)) = self.q_rad.iter().enumerate().find(|(_, q)| q.len() != rows) {
            let column = Quantity::Position.column_name(joint);
            return Err(LogError::ColumnLength { column, got: q.len(), expected: rows });
        }
        differentiate(self);
        Ok(())
    }
}

/// Fills in the velocities; what to say about it.
pub(crate) fn differentiate(log: &mut LogColumns) -> String {
    let half = median_period_s(&log.time_s)
        .filter(|period| *period > 0.0)
        .map_or(HALF_ROWS[0], |period| ((HALF_S / period).round() as usize).clamp(HALF_ROWS[0], HALF_ROWS[1]));
    // Rows sent twice leave holes of two periods.
    let bursts = bursts(&log.time_s, 2.0 * GAP_TOLERANCE);
    let slope = |q: &[f64], k: usize, start: usize, end: usize| -> f64 {
        let rows = k.saturating_sub(half).max(start)..(k + half + 1).min(end);
        let count = rows.len() as f64;
        let (t0, q0) = (log.time_s[k], q[k]);
        let mean = |x: &dyn Fn(usize) -> f64| rows.clone().map(x).sum::<f64>() / count;
        let (mean_t, mean_q) = (mean(&|i| log.time_s[i] - t0), mean(&|i| q[i] - q0));
        let cross = mean(&|i| (log.time_s[i] - t0 - mean_t) * (q[i] - q0 - mean_q));
        let square = mean(&|i| (log.time_s[i] - t0 - mean_t).powi(2));
        let slope = cross / square;
        if slope.is_finite() { slope } else { 0.0 }
    };
    let of = |q: &Vec<f64>| -> Vec<f64> {
        let rows = bursts.iter().flat_map(|burst| burst.clone().map(|k| (k, burst.start, burst.end)));
        rows.map(|(k, start, end)| slope(q, k, start, end)).collect()
    };
    log.dq_rad_s = log.q_rad.iter().map(of).collect();
    format!("no dq_i: worked out from q_i, slopes over {} rows", 2 * half + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine has a known derivative, and a gap is none of its motion.
    #[test]
    fn slopes_are_the_derivative_and_stop_at_gaps() {
        let mut time_s: Vec<f64> = (0..1000).map(|k| f64::from(k) * 2e-3).collect();
        time_s.extend((0..1000).map(|k| 5.0 + f64::from(k) * 2e-3));
        let q = time_s.iter().map(|t| (3.0 * t).sin() + if *t > 4.0 { 100.0 } else { 0.0 }).collect::<Vec<f64>>();
        let mut log = LogColumns { time_s: time_s.clone(), q_rad: vec![q], ..LogColumns::default() };
        assert!(differentiate(&mut log).ends_with("over 11 rows"));
        for (k, t) in time_s.iter().enumerate() {
            // At an end the line is late by half its length: 10 ms/2 × 9 rad/s².
            let edge = k % 1000 < 5 || k % 1000 >= 995;
            let error = (log.dq_rad_s[0][k] - 3.0 * (3.0 * t).cos()).abs();
            assert!(error < if edge { 0.05 } else { 1e-3 }, "{k}: {error}");
        }
    }
}
