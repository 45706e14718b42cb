//! The two processes of a turn, from both sides: this program starts itself twice,
//! as the sender and as the receiver.

use crate::answer::{Answer, BadAnswer};
use crate::figures::Turn;
use crate::log::Log;
use crate::payload::Fill;
use crate::place::{OwnPlace, Place};
use crate::plan::Task;
use crate::{clock, ports};
use rustix::process::{Signal, set_parent_process_death_signal};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use std::error::Error;
use std::fmt::Display;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

pub const SEND: &str = "--send";
pub const RECEIVE: &str = "--receive";
const READY: &str = "ready\n";
/// So long a sender spins; one that spins longer is taken from its processor when
/// it has something to send.
const SHORT_GAP: Duration = Duration::from_millis(1);
/// A child that takes longer has lost its other half.
const LONGEST_LIFE: Duration = Duration::from_secs(20);

/// Lets both do their part in a place of their own.
pub fn take_turn(task: &Task) -> Result<Turn, Box<dyn Error>> {
    let own = OwnPlace::new()?;
    let mut sender = Process::start(SEND, task, &own.place)?;
    let mut receiver = Process::start(RECEIVE, task, &own.place)?;
    sender.begin()?;
    let sent = sender.answer()?;
    let received = receiver.answer()?;
    receiver.end();
    sender.end();
    Ok(Turn::new(&sent, &received)?)
}

/// A child; dropping it kills it.
struct Process {
    what: String,
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Process {
    /// Returns when it is ready for the other.
    fn start(end: &str, task: &Task, place: &Place) -> io::Result<Self> {
        let mut child = Command::new(std::env::current_exe()?)
            .arg(end)
            .arg(&place.folder)
            .args(task.words())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let pipes = (child.stdin.take(), child.stdout.take());
        let (input, Some(output)) = pipes else {
            return Err(io::Error::other("a child without pipes"));
        };
        let mut process = Self {
            what: format!("{} {end}", task.system.name()),
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

    /// Lets it go on: it waits for a byte.
    fn begin(&mut self) -> io::Result<()> {
        self.input
            .as_mut()
            .map_or(Ok(()), |input| input.write_all(b"\n"))
    }

    /// What it says up to the last line of an answer. It goes on living.
    fn answer(&mut self) -> io::Result<Answer> {
        let mut text = String::new();
        while self.output.read_line(&mut text)? > 0 {
            match Answer::parse(&text) {
                Err(BadAnswer::Cut) => {}
                answer => return answer.map_err(|error| self.failed(&error)),
            }
        }
        Err(self.failed(&BadAnswer::Cut))
    }

    /// Lets it end by itself, so that it takes down its ports.
    fn end(mut self) {
        drop(self.input.take());
        let _ = self.child.wait();
    }

    fn failed(&self, why: &dyn Display) -> io::Error {
        io::Error::other(format!("{}: {why}", self.what))
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What a child does: `None` when its words are none of ours.
pub fn live_as_child(end: &str, words: &[String]) -> Option<()> {
    let (folder, words) = words.split_first()?;
    let (place, task) = (Place::at(PathBuf::from(folder))?, Task::parse(words)?);
    end_with_parent();
    if task.is_polled() {
        pin(end == SEND);
    }
    match end {
        SEND => send(&task, &place),
        RECEIVE => receive(&task, &place),
        _ => return None,
    }
    Some(())
}

/// Neither the parent's death nor that of the other child leaves this one behind.
fn end_with_parent() {
    let _ = set_parent_process_death_signal(Some(Signal::KILL));
    std::thread::spawn(|| {
        std::thread::sleep(LONGEST_LIFE);
        eprintln!("transport: no message for too long");
        std::process::exit(3);
    });
}

/// Two that never sleep get a processor each; otherwise the kernel may leave both
/// on one, where each waits for the other's time to be over.
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

fn say(what: impl Display) {
    print!("{what}");
    let _ = io::stdout().flush();
}

/// Waits for a byte from the parent, or the end of all of them.
fn wait_for_parent() {
    let _ = io::stdin().read(&mut [0]);
}

fn send(task: &Task, place: &Place) {
    let mut sender = ports::sender(task, place);
    say(READY);
    wait_for_parent();
    sender.connect();
    let mut fill = Fill::default();
    let mut cpu_begin_ns = 0;
    let gap_ns = task.gap.as_nanos() as u64;
    let spins = task.gap < SHORT_GAP;
    let mut next_ns = clock::now_ns();
    for number in 0..task.n_all() {
        clock::wait_until(next_ns, spins);
        if number == task.n_warm_up {
            cpu_begin_ns = clock::process_ns();
        }
        next_ns = clock::now_ns() + gap_ns;
        sender.send(number, &mut fill);
    }
    let cpu_ns = clock::process_ns() - cpu_begin_ns;
    let answer = Answer::default().with("cpu_ns", [cpu_ns]);
    say(answer.with("fill_ns", fill.without(task.n_warm_up)));
    // The ports live until the receiver has the last message.
    wait_for_parent();
}

fn receive(task: &Task, place: &Place) {
    let receiver = ports::receiver(task, place);
    say(READY);
    say(receiver.receive(Log::new(*task)).answer());
}
