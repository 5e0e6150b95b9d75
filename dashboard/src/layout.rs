//! What the window remembers.

use std::path::Path;

use serde::{Deserialize, Serialize};
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
        }
    }
}

impl Layout {
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
