//! Waiting for sockets, to the microsecond.

use std::io;
use std::os::fd::AsFd;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

/// How long the server may sleep before it looks whether it shall stop.
pub(super) const ATTENTION: Duration = Duration::from_millis(100);

/// Waits until one of the sockets can be read or `within` is over. A socket's own timeout is rounded up to a tick of the
/// kernel, 4 ms; this wait is not.
pub(crate) fn wait_for<const N: usize>(sockets: &[&dyn AsFd; N], within: Duration) -> io::Result<()> {
    let mut descriptors: [PollFd<'_>; N] =
        std::array::from_fn(|i| PollFd::from_borrowed_fd(sockets[i].as_fd(), PollFlags::IN));
    let timeout = Timespec {
        tv_sec: i64::try_from(within.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: i64::from(within.subsec_nanos()),
    };
    match poll(&mut descriptors, Some(&timeout)) {
        Ok(_) | Err(Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}
