//! Why a tree of links holds no arm that can be told.

/// What is wrong with the way from base to tip; names the joint, link or flag to be mended.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ChainError {
    /// A base or tip that is not there.
    #[error("{which} `{name}` is not among the links{}", hint(nearest))]
    NoSuchEnd {
        /// `base_link` or `tip_link`.
        which: &'static str,
        /// The name.
        name: String,
        /// Names that are alike.
        nearest: Vec<String>,
    },
    /// A tip that does not hang on the base.
    #[error("tip_link `{tip}` does not hang on base_link `{base}`")]
    NotConnected {
        /// The base.
        base: String,
        /// The tip.
        tip: String,
    },
    /// More than one arm.
    #[error(
        "there is more than one chain of 6 or 7 joints; name the end of one as tip_link (--tip-link): did you mean {}?",
        listed(tips)
    )]
    Arms {
        /// The ends of the arms.
        tips: Vec<String>,
    },
    /// Chains, none of which is an arm.
    #[error("no chain has 6 or 7 joints; the chains end at {}", listed(ends))]
    NoArm {
        /// The ends, with their numbers of joints.
        ends: Vec<String>,
    },
    /// A joint of a kind that arms do not have here.
    #[error("joint `{joint}` is {kind}; only revolute, continuous and fixed joints are supported{}", hint(tip))]
    Kind {
        /// The joint.
        joint: String,
        /// Its kind.
        kind: &'static str,
        /// The end of the arm before that joint, if there is one.
        tip: Vec<String>,
    },
    /// A joint that moves no mass.
    #[error("joint `{joint}` moves no mass: give link `{link}` an inertia with a mass above 0{}", whole(*any_mass))]
    NoMass {
        /// The joint.
        joint: String,
        /// The link that it moves.
        link: String,
        /// Whether any link has mass.
        any_mass: bool,
    },
    /// Another number of joints than arms have here.
    #[error("{found} joints move between `{base}` and `{tip}`; arms have 6 or 7{suggestion}")]
    Joints {
        /// How many.
        found: usize,
        /// The base.
        base: String,
        /// The tip.
        tip: String,
        /// What to name instead, in words; may be empty.
        suggestion: String,
    },
}

/// Most names that a message lists.
const LISTED: usize = 8;

/// Names in a sentence.
fn listed(names: &[String]) -> String {
    let mut text: Vec<String> = names.iter().take(LISTED).map(|name| format!("`{name}`")).collect();
    if names.len() > LISTED {
        text.push(format!("{} others", names.len() - LISTED));
    }
    match text.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => "nothing".to_owned(),
    }
}

fn whole(any_mass: bool) -> &'static str {
    if any_mass { "" } else { " (no link of this file has: it is made for drawing)" }
}

fn hint(names: &[String]) -> String {
    if names.is_empty() { String::new() } else { format!("; did you mean {}?", listed(names)) }
}
