//! Who pushes the tool, on disk.

use std::path::Path;

use serde::{Deserialize, Serialize};
use tribo_robot::Wrench;
use tribo_sim::{Pulse, WrenchPulses};

use crate::{FieldError, FileError, YamlDocument};

/// Schema name of pushes files.
const SCHEMA: &str = "tribo.pushes/1";
/// Latest time (s): a day.
const LATEST_S: f64 = 86_400.0;
/// Greatest force (N) and moment (Nm).
const GREATEST: f64 = 1000.0;

/// Pushes YAML, `schema: tribo.pushes/1`: forces and moments on the tool, each with a linear ramp up and down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PushesFile {
    /// `tribo.pushes/1`.
    pub schema: String,
    /// The pushes; those that overlap add.
    pub pushes: Vec<Push>,
}

/// One push.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Push {
    /// Start of the rising ramp (s), in time of the arm.
    pub start_s: f64,
    /// End of the falling ramp (s).
    pub end_s: f64,
    /// Force by the environment on the robot (N), at the flange, base axes.
    #[serde(default)]
    pub force_n: [f64; 3],
    /// Moment by the environment on the robot (Nm), likewise.
    #[serde(default)]
    pub moment_nm: [f64; 3],
    /// Length of each ramp (s).
    #[serde(default = "usual_ramp_s")]
    pub ramp_s: f64,
}

fn usual_ramp_s() -> f64 {
    0.1
}

impl PushesFile {
    /// Reads and checks a file.
    ///
    /// # Errors
    ///
    /// [`FileError`] with the file, line, field and allowed range.
    pub fn read(path: &Path) -> Result<WrenchPulses, FileError> {
        let document = YamlDocument::read(path)?;
        document.parse::<Self>()?.validate().map_err(|error| document.explain(error))
    }

    /// The schedule, by the robot on the environment as everywhere inside Tribo.
    ///
    /// # Errors
    ///
    /// [`FieldError`] for the first value out of its range.
    pub fn validate(&self) -> Result<WrenchPulses, FieldError> {
        if self.schema != SCHEMA {
            return Err(FieldError::new("schema", &self.schema, SCHEMA));
        }
        let mut pulses = Vec::with_capacity(self.pushes.len());
        for (k, push) in self.pushes.iter().enumerate() {
            let field = |name: &str| format!("pushes[{k}].{name}");
            FieldError::check(&field("start_s"), push.start_s, 0.0, LATEST_S)?;
            FieldError::check(&field("end_s"), push.end_s, push.start_s, LATEST_S)?;
            FieldError::check(&field("ramp_s"), push.ramp_s, 0.0, 0.5 * (push.end_s - push.start_s))?;
            for axis in 0..3 {
                FieldError::check(&field(&format!("force_n[{axis}]")), push.force_n[axis], -GREATEST, GREATEST)?;
                FieldError::check(&field(&format!("moment_nm[{axis}]")), push.moment_nm[axis], -GREATEST, GREATEST)?;
            }
            let ([fx, fy, fz], [mx, my, mz]) = (push.force_n, push.moment_nm);
            pulses.push(Pulse {
                wrench_base: Wrench::from_force_moment(&[fx, fy, fz, mx, my, mz]).reaction(),
                start_s: push.start_s,
                end_s: push.end_s,
                ramp_s: push.ramp_s,
            });
        }
        Ok(WrenchPulses { pulses })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_push_is_the_reaction_of_what_the_robot_exerts() {
        let text = "schema: tribo.pushes/1\npushes:\n  - {start_s: 1, end_s: 3, force_n: [0, 0, -10]}\n";
        let pulses = YamlDocument::embedded("p.yaml", text).parse::<PushesFile>().unwrap().validate().unwrap();
        assert_eq!(pulses.at(2.0).force_n.z, 10.0);
        assert_eq!(pulses.at(0.9).force_n.z, 0.0);
        let bad = text.replace("end_s: 3", "end_s: 0.5");
        let document = YamlDocument::embedded("p.yaml", &bad);
        let error = document.parse::<PushesFile>().unwrap().validate().unwrap_err();
        assert!(document.explain(error).to_string().contains("end_s"), "the field is named");
    }
}
