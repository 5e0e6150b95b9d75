//! The simulated truth: box-friction plant, sensors, contact, scenarios
