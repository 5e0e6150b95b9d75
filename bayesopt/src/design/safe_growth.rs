//! A design that leaves a safe point in growing steps.

use super::sobol_point;

/// Share of the box reached by design point `index >= 1`:
/// `f_i = f_1 + (f_last − f_1)(i − 1)/(count − 2)`, held at `last` afterwards.
pub fn growth_factor(index: usize, count: usize, first: f64, last: f64) -> f64 {
    if index + 1 >= count || count < 3 {
        return last;
    }
    first + (last - first) * index.saturating_sub(1) as f64 / (count - 2) as f64
}

/// Safe growth:  `u_0 = start,  u_i = start + f_i (s_i − start)`, s the Sobol sequence, f_i the growth factor.
///
/// A convex combination, so it never leaves the box. All in unit coordinates.
/// Starting from zero compensation is worth more than any kernel: measured on an early prototype of the loop.
pub fn safe_growth_point(start: &[f64], index: usize, count: usize, first: f64, last: f64, seed: u64) -> Vec<f64> {
    if index == 0 {
        return start.to_vec();
    }
    let factor = growth_factor(index, count, first, last);
    let sobol = sobol_point(start.len(), index - 1, seed);
    start.iter().zip(&sobol).map(|(u, s)| u + factor * (s - u)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_point_is_the_start_and_steps_grow_to_the_last_factor() {
        let start = vec![0.0; 14];
        assert_eq!(safe_growth_point(&start, 0, 10, 0.1, 0.6, 3), start);
        assert_eq!(growth_factor(1, 10, 0.1, 0.6), 0.1);
        assert_eq!(growth_factor(9, 10, 0.1, 0.6), 0.6);
        assert_eq!(growth_factor(30, 10, 0.1, 0.6), 0.6);
        for i in 1..10 {
            let factor = growth_factor(i, 10, 0.1, 0.6);
            let point = safe_growth_point(&start, i, 10, 0.1, 0.6, 3);
            assert!(point.iter().all(|u| (0.0..=factor).contains(u)));
        }
    }

    #[test]
    fn short_designs_have_a_factor() {
        for count in 0..4 {
            assert!((0.1..=0.6).contains(&growth_factor(1, count, 0.1, 0.6)));
        }
    }
}
