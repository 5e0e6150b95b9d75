//! Extremes of any stretch of a long signal, quickly.

/// Samples of one cell of the lowest level.
const BASE: usize = 32;
/// Cells of a level that make one of the next.
const FACTOR: usize = 8;
/// Cells of a stretch whose ends may move by a cell.
const PARTS: usize = 8;

/// Least and greatest value over cells of growing size:
///
/// ```text
/// level 0:  (min, max) of samples [32 i, 32 (i + 1));   level k + 1:  (min, max) of 8 cells of level k
/// ```
///
/// A query costs at most 2·32 samples and 2·8 cells per level, whatever its length; the cells take a fourteenth of the
/// signal. NaN is left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MinMaxPyramid {
    levels: Vec<Vec<[f32; 2]>>,
}

/// No value yet.
const NOTHING: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

fn join(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    // `min` and `max` of the standard library pass over NaN.
    [a[0].min(b[0]), a[1].max(b[1])]
}

fn of_samples(samples: &[f32]) -> [f32; 2] {
    samples.iter().fold(NOTHING, |sum, value| join(sum, [*value, *value]))
}

fn of_cells(cells: &[[f32; 2]]) -> [f32; 2] {
    cells.iter().fold(NOTHING, |sum, cell| join(sum, *cell))
}

impl MinMaxPyramid {
    /// The pyramid of a signal.
    pub fn new(samples: &[f32]) -> Self {
        let mut levels = vec![samples.chunks(BASE).map(of_samples).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|level| level.len() > FACTOR) {
            let above = below.chunks(FACTOR).map(of_cells).collect();
            levels.push(above);
        }
        Self { levels }
    }

    /// Least and greatest of `samples[from..to]`, of which this is the pyramid; none where there is no number.
    pub fn extremes(&self, samples: &[f32], from: usize, to: usize) -> Option<[f32; 2]> {
        let to = to.min(samples.len());
        if from >= to {
            return None;
        }
        let (first_cell, last_cell) = (from.div_ceil(BASE), to / BASE);
        let found = if first_cell >= last_cell {
            of_samples(&samples[from..to])
        } else {
            let ends = join(of_samples(&samples[from..first_cell * BASE]), of_samples(&samples[last_cell * BASE..to]));
            join(ends, self.cells(0, first_cell, last_cell))
        };
        (found[0] <= found[1]).then_some(found)
    }

    /// [`Self::extremes`] with both ends moved outwards by less than an eighth of the stretch, to ends of cells: for a
    /// picture, where reading single samples of a long signal would take longer than all the rest. No sample is lost; short
    /// stretches are exact.
    pub fn extremes_about(&self, samples: &[f32], from: usize, to: usize) -> Option<[f32; 2]> {
        let to = to.min(samples.len());
        let length = to.saturating_sub(from);
        if length < PARTS * BASE {
            return self.extremes(samples, from, to);
        }
        let (mut level, mut cell) = (0, BASE);
        while level + 1 < self.levels.len() && length >= PARTS * cell * FACTOR {
            (level, cell) = (level + 1, cell * FACTOR);
        }
        let found = self.cells(level, from / cell, to.div_ceil(cell));
        (found[0] <= found[1]).then_some(found)
    }

    /// Over cells `[from, to)` of a level, climbing while whole cells of the level above fit.
    fn cells(&self, level: usize, mut from: usize, mut to: usize) -> [f32; 2] {
        let mut found = NOTHING;
        for (k, level) in self.levels.iter().enumerate().skip(level) {
            let (up_from, up_to) = (from.div_ceil(FACTOR), to / FACTOR);
            if k + 1 == self.levels.len() || up_from >= up_to {
                return join(found, of_cells(&level[from..to]));
            }
            found = join(found, of_cells(&level[from..up_from * FACTOR]));
            found = join(found, of_cells(&level[up_to * FACTOR..to]));
            (from, to) = (up_from, up_to);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against looking at every sample, for stretches of every kind.
    #[test]
    fn equals_the_plain_search() {
        // A noise-like signal with NaN in it, from a linear congruence.
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 8
        };
        for length in [0, 1, 31, 32, 33, 257, 2049, 40_000] {
            let samples: Vec<f32> = (0..length)
                .map(|_| match next() {
                    value if value % 97 == 0 => f32::NAN,
                    value => value as f32 - 8e6,
                })
                .collect();
            let pyramid = MinMaxPyramid::new(&samples);
            for _ in 0..400 {
                let a = next() as usize % (length + 1);
                let b = a + next() as usize % (length + 2 - a);
                let plain: Vec<f32> =
                    samples[a..b.min(length)].iter().copied().filter(|value| !value.is_nan()).collect();
                let expected = plain.iter().copied().reduce(f32::min).zip(plain.iter().copied().reduce(f32::max));
                assert_eq!(pyramid.extremes(&samples, a, b), expected.map(|(low, high)| [low, high]), "{a}..{b}");
            }
        }
    }

    /// A stretch of any length holds all its samples, and less than an eighth more at either end.
    #[test]
    fn moved_ends_lose_nothing() {
        let samples: Vec<f32> = (0..200_001).map(|k| k as f32).collect();
        let pyramid = MinMaxPyramid::new(&samples);
        for length in [1, 100, 256, 300, 2048, 5000, 17_000, 90_000, 200_001] {
            for from in (0..=samples.len() - length).step_by(length.div_ceil(3)) {
                let [low, high] = pyramid.extremes_about(&samples, from, from + length).expect("samples");
                let (first, last, moved) = (from as f32, (from + length - 1) as f32, 0.125 * length as f32);
                assert!(low <= first && first - low < moved, "{low} for {first}, length {length}");
                assert!(high >= last && high - last < moved, "{high} for {last}, length {length}");
            }
        }
    }

    #[test]
    fn cells_take_little_room() {
        let samples = vec![0.0_f32; 3_600_000];
        let cells: usize = MinMaxPyramid::new(&samples).levels.iter().map(Vec::len).sum();
        assert!(cells * 2 * 13 < samples.len(), "{cells}");
    }
}
