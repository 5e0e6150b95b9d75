//! Stories across crates.

mod architecture;
mod box_friction;
mod closed_loop_cost;
mod compensation_guard;
mod drift;
mod dynamics_identities;
mod dynamics_reference;
mod ekf_consistency;
mod ekf_frequency;
mod ekf_known_input;
mod estimators_on_pulses;
mod examples;
mod file_circles;
mod grey_box_ends;
mod law_check;
mod live_bits;
mod payload;
mod references;
mod robust_cost;
mod stopped_trials;
mod tick_faults;
mod wrench_on_pulses;
