//! What a joint's own columns stand for.

/// Waves per revolution beside the slowest ripple of a joint, itself among them. Gears, torque sensors and cables repeat with
/// the joint's angle: a Fourier series, of which a range that is no full wave says nothing. The waves of the motor, some hundred
/// per revolution, lie above the band.
pub const RIPPLES: usize = 4;

/// What a joint's own columns stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointTerm {
    /// A constant.
    Offset,
    /// s = tanh(qd/ε).
    Coulomb,
    /// qd.
    Viscous,
    /// tanh(qd/w).
    Curve(usize),
    /// |τ_link| s.
    Load,
    /// qdd.
    Rotor,
    /// z_x − s.
    Presliding(usize),
    /// clip((qd + ℓ qdd)/w) − s.
    Lead(usize),
    /// sin(n q).
    Sine(usize),
    /// cos(n q).
    Cosine(usize),
    /// q.
    Spring,
}

impl JointTerm {
    /// In the order of the columns.
    pub const ALL: [Self; 23] = [
        Self::Offset,
        Self::Coulomb,
        Self::Viscous,
        Self::Curve(0),
        Self::Curve(1),
        Self::Curve(2),
        Self::Load,
        Self::Rotor,
        Self::Presliding(0),
        Self::Presliding(1),
        Self::Presliding(2),
        Self::Lead(0),
        Self::Lead(1),
        Self::Lead(2),
        Self::Sine(0),
        Self::Cosine(0),
        Self::Sine(1),
        Self::Cosine(1),
        Self::Sine(2),
        Self::Cosine(2),
        Self::Sine(3),
        Self::Cosine(3),
        Self::Spring,
    ];

    /// Dry friction that leads the velocity, of any width.
    pub const LEAD: [Self; 3] = [Self::Lead(0), Self::Lead(1), Self::Lead(2)];

    /// The terms of the ripples.
    pub const RIPPLE: [Self; 2 * RIPPLES] = [
        Self::Sine(0),
        Self::Cosine(0),
        Self::Sine(1),
        Self::Cosine(1),
        Self::Sine(2),
        Self::Cosine(2),
        Self::Sine(3),
        Self::Cosine(3),
    ];

    /// Place among the columns of a joint.
    pub fn place(self) -> usize {
        Self::ALL.iter().position(|term| *term == self).unwrap_or(0)
    }
}
