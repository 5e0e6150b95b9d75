//! Fixed-size extended Kalman filter and the augmented-state wrench estimator
