//! The motion of one joint in polynomial pieces.

/// Highest power of a piece: the position under a quintic speed ramp.
const DEGREE: usize = 6;
/// Peak slope of the quintic step `10u³ − 15u⁴ + 6u⁵`.
pub(crate) const QUINTIC_PEAK_SPEED: f64 = 1.875;
/// Peak curvature of the quintic step, 10/√3.
pub(crate) const QUINTIC_PEAK_ACCELERATION: f64 = 5.773_502_691_896_258;

/// `q(u) = Σ cᵢ uⁱ`, u = (t − start)/duration in 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    start_s: f64,
    duration_s: f64,
    coefficients: [f64; DEGREE + 1],
}

/// Piecewise polynomial of one joint, twice continuously differentiable, built from its start forwards:
///
/// ```text
/// hold       q constant
/// quintic    q, q̇, q̈ given at both ends; from rest to rest it is the minimum-jerk move
/// cruise     q̇ rises by 10u³ − 15u⁴ + 6u⁵ to a speed, keeps it, falls the same way
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct JointProfile {
    start_rad: f64,
    pieces: Vec<Piece>,
    end_s: f64,
    end: [f64; 3],
}

impl JointProfile {
    /// An empty profile at rest at q (rad).
    pub fn resting_at(q_rad: f64) -> Self {
        Self { start_rad: q_rad, pieces: Vec::new(), end_s: 0.0, end: [q_rad, 0.0, 0.0] }
    }

    /// Length so far (s).
    pub fn duration_s(&self) -> f64 {
        self.end_s
    }

    /// Position at the end so far (rad).
    pub fn end_rad(&self) -> f64 {
        self.end[0]
    }

    /// Waits; the joint is taken to be at rest. Nothing happens unless `duration_s` (s) is positive.
    pub fn hold(&mut self, duration_s: f64) {
        let mut coefficients = [0.0; DEGREE + 1];
        coefficients[0] = self.end[0];
        self.push(duration_s, coefficients, [self.end[0], 0.0, 0.0]);
    }

    /// Quintic piece to position (rad), velocity [rad/s] and acceleration [rad/s²] within `duration_s` (s).
    pub fn quintic_to(&mut self, q_rad: f64, qd_rad_s: f64, qdd_rad_s2: f64, duration_s: f64) {
        let (t, [p0, v0, a0]) = (duration_s, self.end);
        let (v0, a0, v1, a1) = (v0 * t, a0 * t * t, qd_rad_s * t, qdd_rad_s2 * t * t);
        let d = q_rad - p0;
        let coefficients = [
            p0,
            v0,
            0.5 * a0,
            10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
            -15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
            6.0 * d - 3.0 * (v0 + v1) + 0.5 * (a1 - a0),
            0.0,
        ];
        self.push(duration_s, coefficients, [q_rad, qd_rad_s, qdd_rad_s2]);
    }

    /// From rest to rest at `speed_rad_s` [rad/s], lowered where the way is too short for the acceleration [rad/s²].
    pub fn cruise_to(&mut self, q_rad: f64, speed_rad_s: f64, acceleration_rad_s2: f64) {
        let way = q_rad - self.end[0];
        if way == 0.0 {
            return;
        }
        let (speed, ramp_s, cruise_s) = cruise(way.abs(), speed_rad_s, acceleration_rad_s2);
        let (speed, start) = (speed * way.signum(), self.end[0]);
        // ∫ speed (10u³ − 15u⁴ + 6u⁵) ramp du, and the same falling.
        let step = speed * ramp_s;
        let after_ramp = start + 0.5 * step;
        let before_fall = q_rad - 0.5 * step;
        self.push(ramp_s, [start, 0.0, 0.0, 0.0, 2.5 * step, -3.0 * step, step], [after_ramp, speed, 0.0]);
        let travel = before_fall - after_ramp;
        self.push(cruise_s, [after_ramp, travel, 0.0, 0.0, 0.0, 0.0, 0.0], [before_fall, speed, 0.0]);
        let fall = [self.end[0], step, 0.0, 0.0, -2.5 * step, 3.0 * step, -step];
        self.push(ramp_s, fall, [q_rad, 0.0, 0.0]);
    }

    /// Time (s) that [`Self::cruise_to`] takes for a way (rad).
    pub fn cruise_time_s(way_rad: f64, speed_rad_s: f64, acceleration_rad_s2: f64) -> f64 {
        if way_rad == 0.0 {
            return 0.0;
        }
        let (_, ramp_s, cruise_s) = cruise(way_rad.abs(), speed_rad_s, acceleration_rad_s2);
        2.0 * ramp_s + cruise_s
    }

    /// Position (rad), velocity [rad/s] and acceleration [rad/s²] at `time_s` (s); at rest outside the profile.
    pub fn at(&self, time_s: f64) -> [f64; 3] {
        if time_s < 0.0 {
            return [self.start_rad, 0.0, 0.0];
        }
        if time_s > self.end_s {
            return [self.end[0], 0.0, 0.0];
        }
        let next = self.pieces.partition_point(|piece| piece.start_s <= time_s);
        match next.checked_sub(1).and_then(|k| self.pieces.get(k)) {
            Some(piece) => piece.at(time_s),
            None => [self.start_rad, 0.0, 0.0],
        }
    }

    /// Velocity [rad/s] and acceleration [rad/s²] that the next piece starts from.
    pub(super) fn start_at(&mut self, qd_rad_s: f64, qdd_rad_s2: f64) {
        self.end = [self.end[0], qd_rad_s, qdd_rad_s2];
    }

    fn push(&mut self, duration_s: f64, coefficients: [f64; DEGREE + 1], end: [f64; 3]) {
        if duration_s > 0.0 {
            self.pieces.push(Piece { start_s: self.end_s, duration_s, coefficients });
            self.end_s += duration_s;
            self.end = end;
        }
    }
}

impl Piece {
    fn at(&self, time_s: f64) -> [f64; 3] {
        let u = ((time_s - self.start_s) / self.duration_s).clamp(0.0, 1.0);
        let (mut p, mut d, mut dd) = (0.0, 0.0, 0.0);
        // Horner for the polynomial and its first two derivatives at once.
        for &c in self.coefficients.iter().rev() {
            dd = dd * u + 2.0 * d;
            d = d * u + p;
            p = p * u + c;
        }
        [p, d / self.duration_s, dd / (self.duration_s * self.duration_s)]
    }
}

/// (speed, length of each ramp, length of the cruise): speed as asked, or what the way allows.
fn cruise(way: f64, speed: f64, acceleration: f64) -> (f64, f64, f64) {
    let speed = speed.min((way * acceleration / QUINTIC_PEAK_SPEED).sqrt());
    let ramp_s = QUINTIC_PEAK_SPEED * speed / acceleration;
    (speed, ramp_s, (way / speed - ramp_s).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> JointProfile {
        let mut profile = JointProfile::resting_at(0.3);
        profile.hold(0.2);
        profile.cruise_to(1.1, 0.5, 4.0);
        profile.hold(0.1);
        profile.cruise_to(1.05, 2.0, 4.0); // too short for its speed
        profile.quintic_to(0.0, -0.4, 1.0, 2.0);
        profile.quintic_to(0.3, 0.0, 0.0, 1.0);
        profile
    }

    /// Finite differences: velocity and acceleration are the derivatives of the position, across joints of pieces too.
    #[test]
    fn derivatives_are_consistent() {
        let (profile, h) = (example(), 1e-5);
        let n = (profile.duration_s() / 1.37e-3) as usize;
        for k in 1..n {
            let t = k as f64 * 1.37e-3;
            let ([p0, v0, _], [p1, v1, _], [_, v, a]) = (profile.at(t - h), profile.at(t + h), profile.at(t));
            assert!(((p1 - p0) / (2.0 * h) - v).abs() < 1e-7, "velocity at {t}");
            assert!(((v1 - v0) / (2.0 * h) - a).abs() < 2e-3, "acceleration at {t}"); // jerk jumps at a quintic joint
        }
        assert_eq!(profile.at(-1.0), [0.3, 0.0, 0.0]);
        assert!((profile.at(profile.duration_s())[0] - 0.3).abs() < 1e-12);
    }

    /// Closed form: peak speed and acceleration of a cruise are the ones asked for, and the time is as predicted.
    #[test]
    fn a_cruise_reaches_its_speed_and_no_more() {
        let mut profile = JointProfile::resting_at(0.0);
        profile.cruise_to(-1.0, 0.5, 4.0);
        assert!((profile.duration_s() - JointProfile::cruise_time_s(1.0, 0.5, 4.0)).abs() < 1e-12);
        let (mut fastest, mut hardest) = (0.0_f64, 0.0_f64);
        for k in 0..=20_000 {
            let [_, v, a] = profile.at(k as f64 * profile.duration_s() / 20_000.0);
            (fastest, hardest) = (fastest.max(-v), hardest.max(a.abs()));
        }
        assert!((fastest - 0.5).abs() < 1e-12 && (hardest - 4.0).abs() < 1e-5, "{fastest} {hardest}");
    }
}
