//! What `tribo diagnose` writes, and what it refuses to write over.

use std::path::{Path, PathBuf};

use tribo_diagnose::NextExperiment;
use tribo_files::write_atomic;
use tribo_model::{ModelFile, TrajectoryFile, ViaPoint, YamlDocument, to_yaml};
use tribo_robot::Arm;

use super::input::same_file;
use crate::arguments::Diagnose;
use crate::failure::BadInput;

/// The first bytes of a report.
const HTML: &[u8] = b"<!doctype html>";

/// Files to write, checked: none is an input, none is another output, and what exists is of the kind to be written.
#[derive(Debug)]
pub struct Outputs {
    /// Extended model.
    pub extend: Option<PathBuf>,
    /// HTML report.
    pub report: Option<PathBuf>,
    /// Via points of the next experiment.
    pub trajectory: Option<PathBuf>,
}

impl Outputs {
    /// Checks the names before any work is done.
    pub fn checked(arguments: &Diagnose) -> anyhow::Result<Self> {
        let outputs = Self {
            extend: arguments.extend.clone(),
            report: arguments.report.clone(),
            trajectory: arguments.trajectory.clone(),
        };
        let named = [
            ("--extend", &outputs.extend, "model file", is_model as fn(&Path) -> bool),
            ("--report", &outputs.report, "HTML file", is_html),
            ("--trajectory", &outputs.trajectory, "trajectory file", is_trajectory),
        ];
        let given: Vec<_> =
            named.iter().filter_map(|(name, path, kind, is)| Some((name, path.as_ref()?, kind, is))).collect();
        for (k, (name, path, kind, is_kind)) in given.iter().enumerate() {
            let refuse = |why: String| Err(BadInput(format!("{name} {}: {why}", path.display())).into());
            if given[..k].iter().any(|(_, other, ..)| other == path || same_file(other, path)) {
                return refuse("is the target of another option too".to_owned());
            }
            let mut inputs = arguments.logs.iter().chain(&arguments.validate).chain(&arguments.reference);
            if inputs.any(|input| same_file(input, path)) {
                return refuse("is a log to be read; it is left untouched".to_owned());
            }
            if arguments.of.model.as_ref().is_some_and(|model| same_file(model, path)) {
                return refuse("is the model that the log is held against; write to another file".to_owned());
            }
            match std::fs::metadata(path) {
                Ok(found) if found.is_dir() => return refuse("is a directory".to_owned()),
                Ok(found) if !found.is_file() => return refuse("is not a regular file".to_owned()),
                Ok(_) if !is_kind(path) => return refuse(format!("exists and is no {kind}; it is left untouched")),
                Ok(_) => {}
                Err(_) => check_parent(path)?,
            }
        }
        Ok(outputs)
    }
}

fn check_parent(path: &Path) -> anyhow::Result<()> {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let why = match std::fs::metadata(parent) {
        Ok(found) if found.is_dir() => return Ok(()),
        Ok(_) => "is not a directory",
        Err(_) => "no such file or directory",
    };
    Err(BadInput(format!("{}: {why}", parent.display())).into())
}

fn is_model(path: &Path) -> bool {
    YamlDocument::read(path).and_then(|document| document.parse::<ModelFile>()).is_ok()
}

fn is_trajectory(path: &Path) -> bool {
    YamlDocument::read(path).and_then(|document| document.parse::<TrajectoryFile>()).is_ok()
}

fn is_html(path: &Path) -> bool {
    use std::io::Read;
    let mut start = [0; HTML.len()];
    let read = std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut start));
    read.is_ok() && start.eq_ignore_ascii_case(HTML)
}

/// Writes the extended model.
pub fn write_model(path: &Path, model: &ModelFile) -> anyhow::Result<()> {
    write_text(path, &to_yaml(model)?)
}

/// Writes the via points of the next experiment.
pub fn write_trajectory<const N: usize>(path: &Path, next: &NextExperiment, arm: &Arm<N>) -> anyhow::Result<()> {
    let file = trajectory(next, &arm.name);
    file.validate(arm).map_err(|error| anyhow::anyhow!("the next experiment makes no valid trajectory: {error}"))?;
    write_text(path, &to_yaml(&file)?)
}

fn trajectory(next: &NextExperiment, robot: &str) -> TrajectoryFile {
    let [a, b] = next.separates.map(|(label, location)| format!("{label} ({location})"));
    TrajectoryFile {
        schema: "tribo.trajectory/1".to_owned(),
        robot: robot.to_owned(),
        comment: Some(format!("{}: separates {a} from {b}. {}", next.motion, next.instruction)),
        via_points: next.via_points.iter().map(|(time_s, q)| ViaPoint { time_s: *time_s, q_rad: q.clone() }).collect(),
    }
}

/// Writes text atomically.
pub fn write_text(path: &Path, text: &str) -> anyhow::Result<()> {
    write_atomic(path, |file| file.write_all(text.as_bytes()))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_regression::{CauseLabel, Location};

    #[test]
    fn a_trajectory_comes_back() {
        let pose = |q: f64| vec![q, q, q, -2.0, q, 2.0, q];
        let next = NextExperiment {
            motion: "slow_cruise",
            instruction: "Move: # slowly, \"twice\".".to_owned(),
            separates: [(CauseLabel::Stribeck, Location::Joint(3)), (CauseLabel::Payload, Location::Arm)],
            expected_evidence: 40.0,
            evidence_of_this_log: 3.0,
            via_points: vec![(0.0, pose(0.1)), (2.5, pose(1.0 / 3.0))],
        };
        let text = to_yaml(&trajectory(&next, "panda")).unwrap();
        let back: TrajectoryFile = YamlDocument::embedded("t.yaml", &text).parse().unwrap();
        assert_eq!(back, trajectory(&next, "panda"));
        back.validate(&tribo_robot::presets::panda()).unwrap();
        assert!(text.starts_with("schema: tribo.trajectory/1\nrobot: panda\ncomment: "), "{text}");
    }
}
