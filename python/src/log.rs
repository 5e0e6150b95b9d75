//! Robot logs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use numpy::PyArrayDyn;
use pyo3::prelude::*;
use serde_json::{Value, json};
use tribo_logs::{
    ColumnMap, LogColumns, LogSummary, LogTarget, Mapping, Quantity, ReadOptions, RobotLog, read, read_from, write_log,
};

use crate::failure::{bad, raised};
use crate::remarks::warn;
use crate::rows::{Rows, array, column, from_columns};

/// A robot log: columns of one length, stamps that increase, every number finite. SI units; joint arrays are `(n, joints)`.
#[pyclass(name = "Log", module = "tribo", frozen)]
#[derive(Clone, Debug)]
pub(crate) struct PyLog {
    pub(crate) log: RobotLog,
    /// File name, or `log`.
    pub(crate) name: String,
    /// What reading the file found.
    summary: Option<LogSummary>,
}

/// Reads a log of any known format from a file, or from `content` that is called `path`. `map` says which column is what, as `--map` does: entries, the path of a map file, or
/// the text of one (`is_text`); `joints` are the names of the arm's joints.
#[pyfunction]
#[pyo3(signature = (path, map, is_text, joints, content))]
pub(crate) fn read_log(
    py: Python<'_>,
    path: PathBuf,
    map: Option<&str>,
    is_text: bool,
    joints: Vec<String>,
    content: Option<Vec<u8>>,
) -> PyResult<PyLog> {
    let map = match map {
        None => None,
        Some(text) if is_text => Some(ColumnMap::from_yaml(text, Path::new("map")).map_err(raised)?),
        Some(given) => Some(ColumnMap::given(given).map_err(raised)?),
    };
    let options = ReadOptions { map, joints, most_rows: None };
    let found = py.detach(|| match content {
        Some(bytes) => read_from(bytes, &path, &options),
        None => read(&path, &options),
    });
    let (log, summary) = found.map_err(raised)?;
    let name = path.display().to_string();
    if let Some(mapping) = summary.mapping.as_ref().filter(|mapping| mapping.proposed) {
        warn(py, &format!("{name}: read as {mapping}; give map to change it"))?;
    }
    Ok(PyLog { log, name, summary: Some(summary) })
}

impl PyLog {
    /// Which columns were read as which, as the JSON of a diagnosis has it.
    pub(crate) fn read_as(&self) -> Value {
        let mapping = self.summary.as_ref().and_then(|summary| summary.mapping.as_ref());
        json!({"log": self.name, "read_as": mapping.map(Mapping::to_json)})
    }

    /// A log that comes from no file.
    pub(crate) fn of(log: RobotLog, name: &str) -> Self {
        Self { log, name: name.to_owned(), summary: None }
    }
}

/// The quantities beside time, by the name of their keyword.
const QUANTITIES: [(&str, Quantity); 11] = [
    ("q", Quantity::Position),
    ("dq", Quantity::Velocity),
    ("tau", Quantity::Torque),
    ("tau_desired", Quantity::TorqueDesired),
    ("tau_friction", Quantity::FrictionCompensation),
    ("tau_link", Quantity::LinkTorque),
    ("theta", Quantity::MotorPosition),
    ("dtheta", Quantity::MotorVelocity),
    ("temperature", Quantity::Temperature),
    ("temperature_ambient", Quantity::TemperatureAmbient),
    ("wrench", Quantity::ExternalWrench),
];

#[pymethods]
impl PyLog {
    /// A log from arrays: `time (n,)` in s, `q (n, joints)` in rad, `tau (n, joints)` in Nm; `dq` in rad/s is worked out from q where it is left out. Further keywords:
    /// `tau_desired, tau_friction, tau_link, theta, dtheta, temperature (n, joints)`, `temperature_ambient (n,)`, `wrench (n, 6)` by the robot on the environment.
    #[staticmethod]
    #[pyo3(signature = (time, q, tau, dq = None, **more))]
    fn from_arrays(
        time: &Bound<'_, PyAny>,
        q: &Bound<'_, PyAny>,
        tau: &Bound<'_, PyAny>,
        dq: Option<&Bound<'_, PyAny>>,
        more: Option<BTreeMap<String, Bound<'_, PyAny>>>,
    ) -> PyResult<Self> {
        let mut columns = LogColumns { time_s: column(time, "time")?, ..LogColumns::default() };
        let samples = columns.time_s.len();
        let mut given: BTreeMap<String, Bound<'_, PyAny>> = more.unwrap_or_default();
        given.insert("q".to_owned(), q.clone());
        given.insert("tau".to_owned(), tau.clone());
        let dq = dq.filter(|dq| !dq.is_none());
        given.extend(dq.map(|dq| ("dq".to_owned(), dq.clone())));
        for (name, value) in &given {
            let known = QUANTITIES.into_iter().find(|(keyword, _)| keyword == name);
            let Some((_, quantity)) = known else {
                let allowed = QUANTITIES.map(|(keyword, _)| keyword).join(", ");
                return Err(bad(format!("{name} is no quantity of a log; allowed: time, {allowed}")));
            };
            let values = match quantity {
                Quantity::TemperatureAmbient => vec![column(value, name)?],
                _ => {
                    let rows = Rows::of(value, name)?;
                    if rows.leading != [samples] {
                        let shape = rows.shape();
                        let message = format!(
                            "{name} has shape {shape:?}; allowed: ({samples}, columns), a row for each of time"
                        );
                        return Err(bad(message));
                    }
                    rows.columns()
                }
            };
            columns.set(quantity, values);
        }
        if dq.is_none() {
            columns.differentiate().map_err(raised)?;
        }
        Ok(Self::of(columns.validate().map_err(raised)?, "log"))
    }

    /// A log from named columns, each `(n,)`: `time`, `q_0` …, `dq_0` …, `tau_J_0` … and the others of a canonical CSV; unknown names are left out.
    #[staticmethod]
    fn from_columns(named: BTreeMap<String, Bound<'_, PyAny>>) -> PyResult<Self> {
        let mut of_quantity: BTreeMap<Quantity, BTreeMap<usize, Vec<f64>>> = BTreeMap::new();
        for (name, value) in &named {
            if let Some((quantity, index)) = Quantity::from_canonical_name(name) {
                of_quantity.entry(quantity).or_default().insert(index, column(value, name)?);
            }
        }
        let mut columns = LogColumns::default();
        for (quantity, found) in of_quantity {
            if let Some(missing) = (0..found.len()).find(|index| !found.contains_key(index)) {
                return Err(bad(format!("missing column: {}", quantity.column_name(missing))));
            }
            columns.set(quantity, found.into_values().collect());
        }
        if columns.dq_rad_s.is_empty() && !columns.q_rad.is_empty() {
            columns.differentiate().map_err(raised)?;
        }
        Ok(Self::of(columns.validate().map_err(raised)?, "log"))
    }

    /// Its columns by their canonical names, each `(n,)`.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, Bound<'py, PyArrayDyn<f64>>)>> {
        let named = self.log.named().into_iter();
        named.map(|(name, values)| Ok((name, array(py, values.to_vec(), &[values.len()])?))).collect()
    }

    /// A quantity by its keyword in `from_arrays`; none where the log lacks it.
    fn quantity<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyArrayDyn<f64>>>> {
        let known = QUANTITIES.into_iter().find(|(keyword, _)| *keyword == name);
        let Some((_, quantity)) = known else { return Err(bad(format!("{name} is no quantity of a log"))) };
        if !self.log.has(quantity) {
            return Ok(None);
        }
        let columns = self.log.quantity(quantity);
        match (quantity, columns.as_slice()) {
            (Quantity::TemperatureAmbient, [only]) => Ok(Some(array(py, only.to_vec(), &[only.len()])?)),
            _ => Ok(Some(from_columns(py, &columns)?)),
        }
    }

    /// Stamps (s), `(n,)`.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        array(py, self.log.time_s.clone(), &[self.log.rows()])
    }

    /// Number of joints.
    #[getter]
    fn joints(&self) -> usize {
        self.log.joints()
    }

    /// Time from the first stamp to the last (s).
    #[getter]
    fn duration(&self) -> f64 {
        self.log.duration_s()
    }

    /// What reading the file found, in words; of a log from arrays, its size.
    fn summary(&self) -> String {
        self.summary.as_ref().map_or_else(|| self.__repr__(), ToString::to_string)
    }

    /// Where it comes from.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// The same log under another name, which messages and reports use.
    fn named(&self, name: String) -> Self {
        Self { name, ..self.clone() }
    }

    /// Writes it as `.csv`, `.csv.gz`, `.parquet` or `.mcap`, whole or not at all.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let target = LogTarget::of_path(&path).ok_or_else(|| {
            bad(format!("{}: the name ends in none of {}", path.display(), LogTarget::ENDINGS.join(", ")))
        })?;
        py.detach(|| write_log(&path, &self.log, target)).map_err(raised)
    }

    /// The samples `start..end`.
    fn slice(&self, start: usize, end: usize) -> PyResult<Self> {
        Ok(Self { log: self.log.slice(start..end).map_err(raised)?, name: self.name.clone(), summary: None })
    }

    fn __len__(&self) -> usize {
        self.log.rows()
    }

    fn __repr__(&self) -> String {
        let (rows, joints, duration) = (self.log.rows(), self.log.joints(), self.log.duration_s());
        format!("Log({}: {rows} samples, {joints} joints, {duration:.3} s)", self.name)
    }
}
