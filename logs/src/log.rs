//! A robot log in memory, by columns.
//!
//! ```text
//! t_0 < t_1 < … < t_{n-1},  t_{n-1} − t_0 finite,  n >= 2,  every cell finite,  every column n long,  N columns per joint quantity
//! ```
//!
//! [`LogColumns`] is the raw form with public fields; [`LogColumns::validate`] checks the law above and gives a
//! [`RobotLog`], which reads like the raw form and cannot be changed.

use std::ops::{Deref, Range};

use tribo_files::LogError;

use crate::quantity::Quantity;

/// The fewest rows that make a log: one period.
pub(crate) const MIN_ROWS: usize = 2;

/// Columns of a log that nobody checked yet. Outer index joint (or wrench component), inner index row.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LogColumns {
    /// Time stamps (s).
    pub time_s: Vec<f64>,
    /// Joint positions (rad).
    pub q_rad: Vec<Vec<f64>>,
    /// Joint velocities (rad/s).
    pub dq_rad_s: Vec<Vec<f64>>,
    /// Measured joint torques (Nm): of the motor side where `tau_link_nm` is there, else of the robot's one measurement.
    pub tau_j_nm: Vec<Vec<f64>>,
    /// Commanded joint torques (Nm).
    pub tau_j_d_nm: Option<Vec<Vec<f64>>>,
    /// The part of the command that a friction compensator added (Nm).
    pub tau_friction_nm: Option<Vec<Vec<f64>>>,
    /// Joint torques measured on the link side (Nm), beside motor-side `tau_j_nm`.
    pub tau_link_nm: Option<Vec<Vec<f64>>>,
    /// Motor positions through the gear (rad).
    pub theta_rad: Option<Vec<Vec<f64>>>,
    /// Motor velocities through the gear (rad/s).
    pub dtheta_rad_s: Option<Vec<Vec<f64>>>,
    /// Joint temperatures (degC).
    pub temperature_c: Option<Vec<Vec<f64>>>,
    /// Ambient temperature (degC).
    pub temperature_ambient_c: Option<Vec<f64>>,
    /// Wrench the robot exerts on the environment, base frame: force x, y, z (N), moment x, y, z (Nm).
    pub o_f_ext: Option<[Vec<f64>; 6]>,
}

impl LogColumns {
    /// Number of joints, from the position columns.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.q_rad.len()
    }

    /// Number of rows, from the time column.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.time_s.len()
    }

    /// The columns of one quantity, empty where the log lacks it.
    #[must_use]
    pub fn quantity(&self, quantity: Quantity) -> Vec<&[f64]> {
        fn all(columns: &[Vec<f64>]) -> Vec<&[f64]> {
            columns.iter().map(Vec::as_slice).collect()
        }
        fn optional(columns: Option<&Vec<Vec<f64>>>) -> Vec<&[f64]> {
            columns.map(|c| all(c)).unwrap_or_default()
        }
        match quantity {
            Quantity::Time => vec![&self.time_s],
            Quantity::Position => all(&self.q_rad),
            Quantity::Velocity => all(&self.dq_rad_s),
            Quantity::Torque => all(&self.tau_j_nm),
            Quantity::TorqueDesired => optional(self.tau_j_d_nm.as_ref()),
            Quantity::FrictionCompensation => optional(self.tau_friction_nm.as_ref()),
            Quantity::LinkTorque => optional(self.tau_link_nm.as_ref()),
            Quantity::MotorPosition => optional(self.theta_rad.as_ref()),
            Quantity::MotorVelocity => optional(self.dtheta_rad_s.as_ref()),
            Quantity::Temperature => optional(self.temperature_c.as_ref()),
            Quantity::TemperatureAmbient => self.temperature_ambient_c.iter().map(Vec::as_slice).collect(),
            Quantity::ExternalWrench => self.o_f_ext.as_ref().map(|c| all(c)).unwrap_or_default(),
        }
    }

    /// Whether the log has the quantity.
    #[must_use]
    pub fn has(&self, quantity: Quantity) -> bool {
        !self.quantity(quantity).is_empty()
    }

    /// Every column with its canonical name, in canonical order.
    #[must_use]
    pub fn named(&self) -> Vec<(String, &[f64])> {
        Quantity::ALL
            .into_iter()
            .flat_map(|quantity| {
                let columns = self.quantity(quantity).into_iter().enumerate();
                columns.map(move |(index, column)| (quantity.column_name(index), column))
            })
            .collect()
    }

    /// Checks the law of a log.
    ///
    /// # Errors
    /// [`LogError::ColumnCount`], [`LogError::ColumnLength`], [`LogError::TooFewRows`], [`LogError::NotFinite`],
    /// [`LogError::TimeNotIncreasing`] or [`LogError::OutOfRange`], whichever is met first in canonical order.
    pub fn validate(self) -> Result<RobotLog, LogError> {
        let (joints, rows) = (self.joints().max(1), self.rows());
        for quantity in Quantity::ALL {
            let (got, expected) = (self.quantity(quantity).len(), quantity.column_count(joints));
            let present = quantity.is_required() || self.is_given(quantity);
            if present && got != expected {
                return Err(LogError::ColumnCount { quantity: quantity.to_string(), got, expected });
            }
        }
        if rows < MIN_ROWS {
            return Err(LogError::TooFewRows { got: rows, need: MIN_ROWS });
        }
        for (column, values) in self.named() {
            if values.len() != rows {
                return Err(LogError::ColumnLength { column, got: values.len(), expected: rows });
            }
            if let Some(row) = values.iter().position(|v| !v.is_finite()) {
                return Err(LogError::NotFinite { column, row, value: values[row] });
            }
        }
        match self.time_s.windows(2).position(|pair| pair[1] <= pair[0]) {
            Some(k) => {
                Err(LogError::TimeNotIncreasing { row: k + 1, previous_s: self.time_s[k], value_s: self.time_s[k + 1] })
            }
            None => finite_duration(&self.time_s).map(|()| RobotLog(self)),
        }
    }

    /// Puts columns in the place of a quantity: one per joint, six of the wrench, one of the others.
    pub fn set(&mut self, quantity: Quantity, columns: Vec<Vec<f64>>) {
        self.set_quantity(quantity, columns);
    }

    /// Puts columns in the place of a quantity; a single-column quantity takes the first.
    pub(crate) fn set_quantity(&mut self, quantity: Quantity, columns: Vec<Vec<f64>>) {
        match quantity {
            Quantity::Time => self.time_s = columns.into_iter().next().unwrap_or_default(),
            Quantity::Position => self.q_rad = columns,
            Quantity::Velocity => self.dq_rad_s = columns,
            Quantity::Torque => self.tau_j_nm = columns,
            Quantity::TorqueDesired => self.tau_j_d_nm = Some(columns),
            Quantity::FrictionCompensation => self.tau_friction_nm = Some(columns),
            Quantity::LinkTorque => self.tau_link_nm = Some(columns),
            Quantity::MotorPosition => self.theta_rad = Some(columns),
            Quantity::MotorVelocity => self.dtheta_rad_s = Some(columns),
            Quantity::Temperature => self.temperature_c = Some(columns),
            Quantity::TemperatureAmbient => self.temperature_ambient_c = columns.into_iter().next(),
            Quantity::ExternalWrench => self.o_f_ext = columns.try_into().ok(),
        }
    }

    /// Every column mapped by `f`, quantities kept.
    pub(crate) fn map(&self, mut f: impl FnMut(Quantity, &[f64]) -> Vec<f64>) -> Self {
        let mut mapped = Self::default();
        for quantity in Quantity::ALL.into_iter().filter(|&quantity| self.has(quantity)) {
            let columns = self.quantity(quantity).into_iter().map(|column| f(quantity, column)).collect();
            mapped.set_quantity(quantity, columns);
        }
        mapped
    }

    /// Whether the caller meant the quantity to be there, even if with no column.
    fn is_given(&self, quantity: Quantity) -> bool {
        match quantity {
            Quantity::TorqueDesired => self.tau_j_d_nm.is_some(),
            Quantity::FrictionCompensation => self.tau_friction_nm.is_some(),
            Quantity::LinkTorque => self.tau_link_nm.is_some(),
            Quantity::MotorPosition => self.theta_rad.is_some(),
            Quantity::MotorVelocity => self.dtheta_rad_s.is_some(),
            Quantity::Temperature => self.temperature_c.is_some(),
            _ => self.has(quantity),
        }
    }
}

/// Stamps that are finite may be further apart than a number can say, and who divides their distance gets no count of rows.
pub(crate) fn finite_duration(time_s: &[f64]) -> Result<(), LogError> {
    let value = time_s.last().zip(time_s.first()).map_or(0.0, |(last, first)| last - first);
    let allowed = "the durations that are finite numbers of seconds";
    if value.is_finite() {
        Ok(())
    } else {
        Err(LogError::OutOfRange { field: "time, last less first", value, allowed })
    }
}

/// A valid log. Its columns are read through [`LogColumns`]: `log.time_s`, `log.q_rad[joint][row]`.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotLog(LogColumns);

impl RobotLog {
    /// The columns, to be changed and validated again.
    #[must_use]
    pub fn into_columns(self) -> LogColumns {
        self.0
    }

    /// The log without some quantities, whose memory is given back; those that every log has stay.
    #[must_use]
    pub fn without(mut self, quantities: &[Quantity]) -> Self {
        for quantity in quantities {
            match quantity {
                Quantity::Time | Quantity::Position | Quantity::Velocity | Quantity::Torque => {}
                Quantity::TorqueDesired => self.0.tau_j_d_nm = None,
                Quantity::FrictionCompensation => self.0.tau_friction_nm = None,
                Quantity::LinkTorque => self.0.tau_link_nm = None,
                Quantity::MotorPosition => self.0.theta_rad = None,
                Quantity::MotorVelocity => self.0.dtheta_rad_s = None,
                Quantity::Temperature => self.0.temperature_c = None,
                Quantity::TemperatureAmbient => self.0.temperature_ambient_c = None,
                Quantity::ExternalWrench => self.0.o_f_ext = None,
            }
        }
        self
    }

    /// The rows of `range`, such as one of [`crate::bursts`].
    ///
    /// # Errors
    /// [`LogError::TooFewRows`] if the part of `range` inside the log has fewer than two rows.
    pub fn slice(&self, range: Range<usize>) -> Result<Self, LogError> {
        let (start, end) = (range.start.min(self.rows()), range.end.min(self.rows()));
        self.0.map(|_, column| column.get(start..end).map(<[f64]>::to_vec).unwrap_or_default()).validate()
    }

    /// The log without these rows, which are in order.
    ///
    /// # Errors
    /// [`LogError::TooFewRows`] if fewer than two rows are left.
    pub fn without_rows(&self, left_out: &[usize]) -> Result<Self, LogError> {
        let kept: Vec<bool> = (0..self.rows()).map(|row| left_out.binary_search(&row).is_err()).collect();
        self.rows_where(&kept)
    }

    /// The rows of which `kept` says so.
    pub(crate) fn rows_where(&self, kept: &[bool]) -> Result<Self, LogError> {
        let pick = |column: &[f64]| column.iter().zip(kept).filter(|(_, kept)| **kept).map(|(x, _)| *x).collect();
        self.0.map(|_, column| pick(column)).validate()
    }

    /// Time from the first to the last stamp (s).
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match (self.time_s.first(), self.time_s.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }
}

impl Deref for RobotLog {
    type Target = LogColumns;

    fn deref(&self) -> &LogColumns {
        &self.0
    }
}

/// One row across the columns of a quantity: `row::<7>(&log.q_rad, k)`.
///
/// # Panics
/// As slice indexing does, if there are fewer than `N` columns or no such row.
#[must_use]
pub fn row<const N: usize>(columns: &[Vec<f64>], row: usize) -> [f64; N] {
    std::array::from_fn(|column| columns[column][row])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_rows() -> LogColumns {
        LogColumns {
            time_s: vec![0.0, 1.0],
            q_rad: vec![vec![1.0, 2.0]],
            dq_rad_s: vec![vec![3.0, 4.0]],
            tau_j_nm: vec![vec![5.0, 6.0]],
            ..LogColumns::default()
        }
    }

    #[test]
    fn each_broken_law_is_named() {
        let mut log = two_rows();
        log.q_rad[0][1] = f64::NAN;
        assert_eq!(log.validate().unwrap_err().to_string(), "column q_0, row 1: NaN is not finite");
        let mut log = two_rows();
        log.time_s[1] = 0.0;
        assert!(log.validate().unwrap_err().to_string().contains("row 1: 0 s does not exceed the stamp before, 0 s"));
        let mut log = two_rows();
        log.dq_rad_s[0].pop();
        assert_eq!(log.validate().unwrap_err().to_string(), "column dq_0: 1 rows, expected 2");
        let log = LogColumns { time_s: vec![-1e308, 1e308], ..two_rows() };
        assert!(log.validate().unwrap_err().to_string().starts_with("time, last less first: inf is outside"));
        let log = LogColumns { temperature_c: Some(vec![]), ..two_rows() };
        assert_eq!(log.validate().unwrap_err().to_string(), "temperature_i: 0 columns, expected 1");
        assert!(matches!(LogColumns::default().validate(), Err(LogError::ColumnCount { .. })));
        let log = two_rows().validate().unwrap();
        assert!(matches!(log.slice(1..2), Err(LogError::TooFewRows { got: 1, need: 2 })));
        assert_eq!(log.slice(0..9).unwrap(), log);
        let warm = LogColumns { temperature_c: Some(vec![vec![30.0, 31.0]]), ..two_rows() }.validate().unwrap();
        assert_eq!(warm.clone().without(&[Quantity::Temperature, Quantity::Position]), log);
        assert_eq!(warm.clone().without(&[Quantity::LinkTorque]), warm);
        assert_eq!(row::<1>(&log.q_rad, 1), [2.0]);
    }
}
