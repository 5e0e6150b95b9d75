//! Temperature dependence and heat balance from sessions of several duty cycles.

use nalgebra::{DMatrix, SMatrix};

use super::blocks::{COLUMNS, Weights, blocks};
use super::cold_fit::scaled_inverse;
use super::levenberg_marquardt::{Expansion, Information, minimise};
use super::temperature_path::{
    ALPHA, BETA, DECAY, DELTA, GAMMA, LN_C, LN_K, PARAMETERS, Parameters, STRIBECK, SessionBlocks,
};
use super::{ColdFit, ThermalFitError, ThermalSession};
use crate::thermal::{HeatBalance, PolynomialStribeck, TemperatureFactor, ThermalError, ThermalJoint, ThermalLaw};

/// Rooms must differ by this (K) to tell the unit of temperature.
const ROOM_SPREAD_K: f64 = 2.0;
/// Fewest sliding samples.
const FEWEST: usize = 1000;
/// Names of the parameters in their order.
const NAMES: [&str; PARAMETERS] = [
    "c0",
    "c1",
    "c2",
    "c3",
    "c4",
    "alpha_per_k",
    "beta",
    "gamma_per_k",
    "delta",
    "conductance_w_per_k",
    "capacity_j_per_k",
    "stribeck_decay_s_per_rad",
];
/// ±1.96 standard deviations are a 95 % interval of a normal error.
const LAMBDA_95: f64 = 1.959_963_984_540_054;

/// What is known of a joint's heat capacity beforehand: 40 kg of steel take 18 kJ/K.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapacityAnchor {
    /// C [J/K].
    pub capacity_j_per_k: f64,
    /// Its standard deviation as a part of it [-].
    pub relative_sd: f64,
}

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalFitSettings {
    /// T0 (°C): the temperature at which the cold friction was found.
    pub reference_c: f64,
    /// Speed from which a joint slides [rad/s].
    pub threshold_rad_s: f64,
    /// Length of a block in which friction has one temperature (s); also what counts as one in the covariance. Well below
    /// t_c/10, above the correlation of the noise.
    pub block_s: f64,
    /// The heat capacity, if the rooms of the sessions are equally warm.
    pub capacity: Option<CapacityAnchor>,
}

impl ThermalFitSettings {
    /// Slides from 10 mrad/s, no capacity known. Blocks of 15 s: a joint that creeps after a rest and then runs is a few
    /// tenths of a kelvin cooler while it creeps, and blocks of a minute would book that to the Stribeck part.
    pub fn new(reference_c: f64) -> Self {
        Self { reference_c, threshold_rad_s: 0.01, block_s: 15.0, capacity: None }
    }

    fn validate(&self) -> Result<(), ThermalFitError> {
        let (v, b) = (self.threshold_rad_s, self.block_s);
        ThermalError::check("reference_c", self.reference_c, self.reference_c.abs() <= 200.0, "-200 to 200 °C")?;
        ThermalError::check("threshold_rad_s", v, v > 0.0 && v <= 1.0, "above 0, up to 1 rad/s")?;
        ThermalError::check("block_s", b, (1.0..=600.0).contains(&b), "1 to 600 s")?;
        if let Some(anchor) = self.capacity {
            let (c, sd) = (anchor.capacity_j_per_k, anchor.relative_sd);
            ThermalError::check("capacity.capacity_j_per_k", c, (1.0..=1e7).contains(&c), "1 to 1e7 J/K")?;
            ThermalError::check("capacity.relative_sd", sd, (1e-4..=1.0).contains(&sd), "1e-4 to 1")?;
        }
        Ok(())
    }
}

/// A number with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimated {
    /// Best value.
    pub value: f64,
    /// Standard deviation.
    pub sd: f64,
    /// 95 % interval.
    pub interval95: [f64; 2],
}

impl Estimated {
    fn normal(value: f64, sd: f64) -> Self {
        Self { value, sd, interval95: [value - LAMBDA_95 * sd, value + LAMBDA_95 * sd] }
    }

    /// From a logarithm and its deviation.
    fn log_normal(ln: f64, sd: f64) -> Self {
        let value = ln.exp();
        Self { value, sd: value * sd, interval95: [(ln - LAMBDA_95 * sd).exp(), (ln + LAMBDA_95 * sd).exp()] }
    }

    /// Whether the interval holds `value`.
    pub fn covers(&self, value: f64) -> bool {
        (self.interval95[0]..=self.interval95[1]).contains(&value)
    }
}

/// The thermal model of a joint and how well it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct ThermalFit {
    /// The joint.
    pub joint: ThermalJoint,
    /// c0 … c3.
    pub polynomial: [Estimated; 4],
    /// α [1/K].
    pub alpha_per_k: Estimated,
    /// β [-].
    pub beta: Estimated,
    /// c4 (Nm), γ [1/K], δ [-] and h [s/rad], if the cold fit has a Stribeck part.
    pub stribeck: Option<[Estimated; 4]>,
    /// K [W/K].
    pub conductance_w_per_k: Estimated,
    /// C [J/K].
    pub capacity_j_per_k: Estimated,
    /// RMS of what is left of the friction torque (Nm).
    pub rms_nm: f64,
    /// Sliding samples behind it.
    pub samples: usize,
}

/// α, β, γ, δ, K and C by least squares over all sessions (simoni2019 section 5, simoni2017 section IV), c and h with them.
///
/// ```text
/// min Σ (tau − φ(q̇; h) · c(T))²/σ² + (c − ĉ, h − ĥ)ᵀ Σ⁻¹ (c − ĉ, h − ĥ) + (ln C − ln C₀)²/s²
/// ```
///
/// The papers hold c fixed; here the cold fit is a measurement with its covariance Σ, so the intervals know that c is not
/// exact. T is never measured: it follows the closed form from block to block. Intervals are from the sandwich
/// covariance over blocks, which holds for noise that is correlated within a block.
///
/// The scale of T: in rooms that are all equally warm, α/s, γ/s, K/s, C/s give the same torques for any s. Then either
/// rooms differ, or `settings.capacity` says how much heat the joint takes. Where T0 = T_env, the torques predicted do
/// not depend on it.
///
/// # Errors
/// [`ThermalFitError`], whichever is met first.
pub fn identify_thermal(
    cold: &ColdFit,
    sessions: &[ThermalSession],
    settings: &ThermalFitSettings,
) -> Result<ThermalFit, ThermalFitError> {
    settings.validate()?;
    sessions.iter().enumerate().try_for_each(|(k, session)| session.check(k))?;
    let warmest = sessions.iter().map(|s| s.ambient_c).fold(f64::NEG_INFINITY, f64::max);
    let coolest = sessions.iter().map(|s| s.ambient_c).fold(f64::INFINITY, f64::min);
    let problem = Problem::new(cold, sessions, settings)?;
    if settings.capacity.is_none() && warmest - coolest < ROOM_SPREAD_K {
        return Err(ThermalFitError::ScaleUnknown { got_k: warmest - coolest, need_k: ROOM_SPREAD_K });
    }
    let (p, expansion) = problem.solve();
    problem.conclude(&p, &expansion)
}

/// Sessions, prior and which parameters are free.
struct Problem<'a> {
    cold: &'a ColdFit,
    sessions: &'a [ThermalSession],
    settings: &'a ThermalFitSettings,
    /// Variance of one sample (Nm²) that weighs samples against the cold fit.
    variance: f64,
    rows: usize,
    /// Inverse covariance of (c0 … c4, h).
    prior: SMatrix<f64, COLUMNS, COLUMNS>,
    free: [bool; PARAMETERS],
    bounds: [[f64; 2]; PARAMETERS],
}

impl<'a> Problem<'a> {
    fn new(
        cold: &'a ColdFit,
        sessions: &'a [ThermalSession],
        settings: &'a ThermalFitSettings,
    ) -> Result<Self, ThermalFitError> {
        let threshold_rad_s = settings.threshold_rad_s;
        let sliding = |s: &ThermalSession| s.samples.iter().filter(|x| x.qd_rad_s.abs() >= threshold_rad_s).count();
        let rows = sessions.iter().map(sliding).sum();
        if rows < FEWEST {
            return Err(ThermalFitError::TooFewSamples { got: rows, need: FEWEST, threshold_rad_s });
        }
        let fitted = if cold.stribeck { COLUMNS } else { STRIBECK };
        let covariance = DMatrix::from_fn(fitted, fitted, |i, j| cold.covariance[(i, j)]);
        let inverse = scaled_inverse(&covariance).ok_or(ThermalFitError::Undetermined {
            parameter: "c0 … c4",
            sd: f64::INFINITY,
            allowed: 1.0,
            remedy: "the covariance of the cold fit is singular",
        })?;
        let prior = SMatrix::from_fn(|i, j| if i < fitted && j < fitted { inverse[(i, j)] } else { 0.0 });
        let mut free = [true; PARAMETERS];
        if !cold.stribeck {
            for i in [STRIBECK, GAMMA, DELTA, DECAY] {
                free[i] = false;
            }
        }
        let mut bounds = [[f64::NEG_INFINITY, f64::INFINITY]; PARAMETERS];
        for (i, range) in [
            (ALPHA, [-0.1, 0.1]),
            (BETA, [0.2, 3.0]),
            (GAMMA, [-0.2, 0.2]),
            (DELTA, [0.2, 3.0]),
            (LN_K, [1e-4_f64.ln(), 1e4_f64.ln()]),
            (LN_C, [1.0_f64.ln(), 1e7_f64.ln()]),
            (DECAY, [0.1, 2000.0]),
        ] {
            bounds[i] = range;
        }
        let variance = (cold.rms_nm * cold.rms_nm).max(1e-20);
        Ok(Self { cold, sessions, settings, variance, rows, prior, free, bounds })
    }

    fn blocks_at(&self, decay: f64) -> Vec<SessionBlocks> {
        let s = self.settings;
        let of = |session: &ThermalSession| SessionBlocks {
            ambient_c: session.ambient_c,
            start_c: session.start_c.unwrap_or(session.ambient_c),
            blocks: blocks(session, s.block_s, s.threshold_rad_s, decay),
        };
        self.sessions.iter().map(of).collect()
    }

    /// Several first guesses of the time constant with h held, then everything from the best of them.
    fn solve(&self) -> (Parameters, Expansion) {
        let cold = &self.cold.friction;
        let decay = cold.stribeck_decay_s_per_rad;
        let blocks = self.blocks_at(decay);
        let power = mean_power(&blocks, cold);
        let mut held = self.free;
        held[DECAY] = false;
        let from = |minutes: f64| {
            let tau_s = 60.0 * minutes;
            // A joint that works for long warms by some 20 K.
            let capacity = self.settings.capacity.map_or(tau_s * power / 20.0, |anchor| anchor.capacity_j_per_k);
            let mut p = Parameters::zeros();
            p.fixed_rows_mut::<4>(0).copy_from_slice(&cold.polynomial);
            p[STRIBECK] = cold.stribeck_nm;
            (p[ALPHA], p[BETA], p[GAMMA], p[DELTA]) = (-0.005, 1.0, 0.0, 1.0);
            (p[LN_C], p[LN_K], p[DECAY]) = (capacity.max(1.0).ln(), (capacity / tau_s).max(1e-4).ln(), decay);
            minimise(p, &held, &self.bounds, |p| self.expand(p, &blocks, decay).0, 60)
        };
        let better = |a: (Parameters, Expansion), b: (Parameters, Expansion)| if b.1.cost < a.1.cost { b } else { a };
        let (p, expansion) = better(better(from(60.0), from(20.0)), from(180.0));
        if !self.cold.stribeck {
            return (p, expansion);
        }
        let expand = |p: &Parameters| self.expand(p, &self.blocks_at(p[DECAY]), p[DECAY]).0;
        minimise(p, &self.free, &self.bounds, expand, 40)
    }

    /// Cost and its derivatives; also the gradient of every block, for the sandwich.
    fn expand(&self, p: &Parameters, sessions: &[SessionBlocks], decay: f64) -> (Expansion, Information) {
        let t0 = self.settings.reference_c;
        let (mut cost, mut score) = (0.0, Parameters::zeros());
        let (mut information, mut meat) = (Information::zeros(), Information::zeros());
        for session in sessions {
            let weights = session.weights(p, t0, decay);
            // Central differences of the weights: cheap, they are per block.
            let derivative: [Option<Vec<Weights>>; PARAMETERS] = std::array::from_fn(|i| {
                self.free[i].then(|| {
                    let step = 1e-5 * p[i].abs().max(if i == ALPHA || i == GAMMA { 1e-3 } else { 1e-2 });
                    let (mut up, mut down) = (*p, *p);
                    up[i] += step;
                    down[i] -= step;
                    let (a, b) = (session.weights(&up, t0, decay), session.weights(&down, t0, decay));
                    a.iter().zip(&b).map(|(a, b)| (a - b) / (2.0 * step)).collect()
                })
            });
            for (k, (block, w)) in session.blocks.iter().zip(&weights).enumerate() {
                cost += block.squared_error(w) / self.variance;
                let mut jacobian = SMatrix::<f64, COLUMNS, PARAMETERS>::zeros();
                for (i, columns) in derivative.iter().enumerate() {
                    if let Some(columns) = columns {
                        jacobian.set_column(i, &columns[k]);
                    }
                }
                let g = jacobian.tr_mul(&block.score(w)) / self.variance;
                score += g;
                meat.ger(1.0, &g, &g, 1.0);
                information += jacobian.tr_mul(&(block.gram * jacobian)) / self.variance;
            }
        }
        // The cold fit.
        let cold = &self.cold.friction;
        let index = [0, 1, 2, 3, STRIBECK, DECAY];
        let [a, b, c, d] = cold.polynomial;
        let centre = Weights::from([a, b, c, d, cold.stribeck_nm, cold.stribeck_decay_s_per_rad]);
        let off = Weights::from_fn(|i, _| p[index[i]]) - centre;
        let pull = self.prior * off;
        cost += off.dot(&pull);
        for i in 0..COLUMNS {
            score[index[i]] -= pull[i];
            for j in 0..COLUMNS {
                information[(index[i], index[j])] += self.prior[(i, j)];
                meat[(index[i], index[j])] += self.prior[(i, j)];
            }
        }
        if let Some(anchor) = self.settings.capacity {
            let weight = anchor.relative_sd.powi(-2);
            let off = p[LN_C] - anchor.capacity_j_per_k.ln();
            cost += weight * off * off;
            score[LN_C] -= weight * off;
            information[(LN_C, LN_C)] += weight;
            meat[(LN_C, LN_C)] += weight;
        }
        (Expansion { cost, score, information }, meat)
    }

    /// Bounds, uncertainty, and what the data could not tell.
    fn conclude(&self, p: &Parameters, expansion: &Expansion) -> Result<ThermalFit, ThermalFitError> {
        for i in 0..PARAMETERS {
            if self.free[i] && (p[i] <= self.bounds[i][0] || p[i] >= self.bounds[i][1]) {
                let value = if i == LN_K || i == LN_C { p[i].exp() } else { p[i] };
                return Err(ThermalFitError::AtBound { parameter: NAMES[i], value });
            }
        }
        let blocks = self.blocks_at(p[DECAY]);
        let (_, meat) = self.expand(p, &blocks, p[DECAY]);
        let free: Vec<usize> = (0..PARAMETERS).filter(|&i| self.free[i]).collect();
        let pick = |m: &Information| DMatrix::from_fn(free.len(), free.len(), |i, j| m[(free[i], free[j])]);
        let undetermined = |parameter, sd, allowed| ThermalFitError::Undetermined {
            parameter,
            sd,
            allowed,
            remedy: "log longer sessions, other duty cycles, or rooms that differ more",
        };
        let Some(inverse) = scaled_inverse(&pick(&expansion.information)) else {
            return Err(undetermined("a combination of alpha, K and C", f64::INFINITY, 0.5));
        };
        let clusters = blocks.iter().flat_map(|s| &s.blocks).filter(|b| b.rows > 0).count() as f64;
        let small = clusters / (clusters - free.len() as f64).max(1.0);
        let robust = &inverse * (pick(&meat) * small) * &inverse;
        let sd: [f64; PARAMETERS] =
            std::array::from_fn(|i| free.iter().position(|&k| k == i).map_or(0.0, |k| robust[(k, k)].max(0.0).sqrt()));
        // Logarithms beyond a factor of 1.6, a factor whose slope is as uncertain as a warm joint's whole loss.
        for (i, allowed) in [(LN_K, 0.5), (LN_C, 0.5), (ALPHA, 0.02), (BETA, 0.3), (GAMMA, 0.1), (DELTA, 1.0)] {
            if self.free[i] && (sd[i].is_nan() || sd[i] > allowed) {
                return Err(undetermined(NAMES[i], sd[i], allowed));
            }
        }
        let square: f64 = blocks
            .iter()
            .flat_map(|s| s.blocks.iter().zip(s.weights(p, self.settings.reference_c, p[DECAY])))
            .map(|(block, w)| block.squared_error(&w))
            .sum();
        let law = ThermalLaw {
            cold: PolynomialStribeck {
                polynomial: [p[0], p[1], p[2], p[3]],
                stribeck_nm: p[STRIBECK],
                stribeck_decay_s_per_rad: p[DECAY],
            }
            .into(),
            polynomial: TemperatureFactor { slope_per_k: p[ALPHA], level: p[BETA] },
            stribeck: TemperatureFactor { slope_per_k: p[GAMMA], level: p[DELTA] },
            reference_c: self.settings.reference_c,
            threshold_rad_s: self.settings.threshold_rad_s,
        };
        let heat = HeatBalance { conductance_w_per_k: p[LN_K].exp(), capacity_j_per_k: p[LN_C].exp() };
        let normal = |i: usize| Estimated::normal(p[i], sd[i]);
        Ok(ThermalFit {
            joint: ThermalJoint::new(law, heat)?,
            polynomial: std::array::from_fn(normal),
            alpha_per_k: normal(ALPHA),
            beta: normal(BETA),
            stribeck: self.cold.stribeck.then(|| [STRIBECK, GAMMA, DELTA, DECAY].map(normal)),
            conductance_w_per_k: Estimated::log_normal(p[LN_K], sd[LN_K]),
            capacity_j_per_k: Estimated::log_normal(p[LN_C], sd[LN_C]),
            rms_nm: (square / self.rows as f64).max(0.0).sqrt(),
            samples: self.rows,
        })
    }
}

/// Mean power (W) over all sessions at T0.
fn mean_power(sessions: &[SessionBlocks], cold: &PolynomialStribeck) -> f64 {
    let c: [f64; 5] = std::array::from_fn(|i| if i < 4 { cold.polynomial[i] } else { cold.stribeck_nm });
    let (mut energy, mut time) = (0.0, 0.0);
    for block in sessions.iter().flat_map(|s| &s.blocks) {
        energy += block.duration_s * (0..5).map(|i| c[i] * block.work[i]).sum::<f64>();
        time += block.duration_s;
    }
    (energy / f64::max(time, 1e-9)).max(1e-6)
}
