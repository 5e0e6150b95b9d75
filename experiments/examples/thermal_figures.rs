//! Probe.
use tribo_experiments::reproduce::{Simoni2017, Simoni2019};
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed: u64 = std::env::args().nth(2).map_or(1, |s| s.parse().unwrap_or(1));
    if std::env::args().nth(1).as_deref() == Some("04") {
        let c: Simoni2019 = serde_saphyr::from_str(&std::fs::read_to_string("experiments/04_simoni2019/config.yaml")?)?;
        let (run, _) = c.run(seed)?;
        for (q, v) in c.quantities().iter().zip(&run.values) {
            println!("{:55} {:>10.4} {:4} paper {:?}", q.name, v, q.unit, q.paper);
        }
        assert_eq!(c.quantities().len(), run.values.len());
    } else {
        let c: Simoni2017 = serde_saphyr::from_str(&std::fs::read_to_string("experiments/03_simoni2017/config.yaml")?)?;
        let (run, _) = c.run(seed)?;
        for (q, v) in c.quantities().iter().zip(&run.values) {
            println!("{:55} {:>10.4} {:4} paper {:?}", q.name, v, q.unit, q.paper);
        }
        assert_eq!(c.quantities().len(), run.values.len());
    }
    Ok(())
}
