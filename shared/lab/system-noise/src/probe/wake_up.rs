//! Wake-up latency probe: a futex ping-pong between two threads.

use crate::samples::Samples;
use rustix::thread::Timespec;
use rustix::thread::futex::{self, Flags};
use service::monotonic_ns;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Pause before each ping, so that both threads fall asleep.
const PAUSE: Duration = Duration::from_micros(200);
/// Longest futex wait, so that no thread waits for one that has failed.
const WAIT_MAX: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 100_000_000,
};
/// Maximum number of wake-up samples.
const SAMPLES_MAX: usize = 20_000;

const PING: u32 = 1;
const PONG: u32 = 2;

/// Shared state of the two threads: the current turn and its start time.
#[derive(Debug, Default)]
struct PingPong {
    turn: AtomicU32,
    since_ns: AtomicU64,
    is_over: AtomicBool,
}

/// Signal that the other thread has finished.
#[derive(Debug)]
struct Finished;

impl PingPong {
    /// Passes the turn and wakes the waiting thread.
    fn pass_turn(&self, turn: u32) {
        self.since_ns.store(monotonic_ns(), Ordering::Relaxed);
        self.turn.store(turn, Ordering::Release);
        let _ = futex::wake(&self.turn, Flags::PRIVATE, 1);
    }

    /// Waits for a turn; wake-up latency if this thread really slept, ns.
    fn await_turn(&self, turn: u32) -> Result<Option<u64>, Finished> {
        let mut has_slept = false;
        loop {
            let present = self.turn.load(Ordering::Acquire);
            if present == turn {
                let now_ns = monotonic_ns();
                let since_ns = self.since_ns.load(Ordering::Relaxed);
                return Ok(has_slept.then(|| now_ns.saturating_sub(since_ns)));
            }
            if self.is_over.load(Ordering::Acquire) {
                return Err(Finished);
            }
            let waited = futex::wait(&self.turn, Flags::PRIVATE, present, Some(&WAIT_MAX));
            has_slept |= waited.is_ok();
        }
    }
}

/// Stops the other thread on drop, also on panic.
struct FinishGuard<'a>(&'a PingPong);

impl Drop for FinishGuard<'_> {
    fn drop(&mut self) {
        self.0.is_over.store(true, Ordering::Release);
        let _ = futex::wake(&self.0.turn, Flags::PRIVATE, 1);
    }
}

/// Measures the wake-up latency of two threads that wake each other through a futex; both sleep
/// in between. The second thread has the scheduling and affinity of the calling one.
///
/// # Errors
/// If a thread cannot be started.
pub fn wake_up_latency(duration: Duration) -> io::Result<Samples> {
    let end = Instant::now() + duration;
    let ping_pong = PingPong::default();
    let latencies_ns = std::thread::scope(|scope| {
        let ping_pong = &ping_pong;
        let finish_guard = FinishGuard(ping_pong);
        let pong = std::thread::Builder::new().spawn_scoped(scope, || pong(ping_pong))?;
        let mut latencies_ns = ping(ping_pong, end);
        drop(finish_guard);
        latencies_ns.extend(pong.join().unwrap_or_default());
        Ok::<_, io::Error>(latencies_ns)
    })?;
    Ok(Samples::new(
        "wake-up",
        "from one thread's call to wake another (futex) until that one runs",
        latencies_ns,
    ))
}

fn ping(ping_pong: &PingPong, end: Instant) -> Vec<u64> {
    let mut latencies_ns = Vec::with_capacity(SAMPLES_MAX / 2);
    while Instant::now() < end && latencies_ns.len() < SAMPLES_MAX / 2 {
        std::thread::sleep(PAUSE);
        ping_pong.pass_turn(PONG);
        match ping_pong.await_turn(PING) {
            Ok(latency_ns) => latencies_ns.extend(latency_ns),
            Err(Finished) => break,
        }
    }
    latencies_ns
}

fn pong(ping_pong: &PingPong) -> Vec<u64> {
    let _end = FinishGuard(ping_pong);
    let mut latencies_ns = Vec::with_capacity(SAMPLES_MAX / 2);
    while let Ok(latency_ns) = ping_pong.await_turn(PONG) {
        // Each ping is answered once, so the counts are equal.
        latencies_ns.extend(latency_ns);
        ping_pong.pass_turn(PING);
    }
    latencies_ns
}
