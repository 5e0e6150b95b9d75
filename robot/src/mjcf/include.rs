//! `<include>`: one text of many files.

use std::collections::BTreeSet;
use std::ops::Range;

use roxmltree::{Document, Node};

use super::MjcfError;
use crate::chain::xml::within_bounds;

/// Largest text with everything in it (bytes).
const LARGEST: usize = 16 << 20;

/// The text of a model with the content of every file in the place of its `<include file="…"/>`; what is included may
/// include. `read` gives the text of a file by the name that the include has, relative to the model's directory, as MuJoCo
/// does it, or says what is wrong.
///
/// # Errors
/// A file that cannot be read, is included twice (MuJoCo refuses it too) or makes the text longer than 16 MiB.
pub fn with_includes(text: &str, read: &mut dyn FnMut(&str) -> Result<String, String>) -> Result<String, MjcfError> {
    let mut text = text.to_owned();
    let mut seen = BTreeSet::new();
    loop {
        within_bounds(&text).map_err(MjcfError::Syntax)?;
        let includes = includes(&text)?;
        if includes.is_empty() {
            return Ok(text);
        }
        // From the end, so that what comes before stays where it is.
        for (range, file) in includes.into_iter().rev() {
            let refuse = |message: String| MjcfError::Include { file: file.clone(), message };
            if !seen.insert(file.clone()) {
                return Err(refuse("included twice".to_owned()));
            }
            let inner = read(&file).map_err(refuse)?;
            within_bounds(&inner).map_err(refuse)?;
            text.replace_range(range, content(&inner).map_err(refuse)?);
            if text.len() > LARGEST {
                return Err(refuse(format!("the model is larger than {LARGEST} bytes")));
            }
        }
    }
}

/// Where an include is in the text, and the file that it names.
type Place = (Range<usize>, String);

/// The includes in a text.
fn includes(text: &str) -> Result<Vec<Place>, MjcfError> {
    let document = Document::parse(text).map_err(|error| MjcfError::Syntax(error.to_string()))?;
    let mut found = Vec::new();
    let include = |node: &Node| node.has_tag_name("include");
    // What is inside of an include goes with it.
    let outermost = |node: &Node| include(node) && !node.ancestors().skip(1).any(|above| include(&above));
    for node in document.descendants().filter(outermost) {
        let file = node.attribute("file").unwrap_or("");
        if file.is_empty() || file.chars().any(char::is_control) {
            let message = "names no file".to_owned();
            return Err(MjcfError::Include { file: file.escape_debug().to_string(), message });
        }
        found.push((node.range(), file.to_owned()));
    }
    Ok(found)
}

/// What is inside of the root element of an included file.
fn content(text: &str) -> Result<&str, String> {
    let document = Document::parse(text).map_err(|error| error.to_string())?;
    let children = || document.root_element().children();
    Ok(match (children().next(), children().next_back()) {
        (Some(first), Some(last)) => &text[first.range().start..last.range().end],
        _ => "",
    })
}
