//! Files of finished cells of a study.

use std::cell::RefCell;

use tribo_campaign::study::{Cell, Study, StudyStore, Work};
use tribo_model::YamlDocument;

use super::scratch::{directory, put};

const STUDY: &str = "schema: tribo.study/1\nseeds: 1\ncases: [{truth: stribeck, friction: stribeck}]\n\
    strategies: [{strategy: sobol, trials: 2}]\n";
const CELL: Cell = Cell { case: 0, estimator: 0, pose: 0, seed: 1, work: Work::Campaign(0) };

thread_local! {
    static STORE: RefCell<Option<(Study, StudyStore)>> = const { RefCell::new(None) };
}

/// A cell is refused with its file, or is the same after it was written and read.
pub fn check(input: &[u8]) {
    STORE.with_borrow_mut(|store| {
        let (study, store) = store.get_or_insert_with(|| {
            let study = Study::parse(&YamlDocument::embedded("study.yaml", STUDY)).expect("a study");
            let store = StudyStore::open(&directory().join("study"), &study).expect("its directory");
            (study, store)
        });
        let name = format!("{}.json", CELL.name(study));
        put(&store.directory().join("cells").join(&name), input);
        match store.read(study, &CELL) {
            Ok(Some(result)) => {
                store.write(study, &CELL, &result).expect("a cell can be written");
                assert_eq!(store.read(study, &CELL).expect("and is read"), Some(result));
            }
            Ok(None) => panic!("the file is there"),
            Err(error) => assert!(error.to_string().contains(&name), "{error}"),
        }
    });
}
