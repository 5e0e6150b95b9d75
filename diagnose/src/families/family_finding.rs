//! Selected families as findings: one per label, with its joints in a table.

use std::f64::consts::SQRT_2;

use nalgebra::DMatrix;
use tribo_posterior::{
    CURVE_WIDTHS, Family, Fit, JointTerm, PRESLIDING_RAD, Place, Problem, RIPPLES, Selection, Unseen, ripple,
};
use tribo_regression::cause::tilt_of;
use tribo_regression::{CauseLabel, Location, RegressionData};
use tribo_sim::Effect;

use crate::confusable::why;
use crate::diagnosis::{Alternative, Finding, Parameter, Plot, Series};
use crate::held_out::gain_of_pairs;
use crate::parameters::parameters_of;

/// Standard deviations that a joint's torque of a family must be above zero.
const SURE: f64 = 2.0;
/// RMS of that torque over what is left of the joint.
const NOTABLE: f64 = 0.3;
/// Change of a link's mass, relative to it, from which on the link is named.
const NOTABLE_MASS: f64 = 0.1;
/// Change of its first moment over its mass from which on the link is named (m).
const NOTABLE_SHIFT_M: f64 = 0.02;
/// Half-width of a 95 % interval over a standard deviation.
const HALF_WIDTH: f64 = 1.96;

/// Everything that findings are made of.
pub(crate) struct Answer<'a, const N: usize> {
    pub data: &'a RegressionData<N>,
    pub problem: &'a Problem,
    pub fit: &'a Fit,
    /// The same with gains of which nothing is known, which what loads the whole arm is told with.
    pub unsure: &'a Fit,
    pub selection: &'a Selection,
    pub unseen: &'a Unseen,
    pub seed: u64,
}

/// What a family shows: where, how large, and the RMS of its torque on the joint where that is largest (Nm).
struct Shown {
    joints: Vec<usize>,
    links: Vec<usize>,
    parameters: Vec<Parameter>,
    explained_rms_nm: f64,
}

/// Size of one joint's torque by some of its own terms (Nm RMS), with its standard deviation.
struct Size {
    rms_nm: f64,
    sd_nm: f64,
}

fn largest(of: &[f64]) -> f64 {
    of.iter().copied().fold(0.0, f64::max)
}

impl<const N: usize> Answer<'_, N> {
    /// The findings of a family; none where no joint shows it.
    pub fn findings(&self, family: Family) -> Vec<Finding> {
        let labels = family.labels().iter();
        labels.filter_map(|label| self.finding(family, *label)).collect()
    }

    fn finding(&self, family: Family, label: CauseLabel) -> Option<Finding> {
        let Shown { joints, links, parameters, explained_rms_nm } = match family {
            Family::Payload | Family::Tilt | Family::Delay => self.of_arm(family)?,
            Family::Links => self.of_links()?,
            Family::Gain => self.of_gains()?,
            _ => self.of_joints(family, label)?,
        };
        let location = match (&joints[..], &links[..]) {
            ([joint], []) => Location::Joint(*joint),
            ([], [link]) => Location::Link(*link),
            _ => Location::Arm,
        };
        let worth = self.selection.worth.get(&family).copied().unwrap_or(0.0);
        let (held_out_gain, held_out_gain_ci95) = self.gain(family, &joints);
        let alternatives = self
            .selection
            .rivals
            .get(&family)
            .into_iter()
            .flatten()
            .filter_map(|(rival, lost)| {
                let other = *rival.labels().first()?;
                let location = if joints.len() == 1 { location } else { Location::Arm };
                Some(Alternative { label: other, location, evidence_gap: 2.0 * lost.max(0.0), why: why(label, other) })
            })
            .collect();
        Some(Finding {
            label,
            location,
            joints,
            links,
            effect: None,
            parameters,
            signature: None,
            p_value: (-worth).exp().min(1.0),
            held_out_gain,
            held_out_gain_ci95,
            explained_rms_nm,
            evidence: 2.0 * worth,
            alternatives,
            plots: if label == CauseLabel::Coulomb { vec![self.friction_plot()] } else { Vec::new() },
        })
    }

    /// Gain on unseen parts, over the joints concerned, each in units of what is left there.
    pub fn gain(&self, family: Family, joints: &[usize]) -> (f64, [f64; 2]) {
        let Some((_, without)) = self.unseen.without.iter().find(|(other, _)| *other == family) else {
            return (0.0, [0.0; 2]);
        };
        let concerned: Vec<usize> = if joints.is_empty() { (0..N).collect() } else { joints.to_vec() };
        let sum = |row: &[f64]| concerned.iter().map(|j| row[*j] / self.fit.variances[*j]).sum::<f64>();
        let pairs: Vec<[f64; 2]> =
            without.iter().zip(&self.unseen.ours).map(|(without, ours)| [sum(without), sum(ours)]).collect();
        gain_of_pairs(&pairs, self.seed)
    }

    fn size(&self, joint: usize, terms: &[JointTerm]) -> Size {
        let parts = self.problem.all_parts();
        let samples = self.problem.columns.samples(&parts).max(1) as f64;
        let columns: Vec<usize> = terms.iter().map(|term| term.place()).collect();
        let index: Vec<Option<usize>> = terms.iter().map(|t| self.problem.index(Place::Own(joint, *t))).collect();
        let gram = DMatrix::from_fn(columns.len(), columns.len(), |r, c| {
            parts.iter().map(|part| self.problem.columns.grams[*part][joint][(columns[r], columns[c])]).sum::<f64>()
        }) / samples;
        let (mut square, mut variance) = (0.0, 0.0);
        for (r, a) in index.iter().enumerate() {
            for (c, b) in index.iter().enumerate() {
                let (Some(a), Some(b)) = (a, b) else { continue };
                square += gram[(r, c)] * self.fit.state[*a] * self.fit.state[*b];
                variance += gram[(r, c)] * self.fit.covariance_of(*a, *b);
            }
        }
        Size { rms_nm: square.max(0.0).sqrt(), sd_nm: variance.max(0.0).sqrt() }
    }

    fn left_nm(&self, joint: usize) -> f64 {
        self.fit.variances[joint].sqrt()
    }

    /// A parameter with one value per place, from values and their standard deviations.
    fn table(name: &'static str, values: Vec<(f64, f64)>) -> Parameter {
        let ends = |(value, sd): &(f64, f64)| [value - HALF_WIDTH * sd, value + HALF_WIDTH * sd];
        Parameter { name, ci95: values.iter().map(ends).collect(), value: values.into_iter().map(|(v, _)| v).collect() }
    }

    fn own(&self, joint: usize, term: JointTerm) -> (f64, f64) {
        self.problem.index(Place::Own(joint, term)).map_or((0.0, 0.0), |i| (self.fit.state[i], self.fit.sd(i)))
    }

    /// Σ of several terms of one joint.
    fn sum(&self, joint: usize, terms: &[JointTerm]) -> (f64, f64) {
        let index: Vec<usize> = terms.iter().filter_map(|t| self.problem.index(Place::Own(joint, *t))).collect();
        self.fit.sum(&index)
    }

    /// Joints that may show a family: all, or those that the selection has it in.
    fn joints_of(&self, family: Family) -> Vec<usize> {
        self.selection.only_joints.get(&family).cloned().unwrap_or_else(|| (0..N).collect())
    }

    fn of_joints(&self, family: Family, label: CauseLabel) -> Option<Shown> {
        use JointTerm as T;
        let terms: &[T] = match label {
            CauseLabel::TorqueOffset => &[T::Offset],
            CauseLabel::Coulomb => &[T::Coulomb],
            CauseLabel::Viscous => &[T::Viscous],
            CauseLabel::FrictionCurve => &[T::Curve(0), T::Curve(1), T::Curve(2)],
            CauseLabel::LoadFriction => &[T::Load],
            CauseLabel::RotorInertia => &[T::Rotor],
            CauseLabel::Presliding => &[T::Presliding(0), T::Presliding(1), T::Presliding(2)],
            CauseLabel::TorqueRipple => &JointTerm::RIPPLE,
            CauseLabel::PositionSpring => &[T::Spring],
            _ => return None,
        };
        let sizes: Vec<Size> = (0..N).map(|j| self.size(j, terms)).collect();
        // Dry, viscous and bent friction are one function of speed: how it is split among them is the least sure of it.
        let sliding = [T::Coulomb, T::Viscous, T::Curve(0), T::Curve(1), T::Curve(2)];
        let shown = if matches!(label, CauseLabel::Coulomb | CauseLabel::Viscous) { &sliding[..] } else { terms };
        let shows = |j: &usize| {
            let size = self.size(*j, shown);
            size.rms_nm > SURE * size.sd_nm && size.rms_nm > NOTABLE * self.left_nm(*j)
        };
        let joints: Vec<usize> = self.joints_of(family).into_iter().filter(shows).collect();
        let explained = joints.iter().map(|j| sizes[*j].rms_nm).fold(0.0, f64::max);
        let of = |term: T| joints.iter().map(|j| self.own(*j, term)).collect::<Vec<_>>();
        let summed = || joints.iter().map(|j| self.sum(*j, terms)).collect::<Vec<_>>();
        // Of several widths or distances, the mean by size says where the friction bends.
        let typical = |shapes: &dyn Fn(usize, usize) -> f64| -> Vec<(f64, f64)> {
            joints
                .iter()
                .map(|j| {
                    let sizes: Vec<f64> = terms.iter().map(|term| self.own(*j, *term).0.abs()).collect();
                    let total: f64 = sizes.iter().sum::<f64>().max(1e-300);
                    ((0..sizes.len()).map(|k| sizes[k] / total * shapes(*j, k)).sum(), 0.0)
                })
                .collect()
        };
        let parameters = match label {
            CauseLabel::TorqueOffset => vec![Self::table("offset_nm", of(T::Offset))],
            CauseLabel::Coulomb => vec![Self::table("delta_coulomb_nm", of(T::Coulomb))],
            CauseLabel::Viscous => vec![Self::table("delta_viscous_nm_s_per_rad", of(T::Viscous))],
            CauseLabel::FrictionCurve => {
                let width = |j: usize, k: usize| self.problem.scale.curve_width_rad_s(j, k);
                vec![Self::table("amplitude_nm", summed()), Self::table("width_rad_s", typical(&width))]
            }
            CauseLabel::LoadFriction => vec![Self::table("load_coefficient", of(T::Load))],
            CauseLabel::RotorInertia => vec![Self::table("delta_rotor_inertia_kg_m2", of(T::Rotor))],
            CauseLabel::Presliding => {
                let distance = |_: usize, k: usize| PRESLIDING_RAD[k];
                vec![Self::table("presliding_distance_rad", typical(&distance)), Self::table("amplitude_nm", summed())]
            }
            CauseLabel::TorqueRipple => self.ripples(&joints),
            _ => vec![
                Self::table("stiffness_nm_per_rad", of(T::Spring)),
                Self::table("rest_rad", joints.iter().map(|_| (0.0, 0.0)).collect()),
            ],
        };
        (!joints.is_empty()).then_some(Shown { joints, links: Vec::new(), parameters, explained_rms_nm: explained })
    }

    /// The ripple of each joint as one wave: amplitude of all waves together, √2 RMS, number and phase of the largest; where a
    /// joint covers a part of a turn neighbouring waves share what one of them does.
    fn ripples(&self, joints: &[usize]) -> Vec<Parameter> {
        let rows = joints.iter().filter_map(|j| {
            let waves = (0..RIPPLES).filter_map(|k| match ripple(self.problem, &self.fit.state, *j, k)? {
                Effect::TorqueRipple { cycles_per_rev, amplitude_nm, phase_rad, .. } => {
                    let sd = self.own(*j, JointTerm::Sine(k)).1.hypot(self.own(*j, JointTerm::Cosine(k)).1) / SQRT_2;
                    Some((cycles_per_rev, amplitude_nm, [phase_rad, sd / amplitude_nm]))
                }
                _ => None,
            });
            let (cycles_per_rev, _, [phase_rad, phase_sd]) = waves.max_by(|a, b| a.1.total_cmp(&b.1))?;
            let Size { rms_nm, sd_nm } = self.size(*j, &JointTerm::RIPPLE);
            Some([(cycles_per_rev, 0.0), (SQRT_2 * rms_nm, SQRT_2 * sd_nm), (phase_rad, phase_sd)])
        });
        let rows: Vec<[(f64, f64); 3]> = rows.collect();
        let column = |name, k: usize| Self::table(name, rows.iter().map(|row| row[k]).collect());
        vec![column("cycles_per_rev", 0), column("amplitude_nm", 1), column("phase_rad", 2)]
    }

    fn of_gains(&self) -> Option<Shown> {
        let value =
            |j: usize| self.problem.index(Place::Gain(j)).map_or((0.0, 0.0), |i| (self.fit.state[i], self.fit.sd(i)));
        let rms = |x: &[f64]| tribo_regression::rms(x);
        let size = |j: usize| value(j).0.abs() * rms(&self.data.measured_nm[j]);
        let shows = |j: &usize| value(*j).0.abs() > SURE * value(*j).1 && size(*j) > NOTABLE * self.left_nm(*j);
        let joints: Vec<usize> = self.joints_of(Family::Gain).into_iter().filter(shows).collect();
        let explained = joints.iter().map(|j| size(*j)).fold(0.0, f64::max);
        let parameters = vec![Self::table("gain_error", joints.iter().map(|j| value(*j)).collect())];
        (!joints.is_empty()).then_some(Shown { joints, links: Vec::new(), parameters, explained_rms_nm: explained })
    }

    /// RMS of the torque of a family on each joint (Nm).
    fn torques_nm(&self, family: Family) -> Vec<f64> {
        let mut only = self.fit.state.clone();
        for (i, place) in self.problem.places.iter().enumerate() {
            if place.family() != family {
                only[i] = 0.0;
            }
        }
        let parts = self.problem.all_parts();
        (0..N)
            .map(|j| {
                let loaded = parts.iter().filter(|part| self.problem.loaded(**part)).copied().collect::<Vec<usize>>();
                let weights = self.problem.change(&only, j, true);
                tribo_regression::rms(&self.problem.columns.combined(j, &weights, &loaded))
            })
            .collect()
    }

    fn of_arm(&self, family: Family) -> Option<Shown> {
        let at =
            |place: Place| self.problem.index(place).map_or((0.0, 0.0), |i| (self.unsure.state[i], self.unsure.sd(i)));
        let parameters = match family {
            Family::Delay => vec![Self::table("delay_s", vec![at(Place::Delay)])],
            Family::Tilt => {
                let (x, y) = (at(Place::Tilt(0)), at(Place::Tilt(1)));
                let gravity = self.data.nominal.arm.gravity_m_s2.norm();
                let effect = tilt_of(self.data, [x.0 * gravity, y.0 * gravity])?;
                let sd = x.1.max(y.1);
                let spread = [sd, (sd / x.0.hypot(y.0).max(1e-9)).min(1.0)];
                parameters_of(&effect)
                    .into_iter()
                    .zip(spread)
                    .map(|((name, values), sd)| Self::table(name, values.into_iter().map(|v| (v, sd)).collect()))
                    .collect()
            }
            _ => {
                let mass = at(Place::Payload(0));
                let com = |k: usize| {
                    let moment = at(Place::Payload(k));
                    let com = moment.0 / mass.0;
                    (com, (moment.1 / mass.0).hypot(com * mass.1 / mass.0))
                };
                vec![Self::table("mass_kg", vec![mass]), Self::table("com_m", (1..4).map(com).collect())]
            }
        };
        let torques_nm = self.torques_nm(family);
        let notable = torques_nm.iter().enumerate().any(|(j, rms_nm)| *rms_nm > NOTABLE * self.left_nm(j));
        let explained_rms_nm = largest(&torques_nm);
        notable.then_some(Shown { joints: Vec::new(), links: Vec::new(), parameters, explained_rms_nm })
    }

    fn of_links(&self) -> Option<Shown> {
        let at = |link: usize, i: usize| {
            self.problem.index(Place::Link(link, i)).map_or((0.0, 0.0), |i| (self.fit.state[i], self.fit.sd(i)))
        };
        let notable = |link: &usize| {
            let mass_kg = self.problem.typical[*link][(3, 3)];
            let moment = (1..4).map(|i| at(*link, i).0.powi(2)).sum::<f64>().sqrt();
            let mass = at(*link, 0);
            (mass.0.abs() > NOTABLE_MASS * mass_kg && mass.0.abs() > SURE * mass.1)
                || moment > NOTABLE_SHIFT_M * mass_kg
        };
        let links: Vec<usize> = (0..N).filter(notable).collect();
        let mass = Self::table("delta_mass_kg", links.iter().map(|link| at(*link, 0)).collect());
        let moments = links.iter().flat_map(|link| (1..4).map(move |i| (*link, i)));
        let moment = Self::table("delta_first_moment_kg_m", moments.map(|(link, i)| at(link, i)).collect());
        let explained_rms_nm = largest(&self.torques_nm(Family::Links));
        let parameters = vec![mass, moment];
        (!links.is_empty()).then_some(Shown { joints: Vec::new(), links, parameters, explained_rms_nm })
    }

    /// Friction that the model lacks, as one function of speed per joint: dry, viscous and bent together.
    fn friction_plot(&self) -> Plot {
        const POINTS: usize = 60;
        let series = (0..N)
            .map(|j| {
                let fastest = self.data.qd[j].iter().fold(0.0, |f: f64, v| f.max(v.abs()));
                let x: Vec<f64> = (0..=POINTS).map(|k| fastest * k as f64 / POINTS as f64).collect();
                let torque = |qd: f64| {
                    let smooth = |width: f64| tribo_friction::law::smooth_sign(qd, width);
                    let curve = |k: usize| {
                        let width = self.problem.scale.curve_width_rad_s(j, k);
                        self.own(j, JointTerm::Curve(k)).0 * smooth(width)
                    };
                    self.own(j, JointTerm::Coulomb).0 * smooth(self.data.nominal.smoothing_rad_s)
                        + self.own(j, JointTerm::Viscous).0 * qd
                        + (0..CURVE_WIDTHS.len()).map(curve).sum::<f64>()
                };
                let y = x.iter().map(|qd| torque(*qd)).collect();
                Series { name: self.data.nominal.arm.joint_names.of(j).to_string(), x, y, joined: true }
            })
            .collect();
        Plot {
            title: "Friction that the model lacks: dry, viscous and bent as one function of speed".to_owned(),
            x_label: "speed [rad/s]".to_owned(),
            y_label: "torque [Nm]".to_owned(),
            series,
        }
    }
}
