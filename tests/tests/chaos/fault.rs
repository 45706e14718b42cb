//! Faults of the chaos test, and their injection.

use super::fake_clock;
use crate::daemon::{Daemon, eventually, send_signal, suspend};
use crate::full_disk::Rubbish;
use crate::hostile_clients::HostileClients;
use message::ProcessKind;
use rustix::process::Signal;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

/// Time for which a fault lasts that has an end of its own.
const LASTS: Duration = Duration::from_secs(3);
/// Turns of a starved process: it rests for nine tenths of the time.
const STARVED: (Duration, Duration) = (Duration::from_millis(450), Duration::from_millis(50));
/// Time for which a process is starved, longer than the watchdog's.
const STARVED_FOR: Duration = Duration::from_secs(8);
const N_HOSTILE: usize = 100;
/// Time after which a tracer that was asked to end is killed.
const TRACER_ENDS_IN: Duration = Duration::from_secs(1);

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
    /// Shared memory without room, for some seconds.
    FullSharedMemory,
    /// Shared memory without room, and a process is killed meanwhile.
    FullSharedMemoryAndKill(ProcessKind),
    /// A medium that takes nothing for some seconds (EIO).
    WriteErrors,
    /// A medium that cannot be read for some seconds (EIO).
    ReadErrors,
    /// The clock is set forward by hours, back by a day, and right again.
    ClockJumps,
}

impl Fault {
    /// Faults that any user can inject.
    pub(super) const FOR_ALL: [Self; 8] = [
        Self::Kill(ProcessKind::MEMORY),
        Self::Kill(ProcessKind::PERCEPTION),
        Self::Kill(ProcessKind::CAMERA),
        Self::Stop(ProcessKind::MEMORY),
        Self::Stop(ProcessKind::PERCEPTION),
        Self::Stop(ProcessKind::CAMERA),
        Self::HostileClients,
        Self::SparseSharedMemory,
    ];
    /// Faults by starvation.
    pub(super) const STARVATION: [Self; 3] = [
        Self::Starve(ProcessKind::MEMORY),
        Self::Starve(ProcessKind::PERCEPTION),
        Self::Starve(ProcessKind::CAMERA),
    ];
    /// Faults that need file systems of their own, so root.
    pub(super) const FOR_ROOT: [Self; 5] = [
        Self::FullDisk,
        Self::FullDiskAndKill,
        Self::FullSharedMemory,
        Self::FullSharedMemoryAndKill(ProcessKind::CAMERA),
        Self::FullSharedMemoryAndKill(ProcessKind::PERCEPTION),
    ];
    /// Faults that need strace, and the permission to trace.
    pub(super) const BY_STRACE: [Self; 2] = [Self::WriteErrors, Self::ReadErrors];

    /// Name in reports.
    pub(super) fn name(self) -> String {
        match self {
            Self::Kill(process) => format!("kill {}", process.word()),
            Self::Stop(process) => format!("stop {}", process.word()),
            Self::Starve(process) => format!("starve {}", process.word()),
            Self::HostileClients => "hostile clients".into(),
            Self::FullDisk => "full disk".into(),
            Self::FullDiskAndKill => "full disk, kill memory".into(),
            Self::SparseSharedMemory => "sparse shared memory".into(),
            Self::FullSharedMemory => "full shared memory".into(),
            Self::FullSharedMemoryAndKill(process) => {
                format!("full shared memory, kill {}", process.word())
            }
            Self::WriteErrors => "write errors".into(),
            Self::ReadErrors => "read errors".into(),
            Self::ClockJumps => "clock jumps".into(),
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
                daemon.signal(ProcessKind::MEMORY, Signal::KILL);
                std::thread::sleep(LASTS);
            }
            Self::SparseSharedMemory => {
                let file = tempfile::NamedTempFile::new_in("/dev/shm").unwrap();
                file.as_file().set_len(1 << 40).unwrap();
                daemon.signal(ProcessKind::CAMERA, Signal::KILL);
                std::thread::sleep(LASTS);
            }
            Self::FullSharedMemory => {
                let _full = full_shared_memory();
                std::thread::sleep(LASTS);
            }
            Self::FullSharedMemoryAndKill(process) => {
                let _full = full_shared_memory();
                daemon.signal(process, Signal::KILL);
                std::thread::sleep(LASTS);
            }
            Self::WriteErrors => fail_system_calls(daemon, "fdatasync,fsync", || {
                std::thread::sleep(LASTS);
            }),
            Self::ReadErrors => {
                // Makes tables of what is in memory.
                daemon.ask(&["memory", "compact"]);
                fail_system_calls(daemon, "pread64", || {
                    let verified = daemon.sandbox.tabula(&["memory", "verify"]);
                    assert!(!verified.status.success(), "{verified:?}");
                });
            }
            Self::ClockJumps => {
                for (jump, seconds) in [("+3h", 10_800.0), ("-1d", -86_400.0), ("+0", 0.0)] {
                    fake_clock::set(daemon.sandbox, jump);
                    eventually("the memory has the other clock", || {
                        (fake_clock::offset_s(daemon) - seconds).abs() < 60.0
                    });
                    std::thread::sleep(LASTS);
                }
            }
        }
        None
    }
}

/// File that takes all room of the shared memory, which is a test's own.
fn full_shared_memory() -> tempfile::NamedTempFile {
    let mut file = tempfile::NamedTempFile::new_in("/dev/shm").unwrap();
    for block in [1 << 20, 4096] {
        let block = vec![1; block];
        while file.write_all(&block).is_ok() {}
    }
    file
}

/// `true` if a process may be traced, so that its system calls can be made to fail.
pub(super) fn can_strace() -> bool {
    let traced = Command::new("strace")
        .args(["-qq", "-e", "trace=none", "true"])
        .output();
    traced.is_ok_and(|output| output.status.success())
}

/// Lets system calls of the memory fail with EIO during `work`; some of them must.
fn fail_system_calls(daemon: &Daemon<'_>, calls: &str, work: impl FnOnce()) {
    let pid = daemon.pid(ProcessKind::MEMORY).expect("it runs");
    let traced = tempfile::NamedTempFile::new().unwrap();
    let mut strace = Command::new("strace")
        .args(["-qq", "-f", "-p", &pid.to_string()])
        .args(["-e", &format!("trace={calls}")])
        .args(["-e", &format!("inject={calls}:error=EIO")])
        .arg("-o")
        .arg(traced.path())
        .spawn()
        .unwrap();
    eventually("the memory is traced", || {
        let status = std::fs::read_to_string(format!("/proc/{pid}/status"));
        let tracer = format!("TracerPid:\t{}\n", strace.id());
        status.is_ok_and(|status| status.contains(&tracer))
    });
    work();
    end_tracer(&mut strace);
    let traced = std::fs::read_to_string(traced.path()).unwrap();
    assert!(traced.contains("(INJECTED)"), "no call of {calls} failed");
}

/// Ends strace, which never returns when the process that it lets go is being killed just then.
fn end_tracer(strace: &mut Child) {
    let _ = send_signal(strace.id(), Signal::INT);
    let begin = Instant::now();
    while strace.try_wait().unwrap().is_none() {
        if begin.elapsed() > TRACER_ENDS_IN {
            strace.kill().unwrap();
        }
        std::thread::sleep(Duration::from_millis(10));
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
