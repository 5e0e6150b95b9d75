//! Torque per unit of a coefficient, on the fine grid and in the band.

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::SVector;

/// A regressor on the fine grid: torque per unit coefficient.
#[derive(Clone, Debug)]
pub enum FineColumn<const N: usize> {
    /// Torque of one joint (Nm).
    Joint(usize, Vec<f64>),
    /// Torque of all joints (Nm).
    Arm(Vec<SVector<f64, N>>),
}

impl<const N: usize> FineColumn<N> {
    /// `sum += coefficient · column`.
    pub fn add_to(&self, sum: &mut [SVector<f64, N>], coefficient: f64) {
        match self {
            Self::Joint(j, values) => sum.iter_mut().zip(values).for_each(|(sum, x)| sum[*j] += coefficient * x),
            Self::Arm(values) => sum.iter_mut().zip(values).for_each(|(sum, x)| *sum += x * coefficient),
        }
    }

    /// Whether it is anything but zero on a joint.
    pub fn acts_on(&self, joint: usize) -> bool {
        match self {
            Self::Joint(j, _) => *j == joint,
            Self::Arm(values) => values.iter().any(|value| value[joint] != 0.0),
        }
    }

    /// Torque per unit of the coefficient on a joint that it acts on (Nm), sample by sample.
    pub fn of_joint(&self, joint: usize) -> Cow<'_, [f64]> {
        match self {
            Self::Joint(_, values) => Cow::Borrowed(values),
            Self::Arm(values) => values.iter().map(|value| value[joint]).collect(),
        }
    }
}

/// A regressor after band filter and averaging; a joint that it leaves alone has no row.
#[derive(Clone, Debug)]
pub struct Column<const N: usize> {
    /// Torque per unit coefficient of each joint (Nm); copies of a column share them.
    pub rows: [Option<Arc<Vec<f64>>>; N],
}

impl<const N: usize> Column<N> {
    /// A column that leaves every joint alone.
    pub fn zero() -> Self {
        Self { rows: std::array::from_fn(|_| None) }
    }

    /// A column with a row of every joint.
    pub fn of_rows(rows: [Vec<f64>; N]) -> Self {
        Self { rows: rows.map(|row| Some(Arc::new(row))) }
    }
}

/// `sum += factor · x`.
pub fn add_scaled(sum: &mut [f64], x: &[f64], factor: f64) {
    sum.iter_mut().zip(x).for_each(|(sum, x)| *sum += factor * x);
}

/// A residual less a combination of columns.
pub fn subtracted<const N: usize>(
    mut left: [Vec<f64>; N],
    columns: &[Column<N>],
    coefficients: &[f64],
) -> [Vec<f64>; N] {
    for (column, coefficient) in columns.iter().zip(coefficients) {
        for (left, x) in left.iter_mut().zip(&column.rows) {
            if let Some(x) = x {
                add_scaled(left, x, -coefficient);
            }
        }
    }
    left
}

/// The combination of ten columns; one of them alone is shared.
pub(crate) fn combined<const N: usize>(columns: &[Column<N>; 10], weights: &SVector<f64, 10>) -> Column<N> {
    let used: Vec<usize> = (0..10).filter(|i| weights[*i] != 0.0).collect();
    if let [only] = used[..]
        && weights[only] == 1.0
    {
        return columns[only].clone();
    }
    let rows = std::array::from_fn(|j| {
        let mut sum: Option<Vec<f64>> = None;
        for i in &used {
            if let Some(values) = &columns[*i].rows[j] {
                let sum = sum.get_or_insert_with(|| vec![0.0; values.len()]);
                add_scaled(sum, values, weights[*i]);
            }
        }
        sum.map(Arc::new)
    });
    Column { rows }
}
