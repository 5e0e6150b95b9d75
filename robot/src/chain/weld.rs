//! Bodies: what is welded together between the joints of a chain.

use std::collections::BTreeSet;

use nalgebra::{Matrix3, Vector3};

use super::frame::{Frame, chained, same};
use super::joint::{ChainJoint, JointPose};
use super::skeleton::{JointKind, Path, Skeleton};
use super::{ChainError, ChainRemark, SerialChain};
use crate::LinkInertia;

/// No body at all.
pub(crate) const NO_MASS: LinkInertia = LinkInertia {
    mass_kg: 0.0,
    com_m: Vector3::new(0.0, 0.0, 0.0),
    inertia_kg_m2: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
};

/// What a file says of each link of a skeleton.
pub(crate) trait Source {
    /// Its error.
    type Error: From<ChainError>;
    /// The links.
    fn skeleton(&self) -> &Skeleton;
    /// Inertia of a link in its own frame.
    fn inertia(&self, link: usize) -> Result<LinkInertia, Self::Error>;
    /// The link in the one above, every joint being where the file draws it.
    fn above_from_link(&self, link: usize) -> Result<Frame, Self::Error>;
    /// The revolute joint above a link.
    fn joint(&self, link: usize) -> Result<(ChainJoint, JointPose), Self::Error>;
}

/// The chain along a path; `gravity_m_s2` is in root axes, `tip_from_flange` where the flange is in the last link.
pub(crate) fn welded_chain<S: Source>(
    source: &S,
    name: String,
    path: &Path,
    gravity_m_s2: &Vector3<f64>,
    tip_from_flange: &Frame,
) -> Result<SerialChain, S::Error> {
    let skeleton = source.skeleton();
    let turns = |k: &usize| skeleton.nodes[*k].kind == JointKind::Revolute;
    let chain: BTreeSet<usize> = path.links.iter().skip(1).copied().filter(turns).collect();
    let (mut joints, mut placements, mut links, mut held) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    // The frame of the link that the path has come to, in the frame of the body that it belongs to.
    let mut body_from_link = same();
    for &link in &path.links[1..] {
        if !chain.contains(&link) {
            body_from_link = chained(&body_from_link, &source.above_from_link(link)?);
            continue;
        }
        let (joint, pose) = source.joint(link)?;
        placements.push(chained(&body_from_link, &pose.above_from_joint));
        body_from_link = pose.joint_from_link;
        let body = welded(source, link, body_from_link, &chain, &mut held)?;
        if body.mass_kg <= 0.0 {
            let any_mass = (0..skeleton.nodes.len()).any(|link| source.inertia(link).is_ok_and(|it| it.mass_kg > 0.0));
            let link = skeleton.nodes[link].name.clone();
            return Err(ChainError::NoMass { joint: joint.name, link, any_mass }.into());
        }
        joints.push(joint);
        links.push(body);
    }
    let mut remarks = Vec::new();
    if let (true, [base, .., tip]) = (path.chosen, &path.links[..]) {
        let [base, tip] = [base, tip].map(|&link| skeleton.nodes[link].name.clone());
        remarks.push(ChainRemark::Chosen { base, tip });
    }
    if !held.is_empty() {
        remarks.push(ChainRemark::Held { joints: held });
    }
    Ok(SerialChain {
        name,
        base_link: skeleton.nodes[path.links[0]].name.clone(),
        joints,
        placements,
        links,
        link_from_flange: chained(&body_from_link, tip_from_flange),
        gravity_m_s2: root_from_link(source, path.links[0])?.rotation.transpose() * gravity_m_s2,
        remarks,
    })
}

/// Everything that hangs on `link`, which is at `body_from_link`, but for what hangs on the joints of the chain. Other
/// joints that move are held, and named.
fn welded<S: Source>(
    source: &S,
    link: usize,
    body_from_link: Frame,
    chain: &BTreeSet<usize>,
    held: &mut Vec<String>,
) -> Result<LinkInertia, S::Error> {
    let skeleton = source.skeleton();
    let mut body = NO_MASS;
    let mut waiting = vec![(link, body_from_link)];
    while let Some((link, at)) = waiting.pop() {
        body = body.combined(&source.inertia(link)?.placed(&at.rotation, &at.translation));
        for &next in skeleton.below(link).iter().filter(|next| !chain.contains(next)) {
            let node = &skeleton.nodes[next];
            if node.kind != JointKind::Fixed {
                held.push(node.joint.clone());
            }
            waiting.push((next, chained(&at, &source.above_from_link(next)?)));
        }
    }
    Ok(body)
}

/// Where a link is in its root.
fn root_from_link<S: Source>(source: &S, link: usize) -> Result<Frame, S::Error> {
    let nodes = &source.skeleton().nodes;
    let (mut at, mut from, mut steps) = (link, same(), 0);
    while let Some(above) = nodes[at].above.filter(|_| steps <= nodes.len()) {
        from = chained(&source.above_from_link(at)?, &from);
        (at, steps) = (above, steps + 1);
    }
    Ok(from)
}
