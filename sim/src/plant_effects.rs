//! Hidden effects in the forward plant.

use nalgebra::SVector;
use tribo_friction::law::{Bristle, Lugre};
use tribo_friction::{JointFriction, MAX_BRISTLES, SetValued};
use tribo_robot::{Wrench, gravity_torque};

use crate::delay_line::DelayLine;
use crate::flexible_joints::FlexibleJoints;
use crate::gap::Gap;
use crate::hidden::{Hidden, coulomb_nm, presliding_rad};

/// Rise and fall of an external contact (s), inside its window.
const CONTACT_EDGE_S: f64 = 0.02;

/// What a plant needs beyond arm and friction law; only plants with effects have one.
#[derive(Clone, Debug)]
pub(crate) struct PlantEffects<const N: usize> {
    pub hidden: Hidden<N>,
    pub flexible: Option<FlexibleJoints<N>>,
    /// Torque through the gears' output during the last period (Nm), contact included.
    pub load: SVector<f64, N>,
    /// Bristles of parts of dry friction.
    parts: [[Bristle; MAX_BRISTLES]; N],
    gaps: [Gap; N],
    delay: DelayLine<N>,
    late_torque: SVector<f64, N>,
}

/// A bristle of so much presliding (rad) after a step of h (s) that took the motor from the first to the second velocity
/// [rad/s]. Its travel does not depend on its strength.
#[inline]
pub(crate) fn travelled(bristle: Bristle, presliding_distance_rad: f64, [qd, qd_new]: [f64; 2], h: f64) -> Bristle {
    let law = Lugre { coulomb_nm: 0.0, viscous_nm_s_per_rad: 0.0, presliding_distance_rad };
    law.advanced(bristle, qd, qd_new, h)
}

impl<const N: usize> PlantEffects<N> {
    /// At rest at q (rad), with a control period of `dt_s` (s).
    pub fn new(hidden: Hidden<N>, q: &SVector<f64, N>, dt_s: f64) -> Self {
        let load = gravity_torque(&hidden.arm, q);
        Self {
            flexible: FlexibleJoints::under(hidden.elasticity, &load),
            gaps: std::array::from_fn(|j| Gap::under(hidden.half_gap_rad[j], load[j])),
            delay: DelayLine::new(hidden.delay_s, dt_s),
            late_torque: SVector::zeros(),
            parts: [[Bristle::default(); MAX_BRISTLES]; N],
            hidden,
            load,
        }
    }

    /// The same effects at another control period (s).
    pub fn set_period(&mut self, dt_s: f64) {
        self.delay = DelayLine::new(self.hidden.delay_s, dt_s);
    }

    /// Wrench of the contacts by the robot on the environment.
    #[inline]
    pub fn contact_at(&self, time_s: f64) -> Wrench {
        self.hidden.contact_at(time_s, CONTACT_EDGE_S)
    }

    /// Presliding distance of the joint (rad); 0 is none.
    #[inline]
    pub fn presliding_rad(&self, j: usize, law: &JointFriction) -> f64 {
        presliding_rad(law, &self.hidden.joints[j])
    }

    /// Law and effects of joint j as one set-valued map around the motor's q (rad) and qd [rad/s]:
    ///
    /// ```text
    /// scale (law + dFc s + dFv v + Fc (z − s)) + (dF exp(−(qd/vs)²) + γ |load|) s + a |s| + position torque
    ///     + Σ A tanh(v/w) + Σ b (z_b − s)
    /// ```
    ///
    /// s is the set-valued sign, z the bristle of joints with presliding. `scale` is the arm's warm-up, times the joint's
    /// own after `worked_s` (s).
    ///
    /// A curve is its chord from standstill to qd. The bristle z_b of a part of dry friction is implicit as that of
    /// [`Lugre`], but not damped, and the box is smaller by b; never below zero: friction of more parts than there is dry
    /// friction is above that of prescribed motion. Of falling curves and parts, the slope that would leave the whole below
    /// zero is taken at qd.
    #[inline]
    pub fn set_valued(
        &self,
        j: usize,
        law: &JointFriction,
        bristle: Bristle,
        [q, qd]: [f64; 2],
        inertia: f64,
        h: f64,
        [scale, worked_s]: [f64; 2],
    ) -> SetValued {
        let effects = &self.hidden.joints[j];
        let scale = scale * self.hidden.thermal[j].map_or(1.0, |thermal| thermal.scale(worked_s));
        let distance = self.presliding_rad(j, law);
        // What the bristle does not take over: for LuGre its viscous part, for a box the rest of the box.
        let mut map = law.set_valued(qd);
        let coulomb = coulomb_nm(law);
        let mut asymmetry = effects.asymmetry_nm;
        if distance > 0.0 {
            let total = (coulomb + effects.coulomb_nm).max(0.0);
            let law = Lugre { coulomb_nm: total, viscous_nm_s_per_rad: 0.0, presliding_distance_rad: distance };
            let dry = law.set_valued(bristle, qd, inertia, h);
            // Half the difference of the two directions stays with the direction of the bristle.
            asymmetry += 0.5 * (map.upper_nm + map.lower_nm);
            let rest = 0.5 * (map.upper_nm - map.lower_nm) - coulomb;
            (map.lower_nm, map.upper_nm) = (-rest, rest);
            map.viscous_nm_s_per_rad += dry.viscous_nm_s_per_rad;
            map.offset_nm += dry.offset_nm;
            map.offset_nm += asymmetry * (bristle.deflection_rad / distance).abs();
            asymmetry = 0.0;
        } else {
            map.lower_nm -= effects.coulomb_nm;
            map.upper_nm += effects.coulomb_nm;
        }
        let mut added = effects.dry_limit_nm(qd, self.load[j]) - effects.coulomb_nm;
        // Bristles of parts and curves: their torque (Nm) if qd stays, and its slope in the new velocity.
        let (mut bent, mut slope) = (0.0, 0.0);
        for (part, bristle) in effects.bristles.iter().zip(&self.parts[j]) {
            if part.amplitude_nm != 0.0 {
                let stiffness = part.amplitude_nm / part.distance_rad / (1.0 + h * qd.abs() / part.distance_rad);
                bent += stiffness * (bristle.deflection_rad + h * qd);
                slope += stiffness * h;
                added -= part.amplitude_nm;
            }
        }
        for curve in &effects.curves {
            bent += curve.torque_nm(qd);
            slope += curve.chord_nm_s_per_rad(qd);
        }
        let viscous = scale * (map.viscous_nm_s_per_rad + effects.viscous_nm_s_per_rad);
        let slope = slope.max(-viscous.max(0.0));
        SetValued {
            viscous_nm_s_per_rad: viscous + slope,
            offset_nm: scale * map.offset_nm + effects.position_torque_nm(q) + bent - slope * qd,
            lower_nm: (scale * map.lower_nm - added + asymmetry).min(0.0),
            upper_nm: (scale * map.upper_nm + added + asymmetry).max(0.0),
        }
    }

    /// Moves the bristles of parts of joint j's dry friction by a sub-step of h (s) that took its motor from `qd` to
    /// `qd_new` [rad/s].
    #[inline]
    pub fn advance_parts(&mut self, j: usize, qd: f64, qd_new: f64, h: f64) {
        for (part, bristle) in self.hidden.joints[j].bristles.iter().zip(&mut self.parts[j]) {
            if part.amplitude_nm != 0.0 {
                *bristle = travelled(*bristle, part.distance_rad, [qd, qd_new], h);
            }
        }
    }

    /// Motor less link angle (rad), through springs and gaps.
    #[inline]
    pub fn motor_lead_rad(&self) -> SVector<f64, N> {
        let gap = SVector::from_fn(|j, _| self.gaps[j].lead_rad);
        self.flexible.as_ref().map_or(gap, |flexible| gap + flexible.deflection_rad())
    }

    /// The torque that the sensor shows (Nm).
    #[inline]
    pub fn sensed_torque(&self) -> SVector<f64, N> {
        self.late_torque.component_mul(&self.hidden.gain)
    }

    /// Ends a period of `dt_s` (s): the torque at the sensor and the torque through the gears (Nm).
    #[inline]
    pub fn end_period(&mut self, at_sensor: &SVector<f64, N>, load: &SVector<f64, N>, dt_s: f64) {
        self.load = *load;
        for (j, gap) in self.gaps.iter_mut().enumerate() {
            *gap = gap.advanced(load[j], dt_s);
        }
        self.late_torque = self.delay.push(*at_sensor);
    }
}
