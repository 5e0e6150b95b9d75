//! Bytes that are no messages, clients that vanish, stalls: the server lives on, the arm stays within its limits, and the next
//! client works.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::time::Duration;

use franka::wire::HeaderLayout;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use tribo_fci::{CyclicCommand, FciVersion, Pace, Request};

use crate::served::served;

/// A session of the wire itself: greeted, with its UDP socket.
struct RawClient {
    stream: TcpStream,
    udp: UdpSocket,
}

impl RawClient {
    fn greeted(address: SocketAddr, version: FciVersion) -> std::io::Result<Self> {
        let udp = UdpSocket::bind("127.0.0.1:0")?;
        udp.set_read_timeout(Some(Duration::from_millis(200)))?;
        let mut stream = TcpStream::connect(address)?;
        stream.set_read_timeout(Some(Duration::from_millis(200)))?;
        let mut payload = version.number().to_le_bytes().to_vec();
        payload.extend(udp.local_addr()?.port().to_le_bytes());
        send(&mut stream, 0, 1, &payload)?;
        let mut answer = [0; 15];
        stream.read_exact(&mut answer)?;
        Ok(Self { stream, udp })
    }

    /// Number of the next state, as its bytes, and where it comes from.
    fn server(&self) -> std::io::Result<([u8; 8], SocketAddr)> {
        let (mut state, mut number) = ([0; 4096], [0; 8]);
        let (_, address) = self.udp.recv_from(&mut state)?;
        number.copy_from_slice(&state[..8]);
        Ok((number, address))
    }
}

fn send(stream: &mut TcpStream, command: u32, id: u32, payload: &[u8]) -> std::io::Result<()> {
    let mut message = HeaderLayout::Robot.encode_header(command, id, payload.len());
    message.extend_from_slice(payload);
    stream.write_all(&message)
}

/// Changes some bytes, cuts or lengthens, or puts in values that are none.
fn mutate(rng: &mut Pcg64, bytes: &mut Vec<u8>) {
    for _ in 0..rng.random_range(1..6) {
        match rng.random_range(0..5) {
            0 if !bytes.is_empty() => {
                let at = rng.random_range(0..bytes.len());
                bytes[at] = rng.random();
            }
            1 => bytes.truncate(rng.random_range(0..=bytes.len())),
            2 => bytes.extend((0..rng.random_range(1..40)).map(|_| rng.random::<u8>())),
            3 if bytes.len() >= 8 => {
                let at = rng.random_range(0..=bytes.len() - 8);
                let value = [f64::NAN, f64::INFINITY, -1e300, 1e-310, -0.0][rng.random_range(0..5)];
                bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
            }
            _ => rng.fill_bytes(bytes),
        }
    }
}

/// Half a million mutated requests and as many mutated commands through both readers.
#[test]
fn no_bytes_break_the_readers() {
    let mut rng = Pcg64::seed_from_u64(3);
    let mut understood = 0;
    for round in 0..500_000_u32 {
        let version = if round % 2 == 0 { FciVersion::V5 } else { FciVersion::V10 };
        let mut payload = vec![0; rng.random_range(0..430)];
        if round % 3 == 0 {
            for value in payload.chunks_exact_mut(8) {
                value.copy_from_slice(&rng.random_range(-1.0..50.0_f64).to_le_bytes());
            }
        }
        mutate(&mut rng, &mut payload);
        understood += u32::from(Request::decode(version, rng.random_range(0..16), &payload).is_some());
        let mut command = vec![0; version.command_bytes()];
        mutate(&mut rng, &mut command);
        let read = CyclicCommand::decode(version, &command);
        assert_eq!(read.is_some(), command.len() == version.command_bytes());
    }
    assert!(understood > 50_000, "most mutations must get past the first check: {understood}");
}

/// Mutated messages on the wire, in and out of motions; the arm never leaves its limits and a proper client works after each. `TRIBO_WIRE_SESSIONS` asks for more
/// of them.
#[test]
fn rubbish_on_the_wire_hurts_nobody() {
    let sessions: u32 = std::env::var("TRIBO_WIRE_SESSIONS").ok().and_then(|text| text.parse().ok()).unwrap_or(60);
    for (version, pace) in [(FciVersion::V5, Pace::Lockstep), (FciVersion::V10, Pace::RealTime)] {
        let server = served(version, pace, 21);
        let mut rng = Pcg64::seed_from_u64(5);
        let (mut datagrams, mut messages) = (0_u32, 0_u32);
        for round in 0..sessions {
            let Ok(mut client) = RawClient::greeted(server.address, version) else { continue };
            if round % 2 == 0 {
                // Torques alone, or with the zero velocities of version 5.
                let mut request = vec![0; if version == FciVersion::V5 { 56 } else { 113 }];
                request[..8].copy_from_slice(&[2, 0, 0, 0, if version == FciVersion::V5 { 1 } else { 4 }, 0, 0, 0]);
                let _ = send(&mut client.stream, 1, 2, &request);
            }
            for _ in 0..40 {
                let Ok((number, address)) = client.server() else { break };
                let mut command = vec![0; version.command_bytes()];
                mutate(&mut rng, &mut command);
                if command.len() >= 8 && rng.random() {
                    command[..8].copy_from_slice(&number);
                }
                // Late ones too, as many as a socket holds.
                for _ in 0..5 {
                    datagrams += u32::from(client.udp.send_to(&command, address).is_ok());
                }
            }
            for id in 0..200 {
                let mut payload = vec![0; rng.random_range(0..430)];
                mutate(&mut rng, &mut payload);
                messages += u32::from(send(&mut client.stream, rng.random_range(0..16), id, &payload).is_ok());
            }
            drop(client);
        }
        println!("version {}: {datagrams} datagrams and {messages} messages were sent", version.number());
        assert!(datagrams > 10 * sessions && messages > 10 * sessions, "{datagrams}, {messages}");
        let robot = server.robot();
        let state = robot.read_once().unwrap();
        assert!(state.q.iter().all(|q| q.is_finite()) && state.dq.iter().all(|dq| dq.abs() < 0.1), "{:?}", state.dq);
        robot.automatic_error_recovery().unwrap();
        drop(robot);
        assert!(server.end().q().iter().all(|q| q.abs() < 3.0));
    }
}

/// A thousand clients that go at any moment of a session.
#[test]
fn a_thousand_clients_vanish() {
    let server = served(FciVersion::V5, Pace::Lockstep, 23);
    let mut rng = Pcg64::seed_from_u64(7);
    for _ in 0..1000 {
        match rng.random_range(0..4) {
            0 => drop(TcpStream::connect(server.address)),
            1 => {
                if let Ok(mut stream) = TcpStream::connect(server.address) {
                    let _ = stream.write_all(&[0; 7]);
                }
            }
            2 => drop(RawClient::greeted(server.address, FciVersion::V5)),
            _ => {
                if let Ok(mut client) = RawClient::greeted(server.address, FciVersion::V5) {
                    let mut request = [0; 56];
                    (request[0], request[4]) = (2, 1);
                    let _ = send(&mut client.stream, 1, 2, &request);
                }
            }
        }
    }
    assert!(server.robot().read_once().is_ok());
}
