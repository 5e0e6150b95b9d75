//! Cartesian impedance control of a redundant arm
