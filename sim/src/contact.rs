//! Who pushes the tool.

use tribo_robot::Wrench;

/// One trapezoidal pulse of a wrench at the flange, base axes, exerted by the robot on the environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulse {
    /// Wrench on the plateau.
    pub wrench_base: Wrench,
    /// Start of the rising ramp (s).
    pub start_s: f64,
    /// End of the falling ramp (s).
    pub end_s: f64,
    /// Length of each ramp (s).
    pub ramp_s: f64,
}

/// A schedule of wrench pulses; overlapping pulses add.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WrenchPulses {
    /// The pulses.
    pub pulses: Vec<Pulse>,
}

impl WrenchPulses {
    /// One plateau per axis: six pulses of `force_n` (N) and `moment_nm` (Nm), each `width_s` long, evenly from `start_s`.
    pub fn each_axis(force_n: f64, moment_nm: f64, start_s: f64, width_s: f64, pause_s: f64) -> Self {
        let pulses = (0..6)
            .map(|axis| {
                let mut components = [0.0; 6];
                components[axis] = if axis < 3 { force_n } else { moment_nm };
                let start_s = start_s + axis as f64 * (width_s + pause_s);
                Pulse {
                    wrench_base: Wrench::from_force_moment(&components),
                    start_s,
                    end_s: start_s + width_s,
                    ramp_s: 0.1,
                }
            })
            .collect();
        Self { pulses }
    }

    /// Wrench by the robot on the environment at `time_s` (s).
    #[inline]
    pub fn at(&self, time_s: f64) -> Wrench {
        let mut total = Wrench::default();
        for pulse in &self.pulses {
            let weight = pulse.weight(time_s);
            if weight > 0.0 {
                total.force_n += pulse.wrench_base.force_n * weight;
                total.moment_nm += pulse.wrench_base.moment_nm * weight;
            }
        }
        total
    }
}

impl Pulse {
    #[inline]
    fn weight(&self, time_s: f64) -> f64 {
        let edge = (time_s - self.start_s).min(self.end_s - time_s);
        if self.ramp_s > 0.0 { (edge / self.ramp_s).clamp(0.0, 1.0) } else { f64::from(edge >= 0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_visit_the_axes_in_file_order() {
        let pulses = WrenchPulses::each_axis(15.0, 2.5, 2.0, 1.0, 0.5);
        for axis in 0..6 {
            let h = pulses.at(2.5 + 1.5 * axis as f64).to_force_moment();
            for (k, value) in h.iter().enumerate() {
                assert_eq!(
                    *value,
                    if k != axis {
                        0.0
                    } else if k < 3 {
                        15.0
                    } else {
                        2.5
                    }
                );
            }
        }
        assert_eq!(pulses.at(1.99), Wrench::default());
        assert!((pulses.at(2.05).force_n.x - 7.5).abs() < 1e-9);
    }
}
