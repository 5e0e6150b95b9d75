//! What the window remembers.

use std::path::Path;

use serde::{Deserialize, Serialize};
use tribo_model::ModelChoice;
use tribo_trial::EstimatorName;

use crate::view::View;

/// How the user left the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layout {
    /// The view.
    pub view: View,
    /// Dark or light; none follows the system.
    pub dark: Option<bool>,
    /// Joint of the views that show one.
    pub joint: usize,
    /// Part of the trial view.
    pub trial_part: usize,
    /// Whose wrench is shown along a log.
    pub estimator: EstimatorName,
    /// Size of the window (px).
    pub size: [f32; 2],
    /// What was open.
    pub path: String,
    /// Campaigns and logs that were open, the last one first.
    pub recent: Vec<Recent>,
}

/// A campaign or a log that was open.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Recent {
    /// Where it is.
    pub path: String,
    /// The robot of a log.
    pub model: ModelChoice,
}

impl Recent {
    /// Whether it is this path with this robot.
    pub fn is(&self, path: &Path, model: &ModelChoice) -> bool {
        Path::new(&self.path) == path && self.model == *model
    }
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            view: View::Campaign,
            dark: None,
            joint: 0,
            trial_part: 0,
            estimator: EstimatorName::default(),
            size: [1280.0, 800.0],
            path: String::new(),
            recent: Vec::new(),
        }
    }
}

/// Paths that are remembered.
const MOST_RECENT: usize = 10;

impl Layout {
    /// Remembers what is open.
    pub fn opened(&mut self, open: Recent) {
        self.path.clone_from(&open.path);
        self.recent.retain(|recent| recent.path != open.path);
        self.recent.insert(0, open);
        self.recent.truncate(MOST_RECENT);
    }

    /// The layout of a file; a missing or foreign one is as good as none.
    pub fn read(path: &Path) -> Self {
        std::fs::read_to_string(path).ok().and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()
    }

    /// Writes the layout. Who cannot write loses a convenience and no more.
    pub fn write(&self, path: &Path) {
        if let (Some(directory), Ok(text)) = (path.parent(), serde_json::to_string_pretty(self)) {
            let _ = std::fs::create_dir_all(directory).and_then(|()| std::fs::write(path, text));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remembers_what_was_open_each_path_once() {
        let mut layout = Layout::default();
        let open = |path: &str, robot: Option<&str>| Recent {
            path: path.to_owned(),
            model: ModelChoice { robot: robot.map(str::to_owned), ..ModelChoice::default() },
        };
        layout.opened(open("a", None));
        layout.opened(open("b", None));
        layout.opened(open("a", Some("ur5e")));
        assert_eq!((&layout.recent, layout.path.as_str()), (&vec![open("a", Some("ur5e")), open("b", None)], "a"));
        (0..20).for_each(|k| layout.opened(open(&k.to_string(), None)));
        assert_eq!((layout.recent.len(), layout.recent[0].path.as_str()), (MOST_RECENT, "19"));
    }

    #[test]
    fn comes_back_and_forgives() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("tribo").join("dashboard.json");
        assert_eq!(Layout::read(&path), Layout::default());
        let layout =
            Layout { view: View::Arm, dark: Some(true), joint: 4, path: "a b".to_owned(), ..Layout::default() };
        layout.write(&path);
        assert_eq!(Layout::read(&path), layout);
        std::fs::write(&path, "{\"view\": \"arm\", \"from the future\": 1}").unwrap();
        assert_eq!(Layout::read(&path).view, View::Arm);
        std::fs::write(&path, "no").unwrap();
        assert_eq!(Layout::read(&path), Layout::default());
    }
}
