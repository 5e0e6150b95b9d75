//! Figures that are made once per snapshot and choice, not once per frame.

use std::sync::Arc;

use tribo_figure::Figure;

/// What figures were made from: the addresses of their snapshots and what the user chose.
pub type Key = (Vec<usize>, Vec<usize>);

/// The address of a snapshot; none is 0. The memo's owner holds the snapshot, so an address names one as long as it counts.
pub fn address<T>(snapshot: Option<&Arc<T>>) -> usize {
    snapshot.map_or(0, |snapshot| Arc::as_ptr(snapshot) as usize)
}

/// The latest figures.
#[derive(Debug, Default)]
pub struct Memo {
    key: Option<Key>,
    figures: Vec<Figure>,
}

impl Memo {
    /// The figures of `key`, made anew if it has changed.
    pub fn get(&mut self, key: Key, make: impl FnOnce() -> Vec<Figure>) -> &[Figure] {
        if self.key.as_ref() != Some(&key) {
            self.figures = make();
            self.key = Some(key);
        }
        &self.figures
    }
}
