//! Rows of a foreign table as a log.
//!
//! ```text
//! one episode  ->  time (s)  ->  joints in order, SI  ->  rows that lack a cell out, repeats out  ->  dq where there is none
//! ```
//!
//! Stamps beyond 10^8 s, epochs, count from the first row; where nothing says their unit, their size does (10^9 s, 10^12 ms, 10^15 µs, 10^18 ns since
//! 1970). A long table becomes a wide one: a row for each stamp that all joints have.

use std::collections::BTreeSet;
use std::path::Path;

use tribo_files::{LogError, visible};

use super::column_map::ColumnMap;
use super::mapping::{MappedColumn, Mapping};
use super::plan::{Clock, Naming, Plan};
use super::select::{Labels, by_number_or_name};
use super::table::{Cells, Column, ForeignTable, Loaded};
use super::unit::Unit;
use crate::differentiated::differentiate;
use crate::joint_order::arm_joints;
use crate::log::{LogColumns, RobotLog};
use crate::quantity::{MAX_JOINTS, Quantity};
use crate::summary::LogSummary;

/// Stamps from here on (s) are counted from the first.
const EPOCH_S: f64 = 1e8;

/// Reads a table by a map. `known` are the names of the arm's joints, base to tool, where they are known.
pub(crate) fn assemble(
    table: &dyn ForeignTable,
    map: &ColumnMap,
    proposed: bool,
    known: &[String],
    path: &Path,
) -> Result<(RobotLog, LogSummary), LogError> {
    let columns = table.columns();
    let plan = Plan::new(map, columns, known, path)?;
    let wanted = plan.wanted();
    let loaded = table.load(&wanted)?;
    let rows = Rows { plan: &plan, columns, wanted: &wanted, loaded: &loaded, path };
    let known = if map.joints.is_empty() { known } else { &map.joints };

    let kept = rows.of_episode()?;
    let (mut log, order, dropped) = match plan.naming {
        Naming::Rows(column) => rows.long(column, &kept, known)?,
        _ => rows.wide(&kept, known)?,
    };
    let mut warnings = loaded.warnings.clone();
    if log.dq_rad_s.is_empty() && log.q_rad.iter().all(|q| q.len() == log.rows()) {
        warnings.push(differentiate(&mut log));
    }
    let log = log.validate().map_err(|error| error.in_file(path))?;
    let read: BTreeSet<usize> = wanted.iter().copied().collect();
    let mut unknown: Vec<String> = columns
        .iter()
        .enumerate()
        .filter(|(index, _)| !read.contains(index))
        .map(|(_, column)| column.list.clone().unwrap_or_else(|| column.shown().to_owned()))
        .collect();
    unknown.dedup();
    unknown.extend(table.left_out().iter().cloned());
    let mut summary = LogSummary::new(table.format(), &log, dropped.repeats, unknown);
    summary.dropped_incomplete = dropped.incomplete;
    summary.warnings.extend(warnings);
    summary.mapping = Some(rows.mapping(map, proposed, &order));
    Ok((log, summary))
}

/// Rows that are not in the log.
#[derive(Default)]
struct Dropped {
    repeats: usize,
    incomplete: usize,
}

/// Names of the joints in the order of the log, and which column of the plan each is.
struct Order {
    names: Vec<String>,
    places: Vec<usize>,
    words: String,
}

/// A table that was read, and what it means.
struct Rows<'t> {
    plan: &'t Plan,
    columns: &'t [Column],
    wanted: &'t [usize],
    loaded: &'t Loaded,
    path: &'t Path,
}

impl Rows<'_> {
    fn refused(&self, detail: String) -> LogError {
        LogError::NotRead { path: self.path.to_path_buf(), detail }
    }

    fn cells(&self, column: usize) -> Result<&Cells, LogError> {
        let place = self.wanted.binary_search(&column).ok().and_then(|place| self.loaded.cells.get(place));
        place.ok_or_else(|| self.refused("a column is missing".to_owned()))
    }

    fn numbers(&self, column: usize) -> Result<(f64, &[f64]), LogError> {
        match self.cells(column)? {
            Cells::Numbers { base, values } => Ok((*base as f64, values)),
            Cells::Text { .. } => {
                Err(self.refused(format!("column `{}` holds text, no numbers", visible(&self.columns[column].name))))
            }
        }
    }

    fn row_count(&self) -> usize {
        match self.loaded.cells.first() {
            Some(Cells::Numbers { values, .. }) => values.len(),
            Some(Cells::Text { of_row, .. }) => of_row.len(),
            None => 0,
        }
    }

    /// The rows of the episode; an error where there are several and nobody says which.
    fn of_episode(&self) -> Result<Vec<usize>, LogError> {
        let Some((column, number)) = self.plan.episode else { return Ok((0..self.row_count()).collect()) };
        let (base, values) = self.numbers(column)?;
        let name = visible(&self.columns[column].name);
        let mut episodes: Vec<f64> =
            values.iter().copied().filter(|value| !value.is_nan()).map(|value| base + value).collect();
        episodes.sort_by(f64::total_cmp);
        episodes.dedup();
        let several = || match (episodes.first(), episodes.last()) {
            (Some(first), Some(last)) => format!("{} episodes in column `{name}` ({first} to {last})", episodes.len()),
            _ => format!("no episode in column `{name}`"),
        };
        match number {
            None if episodes.len() > 1 => Err(self.refused(format!(
                "{}: a log is one motion; say which, for instance --map episode={}",
                several(),
                episodes[0]
            ))),
            None => Ok((0..values.len()).collect()),
            Some(number) => {
                let kept: Vec<usize> = (0..values.len()).filter(|&row| base + values[row] == number as f64).collect();
                if kept.is_empty() {
                    return Err(self.refused(format!("no episode {number}; there are {}", several())));
                }
                Ok(kept)
            }
        }
    }

    /// Time of each of these rows (s); not a number where it is not there.
    fn time_s(&self, kept: &[usize]) -> Result<Vec<f64>, LogError> {
        Ok(match &self.plan.clock {
            Clock::Rate(rate_hz) => (0..kept.len()).map(|row| row as f64 / rate_hz).collect(),
            Clock::Column(column, unit) => {
                let (base, values) = self.numbers(*column)?;
                let first = kept.iter().map(|&row| values[row]).find(|value| !value.is_nan()).unwrap_or(0.0);
                let factor = unit.as_ref().map_or_else(|| by_size(base + first).1, |unit| unit.factor(0));
                if ((base + first) * factor).abs() > EPOCH_S {
                    kept.iter().map(|&row| seconds(factor, values[row] - first)).collect()
                } else {
                    kept.iter().map(|&row| seconds(factor, base + values[row])).collect()
                }
            }
            Clock::Sum(parts) => {
                let mut time_s = vec![0.0; kept.len()];
                for (column, unit) in parts {
                    let (base, values) = self.numbers(*column)?;
                    let first = kept.iter().map(|&row| values[row]).find(|value| !value.is_nan()).unwrap_or(0.0);
                    // Of an epoch the first stamp is the beginning, to the last digit.
                    let zero = if parts.iter().any(|(part, unit)| self.is_epoch(*part, unit)) { first } else { -base };
                    for (time, &row) in time_s.iter_mut().zip(kept) {
                        *time += seconds(unit.factor(0), values[row] - zero);
                    }
                }
                time_s
            }
        })
    }

    fn is_epoch(&self, column: usize, unit: &Unit) -> bool {
        let first = self.numbers(column).ok().and_then(|(base, values)| Some(base + values.first()?));
        first.is_some_and(|first| (first * unit.factor(0)).abs() > EPOCH_S)
    }

    /// A table with a row per stamp.
    fn wide(&self, kept: &[usize], known: &[String]) -> Result<(LogColumns, Order, Dropped), LogError> {
        let order = self.order_of_wide(kept, known)?;
        let mut time_s = self.time_s(kept)?;
        let mut all: Vec<(Quantity, usize, Vec<f64>)> = Vec::new();
        for source in &self.plan.sources {
            for index in 0..source.columns.len() {
                let place = if source.quantity.is_per_joint() { order.places.get(index).copied() } else { Some(index) };
                let Some(place) = place else { continue };
                let (base, values) = self.numbers(source.columns[place])?;
                // Factors, signs and offsets are those of the columns as the map lists them, base to tool.
                let column = kept.iter().map(|&row| source.si(index, base + values[row])).collect();
                all.push((source.quantity, index, column));
            }
        }

        // Rows that lack a cell.
        let whole = |row: usize| !time_s[row].is_nan() && all.iter().all(|(.., column)| !column[row].is_nan());
        let there: Vec<usize> = (0..kept.len()).filter(|&row| whole(row)).collect();
        let mut dropped = Dropped { incomplete: kept.len() - there.len(), repeats: 0 };
        if there.is_empty() && !kept.is_empty() {
            return Err(self.refused(format!(
                "none of its {} rows has all columns that are read: their streams have stamps of their own; put them on one clock first",
                kept.len()
            )));
        }

        // Rows that repeat the one before.
        let mut taken: Vec<usize> = Vec::with_capacity(there.len());
        for row in there {
            if let Some(&before) = taken.last()
                && time_s[row] <= time_s[before]
            {
                let same =
                    time_s[row] == time_s[before] && all.iter().all(|(.., column)| column[row] == column[before]);
                if !same {
                    return Err(self.steps_back(kept[row], time_s[before], time_s[row]));
                }
                dropped.repeats += 1;
                continue;
            }
            taken.push(row);
        }
        let pick = |column: &[f64]| -> Vec<f64> { taken.iter().map(|&row| column[row]).collect() };
        if taken.len() < kept.len() {
            time_s = pick(&time_s);
            for (.., column) in &mut all {
                *column = pick(column);
            }
        }
        let mut log = LogColumns { time_s, ..LogColumns::default() };
        let mut all = all.into_iter().peekable();
        for source in &self.plan.sources {
            let mut columns = Vec::new();
            while let Some((.., column)) = all.next_if(|(quantity, ..)| *quantity == source.quantity) {
                columns.push(column);
            }
            log.set_quantity(source.quantity, columns);
        }
        Ok((log, order, dropped))
    }

    fn steps_back(&self, row: usize, previous_s: f64, value_s: f64) -> LogError {
        match self.loaded.lines.get(row) {
            Some(&line) => {
                LogError::TimeStepsBack { path: self.path.to_path_buf(), line: u64::from(line), previous_s, value_s }
            }
            None => LogError::TimeNotIncreasing { row, value_s, previous_s }.in_file(self.path),
        }
    }

    /// Base to tool; names beside the joints have to be the same in every row.
    fn order_of_wide(&self, kept: &[usize], known: &[String]) -> Result<Order, LogError> {
        let joints = self.plan.labels.len();
        let Naming::Beside(columns) = &self.plan.naming else {
            let names = self.plan.labels.clone();
            return Ok(Order { names, places: (0..joints).collect(), words: self.plan.kind.to_string() });
        };
        let mut names = Vec::new();
        for &column in columns {
            let Cells::Text { labels, of_row } = self.cells(column)? else {
                return Err(self.refused(format!("column `{}` names no joints", visible(&self.columns[column].name))));
            };
            let first = kept.first().and_then(|&row| of_row.get(row)).copied().unwrap_or(u32::MAX);
            if let Some(&other) = kept.iter().find(|&&row| of_row[row] != first) {
                let name = visible(&self.columns[column].name);
                return Err(
                    self.refused(format!("column `{name}`, row {other}: names another joint than the rows before"))
                );
            }
            names.push(labels.get(first as usize).cloned().unwrap_or_default());
        }
        let mut wanted = known.to_vec();
        if wanted.is_empty() || !wanted.iter().all(|name| names.contains(name)) {
            wanted = arm_joints(&names);
        }
        let place = |name: &String| names.iter().position(|known| known == name);
        let places: Option<Vec<usize>> = wanted.iter().map(place).collect();
        match places {
            Some(places) if !places.is_empty() => {
                Ok(Order { names: wanted, places, words: "joints by the names beside them, base to tool".to_owned() })
            }
            _ => Err(self.refused(format!("no joint of an arm is named ({})", visible(&names.join(", "))))),
        }
    }

    /// What became of which column.
    fn mapping(&self, map: &ColumnMap, proposed: bool, order: &Order) -> Mapping {
        let (plan, columns) = (self.plan, self.columns);
        let mut mapped = Vec::new();
        let mut push = |column: String, from: String, unit: &str| {
            mapped.push(MappedColumn { column, from: visible(&from), unit: unit.to_owned() });
        };
        let name = |column: usize| columns[column].name.clone();
        match &plan.clock {
            Clock::Column(column, unit) => {
                let size = |(base, values): (f64, &[f64])| by_size(base + values.first().copied().unwrap_or(0.0)).0;
                let sized = || self.numbers(*column).map_or("s", size);
                push("time".to_owned(), name(*column), unit.as_ref().map_or_else(sized, |unit| unit.text()));
            }
            Clock::Sum(parts) => {
                let names: Vec<String> = parts.iter().map(|(column, _)| name(*column)).collect();
                push("time".to_owned(), names.join(" + "), "s");
            }
            Clock::Rate(rate_hz) => push("time".to_owned(), format!("{rate_hz} rows per second"), "s"),
        }
        for source in &plan.sources {
            let long = matches!(plan.naming, Naming::Rows(_));
            let count = source.quantity.column_count(order.names.len());
            for index in 0..count {
                let from = if long {
                    format!("{} of {}", name(source.columns[0]), order.names[index])
                } else {
                    let place = if source.quantity.is_per_joint() { order.places[index] } else { index };
                    name(source.columns[place])
                };
                push(source.quantity.column_name(index), from, source.unit.text());
            }
        }
        let mut map = map.clone();
        if let (Clock::Column(_, None), Some(time)) = (&plan.clock, mapped.first().filter(|time| time.unit != "s")) {
            map.say_unit(Quantity::Time, &time.unit);
        }
        Mapping { map: map.to_string(), proposed, joints: order.words.clone(), columns: mapped }
    }

    /// A table with a row per joint and stamp.
    fn long(&self, column: usize, kept: &[usize], known: &[String]) -> Result<(LogColumns, Order, Dropped), LogError> {
        if matches!(self.plan.clock, Clock::Rate(_)) {
            return Err(self.refused("a table of one row per joint needs a column of time".to_owned()));
        }
        let (labels, of_row): (Vec<String>, Vec<u32>) = match self.cells(column)? {
            Cells::Text { labels, of_row } => (labels.clone(), of_row.clone()),
            Cells::Numbers { base, values } => {
                let mut numbered = Cells::text();
                for value in values {
                    let label = if value.is_nan() { String::new() } else { format!("{}", *base as f64 + value) };
                    if !numbered.push_label(&label) {
                        return Err(self.refused(format!(
                            "column `{}` names too many joints",
                            visible(&self.columns[column].name)
                        )));
                    }
                }
                let Cells::Text { labels, of_row } = numbered else { return Err(self.refused("no joints".to_owned())) };
                (labels, of_row)
            }
        };
        let (names, words) = if !known.is_empty() && known.iter().all(|name| labels.contains(name)) {
            (known.to_vec(), Labels::KnownNames.to_string())
        } else {
            let (names, kind) =
                by_number_or_name(&labels).map_err(|detail| self.refused(format!("joint: {detail}")))?;
            (names, kind.to_string())
        };
        if !(1..=MAX_JOINTS).contains(&names.len()) {
            return Err(self.refused(format!("{} joints; allowed: 1 to {MAX_JOINTS}", names.len())));
        }
        let time_s = self.time_s(kept)?;

        // The rows of each joint, in the order of time.
        let mut of_joint: Vec<Vec<usize>> = vec![Vec::new(); names.len()];
        let joint_of: Vec<Option<usize>> =
            labels.iter().map(|label| names.iter().position(|name| name == label)).collect();
        for (at, &row) in kept.iter().enumerate() {
            let joint = of_row.get(row).and_then(|&label| *joint_of.get(label as usize)?);
            if let Some(joint) = joint.filter(|_| !time_s[at].is_nan()) {
                if let Some(&before) = of_joint[joint].last()
                    && time_s[at] <= time_s[before]
                {
                    return Err(self.steps_back(row, time_s[before], time_s[at]));
                }
                of_joint[joint].push(at);
            }
        }
        // Stamps that all joints have, found side by side.
        let mut next = vec![0; names.len()];
        let mut picked: Vec<Vec<usize>> = vec![Vec::new(); names.len()];
        for &at in &of_joint[0] {
            for (joint, next) in next.iter_mut().enumerate() {
                while of_joint[joint].get(*next).is_some_and(|&other| time_s[other] < time_s[at]) {
                    *next += 1;
                }
            }
            let rows: Vec<usize> =
                (0..names.len()).filter_map(|joint| of_joint[joint].get(next[joint]).copied()).collect();
            if rows.len() == names.len() && rows.iter().all(|&other| time_s[other] == time_s[at]) {
                picked.iter_mut().zip(rows).for_each(|(picked, row)| picked.push(row));
            }
        }
        let mut values: Vec<(Quantity, Vec<Vec<f64>>)> = Vec::new();
        for source in &self.plan.sources {
            let (base, cells) = self.numbers(source.columns[0])?;
            let of = |joint: usize| {
                picked[joint].iter().map(|&at| source.si(joint, base + cells[kept[at]])).collect::<Vec<f64>>()
            };
            values.push((source.quantity, (0..names.len()).map(of).collect()));
        }
        let stamps = picked[0].len();
        let whole = |k: &usize| values.iter().all(|(_, columns)| columns.iter().all(|column| !column[*k].is_nan()));
        let there: Vec<usize> = (0..stamps).filter(whole).collect();
        let most = of_joint.iter().map(Vec::len).max().unwrap_or(0);
        let pick = |column: &Vec<f64>| -> Vec<f64> { there.iter().map(|&k| column[k]).collect() };
        let mut log =
            LogColumns { time_s: there.iter().map(|&k| time_s[picked[0][k]]).collect(), ..LogColumns::default() };
        for (quantity, columns) in values {
            let columns: Vec<Vec<f64>> = columns.iter().map(pick).collect();
            log.set_quantity(quantity, columns);
        }
        let dropped = Dropped { repeats: 0, incomplete: most - there.len() };
        let places = (0..names.len()).collect();
        Ok((log, Order { names, places, words: format!("one row per joint; {words}") }, dropped))
    }
}

/// The unit of a stamp since 1970, by its size, and its seconds.
fn by_size(stamp: f64) -> (&'static str, f64) {
    match stamp.abs() {
        size if size >= 1e17 => ("ns", 1e-9),
        size if size >= 1e14 => ("us", 1e-6),
        size if size >= 1e11 => ("ms", 1e-3),
        _ => ("s", 1.0),
    }
}

/// A stamp in seconds; one that is divided is closer to its decimal than one that is multiplied.
fn seconds(factor: f64, stamp: f64) -> f64 {
    if [1e-3, 1e-6, 1e-9].contains(&factor) { stamp / factor.recip().round() } else { stamp * factor }
}
