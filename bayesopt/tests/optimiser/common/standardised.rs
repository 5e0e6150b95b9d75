//! What a Gaussian process is fitted to.

/// `(y − mean)/sd`.
pub fn standardised(y: &[f64]) -> Vec<f64> {
    let n = y.len() as f64;
    let mean = y.iter().sum::<f64>() / n;
    let sd = (y.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n).sqrt();
    y.iter().map(|y| (y - mean) / sd).collect()
}
