//! YAML documents out of bytes.

use std::fmt::Display;

use tribo_model::YamlDocument;

/// What errors call the input.
const NAME: &str = "input.yaml";

/// The input as a document; none where it is no text, which is refused before there is a document.
pub fn document(input: &[u8]) -> Option<YamlDocument> {
    std::str::from_utf8(input).ok().map(|text| YamlDocument::embedded(NAME, text))
}

/// Text that Tribo wrote, as a document.
pub fn written(text: &str) -> YamlDocument {
    YamlDocument::embedded("written.yaml", text)
}

/// An error names the input.
pub fn names_the_input(error: &impl Display) {
    let message = error.to_string();
    assert!(message.contains(NAME), "an error that does not name its file: {message}");
}
