//! Which columns of a table a part of a map means, and in which order the joints stand.
//!
//! ```text
//! pos_{joint}        every column of that form; what stands for {joint} are the labels
//! column_{2..8}      these numbers, all of them
//! observation.state  the column of that name, else the entries of the list of that name
//! ```
//!
//! Labels are the arm's joint names where those are known and occur, in whatever order the file has them; else numbers from 0 or 1 without
//! a gap; else names, base to tool by `joint_order`. Columns of grippers and the like are not the arm's.

use std::fmt;

use tribo_files::{LogError, visible};

use super::column_map::Columns;
use super::table::Column;
use super::words::{is_tool, without_unit};
use crate::joint_order::arm_joints;
use crate::quantity::MAX_JOINTS;

/// What stands for the joint in a template.
const JOINT: &str = "{joint}";

/// Columns that a part of a map means: label and position in the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Found {
    pub columns: Vec<(String, usize)>,
    /// Whether labels are joints, and no single column.
    pub per_joint: bool,
}

/// Finds columns; the error says what is missing.
pub(crate) fn find(wanted: &Columns, columns: &[Column]) -> Result<Found, String> {
    match wanted {
        Columns::List(names) => {
            let mut found = Vec::new();
            for (index, name) in names.iter().enumerate() {
                found.push((index.to_string(), one(name, columns)?));
            }
            Ok(Found { columns: found, per_joint: true })
        }
        Columns::Template(template) => match placeholder(template) {
            Some((before, range, after)) => {
                let numbers = range_of(range)?;
                let found: Result<Vec<(String, usize)>, String> = numbers
                    .map(|number| Ok((number.to_string(), one(&format!("{before}{number}{after}"), columns)?)))
                    .collect();
                Ok(Found { columns: found?, per_joint: true })
            }
            None => match template.split_once(JOINT) {
                Some((before, after)) => like(template, before, after, columns),
                None => match one(template, columns) {
                    Ok(column) => Ok(Found { columns: vec![(String::new(), column)], per_joint: false }),
                    Err(error) => entries(template, columns).ok_or(error),
                },
            },
        },
    }
}

/// `{2..8}` in a template, with what stands around it.
fn placeholder(template: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = template.split_once('{')?;
    let (range, after) = rest.split_once('}')?;
    range.contains("..").then_some((before, range, after))
}

fn range_of(range: &str) -> Result<std::ops::RangeInclusive<usize>, String> {
    let numbers = range.split_once("..").and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
    match numbers {
        Some((first, last)) if first <= last && last - first < MAX_JOINTS => Ok(first..=last),
        _ => Err(format!("{{{range}}} is no range of joints; allowed: {{first..last}}, up to {MAX_JOINTS} numbers")),
    }
}

/// The column of a name, with or without its unit.
fn one(name: &str, columns: &[Column]) -> Result<usize, String> {
    for same in [
        |column: &Column, name: &str| column.name == name,
        |column: &Column, name: &str| without_unit(&column.name).0 == name,
    ] {
        let mut found = columns.iter().enumerate().filter(|(_, column)| same(column, name)).map(|(index, _)| index);
        match (found.next(), found.next()) {
            (Some(first), None) => return Ok(first),
            (Some(first), Some(second)) => {
                return Err(format!(
                    "column `{}` occurs twice, as columns {} and {}",
                    visible(name),
                    first + 1,
                    second + 1
                ));
            }
            (None, _) => {}
        }
    }
    Err(format!("no column `{}`", visible(name)))
}

/// All entries of a list.
fn entries(name: &str, columns: &[Column]) -> Option<Found> {
    let of_list = |(_, column): &(usize, &Column)| column.list.as_deref() == Some(name);
    let found: Vec<(String, usize)> = columns
        .iter()
        .enumerate()
        .filter(of_list)
        .enumerate()
        .map(|(entry, (index, _))| (entry.to_string(), index))
        .collect();
    (!found.is_empty()).then_some(Found { columns: found, per_joint: true })
}

/// Every column of a form.
fn like(template: &str, before: &str, after: &str, columns: &[Column]) -> Result<Found, String> {
    let mut found: Vec<(String, usize)> = Vec::new();
    for (index, column) in columns.iter().enumerate() {
        let label = |name: &str| -> Option<String> {
            let label = name.strip_prefix(before)?.strip_suffix(after)?;
            (!label.is_empty()).then(|| label.to_owned())
        };
        let Some(label) = label(without_unit(&column.name).0).or_else(|| label(&column.name)) else { continue };
        if let Some((_, first)) = found.iter().find(|(known, _)| *known == label) {
            return Err(format!(
                "column `{}` occurs twice, as columns {} and {}",
                visible(&column.name),
                first + 1,
                index + 1
            ));
        }
        found.push((label, index));
    }
    if found.is_empty() {
        return Err(format!("no column of the form `{}`", visible(template)));
    }
    Ok(Found { columns: found, per_joint: true })
}

/// How joints are told apart in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Labels {
    /// By the names that the arm's joints have.
    KnownNames,
    /// By numbers, the first being 0 or 1 (or what a range says).
    Numbers(usize),
    /// By names, ordered base to tool.
    Names,
    /// One joint.
    One,
}

impl fmt::Display for Labels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::KnownNames => f.write_str("joints by their given names"),
            Self::Numbers(first) => write!(f, "joints numbered from {first}"),
            Self::Names => f.write_str("joints by name, base to tool"),
            Self::One => f.write_str("one joint"),
        }
    }
}

/// The labels of the joints, base to tool.
pub(crate) fn ordered(found: &Found, columns: &[Column], known: &[String]) -> Result<(Vec<String>, Labels), String> {
    if !found.per_joint {
        return Ok((vec![String::new()], Labels::One));
    }
    let labels: Vec<String> = found.columns.iter().map(|(label, _)| label.clone()).collect();
    if !known.is_empty() {
        let named: Option<Vec<String>> = known.iter().map(|name| named_by(name, found, columns)).collect();
        if let Some(named) = named.filter(|named| (1..named.len()).all(|k| !named[..k].contains(&named[k]))) {
            return Ok((named, Labels::KnownNames));
        }
    }
    let (labels, kind) = by_number_or_name(&labels)?;
    let count = labels.len();
    if !(1..=MAX_JOINTS).contains(&count) {
        return Err(format!("{count} joints; allowed: 1 to {MAX_JOINTS}"));
    }
    Ok((labels, kind))
}

/// The label of the column that names a joint.
fn named_by(name: &str, found: &Found, columns: &[Column]) -> Option<String> {
    if let Some((label, _)) = found.columns.iter().find(|(label, _)| label == name) {
        return Some(label.clone());
    }
    let whole = |column: &str| -> bool {
        column.match_indices(name).any(|(at, _)| {
            let free = |letter: Option<char>| letter.is_none_or(|letter| !letter.is_alphanumeric());
            free(column[..at].chars().next_back()) && free(column[at + name.len()..].chars().next())
        })
    };
    let mut hits = found.columns.iter().filter(|(_, column)| whole(&columns[*column].name));
    match (hits.next(), hits.next()) {
        (Some((label, _)), None) => Some(label.clone()),
        _ => None,
    }
}

/// Numbers without a gap, or names in the order of `joint_order`.
pub(crate) fn by_number_or_name(labels: &[String]) -> Result<(Vec<String>, Labels), String> {
    let mut numbers: Vec<(usize, &String)> =
        labels.iter().filter_map(|label| Some((label.parse::<usize>().ok()?, label))).collect();
    if numbers.is_empty() {
        let names: Vec<String> = labels.iter().filter(|label| !is_tool(label)).cloned().collect();
        return Ok((arm_joints(&names), Labels::Names));
    }
    numbers.sort_unstable();
    let first = numbers[0].0;
    if (0..numbers.len()).any(|k| numbers[k].0 != first + k) || (first > 1 && labels.len() != numbers.len()) {
        let listed = numbers.iter().map(|(number, _)| number.to_string()).collect::<Vec<_>>().join(", ");
        return Err(format!("joints {listed} have a gap; say which with {{first..last}}"));
    }
    Ok((numbers.into_iter().map(|(_, label)| label.clone()).collect(), Labels::Numbers(first)))
}

/// The columns of a quantity in the order of the joints.
pub(crate) fn in_order(found: &Found, labels: &[String], kind: Labels) -> Result<Vec<usize>, String> {
    let at = |label: &String| found.columns.iter().find(|(known, _)| known == label).map(|(_, column)| *column);
    if let Some(columns) = labels.iter().map(at).collect::<Option<Vec<usize>>>()
        && (matches!(kind, Labels::KnownNames | Labels::Names) || found.columns.len() == labels.len())
    {
        return Ok(columns);
    }
    // One quantity may count from 0 and another from 1, or say names where the other says numbers.
    let wanted = labels.len();
    let own = if found.per_joint {
        let all: Vec<String> = found.columns.iter().map(|(label, _)| label.clone()).collect();
        by_number_or_name(&all)?.0
    } else {
        vec![String::new()]
    };
    if own.len() != wanted || (matches!(kind, Labels::Names | Labels::KnownNames) && wanted > 1) {
        let missing: Vec<&str> = labels.iter().filter(|label| at(label).is_none()).map(String::as_str).collect();
        let named = if missing.is_empty() { String::new() } else { format!(", none for {}", missing.join(", ")) };
        return Err(format!("{} columns, q has {wanted}{named}", own.len()));
    }
    own.iter().map(|label| at(label).ok_or_else(|| format!("no column for joint {label}"))).collect()
}

/// The error of a map against a file.
pub(crate) fn no_such(path: &std::path::Path, entry: &str, detail: &str, columns: &[Column]) -> LogError {
    let detail = format!("{entry}: {detail}; columns: {}", listed(columns));
    LogError::NotRead { path: path.to_path_buf(), detail }
}

/// The names of columns; entries of lists as one, and not more than fit a screen.
pub(crate) fn listed(columns: &[Column]) -> String {
    const MOST: usize = 60;
    let mut names: Vec<String> = Vec::new();
    for column in columns {
        if names.len() > MOST {
            break;
        }
        let name = match &column.list {
            Some(list) => {
                let entries = columns.iter().filter(|other| other.list.as_ref() == Some(list)).count();
                format!("{list}[0..{}]", entries.saturating_sub(1))
            }
            None => column.shown().to_owned(),
        };
        if names.last() != Some(&name) {
            names.push(name);
        }
    }
    let more = if names.len() > MOST { ", …" } else { "" };
    names.truncate(MOST);
    names.iter().map(|name| visible(name)).collect::<Vec<_>>().join(", ") + more
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::foreign::table::Kind;

    fn columns(names: &[&str]) -> Vec<Column> {
        names.iter().map(|name| Column::new(*name, Kind::Number)).collect()
    }

    fn order(template: &str, names: &[&str], known: &[&str]) -> Result<(Vec<usize>, Labels), String> {
        let (columns, known) = (columns(names), known.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        let found = find(&Columns::Template(template.to_owned()), &columns)?;
        let (labels, kind) = ordered(&found, &columns, &known)?;
        Ok((in_order(&found, &labels, kind)?, kind))
    }

    #[test]
    fn joints_stand_base_to_tool() {
        assert_eq!(
            order("p{joint}", &["t", "p2 [deg]", "p10", "p1"], &[]),
            Err("joints 1, 2, 10 have a gap; say which with {first..last}".into())
        );
        assert_eq!(order("p{joint}", &["t", "p1", "p0", "p_gripper"], &[]), Ok((vec![2, 1], Labels::Numbers(0))));
        assert_eq!(order("c{2..3}", &["c1", "c2", "c3", "c4"], &[]), Ok((vec![1, 2], Labels::Numbers(2))));
        let ur = ["elbow_joint", "wrist_1_joint", "shoulder_pan_joint"];
        assert_eq!(order("{joint}", &ur, &[]), Ok((vec![2, 0, 1], Labels::Names)));
        assert_eq!(order("{joint}", &["b", "a"], &["a", "b"]), Ok((vec![1, 0], Labels::KnownNames)));
        assert_eq!(order("/js/{joint}/x", &["/js/b/x", "/js/a/x"], &["a"]), Ok((vec![1], Labels::KnownNames)));
    }
}
