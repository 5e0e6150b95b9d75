//! The band that torque of unseen motion lies in, as wide as held-out parts ask for.
//!
//! ```text
//! Var r_j(t) = w_j² (σ_j² ((1 + d m(t))/(1 + d) + e (1 − s_j(t)²)) + c V_j(t)),
//!              V_j what the parameters leave open, m the motion, s_j the smooth sign of the velocity in the band
//! ```
//!
//! What is left of a real robot is error of its model, which grows away from what was fitted, with the motion (see [`super::motion`]), and where a joint
//! turns round or rests, whose friction is hardest to say. c, d and e, common to all joints, are the likeliest for parts that were held out, the fastest
//! and the farthest postures among them ([`super::extremes`]). w_j holds 95 % of a joint's samples of parts that were held out in turn, and, the farther
//! a motion is from what was fitted ([`super::distance`]), also those of the fastest and of the farthest part; and it is then no narrower than the geometric mean
//! of itself and of the geometric mean over all joints: on another motion the widths of joints are nearer to each other than in one log.

/// |z| that 95 % of a Gaussian lie within.
const Z95: f64 = 1.96;
/// Decimal logarithms of the smallest and the largest c, and steps per decade.
const DECADES: [i32; 3] = [-1, 4, 2];
/// Values that d may have.
const MOTION_SCALES: [f64; 3] = [0.0, 0.3, 3.0];
/// Values that e may have.
const TURNING_SCALES: [f64; 7] = [0.0, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0];
/// Largest square of a standardised residual that counts: the tails are no Gaussian's.
const MOST_SQUARE: f64 = 9.0;
/// Most samples that c, d and e are chosen on.
const MOST_SAMPLES: usize = 6000;
/// Narrowest width: a residual that is nothing must not make a band that is nothing.
const NARROWEST: f64 = 1e-3;

/// A residual (Nm) with what it was foretold to vary by (Nm²).
#[derive(Clone, Copy, Debug)]
pub struct Deviation {
    /// Measured less predicted (Nm).
    pub residual_nm: f64,
    /// By noise.
    pub own: f64,
    /// By what the parameters leave open.
    pub unknown: f64,
    /// m, 1 in the mean of what was fitted [-].
    pub motion: f64,
    /// 1 − s², 1 where the joint rests or turns round [-].
    pub turning: f64,
}

/// What was held out in one way.
#[derive(Clone, Debug)]
pub struct HeldOut {
    /// One list per joint, empty where nothing could be held out.
    pub deviations: Vec<Vec<Deviation>>,
    /// How far it is from what was fitted, see [`super::distance`].
    pub distance: f64,
}

/// The bands of all motions.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands {
    scales: Scales,
    /// w of each joint for parts that are held out in turn, and their distance.
    near: (Vec<f64>, f64),
    /// The same of the fastest and the farthest part.
    far: [(Vec<f64>, f64); 2],
}

/// The band of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    scales: Scales,
    /// w of each joint.
    widths: Vec<f64>,
}

/// c, d and e.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scales {
    unknown: f64,
    motion: f64,
    turning: f64,
}

impl Bands {
    /// Of residuals of parts that were held out in turn, and of the fastest and the farthest part.
    pub fn of(in_turn: &HeldOut, extremes: &[HeldOut; 2]) -> Self {
        let scales = Scales::likeliest(&[in_turn, &extremes[0], &extremes[1]]);
        let width = |list: &Vec<Deviation>| {
            quantile(list.iter().map(|at| scales.square(at)).collect(), 0.95)
                .map_or(1.0, |square| square.sqrt() / Z95)
                .max(NARROWEST)
        };
        let near: Vec<f64> = in_turn.deviations.iter().map(width).collect();
        let wider = |(list, near): (&Vec<Deviation>, &f64)| if list.is_empty() { *near } else { near.max(width(list)) };
        let far = extremes.each_ref().map(|way| (way.deviations.iter().zip(&near).map(wider).collect(), way.distance));
        Self { scales, near: (near, in_turn.distance), far }
    }

    /// That of the motion in which parts were held out in turn.
    pub fn near(&self) -> Band {
        self.at(self.near.1)
    }

    /// That of a motion with this distance from what was fitted.
    pub fn at(&self, distance: f64) -> Band {
        let (near, in_turn) = &self.near;
        // 0 as near as parts in turn, or half as far as the extreme part; 1 as far as that.
        let share = |far: f64| {
            let from = in_turn.min(0.5 * far);
            if far > from { ((distance - from) / (far - from)).clamp(0.0, 1.0) } else { 0.0 }
        };
        let shares = self.far.each_ref().map(|(_, to)| share(*to));
        let wide = |j: usize| {
            let of_way = |((far, _), share): (&(Vec<f64>, f64), &f64)| near[j].powf(1.0 - share) * far[j].powf(*share);
            self.far.iter().zip(&shares).map(of_way).fold(near[j], f64::max)
        };
        let own: Vec<f64> = (0..near.len()).map(wide).collect();
        let common = (own.iter().map(|w| w.ln()).sum::<f64>() / own.len().max(1) as f64).exp();
        let pooled = 0.5 * shares[0].max(shares[1]);
        Band {
            scales: self.scales,
            widths: own.iter().map(|w| w.max(w.powf(1.0 - pooled) * common.powf(pooled))).collect(),
        }
    }
}

impl Band {
    /// Standard deviation of a joint's torque (Nm) where its variances, motion and turning are those of `at`.
    pub fn sd_nm(&self, joint: usize, at: &Deviation) -> f64 {
        self.widths[joint] * self.scales.variance(at).sqrt()
    }

    /// Whether a residual of a joint lies in the 95 % band.
    pub fn holds(&self, joint: usize, at: &Deviation) -> bool {
        at.residual_nm.abs() <= Z95 * self.sd_nm(joint, at)
    }
}

impl Scales {
    /// Of all that may be, those under which the samples are likeliest.
    fn likeliest(held_out: &[&HeldOut]) -> Self {
        let all: Vec<Deviation> = held_out.iter().flat_map(|way| way.deviations.iter().flatten()).copied().collect();
        let every = all.len().div_ceil(MOST_SAMPLES).max(1);
        let samples: Vec<Deviation> = all.into_iter().step_by(every).filter(|at| at.own > 0.0).collect();
        let [least, most, steps] = DECADES;
        let unknown = (least * steps..=most * steps).map(|k| 10f64.powf(f64::from(k) / f64::from(steps)));
        let scales = unknown.flat_map(|unknown| {
            MOTION_SCALES
                .into_iter()
                .flat_map(move |motion| TURNING_SCALES.map(|turning| Self { unknown, motion, turning }))
        });
        let none = Self { unknown: 1.0, motion: 0.0, turning: 0.0 };
        scales.map(|s| (s, s.cost(&samples))).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(none, |(s, _)| s)
    }

    /// σ² ((1 + d m)/(1 + d) + e (1 − s²)) + c V (Nm²).
    fn variance(self, at: &Deviation) -> f64 {
        let moving = (1.0 + self.motion * at.motion) / (1.0 + self.motion);
        at.own * (moving + self.turning * at.turning) + self.unknown * at.unknown
    }

    fn square(self, at: &Deviation) -> f64 {
        at.residual_nm.powi(2) / self.variance(at).max(f64::MIN_POSITIVE)
    }

    /// Minus the logarithm of the likelihood of samples at a common width.
    fn cost(self, samples: &[Deviation]) -> f64 {
        let Some(square) = quantile(samples.iter().map(|at| self.square(at)).collect(), 0.95) else { return 0.0 };
        let width = (square / Z95.powi(2)).max(1e-6);
        let of_sample = |at: &Deviation| {
            let grown = self.variance(at) / at.own;
            0.5 * ((self.square(at) / width).min(MOST_SQUARE) + (width * grown).ln())
        };
        samples.iter().map(of_sample).sum()
    }
}

/// A quantile; `None` of nothing.
fn quantile(mut values: Vec<f64>, part: f64) -> Option<f64> {
    let at = (values.len().checked_sub(1)? as f64 * part).round() as usize;
    Some(*values.select_nth_unstable_by(at, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaussian::gaussian;

    /// Parts held out in turn at distance 1, the fastest at distance 2, or none.
    fn bands(in_turn: &[Vec<Deviation>], fastest: &[Vec<Deviation>]) -> Bands {
        let none = HeldOut { deviations: vec![Vec::new(); in_turn.len()], distance: f64::INFINITY };
        let fastest = match fastest.is_empty() {
            true => none.clone(),
            false => HeldOut { deviations: fastest.to_vec(), distance: 2.0 },
        };
        Bands::of(&HeldOut { deviations: in_turn.to_vec(), distance: 1.0 }, &[fastest, none])
    }

    /// Residuals of variance 4 (1 + 10 V) are held by the band in 95 % of samples, with small V and with large.
    #[test]
    fn the_band_finds_how_errors_grow() {
        let mut gauss = gaussian(3);
        let mut draw = |unknown: f64| {
            let residual_nm = 2.0 * (1.0 + 10.0 * unknown).sqrt() * gauss();
            Deviation { residual_nm, own: 1.0, unknown, motion: 1.0, turning: 0.0 }
        };
        let seen: Vec<Vec<Deviation>> =
            (0..3).map(|_| (0..3000).map(|k| draw(f64::from(k % 10) * 0.05)).collect()).collect();
        let band = bands(&seen, &[]).near();
        assert!((5.0..20.0).contains(&band.scales.unknown), "{band:?}");
        let far: Vec<Deviation> = (0..3000).map(|_| draw(3.0)).collect();
        let inside = far.iter().filter(|at| band.holds(1, at)).count() as f64 / 3000.0;
        assert!((0.91..0.99).contains(&inside), "{inside}");
        // One that takes the fit at its word holds less.
        let narrow = Band { scales: Scales { unknown: 1.0, ..band.scales }, ..band };
        let inside = far.iter().filter(|at| narrow.holds(1, at)).count() as f64 / 3000.0;
        assert!(inside < 0.85, "{inside}");
    }

    /// A joint whose residuals grow faster with the motion than those of the others has the width that its fastest part asks for.
    #[test]
    fn the_fastest_part_widens_the_band_of_its_joint() {
        let mut gauss = gaussian(5);
        let mut draw = |motion: f64, growth: f64| Deviation {
            residual_nm: (growth * motion).sqrt() * gauss(),
            own: 1.0,
            unknown: 0.0,
            motion,
            turning: 0.0,
        };
        let in_turn: Vec<Vec<Deviation>> = (0..3).map(|_| (0..2000).map(|_| draw(1.0, 1.0)).collect()).collect();
        let fastest: Vec<Vec<Deviation>> =
            [1.0, 1.0, 4.0].map(|growth| (0..1000).map(|_| draw(4.0, growth)).collect()).to_vec();
        let band = bands(&in_turn, &fastest).at(2.0);
        let without = bands(&in_turn, &[]).near();
        // A motion that is no farther than parts in turn has their width, one that is half as far as the fastest part lies between.
        let near = bands(&in_turn, &fastest).near();
        assert_eq!(near.widths, bands(&in_turn, &fastest).at(0.3).widths);
        let middle = bands(&in_turn, &fastest).at(1.5);
        assert!(
            near.widths[2] < 0.9 * middle.widths[2] && middle.widths[2] < 0.9 * band.widths[2],
            "{near:?} {middle:?} {band:?}"
        );
        let mut inside = |band: &Band, joint: usize, growth: f64| {
            (0..3000).filter(|_| band.holds(joint, &draw(6.0, growth))).count() as f64 / 3000.0
        };
        let held = [(0, 1.0), (2, 4.0)].map(|(joint, growth)| inside(&band, joint, growth));
        assert!(held.iter().all(|share| (0.92..0.985).contains(share)), "{held:?} {band:?}");
        let held = [(0, 1.0), (2, 4.0)].map(|(joint, growth)| inside(&without, joint, growth));
        assert!(held.iter().all(|share| *share < 0.7), "{held:?} {without:?}");
    }
}
