//! What a diagnosis says.

use tribo_regression::{CauseLabel, Location};
use tribo_robot::JointNames;
use tribo_sim::Effect;

use crate::next_experiment::NextExperiment;

/// The answer in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// None of the candidates explains what the model leaves of the log.
    NothingMissing,
    /// Every finding has one name.
    Named,
    /// At least one finding has a rival that this log cannot exclude.
    Ambiguous,
    /// Something is there that no named cause describes.
    Unknown,
}

impl Verdict {
    /// Name in files: `nothing_missing`.
    pub fn name(self) -> &'static str {
        match self {
            Self::NothingMissing => "nothing_missing",
            Self::Named => "named",
            Self::Ambiguous => "ambiguous",
            Self::Unknown => "unknown",
        }
    }
}

/// A parameter of a finding with its 95 % interval, component by component (one for a scalar, three for a vector).
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name with unit suffix, as in [`Effect`]: `delta_coulomb_nm`.
    pub name: &'static str,
    /// Estimate.
    pub value: Vec<f64>,
    /// Lower and upper end of the 95 % interval of each component.
    pub ci95: Vec<[f64; 2]>,
}

/// A rival explanation of a finding.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternative {
    /// What else it could be.
    pub label: CauseLabel,
    /// Where.
    pub location: Location,
    /// Penalised log evidence behind the finding [nat·2]; small is close.
    pub evidence_gap: f64,
    /// Why physics confuses the two, and what would separate them.
    pub why: String,
}

/// A curve or cloud of the evidence plots.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Legend.
    pub name: String,
    /// Abscissa.
    pub x: Vec<f64>,
    /// Ordinate.
    pub y: Vec<f64>,
    /// Whether the points are joined.
    pub joined: bool,
}

/// One plot: "why this verdict".
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// What it shows.
    pub title: String,
    /// Abscissa with unit.
    pub x_label: String,
    /// Ordinate with unit.
    pub y_label: String,
    /// Curves.
    pub series: Vec<Series>,
}

/// One cause that the log shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What.
    pub label: CauseLabel,
    /// Where; the arm, where it covers several joints or links.
    pub location: Location,
    /// Joints that it covers; a parameter has one value per joint where there are several.
    pub joints: Vec<usize>,
    /// Links that it covers, likewise.
    pub links: Vec<usize>,
    /// The effect, ready for a model; `None` for `unknown` and for a finding of several joints.
    pub effect: Option<Effect>,
    /// Parameters with intervals; for `unknown` none.
    pub parameters: Vec<Parameter>,
    /// For `unknown`: what the torque goes with (velocity, position order, time, load).
    pub signature: Option<String>,
    /// Family-wise probability of so much evidence by chance.
    pub p_value: f64,
    /// Part of the held-out residual RMS of the affected joints that this finding removes, given the others [-].
    pub held_out_gain: f64,
    /// Its 95 % interval.
    pub held_out_gain_ci95: [f64; 2],
    /// RMS of the torque it explains on its joint (on the worst joint, for the arm) (Nm), in the band.
    pub explained_rms_nm: f64,
    /// Evidence: twice the log likelihood gained, less the price of its parameters.
    pub evidence: f64,
    /// Rivals that this log cannot exclude, closest first.
    pub alternatives: Vec<Alternative>,
    /// The evidence as plots.
    pub plots: Vec<Plot>,
}

impl Finding {
    /// Parameters as people read them. Of a push that is the wrench by the robot on the environment, as estimators give it; `parameters` and
    /// model files hold the push itself, which is the opposite.
    pub fn said(&self) -> Vec<Parameter> {
        let opposite = |name, of: &Parameter| Parameter {
            name,
            value: of.value.iter().map(|x| -x).collect(),
            ci95: of.ci95.iter().map(|[low, high]| [-high, -low]).collect(),
        };
        let said = |parameter: &Parameter| match (self.label, parameter.name) {
            (CauseLabel::ExternalContact, "force_n") => opposite("force_by_robot_n", parameter),
            (CauseLabel::ExternalContact, "moment_nm") => opposite("moment_by_robot_nm", parameter),
            _ => parameter.clone(),
        };
        self.parameters.iter().map(said).collect()
    }

    /// The joints or links that it covers, one by one.
    pub fn places(&self) -> Vec<Location> {
        match self.links.is_empty() {
            true => self.joints.iter().copied().map(Location::Joint).collect(),
            false => self.links.iter().copied().map(Location::Link).collect(),
        }
    }
}

/// A candidate that was considered and not reported.
#[derive(Clone, Debug, PartialEq)]
pub struct Rejected {
    /// What.
    pub label: CauseLabel,
    /// Where.
    pub location: Location,
    /// Its evidence given the findings (negative: it does not pay for its parameters); `None` if it was not testable.
    pub evidence: Option<f64>,
    /// Why it is out.
    pub reason: String,
}

/// What is wrong with the model at one joint, before any cause is named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointMisfit {
    /// RMS of the residual (Nm).
    pub rms_nm: f64,
    /// Mean of the residual (Nm).
    pub bias_nm: f64,
    /// Part of the variance of the measured torque that the model leaves over [-].
    pub unexplained: f64,
    /// RMS of the white torque noise in the band, from the log itself (Nm).
    pub noise_floor_nm: f64,
    /// Part of the residual's variance that goes with velocity, position, load, time and reversals, each alone [-].
    pub goes_with: [(&'static str, f64); 5],
    /// RMS of the residual after the findings (Nm).
    pub rms_after_nm: f64,
    /// RMS on held-out blocks before and after (Nm).
    pub held_out_nm: [f64; 2],
}

/// Part of the residual's energy across all joints that lies in the range of a rigid-body map [-].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrossJointPattern {
    /// Of Jᵀ with one constant wrench: a push or a weight at the tool.
    pub wrench: f64,
    /// Of the derivative by gravity: a tilted base.
    pub gravity: f64,
    /// Of the inertial regressor: masses.
    pub inertial: f64,
}

/// What models predict where they were not fitted, joint by joint: RMS (Nm) on the parts held out in turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Unseen {
    /// What was held out: `each log in turn`, `each third of the log in turn`.
    pub split: &'static str,
    /// The nominal model.
    pub nominal_nm: Vec<f64>,
    /// The extended model, fitted to the rest.
    pub extended_nm: Vec<f64>,
    /// Coulomb + viscous + offset per joint by least squares, fitted to the rest.
    pub plain_nm: Vec<f64>,
    /// Every base parameter besides, truncated least squares, fitted to the rest.
    pub full_nm: Vec<f64>,
}

/// Mean ratio of the RMS from which a better baseline is more than chance.
const PREFERABLE: f64 = 1.1;

impl Unseen {
    /// The baseline that predicts better in the mean of the joints' ratios, and its name.
    pub fn better_baseline(&self) -> (&'static str, &[f64]) {
        let mean = |of: &[f64], over: &[f64]| of.iter().zip(over).map(|(a, b)| a / b.max(1e-9)).sum::<f64>();
        if mean(&self.plain_nm, &self.full_nm) <= mean(&self.full_nm, &self.plain_nm) {
            ("plain least squares", &self.plain_nm)
        } else {
            ("the full base-parameter refit", &self.full_nm)
        }
    }

    /// Whether that baseline predicts better than the extended model, in the second decimal of [`Self::ratio`].
    pub fn baseline_is_better(&self) -> bool {
        self.ratio() >= 1.005
    }

    /// Whether it predicts so much better that the causes of the extended model are not those of the log. A little better is chance: other
    /// parts of the same log would decide otherwise.
    pub fn baseline_is_preferable(&self) -> bool {
        self.ratio() >= PREFERABLE
    }

    /// Mean over joints of the extended model's RMS over that of the better baseline.
    pub fn ratio(&self) -> f64 {
        self.ratio_to(self.better_baseline().1)
    }

    /// Mean over joints of the extended model's RMS over that of a baseline, joint by joint (Nm).
    pub fn ratio_to(&self, baseline_nm: &[f64]) -> f64 {
        let ratios = self.extended_nm.iter().zip(baseline_nm).map(|(ours, base)| ours / base.max(1e-9));
        ratios.sum::<f64>() / self.extended_nm.len().max(1) as f64
    }
}

/// The extended model on a log that no parameter was fitted to.
#[derive(Clone, Debug, PartialEq)]
pub struct Validation {
    /// Name of the log.
    pub log: String,
    /// RMS per joint with the nominal model (Nm).
    pub before_nm: Vec<f64>,
    /// RMS per joint with the extended model (Nm).
    pub after_nm: Vec<f64>,
    /// RMS per joint of Coulomb + viscous + offset, fitted to the diagnosed logs (Nm); empty where it was not asked for.
    pub plain_nm: Vec<f64>,
    /// RMS per joint of the full base-parameter refit, likewise (Nm).
    pub full_nm: Vec<f64>,
    /// Share of samples inside the predicted 95 % band, where the model foretells one.
    pub inside95: Option<f64>,
    /// Part of the residual RMS over all joints that the findings remove [-].
    pub gain: f64,
    /// Its 95 % interval, over blocks.
    pub gain_ci95: [f64; 2],
}

/// Everything a diagnosis found.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// The answer.
    pub verdict: Verdict,
    /// What was found, strongest first.
    pub findings: Vec<Finding>,
    /// Names of the joints of the arm that the log was held against.
    pub joint_names: JointNames,
    /// The misfit of each joint.
    pub joints: Vec<JointMisfit>,
    /// Whether the residual looks like a push, a tilt or a mass.
    pub pattern: CrossJointPattern,
    /// Part of the held-out residual RMS over all joints that the findings remove [-].
    pub gain_heldout: f64,
    /// Its 95 % interval, over blocks.
    pub gain_heldout_ci95: [f64; 2],
    /// The extended model on other logs.
    pub validation: Vec<Validation>,
    /// What was considered and rejected.
    pub rejected: Vec<Rejected>,
    /// The effects that extend the model, as they were fitted together.
    pub extension: Vec<Effect>,
    /// Width of the smooth sign that the log shows and the extended model has [rad/s], sharper than the model's; `None` where it keeps its own.
    pub smoothing_rad_s: Option<f64>,
    /// Whether the log shows joints that stick where they stop, and the extended model has that, which the model has not.
    pub sticks: bool,
    /// What the extended model and plain fits predict for data that they have not seen; `None` where the log is too short to hold
    /// a part of it out, which a note then says.
    pub unseen: Option<Unseen>,
    /// Standard deviation of the torque that the extended model foretells for unseen motion, per joint (Nm); empty where the
    /// diagnosis foretells none.
    pub predictive_sd_nm: Vec<f64>,
    /// What the result rests on.
    pub assumptions: Vec<String>,
    /// What the reader should know (short log, joints that never moved, …).
    pub notes: Vec<String>,
    /// The experiment that would separate the closest rivals.
    pub next_experiment: Option<NextExperiment>,
    /// Residual against velocity, position, load, time, and its spectra, per joint.
    pub overview: Vec<Plot>,
    /// Band of the residual (Hz).
    pub band_hz: f64,
    /// Rate of the samples after averaging (Hz).
    pub rate_hz: f64,
    /// Number of samples.
    pub samples: usize,
    /// Number of bursts.
    pub bursts: usize,
}

impl Diagnosis {
    /// What extends the model, ready for its file.
    pub fn effects(&self) -> Vec<Effect> {
        self.extension.clone()
    }
}
