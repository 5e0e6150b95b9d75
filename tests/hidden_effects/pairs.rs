//! Two hidden causes on different joints, or one of them on the whole arm.

use tribo_experiments::hidden_effects::Kind;

use crate::examine;

fn both_are_found(seed: u64) {
    let examined = examine(seed, Kind::Pair);
    examined.assert_found();
    examined.assert_parameters(0.35);
    examined.assert_gain();
}

macro_rules! pairs {
    ($($name:ident: $seed:literal;)*) => {$(
        #[test]
        fn $name() {
            both_are_found($seed);
        }
    )*};
}

pairs! {
    first: 900_100;
    fourth: 900_103;
}

/// With two encoders friction and rotor follow the motor's before anything is found, so the residual that the gain is
/// taken of is smaller than the one of the case's own figure.
#[test]
fn second_of_two_encoders() {
    let examined = examine(900_101, Kind::Pair);
    examined.assert_found();
    examined.assert_parameters(0.35);
    assert!(examined.judgement.gain > 0.1, "{}", examined.told());
}

/// Known miss: a ripple of 4 mNm goes unseen.
#[test]
#[should_panic(expected = "not found")]
fn third_is_a_known_miss() {
    both_are_found(900_102);
}
