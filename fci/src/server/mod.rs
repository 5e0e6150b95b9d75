//! The control unit on the network.

mod inbox;
mod session;
mod settings;
mod wait;

use std::net::{SocketAddr, TcpListener};
use std::sync::atomic::{AtomicBool, Ordering};

use tribo_robot::{Plant, PlantLost};

pub(crate) use inbox::{Arrival, Inbox};
use session::Session;
pub use settings::{Pace, ServerEvent, ServerSettings};
use wait::ATTENTION;
pub(crate) use wait::wait_for;

use crate::unit::ControlUnit;

/// TCP port of the robot's commands.
const COMMAND_PORT: u16 = franka::wire::ROBOT_COMMAND_PORT;

/// Why a server cannot start or go on.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The address cannot be had.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// The plant gives no samples.
    #[error(transparent)]
    Plant(#[from] PlantLost),
    /// The network failed.
    #[error("network: {0}")]
    Network(#[from] std::io::Error),
}

/// Makes the unit of the client with that number, the first being 0.
type Renewal<P> = Box<dyn FnMut(usize) -> Result<ControlUnit<P>, PlantLost> + Send>;

/// A server for one client at a time.
pub struct Server<P> {
    settings: ServerSettings,
    listener: TcpListener,
    unit: ControlUnit<P>,
    renewal: Option<Renewal<P>>,
    model: Vec<u8>,
    message_id: u64,
}

impl<P: Plant<7>> Server<P> {
    /// A server of this unit. `model` is what clients download: the URDF in version 10 ([`crate::model::urdf`]), a shared
    /// object in version 5 ([`crate::model::library`]); empty where there is none, which clients are told.
    ///
    /// # Errors
    ///
    /// [`ServeError::Listen`] where the address or port is taken or not this machine's.
    pub fn bind(settings: ServerSettings, unit: ControlUnit<P>, model: Vec<u8>) -> Result<Self, ServeError> {
        let address = SocketAddr::new(settings.address, settings.port.unwrap_or(COMMAND_PORT));
        let listener = TcpListener::bind(address).map_err(|source| ServeError::Listen { address, source })?;
        listener.set_nonblocking(true)?;
        Ok(Self { settings, listener, unit, renewal: None, model, message_id: 0 })
    }

    /// The same server with a new unit for each client that is of its version; a new arm, that is.
    pub fn renewing(
        mut self,
        renewal: impl FnMut(usize) -> Result<ControlUnit<P>, PlantLost> + Send + 'static,
    ) -> Self {
        self.renewal = Some(Box::new(renewal));
        self
    }

    /// Where clients connect.
    ///
    /// # Errors
    ///
    /// [`ServeError::Network`] where the operating system does not tell.
    pub fn address(&self) -> Result<SocketAddr, ServeError> {
        Ok(self.listener.local_addr()?)
    }

    /// The unit.
    pub fn unit(&self) -> &ControlUnit<P> {
        &self.unit
    }

    /// Serves clients one after the other until `stop` is true, which is looked at ten times a second.
    ///
    /// # Errors
    ///
    /// [`ServeError::Network`] where sockets can no longer be had. What a client does is never an error of the server.
    pub fn run(&mut self, stop: &AtomicBool, mut event: impl FnMut(ServerEvent)) -> Result<(), ServeError> {
        let (mut clients, mut next) = (0, None);
        while !stop.load(Ordering::Relaxed) {
            let (stream, client) = match next.take() {
                Some(waiting) => waiting,
                None => {
                    wait_for(&[&self.listener], ATTENTION)?;
                    match self.listener.accept() {
                        Ok(accepted) => accepted,
                        Err(error) if is_nothing_yet(&error) => continue,
                        Err(error) => return Err(error.into()),
                    }
                }
            };
            event(ServerEvent::Connected(client));
            if let Some(renewal) = &mut self.renewal {
                self.unit = renewal(clients)?;
            }
            let message_id = self.message_id;
            let session = Session::new(self.settings, stream, &self.listener, &mut self.unit, &self.model, message_id);
            // A client that fails is gone, whatever the reason.
            if let Ok(mut session) = session {
                self.message_id = session.run(stop, &mut event);
                clients += usize::from(session.is_greeted());
                next = session.into_next();
            }
            event(ServerEvent::Disconnected);
        }
        Ok(())
    }
}

/// Whether a non-blocking call has nothing to tell, or a client took its connection back before it was accepted.
pub(crate) fn is_nothing_yet(error: &std::io::Error) -> bool {
    use std::io::ErrorKind::{ConnectionAborted, ConnectionReset, Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), WouldBlock | Interrupted | TimedOut | ConnectionAborted | ConnectionReset)
}
