//! `tribo listen`.

mod parameters;
mod summary;

use std::net::UdpSocket;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use tribo_friction::FrictionModel;
use tribo_model::{AnyModel, Model};
use tribo_ros2::{
    ArmJoints, Heard, ListenSettings, Listened, Node, NodeSettings, TopicNames, Update, WrenchStream, listen,
};
use tribo_trial::{AnyEstimator, EstimatorName};

use self::parameters::{FileWatch, Parameters, measured};
use super::{named, warn_not_cancelled};
use crate::arguments::{Common, Listen};
use crate::failure::{BadInput, Stopped};
use crate::progress::{stop_on_signal, stop_requested};

/// Time between two looks at the files.
const LOOK: Duration = Duration::from_millis(250);

/// Listens until its time is over or a signal comes.
pub fn run(arguments: &Listen, common: &Common) -> anyhow::Result<()> {
    check(arguments)?;
    let parameters = Parameters::read(arguments)?;
    match &parameters.model {
        AnyModel::Six(model) => on(arguments, common, &parameters, model, Parameters::six),
        AnyModel::Seven(model) => on(arguments, common, &parameters, model, Parameters::seven),
    }
}

/// What clap does not check.
fn check(arguments: &Listen) -> anyhow::Result<()> {
    let positive = [("--rate", arguments.rate, 1e5), ("--for", arguments.duration_s, 1e9)];
    for (name, value, most) in positive {
        if let Some(value) = value.filter(|value| !(*value > 0.0 && *value <= most)) {
            return Err(BadInput(format!("{name} is {value}; allowed: above 0 and at most {most}")).into());
        }
    }
    if arguments.residual == EstimatorName::DoubleEncoder.as_str() {
        let message = "--residual double_encoder needs motor positions (theta), which no JointState has; estimate reads them from logs";
        return Err(BadInput(message.to_owned()).into());
    }
    if let Some(record) = &arguments.record
        && !record.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap"))
    {
        return Err(BadInput(format!(
            "--record {}: the file is MCAP; allowed: a name that ends with .mcap",
            record.display()
        ))
        .into());
    }
    Ok(())
}

/// Listens for an arm of N joints; `of_joints` takes the model out of parameters that were read again.
fn on<const N: usize>(
    arguments: &Listen,
    common: &Common,
    parameters: &Parameters,
    model: &Model<N>,
    of_joints: fn(&Parameters) -> Option<&Model<N>>,
) -> anyhow::Result<()> {
    let name: EstimatorName = named(&arguments.residual)?;
    let names = parameters.joint_names::<N>(&arguments.joints)?;
    let (first, not_cancelled) = measured(model, name)?;
    warn_not_cancelled(&not_cancelled, &model.robot.arm.joint_names, common);
    if model.friction == FrictionModel::none() && model.effects.is_empty() && !common.quiet {
        message!(
            "tribo: the model has no friction, so that of the arm counts as wrench; --model or --compensator says what it has"
        );
    }
    let settings = ListenSettings {
        frame_id: arguments
            .frame
            .clone()
            .or_else(|| parameters.file.base_frame())
            .unwrap_or_else(|| "base_link".to_owned()),
        estimator: arguments.residual.clone(),
        robot: model.robot.arm.name.clone(),
        rate_hz: arguments.rate,
        record: arguments.record.clone(),
        duration: arguments.duration_s.map(Duration::from_secs_f64),
    };
    let node = Node::join(node_settings(arguments)?)?;
    stop_on_signal();
    introduce(&node, &settings, common);

    let stream = WrenchStream::new(first, ArmJoints::new(names));
    let (updates, incoming) = channel();
    let over = AtomicBool::new(false);
    let listened = std::thread::scope(|scope| {
        scope.spawn(|| watch(arguments, common, name, of_joints, &updates, &over));
        let topic = node.settings().topics.joint_states.clone();
        let listened = listen(node, stream, &settings, &incoming, stop_requested(), &mut |heard| {
            if !common.quiet {
                tell(&heard, &topic);
            }
        });
        over.store(true, Ordering::Relaxed);
        listened
    })?;
    summary::show(&listened, &settings, common);
    ended(&listened, arguments)
}

/// Whether that was what was asked for.
fn ended(listened: &Listened, arguments: &Listen) -> anyhow::Result<()> {
    let early = listened.stopped && (arguments.duration_s.is_some() || listened.counts.published == 0);
    if !early {
        return Ok(());
    }
    let recorded = arguments.record.as_ref().map_or(String::new(), |path| format!("; {} is whole", path.display()));
    Err(Stopped(format!(
        "stopped after {:.1} s, {} wrenches went out{recorded}",
        listened.duration_s, listened.counts.published
    ))
    .into())
}

/// Domain, interfaces, topics.
fn node_settings(arguments: &Listen) -> anyhow::Result<NodeSettings> {
    let variable = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    let domain = match (arguments.domain, variable("ROS_DOMAIN_ID")) {
        (Some(domain), _) => domain,
        (None, None) => 0,
        (None, Some(text)) => match text.parse().ok().filter(|domain| *domain <= 232) {
            Some(domain) => domain,
            None => return Err(BadInput(format!("ROS_DOMAIN_ID is {text}; allowed: 0 to 232")).into()),
        },
    };
    let here = variable("ROS_AUTOMATIC_DISCOVERY_RANGE")
        .map_or_else(|| variable("ROS_LOCALHOST_ONLY").is_some_and(|value| value == "1"), |range| range == "LOCALHOST");
    let addresses = match &arguments.address[..] {
        [] if here => vec![std::net::Ipv4Addr::LOCALHOST.into()],
        given => given.to_vec(),
    };
    if let Some(address) = addresses.iter().find(|address| UdpSocket::bind((**address, 0)).is_err()) {
        return Err(BadInput(format!("--address {address}: no network interface of this computer has it")).into());
    }
    let topics = TopicNames {
        joint_states: arguments.joint_states.clone(),
        compensation: arguments.compensation.clone(),
        wrench: arguments.wrench.clone(),
        diagnostics: arguments.diagnostics.clone(),
    };
    Ok(NodeSettings { domain, addresses, topics })
}

/// Reads files that have changed and hands over what they say, until it is over.
fn watch<const N: usize>(
    arguments: &Listen,
    common: &Common,
    name: EstimatorName,
    of_joints: fn(&Parameters) -> Option<&Model<N>>,
    updates: &Sender<Update<N, AnyEstimator<N>>>,
    over: &AtomicBool,
) {
    let files = [&arguments.of.model, &arguments.compensator].into_iter().flatten();
    let mut watch = FileWatch::of(files.map(Path::new));
    while !over.load(Ordering::Relaxed) {
        std::thread::sleep(LOOK);
        let Some(changed) = watch.changed() else { continue };
        let read = Parameters::read(arguments).and_then(|parameters| {
            let other = || BadInput(format!("the arm has {} joints, and had {N}", parameters.model.joints()));
            let model = of_joints(&parameters).ok_or_else(other)?;
            Ok(measured(model, name)?.0)
        });
        let update = match read {
            Ok(measured) => {
                if !common.quiet {
                    message!("tribo: {changed} has changed and is in use");
                }
                Update::Replace(Box::new(measured))
            }
            Err(error) => {
                let why = crate::failure::describe(&error);
                message!("tribo: {changed} has changed and cannot be used; what it said before is kept: {why}");
                Update::Refused(why)
            }
        };
        if updates.send(update).is_err() {
            return;
        }
    }
}

fn introduce(node: &Node, settings: &ListenSettings, common: &Common) {
    let NodeSettings { domain, addresses, topics } = node.settings();
    if !common.quiet {
        let whom = match &addresses[..] {
            [] => "all interfaces".to_owned(),
            some => some.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        };
        message!(
            "tribo: domain {domain}, {whom}: {} in, {} out, frame {}",
            topics.joint_states,
            topics.wrench,
            settings.frame_id
        );
    }
}

fn tell(heard: &Heard, topic: &str) {
    match heard {
        Heard::Silence(others) if others.is_empty() => {
            message!("tribo: no message on {topic} yet; nobody publishes joint states that this computer can see");
        }
        Heard::Silence(others) => {
            message!("tribo: no message on {topic} yet; joint states are published on {}", others.join(", "));
        }
        Heard::Begun(names) if names.is_empty() => message!("tribo: joint states come, without names"),
        Heard::Begun(names) => message!("tribo: joint states come: {}", names.join(", ")),
        Heard::NoCompensation => message!(
            "tribo: joint states come, but no torque on the topic of --compensation: nothing is estimated until one does"
        ),
        Heard::BegunAnew => message!("tribo: the stamps on {topic} have a gap; the estimator begins anew"),
    }
}
