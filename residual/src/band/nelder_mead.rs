//! Minimum of a function of few variables without derivatives.

/// Downhill simplex of Nelder and Mead (nelder1965), standard coefficients: reflect 1, expand 2, contract ½, shrink ½.
///
/// Starts from `start` and `start + step_i e_i`; ends when the values of the simplex agree to `tolerance` or after
/// `evaluations`. Returns the best point and its value; a value that is NaN counts as the worst.
pub(super) fn minimise<const D: usize>(
    objective: &mut dyn FnMut(&[f64; D]) -> f64,
    start: [f64; D],
    step: [f64; D],
    tolerance: f64,
    evaluations: usize,
) -> ([f64; D], f64) {
    let mut value = |x: &[f64; D]| {
        let y = objective(x);
        if y.is_nan() { f64::INFINITY } else { y }
    };
    let mut simplex = vec![(start, value(&start))];
    for i in 0..D {
        let mut x = start;
        x[i] += step[i];
        simplex.push((x, value(&x)));
    }
    let mut used = D + 1;
    loop {
        simplex.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, worst) = (simplex[0], simplex[D]);
        if worst.1 - best.1 <= tolerance || used >= evaluations {
            return best;
        }
        let centre: [f64; D] = std::array::from_fn(|i| simplex[..D].iter().map(|(x, _)| x[i]).sum::<f64>() / D as f64);
        // A point on the line from the worst through the centre; 1 is the reflection.
        let mut along = |t: f64| {
            let x: [f64; D] = std::array::from_fn(|i| centre[i] + t * (centre[i] - worst.0[i]));
            used += 1;
            (x, value(&x))
        };
        let reflected = along(1.0);
        let candidate = if reflected.1 < best.1 {
            let expanded = along(2.0);
            if expanded.1 < reflected.1 { expanded } else { reflected }
        } else if reflected.1 < simplex[D - 1].1 {
            reflected
        } else {
            along(if reflected.1 < worst.1 { 0.5 } else { -0.5 })
        };
        if candidate.1 < worst.1.min(reflected.1.max(simplex[D - 1].1)) || candidate.1 < simplex[D - 1].1 {
            simplex[D] = candidate;
        } else {
            for (x, y) in &mut simplex[1..] {
                *x = std::array::from_fn(|i| 0.5 * (x[i] + best.0[i]));
                *y = value(x);
            }
            used += D;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known minimum: Rosenbrock's valley, and a quadratic with scales a thousand apart.
    #[test]
    fn valleys_are_followed() {
        let mut rosenbrock = |x: &[f64; 2]| (1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2);
        let (x, y) = minimise(&mut rosenbrock, [-1.2, 1.0], [0.5, 0.5], 1e-14, 2000);
        assert!((x[0] - 1.0).abs() < 1e-5 && y < 1e-10, "{x:?} {y}");
        let mut quadratic = |x: &[f64; 3]| x[0] * x[0] + 1e-3 * (x[1] - 2.0).powi(2) + 1e3 * (x[2] + 1.0).powi(2);
        let (x, _) = minimise(&mut quadratic, [1.0; 3], [0.3; 3], 1e-14, 3000);
        assert!((x[1] - 2.0).abs() < 1e-3 && (x[2] + 1.0).abs() < 1e-5, "{x:?}");
    }
}
