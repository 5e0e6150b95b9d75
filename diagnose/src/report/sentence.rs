//! The verdict and the findings in plain language.
//!
//! ```text
//! panda_joint4 (3) lacks Stribeck friction: 0.41 Nm [0.38, 0.44] above Coulomb below 0.05 rad/s; removes 62 % [58, 66] of …
//! ```
//!
//! Numbers in brackets are 95 % intervals. Joints and links count from 0.

use tribo_figure::number::{fixed, percent_with_interval, significant, with_interval};
use tribo_regression::{CauseLabel, Location};
use tribo_robot::JointNames;

use crate::{Diagnosis, Finding, Parameter, Verdict};

/// The answer in one or two sentences.
pub fn verdict_sentence(diagnosis: &Diagnosis) -> String {
    let names = &diagnosis.joint_names;
    let gain = gain_clause(diagnosis.findings.len() > 1, diagnosis.gain_heldout, diagnosis.gain_heldout_ci95);
    match (diagnosis.verdict, &diagnosis.findings[..]) {
        (Verdict::NothingMissing, _) => {
            "Nothing is missing: what the model leaves of this log, none of the candidate causes explains.".to_owned()
        }
        (Verdict::Named, [finding]) => format!("{}.", finding_sentence(finding, names)),
        (Verdict::Named, findings) => {
            let names = shortened(findings.iter().map(|finding| short_name(finding, names)));
            format!("{} causes are missing from the model: {names}; {gain}.", counted(findings.len()))
        }
        (Verdict::Ambiguous, findings) => {
            let doubtful = findings.iter().filter_map(|finding| Some((finding, finding.alternatives.first()?)));
            let pairs = doubtful.map(|(finding, rival)| {
                format!("{} from {}", short_name(finding, names), cause_at(rival.label, rival.location, names))
            });
            let pairs: Vec<String> = pairs.collect();
            let cannot = if pairs.is_empty() {
                "This log cannot tell the causes apart".to_owned()
            } else {
                format!("This log cannot tell {}", shortened(pairs.into_iter()))
            };
            match findings {
                [] => format!("{cannot}."),
                [best] => format!("{cannot}. The best explanation: {}.", mid_sentence(best, names)),
                _ => format!("{cannot}. The best explanation: {gain}."),
            }
        }
        (Verdict::Unknown, findings) => match findings.iter().find(|finding| finding.label == CauseLabel::Unknown) {
            Some(unknown) if findings.len() == 1 => format!("{}.", finding_sentence(unknown, names)),
            Some(unknown) => {
                let named = findings.iter().filter(|finding| finding.label != CauseLabel::Unknown);
                let named = named.map(|finding| short_name(finding, names));
                format!("{}, beside {}; {gain}.", description(unknown, names), shortened(named))
            }
            None if findings.is_empty() => {
                "Something is missing from the model that no named cause describes.".to_owned()
            }
            None => {
                let named = findings.iter().map(|finding| short_name(finding, names));
                let beside = shortened(named);
                format!("Something is missing from the model that no named cause describes, beside {beside}; {gain}.")
            }
        },
    }
}

/// The first few of a list; how many more there are.
fn shortened(items: impl Iterator<Item = String>) -> String {
    let mut items: Vec<String> = items.collect();
    if items.len() > MOST_NAMED + 1 {
        let more = items.len() - MOST_NAMED;
        items.truncate(MOST_NAMED);
        items.push(format!("{more} more"));
    }
    listed(items.into_iter())
}

/// Causes that a headline names.
const MOST_NAMED: usize = 5;

/// One finding with its size and what it is worth on unseen data, without the full stop.
pub fn finding_sentence(finding: &Finding, names: &JointNames) -> String {
    format!(
        "{}; {}",
        description(finding, names),
        gain_clause(false, finding.held_out_gain, finding.held_out_gain_ci95)
    )
}

/// The finding with its size.
pub fn description(finding: &Finding, names: &JointNames) -> String {
    use CauseLabel as L;
    if finding.joints.len() > 1 || finding.links.len() > 1 {
        return description_of_many(finding, names);
    }
    let place = finding.location.among(names);
    let at = if begins_with_a_name(finding, names) { place.clone() } else { capital(&place) };
    let said = finding.said();
    let p = Parameters(&said);
    match finding.label {
        L::Coulomb => {
            format!(
                "{at} has {} dry friction than the model: {}",
                p.more("delta_coulomb_nm"),
                p.size("delta_coulomb_nm", "Nm")
            )
        }
        L::Viscous => {
            let name = "delta_viscous_nm_s_per_rad";
            format!("{at} has {} viscous friction than the model: {}", p.more(name), p.size(name, "Nm s/rad"))
        }
        L::Stribeck => format!(
            "{at} lacks Stribeck friction: {} above Coulomb below {}",
            p.text("breakaway_minus_coulomb_nm", "Nm"),
            p.rough("stribeck_velocity_rad_s", "rad/s")
        ),
        L::CoulombAsymmetry => {
            let way = if p.first("asymmetry_nm") < 0.0 { "backwards" } else { "forwards" };
            format!("{at} has more dry friction {way}: {} above the mean of both ways", p.size("asymmetry_nm", "Nm"))
        }
        L::TorqueOffset => format!("{at} reads a constant torque that is not there: {}", p.text("offset_nm", "Nm")),
        L::TorqueGain => {
            let (value, [low, high]) = (p.first("gain_error"), p.interval("gain_error"));
            let sizes = if value < 0.0 { [-value, -high, -low] } else { [value, low, high] };
            let [size, low, high] = sizes.map(|part| 100.0 * part);
            let way = if value < 0.0 { "little" } else { "much" };
            format!("The torque sensor of {} reads {} too {way}", place, with_interval(size, [low, high], "%"))
        }
        L::ThermalFriction => {
            let name = "drop_fraction";
            format!(
                "{at} loses {} of its friction as it warms up, with a time constant of {}",
                percent_with_interval(p.first(name), p.interval(name)),
                p.text("time_constant_s", "s")
            )
        }
        L::LoadFriction => {
            format!("Dry friction of {} grows with its load: {}", place, p.text("load_coefficient", "Nm per Nm"))
        }
        L::Payload => format!(
            "The flange carries a body that the model lacks: {}, centre of mass at {} m",
            p.text("mass_kg", "kg"),
            p.vector("com_m")
        ),
        L::BaseTilt => {
            let (angle, [low, high]) = (p.first("angle_rad"), p.interval("angle_rad"));
            let [degrees, low, high] = [angle, low, high].map(f64::to_degrees);
            format!(
                "The base is not level: turned by {} about {}",
                with_interval(degrees, [low, high], "°"),
                p.vector("axis")
            )
        }
        L::LinkInertial => format!(
            "{at} has another mass than the model's: {}, first moment {} kg m",
            p.signed("delta_mass_kg", "kg"),
            p.vector("delta_first_moment_kg_m")
        ),
        L::RotorInertia => {
            let name = "delta_rotor_inertia_kg_m2";
            format!("{at} has {} rotor inertia than the model: {}", p.more(name), p.size(name, "kg m²"))
        }
        L::TorqueRipple => format!(
            "The torque of {} ripples with its angle: {} at {} cycles per revolution",
            place,
            p.text("amplitude_nm", "Nm"),
            p.rough("cycles_per_rev", "").trim_end()
        ),
        L::Presliding => format!(
            "Dry friction of {} builds up over a distance after each reversal: {}",
            place,
            p.text("presliding_distance_rad", "rad")
        ),
        L::JointElasticity => {
            format!("{at} has a spring between motor and link: {}", p.text("stiffness_nm_per_rad", "Nm/rad"))
        }
        L::Backlash => format!("{at} has play between motor and link: ± {}", p.text("half_gap_rad", "rad")),
        L::TimeDelay => {
            let (value, [low, high]) = (p.first("delay_s"), p.interval("delay_s"));
            let sizes = if value < 0.0 { [-value, -high, -low] } else { [value, low, high] };
            let [size, low, high] = sizes.map(|seconds| 1e3 * seconds);
            let way = if value < 0.0 { "early" } else { "late" };
            format!("Torques are stamped {way} by {}", with_interval(size, [low, high], "ms"))
        }
        L::ExternalContact => format!(
            "Something pushed the arm from {} to {}; by the robot on the environment: {} N and {} Nm at the flange, base axes",
            p.rough("start_s", "s"),
            p.rough("end_s", "s"),
            p.vector("force_by_robot_n"),
            p.vector("moment_by_robot_nm")
        ),
        L::PositionSpring => format!(
            "{at} pulls like a spring: {}, slack at {}",
            p.text("stiffness_nm_per_rad", "Nm/rad"),
            p.rough("rest_rad", "rad")
        ),
        L::FrictionCurve => format!(
            "Friction of {} bends with speed: {} within {}",
            place,
            p.text("amplitude_nm", "Nm"),
            p.rough("width_rad_s", "rad/s")
        ),
        L::Unknown => {
            let signature = finding.signature.as_deref().unwrap_or("nothing that was tried");
            format!("{at} shows a torque that no named cause describes; it goes with {signature}")
        }
    }
}

/// A finding of several joints or links, by its first parameter.
fn description_of_many(finding: &Finding, names: &JointNames) -> String {
    let places = match finding.links.is_empty() {
        true => names.several(&finding.joints),
        false => format!("links {}", listed(finding.links.iter().map(usize::to_string))),
    };
    let name = capital(cause_name(finding.label));
    let Some(parameter) = finding.parameters.first() else { return format!("{name} in {places}") };
    let unit = tribo_figure::number::quantity_and_unit(parameter.name).1;
    let (low, high) =
        parameter.value.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    format!("{name} in {places}: {} to {} {unit}", significant(low, 3), significant(high, 3))
}

/// The name of a cause for people.
pub fn cause_name(label: CauseLabel) -> &'static str {
    use CauseLabel as L;
    match label {
        L::Coulomb => "dry friction",
        L::Viscous => "viscous friction",
        L::Stribeck => "Stribeck friction",
        L::CoulombAsymmetry => "direction-dependent dry friction",
        L::TorqueOffset => "torque offset",
        L::TorqueGain => "torque sensor scale",
        L::ThermalFriction => "friction that fades with warmth",
        L::LoadFriction => "load-dependent friction",
        L::Payload => "payload",
        L::BaseTilt => "base tilt",
        L::LinkInertial => "link mass",
        L::RotorInertia => "rotor inertia",
        L::TorqueRipple => "torque ripple",
        L::Presliding => "presliding",
        L::JointElasticity => "joint elasticity",
        L::Backlash => "backlash",
        L::TimeDelay => "time delay",
        L::ExternalContact => "external contact",
        L::PositionSpring => "position spring",
        L::FrictionCurve => "friction that bends with speed",
        L::Unknown => "something unknown",
    }
}

/// `Stribeck friction at panda_joint4 (3)`; the arm as a place goes without saying.
pub fn cause_at(label: CauseLabel, location: Location, names: &JointNames) -> String {
    match location {
        Location::Arm => cause_name(label).to_owned(),
        place => format!("{} at {}", cause_name(label), place.among(names)),
    }
}

fn short_name(finding: &Finding, names: &JointNames) -> String {
    match finding.joints.len().max(finding.links.len()) {
        0 | 1 => cause_at(finding.label, finding.location, names),
        count => {
            let what = if finding.links.is_empty() { "joints" } else { "links" };
            format!("{} ({count} {what})", cause_name(finding.label))
        }
    }
}

/// `it removes 62 % [58, 66] of the residual on unseen blocks`, unless it does not.
fn gain_clause(many: bool, gain: f64, ci95: [f64; 2]) -> String {
    let (subject, removes, does) = if many { ("together they ", "remove", "do") } else { ("", "removes", "does") };
    if gain > 0.0 && gain.is_finite() {
        format!("{subject}{removes} {} of the residual on unseen blocks", percent_with_interval(gain, ci95))
    } else {
        format!("{subject}{does} not reduce the residual on unseen blocks")
    }
}

fn counted(number: usize) -> String {
    const WORDS: [&str; 9] = ["Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine", "Ten"];
    number.checked_sub(2).and_then(|k| WORDS.get(k)).map_or(number.to_string(), |word| (*word).to_owned())
}

/// `a, b and c`.
fn listed(parts: impl Iterator<Item = String>) -> String {
    let parts: Vec<String> = parts.collect();
    match &parts[..] {
        [] => "nothing".to_owned(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Whether the sentence about a finding at one joint may begin with the name of that joint, which stays as it is spelt.
fn begins_with_a_name(finding: &Finding, names: &JointNames) -> bool {
    matches!(finding.location, Location::Joint(joint) if names.of(joint).name.is_some())
}

/// The sentence about a finding, continuing another.
fn mid_sentence(finding: &Finding, names: &JointNames) -> String {
    let sentence = finding_sentence(finding, names);
    let named = begins_with_a_name(finding, names) && sentence.starts_with(&finding.location.among(names));
    if named { sentence } else { lower(&sentence) }
}

/// A sentence in mid-sentence.
fn lower(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}

fn capital(text: &str) -> String {
    let text = if text == "arm" { "the arm" } else { text };
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Parameters by name; what a finding lacks reads as `–`.
struct Parameters<'a>(&'a [Parameter]);

impl Parameters<'_> {
    fn get(&self, name: &str) -> Option<&Parameter> {
        self.0.iter().find(|parameter| parameter.name == name)
    }

    fn first(&self, name: &str) -> f64 {
        self.get(name).and_then(|parameter| parameter.value.first().copied()).unwrap_or(f64::NAN)
    }

    fn interval(&self, name: &str) -> [f64; 2] {
        self.get(name).and_then(|parameter| parameter.ci95.first().copied()).unwrap_or([f64::NAN; 2])
    }

    /// Value and interval.
    fn text(&self, name: &str, unit: &str) -> String {
        with_interval(self.first(name), self.interval(name), unit)
    }

    /// Value and interval of the magnitude, where a word says the sign.
    fn size(&self, name: &str, unit: &str) -> String {
        let (value, [low, high]) = (self.first(name), self.interval(name));
        if value < 0.0 { with_interval(-value, [-high, -low], unit) } else { with_interval(value, [low, high], unit) }
    }

    /// Value with its sign, and interval.
    fn signed(&self, name: &str, unit: &str) -> String {
        let sign = if self.first(name) > 0.0 { "+" } else { "" };
        format!("{sign}{}", self.text(name, unit))
    }

    /// Value alone.
    fn rough(&self, name: &str, unit: &str) -> String {
        let value = self.first(name);
        let digits = if value.abs() >= 1000.0 { 5 } else { 3 };
        let text = significant(value, digits);
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        format!("{text} {unit}")
    }

    fn more(&self, name: &str) -> &'static str {
        if self.first(name) < 0.0 { "less" } else { "more" }
    }

    /// `(0.00, 0.01, 0.06)`, with the decimals of the widest interval.
    fn vector(&self, name: &str) -> String {
        let Some(parameter) = self.get(name) else { return "–".to_owned() };
        let decimals = parameter.ci95.iter().filter_map(|ci| super::number::decimals_of_interval(ci[0], ci[1])).max();
        let parts = parameter.value.iter().map(|value| match decimals {
            Some(decimals) if value.is_finite() => fixed(*value, decimals),
            _ => significant(*value, 3),
        });
        format!("({})", parts.collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample::diagnosis;

    /// The sign of `tribo estimate`: a hand that presses down gets a force upwards from the robot, and vice versa.
    #[test]
    fn a_push_is_said_as_the_wrench_of_the_robot() {
        let mut push = diagnosis().findings.remove(0);
        (push.label, push.location) = (CauseLabel::ExternalContact, Location::Arm);
        let ci95 = vec![[-1.0, 1.0], [3.0, 5.0], [-21.0, -19.0]];
        push.parameters = vec![Parameter { name: "force_n", value: vec![0.0, 4.0, -20.0], ci95 }];
        let said = push.said();
        assert_eq!((said[0].name, said[0].value[1], said[0].value[2]), ("force_by_robot_n", -4.0, 20.0));
        assert_eq!(said[0].ci95, [[-1.0, 1.0], [-5.0, -3.0], [19.0, 21.0]]);
        let sentence = description(&push, &JointNames::default());
        assert!(sentence.contains("by the robot on the environment: (") && sentence.contains(", 20"), "{sentence}");
    }

    #[test]
    fn sentences_say_what_where_how_much_and_what_for() {
        let mut sample = diagnosis();
        assert_eq!(
            finding_sentence(&sample.findings[0], &sample.joint_names),
            "Joint 3 lacks Stribeck friction: 0.41 Nm [0.38, 0.44] above Coulomb below 0.0503 rad/s; \
             removes 62 % [58, 66] of the residual on unseen blocks"
        );
        assert_eq!(
            description(&sample.findings[1], &sample.joint_names),
            "The flange carries a body that the model lacks: 0.85 kg [0.83, 0.87], \
             centre of mass at (0.010, −0.002, 0.061) m"
        );
        assert_eq!(
            verdict_sentence(&sample),
            "This log cannot tell Stribeck friction at joint 3 from presliding at joint 3. \
             The best explanation: together they remove 71 % [66, 75] of the residual on unseen blocks."
        );
        let one = Diagnosis { findings: vec![sample.findings[0].clone()], ..sample.clone() };
        assert_eq!(
            verdict_sentence(&one),
            "This log cannot tell Stribeck friction at joint 3 from presliding at joint 3. The best explanation: joint 3 \
             lacks Stribeck friction: 0.41 Nm [0.38, 0.44] above Coulomb below 0.0503 rad/s; \
             removes 62 % [58, 66] of the residual on unseen blocks."
        );
        sample.verdict = Verdict::Named;
        sample.findings.truncate(2);
        assert_eq!(
            verdict_sentence(&sample),
            "Two causes are missing from the model: Stribeck friction at joint 3 and payload; \
             together they remove 71 % [66, 75] of the residual on unseen blocks."
        );
    }

    /// Without its parameters, with NaN, with an empty vector: a sentence, not a panic.
    #[test]
    fn every_label_has_a_sentence_whatever_it_lacks() {
        for label in CauseLabel::ALL {
            for location in [Location::Arm, Location::Joint(2), Location::Link(7)] {
                let mut finding = diagnosis().findings.remove(0);
                (finding.label, finding.location) = (label, location);
                finding.held_out_gain = f64::NAN;
                let sentence = finding_sentence(&finding, &JointNames::default());
                assert!(!sentence.contains("NaN") && sentence.len() > 30, "{sentence}");
                finding.parameters = vec![Parameter { name: "com_m", value: vec![], ci95: vec![] }];
                finding.held_out_gain = 0.3;
                let sentence = finding_sentence(&finding, &JointNames::default());
                assert!(!sentence.contains("NaN") && sentence.starts_with(char::is_uppercase), "{sentence}");
            }
        }
    }
}
