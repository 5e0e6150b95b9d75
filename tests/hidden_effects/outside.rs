//! A torque that no cause of the vocabulary describes is not given a name with confidence.

use tribo_experiments::hidden_effects::Kind;

use crate::examine;

macro_rules! outside {
    ($($name:ident: $seed:literal;)*) => {$(
        #[test]
        fn $name() {
            let examined = examine($seed, Kind::OutsideVocabulary);
            assert_eq!(examined.case.extra, Some(stringify!($name)));
            assert!(!examined.judgement.confidently_wrong, "{}", examined.told());
        }
    )*};
}

// The last digit of the seed picks the torque.
outside! {
    position_friction: 900_301;
    slow_sine: 900_303;
    neighbour_velocity: 900_304;
    disturbance: 900_305;
    hysteretic_spring: 900_308;
}
