//! Robot descriptions.

use tribo_robot::{DescribedArm, urdf};

/// A URDF is refused, or its arm can be written as a URDF with as many joints and the same limits.
pub fn check(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    match urdf::parse(text, None, None) {
        Ok(chain) => {
            same_again(chain.arm::<6>());
            same_again(chain.arm::<7>());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fn same_again<const N: usize>(arm: Option<DescribedArm<N>>) {
    let Some(arm) = arm else { return };
    let text = arm.to_urdf();
    let again = urdf::parse(&text, None, None).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let again = again.arm::<N>().expect("as many joints");
    assert_eq!(again.arm.limits, arm.arm.limits);
    assert_eq!((again.coulomb_nm, again.viscous_nm_s_per_rad), (arm.coulomb_nm, arm.viscous_nm_s_per_rad));
}
