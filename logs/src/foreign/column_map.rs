//! Which columns of a foreign table are which quantity: what `--map` says.
//!
//! ```text
//! time=stamp[ms],q=pos_{joint}[deg],dq=vel_{joint}[deg/s],tau=cur_{joint}[mA*0.11:0.11:0.08]
//! {joint}   name or number of the joint           {0..5}    only these numbers            a+b+c   columns one by one; of time: added
//! joint=COLUMN  names the joint of each row (a long table) or, with {joint}, of each column     joints=a+b+c  names base to tool
//! episode=3     rows of one episode               topic=/joint_states  of a bag           rate=500  rows per second, where no time is logged
//! ```
//!
//! A column without `{joint}` that holds lists, or an array, stands for all its entries; `name[0]` is one of them. Units in brackets at the
//! end: see [`Unit`]. As a file (YAML) a map says more: signs and offsets per joint (see `map_yaml`).

use std::fmt;
use std::str::FromStr;

use tribo_files::LogError;

use super::unit::Unit;
use crate::quantity::Quantity;

/// The longest text of a map (bytes).
const LONGEST: usize = 1 << 16;

/// The columns of one quantity.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Columns {
    /// A name, with or without `{joint}` or `{a..b}`.
    Template(String),
    /// Joint by joint.
    List(Vec<String>),
}

impl fmt::Display for Columns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let quoted = |name: &str| if name.contains([',', '+', '=']) { format!("\"{name}\"") } else { name.to_owned() };
        match self {
            Self::Template(name) => f.write_str(&quoted(name)),
            Self::List(names) => f.write_str(&names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join("+")),
        }
    }
}

/// Where a quantity comes from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub columns: Columns,
    /// `None`: that of the header, else ours.
    pub unit: Option<Unit>,
    /// `SI = factor · (sign · x + offset) + shift`; empty, one for all joints, or one for each.
    pub sign: Vec<f64>,
    /// In the unit of the column.
    pub offset: Vec<f64>,
}

impl Entry {
    /// Columns in the unit that their header says.
    pub fn of(columns: Columns) -> Self {
        Self { columns, unit: None, sign: Vec::new(), offset: Vec::new() }
    }
}

/// Which columns of a foreign table are which quantity.
///
/// Made from text (`"q=pos_{joint}[deg],tau=eff_{joint},time=stamp".parse()`), or from YAML ([`ColumnMap::from_yaml`]); its
/// `Display` is the text again, without signs and offsets.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ColumnMap {
    pub(crate) entries: Vec<(Quantity, Entry)>,
    /// Column, or columns, that name joints.
    pub(crate) joint: Option<String>,
    /// Names in the file, base to tool.
    pub(crate) joints: Vec<String>,
    /// Column of episodes, where it is said, and which one.
    pub(crate) episode: Option<(Option<String>, i64)>,
    /// Topic of a bag.
    pub(crate) topic: Option<String>,
    /// Rows per second.
    pub(crate) rate_hz: Option<f64>,
}

/// The names of quantities in maps.
pub(crate) const KEYS: [(Quantity, &str); 12] = [
    (Quantity::Time, "time"),
    (Quantity::Position, "q"),
    (Quantity::Velocity, "dq"),
    (Quantity::Torque, "tau"),
    (Quantity::TorqueDesired, "tau_d"),
    (Quantity::FrictionCompensation, "tau_friction"),
    (Quantity::LinkTorque, "tau_link"),
    (Quantity::MotorPosition, "theta"),
    (Quantity::MotorVelocity, "dtheta"),
    (Quantity::Temperature, "temperature"),
    (Quantity::TemperatureAmbient, "temperature_ambient"),
    (Quantity::ExternalWrench, "wrench"),
];

/// Everything that may stand before `=`.
pub(crate) fn allowed_keys() -> String {
    let others = ["joint", "joints", "episode", "topic", "rate"];
    KEYS.iter().map(|(_, key)| *key).chain(others).collect::<Vec<_>>().join(", ")
}

/// The quantity under a key: ours or the canonical name.
pub(crate) fn quantity_of(key: &str) -> Option<Quantity> {
    let named = |(quantity, name): &(Quantity, &str)| *name == key || quantity.label() == key;
    KEYS.iter().find(|known| named(known)).map(|(quantity, _)| *quantity)
}

/// The key of a quantity.
pub(crate) fn key_of(quantity: Quantity) -> &'static str {
    KEYS.iter().find(|(known, _)| *known == quantity).map_or("", |(_, key)| key)
}

impl ColumnMap {
    /// Where a quantity comes from.
    pub(crate) fn entry(&self, quantity: Quantity) -> Option<&Entry> {
        self.entries.iter().find(|(known, _)| *known == quantity).map(|(_, entry)| entry)
    }

    /// Whether it says where everything is that a log needs.
    pub(crate) fn is_complete(&self) -> bool {
        let has = |quantity| self.entry(quantity).is_some();
        has(Quantity::Position) && has(Quantity::Torque) && (has(Quantity::Time) || self.rate_hz.is_some())
    }

    /// Topic and joints, where the map says nothing else.
    pub(crate) fn of_bag(&self) -> Option<(Option<&str>, &[String])> {
        let plain = self.entries.is_empty() && self.joint.is_none() && self.episode.is_none() && self.rate_hz.is_none();
        plain.then_some((self.topic.as_deref(), &self.joints))
    }

    /// Adds a quantity.
    pub(crate) fn insert(&mut self, quantity: Quantity, entry: Entry) -> Result<(), String> {
        if self.entry(quantity).is_some() {
            return Err(format!("{} is given twice", key_of(quantity)));
        }
        self.entries.push((quantity, entry));
        self.entries.sort_by_key(|(quantity, _)| *quantity);
        Ok(())
    }

    /// Says the unit of a quantity that had none.
    pub(crate) fn say_unit(&mut self, quantity: Quantity, unit: &str) {
        if let Some((_, entry)) = self.entries.iter_mut().find(|(known, _)| *known == quantity) {
            entry.unit = Unit::parse(unit, quantity).ok();
        }
    }

    /// Both maps as one.
    ///
    /// # Errors
    /// [`LogError::BadMap`] for what both say.
    pub fn and(mut self, other: Self) -> Result<Self, LogError> {
        let twice = |entry: &str| bad(entry, "is given twice".to_owned());
        for (quantity, entry) in other.entries {
            self.insert(quantity, entry).map_err(|detail| bad(key_of(quantity), detail))?;
        }
        fn either<T>(a: Option<T>, b: Option<T>, error: LogError) -> Result<Option<T>, LogError> {
            if a.is_some() && b.is_some() { Err(error) } else { Ok(a.or(b)) }
        }
        self.joint = either(self.joint, other.joint, twice("joint"))?;
        self.episode = either(self.episode, other.episode, twice("episode"))?;
        self.topic = either(self.topic, other.topic, twice("topic"))?;
        self.rate_hz = either(self.rate_hz, other.rate_hz, twice("rate"))?;
        match (self.joints.is_empty(), other.joints.is_empty()) {
            (false, false) => return Err(twice("joints")),
            (true, _) => self.joints = other.joints,
            (false, true) => {}
        }
        Ok(self)
    }

    /// Takes one `key=value`.
    fn take(&mut self, text: &str) -> Result<(), String> {
        let Some((key, value)) = text.split_once('=').map(|(key, value)| (key.trim(), value.trim())) else {
            return Err("is no KEY=COLUMN".to_owned());
        };
        if value.is_empty() {
            return Err("names no column".to_owned());
        }
        if let Some(quantity) = quantity_of(key) {
            return self.insert(quantity, entry(value, quantity)?);
        }
        let unquoted = value.trim_matches('"');
        match key {
            "joint" if self.joint.is_none() => self.joint = Some(unquoted.to_owned()),
            "topic" if self.topic.is_none() => self.topic = Some(unquoted.to_owned()),
            "joints" if self.joints.is_empty() => self.joints = names(value),
            "rate" if self.rate_hz.is_none() => self.rate_hz = Some(rate(value)?),
            "episode" if self.episode.is_none() => self.episode = Some(episode(unquoted)?),
            "joint" | "topic" | "joints" | "rate" | "episode" => return Err("is given twice".to_owned()),
            _ => return Err(format!("`{key}` is no quantity; allowed: {}", allowed_keys())),
        }
        Ok(())
    }
}

/// `500`, rows per second.
pub(crate) fn rate(text: &str) -> Result<f64, String> {
    let rate = text.parse::<f64>().ok().filter(|rate| *rate > 0.0 && rate.is_finite());
    rate.ok_or_else(|| format!("`{text}` is no rate (Hz); allowed: greater than 0"))
}

/// `3` or `episode_index:3`.
fn episode(text: &str) -> Result<(Option<String>, i64), String> {
    let (column, number) =
        text.rsplit_once(':').map_or((None, text), |(column, number)| (Some(column.to_owned()), number));
    let number = number.trim().parse().map_err(|_| format!("`{number}` is no number of an episode"))?;
    Ok((column, number))
}

/// Names separated by plus signs.
fn names(text: &str) -> Vec<String> {
    split(text, '+')
        .into_iter()
        .map(|name| name.trim().trim_matches('"').to_owned())
        .filter(|name| !name.is_empty())
        .collect()
}

/// Columns and unit.
pub(crate) fn entry(value: &str, quantity: Quantity) -> Result<Entry, String> {
    let (columns, unit) = match value.strip_suffix(']').and_then(|start| start.rsplit_once('[')) {
        Some((columns, unit)) if !unit.contains(['{', '}']) && !is_index(unit) => {
            (columns.trim(), Some(Unit::parse(unit.trim(), quantity)?))
        }
        _ => (value, None),
    };
    let mut list = names(columns);
    let columns = match (list.len(), list.pop()) {
        (_, None) => return Err("names no column".to_owned()),
        (1, Some(name)) => Columns::Template(name),
        (_, Some(last)) => {
            list.push(last);
            Columns::List(list)
        }
    };
    Ok(Entry { unit, ..Entry::of(columns) })
}

fn is_index(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// The parts between separators outside of quotes and square brackets.
fn split(text: &str, separator: char) -> Vec<&str> {
    let (mut parts, mut start, mut depth, mut quoted) = (Vec::new(), 0, 0_usize, false);
    for (at, letter) in text.char_indices() {
        match letter {
            '"' => quoted = !quoted,
            '[' if !quoted => depth += 1,
            ']' if !quoted => depth = depth.saturating_sub(1),
            _ if letter == separator && !quoted && depth == 0 => {
                parts.push(&text[start..at]);
                start = at + letter.len_utf8();
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

/// An error of a map.
pub(crate) fn bad(entry: &str, detail: String) -> LogError {
    LogError::BadMap { entry: tribo_files::shown(entry.as_bytes()), detail }
}

impl FromStr for ColumnMap {
    type Err = LogError;

    /// Reads `q=pos_{joint}[deg],tau=eff_{joint},time=stamp`.
    ///
    /// # Errors
    /// [`LogError::BadMap`] with the entry and what is allowed.
    fn from_str(text: &str) -> Result<Self, LogError> {
        if text.len() > LONGEST {
            return Err(bad(text, format!("{} bytes; allowed: up to {LONGEST}", text.len())));
        }
        let mut map = Self::default();
        for part in split(text, ',').into_iter().map(str::trim).filter(|part| !part.is_empty()) {
            map.take(part).map_err(|detail| bad(part, detail))?;
        }
        if map == Self::default() {
            return Err(bad(
                text,
                "says nothing; write for instance q=pos_{joint}[deg],tau=eff_{joint},time=stamp".to_owned(),
            ));
        }
        Ok(map)
    }
}

impl fmt::Display for ColumnMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        for (quantity, entry) in &self.entries {
            let unit = entry.unit.as_ref().map_or(String::new(), |unit| format!("[{}]", unit.text()));
            parts.push(format!("{}={}{unit}", key_of(*quantity), entry.columns));
        }
        parts.extend(self.joint.iter().map(|column| format!("joint={column}")));
        if !self.joints.is_empty() {
            parts.push(format!("joints={}", self.joints.join("+")));
        }
        parts.extend(self.episode.iter().map(|(column, number)| match column {
            Some(column) => format!("episode={column}:{number}"),
            None => format!("episode={number}"),
        }));
        parts.extend(self.topic.iter().map(|topic| format!("topic={topic}")));
        parts.extend(self.rate_hz.iter().map(|rate| format!("rate={rate}")));
        f.write_str(&parts.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_and_its_text_are_inverse() {
        for text in [
            "time=stamp[ms],q=pos_{joint}[deg],dq=vel_{joint},tau=cur_{joint}[mA*0.11,0.12]",
            "time=sec+nanosec,q=a+b,tau=\"x,1\"+\"y+2\",joints=c+d,episode=episode_index:3,rate=500",
            "q=observation.state[{0..5}],tau=effort[3],joint=name,topic=/joint_states",
        ] {
            let map: ColumnMap = text.parse().unwrap();
            assert_eq!(map.to_string(), text);
            assert_eq!(map.to_string().parse::<ColumnMap>().unwrap(), map);
        }
        let canonical: ColumnMap = " tau_J = e , O_F_ext = w".parse().unwrap();
        assert_eq!(canonical.to_string(), "tau=e,wrench=w");
    }

    #[test]
    fn errors_name_the_entry_and_what_is_allowed() {
        for (text, expected) in [
            ("", "column map ``: says nothing"),
            ("q", "column map `q`: is no KEY=COLUMN"),
            ("q=", "column map `q=`: names no column"),
            ("x=y", "column map `x=y`: `x` is no quantity; allowed: time, q, dq, tau, tau_d"),
            ("q=a,q=b", "column map `q=b`: q is given twice"),
            ("q=a[grad]", "unit `grad` is not known; allowed for q_i: rad, deg, rev, raw*FACTOR"),
            ("tau=i[A]", "is a current, which is worth a torque only with a torque constant"),
            ("rate=0", "`0` is no rate (Hz); allowed: greater than 0"),
            ("episode=x", "`x` is no number of an episode"),
        ] {
            let error = text.parse::<ColumnMap>().unwrap_err().to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
        let both = "q=a".parse::<ColumnMap>().unwrap().and("q=b".parse().unwrap());
        assert!(both.unwrap_err().to_string().contains("q is given twice"));
    }
}
