//! A friction compensator in the formats of other programs, and what each of them cannot say.
//!
//! `cargo run --release -p tribo-export --example export_everywhere`

use tribo_export::{Format, export};
use tribo_friction::law::Stribeck;
use tribo_friction::{Compensator, FrictionModel, VelocitySource};
use tribo_model::TunedFile;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let joint = Stribeck {
        coulomb_nm: 0.5,
        viscous_nm_s_per_rad: 0.8,
        breakaway_minus_coulomb_nm: 0.3,
        inverse_stribeck_velocity_s_per_rad: 6.0,
        shape: 1.5,
    };
    let compensator = Compensator::new(FrictionModel::<7>::uniform(joint.into()), VelocitySource::Hybrid);
    let tuned = TunedFile::of_trial("panda", (1, 0), &compensator, None);
    let formats = [Format::C, Format::Rust, Format::Ros2, Format::Crisp, Format::Urdf, Format::Mjcf, Format::Json];
    for format in formats {
        match export(&tuned, format, None) {
            Ok(exported) => {
                println!("{}: {} lines", format.name(), exported.text.lines().count());
                for loss in &exported.losses {
                    println!("  loses {loss}");
                }
            }
            Err(error) => println!("{}: refused, {error}", format.name()),
        }
    }
    // The text is yours to write; `tribo export` writes it atomically.
    let header = export(&tuned, Format::C, Some("my_arm"))?;
    for line in header.text.lines().filter(|line| line.contains("my_arm_compensate")).take(1) {
        println!("{line}");
    }
    Ok(())
}
