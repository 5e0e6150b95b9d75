//! Contiguous blocks for training and test.

use std::fmt;
use std::ops::Range;

/// How to cut blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockSettings {
    /// Length of a block (s). Two seconds outlast the memory of friction and filter; interleaved shorter pieces flatter
    /// wrong causes.
    pub length_s: f64,
    /// Number of folds, at least 2: block i is the test of fold i mod folds. Two folds alternate.
    pub folds: usize,
    /// Training samples closer than this to a test block are dropped (s). `None` takes the memory of the filter.
    pub margin_s: Option<f64>,
}

impl Default for BlockSettings {
    fn default() -> Self {
        Self { length_s: 2.0, folds: 5, margin_s: None }
    }
}

/// Why no blocks can be cut.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BlocksError {
    /// Fewer blocks than folds.
    #[error("{got} blocks of {length_s} s cannot fill {folds} folds")]
    TooFewBlocks {
        /// Blocks cut.
        got: usize,
        /// Folds asked for.
        folds: usize,
        /// Length of a block (s).
        length_s: f64,
    },
    /// A setting lies outside its range.
    #[error("{field}: {value} is outside {allowed}")]
    OutOfRange {
        /// Name of the setting.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The allowed range.
        allowed: &'static str,
    },
}

/// Contiguous blocks of samples in k folds.
///
/// ```text
/// block i is test in fold i mod folds, otherwise training, less the samples within `margin_s` of a test block
/// ```
///
/// A block never spans two bursts. Each burst is cut from its start; a last piece shorter than half a block joins the
/// one before it. Every sample is tested in exactly one fold.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks {
    /// Samples of each block, in order.
    pub ranges: Vec<Range<usize>>,
    /// Number of folds.
    pub folds: usize,
    /// Nominal length of a block (s).
    pub length_s: f64,
    /// Dead time on either side of a test block (s).
    pub margin_s: f64,
    margin_samples: usize,
    burst_of: Vec<usize>,
}

/// Samples of one fold, as ranges in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Split {
    /// What a fit may see.
    pub train: Vec<Range<usize>>,
    /// What it is judged on.
    pub test: Vec<Range<usize>>,
}

impl Blocks {
    /// Cuts the bursts of a signal sampled at `rate_hz`, whose filter remembers `memory_s`.
    ///
    /// # Errors
    /// [`BlocksError`].
    pub fn cut(
        bursts: &[Range<usize>],
        rate_hz: f64,
        memory_s: f64,
        settings: &BlockSettings,
    ) -> Result<Self, BlocksError> {
        let BlockSettings { length_s, folds, margin_s } = *settings;
        let margin_s = margin_s.unwrap_or(memory_s);
        in_range("folds", folds as f64, folds >= 2, "[2, inf)")?;
        in_range("margin_s", margin_s, (0.0..f64::INFINITY).contains(&margin_s), "[0, inf) s")?;
        let length = (length_s * rate_hz).round();
        in_range("length_s", length_s, length >= 2.0 && length.is_finite(), "[2 samples, inf) s")?;
        let length = length as usize;

        let (mut ranges, mut burst_of) = (Vec::new(), Vec::new());
        for (burst, Range { start, end }) in bursts.iter().cloned().enumerate() {
            let whole = (end.saturating_sub(start) + length / 2) / length;
            for block in 0..whole.max(1) {
                let last = block + 1 >= whole;
                let first = start + block * length;
                ranges.push(first..if last { end } else { first + length });
                burst_of.push(burst);
            }
        }
        if ranges.len() < folds {
            return Err(BlocksError::TooFewBlocks { got: ranges.len(), folds, length_s });
        }
        let margin_samples = (margin_s * rate_hz).ceil() as usize;
        Ok(Self { ranges, folds, length_s, margin_s, margin_samples, burst_of })
    }

    /// Training and test samples of `fold`, taken modulo the number of folds.
    pub fn split(&self, fold: usize) -> Split {
        let is_test = |block: &usize| block % self.folds == fold % self.folds;
        let blocks = 0..self.ranges.len();
        let test = blocks.clone().filter(is_test).map(|block| self.ranges[block].clone()).collect();
        let train = blocks.clone().filter(|block| !is_test(block)).map(|block| {
            let Range { mut start, mut end } = self.ranges[block].clone();
            for other in blocks.clone().filter(is_test).filter(|&other| self.burst_of[other] == self.burst_of[block]) {
                if other < block {
                    start = start.max(self.ranges[other].end + self.margin_samples);
                } else {
                    end = end.min(self.ranges[other].start.saturating_sub(self.margin_samples));
                }
            }
            start..end
        });
        Split { train: train.filter(|range| !range.is_empty()).collect(), test }
    }
}

impl fmt::Display for Blocks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} contiguous blocks of {} s, block i tested in fold i mod {}, trained on the rest less {:.0} ms on either \
             side of a test block",
            self.ranges.len(),
            self.length_s,
            self.folds,
            1e3 * self.margin_s
        )
    }
}

fn in_range(field: &'static str, value: f64, inside: bool, allowed: &'static str) -> Result<(), BlocksError> {
    if inside { Ok(()) } else { Err(BlocksError::OutOfRange { field, value, allowed }) }
}

#[cfg(test)]
#[allow(clippy::single_range_in_vec_init, reason = "one burst is one range")]
mod tests {
    use super::*;

    #[test]
    fn train_and_test_are_disjoint_with_a_margin_and_every_sample_is_tested_once() {
        let bursts = [0..1050, 1050..1130, 1130..1830];
        for folds in [2, 3, 5] {
            let settings = BlockSettings { folds, ..BlockSettings::default() };
            let blocks = Blocks::cut(&bursts, 100.0, 0.25, &settings).unwrap();
            let mut tested = vec![0; 1830];
            for fold in 0..folds {
                let split = blocks.split(fold);
                split.test.iter().cloned().flatten().for_each(|k| tested[k] += 1);
                let burst = |k: usize| bursts.iter().position(|b| b.contains(&k));
                for k in split.train.iter().cloned().flatten() {
                    for test in split.test.iter().filter(|test| burst(test.start) == burst(k)) {
                        assert!(k + 25 < test.start + 1 || k >= test.end + 25, "{k} too near to {test:?}");
                    }
                }
                // The margin takes no more than it says.
                let sizes = |ranges: &[Range<usize>]| ranges.iter().map(ExactSizeIterator::len).sum::<usize>();
                let used = sizes(&split.train) + sizes(&split.test);
                assert!(used <= 1830 && used + 50 * split.test.len() >= 1830, "{used}");
            }
            assert!(tested.iter().all(|&count| count == 1));
        }
    }

    #[test]
    fn remainders_join_and_blocks_stay_inside_bursts() {
        let blocks = Blocks::cut(&[0..450, 450..500, 500..1000], 100.0, 0.2, &BlockSettings::default()).unwrap();
        assert_eq!(blocks.ranges, [0..200, 200..450, 450..500, 500..700, 700..900, 900..1000]);
        let settings = BlockSettings { folds: 2, margin_s: Some(0.0), ..BlockSettings::default() };
        let alternating = Blocks::cut(&[0..800], 100.0, 0.2, &settings).unwrap();
        assert_eq!(alternating.split(1), Split { train: vec![0..200, 400..600], test: vec![200..400, 600..800] });
    }

    #[test]
    fn impossible_cuts_are_named() {
        let few = Blocks::cut(&[0..500], 100.0, 0.2, &BlockSettings::default());
        assert_eq!(few, Err(BlocksError::TooFewBlocks { got: 3, folds: 5, length_s: 2.0 }));
        let settings = BlockSettings { length_s: f64::NAN, ..BlockSettings::default() };
        let nan = Blocks::cut(&[0..5000], 100.0, 0.2, &settings);
        assert!(matches!(nan, Err(BlocksError::OutOfRange { field: "length_s", .. })));
    }
}
