//! What a campaign has learnt about the friction of its robot.

use tribo_campaign::Learnt;
use tribo_robot::JointNames;

use crate::output::{print, significant, table};

/// Shows each parameter with its standard deviation, and which of them are still unsure.
pub fn show(learnt: &[Learnt], joints: &JointNames) {
    if learnt.is_empty() {
        return;
    }
    print("\nlearnt from the last logs (least squares, ± one standard deviation):");
    let mut names: Vec<&str> = Vec::new();
    for parameter in learnt {
        if !names.contains(&parameter.name) {
            names.push(parameter.name);
        }
    }
    let mut rows = table(&std::iter::once("joint").chain(names.iter().copied()).collect::<Vec<_>>());
    for of_joint in learnt.chunk_by(|a, b| a.joint == b.joint) {
        let cells = names.iter().map(|name| {
            of_joint.iter().find(|parameter| parameter.name == *name).map_or(String::new(), |parameter| {
                format!("{} ± {}", significant(parameter.value, 3), significant(parameter.sd, 2))
            })
        });
        rows.add_row(of_joint.first().map(|first| joints.of(first.joint).to_string()).into_iter().chain(cells));
    }
    print(rows);
    let unsure: Vec<String> = names.iter().filter_map(|name| unsure(learnt, name, joints)).collect();
    if unsure.is_empty() {
        print(format_args!("every parameter is known to better than {:.0} %", 100.0 * Learnt::UNSURE));
    } else {
        print(format_args!("still unsure (± more than {:.0} %): {}", 100.0 * Learnt::UNSURE, unsure.join(", ")));
    }
}

/// `coulomb_nm of joints 3 and 5`; none where all joints are sure.
fn unsure(learnt: &[Learnt], name: &str, names: &JointNames) -> Option<String> {
    let unsure = learnt.iter().filter(|parameter| parameter.name == name && parameter.is_unsure());
    let joints: Vec<usize> = unsure.map(|parameter| parameter.joint).collect();
    (!joints.is_empty()).then(|| format!("{name} of {}", names.several(&joints)))
}
