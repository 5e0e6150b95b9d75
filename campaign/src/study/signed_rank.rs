//! The test for paired samples.

/// Pairs up to which the distribution is exact.
const EXACT: usize = 60;

/// Two-sided p-value of Wilcoxon's signed-rank test that the pairs' differences are symmetric about zero:
///
/// ```text
/// W = Σ_{d_i > 0} rank |d_i|,   p = min(1, 2 min(P(W' <= W), P(W' >= W)))   over all 2^n signs
/// ```
///
/// Zeros are left out, ties share their mean rank; the distribution is exact up to 60 pairs, ties included, beyond that normal with
/// the variance of tied ranks. Source: wilcoxon1945. None without a difference.
pub fn signed_rank_p(differences: &[f64]) -> Option<f64> {
    let mut nonzero: Vec<f64> = differences.iter().copied().filter(|d| *d != 0.0 && d.is_finite()).collect();
    nonzero.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let n = nonzero.len();
    if n == 0 {
        return None;
    }
    // Twice the rank is whole, ties included.
    let mut doubled = vec![0_usize; n];
    let mut first = 0;
    while first < n {
        let tied = nonzero[first..].iter().take_while(|d| d.abs() == nonzero[first].abs()).count();
        doubled[first..first + tied].fill(2 * first + tied + 1);
        first += tied;
    }
    let positive: usize = nonzero.iter().zip(&doubled).filter(|(d, _)| **d > 0.0).map(|(_, rank)| rank).sum();
    let total: usize = doubled.iter().sum();
    let smaller = positive.min(total - positive);
    if n <= EXACT {
        // Probability of every sum, sign by sign.
        let mut probability = vec![0.0; total + 1];
        probability[0] = 1.0;
        for (k, rank) in doubled.iter().enumerate() {
            let reached: usize = doubled[..k].iter().sum();
            for sum in (0..=reached).rev() {
                let half = 0.5 * probability[sum];
                probability[sum] = half;
                probability[sum + rank] += half;
            }
        }
        let tail: f64 = probability[..=smaller].iter().sum();
        return Some((2.0 * tail).min(1.0));
    }
    let variance: f64 = doubled.iter().map(|rank| (*rank as f64 / 4.0).powi(2)).sum();
    // Half a rank of continuity.
    let z = (((total as f64 / 2.0 - smaller as f64) / 2.0 - 0.5) / variance.sqrt()).max(0.0);
    Some(libm::erfc(z / std::f64::consts::SQRT_2).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// scipy.stats.wilcoxon: `method="exact"` without ties; with ties `PermutationMethod` over all signs; normal with continuity.
    #[test]
    fn agrees_with_scipy() {
        let close = |differences: &[f64], p: f64| {
            let ours = signed_rank_p(differences).unwrap();
            assert!((ours - p).abs() < 1e-12 * p.max(1e-3), "{ours} {p}");
        };
        close(&[0.3, -0.1, 0.7, 1.2, 0.05, -0.6, 0.9, 0.45, -0.2, 0.33], 0.130859375);
        close(&[1.0, -1.0, 2.0, 2.0, -3.0, 1.0, 0.0, 4.0, 4.0, -2.0], 0.36328125);
        let many: Vec<f64> = (1..=80).map(|k| f64::from(k).sin() + 0.2).collect();
        close(&many, 0.010216571002523378);
        assert_eq!(signed_rank_p(&[0.0, 0.0]), None);
        assert_eq!(signed_rank_p(&[1.0]), Some(1.0));
    }
}
