//! What a thread needs of the operating system to be on time.

/// Why a right was not granted, in the system's words.
pub type Refusal = String;

/// Priority of `SCHED_FIFO` (1 to 99): above whatever a desktop runs, below the kernel's own watchdogs at 99.
#[cfg(target_os = "linux")]
const FIFO_PRIORITY: u8 = 80;

/// Cores on which the calling thread may run, ascending; empty where the system does not say.
pub fn allowed_cores() -> Vec<usize> {
    #[cfg(target_os = "linux")]
    if let Ok(set) = rustix::thread::sched_getaffinity(None) {
        return (0..rustix::thread::CpuSet::MAX_CPU).filter(|core| set.is_set(*core)).collect();
    }
    Vec::new()
}

/// Keeps the calling thread, and the threads that it starts from now on, on these cores.
///
/// # Errors
/// What the system answers.
#[cfg(target_os = "linux")]
pub fn run_on_cores(cores: &[usize]) -> Result<(), Refusal> {
    let mut set = rustix::thread::CpuSet::new();
    for &core in cores {
        if core >= rustix::thread::CpuSet::MAX_CPU {
            return Err(format!("no core {core}"));
        }
        set.set(core);
    }
    rustix::thread::sched_setaffinity(None, &set).map_err(|error| error.to_string())
}

/// Lets the calling thread preempt everything ordinary on its core: `SCHED_FIFO`.
///
/// # Errors
/// What the system answers; without privilege it wants `ulimit -r` (`RLIMIT_RTPRIO`) of at least 80.
#[cfg(target_os = "linux")]
pub fn take_fifo_priority() -> Result<(), Refusal> {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id,
    };
    let priority = ThreadPriorityValue::try_from(FIFO_PRIORITY).map_err(|error| error.to_string())?;
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Crossplatform(priority), policy).map_err(
        |error| match error {
            thread_priority::Error::OS(code) => std::io::Error::from_raw_os_error(code).to_string(),
            error => format!("{error:?}"),
        },
    )
}

/// Keeps all memory of the process, present and future, out of the swap and mapped: `mlockall`.
///
/// # Errors
/// What the system answers; without privilege it wants `ulimit -l` (`RLIMIT_MEMLOCK`) above what the process uses.
#[cfg(target_os = "linux")]
pub fn lock_memory() -> Result<(), Refusal> {
    use rustix::mm::{MlockAllFlags, mlockall};
    mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE).map_err(|error| error.to_string())
}

#[cfg(not(target_os = "linux"))]
mod elsewhere {
    use super::Refusal;

    fn unknown<T>() -> Result<T, Refusal> {
        Err("not known on this system".to_owned())
    }

    /// Keeps the calling thread on these cores; only on Linux.
    ///
    /// # Errors
    /// Always.
    pub fn run_on_cores(_cores: &[usize]) -> Result<(), Refusal> {
        unknown()
    }

    /// Lets the calling thread preempt everything ordinary; only on Linux.
    ///
    /// # Errors
    /// Always.
    pub fn take_fifo_priority() -> Result<(), Refusal> {
        unknown()
    }

    /// Keeps all memory mapped; only on Linux.
    ///
    /// # Errors
    /// Always.
    pub fn lock_memory() -> Result<(), Refusal> {
        unknown()
    }
}
#[cfg(not(target_os = "linux"))]
pub use elsewhere::{lock_memory, run_on_cores, take_fifo_priority};
