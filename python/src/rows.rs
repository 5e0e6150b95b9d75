//! Arrays of samples, in and out.

use nalgebra::SVector;
use numpy::{AllowTypeChange, IxDyn, PyArray1, PyArrayDyn, PyArrayLikeDyn, PyArrayMethods};
use pyo3::prelude::*;

use crate::failure::bad;

/// Samples of N joints: `(n, N)`, or `(N,)` of one.
pub(crate) struct Rows<'py> {
    numbers: Numbers<'py>,
    /// `[n]`, or `[]` of one sample.
    pub leading: Vec<usize>,
    /// N.
    pub joints: usize,
}

/// Where the numbers lie.
enum Numbers<'py> {
    /// In Python's array, row by row.
    There(PyArrayLikeDyn<'py, f64, AllowTypeChange>),
    /// Here, since there they are not row by row.
    Here(Vec<f64>),
}

impl<'py> Rows<'py> {
    /// Reads what NumPy takes for an array of numbers.
    ///
    /// # Errors
    /// No numbers, or more dimensions than two.
    pub(crate) fn of(value: &Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let array: PyArrayLikeDyn<'py, f64, AllowTypeChange> =
            value.extract().map_err(|error| bad(format!("{name} is no array of numbers: {error}")))?;
        let view = array.as_array();
        let (leading, joints) = match view.shape() {
            [joints] => (Vec::new(), *joints),
            [rows, joints] => (vec![*rows], *joints),
            shape => return Err(bad(format!("{name} has shape {shape:?}; allowed: (n, joints) or (joints,)"))),
        };
        let copy = (!view.is_standard_layout()).then(|| view.iter().copied().collect());
        Ok(Self { numbers: copy.map_or(Numbers::There(array), Numbers::Here), leading, joints })
    }

    /// Row by row.
    pub(crate) fn numbers(&self) -> &[f64] {
        match &self.numbers {
            Numbers::There(array) => array.as_slice().unwrap_or_default(),
            Numbers::Here(numbers) => numbers,
        }
    }

    /// [`Self::of`] an arm with so many joints, and as many samples as `like`, where there is such.
    ///
    /// # Errors
    /// Another shape.
    pub(crate) fn of_arm(value: &Bound<'py, PyAny>, name: &str, joints: usize, like: Option<&Self>) -> PyResult<Self> {
        let rows = Self::of(value, name)?;
        if rows.joints != joints {
            return Err(bad(format!("{name} has {} columns; the arm has {joints} joints", rows.joints)));
        }
        match like {
            Some(like) if like.leading != rows.leading => {
                let (shape, other) = (rows.shape(), like.shape());
                Err(bad(format!("{name} has shape {shape:?}; the first array has {other:?}")))
            }
            _ => Ok(rows),
        }
    }

    /// The same shape, all zero.
    pub(crate) fn zeros_like(&self) -> Self {
        let zeros = Numbers::Here(vec![0.0; self.numbers().len()]);
        Self { numbers: zeros, leading: self.leading.clone(), joints: self.joints }
    }

    /// As Python has it.
    pub(crate) fn shape(&self) -> Vec<usize> {
        self.leading.iter().copied().chain([self.joints]).collect()
    }

    /// Columns, one per joint.
    pub(crate) fn columns(&self) -> Vec<Vec<f64>> {
        (0..self.joints).map(|j| self.numbers().iter().skip(j).step_by(self.joints.max(1)).copied().collect()).collect()
    }
}

/// Numbers in one dimension.
///
/// # Errors
/// No numbers, or another number of dimensions.
pub(crate) fn column(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    let rows = Rows::of(value, name)?;
    if rows.leading.is_empty() {
        Ok(rows.numbers().to_vec())
    } else {
        Err(bad(format!("{name} has two dimensions; allowed: (n,)")))
    }
}

/// One sample of N joints.
///
/// # Errors
/// Another shape.
pub(crate) fn sample<const N: usize>(value: &Bound<'_, PyAny>, name: &str) -> PyResult<SVector<f64, N>> {
    let numbers = column(value, name)?;
    if numbers.len() == N {
        Ok(SVector::from_column_slice(&numbers))
    } else {
        Err(bad(format!("{name} has {} numbers; the arm has {N} joints", numbers.len())))
    }
}

/// `f(row of each input, row of the output)`, row by row, without Python's lock; the output is `(n, *each)`.
pub(crate) fn over_rows<'py, const N: usize, const K: usize>(
    py: Python<'py>,
    inputs: [&Rows<'_>; K],
    each: &[usize],
    f: impl Fn([SVector<f64, N>; K], &mut [f64]) + Sync,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let Some(first) = inputs.first() else { return Err(bad("no input")) };
    let width: usize = each.iter().product();
    let shape: Vec<usize> = first.leading.iter().chain(each).copied().collect();
    let rows = first.numbers().len() / N;
    let inputs = inputs.map(Rows::numbers);
    let output = py.detach(|| {
        let mut output = vec![0.0; rows * width];
        for (k, out) in output.chunks_exact_mut(width).enumerate() {
            f(inputs.map(|input| SVector::from_column_slice(&input[k * N..(k + 1) * N])), out);
        }
        output
    });
    array(py, output, &shape)
}

/// An array of this shape.
pub(crate) fn array<'py>(py: Python<'py>, numbers: Vec<f64>, shape: &[usize]) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    PyArray1::from_vec(py, numbers).reshape(IxDyn(shape))
}

/// Columns as an array `(n, columns)`.
pub(crate) fn from_columns<'py>(py: Python<'py>, columns: &[&[f64]]) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let rows = columns.first().map_or(0, |column| column.len());
    let numbers = (0..rows).flat_map(|k| columns.iter().map(move |column| column[k])).collect();
    array(py, numbers, &[rows, columns.len()])
}
