//! Faults of the chaos test, and their injection.

use crate::daemon::{Daemon, eventually, send_signal, suspend};
use crate::full_disk::Rubbish;
use crate::hostile_clients::HostileClients;
use message::ProcessKind;
use rustix::process::Signal;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Time for which a fault lasts that has an end of its own.
const LASTS: Duration = Duration::from_secs(3);
/// Turns of a starved process: it rests for nine tenths of the time.
const STARVED: (Duration, Duration) = (Duration::from_millis(450), Duration::from_millis(50));
/// Time for which a process is starved, longer than the watchdog's.
const STARVED_FOR: Duration = Duration::from_secs(8);
const N_HOSTILE: usize = 100;

/// Fault of a daemon with a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fault {
    /// SIGKILL of a process.
    Kill(ProcessKind),
    /// SIGSTOP of a process, which the watchdog has to find.
    Stop(ProcessKind),
    /// A process that gets a tenth of the time.
    Starve(ProcessKind),
    /// Clients that misbehave in all known ways.
    HostileClients,
    /// A disk without room, for some seconds.
    FullDisk,
    /// A disk without room, and the memory is killed meanwhile.
    FullDiskAndKill,
    /// A sparse file of another program in shared memory that claims more than there is.
    SparseSharedMemory,
}

impl Fault {
    /// Faults that any user can inject.
    pub(super) const FOR_ALL: [Self; 8] = [
        Self::Kill(ProcessKind::Memory),
        Self::Kill(ProcessKind::Perception),
        Self::Kill(ProcessKind::Camera),
        Self::Stop(ProcessKind::Memory),
        Self::Stop(ProcessKind::Perception),
        Self::Stop(ProcessKind::Camera),
        Self::HostileClients,
        Self::SparseSharedMemory,
    ];
    /// Faults by starvation.
    pub(super) const STARVATION: [Self; 3] = [
        Self::Starve(ProcessKind::Memory),
        Self::Starve(ProcessKind::Perception),
        Self::Starve(ProcessKind::Camera),
    ];
    /// Faults that need a file system of their own, so root.
    pub(super) const FOR_ROOT: [Self; 2] = [Self::FullDisk, Self::FullDiskAndKill];

    /// Name in reports.
    pub(super) fn name(self) -> String {
        match self {
            Self::Kill(process) => format!("kill {}", process.name()),
            Self::Stop(process) => format!("stop {}", process.name()),
            Self::Starve(process) => format!("starve {}", process.name()),
            Self::HostileClients => "hostile clients".into(),
            Self::FullDisk => "full disk".into(),
            Self::FullDiskAndKill => "full disk, kill memory".into(),
            Self::SparseSharedMemory => "sparse shared memory".into(),
        }
    }

    /// Injects the fault and returns when it is over or when it has been found; the time of
    /// detection of a stopped process.
    pub(super) fn inject(self, daemon: &Daemon<'_>) -> Option<Duration> {
        match self {
            Self::Kill(process) => daemon.signal(process, Signal::KILL),
            Self::Stop(process) => return Some(stop(daemon, process)),
            Self::Starve(process) => starve(daemon, process),
            Self::HostileClients => {
                let sandbox = daemon.sandbox;
                let socket = sandbox.run_folder().control_socket(&sandbox.domain);
                let clients = HostileClients::start(N_HOSTILE, &socket);
                std::thread::sleep(LASTS);
                clients.stop();
            }
            Self::FullDisk => {
                let _rubbish = Rubbish::fill(daemon);
                std::thread::sleep(LASTS);
            }
            Self::FullDiskAndKill => {
                let _rubbish = Rubbish::fill(daemon);
                daemon.signal(ProcessKind::Memory, Signal::KILL);
                std::thread::sleep(LASTS);
            }
            Self::SparseSharedMemory => {
                let file = tempfile::NamedTempFile::new_in("/dev/shm").unwrap();
                file.as_file().set_len(1 << 40).unwrap();
                daemon.signal(ProcessKind::Camera, Signal::KILL);
                std::thread::sleep(LASTS);
            }
        }
        None
    }
}

/// Stops a process until the watchdog has ended it; the time that this took.
fn stop(daemon: &Daemon<'_>, process: ProcessKind) -> Duration {
    let pid = daemon.pid(process).expect("the process reports its id");
    let begin = Instant::now();
    suspend(pid);
    // Not by the log, which tells of repeated ends ever more sparsely.
    let folder = PathBuf::from(format!("/proc/{pid}"));
    eventually("the watchdog ends it", || !folder.exists());
    begin.elapsed()
}

/// Lets a process run for a tenth of the time; it must survive that.
fn starve(daemon: &Daemon<'_>, process: ProcessKind) {
    let pid = daemon.pid(process).expect("the process reports its id");
    let begin = Instant::now();
    while begin.elapsed() < STARVED_FOR {
        for (signal, time) in [(Signal::STOP, STARVED.0), (Signal::CONT, STARVED.1)] {
            let sent = send_signal(pid, signal);
            assert!(sent.is_ok(), "{process:?} ended while it was starved");
            std::thread::sleep(time);
        }
    }
    eventually("the starved process reports", || {
        daemon.pid(process).is_some()
    });
    assert_eq!(
        daemon.pid(process),
        Some(pid),
        "a starved process that makes progress was replaced\n{}",
        daemon.log()
    );
}
