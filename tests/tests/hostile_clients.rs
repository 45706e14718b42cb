//! Hostile clients of the same group: stop and health are answered all the same.

use crate::bad_input::framed;
use crate::daemon::{Sandbox, WATCHDOG};
use crate::simulation::{CARTON, scene_file};
use control_protocol::{ArmCommand, ArmLease, ArmMotion, Command, Request, WorldCommand, request};
use daemon_client::DaemonClient;
use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Kinds of misbehaviour, one for each client in turn.
const KINDS: [fn(&mut UnixStream) -> std::io::Result<()>; 8] = [
    say_nothing,
    send_half_a_message,
    send_garbage,
    announce_too_much,
    wait_for_events,
    ask_all_the_time,
    command_the_arm,
    stop_the_arm,
];

fn message(command: Command) -> Vec<u8> {
    let mut bytes = Vec::new();
    ciborium::into_writer(&Request::from(command), &mut bytes).unwrap();
    framed(&bytes)
}

fn say_nothing(stream: &mut UnixStream) -> std::io::Result<()> {
    stream.read(&mut [0; 64]).map(|_| ())
}

fn send_half_a_message(stream: &mut UnixStream) -> std::io::Result<()> {
    stream.write_all(&[0, 0, 4, 0])?;
    stream.write_all(&[0; 10_000])?;
    say_nothing(stream)
}

fn send_garbage(stream: &mut UnixStream) -> std::io::Result<()> {
    for _ in 0..20 {
        stream.write_all(&[0, 2, 0, 0])?;
        stream.write_all(&[0x9f; 512])?;
        say_nothing(stream)?;
    }
    Ok(())
}

fn announce_too_much(stream: &mut UnixStream) -> std::io::Result<()> {
    stream.write_all(&[0xff; 4])?;
    say_nothing(stream)
}

fn wait_for_events(stream: &mut UnixStream) -> std::io::Result<()> {
    stream.write_all(&message(Command::World(WorldCommand::Events {
        since: u64::MAX - 1,
        wait_ms: 30_000,
    })))?;
    say_nothing(stream)
}

fn ask_all_the_time(stream: &mut UnixStream) -> std::io::Result<()> {
    for command in [Command::Objects, Command::Categories, Command::Objects] {
        stream.write_all(&message(command))?;
        say_nothing(stream)?;
    }
    Ok(())
}

fn command_the_arm(stream: &mut UnixStream) -> std::io::Result<()> {
    static N_LEASES: AtomicU64 = AtomicU64::new(1);
    let lease = ArmLease {
        id: N_LEASES.fetch_add(1, Ordering::Relaxed),
        holder: "a hostile client".to_owned(),
    };
    let motion = ArmMotion::Home;
    stream.write_all(&message(Command::Arm(ArmCommand::Move { lease, motion })))?;
    say_nothing(stream)
}

fn stop_the_arm(stream: &mut UnixStream) -> std::io::Result<()> {
    stream.write_all(&message(Command::Arm(ArmCommand::Stop)))?;
    say_nothing(stream)
}

/// Clients that connect and misbehave until they are told to stop.
pub(crate) struct HostileClients {
    threads: Vec<JoinHandle<()>>,
    is_over: Arc<AtomicBool>,
    n_connections: Arc<AtomicU64>,
}

impl HostileClients {
    pub(crate) fn start(n_clients: usize, socket: &Path) -> Self {
        let is_over = Arc::new(AtomicBool::new(false));
        let n_connections = Arc::new(AtomicU64::new(0));
        let client = |number: usize| {
            let (is_over, n_connections) = (is_over.clone(), n_connections.clone());
            let socket = socket.to_owned();
            let misbehave = KINDS[number % KINDS.len()];
            let body = move || {
                while !is_over.load(Ordering::Relaxed) {
                    let Ok(mut stream) = UnixStream::connect(&socket) else {
                        continue;
                    };
                    let limit = Some(Duration::from_millis(500));
                    stream.set_read_timeout(limit).unwrap();
                    stream.set_write_timeout(limit).unwrap();
                    n_connections.fetch_add(1, Ordering::Relaxed);
                    // The daemon may close the connection at any time.
                    let _ = misbehave(&mut stream);
                }
            };
            let thread = std::thread::Builder::new().stack_size(128 * 1024);
            thread.spawn(body).unwrap()
        };
        Self {
            threads: (0..n_clients).map(client).collect(),
            is_over,
            n_connections,
        }
    }

    /// Stops the clients and returns how many connections they made.
    pub(crate) fn stop(self) -> u64 {
        self.is_over.store(true, Ordering::Relaxed);
        for thread in self.threads {
            thread.join().unwrap();
        }
        self.n_connections.load(Ordering::Relaxed)
    }
}

/// Urgent commands among hostile clients; prints the times of the answers.
fn check_urgent_commands(n_clients: usize, n_commands: usize) {
    let sandbox = Sandbox::new();
    let (_folder, source) = scene_file(CARTON);
    let daemon = sandbox.start(&["--source", &source]);
    let folders = [sandbox.run_folder()];
    let socket = sandbox.run_folder().control_socket(&sandbox.domain);
    let hostile = HostileClients::start(n_clients, &socket);
    let mut times_ms = Vec::new();
    for i in 0..n_commands {
        std::thread::sleep(Duration::from_millis(20));
        let is_stop = i % 2 == 0;
        let began = Instant::now();
        let answered = if is_stop {
            let stop = request::stop_arm();
            DaemonClient::ask_once(&sandbox.domain, &folders, WATCHDOG, &stop).map(drop)
        } else {
            let health = request::health();
            DaemonClient::ask_once(&sandbox.domain, &folders, WATCHDOG, &health).map(drop)
        };
        times_ms.push((is_stop, began.elapsed().as_secs_f64() * 1e3));
        assert!(answered.is_ok(), "{i}: {answered:?}\n{}", daemon.log());
    }
    let n_connections = hostile.stop();
    for (name, kind) in [("stop", true), ("health", false)] {
        let mut times: Vec<f64> = times_ms
            .iter()
            .filter(|t| t.0 == kind)
            .map(|t| t.1)
            .collect();
        times.sort_by(f64::total_cmp);
        let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
        println!(
            "{name} among {n_clients} hostile clients ({n_connections} connections): {} answers, \
             p50 {:.1} ms, p99 {:.1} ms, longest {:.1} ms",
            times.len(),
            at(0.5),
            at(0.99),
            at(1.0)
        );
    }
    daemon.wait_for("an object is tracked", |objects| !objects.is_empty());
    daemon.stop();
}

#[test]
fn stop_and_health_are_answered_among_a_hundred_hostile_clients() {
    check_urgent_commands(100, 20);
}

#[test]
#[ignore = "long"]
fn long_stop_and_health_are_answered_among_a_thousand_hostile_clients() {
    check_urgent_commands(1000, 60);
}
