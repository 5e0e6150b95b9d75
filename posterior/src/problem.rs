//! The Bayesian regression behind a diagnosis.
//!
//! ```text
//! y_j = (1 + g_j)(τ0_j + A_j θ) + e_j,   e_j ~ N(0, κ_j σ_j² per sample),   θ_f ~ N(0, α_f² Q_f⁻¹)
//! ```
//!
//! Bilinear in the gains g and the rest: linear about a [`State`], in which everything is algebra on the Gram matrices of
//! [`Columns`].

use nalgebra::{DMatrix, DVector, Matrix3, Matrix4, SMatrix, Vector3};
use tribo_regression::RegressionData;
use tribo_regression::cause::link_from_flange;

use crate::body::{self, Parameters};
use crate::columns::Columns;
use crate::joint_columns::{DELAY, LINKS, TILT};
use crate::joint_term::JointTerm;
use crate::prior::{ArmScale, Family, PAYLOAD_RADIUS_M};

/// What a parameter stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A term of one joint.
    Own(usize, JointTerm),
    /// Scale of a joint's torque signal.
    Gain(usize),
    /// Gravity across itself, first or second direction of [`tribo_regression::cause::base_tilt_columns`] over g.
    Tilt(usize),
    /// Lateness of all torques.
    Delay,
    /// Mass, then first moments about the flange, of a payload.
    Payload(usize),
    /// One of the ten parameters of a link.
    Link(usize, usize),
}

impl Place {
    /// The joint, of a parameter that one joint has.
    pub fn joint(self) -> Option<usize> {
        match self {
            Self::Own(joint, _) | Self::Gain(joint) => Some(joint),
            _ => None,
        }
    }

    /// The family that it belongs to.
    pub fn family(self) -> Family {
        match self {
            Self::Own(_, term) => match term {
                JointTerm::Offset => Family::Offset,
                JointTerm::Coulomb | JointTerm::Viscous => Family::CoulombViscous,
                JointTerm::Curve(_) => Family::Curve,
                JointTerm::Load => Family::Load,
                JointTerm::Rotor => Family::Rotor,
                JointTerm::Presliding(_) => Family::Presliding,
                JointTerm::Lead(_) => Family::Lead,
                JointTerm::Sine(_) | JointTerm::Cosine(_) => Family::Ripple,
                JointTerm::Spring => Family::Spring,
            },
            Self::Gain(_) => Family::Gain,
            Self::Tilt(_) => Family::Tilt,
            Self::Delay => Family::Delay,
            Self::Payload(_) => Family::Payload,
            Self::Link(..) => Family::Links,
        }
    }
}

/// Where the bilinear model is made linear, which is also what it predicts with: one value per parameter.
pub type State = DVector<f64>;

/// The regression of some logs on all families.
pub struct Problem {
    /// Columns of every joint, with their Gram matrices part by part.
    pub columns: Columns,
    /// What each parameter is of.
    pub places: Vec<Place>,
    /// Precision of the parameters at unit scales, block-diagonal by family.
    pub precision: DMatrix<f64>,
    /// Nominal parameters of each link.
    pub links: Vec<Parameters>,
    /// A body of each link's size.
    pub typical: Vec<Matrix4<f64>>,
    /// What the model already has of rotors: none may become negative.
    pub rotor_kg_m2: Vec<f64>,
    /// What the model already has of dry friction (Nm): friction drives no joint, however slowly it turns.
    pub dry_nm: Vec<f64>,
    /// What the model already has of viscous friction [Nm s/rad]: friction drives no joint, however fast it turns.
    pub viscous_nm_s_per_rad: Vec<f64>,
    /// How strong the arm is, joint by joint: what priors are relative to.
    pub scale: ArmScale,
    /// Logs without payload.
    pub unloaded: Vec<bool>,
    last_link_from_flange: SMatrix<f64, 10, 10>,
    gravity_m_s2: f64,
}

/// Normal equations of one joint's rows at a state.
pub struct JointSystem {
    /// Parameters that the joint feels.
    pub index: Vec<usize>,
    pub gram: DMatrix<f64>,
    pub score: DVector<f64>,
    /// Σ b².
    pub square: f64,
}

/// Normal equations of all joints.
pub struct NormalEquations {
    pub joints: Vec<JointSystem>,
    /// Rows of each joint.
    pub samples: usize,
}

/// Largest error of a torque's scale that the linearisation follows.
pub(crate) const LARGEST_GAIN: f64 = 0.5;

impl Problem {
    /// The problem of regression data; `unloaded` says of each log whether the flange was bare.
    pub fn of<const N: usize>(
        data: &RegressionData<N>,
        columns: Columns,
        scale: ArmScale,
        unloaded: Vec<bool>,
    ) -> Self {
        let arm = &data.nominal.arm;
        let ripples = |j: usize| scale.slowest_ripple[j].is_some();
        let terms = |j: usize| {
            let all = JointTerm::ALL.into_iter();
            all.filter(move |term| ripples(j) || !matches!(term, JointTerm::Sine(_) | JointTerm::Cosine(_)))
        };
        let mut places: Vec<Place> = (0..N).flat_map(|j| terms(j).map(move |term| Place::Own(j, term))).collect();
        places.extend((0..N).map(Place::Gain));
        places.push(Place::Delay);
        if !data.transmission {
            places.extend((0..2).map(Place::Tilt));
            places.extend((0..4).map(Place::Payload));
            places.extend((0..N).flat_map(|link| (0..10).map(move |i| Place::Link(link, i))));
        }
        let typical: Vec<Matrix4<f64>> = (0..N).map(|k| body::typical_body(arm, k)).collect();
        let mut precision = DMatrix::zeros(places.len(), places.len());
        let payload = scale.payload_sd();
        for (i, place) in places.iter().enumerate() {
            let sd = match *place {
                Place::Own(j, term) => scale.joint_sd(j, term),
                Place::Gain(_) => scale.gain_sd(),
                Place::Tilt(_) => ArmScale::TILT_SD_RAD,
                Place::Delay => ArmScale::DELAY_SD_S,
                Place::Payload(k) => payload[k],
                Place::Link(link, a) => {
                    if a == 0
                        && let Some(metric) = body::metric(&typical[link])
                    {
                        precision.view_mut((i, i), (10, 10)).copy_from(&metric);
                    }
                    continue;
                }
            };
            precision[(i, i)] = sd.powi(-2);
        }
        Self {
            columns,
            places,
            precision,
            links: arm.links.iter().map(body::of_link).collect(),
            typical,
            dry_nm: (0..N).map(|j| data.nominal.dry_nm(j)).collect(),
            viscous_nm_s_per_rad: (0..N).map(|j| data.nominal.viscous_nm_s(j)).collect(),
            rotor_kg_m2: arm.rotor_inertia_kg_m2.iter().copied().collect(),
            scale,
            unloaded,
            last_link_from_flange: link_from_flange(arm),
            gravity_m_s2: arm.gravity_m_s2.norm(),
        }
    }

    /// The same regression on other rows.
    pub fn over(&self, columns: Columns) -> Self {
        Self {
            columns,
            places: self.places.clone(),
            precision: self.precision.clone(),
            links: self.links.clone(),
            typical: self.typical.clone(),
            dry_nm: self.dry_nm.clone(),
            viscous_nm_s_per_rad: self.viscous_nm_s_per_rad.clone(),
            rotor_kg_m2: self.rotor_kg_m2.clone(),
            scale: self.scale.clone(),
            unloaded: self.unloaded.clone(),
            last_link_from_flange: self.last_link_from_flange,
            gravity_m_s2: self.gravity_m_s2,
        }
    }

    /// Length of gravity (m/s²).
    pub fn gravity_m_s2(&self) -> f64 {
        self.gravity_m_s2
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.columns.joints.len()
    }

    /// Index of a parameter.
    pub fn index(&self, place: Place) -> Option<usize> {
        self.places.iter().position(|other| *other == place)
    }

    /// Parameters of a family.
    pub fn of_family(&self, family: Family) -> impl Iterator<Item = usize> + '_ {
        (0..self.places.len()).filter(move |i| self.places[*i].family() == family)
    }

    /// Whether the logs have any column of a family.
    pub fn has(&self, family: Family) -> bool {
        self.of_family(family).next().is_some()
    }

    /// Every part of the logs.
    pub fn all_parts(&self) -> Vec<usize> {
        (0..self.columns.parts.len()).collect()
    }

    /// Gain of a joint at a state, within what the linearisation follows.
    pub fn gain(&self, state: &State, joint: usize) -> f64 {
        self.index(Place::Gain(joint)).map_or(0.0, |i| state[i].clamp(-LARGEST_GAIN, LARGEST_GAIN))
    }

    /// Centre of mass of the payload at a state (m, flange frame).
    pub fn payload_com_m(&self, state: &State) -> Vector3<f64> {
        let at = |k: usize| self.index(Place::Payload(k)).map_or(0.0, |i| state[i]);
        let mass_kg = at(0);
        if mass_kg > 1e-3 * self.scale.rated_payload_kg {
            let com = Vector3::new(at(1), at(2), at(3)) / mass_kg;
            // A direction that nothing determines must not run away with the inertia.
            com * (FARTHEST_COM_M / com.norm().max(FARTHEST_COM_M))
        } else {
            Vector3::zeros()
        }
    }

    /// Ten parameters in the flange frame per unit of a payload parameter, about a centre of mass: a body whose radius of
    /// gyration about its own centre is [`PAYLOAD_RADIUS_M`].
    ///
    /// ```text
    /// I_o = r² m 1 + (h·h 1 − h hᵀ)/m:   ∂I_o/∂m = r² 1 − (c·c 1 − c cᵀ),   ∂I_o/∂h_i = 2 c_i 1 − (c e_iᵀ + e_i cᵀ)
    /// ```
    ///
    /// Homogeneous of degree one in (m, h): at c the linear body is the body itself.
    fn payload_direction(&self, k: usize, com_m: &Vector3<f64>) -> Parameters {
        let c = com_m;
        let (mut pi, inertia) = if k == 0 {
            let about = Matrix3::identity() * (PAYLOAD_RADIUS_M.powi(2) - c.norm_squared()) + c * c.transpose();
            (Parameters::zeros(), about)
        } else {
            let e = Vector3::ith(k - 1, 1.0);
            let about = Matrix3::identity() * (2.0 * c[k - 1]) - (c * e.transpose() + e * c.transpose());
            (Parameters::zeros(), about)
        };
        pi[k] = 1.0;
        for (place, (r, c)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].into_iter().enumerate() {
            pi[4 + place] = inertia[(r, c)];
        }
        self.last_link_from_flange * pi
    }

    /// Weights of the columns of a joint per unit of a parameter, gains aside; `None` if the joint does not feel it.
    fn direction(&self, joint: usize, place: Place, com_m: &Vector3<f64>, loaded: bool) -> Option<Vec<(usize, f64)>> {
        let columns = &self.columns.joints[joint];
        let of_link = |link: usize| {
            (columns.links > 0 && link >= columns.first_link).then(|| LINKS + 10 * (link - columns.first_link))
        };
        match place {
            Place::Own(j, term) => (j == joint).then(|| vec![(term.place(), 1.0)]),
            Place::Gain(_) => None,
            Place::Tilt(axis) => Some(vec![(TILT + axis, self.gravity_m_s2)]),
            Place::Delay => Some(vec![(DELAY, 1.0)]),
            Place::Payload(k) => {
                let first = of_link(self.joints() - 1)?;
                let pi = self.payload_direction(k, com_m);
                Some(if loaded { pi.iter().enumerate().map(|(i, w)| (first + i, *w)).collect() } else { Vec::new() })
            }
            Place::Link(link, i) => Some(vec![(of_link(link)? + i, 1.0)]),
        }
    }

    /// Weights of the columns of a joint in `A θ`.
    pub fn change(&self, state: &State, joint: usize, loaded: bool) -> DVector<f64> {
        let columns = &self.columns.joints[joint];
        let com_m = self.payload_com_m(state);
        let mut weights = DVector::zeros(columns.matrix.ncols());
        for (place, value) in self.places.iter().zip(state.iter()).filter(|(_, value)| **value != 0.0) {
            for (column, weight) in self.direction(joint, *place, &com_m, loaded).into_iter().flatten() {
                weights[column] += weight * value;
            }
        }
        weights
    }

    /// Weights of the columns of a joint in the residual `y − (1 + g)(τ0 + A θ)`.
    pub fn residual(&self, state: &State, joint: usize, loaded: bool) -> DVector<f64> {
        let columns = &self.columns.joints[joint];
        let mut weights = self.change(state, joint, loaded);
        weights[columns.nominal()] += 1.0;
        weights *= -(1.0 + self.gain(state, joint));
        weights[columns.measured()] += 1.0;
        weights
    }

    /// The residual of a joint along some parts (Nm).
    pub fn residual_along(&self, state: &State, joint: usize, parts: &[usize]) -> Vec<f64> {
        let weights = [false, true].map(|loaded| self.residual(state, joint, loaded));
        parts
            .iter()
            .flat_map(|part| {
                let loaded = self.loaded(*part);
                self.columns.combined(joint, &weights[usize::from(loaded)], std::slice::from_ref(part))
            })
            .collect()
    }

    /// A term of a joint along some parts, per unit of its parameter.
    pub fn term_along(&self, joint: usize, term: JointTerm, parts: &[usize]) -> Vec<f64> {
        let mut weights = DVector::zeros(self.columns.joints[joint].matrix.ncols());
        weights[term.place()] = 1.0;
        self.columns.unweighted(joint, &weights, parts)
    }

    /// Σ of the squared residual of a joint over one part, rows unweighted (Nm²).
    pub fn unseen_square(&self, state: &State, joint: usize, part: usize) -> f64 {
        let weights = self.residual(state, joint, self.loaded(part));
        self.columns.unweighted(joint, &weights, &[part]).iter().map(|r| r * r).sum()
    }

    /// Mean square of the residual of each joint over some parts (Nm²).
    pub fn mean_squares(&self, state: &State, parts: &[usize]) -> Vec<f64> {
        let samples = self.columns.samples(parts).max(1) as f64;
        (0..self.joints())
            .map(|j| {
                let weights = [false, true].map(|loaded| self.residual(state, j, loaded));
                let square = |part: &usize| {
                    let weights = &weights[usize::from(self.loaded(*part))];
                    (weights.transpose() * &self.columns.grams[*part][j] * weights)[0].max(0.0)
                };
                parts.iter().map(square).sum::<f64>() / samples
            })
            .collect()
    }

    /// A state with some parameters at zero.
    pub fn without(&self, state: &State, left_out: impl Fn(Place) -> bool) -> State {
        State::from_fn(state.len(), |i, _| if left_out(self.places[i]) { 0.0 } else { state[i] })
    }

    /// Whether the payload is at the flange in a part.
    pub fn loaded(&self, part: usize) -> bool {
        !self.unloaded[self.columns.parts[part].log]
    }

    /// The normal equations over some parts, linear about a state.
    pub fn normal_equations(&self, state: &State, parts: &[usize]) -> NormalEquations {
        let com_m = self.payload_com_m(state);
        let of_loading = [false, true].map(|loaded| {
            let parts: Vec<usize> = parts.iter().copied().filter(|part| self.loaded(*part) == loaded).collect();
            self.columns.gram_over(&parts)
        });
        let grams = |j: usize| of_loading.each_ref().map(|grams| grams.as_ref().map(|grams| &grams[j]));
        let joints = (0..self.joints()).map(|j| self.joint_system(state, j, &com_m, grams(j))).collect();
        NormalEquations { joints, samples: self.columns.samples(parts) }
    }

    /// Derivative of the predicted torque of a joint by some parameters, as weights of its columns.
    pub fn slopes(&self, state: &State, j: usize, index: &[usize], loaded: bool) -> DMatrix<f64> {
        let columns = &self.columns.joints[j];
        let (gain, com_m) = (self.gain(state, j), self.payload_com_m(state));
        let mut map = DMatrix::zeros(columns.matrix.ncols(), index.len());
        for (local, i) in index.iter().enumerate() {
            let place = self.places[*i];
            if place == Place::Gain(j) {
                map.column_mut(local).copy_from(&self.change(state, j, loaded));
                map[(columns.nominal(), local)] += 1.0;
            } else {
                for (column, weight) in self.direction(j, place, &com_m, loaded).into_iter().flatten() {
                    map[(column, local)] += weight * (1.0 + gain);
                }
            }
        }
        map
    }

    /// The equations of one joint from the Gram matrices of its columns without and with payload.
    fn joint_system(
        &self,
        state: &State,
        j: usize,
        com_m: &Vector3<f64>,
        grams: [Option<&DMatrix<f64>>; 2],
    ) -> JointSystem {
        let columns = &self.columns.joints[j];
        let gain = self.gain(state, j);
        let felt = |place: &Place| *place == Place::Gain(j) || self.direction(j, *place, com_m, true).is_some();
        let index: Vec<usize> = (0..self.places.len()).filter(|i| felt(&self.places[*i])).collect();
        let mut system = JointSystem {
            gram: DMatrix::zeros(index.len(), index.len()),
            score: DVector::zeros(index.len()),
            square: 0.0,
            index,
        };
        for (loaded, gram) in [false, true].into_iter().zip(grams) {
            let Some(gram) = gram else { continue };
            // b = y − τ0 + g0 A θ0, columns (1 + g0) A and τ0 + A θ0.
            let change = self.change(state, j, loaded);
            let mut target = &change * gain;
            target[columns.nominal()] -= 1.0;
            target[columns.measured()] += 1.0;
            let map = self.slopes(state, j, &system.index, loaded);
            let half = gram * &map;
            system.gram += map.tr_mul(&half);
            system.score += half.tr_mul(&target);
            system.square += target.dot(&(gram * &target)).max(0.0);
        }
        system
    }
}

/// Farthest centre of mass of a payload about which its inertia is made linear (m).
const FARTHEST_COM_M: f64 = 0.5;
