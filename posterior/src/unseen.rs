//! What each model predicts where it has not looked: other logs, or another third of the one log.

use nalgebra::DVector;
use rayon::prelude::*;

use crate::band::Deviation;
use crate::baseline::Baselines;
use crate::fit::{Fit, posterior};
use crate::joint_term::JointTerm;
use crate::motion::Motion;
use crate::prior::Family;
use crate::problem::{Problem, State};
use crate::split::{Split, folds};

/// Squared residuals (Nm²) `[part][joint]` of models that were fitted without that part.
pub struct Unseen {
    /// Parts, in the order of the rows below.
    pub parts: Vec<usize>,
    /// Of the nominal model.
    pub nominal: Vec<Vec<f64>>,
    /// Of all families.
    pub ours: Vec<Vec<f64>>,
    /// Of Coulomb + viscous + offset.
    pub plain: Vec<Vec<f64>>,
    /// Of every base parameter.
    pub full: Vec<Vec<f64>>,
    /// Of all families but one.
    pub without: Vec<(Family, Vec<Vec<f64>>)>,
    /// Residuals with what was foretold of them, all samples, by joint.
    pub deviations: Vec<Vec<Deviation>>,
    /// How the parts were held out.
    pub split: Split,
}

/// What one fold says.
struct Fold {
    held_out: Vec<usize>,
    models: [State; 3],
    without: Vec<State>,
    ours: Option<Fit>,
}

impl Unseen {
    /// Fits every model to the rest of each fold; `all` lends its families, scales and noise colour.
    pub fn of(problem: &Problem, all: &Fit) -> Self {
        let (split, folds) = folds(problem);
        let optional: Vec<Family> = all.start.families.clone();
        let zero = DVector::zeros(problem.places.len());
        let found: Vec<Fold> = folds
            .into_iter()
            .map(|held_out| {
                let seen: Vec<usize> =
                    problem.all_parts().into_iter().filter(|part| !held_out.contains(part)).collect();
                let fitted = |without: Option<Family>| {
                    let keep = |family: &&Family| Some(**family) != without;
                    let families: Vec<Family> = all.start.families.iter().filter(keep).copied().collect();
                    let start = all.lend(problem, families);
                    posterior(problem, &seen, &start).map(|(fit, _)| fit)
                };
                let baselines = Baselines::of(problem, &seen);
                let ours = fitted(None);
                let without: Vec<State> = optional
                    .par_iter()
                    .map(|family| fitted(Some(*family)).map_or_else(|| zero.clone(), |fit| fit.state))
                    .collect();
                let state = ours.as_ref().map_or_else(|| zero.clone(), |fit| fit.state.clone());
                Fold { held_out, models: [state, baselines.plain, baselines.full], without, ours }
            })
            .collect();
        let joints = problem.joints();
        let squares = |state: &State, part: usize| -> Vec<f64> {
            (0..joints).map(|j| problem.unseen_square(state, j, part)).collect()
        };
        let mut unseen = Self {
            parts: Vec::new(),
            nominal: Vec::new(),
            ours: Vec::new(),
            plain: Vec::new(),
            full: Vec::new(),
            without: optional.iter().map(|family| (*family, Vec::new())).collect(),
            deviations: vec![Vec::new(); joints],
            split,
        };
        let motion = Motion::of(problem, &problem.all_parts());
        for fold in &found {
            for &part in &fold.held_out {
                unseen.parts.push(part);
                unseen.nominal.push(squares(&zero, part));
                unseen.ours.push(squares(&fold.models[0], part));
                unseen.plain.push(squares(&fold.models[1], part));
                unseen.full.push(squares(&fold.models[2], part));
                for (state, (_, rows)) in fold.without.iter().zip(&mut unseen.without) {
                    rows.push(squares(state, part));
                }
            }
            if let Some(fit) = &fold.ours {
                for (j, all) in unseen.deviations.iter_mut().enumerate() {
                    all.extend(deviations(problem, fit, &motion, j, &fold.held_out));
                }
            }
        }
        unseen
    }

    /// RMS of each joint over all parts (Nm).
    pub fn rms_nm(&self, problem: &Problem, squares: &[Vec<f64>]) -> Vec<f64> {
        let samples = problem.columns.samples(&self.parts).max(1) as f64;
        (0..problem.joints()).map(|j| (squares.iter().map(|row| row[j]).sum::<f64>() / samples).sqrt()).collect()
    }
}

/// Residuals of a joint along some parts, with what a fit foretells of them; `motion` is that of what was fitted.
pub fn deviations(problem: &Problem, fit: &Fit, motion: &Motion, joint: usize, parts: &[usize]) -> Vec<Deviation> {
    parts
        .iter()
        .flat_map(|part| {
            let weights = problem.residual(&fit.state, joint, problem.loaded(*part));
            let residual = problem.columns.combined(joint, &weights, &[*part]);
            let unknown = unknown_variance(problem, fit, joint, *part);
            let own = fit.variances[joint];
            let foretold = unknown.into_iter().zip(motion.over(problem, *part));
            let signs = problem.term_along(joint, JointTerm::Coulomb, &[*part]);
            residual.into_iter().zip(foretold).zip(signs).map(move |((residual_nm, (unknown, motion)), sign)| {
                Deviation { residual_nm, own, unknown, motion, turning: (1.0 - sign * sign).max(0.0) }
            })
        })
        .collect()
}

/// Variance of the predicted torque of a joint along a part by what the parameters leave open (Nm²).
pub fn unknown_variance(problem: &Problem, fit: &Fit, joint: usize, part: usize) -> Vec<f64> {
    let slopes = problem.slopes(&fit.state, joint, &fit.active, problem.loaded(part));
    let samples = problem.columns.parts[part].samples.clone();
    let rows = problem.columns.joints[joint].matrix.rows(samples.start, samples.len());
    let derivative = rows * slopes;
    let spread = &derivative * &fit.covariance;
    (0..samples.len()).map(|k| spread.row(k).dot(&derivative.row(k)).max(0.0)).collect()
}
