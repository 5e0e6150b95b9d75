//! What the wire does to a trial: nothing. A trial over TCP and UDP is, bit for bit, the trial before the same control unit in
//! this process, and its cost that of the simulated arm without any unit.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use std::net::{IpAddr, Ipv4Addr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::SVector;
use tribo_campaign::{AnyTune, TuneConfig, ValidTune};
use tribo_fci::{
    Connection, ControlUnit, ControllerMode, CyclicCommand, FciVersion, GeneratorMode, MotionRequest, Pace, Server,
    ServerSettings,
};
use tribo_logs::RobotLog;
use tribo_robot::{ControlTerms, Plant, PlantLost, SensorFrame};
use tribo_sim::{BoxFrictionPlant, Sensors, TorqueSide};
use tribo_trial::{AnyEstimator, record_trial};

/// The control unit without a network, as the loop sees it.
struct Near {
    unit: ControlUnit<BoxFrictionPlant<7>>,
    periods: u64,
}

impl Plant<7> for Near {
    fn sense(&mut self) -> Result<SensorFrame<7>, PlantLost> {
        let state = self.unit.state(self.periods);
        let time_s = self.periods as f64 * 1e-3;
        Ok(SensorFrame { time_s, q: state.q_rad, qd: state.qd_rad_s, tau: state.torque_nm, theta: None })
    }

    fn actuate(&mut self, tau_nm: &SVector<f64, 7>) {
        let state = self.unit.state(0);
        let terms = ControlTerms::at(self.unit.bare_arm(), &state.q_rad, &state.qd_rad_s);
        let torque_nm = (tau_nm - terms.gravity_nm).into();
        let (zero, pose) = ([0.0; 7], [0.0; 16]);
        let command = CyclicCommand {
            message_id: self.periods,
            q_rad: zero,
            qd_rad_s: zero,
            pose,
            twist: [0.0; 6],
            elbow: None,
            torque_nm,
            finished: false,
        };
        assert_eq!(self.unit.cycle(Some(&command)), None, "no reflex");
        self.periods += 1;
    }
}

fn unit(tune: &ValidTune<7>) -> ControlUnit<BoxFrictionPlant<7>> {
    let (mut trial, seed) = tune.numbered(0);
    trial.sensors = Sensors { torque_side: TorqueSide::Link, ..trial.sensors };
    ControlUnit::new(FciVersion::V5, tune.trial.model.clone(), trial.plant(seed)).expect("a simulated arm answers")
}

fn recorded(plant: &mut impl Plant<7>, tune: &ValidTune<7>) -> (f64, RobotLog) {
    let friction = tune.oracle.friction.scaled(0.8);
    let estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, &tune.trial, &friction).unwrap();
    let (outcome, log) = record_trial(plant, &tune.trial, &friction, estimator).unwrap();
    assert_eq!(outcome.aborted, None);
    (outcome.cost.total(), log)
}

#[test]
fn a_trial_over_the_wire_has_the_bits_of_one_before_the_unit() {
    let AnyTune::Seven(mut tune) = TuneConfig::default().validate_any().unwrap() else { panic!("a Panda") };
    tune.trial.reference.duration_s = 5.0;

    let mut near = Near { unit: unit(&tune), periods: 0 };
    let request = MotionRequest { controller: ControllerMode::External, generator: GeneratorMode::JointVelocity };
    near.unit.start(request).unwrap();
    let (cost_near, log_near) = recorded(&mut near, &tune);

    let address = IpAddr::V4(Ipv4Addr::LOCALHOST);
    let settings = ServerSettings { version: FciVersion::V5, address, port: Some(0), pace: Pace::Lockstep };
    let mut server = Server::bind(settings, unit(&tune), Vec::new()).unwrap();
    let host = server.address().unwrap().to_string();
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stop);
    let thread = std::thread::spawn(move || server.run(&stopped, |_| {}));
    let connection = Connection::open(&host, false).unwrap();
    let never = AtomicBool::new(false);
    let mut far = connection.torque_plant(&tune.trial.model, &never).unwrap();
    let (cost_far, log_far) = recorded(&mut far, &tune);
    far.finish().unwrap();
    drop(connection);
    stop.store(true, Ordering::Relaxed);
    thread.join().unwrap().unwrap();

    let (trial, seed) = tune.numbered(0);
    let (cost_here, _) = recorded(&mut trial.plant(seed), &tune);

    assert_eq!(cost_near.to_bits(), cost_far.to_bits());
    assert_eq!(cost_here.to_bits(), cost_far.to_bits());
    assert_eq!(log_near, log_far);
}
