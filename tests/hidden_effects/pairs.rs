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
    second: 900_101;
    third: 900_102;
    fourth: 900_103;
}
