//! Models (`schema: tribo.model/1`) with friction, effects and a URDF within.

use tribo_model::{ModelFile, to_yaml};

use super::document::{document, names_the_input, written};

/// A model is refused with its field, or is the same after it was written and read.
pub fn check(input: &[u8]) {
    let Some(document) = document(input) else { return };
    let file = match document.parse::<ModelFile>() {
        Ok(file) => file,
        Err(error) => return names_the_input(&error),
    };
    match file.validate_any() {
        Ok(model) => {
            let text = to_yaml(&file).expect("a model can be written");
            let again: ModelFile = written(&text).parse().expect("a model that was written is read");
            assert_eq!(again, file, "{text}");
            assert_eq!(again.validate_any().expect("and is as valid"), model);
        }
        Err(error) => names_the_input(&document.explain(error)),
    }
}
