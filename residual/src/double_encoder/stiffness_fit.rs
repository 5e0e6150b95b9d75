//! Stiffness curve of one joint from loads that are known.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::{CalibrationError, StiffnessCurve};

/// One known load on one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadSample {
    /// Deflection without it (rad), at the same pose; 0 in the paper's form, which knows no preload.
    pub from_rad: f64,
    /// Deflection with it (rad), less what the paper's form takes off.
    pub to_rad: f64,
    /// Torque of the load about the joint (Nm), eq. (17).
    pub torque_nm: f64,
    /// Change of the direction of the joint's motion, [−2, 2]: under a load the link gives way, and its stiction turns
    /// against it; see `stop_operator.rs`.
    pub direction_change: f64,
    /// Change of the direction of loading, [−2, 2].
    pub loading_change: f64,
}

/// Fewest samples per joint: five unknowns and the knot, five samples each.
pub const FEWEST_LOADS: usize = 30;
/// Knots tried before the best is refined.
const KNOTS: usize = 40;
/// Least slope over the greatest. A gear is softer near zero, not ten times as soft: there the knot has found stiction.
const LEAST_SLOPE: f64 = 0.25;
/// Fewest samples beyond the knot on a side with a slope of its own.
const FEWEST_BEYOND: usize = 5;
/// Weight of the tie of an outer slope to the inner one that keeps the normal matrix regular, relative to the data.
const WEAK_TIE: f64 = 1e-9;

/// Least squares on
///
/// ```text
/// τ_W = T(to) − T(from) − b Δd − c Δs,      T with knot δ₀,      min over δ₀ of the RMS
/// ```
///
/// The paper fits deflections and searches τ_W0 by a particle swarm; the torques are as good (deflections are measured to
/// 1e-3 of their range) and their slopes linear, so that what is left is a search in one dimension: a grid, then golden
/// section. b is the stiction of the link and c the half-width of the gear's hysteresis, each 0 unless
/// `wanted = [direction, loading]` asks for it. A side that no load has reached takes the slope of the others.
///
/// # Errors
/// [`CalibrationError::TooFewLoads`], [`CalibrationError::NoLoadRange`], [`CalibrationError::SoftJoint`].
pub fn fit_stiffness(
    joint: usize,
    samples: &[LoadSample],
    wanted: [bool; 2],
) -> Result<StiffnessCurve, CalibrationError> {
    if samples.len() < FEWEST_LOADS {
        return Err(CalibrationError::TooFewLoads { joint, need: FEWEST_LOADS, got: samples.len() });
    }
    let torque_range = samples.iter().map(|s| s.torque_nm.abs()).fold(0.0, f64::max);
    let mut extents: Vec<f64> = samples.iter().flat_map(|s| [s.from_rad.abs(), s.to_rad.abs()]).collect();
    extents.sort_by(f64::total_cmp);
    let widest = extents[extents.len() - 1];
    // The knot may lie where a twentieth of the samples is within it and a tenth beyond.
    let (least, most) = (extents[extents.len() / 20].max(0.02 * widest), extents[extents.len() * 9 / 10]);
    if !(torque_range > 0.0 && least < most) {
        return Err(CalibrationError::NoLoadRange { joint });
    }
    let rms = |knot: f64| match solve(samples, knot, wanted) {
        Some(fit) if fit.slopes_nm_per_rad.min() > LEAST_SLOPE * fit.slopes_nm_per_rad.max() => fit.rms_nm,
        _ => f64::INFINITY,
    };
    let grid = |k: usize| least * (most / least).powf(k as f64 / (KNOTS - 1) as f64);
    let best = (0..KNOTS).map(|k| (k, rms(grid(k)))).fold((0, f64::INFINITY), |a, b| if b.1 < a.1 { b } else { a }).0;
    // Where no knot is believable everything lies within the near-zero interval: one slope.
    let knot = if rms(grid(best)).is_finite() {
        golden_section(&rms, grid(best.saturating_sub(1)), grid((best + 1).min(KNOTS - 1)))
    } else {
        2.0 * widest
    };
    let curve = solve(samples, knot, wanted).ok_or(CalibrationError::NoLoadRange { joint })?;
    match curve.slopes_nm_per_rad.iter().find(|slope| !(**slope > 0.0 && slope.is_finite())) {
        Some(&slope) => Err(CalibrationError::SoftJoint { joint, stiffness_nm_per_rad: slope }),
        None => Ok(curve),
    }
}

/// Three slopes, b and c.
const UNKNOWNS: usize = 5;
type Unknowns = SVector<f64, UNKNOWNS>;

/// Least squares for one knot (rad).
fn solve(samples: &[LoadSample], knot_rad: f64, wanted: [bool; 2]) -> Option<StiffnessCurve> {
    let columns = |s: &LoadSample| {
        let slopes = StiffnessCurve::columns(knot_rad, s.to_rad) - StiffnessCurve::columns(knot_rad, s.from_rad);
        let [b, c] =
            [(wanted[0], s.direction_change), (wanted[1], s.loading_change)].map(|(on, x)| if on { -x } else { 0.0 });
        Unknowns::from([slopes[0], slopes[1], slopes[2], b, c])
    };
    let (mut normal, mut moment) = (SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros(), Unknowns::zeros());
    let mut beyond = [0_usize; 2];
    for s in samples {
        let row = columns(s);
        normal += row * row.transpose();
        moment += row * s.torque_nm;
        beyond[0] += usize::from(row[0] != 0.0);
        beyond[1] += usize::from(row[2] != 0.0);
    }
    // Ties of the outer slopes to the inner one, weak where they are measured and binding where they are not.
    let stiff = normal.fixed_view::<3, 3>(0, 0).trace();
    let mut free = 3.0;
    for (side, column) in [(0, 0), (1, 2)] {
        let weight = if beyond[side] < FEWEST_BEYOND {
            free -= 1.0;
            stiff
        } else {
            WEAK_TIE * stiff
        };
        normal[(column, column)] += weight;
        normal[(1, 1)] += weight;
        normal[(column, 1)] -= weight;
        normal[(1, column)] -= weight;
    }
    for i in 3..UNKNOWNS {
        if normal[(i, i)] > 0.0 {
            free += 1.0;
        } else {
            normal[(i, i)] = 1.0;
        }
    }
    // The columns differ by the scale of a deflection: equilibrate before the factorisation.
    let scale = normal.diagonal().map(|d| 1.0 / d.sqrt());
    let scaled = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_fn(|i, j| normal[(i, j)] * scale[i] * scale[j]);
    let inverse = scaled.cholesky()?.inverse();
    let inverse = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_fn(|i, j| inverse[(i, j)] * scale[i] * scale[j]);
    let x = inverse * moment;
    let squares: f64 = samples.iter().map(|s| (s.torque_nm - columns(s).dot(&x)).powi(2)).sum();
    let variance = squares / (samples.len() as f64 - free);
    let covariance: Matrix3<f64> = inverse.fixed_view::<3, 3>(0, 0).into_owned() * variance;
    Some(StiffnessCurve {
        slopes_nm_per_rad: Vector3::new(x[0], x[1], x[2]),
        knot_rad,
        slope_covariance: covariance,
        stiction_nm: x[3],
        hysteresis_nm: x[4],
        rms_nm: variance.sqrt(),
    })
}

/// Minimum of a function of one variable between two points, to 1e-4 of their distance.
fn golden_section(f: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut left, mut right) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut at_left, mut at_right) = (f(left), f(right));
    // 0.618²⁰ < 1e-4.
    for _ in 0..20 {
        if at_left <= at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - ratio * (high - low);
            at_left = f(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + ratio * (high - low);
            at_right = f(right);
        }
    }
    if at_left <= at_right { left } else { right }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth() -> StiffnessCurve {
        let slopes_nm_per_rad = Vector3::new(1.2e4, 7e3, 1.5e4);
        StiffnessCurve {
            slopes_nm_per_rad,
            knot_rad: 4e-4,
            stiction_nm: 0.2,
            hysteresis_nm: 0.3,
            ..StiffnessCurve::linear(1e4, 0.1)
        }
    }

    /// Loads of ±20 Nm on preloads of ±15 Nm, loading and unloading, from the inverse curve.
    fn samples() -> Vec<LoadSample> {
        (0..200)
            .map(|k| {
                let preload = 15.0 * (0.7 * f64::from(k)).sin();
                let torque_nm = 20.0 * (1.3 * f64::from(k) + 0.4).sin();
                let loading_change = f64::from(k % 3 - 1);
                let direction_change = 0.4 * f64::from(k % 5 - 2);
                let from_rad = truth().deflection_rad(preload);
                let to_rad =
                    truth().deflection_rad(preload + torque_nm + 0.2 * direction_change + 0.3 * loading_change);
                LoadSample { from_rad, to_rad, torque_nm, direction_change, loading_change }
            })
            .collect()
    }

    #[test]
    fn the_curve_that_made_the_data_is_found() {
        let fit = fit_stiffness(0, &samples(), [true; 2]).unwrap();
        let error = (fit.slopes_nm_per_rad - truth().slopes_nm_per_rad).component_div(&truth().slopes_nm_per_rad);
        assert!(error.amax() < 1e-3, "{fit:?}");
        assert!((fit.knot_rad / 4e-4 - 1.0).abs() < 1e-3 && (fit.hysteresis_nm - 0.3).abs() < 1e-3, "{fit:?}");
        assert!((fit.stiction_nm - 0.2).abs() < 1e-3, "{fit:?}");
        let blind = fit_stiffness(0, &samples(), [false; 2]).unwrap();
        assert!(blind.rms_nm > 0.1 && fit.rms_nm < 2e-3, "{} {}", blind.rms_nm, fit.rms_nm);
    }

    #[test]
    fn an_unloaded_side_takes_the_slope_of_the_others() {
        let up: Vec<LoadSample> = (1..60)
            .map(|k| LoadSample {
                from_rad: 0.0,
                to_rad: 2e-5 * f64::from(k),
                torque_nm: 0.2 * f64::from(k),
                direction_change: 0.0,
                loading_change: 0.0,
            })
            .collect();
        let fit = fit_stiffness(0, &up, [false; 2]).unwrap();
        assert!((fit.slopes_nm_per_rad.add_scalar(-1e4)).amax() < 1.0, "{fit:?}");
    }

    #[test]
    fn too_little_is_said_to_be_too_little() {
        let few = fit_stiffness(3, &samples()[..29], [true; 2]);
        assert!(matches!(few, Err(CalibrationError::TooFewLoads { joint: 3, need: 30, got: 29 })));
        let unloaded =
            vec![
                LoadSample { from_rad: 0.0, to_rad: 0.0, torque_nm: 0.0, direction_change: 0.0, loading_change: 0.0 };
                30
            ];
        assert!(matches!(fit_stiffness(1, &unloaded, [true; 2]), Err(CalibrationError::NoLoadRange { joint: 1 })));
        let wrong: Vec<_> = samples().iter().map(|s| LoadSample { torque_nm: -s.torque_nm, ..*s }).collect();
        assert!(matches!(fit_stiffness(1, &wrong, [true; 2]), Err(CalibrationError::SoftJoint { joint: 1, .. })));
    }
}
