//! A column map out of the names in a table, or why there is none.
//!
//! ```text
//! names --words--> meaning, origin --form--> groups (pos_{joint}) --one of each?--> map
//! ```
//!
//! Nothing is chosen where two columns may be meant: two torques, two positions, a current without its torque constant. Then the answer is
//! the sentence that shows them, with the map that would do. Units are those that names say.

use std::collections::HashMap;

use super::column_map::{ColumnMap, Columns, Entry};
use super::table::{Column, Kind};
use super::unit::{Dimension, Unit};
use super::words::{Meaning, Origin, is_tool, meaning, unit_in};
use crate::quantity::Quantity;

/// Columns of one form.
#[derive(Debug, Clone, PartialEq)]
struct Group {
    columns: Columns,
    members: Vec<usize>,
    origin: Origin,
}

/// Why there is no map, and what would be one.
#[derive(Debug)]
pub(crate) struct Undecided {
    pub why: String,
    /// The text of a map that would do, once capital words are filled in.
    pub map: String,
}

/// What the names say beside what is `given`. The map of an answer without decision has both.
pub(crate) fn propose(columns: &[Column], known: &[String], given: &ColumnMap) -> Result<ColumnMap, Undecided> {
    let open = |quantity: Quantity| given.entry(quantity).is_none();
    let groups = |wanted: Meaning| groups_of(columns, wanted, known);
    let mut why = Vec::new();
    let mut map = ColumnMap::default();
    let mut parts = Vec::new();

    // Time.
    match time_of(columns) {
        _ if !open(Quantity::Time) || given.rate_hz.is_some() => {}
        Ok(time) => add(&mut map, Quantity::Time, time, columns, &mut parts),
        Err(reason) => {
            why.push(reason);
            parts.push("time=COLUMN".to_owned());
        }
    }

    // Positions, and velocities if there are any.
    let positions = measured(groups(Meaning::Position));
    let velocities = measured(groups(Meaning::Velocity));
    for (quantity, found, needed) in [(Quantity::Position, &positions, true), (Quantity::Velocity, &velocities, false)]
    {
        match found.as_slice() {
            _ if !open(quantity) => {}
            [group] => add(&mut map, quantity, group.clone(), columns, &mut parts),
            [] if needed => {
                why.push("no column is understood as joint positions".to_owned());
                parts.push("q=COLUMNS".to_owned());
            }
            [] => {}
            [first, ..] => {
                why.push(format!("several columns may be {quantity}: {}", forms(found)));
                add(&mut ColumnMap::default(), quantity, first.clone(), columns, &mut parts);
            }
        }
    }

    // Torques.
    let all = groups(Meaning::Torque);
    let (commanded, torques): (Vec<Group>, Vec<Group>) =
        all.into_iter().partition(|group| group.origin == Origin::Commanded);
    let torques = measured(torques);
    let currents = measured(groups(Meaning::Current));
    let canonical = |group: &Group| group.columns == Columns::Template("tau_J_{joint}".to_owned());
    match (torques.as_slice(), commanded.as_slice()) {
        _ if !open(Quantity::Torque) => {}
        ([torque], []) => add(&mut map, Quantity::Torque, torque.clone(), columns, &mut parts),
        ([torque], [desired]) if canonical(torque) => {
            add(&mut map, Quantity::Torque, torque.clone(), columns, &mut parts);
            add(&mut map, Quantity::TorqueDesired, desired.clone(), columns, &mut parts);
        }
        ([torque], [desired, ..]) => {
            let both: Vec<Group> = torques.iter().chain(&commanded).cloned().collect();
            why.push(format!("torques measured and commanded are there: {}", forms(&both)));
            let mut ignored = ColumnMap::default();
            add(&mut ignored, Quantity::Torque, torque.clone(), columns, &mut parts);
            add(&mut ignored, Quantity::TorqueDesired, desired.clone(), columns, &mut parts);
        }
        ([first, _, ..], _) => {
            why.push(format!("several columns may be the torque: {}", forms(&torques)));
            add(&mut ColumnMap::default(), Quantity::Torque, first.clone(), columns, &mut parts);
        }
        ([], desired) => {
            if let Some(current) = currents.first() {
                let unit = current.members.first().and_then(|&k| unit_of(&columns[k], Dimension::Torque));
                let unit = unit.filter(|unit| matches!(*unit, "A" | "mA")).unwrap_or("A");
                let or = if desired.is_empty() {
                    String::new()
                } else {
                    format!("; or the torques that were commanded ({})", forms(desired))
                };
                why.push(format!(
                    "no torque, but currents ({}): their torque constants are needed (Nm/A at the joint){or}",
                    forms(&currents)
                ));
                parts.push(format!("tau={}[{unit}*CONSTANT]", current.columns));
            } else if let Some(desired) = desired.first() {
                why.push(format!("the only torques are commanded ones ({})", forms(&commanded)));
                add(&mut ColumnMap::default(), Quantity::Torque, desired.clone(), columns, &mut parts);
            } else {
                why.push("no column is understood as joint torques, which a log needs (measured, or currents times torque constants)".to_owned());
                parts.push("tau=COLUMNS".to_owned());
            }
        }
    }

    // Names of joints, and what is worth taking along.
    if let Some(names) = groups(Meaning::Joint).into_iter().next().filter(|_| given.joint.is_none()) {
        let single = |group: Option<&Group>| group.is_some_and(|group| group.members.len() == 1);
        let text = names.members.iter().all(|&k| columns[k].kind == Kind::Text);
        let long = names.members.len() == 1 && single(positions.first());
        let wide = text && positions.first().is_some_and(|group| group.members.len() == names.members.len());
        if long || wide {
            let column = names.columns.to_string();
            parts.push(format!("joint={column}"));
            map.joint = Some(column);
        }
    }
    if let ([group], [position]) = (measured(groups(Meaning::Temperature)).as_slice(), positions.as_slice())
        && open(Quantity::Temperature)
        && group.members.len() == position.members.len()
    {
        add(&mut map, Quantity::Temperature, group.clone(), columns, &mut parts);
    }
    if why.is_empty() {
        return Ok(map);
    }
    if *given != ColumnMap::default() {
        parts.push(given.to_string());
    }
    Err(Undecided { why: why.join("; "), map: parts.join(",") })
}

/// Puts a group into the map, with the unit that its names say.
fn add(map: &mut ColumnMap, quantity: Quantity, group: Group, columns: &[Column], parts: &mut Vec<String>) {
    let dimension = Dimension::of(quantity);
    let unit = group.members.first().zip(dimension).and_then(|(&k, dimension)| unit_of(&columns[k], dimension));
    let unit = unit.and_then(|unit| Unit::parse(unit, quantity).ok());
    let mut alone = ColumnMap::default();
    // Seconds and nanoseconds beside each other have a unit each.
    let entry =
        Entry { unit: unit.filter(|_| quantity != Quantity::Time || !summed(&group)), ..Entry::of(group.columns) };
    for into in [map, &mut alone] {
        // Each quantity is added once.
        let _ = into.insert(quantity, entry.clone());
    }
    parts.push(alone.to_string());
}

fn summed(group: &Group) -> bool {
    matches!(group.columns, Columns::List(_))
}

/// The unit that type or name of a column says.
pub(crate) fn unit_of(column: &Column, dimension: Dimension) -> Option<&'static str> {
    column.unit.or_else(|| unit_in(&column.name, dimension))
}

/// The groups that are closest to a measurement.
fn measured(groups: Vec<Group>) -> Vec<Group> {
    let best = groups.iter().map(|group| group.origin).min();
    groups.into_iter().filter(|group| Some(group.origin) == best).collect()
}

fn forms(groups: &[Group]) -> String {
    groups.iter().map(|group| group.columns.to_string()).collect::<Vec<_>>().join(", ")
}

/// The clock: the only one, or the only one whose name says nothing else.
fn time_of(columns: &[Column]) -> Result<Group, String> {
    let of = |wanted: Meaning| -> Vec<usize> {
        let means = |k: &usize| {
            columns[*k].kind == Kind::Number && meaning(&columns[*k].name).is_some_and(|(found, _)| found == wanted)
        };
        (0..columns.len()).filter(means).collect()
    };
    let single = |k: usize| Group {
        columns: Columns::Template(bare_template(&columns[k].name)),
        members: vec![k],
        origin: Origin::Plain,
    };
    let (clocks, seconds, nanoseconds) = (of(Meaning::Time), of(Meaning::Seconds), of(Meaning::Nanoseconds));
    let pair = match (seconds.as_slice(), nanoseconds.as_slice()) {
        ([sec], [nsec]) => Some(Group {
            columns: Columns::List(vec![columns[*sec].name.clone(), columns[*nsec].name.clone()]),
            members: vec![*sec, *nsec],
            origin: Origin::Plain,
        }),
        _ => None,
    };
    let plain: Vec<usize> = clocks.iter().copied().filter(|&k| is_plain_clock(&columns[k].name)).collect();
    match (clocks.as_slice(), plain.as_slice(), pair) {
        ([clock], _, None) | (_, [clock], _) => Ok(single(*clock)),
        ([], _, Some(pair)) => Ok(pair),
        ([], _, None) if seconds.len() == 1 && nanoseconds.is_empty() => Ok(single(seconds[0])),
        ([], _, None) => Err("no column is understood as time (without one: rate=HZ)".to_owned()),
        (several, ..) => {
            let names: Vec<&str> = several.iter().map(|&k| columns[k].name.as_str()).collect();
            Err(format!("several columns may be the time: {}", names.join(", ")))
        }
    }
}

fn is_plain_clock(name: &str) -> bool {
    let (bare, _) = super::words::without_unit(name);
    let bare = bare.trim_matches(|letter: char| !letter.is_alphanumeric()).to_lowercase();
    matches!(bare.as_str(), "time" | "t" | "timestamp" | "stamp")
}

/// The columns of a meaning, put together by their form.
fn groups_of(columns: &[Column], wanted: Meaning, known: &[String]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for origin in [Origin::Measured, Origin::Plain, Origin::Commanded] {
        let mut members: Vec<usize> = Vec::new();
        for (k, column) in columns.iter().enumerate() {
            let fits = meaning(&column.name) == Some((wanted, origin)) && !is_tool(&column.name);
            let kind = column.kind == Kind::Number || wanted == Meaning::Joint;
            if !(fits && kind) {
                continue;
            }
            match &column.list {
                Some(list) => {
                    let template = Columns::Template(list.clone());
                    match groups.iter_mut().find(|group| group.columns == template) {
                        Some(group) => group.members.push(k),
                        None => groups.push(Group { columns: template, members: vec![k], origin }),
                    }
                }
                None => members.push(k),
            }
        }
        groups.extend(by_form(columns, members, origin, known));
    }
    groups
}

/// Words in the names of joints without numbers.
const JOINT_WORDS: [&str; 4] = ["shoulder", "elbow", "wrist", "base"];

fn by_form(columns: &[Column], members: Vec<usize>, origin: Origin, known: &[String]) -> Vec<Group> {
    let name = |k: usize| columns[k].name.as_str();
    let named = |k: &usize| {
        let lower = name(*k).to_lowercase();
        JOINT_WORDS.iter().any(|word| lower.contains(word))
            || known.iter().any(|joint| name(*k).contains(joint.as_str()))
    };
    if members.len() > 1
        && members.iter().all(named)
        && let Some(template) = around(&members.iter().map(|&k| name(k)).collect::<Vec<_>>())
    {
        return vec![Group { columns: Columns::Template(template), members, origin }];
    }
    let mut forms: Vec<Vec<usize>> = Vec::new();
    let mut place: HashMap<Vec<&str>, usize> = HashMap::new();
    for &k in &members {
        let at = *place.entry(form(name(k))).or_insert(forms.len());
        match forms.get_mut(at) {
            Some(alike) => alike.push(k),
            None => forms.push(vec![k]),
        }
    }
    let mut groups: Vec<Group> = Vec::new();
    for alike in forms {
        // The number that changes among the columns of one form; the last one where several do.
        let first = alike.first().map_or("", |&k| name(k));
        let runs = digit_runs(first);
        let varies = |run: usize| {
            let digits = |text: &str| digit_runs(text).get(run).and_then(|&(a, b)| text.get(a..b).map(str::to_owned));
            alike.iter().any(|&k| digits(name(k)) != digits(first))
        };
        let run = (0..runs.len()).rev().find(|&run| varies(run)).or_else(|| runs.len().checked_sub(1));
        let template = |text: &str| match run.and_then(|run| digit_runs(text).get(run).copied()) {
            Some((a, b)) => format!("{}{{joint}}{}", &text[..a], &text[b..]),
            None => text.to_owned(),
        };
        let mut of_form: HashMap<String, usize> = HashMap::new();
        for k in alike {
            let at = *of_form.entry(template(name(k))).or_insert_with_key(|template| {
                groups.push(Group { columns: Columns::Template(bare_template(template)), members: Vec::new(), origin });
                groups.len() - 1
            });
            groups[at].members.push(k);
        }
    }
    groups
}

/// A template without the unit that its columns carry in brackets.
fn bare_template(template: &str) -> String {
    super::words::without_unit(template).0.to_owned()
}

/// What stands between the numbers of a name.
fn form(name: &str) -> Vec<&str> {
    let (mut parts, mut start) = (Vec::new(), 0);
    for (a, b) in digit_runs(name) {
        parts.push(&name[start..a]);
        start = b;
    }
    parts.push(&name[start..]);
    parts
}

/// The runs of digits of a name, as byte ranges.
fn digit_runs(name: &str) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (at, _) in name.bytes().enumerate().filter(|(_, byte)| byte.is_ascii_digit()) {
        match runs.last_mut() {
            Some(run) if run.1 == at => run.1 = at + 1,
            _ => runs.push((at, at + 1)),
        }
    }
    runs
}

/// What all names have in common around the joint, cut at words.
fn around(names: &[&str]) -> Option<String> {
    let first = *names.first()?;
    let bound = |letter: char| !letter.is_alphanumeric();
    let mut before = first.len();
    let mut after = first.len();
    for name in names {
        let common = first.bytes().zip(name.bytes()).take_while(|(a, b)| a == b).count();
        before = before.min(common);
        let common = first.bytes().rev().zip(name.bytes().rev()).take_while(|(a, b)| a == b).count();
        after = after.min(common);
    }
    let before = first.get(..before).and_then(|start| start.rfind(bound)).map_or(0, |at| at + 1);
    let tail = first.get(first.len() - after..)?;
    let after = tail.find(bound).map_or("", |at| &tail[at..]);
    // `_joint` belongs to the name.
    let after = after.strip_prefix("_joint").filter(|rest| rest.chars().next().is_none_or(bound)).unwrap_or(after);
    let start = first.get(..before)?;
    let fits = names.iter().all(|name| name.len() > start.len() + after.len());
    fits.then(|| format!("{start}{{joint}}{after}"))
}
