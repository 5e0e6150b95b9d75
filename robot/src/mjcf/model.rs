//! A model of MuJoCo as a tree of links.

use std::collections::{BTreeMap, BTreeSet};

use super::MjcfError;
use super::actuators::{Drive, drives};
use super::bodies::{Bodies, named};
use super::compiler::Compiler;
use super::element::{Defaults, Xml, called};
use super::inertial::body_inertia;
use super::joint::{hinge, kind};
use crate::chain::frame::{Frame, same};
use crate::chain::joint::{ChainJoint, JointPose};
use crate::chain::skeleton::{JointKind, Node, Path, Skeleton};
use crate::chain::{Source, welded_chain};
use crate::{ChainRemark, LinkInertia, SerialChain};

/// Names of the site at the flange, with or without a prefix: mujoco_menagerie's, and our own.
const FLANGE_SITES: [&str; 2] = ["attachment_site", "flange"];

/// Everything that an arm needs of a model.
pub(super) struct Model<'a> {
    name: String,
    defaults: Defaults<'a>,
    compiler: Compiler,
    bodies: Bodies<'a>,
    drives: BTreeMap<&'a str, Drive>,
    skeleton: Skeleton,
}

impl<'a> Model<'a> {
    /// Reads a model.
    pub fn of(root: Xml<'a>) -> Result<Self, MjcfError> {
        let compiler = Compiler::of(root)?;
        let defaults = Defaults::of(root);
        let bodies = Bodies::of(root, &defaults, &compiler)?;
        let drives = drives(root, &defaults, &compiler)?;
        let mut names = BTreeSet::new();
        let mut nodes = Vec::new();
        for body in &bodies.bodies {
            let mut joint = String::new();
            for (element, _) in &body.joints {
                joint = named(element.node, "joint")?.unwrap_or_else(|| format!("the joint of body {}", body.name));
                if !names.insert(joint.clone()) {
                    return Err(MjcfError::Twice { kind: "joint", name: joint });
                }
            }
            nodes.push(Node { name: body.name.clone(), above: body.above, joint, kind: kind(body, &defaults) });
        }
        let name = match root.attribute("model") {
            Some(name) if name.chars().any(char::is_control) => {
                return Err(MjcfError::ControlCharacter { kind: "model", name: name.escape_debug().to_string() });
            }
            name => name.unwrap_or("MuJoCo Model").to_owned(),
        };
        Ok(Self { name, defaults, compiler, bodies, drives, skeleton: Skeleton::new(nodes) })
    }

    /// The arm between a base and a tip.
    pub fn chain(&self, base: Option<&str>, tip: Option<&str>) -> Result<SerialChain, MjcfError> {
        let base = base.map(|name| self.skeleton.find("base_link", name)).transpose()?;
        let (tip, site) = match tip {
            Some(name) => match (self.skeleton.find("tip_link", name), self.bodies.sites.get(name)) {
                (Ok(body), _) => (Some(body), Some(same())),
                (Err(_), Some(&(body, at))) => (Some(body), Some(at)),
                (Err(error), None) => return Err(error.into()),
            },
            None => (None, None),
        };
        let path = self.skeleton.path(0, base, tip)?;
        let path = if base.is_none() { self.beginning_at_first_joint(path) } else { path };
        let site = site.or_else(|| self.flange_site(&path)).unwrap_or_else(same);
        let mut chain = welded_chain(self, self.name.clone(), &path, &self.compiler.gravity_m_s2, &site)?;
        chain.remarks.extend(self.springs(&path)?);
        Ok(chain)
    }

    /// The path without the bodies between the world and the one that carries the first joint.
    fn beginning_at_first_joint(&self, mut path: Path) -> Path {
        let fixed = |&link: &usize| self.skeleton.nodes[link].kind == JointKind::Fixed;
        let skipped = path.links.iter().skip(1).take_while(|link| fixed(link)).count();
        path.links.drain(..skipped);
        path
    }

    /// The site at the end of an arm whose tip nobody names.
    fn flange_site(&self, path: &Path) -> Option<Frame> {
        let tip = *path.links.last()?;
        let at_flange = |name: &str| FLANGE_SITES.iter().any(|flange| name.ends_with(flange));
        let mut sites = self.bodies.sites.iter().filter(|(name, (body, _))| *body == tip && at_flange(name));
        sites.next().map(|(_, (_, at))| *at)
    }

    /// Springs of the chain's joints, which are no part of an arm.
    fn springs(&self, path: &Path) -> Result<Vec<ChainRemark>, MjcfError> {
        let mut remarks = Vec::new();
        for (element, _) in path.links.iter().skip(1).flat_map(|&link| &self.bodies.bodies[link].joints) {
            for name in ["stiffness", "springdamper"] {
                let given = self.defaults.numbers(*element, name, 1..=4)?.unwrap_or_default();
                if given.iter().any(|value| *value != 0.0) {
                    remarks.push(ChainRemark::NotRead(format!("{name} of {}", called(element.node))));
                }
            }
        }
        Ok(remarks)
    }
}

impl Source for Model<'_> {
    type Error = MjcfError;

    fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    fn inertia(&self, link: usize) -> Result<LinkInertia, MjcfError> {
        body_inertia(&self.bodies.bodies[link], &self.defaults, &self.compiler)
    }

    fn above_from_link(&self, link: usize) -> Result<Frame, MjcfError> {
        Ok(self.bodies.bodies[link].pose)
    }

    fn joint(&self, link: usize) -> Result<(ChainJoint, JointPose), MjcfError> {
        let body = &self.bodies.bodies[link];
        let name = self.skeleton.nodes[link].joint.clone();
        let actuated = body.joints.first().and_then(|(element, _)| element.node.attribute("name"));
        let drive = actuated.and_then(|name| self.drives.get(name)).copied().unwrap_or_default();
        hinge(body, name, &self.defaults, &self.compiler, &drive)
    }
}
