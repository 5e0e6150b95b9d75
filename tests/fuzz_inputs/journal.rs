//! Journals: every operation, torn ends, and who reads while another writes.

use tribo_campaign::journal::{Journal, JournalTail, replay};

use super::scratch::{directory, put};

fn clock() -> String {
    "2026-01-01T00:00:00.000000+00:00".to_owned()
}

/// A journal opens if and only if its whole lines can be replayed, whatever stands behind the last line break; then it can be
/// gone on with. One that is refused is left as it was. Whoever watches sees the same trials.
pub fn check(input: &[u8]) {
    let path = directory().join("journal.log");
    put(&path, input);
    let whole = input.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
    let replayed = replay(&path, &input[..whole]).ok();

    let mut tail = JournalTail::new(&path);
    let watched = tail.poll();
    assert_eq!(watched.is_ok(), replayed.is_some(), "{watched:?}");

    match (Journal::open(&path, clock), replayed) {
        (Ok((mut journal, trials)), Some(expected)) => {
            assert_eq!(trials, expected);
            assert_eq!(tail.trials(), expected);
            journal.create_trial().expect("a journal that opens can be gone on with");
            drop(journal);
            let (_journal, more) = Journal::open(&path, clock).expect("and opens again");
            assert_eq!((more.len(), &more[..expected.len()]), (expected.len() + 1, &expected[..]));
        }
        (Err(error), None) => {
            assert!(error.to_string().contains("journal.log"), "{error}");
            assert_eq!(std::fs::read(&path).expect("the file is there"), input, "a refused journal is left alone");
        }
        (opened, replayed) => panic!("opened: {:?}, replayed: {replayed:?}", opened.map(|(_, trials)| trials)),
    }
}
