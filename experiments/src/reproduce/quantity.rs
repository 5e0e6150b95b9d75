//! What an experiment measures, seed by seed.

use serde::{Deserialize, Serialize};

/// One number that an experiment measures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// What the paper reports, where it does.
    pub paper: Option<f64>,
}

impl Quantity {
    /// A quantity of this name and unit.
    pub fn new(name: impl Into<String>, unit: &str, paper: Option<f64>) -> Self {
        Self { name: name.into(), unit: unit.to_owned(), paper }
    }
}

/// The numbers of one seed, in the order of the quantities.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeedRun {
    /// The seed.
    pub seed: u64,
    /// The numbers.
    pub values: Vec<f64>,
}

/// A quantity over seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuantitySummary {
    /// The quantity.
    #[serde(flatten)]
    pub quantity: Quantity,
    /// Mean over seeds.
    pub mean: f64,
    /// Standard deviation over seeds; 0 for one.
    pub sd: f64,
    /// Least.
    pub min: f64,
    /// Largest.
    pub max: f64,
}

/// One summary per quantity.
pub fn summarize_quantities(quantities: &[Quantity], runs: &[SeedRun]) -> Vec<QuantitySummary> {
    let count = runs.len().max(1) as f64;
    quantities
        .iter()
        .enumerate()
        .map(|(i, quantity)| {
            let values: Vec<f64> = runs.iter().map(|run| run.values[i]).collect();
            let mean = values.iter().sum::<f64>() / count;
            let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
            QuantitySummary {
                quantity: quantity.clone(),
                mean,
                sd: if runs.len() > 1 { (square / (count - 1.0)).sqrt() } else { 0.0 },
                min: values.iter().copied().fold(f64::INFINITY, f64::min),
                max: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_spread_over_seeds() {
        let quantities = [Quantity::new("a", "Nm", None), Quantity::new("b", "K", Some(2.0))];
        let runs = [SeedRun { seed: 1, values: vec![1.0, 5.0] }, SeedRun { seed: 2, values: vec![3.0, 5.0] }];
        let summary = summarize_quantities(&quantities, &runs);
        assert_eq!((summary[0].mean, summary[0].min, summary[0].max), (2.0, 1.0, 3.0));
        assert!((summary[0].sd - 2.0_f64.sqrt()).abs() < 1e-15 && summary[1].sd == 0.0);
    }
}
