//! ROS 2 parameter files.

use super::float::floats;
use super::text::{in_comment, is_identifier};
use super::{ExportError, Loss};

/// The text of a parameter file, `NODE: ros__parameters: …` (design.ros2.org, "ROS 2 parameters"), as it grows.
///
/// A bare node name matches in any namespace (`/**: NODE:`); one with slashes is taken as it is. Numbers are always doubles
/// of ROS (see [`super::float::float`]).
pub(super) struct ParameterFile {
    text: String,
    indent: usize,
}

impl ParameterFile {
    /// A file for one node, beginning with `remarks` and what is lost.
    ///
    /// # Errors
    /// A name that is no node name.
    pub fn new(node: &str, remarks: &[String], losses: &[Loss]) -> Result<Self, ExportError> {
        let bare = node.trim_start_matches('/');
        if node != "/**" && !bare.split('/').all(|part| is_identifier(part) || part == "**" || part == "*") {
            let allowed = "names of letters, digits and _ that begin with a letter, between slashes, or /**";
            return Err(ExportError::Name { name: node.to_owned(), allowed });
        }
        let mut file = Self { text: String::new(), indent: 0 };
        for remark in remarks {
            file.line(&format!("# {}", in_comment(remark)));
        }
        for loss in losses {
            file.line(&format!("# Not in this file: {}", in_comment(&loss.to_string())));
        }
        if !node.contains('/') {
            file.open("/**");
        }
        file.open(node);
        file.open("ros__parameters");
        Ok(file)
    }

    fn line(&mut self, line: &str) {
        self.text.push_str(&format!("{:1$}{line}\n", "", 2 * self.indent));
    }

    /// Begins a group of parameters.
    pub fn open(&mut self, key: &str) {
        self.line(&format!("{key}:"));
        self.indent += 1;
    }

    /// Ends the last group.
    pub fn close(&mut self) {
        self.indent -= 1;
    }

    /// A parameter whose value is written in YAML.
    pub fn value(&mut self, key: &str, value: &str) {
        self.line(&format!("{key}: {value}"));
    }

    /// An array of doubles.
    pub fn array(&mut self, key: &str, values: impl IntoIterator<Item = f64>) {
        self.value(key, &format!("[{}]", floats(values)));
    }

    /// The text.
    pub fn into_text(self) -> String {
        self.text
    }
}
