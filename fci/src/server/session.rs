//! One client.

use std::io::{self, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use franka::wire::HeaderLayout;
use franka::wire::robot::v5;
use tribo_robot::Plant;
use zerocopy::IntoBytes;
use zerocopy::little_endian::F64;

use super::inbox::{Arrival, Inbox};
use super::settings::{Pace, ServerEvent, ServerSettings};
use super::wait::{ATTENTION, wait_for};
use crate::unit::ControlUnit;
use crate::wire::{Answer, CyclicCommand, ErrorFlags, MoveEnd, Refusal, Request, RobotMode, STATE_BYTES_MAX};

/// Length of a period.
const PERIOD: Duration = Duration::from_millis(1);
/// In lockstep, how long the server waits for the first command of a motion before it sends one more state: a client may
/// want several before it answers, and takes at most so long to answer one.
const FIRST_ANSWER: Duration = Duration::from_millis(50);
/// How long a client may leave answers unread.
const WRITE_TIMEOUT: Duration = Duration::from_millis(500);

/// Why a session ends.
enum End {
    /// The client or the network.
    Gone,
    /// Bytes that are no request.
    Nonsense,
}

impl From<io::Error> for End {
    fn from(_: io::Error) -> Self {
        Self::Gone
    }
}

/// The running request of a motion.
struct MoveInHand {
    id: u32,
    /// How it ended, once it has; answered after the next state.
    end: Option<MoveEnd>,
    /// Id of the StopMove that ended it.
    stopped_by: Option<u32>,
}

/// One client's connection, from Connect to its end.
pub(super) struct Session<'a, P> {
    settings: ServerSettings,
    stream: TcpStream,
    listener: &'a TcpListener,
    udp: UdpSocket,
    /// Whether the client has said hello.
    greeted: bool,
    inbox: Inbox,
    unit: &'a mut ControlUnit<P>,
    model: &'a [u8],
    message_id: u64,
    in_hand: Option<MoveInHand>,
    command: Option<CyclicCommand>,
    /// Somebody else who wants to connect: refused once it is seen that this client is still there, else the next one.
    waiting: Option<(TcpStream, SocketAddr)>,
}

impl<'a, P: Plant<7>> Session<'a, P> {
    pub(super) fn new(
        settings: ServerSettings,
        stream: TcpStream,
        listener: &'a TcpListener,
        unit: &'a mut ControlUnit<P>,
        model: &'a [u8],
        message_id: u64,
    ) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
        stream.set_nonblocking(true)?;
        let udp = UdpSocket::bind((stream.local_addr()?.ip(), 0))?;
        udp.set_nonblocking(true)?;
        let inbox = Inbox::new(HeaderLayout::Robot);
        let (greeted, in_hand, command) = (false, None, None);
        let waiting = None;
        Ok(Self { settings, stream, listener, udp, greeted, inbox, unit, model, message_id, in_hand, command, waiting })
    }

    /// Whether the client was of our version.
    pub(super) fn is_greeted(&self) -> bool {
        self.greeted
    }

    /// Serves until the client goes or `stop`; returns the number of the last state.
    pub(super) fn run(&mut self, stop: &AtomicBool, event: &mut impl FnMut(ServerEvent)) -> u64 {
        let mut next = Instant::now();
        let end = loop {
            if stop.load(Ordering::Relaxed) {
                break Ok(());
            }
            let period = match self.settings.pace {
                Pace::RealTime => {
                    // After a stall, time goes on from now: the lost periods are not made up for.
                    next = (next + PERIOD).max(Instant::now());
                    self.period_in_real_time(next, event)
                }
                Pace::Lockstep => self.period_in_lockstep(stop, event),
            };
            if let Err(end) = period {
                break Err(end);
            }
        };
        if matches!(end, Err(End::Nonsense)) {
            event(ServerEvent::Nonsense);
        }
        if self.unit.mode() == RobotMode::Move {
            self.unit.stop();
            event(ServerEvent::MoveEnded(MoveEnd::Stopped, ErrorFlags::default()));
        }
        self.finish_stopping();
        self.message_id
    }

    /// Whatever the arm still moves, it does so before anybody sees it again.
    fn finish_stopping(&mut self) {
        while self.unit.is_stopping() {
            self.unit.cycle(None);
        }
    }

    fn period_in_real_time(&mut self, next: Instant, event: &mut impl FnMut(ServerEvent)) -> Result<(), End> {
        if self.greeted {
            self.send_state(event)?;
        }
        loop {
            let left = next.saturating_duration_since(Instant::now());
            self.wait(left)?;
            self.read_requests(event)?;
            self.read_commands(|_| true);
            if left.is_zero() {
                break;
            }
        }
        let command = self.command.take();
        self.cycle(command, event);
        Ok(())
    }

    fn period_in_lockstep(&mut self, stop: &AtomicBool, event: &mut impl FnMut(ServerEvent)) -> Result<(), End> {
        if self.greeted {
            self.send_state(event)?;
        }
        let id = self.message_id;
        let was_moving = self.unit.mode() == RobotMode::Move;
        let patience = match (was_moving, self.unit.is_commanded()) {
            (true, true) => None,
            (true, false) => Some(FIRST_ANSWER),
            (false, _) => Some(PERIOD),
        };
        let since = Instant::now();
        // A request may begin or end a motion, which the client must see in a state before it sends or waits on.
        while (self.unit.mode() == RobotMode::Move) == was_moving && !stop.load(Ordering::Relaxed) {
            let left = patience.map_or(ATTENTION, |patience| patience.saturating_sub(since.elapsed()));
            if left.is_zero() {
                break;
            }
            self.wait(left)?;
            self.read_requests(event)?;
            // Only the answer to the last state counts: a client that was asked twice has answered both.
            self.read_commands(|command| command.message_id == id);
            if let Some(command) = self.command.take()
                && was_moving
            {
                self.cycle(Some(command), event);
                break;
            }
        }
        self.finish_stopping();
        Ok(())
    }

    fn wait(&self, within: Duration) -> io::Result<()> {
        wait_for(&[&self.stream, &self.udp, self.listener], within)
    }

    fn cycle(&mut self, command: Option<CyclicCommand>, event: &mut impl FnMut(ServerEvent)) {
        if let Some(end) = self.unit.cycle(command.as_ref()) {
            event(ServerEvent::MoveEnded(end, self.unit.errors()));
            if let Some(in_hand) = &mut self.in_hand {
                in_hand.end = Some(end);
            }
        }
    }

    /// Sends the next state, and after it the answer to a motion that has ended.
    fn send_state(&mut self, event: &mut impl FnMut(ServerEvent)) -> Result<(), End> {
        self.message_id += 1;
        let mut bytes = [0; STATE_BYTES_MAX];
        let length = self.unit.state(self.message_id).encode(self.settings.version, &mut bytes);
        // A client whose port is closed for a while is one whose network loses states.
        let _ = self.udp.send(&bytes[..length]);
        if let Some(MoveInHand { id, end: Some(end), stopped_by }) = self.in_hand {
            self.in_hand = None;
            self.answer(v5::Command::Move.to_u32(), id, Answer::MoveEnded(end), &[])?;
            if let Some(stop_id) = stopped_by {
                event(ServerEvent::MoveEnded(end, ErrorFlags::default()));
                self.answer(v5::Command::StopMove.to_u32(), stop_id, Answer::Success, &[])?;
            }
        }
        Ok(())
    }

    /// Takes the newest of the commands that have come and are wanted.
    fn read_commands(&mut self, wanted: impl Fn(&CyclicCommand) -> bool) {
        let mut bytes = [0; 512];
        // Errors are those of earlier sends (a port that is closed), or that there is nothing more.
        for _ in 0..64 {
            let Ok(length) = self.udp.recv(&mut bytes) else { break };
            let Some(command) = CyclicCommand::decode(self.settings.version, &bytes[..length]) else { continue };
            let newer = self.command.is_none_or(|last| command.message_id > last.message_id);
            if newer && command.message_id <= self.message_id && wanted(&command) {
                self.command = Some(command);
            }
        }
    }

    fn read_requests(&mut self, event: &mut impl FnMut(ServerEvent)) -> Result<(), End> {
        let somebody_waited = self.waiting.is_some();
        let arrival = self.inbox.fill(&mut self.stream)?;
        loop {
            let message = self.inbox.next().map_err(|_| End::Nonsense)?;
            let Some(message) = message else { break };
            let (command, id) = (message.command, message.id);
            let request = Request::decode(self.settings.version, command, message.payload).ok_or(End::Nonsense)?;
            self.carry_out(command, id, request, event)?;
        }
        if arrival == Arrival::End {
            return Err(End::Gone);
        }
        // Who came while this client was going has seen it go: it is read once more before anybody is refused.
        if somebody_waited
            && arrival == Arrival::Nothing
            && let Some((_, other)) = self.waiting.take()
        {
            event(ServerEvent::Busy(other));
        }
        if self.waiting.is_none() {
            self.waiting = self.listener.accept().ok();
        }
        Ok(())
    }

    /// Who is to be served next, having come before this client was seen to be gone.
    pub(super) fn into_next(self) -> Option<(TcpStream, SocketAddr)> {
        self.waiting
    }

    fn carry_out(
        &mut self,
        command: u32,
        id: u32,
        request: Request,
        event: &mut impl FnMut(ServerEvent),
    ) -> Result<(), End> {
        if !self.greeted {
            let Request::Connect { version, udp_port } = request else { return Err(End::Nonsense) };
            return self.greet(command, id, version, udp_port, event);
        }
        let done = |result: Result<(), Refusal>| result.map_or_else(Answer::Refused, |()| Answer::Success);
        let answer = match request {
            Request::Connect { .. } => return Err(End::Nonsense),
            Request::Move(motion) => match self.unit.start(motion) {
                Ok(()) => {
                    self.command = None;
                    self.in_hand = Some(MoveInHand { id, end: None, stopped_by: None });
                    event(ServerEvent::MoveStarted(motion));
                    Answer::MotionStarted
                }
                Err(refusal) => Answer::MoveRefused(refusal),
            },
            Request::StopMove => {
                self.unit.stop();
                match &mut self.in_hand {
                    Some(in_hand) if in_hand.end.is_none() => {
                        in_hand.end = Some(MoveEnd::Stopped);
                        in_hand.stopped_by = Some(id);
                        return Ok(());
                    }
                    _ => Answer::Success,
                }
            }
            Request::Set(setting) => done(self.unit.set(setting)),
            Request::AutomaticErrorRecovery => done(self.unit.recover()),
            Request::GetCartesianLimit => {
                // No virtual wall: a box of no size, not active.
                let mut frame = [F64::new(0.0); 16];
                for diagonal in [0, 5, 10, 15] {
                    frame[diagonal] = F64::new(1.0);
                }
                let wall = v5::GetCartesianLimitResponse {
                    status: 0,
                    object_world_size: [F64::new(0.0); 3],
                    object_frame: frame,
                    object_activation: 0,
                };
                return self.answer(command, id, Answer::Success, &wall.as_bytes()[1..]);
            }
            Request::LoadModelLibrary { architecture, system } => {
                let (x64, linux) = (v5::LoadModelLibraryArchitecture::X64, v5::LoadModelLibrarySystem::Linux);
                let ours = architecture == x64.to_u8() && system == linux.to_u8();
                if self.model.is_empty() || !ours {
                    Answer::NoModelLibrary
                } else {
                    return self.answer(command, id, Answer::Success, self.model);
                }
            }
            Request::GetRobotModel => return self.answer(command, id, Answer::Success, self.model),
            Request::Invalid if command == v5::Command::Move.to_u32() => Answer::MoveRefused(Refusal::InvalidArgument),
            Request::Invalid => Answer::Refused(Refusal::InvalidArgument),
        };
        self.answer(command, id, answer, &[])
    }

    fn greet(
        &mut self,
        command: u32,
        id: u32,
        version: u16,
        udp_port: u16,
        event: &mut impl FnMut(ServerEvent),
    ) -> Result<(), End> {
        let own = self.settings.version.number();
        let status = u8::from(version != own);
        let [low, high] = own.to_le_bytes();
        self.send(command, id, &[status, low, high])?;
        if version != own {
            event(ServerEvent::OtherVersion(version));
            return Err(End::Gone);
        }
        let client = SocketAddr::new(self.stream.peer_addr()?.ip(), udp_port);
        // From now on only this client is heard.
        self.udp.connect(client)?;
        self.greeted = true;
        Ok(())
    }

    fn answer(&mut self, command: u32, id: u32, answer: Answer, more: &[u8]) -> Result<(), End> {
        let mut payload = Vec::with_capacity(1 + more.len());
        payload.push(answer.status(self.settings.version));
        payload.extend_from_slice(more);
        self.send(command, id, &payload)
    }

    fn send(&mut self, command: u32, id: u32, payload: &[u8]) -> Result<(), End> {
        let mut message = HeaderLayout::Robot.encode_header(command, id, payload.len());
        message.extend_from_slice(payload);
        // The longest, a model library, is longer than what the network takes at once.
        self.stream.set_nonblocking(false)?;
        let written = self.stream.write_all(&message);
        self.stream.set_nonblocking(true)?;
        Ok(written?)
    }
}
