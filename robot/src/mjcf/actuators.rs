//! `<actuator>`: what drives a joint.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::MjcfError;
use super::compiler::Compiler;
use super::element::{Defaults, Element, Xml};
use super::limit::{largest_both_ways, limited};

/// What the actuators of one joint say of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Drive {
    /// Torque limit (Nm), the sum over actuators; none if one has none.
    pub torque_nm: Option<f64>,
    /// Rotor inertia reflected through the gears [kg m²].
    pub armature_kg_m2: f64,
    /// Viscous friction of the motors through the gears [Nm s/rad].
    pub damping_nm_s_per_rad: f64,
}

/// The actuators, by the joint they drive:
///
/// ```text
/// torque limit = |gear| · forcerange,   or of a motor |gear| · gain · ctrlrange
/// rotor inertia = gear² · armature,     viscous friction = gear² · damping
/// ```
pub(super) fn drives<'a>(
    model: Xml<'a>,
    defaults: &Defaults<'a>,
    compiler: &Compiler,
) -> Result<BTreeMap<&'a str, Drive>, MjcfError> {
    let mut drives: BTreeMap<&str, Drive> = BTreeMap::new();
    let lists = model.children().filter(|node| node.has_tag_name("actuator"));
    for node in lists.flat_map(|list| list.children()).filter(Node::is_element) {
        let Some(joint) = node.attribute("joint").or_else(|| node.attribute("jointinparent")) else { continue };
        let element = defaults.element(node, 0)?;
        let gear = defaults.numbers(element, "gear", 1..=6)?.map_or(1.0, |gear| gear[0]);
        let force = limited(element, defaults, compiler, ("forcelimited", "forcerange"))?.map(largest_both_ways);
        let control = match gain(element, defaults)? {
            Some(gain) => limited(element, defaults, compiler, ("ctrllimited", "ctrlrange"))?
                .map(|range| largest_both_ways(range) * gain.abs()),
            None => None,
        };
        let limit = [force, control].into_iter().flatten().reduce(f64::min).map(|limit| limit * gear.abs());
        let through_gear = |attribute: &'static str| -> Result<f64, MjcfError> {
            Ok(defaults.numbers(element, attribute, 1..=4)?.map_or(0.0, |numbers| numbers[0].max(0.0)) * gear * gear)
        };
        let (armature, damping) = (through_gear("armature")?, through_gear("damping")?);
        drives
            .entry(joint)
            .and_modify(|drive| {
                drive.torque_nm = drive.torque_nm.zip(limit).map(|(a, b)| a + b);
                drive.armature_kg_m2 += armature;
                drive.damping_nm_s_per_rad += damping;
            })
            .or_insert(Drive { torque_nm: limit, armature_kg_m2: armature, damping_nm_s_per_rad: damping });
    }
    Ok(drives)
}

/// Force per control where the force is nothing else; none of actuators with feedback or dynamics.
fn gain(element: Element<'_>, defaults: &Defaults<'_>) -> Result<Option<f64>, MjcfError> {
    let plain = |name: &'static str, plain: &str| defaults.text(element, name).is_none_or(|text| text == plain);
    Ok(match element.node.tag_name().name() {
        "motor" => Some(1.0),
        "general" if plain("biastype", "none") && plain("gaintype", "fixed") && plain("dyntype", "none") => {
            let gain = defaults.numbers(element, "gainprm", 1..=10)?;
            Some(gain.map_or(1.0, |gain| gain[0]))
        }
        _ => None,
    })
}
