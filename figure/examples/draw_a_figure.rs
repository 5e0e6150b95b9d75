//! A figure as data, drawn as SVG and written as CSV.
//!
//! `cargo run --release -p tribo-figure --example draw_a_figure -- [friction.svg]`

use tribo_figure::{Figure, Layer, Scale, csv, svg};

fn main() -> std::io::Result<()> {
    let qd: Vec<f64> = (-100..=100).map(|k| f64::from(k) * 0.01).collect();
    let friction_nm = |qd: &f64| (0.5 + 0.4 * (-(qd / 0.1).powi(2)).exp()) * (qd / 0.005).tanh() + 0.3 * qd;
    let torque_nm: Vec<f64> = qd.iter().map(friction_nm).collect();
    let band = |width: f64| torque_nm.iter().map(|tau| tau + width).collect::<Vec<f64>>();
    let figure = Figure::new("Stribeck friction", Scale::of("velocity [rad/s]"), Scale::of("torque [Nm]"))
        .with(Layer::band("95 %", 0, qd.clone(), band(-0.1), band(0.1)))
        .with(Layer::line("law", 0, qd.clone(), torque_nm.clone()));
    let (drawn, table) = (svg(&figure), csv(&figure));
    println!("SVG of {} bytes, CSV of {} rows", drawn.len(), table.lines().count());
    let largest = torque_nm.iter().fold(0.0_f64, |most, tau| most.max(*tau));
    println!("largest torque {largest:.2} Nm");
    match std::env::args().nth(1) {
        Some(path) => std::fs::write(path, drawn),
        None => Ok(()),
    }
}
