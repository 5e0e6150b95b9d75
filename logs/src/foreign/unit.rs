//! Units of foreign columns, and what they are worth in ours.
//!
//! ```text
//! SI = factor · x + shift          s ms us ns | rad deg rev | rad/s deg/s rpm | Nm mNm | A mA (· Nm/A) | degC K | raw · factor
//! ```
//!
//! `A*0.11` and `mA*0.11:0.11:0.08` are currents times a torque constant at the joint (Nm/A), one for all joints or one for each; `raw*0.001`
//! is any count times a factor. Names are those of headers too: `Time (ms)`, `q1 [deg]`.

use crate::quantity::Quantity;

/// What a column measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    Time,
    Angle,
    AngularVelocity,
    Torque,
    Current,
    Temperature,
}

impl Dimension {
    /// What a quantity of ours measures; `None` for the wrench, which has two.
    pub fn of(quantity: Quantity) -> Option<Self> {
        match quantity {
            Quantity::Time => Some(Self::Time),
            Quantity::Position | Quantity::MotorPosition => Some(Self::Angle),
            Quantity::Velocity | Quantity::MotorVelocity => Some(Self::AngularVelocity),
            Quantity::Torque | Quantity::TorqueDesired | Quantity::FrictionCompensation | Quantity::LinkTorque => {
                Some(Self::Torque)
            }
            Quantity::Temperature | Quantity::TemperatureAmbient => Some(Self::Temperature),
            Quantity::ExternalWrench => None,
        }
    }
}

/// Name, spellings in lower case, dimension, factor, shift.
type Known = (&'static str, &'static [&'static str], Dimension, f64, f64);

const KNOWN: [Known; 14] = [
    ("s", &["s", "sec", "secs", "second", "seconds"], Dimension::Time, 1.0, 0.0),
    ("ms", &["ms", "msec", "millis", "milliseconds"], Dimension::Time, 1e-3, 0.0),
    ("us", &["us", "µs", "μs", "usec", "micros", "microseconds"], Dimension::Time, 1e-6, 0.0),
    ("ns", &["ns", "nsec", "nsecs", "nanos", "nanosec", "nanoseconds"], Dimension::Time, 1e-9, 0.0),
    ("rad", &["rad", "rads", "radian", "radians"], Dimension::Angle, 1.0, 0.0),
    ("deg", &["deg", "degs", "degree", "degrees", "°"], Dimension::Angle, std::f64::consts::PI / 180.0, 0.0),
    ("rev", &["rev", "revs", "turn", "turns"], Dimension::Angle, std::f64::consts::TAU, 0.0),
    ("rad/s", &["rad/s", "rad/sec", "rad s^-1"], Dimension::AngularVelocity, 1.0, 0.0),
    (
        "deg/s",
        &["deg/s", "deg/sec", "degree/s", "degrees/s", "°/s", "dps"],
        Dimension::AngularVelocity,
        std::f64::consts::PI / 180.0,
        0.0,
    ),
    ("rpm", &["rpm", "rev/min", "1/min"], Dimension::AngularVelocity, std::f64::consts::PI / 30.0, 0.0),
    ("Nm", &["nm", "n·m", "n*m", "n.m", "n m"], Dimension::Torque, 1.0, 0.0),
    ("mNm", &["mnm", "mn·m", "mn*m", "mn.m"], Dimension::Torque, 1e-3, 0.0),
    ("degC", &["degc", "°c", "c", "celsius"], Dimension::Temperature, 1.0, 0.0),
    ("K", &["k", "kelvin"], Dimension::Temperature, 1.0, -273.15),
];

/// Currents, worth a torque with a constant only.
const CURRENTS: [(&str, &[&str], f64); 2] =
    [("A", &["a", "amp", "amps", "ampere", "amperes"], 1.0), ("mA", &["ma", "milliamp", "milliamps"], 1e-3)];

/// Any count.
const RAW: &str = "raw";

/// The name and dimension of a unit as headers spell it.
pub(crate) fn spelled(text: &str) -> Option<(&'static str, Dimension)> {
    let lower = text.trim().to_lowercase();
    let known = KNOWN.iter().find(|known| known.1.contains(&lower.as_str())).map(|known| (known.0, known.2));
    known.or_else(|| {
        CURRENTS.iter().find(|known| known.1.contains(&lower.as_str())).map(|known| (known.0, Dimension::Current))
    })
}

/// Unit of a quantity's columns: `SI = factor_j · x + shift`.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// As it is written in a map.
    text: String,
    /// One for all joints, or one for each.
    factors: Vec<f64>,
    shift: f64,
}

impl Unit {
    /// Reads `deg`, `ms`, `A*0.11`, `raw*0.001:0.002`; the error says what is allowed.
    pub(crate) fn parse(text: &str, quantity: Quantity) -> Result<Self, String> {
        let refused = |why: &str| Err(format!("unit `{text}` {why}; allowed for {quantity}: {}", allowed(quantity)));
        let dimension = Dimension::of(quantity);
        let Some((name, constants)) =
            text.split_once(['*', '·', '×']).filter(|(name, _)| spelled(text).is_none() && !name.is_empty())
        else {
            let lower = text.trim().to_lowercase();
            let known = KNOWN.iter().find(|known| known.1.contains(&lower.as_str()) && Some(known.2) == dimension);
            return match (known, spelled(text)) {
                (Some(&(name, _, _, factor, shift)), _) => {
                    Ok(Self { text: name.to_owned(), factors: vec![factor], shift })
                }
                (None, Some((_, Dimension::Current))) if dimension == Some(Dimension::Torque) => {
                    refused("is a current, which is worth a torque only with a torque constant")
                }
                (None, Some(_)) => refused("measures something else"),
                (None, None) => refused("is not known"),
            };
        };
        let lower = name.trim().to_lowercase();
        let of_one = match CURRENTS.iter().find(|known| known.1.contains(&lower.as_str())) {
            Some(&(_, _, factor)) if dimension == Some(Dimension::Torque) => factor,
            None if lower == RAW => 1.0,
            _ => return refused("takes no factor"),
        };
        let mut factors = Vec::new();
        for constant in constants.split([',', ':', ' ']).map(str::trim).filter(|part| !part.is_empty()) {
            match constant.parse::<f64>() {
                Ok(value) if value.is_finite() && value != 0.0 => factors.push(of_one * value),
                _ => return refused("has a factor that is no number other than 0"),
            }
        }
        if factors.is_empty() {
            return refused("has no factor");
        }
        Ok(Self { text: text.to_owned(), factors, shift: 0.0 })
    }

    /// The unit of ours.
    pub(crate) fn si(quantity: Quantity) -> Self {
        Self { text: quantity.unit().to_owned(), factors: vec![1.0], shift: 0.0 }
    }

    /// How many joints it has a factor for; `None` where it is the same for all.
    pub(crate) fn joints(&self) -> Option<usize> {
        (self.factors.len() > 1).then_some(self.factors.len())
    }

    /// The factor of a joint.
    pub(crate) fn factor(&self, joint: usize) -> f64 {
        self.factors.get(joint).or(self.factors.first()).copied().unwrap_or(1.0)
    }

    /// A value in SI.
    pub(crate) fn si_value(&self, joint: usize, value: f64) -> f64 {
        self.factor(joint) * value + self.shift
    }

    /// As it is written in a map.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// What may be written for a quantity.
fn allowed(quantity: Quantity) -> String {
    let dimension = Dimension::of(quantity);
    let mut names: Vec<&str> = KNOWN.iter().filter(|known| Some(known.2) == dimension).map(|known| known.0).collect();
    if dimension == Some(Dimension::Torque) {
        names.extend(["A*CONSTANT", "mA*CONSTANT (Nm/A at the joint; one, or one per joint as 11.1:11.1:8.9)"]);
    }
    names.push("raw*FACTOR");
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_worth_what_they_are() {
        let value = |text, quantity| Unit::parse(text, quantity).map(|unit| unit.si_value(1, 2.0));
        assert_eq!(value("ms", Quantity::Time), Ok(2e-3));
        assert_eq!(value("Deg", Quantity::Position), Ok(std::f64::consts::PI / 90.0));
        assert_eq!(value("rpm", Quantity::Velocity), Ok(std::f64::consts::PI / 15.0));
        assert_eq!(value("mA*10:20", Quantity::Torque), Ok(0.04));
        assert_eq!(value("raw*0.5", Quantity::Torque), Ok(1.0));
        assert_eq!(value("N*m", Quantity::Torque), Ok(2.0));
        assert_eq!(value("K", Quantity::Temperature), Ok(2.0 - 273.15));
        for (text, quantity, word) in [
            ("mA", Quantity::Torque, "only with a torque constant"),
            ("deg", Quantity::Velocity, "measures something else; allowed for dq_i: rad/s, deg/s, rpm, raw*FACTOR"),
            ("grad", Quantity::Position, "is not known"),
            ("raw*", Quantity::Position, "has no factor"),
            ("A*0", Quantity::Torque, "no number other than 0"),
            ("A*2", Quantity::Position, "takes no factor"),
        ] {
            let error = value(text, quantity).unwrap_err();
            assert!(error.contains(word), "{error}");
        }
    }
}
