//! Every variant on the measurements of every seed.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tribo_residual::{CalibrationError, DoubleEncoderModel, Rest, RestWrench, calibrate};
use tribo_robot::{LAMBDA_95, Wrench, presets};

use super::{Measurements, Uhlmann2023, Variant};

/// One variant on one seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariantResult {
    /// The model.
    pub variant: Variant,
    /// The seed.
    pub seed: u64,
    /// RMSE of Δθ₁ on the test poses over its RMS there, mean over joints.
    pub test_error: f64,
    /// Share of (test pose, joint) pairs within the 95 % band of Δθ₁.
    pub test_coverage: f64,
    /// The same on the circle without load.
    pub circle_coverage: f64,
    /// Median over the circle of |ΔF|/|F|.
    pub force_error: f64,
    /// Median over the circle of the relative wrench error, moments over the lever.
    pub wrench_error: f64,
    /// Share of the circle's poses with |ΔF|/|F| below 25 %.
    pub below_25: f64,
    /// Share of (pose, component) pairs within the 95 % band of the wrench.
    pub wrench_coverage: f64,
    /// Mean half-width of that band: force (N) and moment (Nm).
    pub half_width: [f64; 2],
}

/// The seeds of one variant: means, and the worst seed of the wrench error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariantSummary {
    /// The model.
    pub variant: Variant,
    /// Seeds.
    pub seeds: usize,
    /// Means of [`VariantResult`].
    pub test_error: f64,
    /// See [`VariantResult`].
    pub test_coverage: f64,
    /// See [`VariantResult`].
    pub circle_coverage: f64,
    /// See [`VariantResult`].
    pub force_error: f64,
    /// See [`VariantResult`].
    pub wrench_error: f64,
    /// Worst seed.
    pub wrench_error_worst: f64,
    /// See [`VariantResult`].
    pub below_25: f64,
    /// See [`VariantResult`].
    pub wrench_coverage: f64,
    /// See [`VariantResult`].
    pub half_width: [f64; 2],
}

/// What a model makes of the circle, pose by pose, for figures.
#[derive(Clone, Debug)]
pub struct Circle {
    /// Without load: what was measured and what was expected.
    pub free: Vec<(Rest<7>, RestWrench<7>)>,
    /// With the air spring: the truth and the estimate.
    pub loaded: Vec<(Wrench, RestWrench<7>)>,
    /// The model.
    pub model: DoubleEncoderModel<7>,
}

impl Uhlmann2023 {
    /// Runs every variant on every seed, on the threads of the current rayon pool; `done` is told of each as it ends.
    ///
    /// # Errors
    /// A calibration that fails, whichever is met first.
    pub fn run(&self, done: impl Fn(&VariantResult) + Sync) -> Result<Vec<VariantResult>, CalibrationError> {
        let cells: Vec<(Variant, u64)> =
            self.variants.iter().flat_map(|&variant| (1..=self.seeds).map(move |seed| (variant, seed))).collect();
        cells
            .par_iter()
            .map(|&(variant, seed)| {
                let result = self.run_one(variant, seed)?;
                done(&result);
                Ok(result)
            })
            .collect()
    }

    /// Calibrates one variant on one seed and goes round the circle.
    ///
    /// # Errors
    /// As the calibration.
    pub fn circle_of(&self, variant: Variant, seed: u64) -> Result<(Measurements, Circle), CalibrationError> {
        let (arm, settings) = (presets::panda(), variant.settings().validate()?);
        let measured = self.measure(&settings, seed);
        let model = calibrate(&arm, &measured.rests, settings, seed)?;
        let free = model.wrenches(&arm, &measured.circle_free).into_iter().flatten();
        let loaded: Vec<Rest<7>> = measured.circle_loaded.iter().map(|(rest, _)| *rest).collect();
        let estimates = model.wrenches(&arm, &loaded).into_iter().flatten();
        let circle = Circle {
            free: measured.circle_free.iter().copied().zip(free).collect(),
            loaded: measured.circle_loaded.iter().map(|(_, wrench)| *wrench).zip(estimates).collect(),
            model,
        };
        Ok((measured, circle))
    }

    fn run_one(&self, variant: Variant, seed: u64) -> Result<VariantResult, CalibrationError> {
        let (measured, circle) = self.circle_of(variant, seed)?;
        let predicted = circle.model.free_deflections(&presets::panda(), &measured.test);
        let (mut squares, mut power, mut inside) = ([0.0; 7], [0.0; 7], 0.0);
        for (rest, [mean, sd]) in measured.test.iter().zip(&predicted) {
            for j in 0..7 {
                let error = rest.deflection_rad[j] - mean[j];
                squares[j] += error * error;
                power[j] += rest.deflection_rad[j].powi(2);
                inside += f64::from(u8::from(error.abs() <= LAMBDA_95 * sd[j]));
            }
        }
        let on_circle = circle.free.iter().flat_map(|(rest, at)| {
            (0..7).map(move |j| {
                (rest.deflection_rad[j] - at.free_deflection_rad[j]).abs() <= LAMBDA_95 * at.free_sd_rad[j]
            })
        });
        let loaded = &circle.loaded;
        let (mut forces, mut wrenches) = (Vec::new(), Vec::new());
        let (mut covered, mut half_width) = (0.0, [0.0; 2]);
        for (truth, at) in loaded {
            let (h, want) = (at.wrench_base.to_vector(), truth.to_vector());
            let error = h - want;
            let size = |w: &nalgebra::Vector6<f64>| {
                let moment = w.fixed_rows::<3>(0).norm() / self.lever_m;
                moment.hypot(w.fixed_rows::<3>(3).norm())
            };
            forces.push(error.fixed_rows::<3>(3).norm() / truth.force_n.norm());
            wrenches.push(size(&error) / size(&want));
            for i in 0..6 {
                let half = LAMBDA_95 * at.covariance[(i, i)].sqrt();
                covered += f64::from(u8::from(error[i].abs() <= half));
                half_width[usize::from(i < 3)] += half / 3.0;
            }
        }
        let count = loaded.len() as f64;
        let below = forces.iter().filter(|&&error| error < 0.25).count() as f64 / count;
        // Six digits: enough to see a change, few enough to read.
        let short = |x: f64| (x * 1e6).round() / 1e6;
        Ok(VariantResult {
            variant,
            seed,
            test_error: short((0..7).map(|j| (squares[j] / power[j]).sqrt()).sum::<f64>() / 7.0),
            test_coverage: short(inside / (7.0 * predicted.len() as f64)),
            circle_coverage: short(share(on_circle)),
            force_error: short(median(forces)),
            wrench_error: short(median(wrenches)),
            below_25: short(below),
            wrench_coverage: short(covered / (6.0 * count)),
            half_width: half_width.map(|sum| short(sum / count)),
        })
    }
}

fn share(hits: impl Iterator<Item = bool>) -> f64 {
    let (hits, count) = hits.fold((0.0, 0.0), |(hits, count), hit| (hits + f64::from(u8::from(hit)), count + 1.0));
    hits / count
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}

/// One row per variant, in the order in which they first appear.
pub fn summarize(results: &[VariantResult]) -> Vec<VariantSummary> {
    let mut variants: Vec<Variant> = Vec::new();
    for result in results {
        if !variants.contains(&result.variant) {
            variants.push(result.variant);
        }
    }
    variants
        .into_iter()
        .map(|variant| {
            let of: Vec<&VariantResult> = results.iter().filter(|result| result.variant == variant).collect();
            let mean = |value: &dyn Fn(&VariantResult) -> f64| {
                of.iter().map(|result| value(result)).sum::<f64>() / of.len() as f64
            };
            VariantSummary {
                variant,
                seeds: of.len(),
                test_error: mean(&|r| r.test_error),
                test_coverage: mean(&|r| r.test_coverage),
                circle_coverage: mean(&|r| r.circle_coverage),
                force_error: mean(&|r| r.force_error),
                wrench_error: mean(&|r| r.wrench_error),
                wrench_error_worst: of.iter().map(|r| r.wrench_error).fold(0.0, f64::max),
                below_25: mean(&|r| r.below_25),
                wrench_coverage: mean(&|r| r.wrench_coverage),
                half_width: [0, 1].map(|i| mean(&|r| r.half_width[i])),
            }
        })
        .collect()
}
