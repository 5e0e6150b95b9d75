//! Links and the joints above them, and the way from the base of an arm to its tip.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use super::ChainError;

/// Numbers of joints that arms have here.
const ARM_JOINTS: RangeInclusive<usize> = 6..=7;
/// Name of the frame at the flange of an industrial arm, with or without a prefix (ROS-Industrial, REP 199).
const TOOL_FRAME: &str = "tool0";

/// Parts of the names of joints that belong to a hand, in lower case.
const HAND_JOINTS: [&str; 4] = ["gripper", "finger", "jaw", "knuckle"];

/// How a link hangs on the one above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JointKind {
    /// Not at all, or welded.
    Fixed,
    /// By a joint that turns about an axis.
    Revolute,
    /// By what no arm has here, in words.
    Other(&'static str),
}

/// A link.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub name: String,
    pub above: Option<usize>,
    /// Name of the joint above.
    pub joint: String,
    pub kind: JointKind,
}

/// A tree, or several, of links. Loops are allowed, and never walked.
#[derive(Clone, Debug)]
pub(crate) struct Skeleton {
    pub nodes: Vec<Node>,
    below: Vec<Vec<usize>>,
    /// Whether the joint above a link, or any joint that hangs on it, is not fixed.
    moves: Vec<bool>,
    names: BTreeMap<String, usize>,
}

/// Links from the base (the first) to the tip.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Path {
    pub links: Vec<usize>,
    /// Whether there was a choice.
    pub chosen: bool,
}

/// An end that the tree has below some link.
struct End {
    base: usize,
    tip: usize,
    joints: usize,
}

impl Skeleton {
    pub fn new(nodes: Vec<Node>) -> Self {
        let mut below = vec![Vec::new(); nodes.len()];
        let mut names = BTreeMap::new();
        for (k, node) in nodes.iter().enumerate() {
            if let Some(above) = node.above {
                below[above].push(k);
            }
            names.entry(node.name.clone()).or_insert(k);
        }
        let mut moves = vec![false; nodes.len()];
        for (k, node) in nodes.iter().enumerate() {
            let mut at = (node.kind != JointKind::Fixed).then_some(k);
            while let Some(k) = at.filter(|&k| !moves[k]) {
                moves[k] = true;
                at = nodes[k].above;
            }
        }
        Self { nodes, below, moves, names }
    }

    /// Links below a link.
    pub fn below(&self, link: usize) -> &[usize] {
        &self.below[link]
    }

    /// A link by name.
    pub fn find(&self, which: &'static str, name: &str) -> Result<usize, ChainError> {
        self.names.get(name).copied().ok_or_else(|| {
            let (lower, short) = (name.to_lowercase(), |other: &&String| other.len() > 2);
            let alike = |other: &&String| {
                let other = other.to_lowercase();
                other.contains(&lower) || lower.contains(&other)
            };
            let nearest = self.names.keys().filter(short).filter(alike).take(4).cloned().collect();
            ChainError::NoSuchEnd { which, name: name.to_owned(), nearest }
        })
    }

    /// The way from `base` (else `root`) to `tip` (else the end of the only arm).
    ///
    /// Without `base`, the arm begins below the last joint above it that is no arm's (a rail, a wheel); without `tip`, it
    /// ends where, after 6 or 7 joints, the tree branches or a joint is no arm's, before the joint of a hand (by its name: a
    /// gripper, finger, jaw or knuckle), or at its last link.
    pub fn path(&self, root: usize, base: Option<usize>, tip: Option<usize>) -> Result<Path, ChainError> {
        match tip {
            Some(tip) => self.up(root, base, tip),
            None => self.down(base.unwrap_or(root)),
        }
    }

    fn up(&self, root: usize, base: Option<usize>, tip: usize) -> Result<Path, ChainError> {
        let name = |link: usize| self.nodes[link].name.clone();
        let (mut links, top) = (vec![tip], base.unwrap_or(root));
        let mut at = tip;
        while at != top {
            // A loop would never end; a way is never longer than there are links.
            let Some(above) = self.nodes[at].above.filter(|_| links.len() <= self.nodes.len()) else {
                return Err(ChainError::NotConnected { base: name(top), tip: name(tip) });
            };
            links.push(above);
            at = above;
        }
        links.reverse();
        let joints =
            |links: &[usize]| links.iter().skip(1).filter(|&&k| self.nodes[k].kind == JointKind::Revolute).count();
        let other = |k: &usize| matches!(self.nodes[*k].kind, JointKind::Other(_));
        if let Some(last) = links.iter().skip(1).rposition(other).map(|at| at + 1) {
            // A rail is part of no arm, but may carry one.
            if base.is_none() && ARM_JOINTS.contains(&joints(&links[last..])) {
                return Ok(Path { links: links.split_off(last), chosen: true });
            }
            let first = links.iter().skip(1).position(other).map_or(last, |at| at + 1);
            let before = joints(&links[..first]);
            let hint = ARM_JOINTS.contains(&before).then(|| name(links[first - 1]));
            return Err(self.refused(links[first], hint.into_iter().collect()));
        }
        let found = joints(&links);
        if ARM_JOINTS.contains(&found) {
            return Ok(Path { links, chosen: false });
        }
        Err(self.wrong_number(found, &links))
    }

    fn down(&self, root: usize) -> Result<Path, ChainError> {
        let ends = self.ends(root);
        let name = |link: usize| self.nodes[link].name.clone();
        let arms: Vec<&End> = ends.iter().filter(|end| ARM_JOINTS.contains(&end.joints)).collect();
        match (&arms[..], &ends[..]) {
            (&[arm], ends) => {
                let path = self.up(root, Some(arm.base), arm.tip)?;
                Ok(Path { chosen: ends.len() > 1 || arm.base != root, ..path })
            }
            ([], &[End { tip, .. }]) => Err(match self.up(root, Some(root), tip) {
                Err(error) => error,
                Ok(path) => self.wrong_number(0, &path.links),
            }),
            ([], ends) => {
                let ends = ends.iter().map(|end| format!("{} ({} joints)", name(end.tip), end.joints)).collect();
                Err(ChainError::NoArm { ends })
            }
            (arms, _) => Err(ChainError::Arms { tips: arms.iter().map(|arm| name(arm.tip)).collect() }),
        }
    }

    /// Every end of the tree below `root`, in the order of the file.
    fn ends(&self, root: usize) -> Vec<End> {
        let (mut ends, mut waiting, mut seen) = (Vec::new(), vec![(root, root, 0)], 0);
        while let Some((base, at, joints)) = waiting.pop() {
            seen += 1;
            if seen > self.nodes.len() {
                break;
            }
            let moving: Vec<usize> = self.below[at].iter().copied().filter(|&k| self.moves[k]).collect();
            let other = |&next: &usize| matches!(self.nodes[next].kind, JointKind::Other(_));
            let goes_on = match (&moving[..], ARM_JOINTS.contains(&joints)) {
                ([], _) => false,
                ([next], arm) => !(self.of_hand(*next) || arm && other(next)),
                (several, arm) => !arm && !several.iter().all(|&next| self.of_hand(next)),
            };
            if !goes_on {
                let tip = if moving.is_empty() { self.rigid_end(at) } else { at };
                ends.push(End { base, tip, joints });
                continue;
            }
            for &next in moving.iter().rev().filter(|&&next| !self.of_hand(next)) {
                waiting.push(match self.nodes[next].kind {
                    JointKind::Fixed => (base, next, joints),
                    JointKind::Revolute => (base, next, joints + 1),
                    JointKind::Other(_) => (next, next, 0),
                });
            }
        }
        ends
    }

    /// Whether the joint above a link is a hand's.
    fn of_hand(&self, link: usize) -> bool {
        let node = &self.nodes[link];
        let name = node.joint.to_lowercase();
        node.kind != JointKind::Fixed && HAND_JOINTS.iter().any(|part| name.contains(part))
    }

    /// Where the frames end that are fixed to a link on which nothing moves: at the only last one, else at the tool frame,
    /// else at the link itself.
    fn rigid_end(&self, link: usize) -> usize {
        let (mut at, mut steps) = (link, 0);
        while let [next] = self.below[at][..] {
            (at, steps) = (next, steps + 1);
            if steps > self.nodes.len() {
                return link;
            }
        }
        if self.below[at].is_empty() {
            return at;
        }
        let (mut tools, mut waiting) = (Vec::new(), vec![at]);
        while let Some(k) = waiting.pop() {
            tools.extend(self.nodes[k].name.ends_with(TOOL_FRAME).then_some(k));
            waiting.extend(&self.below[k]);
        }
        if let [tool] = tools[..] { tool } else { at }
    }

    fn refused(&self, link: usize, tip: Vec<String>) -> ChainError {
        let node = &self.nodes[link];
        let kind = if let JointKind::Other(kind) = node.kind { kind } else { "not an arm's" };
        ChainError::Kind { joint: node.joint.clone(), kind, tip }
    }

    /// Too few or too many joints along `links`, and where an arm would be.
    fn wrong_number(&self, found: usize, links: &[usize]) -> ChainError {
        let name = |link: usize| self.nodes[link].name.clone();
        let most = *ARM_JOINTS.end();
        let turns: Vec<usize> =
            (1..links.len()).filter(|&k| self.nodes[links[k]].kind == JointKind::Revolute).collect();
        let suggestion = match found > most {
            // The first seven, or the last.
            true => format!(
                "; did you mean tip_link (--tip-link) `{}`, or base_link (--base-link) `{}`?",
                name(links[turns[most] - 1]),
                name(links[turns[found - most] - 1]),
            ),
            false => String::new(),
        };
        let [base, tip] = [links.first(), links.last()].map(|end| end.map_or(String::new(), |&link| name(link)));
        ChainError::Joints { found, base, tip, suggestion }
    }
}
