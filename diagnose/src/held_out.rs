//! The gain of the findings on blocks that their coefficients have not seen, and intervals from the blocks.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use tribo_posterior::THIRDS;
use tribo_regression::least_squares::{inner, solve_ridge};
use tribo_regression::{CauseLabel, Column, System};

/// Number of folds.
const FOLDS: usize = 8;
/// Length of a block (s), shorter in short logs.
const BLOCK_S: f64 = 2.0;
/// Shortest block (s).
const SHORTEST_BLOCK_S: f64 = 0.4;
/// Parts of a push that are held out in turn.
const PARTS_OF_A_PUSH: f64 = 4.0;
/// Shortest part of a push (s).
const SHORTEST_PART_S: f64 = 0.2;
/// Blocks wanted.
const BLOCKS_WANTED: f64 = 16.0;
/// Bootstrap resamples.
const RESAMPLES: usize = 400;

/// Contiguous blocks of output samples; a block never spans two bursts, and many short bursts are blocks themselves.
pub(crate) struct TimeBlocks {
    pub ranges: Vec<Range<usize>>,
    /// Block of each whitened row.
    of_row: Vec<usize>,
}

impl TimeBlocks {
    /// Blocks of a log; where one of the `selected` groups is a push, blocks so short that several lie inside it, or no
    /// block would have seen it when it is asked for.
    pub fn of<const N: usize>(system: &System<'_, N>, selected: &[usize]) -> Self {
        let data = system.data;
        let rate_hz = data.chains.first().map_or(1.0, |chain| chain.output_rate_hz());
        let duration_s = data.time_s.len() as f64 / rate_hz;
        let length_s = (duration_s / BLOCKS_WANTED).clamp(SHORTEST_BLOCK_S, BLOCK_S);
        let length = ((length_s * rate_hz).round() as usize).max(2);
        let mut ranges = Vec::new();
        for burst in &data.bursts {
            let count = ((burst.out.len() + length / 2) / length).max(1);
            for block in 0..count {
                let first = burst.out.start + block * length;
                let end = if block + 1 == count { burst.out.end } else { first + length };
                ranges.push(first..end);
            }
        }
        for group in selected.iter().map(|g| &system.groups[*g]) {
            if let ([start_s, end_s], CauseLabel::ExternalContact) = (group.shape.as_slice(), group.candidate.label()) {
                let part = (((end_s - start_s) / PARTS_OF_A_PUSH).max(SHORTEST_PART_S) * rate_hz).round() as usize;
                let inside =
                    |range: &Range<usize>| data.time_s[range.clone()].iter().any(|t| (*start_s..*end_s).contains(t));
                ranges = ranges
                    .into_iter()
                    .flat_map(|range| if inside(&range) { split(range, part.max(2)) } else { vec![range] })
                    .collect();
            }
        }
        Self::in_ranges(system, ranges)
    }

    /// The same with given ranges.
    fn in_ranges<const N: usize>(system: &System<'_, N>, ranges: Vec<Range<usize>>) -> Self {
        let mut of_row = Vec::with_capacity(system.joint_rows);
        let mut block = 0;
        for &sample in &system.row_samples {
            while block + 1 < ranges.len() && sample >= ranges[block].end {
                block += 1;
            }
            of_row.push(block);
        }
        Self { ranges, of_row }
    }
}

/// Contiguous parts of a range, all but the last `length` long or a little more.
fn split(range: Range<usize>, length: usize) -> Vec<Range<usize>> {
    let count = (range.len() / length).max(1);
    let edge = |i: usize| range.start + i * range.len() / count;
    (0..count).map(|i| edge(i)..edge(i + 1)).collect()
}

/// Gram matrix and score of some whitened columns, block by block.
pub(crate) struct BlockGram {
    square: Vec<DMatrix<f64>>,
    score: Vec<DVector<f64>>,
    /// Squares of the columns over all blocks.
    whole: Vec<f64>,
    /// Ridge of each column.
    ridge: Vec<f64>,
}

/// The range of a piece that follows those before.
fn next_range<T>(start: &mut usize, piece: &[T]) -> Option<Range<usize>> {
    let first = *start;
    *start += piece.len();
    Some(first..*start)
}

/// Part of a column's square that resampled blocks must hold for its coefficient to be asked for.
const LEAST_PART: f64 = 1e-3;

impl BlockGram {
    /// Products of columns of the system, and of one more whitened column if given, with each other and with the target.
    pub fn of<const N: usize>(
        system: &System<'_, N>,
        of_system: &[usize],
        extra: Option<&Column<N>>,
        blocks: &TimeBlocks,
    ) -> Self {
        let columns: Vec<&Column<N>> = of_system.iter().map(|c| &system.columns[*c]).chain(extra).collect();
        let ridge = system.ridges(of_system).into_iter().chain(extra.map(|_| 0.0)).collect();
        let k = columns.len();
        let mut square = vec![DMatrix::zeros(k, k); blocks.ranges.len()];
        let mut score = vec![DVector::zeros(k); blocks.ranges.len()];
        for j in 0..N {
            let present: Vec<(usize, &Vec<f64>)> =
                columns.iter().enumerate().filter_map(|(c, column)| Some((c, column.rows[j].as_deref()?))).collect();
            let Some(target) = system.target.rows[j].as_ref() else { continue };
            // Rows of a block stand together.
            for rows in blocks.of_row.chunk_by(|a, b| a == b).scan(0, next_range) {
                let block = blocks.of_row[rows.start];
                for (i, (a, x)) in present.iter().enumerate() {
                    score[block][*a] += inner(&x[rows.clone()], &target[rows.clone()]);
                    for (b, y) in &present[i..] {
                        square[block][(*a, *b)] += inner(&x[rows.clone()], &y[rows.clone()]);
                    }
                }
            }
        }
        for square in &mut square {
            square.fill_lower_triangle_with_upper_triangle();
        }
        let whole = (0..k).map(|c| square.iter().map(|block| block[(c, c)]).sum()).collect();
        Self { square, score, whole, ridge }
    }

    /// Coefficients from the blocks, each taken `weight` times.
    pub fn fit(&self, weights: &[f64], columns: &[usize]) -> Vec<f64> {
        let k = columns.len();
        let (mut square, mut score) = (DMatrix::<f64>::zeros(k, k), DVector::<f64>::zeros(k));
        for (block, &weight) in weights.iter().enumerate() {
            if weight > 0.0 {
                for (a, &ca) in columns.iter().enumerate() {
                    score[a] += weight * self.score[block][ca];
                    for (b, &cb) in columns.iter().enumerate() {
                        square[(a, b)] += weight * self.square[block][(ca, cb)];
                    }
                }
            }
        }
        for (a, &ca) in columns.iter().enumerate() {
            if square[(a, a)] < LEAST_PART * self.whole[ca] {
                square.fill_row(a, 0.0);
                square.fill_column(a, 0.0);
                score[a] = 0.0;
            }
        }
        let ridge: Vec<f64> = columns.iter().map(|c| self.ridge[*c]).collect();
        solve_ridge(&square, &score, &ridge).coefficients
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.square.len()
    }
}

/// Squared residuals on blocks that the fit has not seen: `[block][joint]`, per (sub)set of columns.
pub(crate) type BlockSquares<const N: usize> = Vec<[f64; N]>;

/// The columns of some causes, whitened block by block and plain: what they foretell where their coefficients have not
/// looked.
pub(crate) struct HeldOut<const N: usize> {
    pub blocks: TimeBlocks,
    pub gram: BlockGram,
    /// The columns unwhitened, in the order of the causes.
    pub plain: Vec<Column<N>>,
    /// Blocks that are held out together: every so many-th.
    folds: usize,
}

impl<const N: usize> HeldOut<N> {
    /// Of these groups of a system.
    pub fn of(system: &System<'_, N>, groups: &[usize]) -> Self {
        let plain = groups.iter().flat_map(|group| system.plain_columns(*group)).collect();
        Self::with_plain(system, groups, plain)
    }

    /// The same where the plain columns are at hand.
    pub fn with_plain(system: &System<'_, N>, groups: &[usize], plain: Vec<Column<N>>) -> Self {
        let blocks = TimeBlocks::of(system, groups);
        let gram = BlockGram::of(system, &system.columns_of(groups), None, &blocks);
        let folds = FOLDS.min(blocks.ranges.len().max(1));
        Self { blocks, gram, plain, folds }
    }

    /// The same with whole parts of the logs for blocks, each held out in turn: every log, or the thirds of one.
    pub fn of_parts(system: &System<'_, N>, groups: &[usize], plain: Vec<Column<N>>) -> Self {
        let data = system.data;
        let bounds = |log: usize| {
            let own = || data.bursts.iter().filter(move |burst| burst.log == log).map(|burst| &burst.out);
            own().map(|out| out.start).min().unwrap_or(0)..own().map(|out| out.end).max().unwrap_or(0)
        };
        let ranges: Vec<Range<usize>> = match data.chains.len() {
            1 => {
                let Range { start, end } = bounds(0);
                let edge = |k: usize| start + k * (end - start) / THIRDS;
                (0..THIRDS).map(|k| edge(k)..edge(k + 1)).collect()
            }
            logs => (0..logs).map(bounds).collect(),
        };
        let blocks = TimeBlocks::in_ranges(system, ranges);
        let gram = BlockGram::of(system, &system.columns_of(groups), None, &blocks);
        let folds = blocks.ranges.len().max(1);
        Self { blocks, gram, plain, folds }
    }

    /// Cross-validated squares of `residual − fitted` with all columns.
    pub fn squares(&self, residual: &[Vec<f64>; N]) -> BlockSquares<N> {
        self.squares_without(residual, 0..0)
    }

    /// The same without some of the columns: the coefficients of each fold come from the other folds' blocks.
    pub fn squares_without(&self, residual: &[Vec<f64>; N], left_out: Range<usize>) -> BlockSquares<N> {
        let keep: Vec<usize> = (0..self.plain.len()).filter(|c| !left_out.contains(c)).collect();
        let count = self.blocks.ranges.len();
        let folds = self.folds;
        let mut squares = vec![[0.0; N]; count];
        for fold in 0..folds {
            let weights: Vec<f64> = (0..count).map(|block| if block % folds == fold { 0.0 } else { 1.0 }).collect();
            let coefficients =
                if keep.is_empty() || folds < 2 { vec![0.0; keep.len()] } else { self.gram.fit(&weights, &keep) };
            for block in (fold..count).step_by(folds) {
                for j in 0..N {
                    let of_sample = |k: usize| {
                        let fitted: f64 = keep
                            .iter()
                            .zip(&coefficients)
                            .filter_map(|(c, coefficient)| Some(self.plain[*c].rows[j].as_ref()?[k] * coefficient))
                            .sum();
                        (residual[j][k] - fitted).powi(2)
                    };
                    squares[block][j] = self.blocks.ranges[block].clone().map(of_sample).sum();
                }
            }
        }
        squares
    }
}

/// Squares of the residual itself.
pub(crate) fn plain_squares<const N: usize>(residual: &[Vec<f64>; N], blocks: &TimeBlocks) -> BlockSquares<N> {
    blocks
        .ranges
        .iter()
        .map(|range| std::array::from_fn(|j| residual[j][range.clone()].iter().map(|r| r * r).sum()))
        .collect()
}

/// `1 − rms_after / rms_before` over the given joints, with its 95 % interval over resampled blocks.
pub(crate) fn gain_with_interval<const N: usize>(
    before: &BlockSquares<N>,
    after: &BlockSquares<N>,
    joints: &[usize],
    seed: u64,
) -> (f64, [f64; 2]) {
    let sum = |squares: &BlockSquares<N>, block: usize| joints.iter().map(|j| squares[block][*j]).sum::<f64>();
    let pairs: Vec<[f64; 2]> = (0..before.len()).map(|b| [sum(before, b), sum(after, b)]).collect();
    gain_of_pairs(&pairs, seed)
}

/// The same for sums of squares per block.
pub(crate) fn gain_of_pairs(pairs: &[[f64; 2]], seed: u64) -> (f64, [f64; 2]) {
    let gain = |before: f64, after: f64| if before > 0.0 { 1.0 - (after / before).sqrt() } else { 0.0 };
    let total = pairs.iter().fold([0.0, 0.0], |sum, pair| [sum[0] + pair[0], sum[1] + pair[1]]);
    let draws = resampled(pairs.len(), seed, |weights| {
        let sums = pairs.iter().zip(weights).fold([0.0, 0.0], |s, (p, w)| [s[0] + w * p[0], s[1] + w * p[1]]);
        gain(sums[0], sums[1])
    });
    (gain(total[0], total[1]), interval(draws))
}

/// A statistic of resampled blocks (bootstrap), `RESAMPLES` times.
pub(crate) fn resampled<T>(blocks: usize, seed: u64, mut statistic: impl FnMut(&[f64]) -> T) -> Vec<T> {
    let mut rng = Pcg64::seed_from_u64(seed ^ 0x626f_6f74);
    (0..RESAMPLES)
        .map(|_| {
            let mut weights = vec![0.0; blocks];
            for _ in 0..blocks {
                weights[rng.random_range(0..blocks.max(1))] += 1.0;
            }
            statistic(&weights)
        })
        .collect()
}

/// The 2.5 % and 97.5 % quantiles.
pub(crate) fn interval(mut draws: Vec<f64>) -> [f64; 2] {
    draws.retain(|x| x.is_finite());
    draws.sort_by(f64::total_cmp);
    let at =
        |p: f64| draws.get(((draws.len() as f64 - 1.0) * p).round().max(0.0) as usize).copied().unwrap_or(f64::NAN);
    [at(0.025), at(0.975)]
}
