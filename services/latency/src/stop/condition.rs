//! Conditions under which the arm is stopped: dead and hung processes, clients, a busy machine.

use super::moving_arm::MovingArm;
use crate::results::not_written;
use channel::{DomainState, RunFolder};
use clap::ValueEnum;
use control_protocol::request;
use message::ProcessKind;
use rustix::process::{Pid, Signal, geteuid, kill_process};
use serde::Serialize;
use service::Failure;
use std::ffi::OsStr;
use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Number of clients of the conditions with clients.
const N_CLIENTS: usize = 1000;
/// Number of kills after which the memory is in back-off.
const N_KILLS: usize = 9;
/// Stack of a client's thread, bytes.
const STACK_BYTES: usize = 128 * 1024;
/// Time that a hostile client waits for an answer.
const PATIENCE: Duration = Duration::from_millis(500);
/// Maximum time until a killed process is there again.
const RESTART_TIMEOUT: Duration = Duration::from_secs(20);

/// Condition under which stops are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum StopCondition {
    /// Nothing else happens
    Quiet,
    /// The memory is suspended
    MemoryStopped,
    /// The memory is killed before each stop
    MemoryKilled,
    /// The memory waits for its next start after many kills
    MemoryBackOff,
    /// The disk of the memory is frozen (needs root)
    FrozenDisk,
    /// The configuration file is broken, and was to be read again
    BrokenConfiguration,
    /// `tabula run` is killed with the stop; the daemon ends, so there are a fiftieth of the stops
    ParentKilled,
    /// A thousand clients are connected and say nothing
    IdleClients,
    /// A thousand clients send garbage and requests
    HostileClients,
    /// Twice as many threads as cores compute
    BusyCores,
}

/// Reason for which a condition is not there.
#[derive(Debug)]
pub(crate) enum Unavailable {
    /// This computer or account cannot bring it about.
    Here(String),
    /// The measurement has failed.
    Failed(Failure),
}

impl From<Failure> for Unavailable {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure)
    }
}

impl StopCondition {
    /// All conditions.
    pub(crate) const ALL: [Self; 10] = [
        Self::Quiet,
        Self::MemoryStopped,
        Self::MemoryKilled,
        Self::MemoryBackOff,
        Self::FrozenDisk,
        Self::BrokenConfiguration,
        Self::ParentKilled,
        Self::IdleClients,
        Self::HostileClients,
        Self::BusyCores,
    ];

    /// Name for people.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Quiet => "quiet",
            Self::MemoryStopped => "memory stopped",
            Self::MemoryKilled => "memory killed",
            Self::MemoryBackOff => "memory in back-off",
            Self::FrozenDisk => "disk frozen",
            Self::BrokenConfiguration => "configuration broken",
            Self::ParentKilled => "tabula run killed",
            Self::IdleClients => "1000 idle clients",
            Self::HostileClients => "1000 hostile clients",
            Self::BusyCores => "all cores busy",
        }
    }

    /// Number of stops to measure.
    pub(crate) fn n_stops(self, wanted: u32) -> usize {
        let wanted = wanted as usize;
        if self.ends_the_daemon() {
            wanted.div_ceil(50)
        } else {
            wanted
        }
    }

    /// True if each stop needs a daemon of its own.
    pub(crate) fn ends_the_daemon(self) -> bool {
        self == Self::ParentKilled
    }

    /// Disk of its own for the daemon's memory, which can be frozen.
    pub(crate) fn mount_disk(self, home: &Path) -> Result<Option<FreezableDisk>, Unavailable> {
        (self == Self::FrozenDisk)
            .then(|| FreezableDisk::mount(home))
            .transpose()
    }
}

/// Condition that holds until drop, which must come before that of its daemon.
pub(crate) struct ConditionGuard {
    condition: StopCondition,
    suspended: Option<u32>,
    clients: Option<Clients>,
    disk: Option<FreezableDisk>,
}

impl ConditionGuard {
    /// Brings the condition about. `config` is the daemon's own configuration file, which may be
    /// broken.
    pub(crate) fn begin(
        condition: StopCondition,
        arm: &MovingArm,
        config: &Path,
        disk: Option<FreezableDisk>,
    ) -> Result<Self, Unavailable> {
        let mut guard = Self {
            condition,
            suspended: None,
            clients: None,
            disk,
        };
        let socket = || arm.folder().join("control.sock");
        match condition {
            StopCondition::MemoryStopped => {
                let memory = wait_for_memory(arm)?;
                send(memory, Signal::STOP);
                guard.suspended = Some(memory);
            }
            StopCondition::MemoryBackOff => {
                for _ in 0..N_KILLS {
                    send(wait_for_memory(arm)?, Signal::KILL);
                }
            }
            StopCondition::FrozenDisk => {
                if let Some(disk) = &mut guard.disk {
                    disk.freeze()?;
                }
            }
            StopCondition::BrokenConfiguration => {
                dataset::write_atomic(config, "[[[").map_err(not_written)?;
                let _ = arm.ask(&request::reload_configuration());
            }
            StopCondition::IdleClients => {
                guard.clients = Some(Clients::start(N_CLIENTS, &socket(), hold_connection));
            }
            StopCondition::HostileClients => {
                guard.clients = Some(Clients::start(N_CLIENTS, &socket(), misbehave));
            }
            StopCondition::BusyCores => {
                let n_cores = std::thread::available_parallelism().map_or(2, usize::from);
                guard.clients = Some(Clients::start(2 * n_cores, &socket(), compute));
            }
            StopCondition::Quiet | StopCondition::MemoryKilled | StopCondition::ParentKilled => {}
        }
        Ok(guard)
    }

    /// Does what the condition does at each stop.
    pub(crate) fn before_stop(&self, arm: &MovingArm) {
        let victim = match self.condition {
            StopCondition::MemoryKilled | StopCondition::MemoryBackOff => memory(arm),
            StopCondition::ParentKilled => Some(arm.daemon().process_id()),
            _ => None,
        };
        if let Some(pid) = victim {
            send(pid, Signal::KILL);
        }
    }
}

impl Drop for ConditionGuard {
    fn drop(&mut self) {
        if let Some(pid) = self.suspended {
            send(pid, Signal::CONT);
        }
    }
}

fn memory(arm: &MovingArm) -> Option<u32> {
    let state = DomainState::inspect(arm.daemon().domain(), &RunFolder::of_user());
    let name = ProcessKind::MEMORY.program();
    state
        .running
        .into_iter()
        .find_map(|(role, pid)| pid.filter(|_| role == name))
}

fn wait_for_memory(arm: &MovingArm) -> Result<u32, Failure> {
    let begun = Instant::now();
    while begun.elapsed() < RESTART_TIMEOUT {
        if let Some(pid) = memory(arm) {
            return Ok(pid);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    Err(Failure::general(
        "the memory of the daemon has not begun again within 20 s",
    ))
}

fn send(pid: u32, signal: Signal) {
    if let Some(process) = Pid::from_raw(pid.cast_signed()) {
        // One that has ended by itself needs no signal.
        let _ = kill_process(process, signal);
    }
}

/// Threads that do something until drop.
struct Clients {
    threads: Vec<JoinHandle<()>>,
    is_over: Arc<AtomicBool>,
}

impl Clients {
    fn start(n_threads: usize, socket: &Path, work: fn(usize, &Path, &AtomicBool)) -> Self {
        let is_over = Arc::new(AtomicBool::new(false));
        let thread = |number: usize| {
            let (is_over, socket) = (is_over.clone(), socket.to_owned());
            let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
            thread.spawn(move || {
                while !is_over.load(Ordering::Relaxed) {
                    work(number, &socket, &is_over);
                }
            })
        };
        let threads = (0..n_threads).filter_map(|number| thread(number).ok());
        Self {
            threads: threads.collect(),
            is_over,
        }
    }
}

impl Drop for Clients {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Holds one connection without a word.
fn hold_connection(_number: usize, socket: &Path, is_over: &AtomicBool) {
    let connection = UnixStream::connect(socket);
    while connection.is_ok() && !is_over.load(Ordering::Relaxed) {
        std::thread::sleep(PATIENCE);
    }
}

/// Connects, and sends garbage, half a message, or a request whose answer is not read. Stops and
/// commands of the arm are left out: they would end the motion that is measured.
fn misbehave(number: usize, socket: &Path, _is_over: &AtomicBool) {
    let Ok(mut stream) = UnixStream::connect(socket) else {
        std::thread::sleep(Duration::from_millis(10));
        return;
    };
    let _ = stream.set_read_timeout(Some(PATIENCE));
    let _ = stream.set_write_timeout(Some(PATIENCE));
    let sent: &[u8] = match number % 3 {
        0 => &[0x9f; 512],
        1 => &[0xff; 4],
        _ => b"\x22\x00\x00\x00\xa2hprotocol\x02gcommandgobjects",
    };
    // The daemon may close the connection at any time.
    let _ = stream.write_all(sent);
    let _ = stream.read(&mut [0; 64]);
}

/// Keeps a core busy.
fn compute(number: usize, _socket: &Path, _is_over: &AtomicBool) {
    let sum: u64 = (0..1_000_000_u64).fold(number as u64, |sum, i| sum.rotate_left(7) ^ i);
    std::hint::black_box(sum);
}

/// File system in a file, mounted at the perceptual memory of a home; root can freeze it.
pub(crate) struct FreezableDisk {
    _image: TempDir,
    folder: PathBuf,
    is_frozen: bool,
}

impl FreezableDisk {
    fn mount(home: &Path) -> Result<Self, Unavailable> {
        if !geteuid().is_root() {
            return Err(Unavailable::Here("only root can freeze a disk".to_owned()));
        }
        let here = |error: std::io::Error| Unavailable::Here(error.to_string());
        let image_folder = TempDir::with_prefix("tabula-disk-").map_err(here)?;
        let image = image_folder.path().join("disk.img");
        let folder = home.join("perceptual-memory");
        std::fs::create_dir_all(&folder).map_err(here)?;
        run_tool("truncate", ["--size=256M".as_ref(), image.as_os_str()])?;
        run_tool("mkfs.ext4", ["-q".as_ref(), image.as_os_str()])?;
        let loop_device = ["-o".as_ref(), "loop".as_ref()];
        let places = [image.as_os_str(), folder.as_os_str()];
        run_tool("mount", loop_device.into_iter().chain(places))?;
        // The store wants an empty folder.
        let _ = std::fs::remove_dir(folder.join("lost+found"));
        Ok(Self {
            _image: image_folder,
            folder,
            is_frozen: false,
        })
    }

    fn freeze(&mut self) -> Result<(), Unavailable> {
        run_tool("fsfreeze", ["--freeze".as_ref(), self.folder.as_os_str()])?;
        self.is_frozen = true;
        Ok(())
    }
}

impl Drop for FreezableDisk {
    fn drop(&mut self) {
        let folder = self.folder.as_os_str();
        if self.is_frozen {
            let _ = run_tool("fsfreeze", ["--unfreeze".as_ref(), folder]);
        }
        let _ = run_tool("umount", ["--lazy".as_ref(), folder]);
    }
}

/// Runs a program of the system; its failure is one of this computer.
fn run_tool<'a>(
    name: &str,
    arguments: impl IntoIterator<Item = &'a OsStr>,
) -> Result<(), Unavailable> {
    let ran = Command::new(name).args(arguments).output();
    match ran {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stderr);
            Err(Unavailable::Here(format!("{name}: {}", said.trim())))
        }
        Err(error) => Err(Unavailable::Here(format!("{name}: {error}"))),
    }
}
