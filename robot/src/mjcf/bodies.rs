//! The tree of bodies under `<worldbody>`.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use roxmltree::Node;

use super::MjcfError;
use super::compiler::Compiler;
use super::element::{Defaults, Element, Xml, called};
use super::pose::pose_of;
use crate::chain::frame::{Frame, chained, same};

/// Name of the body that everything hangs on.
const WORLD: &str = "world";

/// A body; what is in a `<frame>` has that frame with it.
#[derive(Debug)]
pub(super) struct Body<'a> {
    pub name: String,
    pub above: Option<usize>,
    /// The body in the one above.
    pub pose: Frame,
    pub joints: Vec<(Element<'a>, Frame)>,
    pub geoms: Vec<(Element<'a>, Frame)>,
    pub inertial: Option<(Element<'a>, Frame)>,
}

/// All bodies, the world first, and the sites by name: their bodies, and where they are in them.
pub(super) struct Bodies<'a> {
    pub bodies: Vec<Body<'a>>,
    pub sites: BTreeMap<&'a str, (usize, Frame)>,
}

/// Where the walk is: a body, or a frame in one.
struct Place<'a> {
    node: Xml<'a>,
    body: usize,
    around: Frame,
    childclass: usize,
}

impl<'a> Bodies<'a> {
    /// Every body of a model.
    pub fn of(model: Xml<'a>, defaults: &Defaults<'a>, compiler: &Compiler) -> Result<Self, MjcfError> {
        let mut found = Self { bodies: vec![Body::new(WORLD.to_owned(), None, same())], sites: BTreeMap::new() };
        let mut names = BTreeSet::from([WORLD.to_owned()]);
        let tops = model.children().filter(|node| node.has_tag_name("worldbody"));
        let mut waiting: VecDeque<Place<'a>> =
            tops.map(|node| Place { node, body: 0, around: same(), childclass: 0 }).collect();
        while let Some(Place { node, body, around, childclass }) = waiting.pop_front() {
            let childclass = node.attribute("childclass").map_or(Ok(childclass), |name| defaults.class(name))?;
            for child in node.children().filter(Node::is_element) {
                let element = defaults.element(child, childclass)?;
                match child.tag_name().name() {
                    "body" => {
                        let pose = chained(&around, &pose_of(element, defaults, compiler)?);
                        let name = named(child, "body")?
                            .unwrap_or_else(|| format!("body {} (it has no name)", found.bodies.len()));
                        if !names.insert(name.clone()) {
                            return Err(MjcfError::Twice { kind: "body", name });
                        }
                        found.bodies.push(Body::new(name, Some(body), pose));
                        let body = found.bodies.len() - 1;
                        waiting.push_back(Place { node: child, body, around: same(), childclass });
                    }
                    "frame" => {
                        let around = chained(&around, &pose_of(element, defaults, compiler)?);
                        waiting.push_back(Place { node: child, body, around, childclass });
                    }
                    "joint" | "freejoint" => found.bodies[body].joints.push((element, around)),
                    "geom" => found.bodies[body].geoms.push((element, around)),
                    "inertial" => found.bodies[body].inertial = Some((element, around)),
                    "site" => {
                        if let Some(name) = child.attribute("name") {
                            let at = chained(&around, &pose_of(element, defaults, compiler)?);
                            found.sites.insert(name, (body, at));
                        }
                    }
                    // A cloth on the floor is nobody's; bodies from elsewhere may be the arm.
                    "attach" | "replicate" => return Err(not_read(child)),
                    "composite" | "flexcomp" if body > 0 => return Err(not_read(child)),
                    _ => {}
                }
            }
        }
        if found.bodies.len() == 1 {
            let message = match model.has_tag_name("mujocoinclude") {
                true => "a part that another file includes (<mujocoinclude>): give that file",
                false => "there is no body in <worldbody>",
            };
            return Err(MjcfError::Syntax(message.to_owned()));
        }
        Ok(found)
    }
}

impl Body<'_> {
    fn new(name: String, above: Option<usize>, pose: Frame) -> Self {
        Self { name, above, pose, joints: Vec::new(), geoms: Vec::new(), inertial: None }
    }
}

/// The name of an element, without what a terminal would obey.
pub(super) fn named(node: Xml<'_>, kind: &'static str) -> Result<Option<String>, MjcfError> {
    match node.attribute("name") {
        Some(name) if name.chars().any(char::is_control) => {
            Err(MjcfError::ControlCharacter { kind, name: name.escape_debug().to_string() })
        }
        name => Ok(name.map(str::to_owned)),
    }
}

fn not_read(node: Xml<'_>) -> MjcfError {
    let why = "write the model as MuJoCo compiles it (mj_saveLastXML)";
    MjcfError::NotSupported { what: format!("<{}> in {}", node.tag_name().name(), parent(node)), why }
}

fn parent(node: Xml<'_>) -> String {
    node.parent_element().map_or(String::new(), called)
}
