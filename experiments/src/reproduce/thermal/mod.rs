//! The thermal friction model and the virtual sensor built on it (simoni2019, simoni2017).

mod duty_cycles;
mod observer_run;
mod simoni2017;
mod simoni2019;
mod table4;

pub use duty_cycles::DutyCycleStudy;
pub use observer_run::ObserverTrace;
pub use simoni2017::{PolishingTrace, Simoni2017};
pub use simoni2019::{Simoni2019, Simoni2019Trace};
pub use table4::Table4Row;

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_model::YamlDocument;

    fn shipped() -> (Simoni2017, Simoni2019) {
        let read = |text| YamlDocument::embedded("config.yaml", text);
        (
            read(crate::reproduce::shipped::SIMONI2017).parse().unwrap(),
            read(crate::reproduce::shipped::SIMONI2019).parse().unwrap(),
        )
    }

    /// One seed of 04: the same bits twice, one value per quantity, and what the experiment is there to show.
    #[test]
    fn a_warm_joint_needs_its_temperature() {
        let (_, experiment) = shipped();
        experiment.validate().unwrap();
        let (run, trace) = experiment.run(3).unwrap();
        assert_eq!(experiment.run(3).unwrap(), (run.clone(), trace.clone()));
        assert_ne!(experiment.run(4).unwrap().0.values, run.values);
        assert_eq!(run.values.len(), experiment.quantities().len());
        let last = trace.table.last().unwrap();
        assert_eq!(last.minute, 273.0);
        let [with, without] = last.unexplained_percent;
        assert!(with < 15.0 && without > 60.0, "{with} {without}");
        let settled = experiment.quantities().iter().position(|q| q.name.starts_with("10 K wrong start")).unwrap();
        assert!(run.values[settled] < 120.0);
    }

    #[test]
    fn settings_out_of_range_are_named() {
        let (polishing, joint) = shipped();
        polishing.validate().unwrap();
        let error = Simoni2017 { gear_share: 1.0, ..polishing.clone() }.validate().unwrap_err();
        assert!(error.to_string().contains("gear_share"), "{error}");
        let error = Simoni2019 { noise_sd_nm: f64::NAN, ..joint }.validate().unwrap_err();
        assert!(error.to_string().contains("noise_sd_nm"), "{error}");
        assert_eq!(polishing.quantities().len(), 14);
    }
}
