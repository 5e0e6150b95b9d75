//! The maximum of a function of one variable.

/// Shows points of an interval to `value`, at most `most` of them after the first two, until the interval that holds the maximum of a
/// function with one peak is no longer than `least`. Who asks keeps the best of what it was shown.
pub fn golden_section([mut low, mut high]: [f64; 2], least: f64, most: usize, value: &mut dyn FnMut(f64) -> f64) {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (value(a), value(b));
    for _ in 0..most {
        if high - low < least {
            break;
        }
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = value(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = value(b);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_at_the_peak_after_as_many_points_as_allowed() {
        let mut shown = Vec::new();
        golden_section([-3.0, 5.0], 1e-6, 100, &mut |x| {
            shown.push(x);
            -(x - 1.25).powi(2)
        });
        assert!((shown[shown.len() - 1] - 1.25).abs() < 1e-6 && shown.len() < 40, "{shown:?}");
        let mut count = 0;
        golden_section([0.0, 1.0], 0.0, 7, &mut |x| {
            count += 1;
            x
        });
        assert_eq!(count, 9);
    }
}
