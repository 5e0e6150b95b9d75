//! Twist, wrench and pose: what the crates say to each other about the tool.

use nalgebra::{IsometryMatrix3, Vector3, Vector6};

/// A rigid transform `a_from_b`, rotation matrix and translation (m).
pub type Pose = IsometryMatrix3<f64>;

/// Velocity of a rigid body at a stated point, in stated axes; angular part first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Angular velocity [rad/s].
    pub angular_rad_s: Vector3<f64>,
    /// Linear velocity of the point [m/s].
    pub linear_m_s: Vector3<f64>,
}

/// Moment and force at a stated point, in stated axes; angular part first.
///
/// Sign: the wrench exerted **by the robot on the environment**, as h_ext of roveda2022 eq. (1) and
/// `O_F_ext_hat_K` of libfranka. What a hand does to the robot is the opposite: [`Wrench::reaction`] is the one
/// place where the sign turns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Moment (Nm).
    pub moment_nm: Vector3<f64>,
    /// Force (N).
    pub force_n: Vector3<f64>,
}

impl Twist {
    /// From the 6-vector `[angular; linear]`.
    #[inline]
    pub fn from_vector(v: &Vector6<f64>) -> Self {
        Self { angular_rad_s: v.fixed_rows::<3>(0).into_owned(), linear_m_s: v.fixed_rows::<3>(3).into_owned() }
    }

    /// The 6-vector `[angular; linear]`.
    #[inline]
    pub fn to_vector(&self) -> Vector6<f64> {
        stack(&self.angular_rad_s, &self.linear_m_s)
    }
}

impl Wrench {
    /// From the 6-vector `[moment; force]`.
    #[inline]
    pub fn from_vector(h: &Vector6<f64>) -> Self {
        Self { moment_nm: h.fixed_rows::<3>(0).into_owned(), force_n: h.fixed_rows::<3>(3).into_owned() }
    }

    /// The 6-vector `[moment; force]`.
    #[inline]
    pub fn to_vector(&self) -> Vector6<f64> {
        stack(&self.moment_nm, &self.force_n)
    }

    /// Newton's third law: robot-on-environment ↔ environment-on-robot.
    #[inline]
    pub fn reaction(&self) -> Self {
        Self { moment_nm: -self.moment_nm, force_n: -self.force_n }
    }

    /// The six numbers in file order, force then moment: `[Fx Fy Fz Mx My Mz]` [N, Nm].
    #[inline]
    pub fn to_force_moment(&self) -> [f64; 6] {
        let (f, m) = (&self.force_n, &self.moment_nm);
        [f.x, f.y, f.z, m.x, m.y, m.z]
    }

    /// From the six numbers in file order, force then moment [N, Nm].
    #[inline]
    pub fn from_force_moment(x: &[f64; 6]) -> Self {
        Self { force_n: Vector3::new(x[0], x[1], x[2]), moment_nm: Vector3::new(x[3], x[4], x[5]) }
    }
}

/// `[angular; linear]`.
#[inline]
fn stack(angular: &Vector3<f64>, linear: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(angular.x, angular.y, angular.z, linear.x, linear.y, linear.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_order_is_force_then_moment_and_the_sign_turns_in_one_place() {
        let h = Wrench::from_force_moment(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(h.to_vector(), Vector6::new(4.0, 5.0, 6.0, 1.0, 2.0, 3.0));
        assert_eq!(h.to_force_moment(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(h.reaction().to_vector(), -h.to_vector());
        assert_eq!(Wrench::from_vector(&h.to_vector()), h);
    }
}
