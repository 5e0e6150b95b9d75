//! The tree of links, and the way from base to tip.

use std::collections::{BTreeMap, BTreeSet};

use urdf_rs::{Joint, JointType, Link, Robot};

use super::UrdfError;

/// Largest file that is read (bytes), a hundred times that of any arm.
const LARGEST: usize = 16 << 20;
/// Deepest nesting of elements; URDF needs six.
const DEEPEST: usize = 64;

/// A URDF whose names are unique and whose joints join links.
pub(super) struct Tree {
    pub robot: Robot,
    /// Place of each link in `robot.links`.
    links: BTreeMap<String, usize>,
    /// Place of the joint above each link in `robot.joints`.
    above: BTreeMap<String, usize>,
    /// Places of the joints below each link.
    below: BTreeMap<String, Vec<usize>>,
    /// Whether each joint of `robot.joints`, or any joint that hangs on it, is not fixed.
    moves: Vec<bool>,
}

/// Places in `robot.joints` of the joints from base to tip, and the names of both ends.
pub(super) struct Path {
    pub base: String,
    pub tip: String,
    pub joints: Vec<usize>,
}

impl Tree {
    /// Parses a URDF.
    pub fn parse(text: &str) -> Result<Self, UrdfError> {
        if text.len() > LARGEST {
            return Err(UrdfError::Syntax(format!("{} bytes; allowed: up to {LARGEST}", text.len())));
        }
        // The parser calls itself for every level, and a stack that ends takes the program with it.
        if nesting(text) > DEEPEST {
            return Err(UrdfError::Syntax(format!("elements are nested more than {DEEPEST} deep")));
        }
        let robot = urdf_rs::read_from_string(text).map_err(|error| UrdfError::Syntax(error.to_string()))?;
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
        let (mut above, mut below) = (BTreeMap::<String, usize>::new(), BTreeMap::<String, Vec<usize>>::new());
        let mut joints = BTreeSet::new();
        for (k, joint) in robot.joints.iter().enumerate() {
            if !joints.insert(&joint.name) {
                return Err(twice("joint", &joint.name));
            }
            for link in [&joint.parent.link, &joint.child.link] {
                if !links.contains_key(link) {
                    return Err(UrdfError::NoSuchLink { joint: joint.name.clone(), link: link.clone() });
                }
            }
            if joint.parent.link == joint.child.link {
                return Err(UrdfError::OwnParent { joint: joint.name.clone(), link: joint.child.link.clone() });
            }
            below.entry(joint.parent.link.clone()).or_default().push(k);
            if let Some(first) = above.insert(joint.child.link.clone(), k) {
                return Err(UrdfError::TwoParents {
                    link: joint.child.link.clone(),
                    first: robot.joints[first].name.clone(),
                    second: joint.name.clone(),
                });
            }
        }
        let moves = moving(&robot, &above);
        Ok(Self { robot, links, above, below, moves })
    }

    /// A link by name.
    pub fn link(&self, name: &str) -> Option<&Link> {
        self.links.get(name).map(|&k| &self.robot.links[k])
    }

    /// The joints that hang on a link.
    pub fn below(&self, link: &str) -> impl Iterator<Item = (usize, &Joint)> {
        self.below.get(link).into_iter().flatten().map(|&k| (k, &self.robot.joints[k]))
    }

    /// The way from `base` (else the root) to `tip` (else the only end that joints lead to).
    pub fn path(&self, base: Option<&str>, tip: Option<&str>) -> Result<Path, UrdfError> {
        for (which, end) in [("base_link", base), ("tip_link", tip)] {
            if let Some(name) = end.filter(|name| !self.links.contains_key(*name)) {
                return Err(UrdfError::NoSuchEnd { which, name: name.to_owned() });
            }
        }
        let base = base.map_or_else(|| self.root(), |base| Ok(base.to_owned()))?;
        match tip {
            Some(tip) => self.path_up(base, tip),
            None => self.path_down(base),
        }
    }

    fn root(&self) -> Result<String, UrdfError> {
        let roots: Vec<&String> = self.links.keys().filter(|link| !self.above.contains_key(*link)).collect();
        match roots[..] {
            [root] => Ok(root.clone()),
            _ => Err(UrdfError::NoRoot { links: roots.into_iter().cloned().collect() }),
        }
    }

    fn path_up(&self, base: String, tip: &str) -> Result<Path, UrdfError> {
        let (mut joints, mut link) = (Vec::new(), tip);
        while link != base {
            // A loop would never end; a tree has fewer joints than links.
            let Some(&joint) = self.above.get(link).filter(|_| joints.len() < self.links.len()) else {
                return Err(UrdfError::NotConnected { base, tip: tip.to_owned() });
            };
            joints.push(joint);
            link = &self.robot.joints[joint].parent.link;
        }
        joints.reverse();
        Ok(Path { base, tip: tip.to_owned(), joints })
    }

    fn path_down(&self, base: String) -> Result<Path, UrdfError> {
        let (mut joints, mut link) = (Vec::new(), base.as_str());
        loop {
            let below: Vec<(usize, &Joint)> = self.below(link).collect();
            let moving: Vec<&(usize, &Joint)> = below.iter().filter(|(k, _)| self.moves[*k]).collect();
            let candidates: Vec<&(usize, &Joint)> = if moving.is_empty() { below.iter().collect() } else { moving };
            match candidates[..] {
                _ if joints.len() > self.links.len() => return Err(UrdfError::NoRoot { links: Vec::new() }),
                [] => break,
                [&(k, joint)] => {
                    joints.push(k);
                    link = &joint.child.link;
                }
                _ => {
                    return Err(UrdfError::Branch {
                        link: link.to_owned(),
                        joints: candidates.iter().map(|(_, joint)| format!("`{}`", joint.name)).collect(),
                    });
                }
            }
        }
        let tip = link.to_owned();
        Ok(Path { base, tip, joints })
    }
}

/// Which joints move, or carry one that does: from every joint that is not fixed up to the base, or to where another one came by.
fn moving(robot: &Robot, above: &BTreeMap<String, usize>) -> Vec<bool> {
    let mut moves = vec![false; robot.joints.len()];
    for (k, joint) in robot.joints.iter().enumerate() {
        let mut at = (joint.joint_type != JointType::Fixed).then_some(k);
        while let Some(k) = at.filter(|&k| !moves[k]) {
            moves[k] = true;
            at = above.get(&robot.joints[k].parent.link).copied();
        }
    }
    moves
}

/// How deep the elements of a text are nested at most; what is in comments or quotes may count too.
fn nesting(text: &str) -> usize {
    let (mut depth, mut deepest) = (0usize, 0);
    for (at, _) in text.match_indices('<') {
        let rest = &text[at + 1..];
        let end = rest.find('>').unwrap_or(rest.len());
        match rest.as_bytes().first() {
            Some(b'/') => depth = depth.saturating_sub(1),
            Some(b'!' | b'?') | None => {}
            Some(_) if rest[..end].ends_with('/') => {}
            Some(_) => depth += 1,
        }
        deepest = deepest.max(depth);
    }
    deepest
}
