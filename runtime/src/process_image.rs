//! Sensors read before the cycle, commands written after it.

use nalgebra::SVector;
use tribo_robot::{Plant, PlantLost, SensorFrame};

/// The process image of IEC 61131: [`crate::ControlLoop::tick`] senses what was put into it and leaves its command in it.
///
/// Between a robot and the loop it lets whoever owns the clock decide whether a command still goes out
/// ([`crate::RealTimeLoop`]), and time the loop without the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessImage<const N: usize> {
    /// What the next `sense` returns.
    pub frame: SensorFrame<N>,
    /// Torque of the last `actuate` (Nm).
    pub command: SVector<f64, N>,
}

impl<const N: usize> ProcessImage<N> {
    /// An image of this frame, with a command of zero.
    pub fn of(frame: SensorFrame<N>) -> Self {
        Self { frame, command: SVector::zeros() }
    }
}

impl<const N: usize> Plant<N> for ProcessImage<N> {
    #[inline]
    fn sense(&mut self) -> Result<SensorFrame<N>, PlantLost> {
        Ok(self.frame)
    }

    #[inline]
    fn actuate(&mut self, tau_nm: &SVector<f64, N>) {
        self.command = *tau_nm;
    }
}
