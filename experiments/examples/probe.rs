use tribo_control::*;
use tribo_ekf::*;
use tribo_experiments::*;
use tribo_friction::law::CoulombViscous;
use tribo_friction::*;
use tribo_robot::*;
use tribo_sim::*;
fn main() {
    let q = presets::panda_ready_pose();
    let arm = presets::panda();
    let mk = |truth: Truth<7>, v, dn| Trial {
        truth,
        sensors: Sensors::default(),
        sub_steps: 5,
        pulses: WrenchPulses::default(),
        model: arm.clone(),
        start: q,
        impedance: ImpedanceSettings { nullspace_damping_per_s: dn, ..Default::default() },
        reference: SinusoidReference::paper(Kinematics::at(&arm, &q).base_from_flange(), PAPER_PHASES_RAD),
        velocity: v,
        limits: PenaltyLimits::default(),
        dt_s: 1e-3,
    };
    let none = FrictionModel::uniform(CoulombViscous::default().into());
    for (name, truth) in [
        ("frictionless", Truth::panda_frictionless()),
        ("cv", Truth::panda_coulomb_viscous()),
        ("stribeck", Truth::panda_stribeck()),
        ("lugre", Truth::panda_lugre()),
        ("gaz", Truth::panda_gaz()),
    ] {
        for dn in [5.0, 50.0] {
            for v in [VelocitySource::Measured, VelocitySource::Reference, VelocitySource::Hybrid] {
                let t0 = std::time::Instant::now();
                let trial = mk(truth.clone(), v, dn);
                let a = run_trial(&trial, &none, WrenchEkf::new(WrenchEkfSettings::default()), 1);
                let b = run_trial(&trial, &truth.friction, WrenchEkf::new(WrenchEkfSettings::default()), 1);
                println!(
                    "{name} Dn {dn} {v:?}: none {:.2} {:?}  oracle {:.2} {:?}   {:.3} s/trial",
                    a.cost.total(),
                    a.aborted,
                    b.cost.total(),
                    b.aborted,
                    t0.elapsed().as_secs_f64() / 2.0
                );
            }
        }
    }
}
