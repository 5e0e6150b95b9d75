//! How much evidence chance alone would give: the permutation null distribution, from sign flips of blocks.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use tribo_regression::Location;
use tribo_regression::contact_window::residual;
use tribo_regression::evidence::Conditional;
use tribo_regression::least_squares::solve_truncated;

use crate::search::Search;

/// Length of a block (s).
const BLOCK_S: f64 = 0.25;
/// Number of flips.
const FLIPS: usize = 200;

/// A group whose evidence in the flipped residuals is computed: index, columns, their Gram matrix and norms given the selection.
type Questioned = (usize, Vec<usize>, DMatrix<f64>, DVector<f64>);

/// The permutation null distribution of evidence: that of the residual with the signs of its blocks flipped at random.
#[derive(Clone, Debug)]
pub(crate) struct Chance {
    /// Mean evidence of chance over its nominal value: 1 for perfectly white data.
    pub inflation: f64,
    /// The same of the causes that act on one joint alone, per joint.
    pub joint_inflation: Vec<f64>,
    /// Location of the distribution of the largest evidence over all causes (Gumbel).
    location: f64,
    /// Its scale.
    scale: f64,
}

impl Chance {
    /// Flips the signs of quarter-second blocks of the whitened residual, the same for all joints, and asks every cause
    /// how much it explains of that.
    ///
    /// Blocks keep the correlation inside them and between joints; the largest evidence over all causes corrects for
    /// their number.
    pub fn of<const N: usize>(search: &Search<'_, '_, N>, seed: u64) -> Self {
        let system = &*search.system;
        let selected = system.columns_of(&search.selected);
        let left = residual(system, &selected);
        let given = Conditional::on(system, &selected);

        // Block scores of every column.
        let rate_hz = system.data.chains.first().map_or(1.0, |chain| chain.output_rate_hz());
        let length = ((BLOCK_S * rate_hz).round() as usize).max(1);
        let (mut block_of_row, mut block, mut in_block) = (Vec::new(), 0usize, 0);
        for row in 0..system.joint_rows {
            let new_burst = row > 0 && system.row_bursts[row] != system.row_bursts[row - 1];
            if in_block == length || new_burst {
                (block, in_block) = (block + 1, 0);
            }
            block_of_row.push(block);
            in_block += 1;
        }
        let blocks = block + 1;
        let scores: Vec<Vec<f64>> = system
            .columns
            .par_iter()
            .map(|column| {
                let mut sums = vec![0.0; blocks];
                for j in 0..N {
                    if let (Some(x), Some(r)) = (&column.rows[j], &left.rows[j]) {
                        for row in 0..system.joint_rows {
                            sums[block_of_row[row]] += x[row] * r[row];
                        }
                    }
                }
                sums
            })
            .collect();
        let groups: Vec<Questioned> = (0..system.groups.len())
            .filter(|g| !search.selected.contains(g))
            .map(|g| {
                let columns: Vec<usize> = system.groups[g].columns.clone().collect();
                let square = given.square(system, &columns);
                let norms = DVector::from_fn(columns.len(), |i, _| system.gram[(columns[i], columns[i])].sqrt());
                (g, columns, square, norms)
            })
            .collect();

        let mut rng = Pcg64::seed_from_u64(seed ^ 0x666c_6970);
        let signs: Vec<Vec<f64>> = (0..FLIPS)
            .map(|_| (0..blocks).map(|_| if rng.random_range(0.0..1.0) < 0.5 { -1.0 } else { 1.0 }).collect())
            .collect();
        let flips: Vec<(f64, Vec<Option<f64>>)> = signs
            .par_iter()
            .map(|signs| {
                let flipped: Vec<f64> =
                    scores.iter().map(|sums| sums.iter().zip(signs).map(|(s, e)| s * e).sum()).collect();
                let projected = given.projected_scores(system, &selected, &flipped);
                let mut largest = f64::NEG_INFINITY;
                let mut ratios = Vec::with_capacity(groups.len());
                for (g, columns, square, norms) in &groups {
                    let score = DVector::from_fn(columns.len(), |i, _| projected[columns[i]]);
                    let gain = solve_truncated(square, &score, norms, tribo_regression::least_squares::OWN_PART);
                    let asked = gain.directions > 0;
                    ratios.push(asked.then(|| gain.explained / gain.directions as f64));
                    if asked {
                        largest = largest.max(gain.explained / search.inflation - search.price(*g, &gain));
                    }
                }
                (largest, ratios)
            })
            .collect();

        // Mean ratio of each cause over the flips.
        let means: Vec<(Location, f64)> = groups
            .iter()
            .enumerate()
            .filter_map(|(i, (g, ..))| {
                let sum: f64 = flips.iter().map(|(_, ratios)| ratios[i]).sum::<Option<f64>>()?;
                Some((search.place(*g).1, sum / FLIPS as f64))
            })
            .collect();
        let inflation = typical(means.iter().map(|(_, mean)| *mean));
        let of_joint = |j: usize| means.iter().filter(move |(place, _)| *place == Location::Joint(j)).map(|(_, m)| *m);
        let joint_inflation = (0..N).map(|j| typical(of_joint(j))).collect();
        let largest: Vec<f64> = flips.iter().map(|(value, _)| *value).filter(|value| value.is_finite()).collect();
        let n = largest.len().max(1) as f64;
        let mean = largest.iter().sum::<f64>() / n;
        let sd = (largest.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
        let scale = (sd * 6f64.sqrt() / std::f64::consts::PI).max(1e-3);
        Self { inflation, joint_inflation, location: mean - 0.577_215_664_901_532_9 * scale, scale }
    }

    /// Family-wise probability of at least this much evidence by chance (Gumbel tail of the flipped maxima).
    pub fn p_value(&self, evidence: f64) -> f64 {
        let x = (evidence - self.location) / self.scale;
        (-(-(-x).exp()).exp_m1()).clamp(0.0, 1.0)
    }
}

/// The 75 % quantile over the causes, at least 1.
fn typical(means: impl Iterator<Item = f64>) -> f64 {
    let mut means: Vec<f64> = means.collect();
    means.sort_by(f64::total_cmp);
    means.get(means.len() * 3 / 4).copied().unwrap_or(1.0).max(1.0)
}
