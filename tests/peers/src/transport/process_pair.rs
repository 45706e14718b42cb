//! Process pair of one run: this program starts itself twice, as sender and as receiver.

use crate::benchmark_case::BenchmarkCase;
use crate::child_report::{ChildReport, ReportError};
use crate::ipc_namespace::{IpcNamespace, OwnedIpcNamespace};
use crate::latency_recorder::LatencyRecorder;
use crate::latency_summary::PairRun;
use crate::payload::PayloadWriter;
use crate::{clock, ports};
use rustix::process::{Signal, set_parent_process_death_signal};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use std::error::Error;
use std::fmt::Display;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

/// Option of the sending child process.
pub const SEND: &str = "--send";
/// Option of the receiving child process.
pub const RECEIVE: &str = "--receive";
/// Line that a child prints once its ports exist.
const READY: &str = "ready\n";
/// Longest interval between messages that the sender spends spinning. Chosen: a process that spins
/// longer is preempted just when it has to send.
const LONGEST_SPIN: Duration = Duration::from_millis(1);
/// Watchdog of a child process: its partner is lost if it runs longer. Chosen.
const CHILD_TIMEOUT: Duration = Duration::from_secs(20);

/// Runs sender and receiver of a case in a namespace of their own.
///
/// # Errors
/// If a child cannot be started, or fails.
pub fn run_pair(case: &BenchmarkCase) -> Result<PairRun, Box<dyn Error>> {
    let own = OwnedIpcNamespace::new()?;
    let mut sender = ChildProcess::start(SEND, case, &own.namespace)?;
    let mut receiver = ChildProcess::start(RECEIVE, case, &own.namespace)?;
    sender.release()?;
    let sent = sender.read_report()?;
    let received = receiver.read_report()?;
    receiver.end();
    sender.end();
    Ok(PairRun::new(&sent, &received)?)
}

/// Child process with its pipes; dropping it kills the process.
struct ChildProcess {
    /// System and role, for error messages.
    name: String,
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl ChildProcess {
    /// Starts a child and waits until it is ready.
    ///
    /// # Errors
    /// If it cannot be started or ends before it is ready.
    fn start(end: &str, case: &BenchmarkCase, namespace: &IpcNamespace) -> io::Result<Self> {
        let mut child = Command::new(std::env::current_exe()?)
            .arg(end)
            .arg(&namespace.folder)
            .args(case.arguments())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let pipes = (child.stdin.take(), child.stdout.take());
        let (input, Some(output)) = pipes else {
            return Err(io::Error::other("a child without pipes"));
        };
        let mut process = Self {
            name: format!("{} {end}", case.system.name()),
            child,
            input,
            output: BufReader::new(output),
        };
        let mut line = String::new();
        process.output.read_line(&mut line)?;
        if line == READY {
            Ok(process)
        } else {
            Err(process.failed(&"ended before it was ready"))
        }
    }

    /// Releases the child from its start barrier: it waits for a byte.
    fn release(&mut self) -> io::Result<()> {
        self.input
            .as_mut()
            .map_or(Ok(()), |input| input.write_all(b"\n"))
    }

    /// Reads the child's report. The child keeps running.
    ///
    /// # Errors
    /// If the report is truncated or malformed.
    fn read_report(&mut self) -> io::Result<ChildReport> {
        let mut text = String::new();
        while self.output.read_line(&mut text)? > 0 {
            match ChildReport::parse(&text) {
                Err(ReportError::Truncated) => {}
                report => return report.map_err(|error| self.failed(&error)),
            }
        }
        Err(self.failed(&ReportError::Truncated))
    }

    /// Waits for the regular end of the child, in which it removes its ports.
    fn end(mut self) {
        drop(self.input.take());
        let _ = self.child.wait();
    }

    /// Error with the child's name.
    fn failed(&self, reason: &dyn Display) -> io::Error {
        io::Error::other(format!("{}: {reason}", self.name))
    }
}

impl Drop for ChildProcess {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Runs a child process to its end; `None` if its arguments are invalid.
pub fn run_child(end: &str, arguments: &[String]) -> Option<()> {
    let (folder, arguments) = arguments.split_first()?;
    let (namespace, case) = (
        IpcNamespace::at(PathBuf::from(folder))?,
        BenchmarkCase::parse(arguments)?,
    );
    exit_with_parent();
    if case.is_polled() {
        pin(end == SEND);
    }
    match end {
        SEND => send(&case, &namespace),
        RECEIVE => receive(&case, &namespace),
        _ => return None,
    }
    Some(())
}

/// Ends this process when its parent dies, or by a watchdog when its partner does.
fn exit_with_parent() {
    let _ = set_parent_process_death_signal(Some(Signal::KILL));
    std::thread::spawn(|| {
        std::thread::sleep(CHILD_TIMEOUT);
        eprintln!("transport: no message for too long");
        std::process::exit(3);
    });
}

/// Pins sender and receiver to different processors; best effort.
///
/// Two processes that never sleep could otherwise share one, where each waits for the end of the
/// other's time slice.
fn pin(is_sender: bool) {
    let Ok(allowed) = sched_getaffinity(None) else {
        return;
    };
    let mut processors = (0..CpuSet::MAX_CPU).filter(|&n| allowed.is_set(n));
    let (first, last) = (processors.next(), processors.next_back());
    let mut own = CpuSet::new();
    if let Some(processor) = if is_sender { first } else { last } {
        own.set(processor);
        let _ = sched_setaffinity(None, &own);
    }
}

/// Prints and flushes, because the output is a pipe.
fn print_flushed(text: impl Display) {
    print!("{text}");
    let _ = io::stdout().flush();
}

/// Waits for a byte from the parent, or the end of its pipe.
fn wait_for_parent() {
    let _ = io::stdin().read(&mut [0]);
}

/// Sending child: sends all messages at the rate of the case, then prints its report.
fn send(case: &BenchmarkCase, namespace: &IpcNamespace) {
    let mut sender = ports::sender(case, namespace);
    print_flushed(READY);
    wait_for_parent();
    sender.connect();
    let mut writer = PayloadWriter::default();
    let mut cpu_begin_ns = 0;
    let interval_ns = case.interval.as_nanos() as u64;
    let spins = case.interval < LONGEST_SPIN;
    let mut next_ns = clock::now_ns();
    for number in 0..case.n_all() {
        clock::wait_until(next_ns, spins);
        if number == case.n_warm_up {
            cpu_begin_ns = clock::process_ns();
        }
        next_ns = clock::now_ns() + interval_ns;
        sender.send(number, &mut writer);
    }
    let cpu_ns = clock::process_ns() - cpu_begin_ns;
    let report = ChildReport::default().with("cpu_ns", [cpu_ns]);
    print_flushed(report.with("fill_ns", writer.into_cpu_ns_after(case.n_warm_up)));
    // The ports must exist until the receiver has the last message.
    wait_for_parent();
}

/// Receiving child: receives all messages, then prints its report.
fn receive(case: &BenchmarkCase, namespace: &IpcNamespace) {
    let receiver = ports::receiver(case, namespace);
    print_flushed(READY);
    print_flushed(receiver.receive(LatencyRecorder::new(*case)).into_report());
}
