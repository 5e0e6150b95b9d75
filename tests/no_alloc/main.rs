//! The tick allocates nothing.
//!
//! A counting allocator (crate `allocation-counter`, one counter per thread) watches a thousand ticks of the whole loop
//! (sense, wrench filter, controller, limits, plant) for every truth and velocity source, then a thousand ticks after a
//! fault; a thousand steps of the loop on a clock; a thousand ticks of every other wrench estimator, and of each as logs and topics feed it. There is no tolerance: one allocation in two thousand ticks is a failure.

use std::cell::Cell;
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::{SVector, Vector6};
use tribo_control::{PAPER_PHASES_RAD, SinusoidReference};
use tribo_fci::{
    Connection, ControlUnit, ControllerMode, CyclicCommand, FciVersion, GeneratorMode, MotionRequest, MoveEnd, Pace,
    STATE_BYTES_MAX, Server, ServerSettings, model,
};
use tribo_friction::thermal::{HeatBalance, PolynomialStribeck, TemperatureFactor, ThermalJoint, ThermalLaw};
use tribo_friction::{Compensator, FrictionBand, JointBand, JointEffects, VelocitySource};
use tribo_model::Model;
use tribo_residual::{
    DoubleEncoderEstimator, DoubleEncoderModel, DoubleEncoderSettings, LoadedRest, MomentumEstimator, MomentumSettings,
    QpEstimator, QpSettings, Rest, Rests, ThermalEstimator, ThermalSettings, calibrate,
};
use tribo_robot::{ControlTerms, EstimatorInput, SensorFrame, Wrench, WrenchEstimator, presets};
use tribo_runtime::{Clock, LoopTiming, OverrunPolicy, RealTimeLoop, record_ring};
use tribo_sim::{BoxFrictionPlant, Effect, Sensors, TorqueSide, Truth, WrenchPulses};
use tribo_tests::{DT_S, TamperedPlant, all_effects, five_truths, loop_with, ready_flange};
use tribo_trial::{EstimatorName, LogEstimator};

/// Ticks watched before and after the fault.
const TICKS: u64 = 1000;

/// The guard itself can fail: a single boxed number is seen.
#[test]
fn the_counter_sees_one_allocation() {
    let seen = allocation_counter::measure(|| {
        std::hint::black_box(Box::new(1.0_f64));
    });
    assert_eq!(seen.count_total, 1);
}

#[test]
fn no_tick_allocates_healthy_or_faulted() {
    for (name, truth) in five_truths() {
        watch(name, &truth, [JointEffects::default(); 7]);
    }
}

/// The same with a compensator that believes every effect it knows, curves and all bristles included, and with a plant
/// whose friction has both.
#[test]
fn no_tick_allocates_with_effects() {
    watch("believed effects", &Truth::panda_coulomb_viscous(), all_effects());
    watch("true effects", &truth_with_effects(), all_effects());
}

/// The other wrench estimators by themselves: a moving arm, a standing one (friction in its band, all twelve limits), a
/// wrench that comes and goes, and a sample that must be refused.
#[test]
fn no_estimator_allocates() {
    let joint = JointBand::coulomb_viscous(0.5, 0.8, 3e-3, 0.05);
    let band = FrictionBand::new([joint; 7]).expect("a valid band");
    let unknown = JointBand { coulomb_max_nm: f64::INFINITY, coulomb_min_nm: f64::NEG_INFINITY, ..joint };
    let partly_unknown = FrictionBand::new([joint, joint, joint, joint, joint, joint, unknown]).expect("a valid band");
    watch_estimator("momentum", MomentumEstimator::new(MomentumSettings::new(band)));
    watch_estimator("qp", QpEstimator::new(QpSettings::new(band)));
    watch_estimator("double encoder", DoubleEncoderEstimator::new(calibrated()));
    watch_estimator("qp, one joint unknown", QpEstimator::new(QpSettings::new(partly_unknown)));
    let cold =
        PolynomialStribeck { polynomial: [0.5, 0.8, 0.1, 0.0], stribeck_nm: 0.2, stribeck_decay_s_per_rad: 10.0 };
    let polynomial = TemperatureFactor { slope_per_k: -0.009, level: 1.0 };
    let law = ThermalLaw { polynomial, ..ThermalLaw::without_temperature(cold.into()) };
    let warm = ThermalJoint::new(law, HeatBalance::SIMONI2019).expect("a valid joint");
    let settings = ThermalSettings::new([warm; 7], 22.0);
    watch_estimator("thermal", ThermalEstimator::new(settings).expect("valid settings"));
}

/// A model of two encoders per joint with a process in every joint, from poses around the ready one.
fn calibrated() -> Arc<DoubleEncoderModel<7>> {
    let arm = presets::panda();
    let turn = |k: usize, j: usize| 0.5 * (1.7 * k as f64 + 2.3 * (k * j) as f64).sin();
    let rest = |k: usize, load: Vector6<f64>| {
        let q = presets::panda_ready_pose() + SVector::from_fn(|j, _| turn(k, j));
        let terms = ControlTerms::at(&arm, &q, &SVector::zeros());
        let torque = terms.gravity_nm * 1.1 + terms.jacobian.transpose() * load;
        let direction = SVector::from_fn(|j, _| turn(k + 1, j).signum());
        Rest { q, deflection_rad: torque / 1e4, direction, loading: -direction }
    };
    let free = (0..60).map(|k| rest(k, Vector6::zeros())).collect();
    let loaded = (0..60).map(|k| {
        let h = Vector6::from_fn(|i, _| 10.0 * turn(k, i + 7));
        LoadedRest { free: rest(k, Vector6::zeros()), loaded: rest(k, h), wrench_base: Wrench::from_vector(&h) }
    });
    let settings = DoubleEncoderSettings { inducing: 40, ..DoubleEncoderSettings::default() };
    let rests = Rests { free, loaded: loaded.collect() };
    Arc::new(calibrate(&arm, &rests, settings.validate().expect("valid settings"), 1).expect("enough rests"))
}

/// The loop on a clock: woken late, a deadline missed, then stopped by the overrun policy; the ring full half-way.
#[test]
fn no_step_on_a_clock_allocates() {
    /// Every reading takes 20 µs; the readings of two ticks much longer.
    #[derive(Debug, Default)]
    struct SlowClock(Cell<(u64, u64)>);
    impl Clock for SlowClock {
        fn now_ns(&self) -> u64 {
            let (reading, now_ns) = self.0.get();
            let longer_ns = match reading {
                301 => 1_500_000,
                601 => 5_000_000,
                _ => 20_000,
            };
            self.0.set((reading + 1, now_ns + longer_ns));
            now_ns + longer_ns
        }
        fn sleep_until_ns(&self, at_ns: u64) {
            let (reading, now_ns) = self.0.get();
            self.0.set((reading, now_ns.max(at_ns)));
        }
    }
    let truth = Truth::panda_coulomb_viscous();
    let reference = SinusoidReference::paper(ready_flange(), PAPER_PHASES_RAD);
    let control = loop_with(reference, Compensator::new(truth.friction, VelocitySource::Hybrid));
    let plant = BoxFrictionPlant::new(truth, Sensors::default(), presets::panda_ready_pose(), 1);
    let (sink, _drain) = record_ring(500);
    let timing = LoopTiming::new().expect("valid bounds");
    let policy = OverrunPolicy::default();
    let held = SVector::zeros();
    let real_time = RealTimeLoop::new(control, plant, SlowClock::default(), policy, sink, timing, held);
    let mut real_time = real_time.expect("a simulated arm answers");
    let seen = allocation_counter::measure(|| {
        real_time.run(TICKS);
    });
    assert_eq!(seen.count_total, 0, "{seen:?}");
    assert_eq!((real_time.overruns().missed(), real_time.faulted_at()), (6, Some(300)), "one held, five stop it");
    assert!(real_time.dropped() > 0, "a full ring");
}

/// A period of the control unit under each kind of motion, a reflex and its way out included.
#[test]
fn no_period_of_the_control_unit_allocates() {
    let request = |controller, generator| MotionRequest { controller, generator };
    let motions = [
        request(ControllerMode::External, GeneratorMode::JointVelocity),
        request(ControllerMode::JointImpedance, GeneratorMode::JointPosition),
        request(ControllerMode::CartesianImpedance, GeneratorMode::CartesianPose),
        request(ControllerMode::JointImpedance, GeneratorMode::CartesianVelocity),
    ];
    let plant =
        BoxFrictionPlant::new(Truth::panda_coulomb_viscous(), Sensors::default(), presets::panda_ready_pose(), 1);
    let mut unit = ControlUnit::new(FciVersion::V5, presets::panda(), plant).expect("a simulated arm answers");
    let mut bytes = [0; STATE_BYTES_MAX];
    let (mut id, mut reflexes) = (0, 0);
    let seen = allocation_counter::measure(|| {
        for motion in motions {
            unit.recover().expect("no motion runs");
            unit.start(motion).expect("the robot is ready");
            for period in 0..TICKS / 8 {
                let state = unit.state(id);
                state.encode(FciVersion::V5, &mut bytes);
                id += 1;
                let pose = state.end_effector_desired.to_homogeneous();
                let command = CyclicCommand {
                    message_id: id,
                    q_rad: state.q_desired_rad.into(),
                    qd_rad_s: [0.0; 7],
                    pose: std::array::from_fn(|i| pose.as_slice()[i]),
                    twist: [0.0; 6],
                    elbow: None,
                    // The last ends in a reflex where torques count.
                    torque_nm: [if period + 1 == TICKS / 8 { 50.0 } else { 0.0 }; 7],
                    finished: period + 1 == TICKS / 8,
                };
                let lost = period % 50 == 49;
                reflexes += u32::from(unit.cycle((!lost).then_some(&command)) == Some(MoveEnd::Reflex));
            }
            unit.stop();
        }
    });
    assert_eq!(seen.count_total, 0, "{seen:?}");
    assert_eq!(reflexes, 1, "the jump of torque");
}

/// While it lives, a server runs.
struct Served<'a>(&'a AtomicBool);

impl Drop for Served<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// The whole loop on a robot behind the Franka Control Interface: state in from the network, torque out.
#[test]
fn no_tick_over_the_network_allocates() {
    for version in [FciVersion::V5, FciVersion::V10] {
        let arm = if version == FciVersion::V5 { presets::panda() } else { presets::fr3() };
        let truth = Truth { arm: arm.clone(), ..Truth::panda_coulomb_viscous() };
        let sensors = Sensors { torque_side: TorqueSide::Link, ..Sensors::default() };
        let plant = BoxFrictionPlant::new(truth.clone(), sensors, presets::panda_ready_pose(), 1);
        let unit = ControlUnit::new(version, arm.clone(), plant).expect("a simulated arm answers");
        let settings =
            ServerSettings { version, address: Ipv4Addr::LOCALHOST.into(), port: Some(0), pace: Pace::Lockstep };
        // A client of version 10 takes the robot's limits from its URDF.
        let model = if version == FciVersion::V5 { Vec::new() } else { model::urdf(&arm).into_bytes() };
        let mut server = Server::bind(settings, unit, model).expect("a free port");
        let address = server.address().expect("it is bound").to_string();
        let (stop, never) = (AtomicBool::new(false), AtomicBool::new(false));
        std::thread::scope(|scope| {
            // Allocations are counted in the thread of the loop alone; a test that fails must not wait for the server's.
            scope.spawn(|| server.run(&stop, |_| {}));
            let served = Served(&stop);
            let connection = Connection::open(&address, false).expect("it serves");
            connection.approach(&arm, &presets::panda_ready_pose()).expect("it is there");
            let mut plant = connection.torque_plant(&arm, &never).expect("it is ready");
            let flange = tribo_robot::Kinematics::at(&arm, &presets::panda_ready_pose()).base_from_flange();
            let reference = SinusoidReference::paper(flange, PAPER_PHASES_RAD);
            let mut control = loop_with(reference, Compensator::new(truth.friction, VelocitySource::Hybrid));
            let mut faults = 0;
            let seen = allocation_counter::measure(|| {
                for _ in 0..TICKS {
                    faults += u64::from(std::hint::black_box(control.tick(&mut plant)).fault.is_some());
                }
            });
            let landed = plant.finish();
            drop(served);
            landed.expect("the robot had no reason to stop");
            assert_eq!((faults, seen.count_total), (0, 0), "{version:?}: {seen:?}");
        });
    }
}

/// Every estimator as a log or a topic feeds it, its friction and effects believed, one beginning on the way.
#[test]
fn no_measured_wrench_allocates() {
    let model = Model { effects: truth_with_effects().effects, ..Model::panda(TorqueSide::Motor) };
    for name in EstimatorName::ALL {
        let mut measured = LogEstimator::new(&model).measured(name).expect("a believable model");
        let terms = ControlTerms::at(&model.arm, &presets::panda_ready_pose(), &SVector::zeros());
        let mut settled = 0;
        let seen = allocation_counter::measure(|| {
            for tick in 0..TICKS {
                let t = tick as f64 * DT_S;
                let q = presets::panda_ready_pose() + SVector::repeat(0.1 * (2.0 * t).sin());
                let qd = SVector::repeat(0.2 * (2.0 * t).cos());
                let frame = SensorFrame { time_s: t, q, qd, tau: terms.gravity_nm, theta: Some(q) };
                if tick % 800 == 0 {
                    measured.begin(&frame);
                } else {
                    std::hint::black_box(measured.step(&frame, (tick % 3 == 0).then_some(&qd)));
                }
                settled += u64::from(measured.has_settled());
            }
        });
        assert_eq!(seen.count_total, 0, "{name:?}: {seen:?}");
        assert_eq!(settled, 300, "{name:?}");
    }
}

/// A Panda with a curve and bristles in every joint.
fn truth_with_effects() -> Truth<7> {
    let mut truth = Truth::panda_coulomb_viscous();
    for joint in 0..7 {
        truth.effects.push(Effect::FrictionCurve { joint, amplitude_nm: 0.05, width_rad_s: 0.1 });
        for (presliding_distance_rad, amplitude_nm) in [(3e-4, Some(0.05)), (3e-3, Some(-0.02)), (1e-3, None)] {
            truth.effects.push(Effect::Presliding { joint, presliding_distance_rad, amplitude_nm });
        }
    }
    truth
}

fn watch_estimator<E: WrenchEstimator<7>>(name: &str, mut estimator: E) {
    let arm = presets::panda();
    let (none, no_command) = (SVector::<f64, 7>::zeros(), Vector6::zeros());
    let mut faults = 0;
    let seen = allocation_counter::measure(|| {
        for tick in 0..TICKS {
            let t = tick as f64 * DT_S;
            let speed = if tick % 400 < 200 { 0.3 } else { 0.0 };
            let q = presets::panda_ready_pose() + SVector::repeat(0.1 * (2.0 * t).sin());
            let qd = SVector::repeat(speed * (0.7 * t).cos());
            let terms = ControlTerms::at(&arm, &q, &qd);
            let push = Vector6::repeat(if tick % 300 < 100 { 2.0 } else { 0.0 });
            let tau_motor = if tick % 97 == 96 {
                SVector::repeat(f64::NAN)
            } else {
                terms.bias_nm() + terms.jacobian.transpose() * push
            };
            let theta = Some(q + SVector::repeat(1e-3 * (3.0 * t).sin()));
            let frame = SensorFrame { time_s: t, q, qd, tau: tau_motor, theta };
            if tick % 500 == 0 {
                estimator.reset(&frame, &terms);
            }
            let estimate = std::hint::black_box(estimator.step(&EstimatorInput {
                frame: &frame,
                terms: &terms,
                tau_motor: &tau_motor,
                tau_friction: &none,
                acceleration_command: &no_command,
                dt_s: DT_S,
            }));
            faults += u64::from(estimate.fault.is_some());
        }
    });
    assert_eq!(seen.count_total, 0, "{name}: {seen:?}");
    assert_eq!(faults, TICKS / 97, "{name}: the refused samples and no others");
}

fn watch(name: &str, truth: &Truth<7>, effects: [JointEffects; 7]) {
    for velocity in [VelocitySource::Measured, VelocitySource::Reference, VelocitySource::Hybrid] {
        let plant = BoxFrictionPlant::new(truth.clone(), Sensors::default(), presets::panda_ready_pose(), 1)
            .with_pulses(WrenchPulses::each_axis(15.0, 2.5, 0.1, 0.1, 0.05));
        let mut plant = TamperedPlant::new(plant, |tick, mut frame| {
            if tick >= TICKS {
                frame.q = SVector::repeat(f64::NAN);
            }
            frame
        });
        let reference = SinusoidReference::paper(ready_flange(), PAPER_PHASES_RAD);
        let compensator = Compensator::new(truth.friction, velocity).with_effects(effects);
        let mut control = loop_with(reference, compensator);
        let mut faulted = 0;
        for (part, expected_faults) in [("healthy", 0), ("faulted", TICKS)] {
            let seen = allocation_counter::measure(|| {
                for _ in 0..TICKS {
                    let record = std::hint::black_box(control.tick(&mut plant));
                    faulted += u64::from(record.fault.is_some());
                }
            });
            assert_eq!(faulted, expected_faults, "{name} {velocity:?} {part}");
            assert_eq!(seen.count_total, 0, "{name} {velocity:?} {part}: {seen:?}");
        }
    }
}
