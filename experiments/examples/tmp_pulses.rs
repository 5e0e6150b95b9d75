//! tmp
use tribo_experiments::reproduce::{PushCase, PushedTool};
fn main() {
    let mut cases = Vec::new();
    for payload_kg in [0.0, 0.2] {
        for (friction, compensated) in [(false, false), (true, false), (true, true)] {
            for moving in [false, true] {
                cases.push(PushCase { friction, compensated, moving, payload_kg });
            }
        }
    }
    let seeds = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(2);
    let rows = PushedTool { schema: "tribo.reproduce/1".into(), seeds, pose: 0, cases }.run(|| ()).unwrap();
    for r in rows {
        let c = r.case;
        println!(
            "{:8} f{:.2} {} {} {} {:.1}kg | {:.2} N {:.3} Nm | bias {:.2} {:.3} | {:.0} ms | cov {:.1} worst {:.1} | ± {:.2} N {:.3} Nm",
            r.estimator.as_str(),
            r.noise_factor,
            if c.friction { "friction" } else { "free    " },
            if c.compensated { "comp" } else { "none" },
            if c.moving { "moving" } else { "fixed " },
            c.payload_kg,
            r.rmse_force_n,
            r.rmse_moment_nm,
            r.bias_force_n,
            r.bias_moment_nm,
            r.delay_ms,
            100.0 * r.coverage95,
            100.0 * r.coverage95_worst,
            r.half_width_force_n,
            r.half_width_moment_nm
        );
    }
}
