//! One hidden cause each: name, place, parameters, gain.

use tribo_experiments::hidden_effects::{Kind, Strength};
use tribo_regression::CauseLabel;

use crate::examine;

macro_rules! singles {
    ($($name:ident: $seed:literal, $label:ident, $strength:ident, $tolerance:literal;)*) => {$(
        #[test]
        fn $name() {
            let examined = examine($seed, Kind::Single(CauseLabel::$label, Strength::$strength));
            examined.assert_found();
            examined.assert_parameters($tolerance);
            examined.assert_gain();
        }
    )*};
}

// Name: seed, cause, strength, bound of the relative errors of its main parameters.
singles! {
    coulomb: 900_000, Coulomb, Medium, 0.1;
    viscous: 900_001, Viscous, Medium, 0.1;
    stribeck: 900_002, Stribeck, Strong, 0.15;
    coulomb_asymmetry: 900_003, CoulombAsymmetry, Medium, 0.1;
    torque_offset: 900_004, TorqueOffset, Weak, 0.2;
    torque_gain: 900_005, TorqueGain, Medium, 0.15;
    thermal_friction: 900_006, ThermalFriction, Strong, 0.25;
    load_friction: 900_007, LoadFriction, Medium, 0.15;
    payload: 900_008, Payload, Strong, 0.2;
    base_tilt: 900_009, BaseTilt, Strong, 0.15;
    link_inertial: 900_010, LinkInertial, Strong, 0.25;
    rotor_inertia: 900_011, RotorInertia, Medium, 0.15;
    torque_ripple: 900_012, TorqueRipple, Strong, 0.15;
    presliding: 900_013, Presliding, Strong, 0.25;
    elasticity: 900_014, JointElasticity, Strong, 0.25;
    backlash: 900_015, Backlash, Medium, 0.15;
    time_delay: 900_016, TimeDelay, Strong, 0.1;
    external_contact: 900_017, ExternalContact, Strong, 0.25;
    position_spring: 900_018, PositionSpring, Medium, 0.3;
}
