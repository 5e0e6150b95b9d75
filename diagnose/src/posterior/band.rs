//! The band that torque of unseen motion lies in, as wide as held-out parts ask for.
//!
//! ```text
//! Var r_j(t) = w_j² (σ_j² (1 + d m(t))/(1 + d) + c V_j(t)),   V_j what the parameters leave open, m the motion
//! ```
//!
//! What is left of a real robot is error of its model, which grows away from what was fitted and with the motion (see
//! [`super::motion`]): c and d, common to all joints, are the likeliest for parts that were held out, the fastest among them ([`super::faster`]);
//! w_j then holds 95 % of a joint's samples in thirds or logs that were held out, and in the fastest part.

/// |z| that 95 % of a Gaussian lie within.
const Z95: f64 = 1.96;
/// Decimal logarithm of the largest c, and steps per decade.
const DECADES: [usize; 2] = [4, 4];
/// Values that d may have.
const MOTION_SCALES: [f64; 7] = [0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0];
/// Largest square of a standardised residual that counts: the tails are no Gaussian's.
const MOST_SQUARE: f64 = 9.0;

/// A residual (Nm) with what it was foretold to vary by (Nm²).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deviation {
    pub residual_nm: f64,
    /// By noise.
    pub own: f64,
    /// By what the parameters leave open.
    pub unknown: f64,
    /// m, 1 in the mean of what was fitted [-].
    pub motion: f64,
}

/// The band.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Band {
    /// c.
    pub unknown_scale: f64,
    /// d.
    pub motion_scale: f64,
    /// w of each joint.
    pub widths: Vec<f64>,
}

impl Band {
    /// The band of residuals of parts that were held out in turn, and of the fastest part; one list per joint.
    pub fn of(in_turn: &[Vec<Deviation>], fastest: &[Vec<Deviation>]) -> Self {
        let unseen: Vec<Vec<Deviation>> =
            in_turn.iter().zip(fastest).map(|(all, fast)| all.iter().chain(fast).copied().collect()).collect();
        let unknown = (0..=DECADES[0] * DECADES[1]).map(|k| 10f64.powf(k as f64 / DECADES[1] as f64));
        let pairs = unknown.flat_map(|c| MOTION_SCALES.into_iter().map(move |d| [c, d]));
        let likeliest = pairs
            .map(|pair| (pair, cost(&unseen, pair)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or([1.0, 0.0], |(pair, _)| pair);
        let width = |held_out: &[Deviation]| {
            let squares = held_out.iter().map(|at| square(at, likeliest)).collect();
            quantile(squares, 0.95).sqrt() / Z95
        };
        let wider = |(all, fast): (&Vec<Deviation>, &Vec<Deviation>)| match fast.is_empty() {
            true => width(all).max(1e-3),
            false => width(all).max(width(fast)).max(1e-3),
        };
        let [unknown_scale, motion_scale] = likeliest;
        Self { unknown_scale, motion_scale, widths: in_turn.iter().zip(fastest).map(wider).collect() }
    }

    /// Standard deviation of a joint's torque (Nm), from variances by noise and by what is unknown (Nm²), where the arm moves as in
    /// what was fitted.
    pub fn sd_nm(&self, joint: usize, own: f64, unknown: f64) -> f64 {
        let at = Deviation { residual_nm: 0.0, own, unknown, motion: 1.0 };
        self.widths[joint] * variance(&at, [self.unknown_scale, self.motion_scale]).sqrt()
    }

    /// Whether a residual of a joint lies in the 95 % band.
    pub fn holds(&self, joint: usize, at: &Deviation) -> bool {
        let scales = [self.unknown_scale, self.motion_scale];
        at.residual_nm.abs() <= Z95 * self.widths[joint] * variance(at, scales).sqrt()
    }
}

/// σ² (1 + d m)/(1 + d) + c V (Nm²).
fn variance(at: &Deviation, [c, d]: [f64; 2]) -> f64 {
    at.own * (1.0 + d * at.motion) / (1.0 + d) + c * at.unknown
}

fn square(at: &Deviation, scales: [f64; 2]) -> f64 {
    at.residual_nm.powi(2) / variance(at, scales).max(f64::MIN_POSITIVE)
}

/// Minus the logarithm of the likelihood of all joints at their common width.
fn cost(unseen: &[Vec<Deviation>], scales: [f64; 2]) -> f64 {
    let all = || unseen.iter().flatten().filter(|at| at.own > 0.0);
    let width = (quantile(all().map(|at| square(at, scales)).collect(), 0.95) / Z95.powi(2)).max(1e-6);
    all()
        .map(|at| {
            let grown = variance(at, scales) / at.own;
            0.5 * ((square(at, scales) / width).min(MOST_SQUARE) + (width * grown).ln())
        })
        .sum()
}

/// A quantile; of nothing, that of a Gaussian's squares.
fn quantile(mut values: Vec<f64>, part: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = ((values.len() as f64 - 1.0) * part).round().max(0.0) as usize;
    values.get(at).copied().unwrap_or(Z95 * Z95)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise_level::gaussian;

    /// Residuals of variance 4 (1 + 10 V) are held by the band in 95 % of samples, with small V and with large.
    #[test]
    fn the_band_finds_how_errors_grow() {
        let mut gauss = gaussian(3);
        let mut draw = |unknown: f64| {
            let residual_nm = 2.0 * (1.0 + 10.0 * unknown).sqrt() * gauss();
            Deviation { residual_nm, own: 1.0, unknown, motion: 1.0 }
        };
        let seen: Vec<Vec<Deviation>> =
            (0..3).map(|_| (0..3000).map(|k| draw(f64::from(k % 10) * 0.05)).collect()).collect();
        let band = Band::of(&seen, &vec![Vec::new(); 3]);
        assert!((5.0..20.0).contains(&band.unknown_scale), "{band:?}");
        let far: Vec<Deviation> = (0..3000).map(|_| draw(3.0)).collect();
        let inside = far.iter().filter(|at| band.holds(1, at)).count() as f64 / 3000.0;
        assert!((0.91..0.99).contains(&inside), "{inside}");
        // One that takes the fit at its word holds less.
        let narrow = Band { unknown_scale: 1.0, ..band };
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
        };
        let in_turn: Vec<Vec<Deviation>> = (0..3).map(|_| (0..2000).map(|_| draw(1.0, 1.0)).collect()).collect();
        let fastest: Vec<Vec<Deviation>> =
            [1.0, 1.0, 4.0].map(|growth| (0..1000).map(|_| draw(4.0, growth)).collect()).to_vec();
        let band = Band::of(&in_turn, &fastest);
        let without = Band::of(&in_turn, &vec![Vec::new(); 3]);
        let mut inside = |band: &Band, joint: usize, growth: f64| {
            (0..3000).filter(|_| band.holds(joint, &draw(6.0, growth))).count() as f64 / 3000.0
        };
        let held = [(0, 1.0), (2, 4.0)].map(|(joint, growth)| inside(&band, joint, growth));
        assert!(held.iter().all(|share| (0.92..0.985).contains(share)), "{held:?} {band:?}");
        let held = [(0, 1.0), (2, 4.0)].map(|(joint, growth)| inside(&without, joint, growth));
        assert!(held.iter().all(|share| *share < 0.7), "{held:?} {without:?}");
    }
}
