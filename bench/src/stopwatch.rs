//! Time of short work.

use std::time::Instant;

/// Groups of passes.
const GROUPS: usize = 5;
/// Passes of a group.
const PASSES: usize = 21;

/// Time of one of `calls` equal pieces of work that `pass` does (ns): the least of five medians of 21 passes. The median leaves
/// out what interrupts a pass, the least of them what slows a whole group.
pub fn per_call_ns(calls: usize, mut pass: impl FnMut()) -> f64 {
    pass();
    let mut median = || {
        let mut times: Vec<f64> = (0..PASSES)
            .map(|_| {
                let started = Instant::now();
                pass();
                started.elapsed().as_secs_f64()
            })
            .collect();
        times.sort_by(f64::total_cmp);
        times[PASSES / 2]
    };
    let least = (0..GROUPS).map(|_| median()).fold(f64::INFINITY, f64::min);
    least * 1e9 / calls.max(1) as f64
}
