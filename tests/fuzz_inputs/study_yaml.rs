//! Studies (`schema: tribo.study/1`).

use tribo_campaign::study::Study;
use tribo_model::to_yaml;

use super::document::{document, written};

/// A study is refused, or is what `study.yaml` gives back, and so is its number of cells.
pub fn check(input: &[u8]) {
    let Some(document) = document(input) else { return };
    // A refused study names itself or a file that it names.
    let Ok(study) = Study::parse(&document) else { return };
    let text = to_yaml(&study).expect("a study can be written");
    let again = Study::parse(&written(&text)).expect("a study that was written is read");
    assert_eq!(again, study, "{text}");
    assert_eq!(again.cells().len(), study.cells().len());
}
