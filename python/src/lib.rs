//! The Python module.
use pyo3::prelude::*;
#[pymodule]
mod _tribo {
    use pyo3::prelude::*;
    #[pyfunction]
    fn hello() -> usize { 1 }
}
