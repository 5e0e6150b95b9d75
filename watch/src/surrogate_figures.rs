//! Figures of the surrogate.

use tribo_figure::number::quantity_and_unit;
use tribo_figure::{Figure, Layer, Scale, Symbol};
use tribo_robot::JointNames;

use super::campaign_figures::cost_axis;
use super::{CampaignSnapshot, Surrogate};

/// `joint_3.coulomb_nm` → `panda_joint4 (3), coulomb` and its unit.
pub fn parameter_name(name: &str, joints: &JointNames) -> (String, &'static str) {
    let (joint, parameter) = name.split_once('.').unwrap_or(("", name));
    let (quantity, unit) = quantity_and_unit(parameter);
    let joint = joint.strip_prefix("joint_").and_then(|number| number.parse().ok());
    (joint.map_or(quantity.clone(), |joint| format!("{}, {quantity}", joints.of(joint))), unit)
}

fn axis_of(name: &str, joints: &JointNames) -> Scale {
    let (quantity, unit) = parameter_name(name, joints);
    Scale::of(&if unit.is_empty() { quantity } else { format!("{quantity} [{unit}]") })
}

/// Costs far above all trials are cut off at this multiple of the worst: the surrogate model there is as wide as the prior.
const CUT: f64 = 1.5;

/// The surrogate model about J along one parameter through the incumbent, with its 95 % band and the trials seen from the side.
pub fn slice(surrogate: &Surrogate, campaign: &CampaignSnapshot, parameter: usize) -> Option<Figure> {
    let (slice, name) = (surrogate.slices.get(parameter)?, surrogate.names.get(parameter)?);
    let complete: Vec<_> = campaign.trials.iter().filter(|watched| watched.trial.aborted.is_none()).collect();
    let costs: Vec<f64> = complete.iter().map(|watched| watched.trial.cost.total()).collect();
    let most = CUT * costs.iter().copied().fold(0.0, f64::max);
    let cut = |values: Vec<f64>| -> Vec<f64> { values.into_iter().map(|cost| cost.min(most)).collect() };
    let [low, high]: [Vec<f64>; 2] = [0, 1].map(|end| cut(slice.band95.iter().map(|band| band[end]).collect()));
    let cost = |number: usize| campaign.trial(number).map(|watched| watched.trial.cost.total());
    let title = format!("Surrogate model along {}", parameter_name(name, campaign.tune.joint_names()).0);
    let abscissae = complete.iter().map(|watched| watched.trial.theta[parameter]).collect();
    let notes = complete.iter().map(|watched| format!("trial {}", watched.trial.number)).collect();
    let figure = Figure::new(title, axis_of(name, campaign.tune.joint_names()), cost_axis(campaign.cost_name()))
        .with(Layer::band("95 % of the mean cost", 0, slice.at.clone(), low, high))
        .with(Layer::line("median", 0, slice.at.clone(), cut(slice.median.clone())))
        .with(Layer::symbols("trials, seen from the side", 6, Symbol::Dot, abscissae, costs, notes));
    let best = cost(surrogate.incumbent)?;
    let note = format!("incumbent, trial {}", surrogate.incumbent);
    let at = vec![surrogate.incumbent_theta[parameter]];
    Some(figure.with(Layer::symbols("incumbent", 1, Symbol::Diamond, at, vec![best], vec![note])))
}

/// What a new trial would be worth along one parameter through the incumbent.
pub fn acquisition(surrogate: &Surrogate, campaign: &CampaignSnapshot, parameter: usize) -> Option<Figure> {
    let (slice, name) = (surrogate.slices.get(parameter)?, surrogate.names.get(parameter)?);
    let label = if surrogate.log_acquisition { "ln expected improvement [-]" } else { "expected improvement [sd]" };
    let title = format!("Acquisition value along {}", parameter_name(name, campaign.tune.joint_names()).0);
    let line = Layer::line("", 2, slice.at.clone(), slice.acquisition.clone());
    Some(Figure::new(title, axis_of(name, campaign.tune.joint_names()), Scale::of(label)).with(line))
}

/// Inverse length-scale of every parameter, one group per joint.
pub fn relevance(surrogate: &Surrogate, campaign: &CampaignSnapshot) -> Figure {
    let joints = campaign.tune.space().joints();
    let per_joint = (surrogate.names.len() / joints.max(1)).max(1);
    let names = (0..joints).map(|j| campaign.tune.joint_names().of(j).to_string()).collect();
    let mut figure = Figure::new(
        "Relevance of the parameters",
        Scale::categories("", names),
        Scale::of("1 / length-scale [1 / range]"),
    );
    let width = 0.8 / per_joint as f64;
    for k in 0..per_joint {
        let x = (0..joints).map(|j| j as f64 + (k as f64 + 0.5) * width - 0.4).collect();
        let height =
            (0..joints).filter_map(|j| surrogate.lengthscales.get(j * per_joint + k)).map(|l| 1.0 / l).collect();
        let name = surrogate.names.get(k).and_then(|name| name.split_once('.')).map_or("", |(_, name)| name);
        figure.layers.push(Layer::bars(&quantity_and_unit(name).0, k, x, height, 0.94 * width));
    }
    figure
}

/// The most relevant parameter.
pub fn most_relevant(surrogate: &Surrogate) -> usize {
    let shortest = surrogate.lengthscales.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
    shortest.map_or(0, |(k, _)| k)
}
