//! Models of MuJoCo.

use tribo_robot::{DescribedArm, mjcf};

/// A model is refused, with a reason that a terminal can print, or its arm has finite numbers; what it includes is not there.
pub fn check(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    let whole = mjcf::with_includes(text, &mut |_| Ok("<mujocoinclude><site/></mujocoinclude>".to_owned()));
    match whole.and_then(|text| mjcf::parse(&text, None, None)) {
        Ok(chain) => {
            finite(chain.arm::<6>());
            finite(chain.arm::<7>());
            assert!(chain.remarks().iter().all(|remark| !remark.to_string().is_empty()));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fn finite<const N: usize>(described: Option<DescribedArm<N>>) {
    let Some(DescribedArm { arm, coulomb_nm, viscous_nm_s_per_rad, .. }) = described else { return };
    let limits = &arm.limits;
    for j in 0..N {
        let link = &arm.links[j];
        assert!(link.mass_kg > 0.0 && link.mass_kg.is_finite());
        assert!(link.com_m.iter().chain(link.inertia_kg_m2.iter()).all(|value| value.is_finite()));
        assert!(arm.placements[j].rotation.iter().chain(arm.placements[j].translation.iter()).all(|x| x.is_finite()));
        assert!(limits.q_min_rad[j] < limits.q_max_rad[j] && limits.tau_max_nm[j] > 0.0 && limits.tau_max_nm[j] < 1e6);
        assert!(
            [coulomb_nm[j], viscous_nm_s_per_rad[j], arm.rotor_inertia_kg_m2[j]].iter().all(|x| (0.0..1e6).contains(x))
        );
    }
}
