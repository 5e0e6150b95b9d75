//! Figures of a campaign.

use std::ops::Range;

use tribo_figure::number::{quantity_and_unit, significant};
use tribo_figure::{Figure, Layer, Mark, Scale, Symbol};
use tribo_trial::CostName;

use super::{CampaignSnapshot, WatchedTrial};

/// Colour of a cost that a trial is compared with.
const GREY: usize = 6;

fn numbers(campaign: &CampaignSnapshot) -> Vec<f64> {
    campaign.trials.iter().map(|watched| watched.trial.number as f64).collect()
}

/// The axis of J.
pub(super) fn cost_axis(cost: CostName) -> Scale {
    Scale::of(&format!("cost J [{}]", cost.unit())).or_logarithmic()
}

fn trial_axis(campaign: &CampaignSnapshot) -> Scale {
    Scale::whole("trial").holding(-0.5).holding(campaign.total() as f64 - 0.5)
}

/// J of every trial, failed ones with their reason, the incumbent and the reference costs.
pub fn cost_per_trial(campaign: &CampaignSnapshot) -> Figure {
    let mut figure = Figure::new("Cost of every trial", trial_axis(campaign), cost_axis(campaign.cost_name()));
    if let Some(references) = campaign.references {
        figure.layers.push(Layer::level("no compensation", 1, references.uncompensated));
        figure.layers.push(Layer::level("true friction", 2, references.oracle));
        figure.layers.push(Layer::level("no friction", GREY, references.frictionless));
    }
    // The incumbent as a staircase.
    let (mut x, mut y, mut best) = (Vec::new(), Vec::new(), f64::INFINITY);
    for watched in &campaign.trials {
        if watched.trial.aborted.is_none() && watched.trial.cost.total() < best {
            if best.is_finite() {
                x.push(watched.trial.number as f64);
                y.push(best);
            }
            best = watched.trial.cost.total();
        }
        if best.is_finite() {
            x.push(watched.trial.number as f64);
            y.push(best);
        }
    }
    figure.layers.push(Layer::line("best so far", 0, x, y));
    for (name, ink, symbol, failed) in [("complete", 0, Symbol::Dot, false), ("failed", 1, Symbol::Cross, true)] {
        let chosen: Vec<_> =
            campaign.trials.iter().filter(|watched| watched.trial.aborted.is_some() == failed).collect();
        let notes = chosen.iter().map(|watched| {
            let (trial, cost) = (&watched.trial, watched.trial.cost.total());
            format!("trial {}: J {}, {}, by {}", trial.number, significant(cost, 4), watched.state(), trial.origin)
        });
        if chosen.is_empty() {
            continue;
        }
        figure.layers.push(Layer::symbols(
            name,
            ink,
            symbol,
            chosen.iter().map(|watched| watched.trial.number as f64).collect(),
            chosen.iter().map(|watched| watched.trial.cost.total()).collect(),
            notes.collect(),
        ));
    }
    figure
}

/// The parts of J of every trial, stacked. Without the penalty of failed trials, which is three decades higher: it is a
/// part of its own where `with_penalty` is set.
pub fn cost_parts(campaign: &CampaignSnapshot, with_penalty: bool) -> Figure {
    let title = if with_penalty { "Parts of the cost, penalty included" } else { "Parts of the cost, without penalty" };
    let mut figure =
        Figure::new(title, trial_axis(campaign), Scale::of(&format!("part of J [{}]", campaign.cost_name().unit())));
    let x = numbers(campaign);
    let mut base = vec![0.0; x.len()];
    let names = campaign.cost_name().part_names();
    for (k, (name, ink)) in names.into_iter().zip([0, 5, 2, 4, 1]).enumerate() {
        let height: Vec<f64> = campaign.trials.iter().map(|watched| watched.trial.cost.parts()[k].1).collect();
        if k == 4 && (!with_penalty || height.iter().all(|penalty| *penalty == 0.0)) {
            continue;
        }
        let top = base.iter().zip(&height).map(|(base, height)| base + height).collect();
        let mark = Mark::Bars { x: x.clone(), base, height, width: 0.8 };
        figure.layers.push(Layer { name: name.to_owned(), ink, mark });
        base = top;
    }
    figure
}

/// One figure per parameter of the law: its value in every joint over the trials, and its bounds, the widest of all joints; a bound far
/// above all values is left out.
pub fn parameters(campaign: &CampaignSnapshot) -> Vec<Figure> {
    parameters_of(campaign, 0..campaign.tune.space().joints())
}

/// Parameters of one joint over the trials, each on its own axis, with its bounds and what the simulated arm has.
pub fn parameters_of_joint(campaign: &CampaignSnapshot, joint: usize) -> Vec<Figure> {
    let mut figures = parameters_of(campaign, joint..joint + 1);
    let truth = campaign.tune.true_parameters();
    for (k, figure) in figures.iter_mut().enumerate() {
        figure.title = format!("{}, {}", figure.title, campaign.tune.joint_names().of(joint));
        for layer in figure.layers.iter_mut().filter(|layer| layer.name != "bounds") {
            layer.ink = 0;
            if let Mark::Line { dashed, .. } = &mut layer.mark {
                *dashed = false;
            }
        }
        if let Some(truth) = &truth {
            let place = joint * campaign.tune.space().parameters_per_joint() + k;
            figure.layers.push(Layer::level("true friction", 2, truth[place]));
        }
    }
    figures
}

/// How many times the largest value a bound is at most worth drawing.
const FAR: f64 = 5.0;

fn parameters_of(campaign: &CampaignSnapshot, joints: Range<usize>) -> Vec<Figure> {
    let space = campaign.tune.space();
    let (entries, per_joint, x) = (space.entries(), space.parameters_per_joint(), numbers(campaign));
    let figure = |(k, name): (usize, &str)| {
        let (quantity, unit) = quantity_and_unit(name);
        let label = if unit.is_empty() { quantity.clone() } else { format!("{quantity} [{unit}]") };
        let mut figure = Figure::new(format!("Parameter: {quantity}"), trial_axis(campaign), Scale::of(&label));
        let shown = || joints.clone().filter_map(|j| entries.get(j * per_joint + k));
        let low = shown().map(|entry| entry.1).fold(f64::INFINITY, f64::min);
        let high = shown().map(|entry| entry.2).fold(f64::NEG_INFINITY, f64::max);
        figure.layers.push(Layer::level("bounds", GREY, low));
        let of_trial =
            |watched: &WatchedTrial| joints.clone().map(|j| watched.trial.theta[j * per_joint + k]).fold(0.0, f64::max);
        let most = campaign.trials.iter().map(of_trial).fold(0.0, f64::max);
        if most == 0.0 || high <= FAR * most {
            figure.layers.push(Layer::level("bounds", GREY, high));
        }
        for j in joints.clone() {
            let values = campaign.trials.iter().map(|watched| watched.trial.theta[j * per_joint + k]).collect();
            let name = campaign.tune.joint_names().of(j).to_string();
            figure.layers.push(match j {
                0..4 => Layer::line(&name, j, x.clone(), values),
                _ => Layer::dashed(&name, j, x.clone(), values),
            });
        }
        figure
    };
    space.names_of_joint().enumerate().map(figure).collect()
}

/// Two campaigns: the best cost so far of each.
pub fn compare_best(campaigns: &[(&str, &CampaignSnapshot)]) -> Figure {
    let longest = campaigns.iter().map(|(_, campaign)| campaign.total()).max().unwrap_or(1);
    let x = Scale::whole("trial").holding(-0.5).holding(longest as f64 - 0.5);
    // Two campaigns of different costs cannot be compared; the unit of the first says which it is.
    let cost = campaigns.first().map_or(CostName::Paper, |(_, campaign)| campaign.cost_name());
    let mut figure = Figure::new("Best cost so far", x, cost_axis(cost));
    for (k, (name, campaign)) in campaigns.iter().enumerate() {
        for layer in cost_per_trial(campaign).layers {
            let shown = match layer.name.as_str() {
                "best so far" => (*name).to_owned(),
                "failed" => format!("{name}: failed"),
                _ => continue,
            };
            figure.layers.push(Layer { name: shown, ink: k, ..layer });
        }
    }
    figure
}
