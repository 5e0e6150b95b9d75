//! The hand's own port.

use std::io::{self, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use franka::wire::HeaderLayout;
use franka::wire::gripper::{
    GRIPPER_COMMAND_PORT, GRIPPER_VERSION, GraspRequest, GripperCommand, GripperConnectRequest, GripperConnectStatus,
    GripperMoveRequest, GripperState, GripperStatus,
};
use zerocopy::little_endian::{F64, U16, U32};
use zerocopy::{FromBytes, IntoBytes};

use crate::server::{Arrival, Inbox, ServeError, is_nothing_yet, wait_for};

/// Widest opening of the hand (m).
const MAX_WIDTH_M: f64 = 0.08;
/// Greatest speed of the fingers (m/s).
const MAX_SPEED_M_S: f64 = 0.2;
/// Speed of homing (m/s).
const HOMING_SPEED_M_S: f64 = 0.1;
/// Time between two states.
const STATE_PERIOD: Duration = Duration::from_millis(10);
/// What the hand's thermometer shows (°C).
const TEMPERATURE: u16 = 25;

/// A Franka hand that has nothing between its fingers: it opens, closes and homes at the asked speed, and grasps nothing.
/// Its mass is not that of the arm's flange.
#[derive(Debug)]
pub struct GripperServer {
    listener: TcpListener,
    width_m: f64,
    message_id: u32,
}

/// A motion of the fingers.
#[derive(Clone, Copy, Debug)]
struct Travel {
    command: u32,
    id: u32,
    to_m: f64,
    speed_m_s: f64,
    /// What the end is answered with.
    status: GripperStatus,
}

impl GripperServer {
    /// A hand at this address; `port` is the interface's own, 1338, unless given.
    ///
    /// # Errors
    ///
    /// [`ServeError::Listen`] where the address or port is taken.
    pub fn bind(address: std::net::IpAddr, port: Option<u16>) -> Result<Self, ServeError> {
        let address = SocketAddr::new(address, port.unwrap_or(GRIPPER_COMMAND_PORT));
        let listener = TcpListener::bind(address).map_err(|source| ServeError::Listen { address, source })?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, width_m: MAX_WIDTH_M, message_id: 0 })
    }

    /// Where clients connect.
    ///
    /// # Errors
    ///
    /// [`ServeError::Network`] where the operating system does not tell.
    pub fn address(&self) -> Result<SocketAddr, ServeError> {
        Ok(self.listener.local_addr()?)
    }

    /// Serves clients one after the other until `stop` is true.
    ///
    /// # Errors
    ///
    /// [`ServeError::Network`] where sockets can no longer be had.
    pub fn run(&mut self, stop: &AtomicBool) -> Result<(), ServeError> {
        while !stop.load(Ordering::Relaxed) {
            wait_for(&[&self.listener], Duration::from_millis(100))?;
            match self.listener.accept() {
                // A client that fails is gone, whatever the reason.
                Ok((stream, _)) => drop(self.serve(stream, stop)),
                Err(error) if is_nothing_yet(&error) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    fn serve(&mut self, mut stream: TcpStream, stop: &AtomicBool) -> io::Result<()> {
        stream.set_nodelay(true)?;
        stream.set_nonblocking(true)?;
        let udp = UdpSocket::bind((stream.local_addr()?.ip(), 0))?;
        let mut inbox = Inbox::new(HeaderLayout::Gripper);
        let (mut greeted, mut travel, mut next) = (false, None::<Travel>, Instant::now());
        while !stop.load(Ordering::Relaxed) {
            wait_for(&[&stream], next.saturating_duration_since(Instant::now()))?;
            let arrival = inbox.fill(&mut stream)?;
            while let Some(message) = inbox.next().map_err(|_| io::ErrorKind::InvalidData)? {
                let (command, id) = (message.command, message.id);
                let known = u16::try_from(command).ok().and_then(GripperCommand::from_u16);
                match known.ok_or(io::ErrorKind::InvalidData)? {
                    GripperCommand::Connect if !greeted => {
                        let request = read::<GripperConnectRequest>(message.payload)?;
                        let fits = request.version.get() == GRIPPER_VERSION;
                        let other = GripperConnectStatus::IncompatibleLibraryVersion;
                        let status = if fits { GripperConnectStatus::Success } else { other };
                        let [a, b] = status.to_u16().to_le_bytes();
                        let [c, d] = GRIPPER_VERSION.to_le_bytes();
                        send(&mut stream, command, id, &[a, b, c, d])?;
                        if !fits {
                            return Ok(());
                        }
                        udp.connect(SocketAddr::new(stream.peer_addr()?.ip(), request.udp_port.get()))?;
                        greeted = true;
                    }
                    GripperCommand::Stop if greeted => {
                        if let Some(travel) = travel.take() {
                            answer(&mut stream, travel.command, travel.id, GripperStatus::Aborted)?;
                        }
                        answer(&mut stream, command, id, GripperStatus::Success)?;
                    }
                    GripperCommand::Connect | GripperCommand::Stop => return Err(io::ErrorKind::InvalidData.into()),
                    motion if greeted => {
                        if let Some(travel) = travel.take() {
                            answer(&mut stream, travel.command, travel.id, GripperStatus::Aborted)?;
                        }
                        match wanted(motion, message.payload)? {
                            Some((to_m, speed_m_s, status)) => {
                                travel = Some(Travel { command, id, to_m, speed_m_s, status });
                            }
                            None => answer(&mut stream, command, id, GripperStatus::Fail)?,
                        }
                    }
                    _ => return Err(io::ErrorKind::InvalidData.into()),
                }
            }
            if arrival == Arrival::End {
                return Ok(());
            }
            if Instant::now() < next {
                continue;
            }
            next = (next + STATE_PERIOD).max(Instant::now());
            if let Some(moving) = travel {
                let step = moving.speed_m_s * STATE_PERIOD.as_secs_f64();
                self.width_m += (moving.to_m - self.width_m).clamp(-step, step);
                if (moving.to_m - self.width_m).abs() < 1e-9 {
                    travel = None;
                    answer(&mut stream, moving.command, moving.id, moving.status)?;
                }
            }
            if greeted {
                self.message_id = self.message_id.wrapping_add(1);
                let state = GripperState {
                    message_id: U32::new(self.message_id),
                    width: F64::new(self.width_m),
                    max_width: F64::new(MAX_WIDTH_M),
                    is_grasped: 0,
                    temperature: U16::new(TEMPERATURE),
                };
                // A closed port of the client loses states, as a network does.
                let _ = udp.send(state.as_bytes());
            }
        }
        Ok(())
    }
}

/// Width (m) and speed (m/s) that a motion asks for, and what its end is answered with; `None` where they are not allowed.
fn wanted(command: GripperCommand, payload: &[u8]) -> io::Result<Option<(f64, f64, GripperStatus)>> {
    let (width, speed, status) = match command {
        GripperCommand::Move => {
            let request = read::<GripperMoveRequest>(payload)?;
            (request.width.get(), request.speed.get(), GripperStatus::Success)
        }
        GripperCommand::Grasp => {
            let request = read::<GraspRequest>(payload)?;
            // Nothing stops the fingers before they touch: a grasp that is to hold something fails.
            (
                0.0_f64.max(request.width.get() - request.epsilon_inner.get()),
                request.speed.get(),
                GripperStatus::Unsuccessful,
            )
        }
        _ => (MAX_WIDTH_M, HOMING_SPEED_M_S, GripperStatus::Success),
    };
    let allowed = (0.0..=MAX_WIDTH_M).contains(&width) && speed > 0.0 && speed.is_finite();
    Ok(allowed.then(|| (width, speed.min(MAX_SPEED_M_S), status)))
}

fn read<T: FromBytes + zerocopy::KnownLayout + zerocopy::Immutable>(payload: &[u8]) -> io::Result<T> {
    T::read_from_prefix(payload).map(|(request, _)| request).map_err(|_| io::ErrorKind::InvalidData.into())
}

fn answer(stream: &mut TcpStream, command: u32, id: u32, status: GripperStatus) -> io::Result<()> {
    send(stream, command, id, &status.to_u16().to_le_bytes())
}

fn send(stream: &mut TcpStream, command: u32, id: u32, payload: &[u8]) -> io::Result<()> {
    let mut message = HeaderLayout::Gripper.encode_header(command, id, payload.len());
    message.extend_from_slice(payload);
    stream.write_all(&message)
}
