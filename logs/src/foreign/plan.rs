//! A map held against the columns of a file: every column that is read, with its unit.

use std::path::Path;

use tribo_files::LogError;

use super::column_map::{ColumnMap, Columns, Entry, key_of};
use super::propose::unit_of;
use super::select::{Found, Labels, find, in_order, no_such, ordered};
use super::table::{Column, Kind};
use super::unit::{Dimension, Unit};
use super::words::{Meaning, meaning};
use crate::quantity::Quantity;

/// Where time comes from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Clock {
    /// A column and its unit; `None` where nothing says it, and the size of the stamps has to.
    Column(usize, Option<Unit>),
    /// Whole units and the rest of them, added.
    Sum(Vec<(usize, Unit)>),
    /// Rows per second.
    Rate(f64),
}

/// The columns of a quantity, joint by joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Source {
    pub quantity: Quantity,
    pub columns: Vec<usize>,
    pub unit: Unit,
    pub sign: Vec<f64>,
    pub offset: Vec<f64>,
}

impl Source {
    /// A cell in SI.
    pub fn si(&self, joint: usize, value: f64) -> f64 {
        let of = |list: &[f64], none: f64| list.get(joint).or(list.first()).copied().unwrap_or(none);
        self.unit.si_value(joint, of(&self.sign, 1.0) * value + of(&self.offset, 0.0))
    }
}

/// What names the joints.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Naming {
    /// The names of the columns.
    Columns,
    /// Columns of names, one beside each joint.
    Beside(Vec<usize>),
    /// A column: each row is of one joint.
    Rows(usize),
}

/// Everything that is read of a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plan {
    pub clock: Clock,
    pub sources: Vec<Source>,
    pub naming: Naming,
    pub labels: Vec<String>,
    pub kind: Labels,
    /// Column of episodes, and which one; `None` where nobody said.
    pub episode: Option<(usize, Option<i64>)>,
}

impl Plan {
    /// Holds a map against the columns of a file. `known` are the names of the arm's joints, base to tool, where they are known.
    pub fn new(map: &ColumnMap, columns: &[Column], known: &[String], path: &Path) -> Result<Self, LogError> {
        let refused = |entry: &str, detail: String| no_such(path, entry, &detail, columns);
        if map.topic.is_some() {
            return Err(refused("topic", "only bags have topics, this is a table".to_owned()));
        }
        let known = if map.joints.is_empty() { known } else { &map.joints };
        let clock = clock(map, columns).map_err(|detail| refused("time", detail))?;

        // Who is who.
        let naming = match &map.joint {
            None => Naming::Columns,
            Some(name) => {
                let found =
                    find(&Columns::Template(name.clone()), columns).map_err(|detail| refused("joint", detail))?;
                match found.columns.as_slice() {
                    [(_, column)] if !found.per_joint => Naming::Rows(*column),
                    _ => {
                        let (labels, kind) =
                            ordered(&found, columns, &[]).map_err(|detail| refused("joint", detail))?;
                        Naming::Beside(in_order(&found, &labels, kind).map_err(|detail| refused("joint", detail))?)
                    }
                }
            }
        };
        let Some(entry) = map.entry(Quantity::Position) else {
            return Err(refused("q", "the map does not say where the joint positions are".to_owned()));
        };
        if map.entry(Quantity::Torque).is_none() {
            let detail = "the map does not say where the joint torques are; a log needs them (measured, or currents times torque constants)";
            return Err(refused("tau", detail.to_owned()));
        }
        let position = find(&entry.columns, columns).map_err(|detail| refused("q", detail))?;
        // Names beside the joints are matched when they are read.
        let by_column: &[String] = if naming == Naming::Columns { known } else { &[] };
        let (labels, kind) = ordered(&position, columns, by_column).map_err(|detail| refused("q", detail))?;

        let mut sources = Vec::new();
        for (quantity, entry) in map.entries.iter().filter(|(quantity, _)| *quantity != Quantity::Time) {
            let refused = |detail: String| refused(key_of(*quantity), detail);
            let found = find(&entry.columns, columns).map_err(refused)?;
            sources.push(source(*quantity, entry, &found, columns, (&labels, kind), &naming).map_err(refused)?);
        }
        if let Naming::Beside(names) = &naming
            && names.len() != labels.len()
        {
            return Err(refused("joint", format!("{} columns of names for {} joints", names.len(), labels.len())));
        }
        let episode = episode(map, columns).map_err(|detail| refused("episode", detail))?;
        let named = matches!(naming, Naming::Rows(_) | Naming::Beside(_));
        if !map.joints.is_empty() && !named && kind != Labels::KnownNames {
            return Err(refused("joints", format!("the columns of q do not name {}", map.joints.join(", "))));
        }
        Ok(Self { clock, sources, naming, labels, kind, episode })
    }

    /// Every column that is read, each once.
    pub fn wanted(&self) -> Vec<usize> {
        let mut wanted: Vec<usize> = match &self.clock {
            Clock::Column(column, _) => vec![*column],
            Clock::Sum(parts) => parts.iter().map(|(column, _)| *column).collect(),
            Clock::Rate(_) => Vec::new(),
        };
        wanted.extend(self.sources.iter().flat_map(|source| source.columns.iter().copied()));
        match &self.naming {
            Naming::Columns => {}
            Naming::Beside(columns) => wanted.extend(columns),
            Naming::Rows(column) => wanted.push(*column),
        }
        wanted.extend(self.episode.map(|(column, _)| column));
        wanted.sort_unstable();
        wanted.dedup();
        wanted
    }
}

fn numbers_only(found: &[usize], columns: &[Column]) -> Result<(), String> {
    match found.iter().find(|&&column| columns[column].kind == Kind::Text) {
        Some(&text) => Err(format!("column `{}` holds text, no numbers", tribo_files::visible(&columns[text].name))),
        None => Ok(()),
    }
}

fn clock(map: &ColumnMap, columns: &[Column]) -> Result<Clock, String> {
    match (map.entry(Quantity::Time), map.rate_hz) {
        (Some(_), Some(_)) => Err("a column of time and a rate are given; one of them is enough".to_owned()),
        (None, None) => {
            Err("the map does not say where time is (time=COLUMN, or rate=HZ where no time is logged)".to_owned())
        }
        (None, Some(rate_hz)) => Ok(Clock::Rate(rate_hz)),
        (Some(entry), None) => {
            if !(entry.sign.is_empty() && entry.offset.is_empty()) {
                return Err("time takes no sign and no offset".to_owned());
            }
            let found: Vec<usize> =
                find(&entry.columns, columns)?.columns.into_iter().map(|(_, column)| column).collect();
            numbers_only(&found, columns)?;
            match found.as_slice() {
                [column] => {
                    let said = || {
                        let unit = unit_of(&columns[*column], Dimension::Time)?;
                        Unit::parse(unit, Quantity::Time).ok()
                    };
                    Ok(Clock::Column(*column, entry.unit.clone().or_else(said)))
                }
                parts => {
                    let unit = |(k, column): (usize, &usize)| -> Result<(usize, Unit), String> {
                        let named = match meaning(&columns[*column].name) {
                            Some((Meaning::Nanoseconds, _)) => "ns",
                            Some((Meaning::Seconds, _)) => "s",
                            _ => match unit_of(&columns[*column], Dimension::Time) {
                                Some(unit) => unit,
                                None if k == 0 => "s",
                                None => "ns",
                            },
                        };
                        Ok((*column, Unit::parse(named, Quantity::Time)?))
                    };
                    Ok(Clock::Sum(parts.iter().enumerate().map(unit).collect::<Result<_, _>>()?))
                }
            }
        }
    }
}

fn source(
    quantity: Quantity,
    entry: &Entry,
    found: &Found,
    columns: &[Column],
    (labels, kind): (&[String], Labels),
    naming: &Naming,
) -> Result<Source, String> {
    let long = matches!(naming, Naming::Rows(_));
    let chosen: Vec<usize> = if quantity.is_per_joint() && !long {
        in_order(found, labels, kind)?
    } else {
        let own = |columns: &[(String, usize)]| columns.iter().map(|(_, column)| *column).collect::<Vec<usize>>();
        let expected = if long { 1 } else { quantity.column_count(labels.len()) };
        if found.columns.len() != expected {
            return Err(format!("{} columns, expected {expected}", found.columns.len()));
        }
        own(&found.columns)
    };
    numbers_only(&chosen, columns)?;
    let unit = match (&entry.unit, Dimension::of(quantity)) {
        (Some(unit), _) => unit.clone(),
        (None, None) => Unit::si(quantity),
        (None, Some(dimension)) => {
            let mut said = chosen.iter().map(|&column| unit_of(&columns[column], dimension));
            let first = said.next().flatten();
            if said.any(|other| other != first) {
                return Err("its columns are in different units; say which with [unit]".to_owned());
            }
            first.map_or(Ok(Unit::si(quantity)), |unit| Unit::parse(unit, quantity))?
        }
    };
    let joints = if long { None } else { Some(chosen.len()) };
    for (what, count) in [
        ("factors", unit.joints()),
        ("signs", (entry.sign.len() > 1).then_some(entry.sign.len())),
        ("offsets", (entry.offset.len() > 1).then_some(entry.offset.len())),
    ] {
        if let (Some(count), Some(joints)) = (count, joints)
            && count != joints
        {
            return Err(format!("{count} {what} for {joints} columns; allowed: 1 or {joints}"));
        }
    }
    Ok(Source { quantity, columns: chosen, unit, sign: entry.sign.clone(), offset: entry.offset.clone() })
}

/// The column of episodes: the one that is named, or the one that its name gives away.
fn episode(map: &ColumnMap, columns: &[Column]) -> Result<Option<(usize, Option<i64>)>, String> {
    let column = match &map.episode {
        Some((Some(name), _)) => {
            let found = find(&Columns::Template(name.clone()), columns)?;
            found.columns.first().map(|(_, column)| *column)
        }
        _ => columns.iter().position(|column| {
            column.kind == Kind::Number && matches!(meaning(&column.name), Some((Meaning::Episode, _)))
        }),
    };
    match (column, &map.episode) {
        (Some(column), given) => {
            numbers_only(&[column], columns)?;
            Ok(Some((column, given.as_ref().map(|(_, number)| *number))))
        }
        (None, None) => Ok(None),
        (None, Some((_, number))) => Err(format!("no column of episodes; say which: episode=COLUMN:{number}")),
    }
}
