//! How a server serves, and what it tells.

use std::net::{IpAddr, SocketAddr};

use crate::wire::{ErrorFlags, FciVersion, MotionRequest, MoveEnd};

/// What makes time pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// A period each millisecond, with or without a command.
    RealTime,
    /// A period for each command; without one, time stands still. Between motions states come each millisecond, of an arm
    /// that does not move.
    Lockstep,
}

/// Where and how to serve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ServerSettings {
    /// Version of the interface.
    pub version: FciVersion,
    /// Address to listen on; whoever reaches it can move the arm.
    pub address: IpAddr,
    /// TCP port; `None` is the interface's own, 1337, the only one that libfranka knows.
    pub port: Option<u16>,
    /// What makes time pass.
    pub pace: Pace,
}

/// What happens at a server, for its user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ServerEvent {
    /// A client is there.
    Connected(SocketAddr),
    /// A client of another version was sent away.
    OtherVersion(u16),
    /// A second client was sent away.
    Busy(SocketAddr),
    /// The client has gone; the arm is stopped.
    Disconnected,
    /// A message that is none of this interface; its client was sent away.
    Nonsense,
    /// A motion began.
    MoveStarted(MotionRequest),
    /// A motion ended, with the flags that say why.
    MoveEnded(MoveEnd, ErrorFlags),
}
