//! What the sources in C and in Rust share.

use tribo_friction::VelocitySource;

use super::bounds;
use super::loss::{controller_arm, not_cancelled};
use super::terms::{Statement, Term, effect_terms, law_term, memory, sign, velocity};
use super::{Loss, TunedCompensator};

/// What goes in as the reference velocity.
pub(super) const REFERENCE: &str = "The reference velocity is what the motion is meant to have: the desired velocity of the joint trajectory, of a Cartesian \
     controller the pseudo-inverse of the Jacobian times the desired twist; 0 at rest, and never the measured one.";

/// A compensator as a program: its terms, what they need, and the words at the head of the file.
pub(super) struct Program<const N: usize> {
    /// What comes before them: `dq`, and `s` where a term uses it.
    pub opening: Vec<Statement>,
    /// The law, then the effects.
    pub terms: Vec<Term<N>>,
    /// Whether there are effects: then the function takes position, load, period and memory too.
    pub effects: bool,
    /// The largest torque of each joint (Nm), as a table.
    pub most_nm: (String, [f64; N]),
    /// Bristles in the memory.
    pub memory: usize,
    /// Whether it takes the measured velocity, and the reference velocity.
    pub takes: [bool; 2],
    /// What the file does not say.
    pub losses: Vec<Loss>,
    /// Lines for people.
    pub remarks: Vec<String>,
}

impl<const N: usize> Program<N> {
    /// The program of a compensator; in C its functions begin with `prefix`.
    pub fn of(tuned: &TunedCompensator<N>, prefix: &str) -> Self {
        let mut terms = vec![law_term(tuned)];
        terms.extend(effect_terms(tuned, prefix));
        let (effects, memory) = (tuned.has_effects(), memory(tuned));
        let mut losses = not_cancelled(tuned);
        losses.extend(bounds::cut_off(tuned));
        losses.extend(controller_arm(tuned));

        let mut remarks = vec![format!("Friction compensation of {}.", tuned.robot), format!("{}.", tuned.origin)];
        let formulas: Vec<&str> = terms.iter().map(|term| term.formula).collect();
        remarks.push(format!("tau = {}", formulas.join(" + ")));
        let smoothing = tuned.compensator.smoothing_rad_s;
        remarks.push(match smoothing > 0.0 {
            true => format!("s = tanh(dq / {smoothing}), the smoothed sign of dq."),
            false => "s is the sign of dq, 0 at 0.".to_owned(),
        });
        remarks.push(match tuned.compensator.source {
            VelocitySource::Measured => "dq is the measured velocity.".to_owned(),
            VelocitySource::Reference => {
                format!("dq is the reference velocity; the measured one is not looked at. {REFERENCE}")
            }
            VelocitySource::Hybrid => format!(
                "dq is the measured velocity where that is above {} rad/s, else the reference velocity: also where the measured \
                 one is not finite. {REFERENCE}",
                tuned.compensator.hybrid_threshold_rad_s
            ),
        });
        remarks.extend(bounds::remarks(tuned, effects));
        remarks.push("SI units (rad, rad/s, Nm, s); joints from the base.".to_owned());
        if effects {
            remarks.push(
                "load is the torque that the gears pass to the links: gravity, Coriolis and link inertia. dt is the control period."
                    .to_owned(),
            );
            let parts = match memory > N {
                true => format!(", then in the same order those of parts b of dry friction ({memory} in all)"),
                false => String::new(),
            };
            remarks.push(format!(
                "z is the memory of the compensator, one bristle per joint{parts}: zero at the start, then left alone. \
                 What is beyond 1 counts as 1, what is not finite as 0: garbage is forgotten within the distance of presliding."
            ));
        }
        remarks.extend(losses.iter().map(|loss| format!("Not in this file: {loss}")));
        let mut opening = vec![velocity(tuned, prefix)];
        opening.extend(bounds::opening(prefix, |name| any_uses(&terms, name)));
        if any_uses(&terms, "s") {
            opening.push(sign(tuned));
        }
        let takes = match tuned.compensator.source {
            VelocitySource::Measured => [true, false],
            VelocitySource::Reference => [false, true],
            VelocitySource::Hybrid => [true, true],
        };
        let most_nm = ("most_nm".to_owned(), std::array::from_fn(|j| bounds::most_nm(tuned, j)));
        Self { opening, most_nm, terms, effects, memory, takes, losses, remarks }
    }

    /// The tables of all terms, each once.
    pub fn tables(&self) -> Vec<&(String, [f64; N])> {
        let mut tables: Vec<&(String, [f64; N])> = vec![&self.most_nm];
        for table in self.terms.iter().flat_map(|term| &term.tables) {
            if tables.iter().all(|known| known.0 != table.0) {
                tables.push(table);
            }
        }
        tables
    }

    /// Whether an argument is used in any statement (those in C stand for those in Rust).
    pub fn uses(&self, argument: &str) -> bool {
        any_uses(&self.terms, bounds::checked(argument))
    }
}

fn any_uses<const N: usize>(terms: &[Term<N>], variable: &str) -> bool {
    let ours = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    terms.iter().any(|term| term.c.split(|letter| !ours(letter)).any(|word| word == variable))
}
