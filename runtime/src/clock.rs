//! The clock of a loop in real time.

/// A clock that can be read and waited for. Tests bring their own.
pub trait Clock {
    /// Time since a fixed moment (ns); never runs backwards.
    fn now_ns(&self) -> u64;

    /// Waits until that time (ns), or returns at once if it has passed.
    fn sleep_until_ns(&self, at_ns: u64);
}

/// `CLOCK_MONOTONIC`, waited for by absolute time (`clock_nanosleep`, `TIMER_ABSTIME`): waiting does not drift.
#[derive(Clone, Copy, Debug, Default)]
pub struct MonotonicClock;

#[cfg(target_os = "linux")]
impl Clock for MonotonicClock {
    #[inline]
    fn now_ns(&self) -> u64 {
        let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
        now.tv_sec.unsigned_abs() * 1_000_000_000 + now.tv_nsec.unsigned_abs()
    }

    fn sleep_until_ns(&self, at_ns: u64) {
        use rustix::{io::Errno, thread, time};
        let (seconds, rest) = (at_ns / 1_000_000_000, at_ns % 1_000_000_000);
        let at = time::Timespec { tv_sec: seconds.cast_signed(), tv_nsec: rest.cast_signed() };
        // A signal is no reason to wake.
        while thread::clock_nanosleep_absolute(thread::ClockId::Monotonic, &at) == Err(Errno::INTR) {}
    }
}

#[cfg(not(target_os = "linux"))]
impl Clock for MonotonicClock {
    fn now_ns(&self) -> u64 {
        static ORIGIN: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
        u64::try_from(ORIGIN.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    /// Relative waiting: as exact as the system has it.
    fn sleep_until_ns(&self, at_ns: u64) {
        std::thread::sleep(std::time::Duration::from_nanos(at_ns.saturating_sub(self.now_ns())));
    }
}
