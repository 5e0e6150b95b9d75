//! Nothing is hidden, and nothing is found.

use tribo_diagnose::Verdict;
use tribo_experiments::hidden_effects::Kind;

use crate::examine;

macro_rules! nulls {
    ($($name:ident: $seed:literal;)*) => {$(
        #[test]
        fn $name() {
            let examined = examine($seed, Kind::Null);
            assert_eq!(examined.diagnosis.verdict, Verdict::NothingMissing, "{}", examined.told());
            assert!(examined.diagnosis.findings.is_empty(), "{}", examined.told());
        }
    )*};
}

nulls! {
    first: 900_200;
    second: 900_201;
    third: 900_202;
    fourth: 900_203;
}
