//! The tree of links.

use std::collections::{BTreeMap, BTreeSet};

use urdf_rs::Robot;

use super::UrdfError;
use super::body::inertia_of;
use super::joint::{chain_joint, kind, origin};
use crate::LinkInertia;
use crate::chain::Source;
use crate::chain::frame::{Frame, same};
use crate::chain::joint::{ChainJoint, JointPose};
use crate::chain::skeleton::{JointKind, Node, Skeleton};
use crate::chain::xml::within_bounds;

/// A URDF whose names are unique and whose joints join links. Links are numbered as in `robot.links`.
pub(super) struct Tree {
    pub robot: Robot,
    skeleton: Skeleton,
    /// Whether macros may still be in the file; of an expanded one, they may be in comments.
    pub xacro: bool,
    /// Place of the joint above each link in `robot.joints`.
    above: Vec<Option<usize>>,
}

impl Tree {
    /// Parses a URDF.
    pub fn parse(text: &str) -> Result<Self, UrdfError> {
        within_bounds(text).map_err(UrdfError::Syntax)?;
        let robot = read(text)?;
        let names = robot.links.iter().map(|link| ("link", &link.name));
        let names =
            names.chain(robot.joints.iter().map(|joint| ("joint", &joint.name))).chain([("robot", &robot.name)]);
        if let Some((kind, name)) = names.into_iter().find(|(_, name)| name.chars().any(char::is_control)) {
            return Err(UrdfError::ControlCharacter { kind, name: name.escape_debug().to_string() });
        }
        let twice = |kind, name: &str| UrdfError::Twice { kind, name: name.to_owned() };
        let mut links = BTreeMap::new();
        for (k, link) in robot.links.iter().enumerate() {
            if links.insert(link.name.clone(), k).is_some() {
                return Err(twice("link", &link.name));
            }
        }
        let mut above = vec![None; robot.links.len()];
        let mut parents = vec![None; robot.links.len()];
        let mut joints = BTreeSet::new();
        for (k, joint) in robot.joints.iter().enumerate() {
            if !joints.insert(&joint.name) {
                return Err(twice("joint", &joint.name));
            }
            let place = |link: &String| {
                let none = || UrdfError::NoSuchLink { joint: joint.name.clone(), link: link.clone() };
                links.get(link).copied().ok_or_else(none)
            };
            let (parent, child) = (place(&joint.parent.link)?, place(&joint.child.link)?);
            if parent == child {
                return Err(UrdfError::OwnParent { joint: joint.name.clone(), link: joint.child.link.clone() });
            }
            if let Some(first) = above[child].replace(k) {
                return Err(UrdfError::TwoParents {
                    link: joint.child.link.clone(),
                    first: robot.joints[first].name.clone(),
                    second: joint.name.clone(),
                });
            }
            parents[child] = Some(parent);
        }
        let node = |(k, link): (usize, &urdf_rs::Link)| {
            let joint = above[k].map(|joint: usize| &robot.joints[joint]);
            Node {
                name: link.name.clone(),
                above: parents[k],
                joint: joint.map_or(String::new(), |joint| joint.name.clone()),
                kind: joint.map_or(JointKind::Fixed, kind),
            }
        };
        let skeleton = Skeleton::new(robot.links.iter().enumerate().map(node).collect());
        Ok(Self { robot, skeleton, above, xacro: text.contains(MACRO) })
    }

    /// The link that the way to `base` or `tip` starts from: the link above both on which nothing hangs itself.
    pub fn root(&self, end: Option<usize>) -> Result<usize, UrdfError> {
        let nodes = &self.skeleton.nodes;
        if let Some(mut at) = end {
            let mut steps = 0;
            while let Some(above) = nodes[at].above.filter(|_| steps < nodes.len()) {
                (at, steps) = (above, steps + 1);
            }
            return Ok(at);
        }
        let roots: Vec<usize> = (0..nodes.len()).filter(|&k| nodes[k].above.is_none()).collect();
        match roots[..] {
            [root] => Ok(root),
            _ if self.xacro => Err(UrdfError::Xacro),
            _ => Err(UrdfError::NoRoot { links: roots.into_iter().map(|k| nodes[k].name.clone()).collect() }),
        }
    }
}

/// How a macro of xacro begins.
const MACRO: &str = "<xacro:";
/// What the parser says of a prefix that nobody declares.
const UNBOUND: &str = "Unbound namespace prefix";
/// Most prefixes that are declared for an author who forgot to.
const PREFIXES: usize = 32;

/// Parses the XML. Prefixes of vendors' extensions that nobody declares (`drake:acceleration`) are declared.
fn read(text: &str) -> Result<Robot, UrdfError> {
    let refuse = |error: String| match text.contains(MACRO) {
        true => UrdfError::Xacro,
        false => UrdfError::Syntax(error),
    };
    match urdf_rs::read_from_string(text).map_err(|error| error.to_string()) {
        Ok(robot) => Ok(robot),
        Err(error) if error.contains(UNBOUND) && !text.contains(MACRO) => {
            let declared = declared(text).unwrap_or_default();
            urdf_rs::read_from_string(&declared).map_err(|_| refuse(error))
        }
        Err(error) => Err(refuse(error)),
    }
}

/// The text with every prefix declared in its root element.
fn declared(text: &str) -> Option<String> {
    let root = text.find("<robot")? + "<robot".len();
    let mut prefixes = BTreeSet::new();
    for (at, _) in text.match_indices(':') {
        let before = &text[..at];
        let start = before.rfind(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '_' || letter == '-'))?;
        let prefix = &before[start + 1..];
        let opens = before[start..].starts_with(['<', '/', ' ', '\n', '\t', '\r']);
        let named = prefix.starts_with(|letter: char| letter.is_ascii_alphabetic()) && !prefix.starts_with("xml");
        if opens && named && prefixes.len() < PREFIXES && !text.contains(&format!("xmlns:{prefix}")) {
            prefixes.insert(prefix);
        }
    }
    let names: String = prefixes.iter().map(|prefix| format!(" xmlns:{prefix}=\"{prefix}\"")).collect();
    Some(format!("{}{names}{}", &text[..root], &text[root..]))
}

impl Source for Tree {
    type Error = UrdfError;

    fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    fn inertia(&self, link: usize) -> Result<LinkInertia, UrdfError> {
        inertia_of(&self.robot.links[link])
    }

    fn above_from_link(&self, link: usize) -> Result<Frame, UrdfError> {
        self.above[link].map_or_else(|| Ok(same()), |joint| origin(&self.robot.joints[joint]))
    }

    fn joint(&self, link: usize) -> Result<(ChainJoint, JointPose), UrdfError> {
        match self.above[link] {
            Some(joint) => chain_joint(&self.robot.joints[joint]),
            None => Err(UrdfError::NoRoot { links: Vec::new() }),
        }
    }
}
