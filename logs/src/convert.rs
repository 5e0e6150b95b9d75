//! From a log of any format to a file of ours, in batches of rows where the formats allow it.
//!
//! ```text
//! canonical or libfranka CSV  --65 536 rows at a time, checked as ever-->  CSV, Parquet, MCAP    one batch in memory
//! anything else               --whole-->                                   CSV, Parquet, MCAP    the log in memory
//! ```
//!
//! Both ways write the same bytes. Of a log in batches only the stamps stay in memory: 29 MB for an hour at 1 kHz.
//! Leaves out: other formats in batches (Parquet, MCAP and the Kinova files are looked at as a whole first).

use std::io::BufRead;
use std::path::Path;
use std::rc::Rc;

use tribo_files::{LogError, LogFile, ROWS_PER_GROUP, replace};

use crate::canonical_csv::canonical_rows;
use crate::csv_rows::CsvRows;
use crate::detect::{detect, read_heard};
use crate::differentiated::lacks_velocity;
use crate::format::LogFormat;
use crate::libfranka::libfranka_rows;
use crate::log::{MIN_ROWS, finite_duration};
use crate::read_options::ReadOptions;
use crate::recognise::{Remark, Severity, recognise};
use crate::summary::LogSummary;
use crate::write_log::{LogTarget, Sink, write_log};

/// Reads the log at `from` and writes it to `to`. `progress` hears the part that is read, 0 to 1, and stops by saying false.
///
/// # Errors
/// Those of [`read_watched`](crate::read_watched) and [`write_log`]; [`LogError::Stopped`]. Then nothing is written.
pub fn convert(
    from: impl AsRef<Path>,
    to: impl AsRef<Path>,
    target: LogTarget,
    progress: impl Fn(f64) -> bool + Clone + 'static,
) -> Result<LogSummary, LogError> {
    convert_by(from, to, target, &ReadOptions::default(), progress)
}

/// As [`convert`], of a log that is read by `options`.
///
/// # Errors
/// Those of [`read_watched`](crate::read_watched) and [`write_log`]; [`LogError::Stopped`]. Then nothing is written.
pub fn convert_by(
    from: impl AsRef<Path>,
    to: impl AsRef<Path>,
    target: LogTarget,
    options: &ReadOptions,
    progress: impl Fn(f64) -> bool + Clone + 'static,
) -> Result<LogSummary, LogError> {
    convert_heard(from.as_ref(), to.as_ref(), target, options, Rc::new(progress))
}

fn convert_heard(
    from: &Path,
    to: &Path,
    target: LogTarget,
    options: &ReadOptions,
    progress: Rc<dyn Fn(f64) -> bool>,
) -> Result<LogSummary, LogError> {
    let stopped = || LogError::Stopped { path: to.to_path_buf() };
    let format = detect(from)?;
    let file = LogFile::new(from);
    let rows = if options.map.is_some() { None } else { rows_of(&file, format)? };
    match rows {
        Some(rows) => {
            let mut summary = None;
            replace(to, |out| {
                let names: Vec<String> = rows.header.column_names();
                let sink = Sink::new(out, to, &names, target)?;
                summary = Some(in_batches(rows, from, sink, &mut || {
                    progress(file.part_read()).then_some(()).ok_or_else(stopped)
                })?);
                Ok(())
            })?;
            summary.ok_or_else(stopped)
        }
        None => {
            let read = read_heard(from, options, Rc::clone(&progress));
            let (log, summary) = read.map_err(|error| match error {
                LogError::Stopped { .. } => stopped(),
                other => other,
            })?;
            if !progress(1.0) {
                return Err(stopped());
            }
            write_log(to, &log, target)?;
            Ok(summary)
        }
    }
}

/// The rows of a format that can be read in one pass; `None` for the others.
fn rows_of<'p>(file: &LogFile<'p>, format: LogFormat) -> Result<Option<CsvRows<'p, Box<dyn BufRead>>>, LogError> {
    let rows = match format {
        LogFormat::Csv | LogFormat::CsvGz => match canonical_rows(file.open_text("CSV")?.0, file.path, format) {
            // The names may say all the same what is what; the reader of the whole file tells.
            Err(LogError::InFile { source, .. }) if matches!(*source, LogError::MissingColumns { .. }) => {
                return Ok(None);
            }
            rows => rows?,
        },
        LogFormat::Libfranka => libfranka_rows(file)?,
        _ => return Ok(None),
    };
    // Velocities are worked out from the whole log.
    Ok((!lacks_velocity(&rows.header.quantities)).then_some(rows))
}

/// Every row from the file to the sink.
fn in_batches(
    mut rows: CsvRows<'_, Box<dyn BufRead>>,
    from: &Path,
    mut sink: Sink<'_, '_>,
    go_on: &mut dyn FnMut() -> Result<(), LogError>,
) -> Result<LogSummary, LogError> {
    let mut batch = vec![Vec::new(); rows.header.positions.len()];
    let (mut time_s, mut remarks, mut first) = (Vec::new(), Vec::<Remark>::new(), true);
    loop {
        batch.iter_mut().for_each(Vec::clear);
        let count = rows.append_to(&mut batch, ROWS_PER_GROUP)?;
        time_s.extend_from_slice(&batch[0]);
        if count > 0 {
            sink.write(&batch.iter().map(Vec::as_slice).collect::<Vec<_>>())?;
        }
        let done = std::mem::replace(&mut batch, vec![Vec::new(); rows.header.positions.len()]);
        // A rest of the log is too short to be judged alone.
        if first || count >= ROWS_PER_GROUP / 4 {
            for remark in recognise(&rows.header.assemble(done)) {
                // Said once of each joint; the first batch that shows it has the figures.
                if !remarks.iter().any(|said| said.fault == remark.fault && said.joints == remark.joints) {
                    remarks.push(remark);
                }
            }
        }
        first = false;
        go_on()?;
        if count < ROWS_PER_GROUP {
            break;
        }
    }
    if time_s.len() < MIN_ROWS {
        return Err(LogError::TooFewRows { got: time_s.len(), need: MIN_ROWS }.in_file(from));
    }
    finite_duration(&time_s).map_err(|error| error.in_file(from))?;
    sink.finish()?;

    let (format, joints, present) = (rows.format, rows.header.joints, rows.header.quantities.clone());
    let end = rows.end();
    let mut summary = LogSummary::of_rows(format, joints, &time_s, present, end.dropped_repeats, end.unknown);
    summary.warnings.extend(end.warnings);
    remarks.sort_by_key(|remark| remark.severity == Severity::Warn);
    summary.remarks = remarks;
    Ok(summary)
}
