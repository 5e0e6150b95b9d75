//! A joint-space trajectory on disk.

use std::path::Path;

use nalgebra::SVector;
use serde::{Deserialize, Serialize};
use tribo_robot::Arm;
use tribo_sim::excitation::ViaPoints;

use crate::{FieldError, FileError, YamlDocument};

/// Schema name of trajectory files.
const SCHEMA: &str = "tribo.trajectory/1";

/// Trajectory YAML, `schema: tribo.trajectory/1`: points in joint space, joined by minimum-jerk moves that rest at each.
///
/// ```text
/// q(t) = q_k + (q_{k+1} − q_k)(10 s³ − 15 s⁴ + 6 s⁵),   s = (t − t_k)/(t_{k+1} − t_k),   max |q̇| = 1.875 |Δq|/Δt
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrajectoryFile {
    /// `tribo.trajectory/1`.
    pub schema: String,
    /// Name of the arm: of a preset, or the one that its URDF gives it.
    pub robot: String,
    /// What it is for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comment: Option<String>,
    /// The points, times increasing from 0.
    pub via_points: Vec<ViaPoint>,
}

/// Where to be, when.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViaPoint {
    /// Time since the start (s).
    pub time_s: f64,
    /// Joint positions (rad).
    pub q_rad: Vec<f64>,
}

/// Peak speed of a minimum-jerk move over its mean speed [-].
const PEAK_OVER_MEAN: f64 = 1.875;
/// Longest trajectory (s).
const LONGEST_S: f64 = 3600.0;

impl TrajectoryFile {
    /// The file of these points.
    pub fn new<const N: usize>(arm: &Arm<N>, points: &ViaPoints<N>, comment: Option<String>) -> Self {
        let point = |(&time_s, q): (&f64, &SVector<f64, N>)| ViaPoint { time_s, q_rad: q.iter().copied().collect() };
        Self {
            schema: SCHEMA.to_owned(),
            robot: arm.name.clone(),
            comment,
            via_points: points.time_s.iter().zip(&points.q_rad).map(point).collect(),
        }
    }

    /// Reads a file and validates it for `arm`.
    pub fn read<const N: usize>(path: &Path, arm: &Arm<N>) -> Result<ViaPoints<N>, FileError> {
        let document = YamlDocument::read(path)?;
        document.parse::<Self>()?.validate(arm).map_err(|error| document.explain(error))
    }

    /// Checks every point against the limits of `arm`, positions and the speed of the move to it.
    pub fn validate<const N: usize>(&self, arm: &Arm<N>) -> Result<ViaPoints<N>, FieldError> {
        if self.schema != SCHEMA {
            return Err(FieldError::new("schema", &self.schema, SCHEMA));
        }
        if self.robot != arm.name {
            return Err(FieldError::new("robot", &self.robot, &arm.name));
        }
        if self.via_points.len() < 2 {
            let value = format!("{} entries", self.via_points.len());
            return Err(FieldError::new("via_points", value, "at least 2 entries"));
        }
        let limits = arm.limits;
        let mut points = ViaPoints { time_s: Vec::new(), q_rad: Vec::new(), resting: true };
        for (k, point) in self.via_points.iter().enumerate() {
            let field = |name: &str| format!("via_points[{k}].{name}");
            let before = points.time_s.last().copied();
            match before {
                None => FieldError::check(&field("time_s"), point.time_s, 0.0, 0.0)?,
                Some(before) if !(point.time_s > before && point.time_s <= LONGEST_S) => {
                    let allowed = format!("greater than {before}, at most {LONGEST_S}");
                    return Err(FieldError::new(field("time_s"), point.time_s, allowed));
                }
                Some(_) => {}
            }
            if point.q_rad.len() != N {
                let value = format!("{} entries", point.q_rad.len());
                return Err(FieldError::new(field("q_rad"), value, format!("{N} entries, one per joint")));
            }
            let q = SVector::<f64, N>::from_column_slice(&point.q_rad);
            for j in 0..N {
                FieldError::check(&field(&format!("q_rad[{j}]")), q[j], limits.q_min_rad[j], limits.q_max_rad[j])?;
                if let (Some(before), Some(from)) = (before, points.q_rad.last()) {
                    let reach = limits.qd_max_rad_s[j] * (point.time_s - before) / PEAK_OVER_MEAN;
                    if (q[j] - from[j]).abs() > reach {
                        let (low, high, fastest) = (from[j] - reach, from[j] + reach, limits.qd_max_rad_s[j]);
                        let allowed = format!("{low:.4} to {high:.4}, or the joint exceeds {fastest} rad/s on its way");
                        return Err(FieldError::new(field(&format!("q_rad[{j}]")), q[j], allowed));
                    }
                }
            }
            points.time_s.push(point.time_s);
            points.q_rad.push(q);
        }
        Ok(points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::presets;
    use tribo_sim::excitation::JointTrajectory;

    fn two(q: f64, time_s: f64) -> TrajectoryFile {
        let start = presets::panda_ready_pose();
        let mut end = start;
        end[1] += q;
        let points = ViaPoints { time_s: vec![0.0, time_s], q_rad: vec![start, end], resting: true };
        TrajectoryFile::new(&presets::panda(), &points, Some("to the right".to_owned()))
    }

    #[test]
    fn a_file_is_its_points_again() {
        let file = two(0.5, 2.0);
        let text = crate::to_yaml(&file).unwrap();
        assert_eq!(YamlDocument::embedded("t.yaml", &text).parse::<TrajectoryFile>().unwrap(), file);
        let points = file.validate(&presets::panda()).unwrap();
        assert_eq!(TrajectoryFile::new(&presets::panda(), &points, file.comment.clone()), file);
        assert!((points.path().at(1.0).qd[1] - PEAK_OVER_MEAN * 0.25).abs() < 1e-12);
    }

    /// The bound is the true peak: just inside it passes, and the path then meets the limit.
    #[test]
    fn the_speed_limit_is_the_peak_of_the_path() {
        let limits = presets::panda().limits;
        let reach = limits.qd_max_rad_s[1] * 0.5 / PEAK_OVER_MEAN;
        let path = two(0.999 * reach, 0.5).validate(&presets::panda()).unwrap().path();
        let peak = (0..500).map(|k| path.at(1e-3 * f64::from(k)).qd[1].abs()).fold(0.0, f64::max);
        assert!(peak < limits.qd_max_rad_s[1] && peak > 0.998 * limits.qd_max_rad_s[1], "{peak}");
        let error = two(1.001 * reach, 0.5).validate(&presets::panda()).unwrap_err();
        assert_eq!(error.field, "via_points[1].q_rad[1]");
        assert!(error.allowed.contains("rad/s"), "{error}");
    }

    #[test]
    fn refusals_name_the_point() {
        let refused = |change: &dyn Fn(&mut TrajectoryFile)| {
            let mut file = two(0.1, 2.0);
            change(&mut file);
            file.validate(&presets::panda()).unwrap_err().field
        };
        assert_eq!(refused(&|file| file.schema = "tribo.trajectory/9".to_owned()), "schema");
        assert_eq!(refused(&|file| file.robot = "ur5".to_owned()), "robot");
        assert_eq!(refused(&|file| file.via_points.truncate(1)), "via_points");
        assert_eq!(refused(&|file| file.via_points[0].time_s = 0.5), "via_points[0].time_s");
        assert_eq!(refused(&|file| file.via_points[1].time_s = 0.0), "via_points[1].time_s");
        assert_eq!(refused(&|file| file.via_points[1].time_s = f64::NAN), "via_points[1].time_s");
        assert_eq!(refused(&|file| file.via_points[1].q_rad[3] = 0.3), "via_points[1].q_rad[3]");
        assert_eq!(refused(&|file| file.via_points[0].q_rad[6] = f64::NAN), "via_points[0].q_rad[6]");
        assert_eq!(refused(&|file| file.via_points[1].q_rad.truncate(6)), "via_points[1].q_rad");
    }
}
