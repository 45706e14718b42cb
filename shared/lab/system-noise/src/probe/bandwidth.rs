//! Memory bandwidth probe (after STREAM, John `McCalpin` 1995).

use crate::fingerprint::Fingerprint;
use crate::system_call::advise_huge_pages;
use serde::{Deserialize, Serialize};
use service::monotonic_ns;
use std::hint::black_box;
use std::io;
use std::sync::RwLock;
use std::thread::Builder;

/// Size of a cloud of 640 x 480 points, bytes.
const CLOUD_BYTES: usize = 640 * 480 * 16;
/// Size of a memory word, bytes.
const WORD_BYTES: usize = size_of::<u64>();
/// Minimum and maximum size of a buffer, and the size for an unknown cache, bytes.
const BUFFER_BYTES_MIN: u64 = 64 << 20;
const BUFFER_BYTES_MAX: u64 = 512 << 20;
const BUFFER_BYTES_UNTOLD: u64 = 256 << 20;

/// Memory operation of the bandwidth probe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MemoryOperation {
    /// Reads all words and sums them.
    Read,
    /// Fills the memory with a constant value.
    Write,
    /// Copy from one buffer to another; bytes read and bytes written both count.
    Copy,
    /// Sum of a cloud of 4.9 MB that the same thread has just written.
    ReadJustWritten,
}

impl MemoryOperation {
    /// Name of the memory operation for text reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Write => "write",
            Self::Copy => "copy",
            Self::ReadJustWritten => "read a cloud just written",
        }
    }
}

/// Bandwidth of a memory operation, 10^9 bytes per second.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bandwidth {
    /// Measured memory operation.
    pub operation: MemoryOperation,
    /// Number of threads, each with its part of the buffer.
    pub n_threads: usize,
    /// Bytes read or written per round.
    pub n_bytes: usize,
    /// Bandwidth of the best round.
    pub best_gb_per_s: f64,
    /// Bandwidth of each measurement round, 10^9 bytes per second.
    pub rounds_gb_per_s: Vec<f64>,
}

impl Bandwidth {
    fn new(
        operation: MemoryOperation,
        n_threads: usize,
        n_bytes: usize,
        rounds_ns: &[u64],
    ) -> Self {
        let rounds_gb_per_s: Vec<f64> = rounds_ns
            .iter()
            .map(|round_ns| n_bytes as f64 / (*round_ns).max(1) as f64)
            .collect();
        Self {
            operation,
            n_threads,
            n_bytes,
            best_gb_per_s: rounds_gb_per_s.iter().copied().fold(0.0, f64::max),
            rounds_gb_per_s,
        }
    }
}

/// Size of a buffer that defeats the caches, bytes: four times the last-level cache, at most an
/// eighth of the memory.
pub fn buffer_bytes(fingerprint: &Fingerprint) -> usize {
    let wanted = match fingerprint.last_level_cache_bytes {
        Some(cache) => (4 * cache).clamp(BUFFER_BYTES_MIN, BUFFER_BYTES_MAX),
        None => BUFFER_BYTES_UNTOLD,
    };
    let most = fingerprint.memory_total_bytes.map_or(wanted, |all| all / 8);
    wanted.min(most) as usize
}

/// Source and target buffer with resident pages.
#[derive(Debug)]
pub struct BandwidthBuffers {
    source: Vec<u64>,
    target: Vec<u64>,
}

impl BandwidthBuffers {
    /// Buffers of `n_bytes` each, on pages of the kernel's choice.
    pub fn new(n_bytes: usize) -> Self {
        let words = || vec![1; n_bytes / WORD_BYTES];
        Self {
            source: words(),
            target: words(),
        }
    }

    /// Buffers of `n_bytes` each on huge pages, requested before the first page is touched.
    ///
    /// # Errors
    /// If the kernel has no huge pages.
    pub fn on_huge_pages(n_bytes: usize) -> io::Result<Self> {
        let words = || {
            let mut words = Vec::with_capacity(n_bytes / WORD_BYTES);
            advise_huge_pages(words.spare_capacity_mut())?;
            words.resize(n_bytes / WORD_BYTES, 1);
            Ok::<_, io::Error>(words)
        };
        Ok(Self {
            source: words()?,
            target: words()?,
        })
    }

    /// Measures reading, writing and copying on `n_threads` threads for `n_rounds` rounds.
    ///
    /// # Errors
    /// If a thread cannot be started.
    pub fn measure(&mut self, n_threads: usize, n_rounds: usize) -> io::Result<Vec<Bandwidth>> {
        let operations = [
            MemoryOperation::Read,
            MemoryOperation::Write,
            MemoryOperation::Copy,
        ];
        let measured = operations.map(|operation| {
            let rounds_ns: io::Result<Vec<u64>> = (0..n_rounds)
                .map(|_| self.round_ns(operation, n_threads))
                .collect();
            let n_buffers = if operation == MemoryOperation::Copy {
                2
            } else {
                1
            };
            let n_bytes = n_buffers * self.source.len() * WORD_BYTES;
            Ok(Bandwidth::new(operation, n_threads, n_bytes, &rounds_ns?))
        });
        measured.into_iter().collect()
    }

    /// Duration of a round, from the first thread's start to the last thread's end, ns.
    fn round_ns(&mut self, operation: MemoryOperation, n_threads: usize) -> io::Result<u64> {
        let n_words = self.source.len().div_ceil(n_threads.max(1)).max(1);
        let parts = self.source.chunks(n_words);
        let parts: Vec<_> = parts.zip(self.target.chunks_mut(n_words)).collect();
        if let [_] = parts.as_slice() {
            return Ok(span_ns(
                parts.into_iter().map(|part| timed(operation, part)),
            ));
        }
        // Start gate: the threads start together after the last one was spawned.
        let gate = RwLock::new(());
        std::thread::scope(|scope| {
            let closed = gate.write();
            let start = |part| {
                let gate = &gate;
                let work = move || {
                    drop(gate.read());
                    timed(operation, part)
                };
                Builder::new().spawn_scoped(scope, work)
            };
            let threads: io::Result<Vec<_>> = parts.into_iter().map(start).collect();
            drop(closed);
            let times = threads?.into_iter().filter_map(|thread| thread.join().ok());
            Ok(span_ns(times))
        })
    }
}

/// Measures reading a cloud that this thread has just written.
pub fn read_just_written(n_rounds: usize) -> Bandwidth {
    let mut cloud = vec![0_u64; CLOUD_BYTES / WORD_BYTES];
    let rounds_ns: Vec<u64> = (0..n_rounds)
        .map(|round| {
            black_box(&mut cloud).fill(round as u64);
            let (start_ns, end_ns) = timed(MemoryOperation::Read, (&cloud, &mut []));
            end_ns - start_ns
        })
        .collect();
    Bandwidth::new(MemoryOperation::ReadJustWritten, 1, CLOUD_BYTES, &rounds_ns)
}

/// Start and end time of one thread's work, ns.
fn timed(operation: MemoryOperation, (source, target): (&[u64], &mut [u64])) -> (u64, u64) {
    let start_ns = monotonic_ns();
    match operation {
        MemoryOperation::Read | MemoryOperation::ReadJustWritten => {
            let words = black_box(source).iter();
            black_box(words.fold(0_u64, |sum, word| sum.wrapping_add(*word)));
        }
        MemoryOperation::Write => black_box(target).fill(start_ns),
        MemoryOperation::Copy => black_box(target).copy_from_slice(black_box(source)),
    }
    (start_ns, monotonic_ns())
}

/// Duration from the first start to the last end, ns.
fn span_ns(times: impl Iterator<Item = (u64, u64)>) -> u64 {
    let (first_ns, last_ns) = times.fold((u64::MAX, 0), |(first, last), (start, end)| {
        (start.min(first), end.max(last))
    });
    last_ns.saturating_sub(first_ns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_read_and_written_are_counted() {
        let mut buffers = BandwidthBuffers::new(1 << 20);
        for n_threads in [1, 3] {
            let measured = buffers.measure(n_threads, 2).unwrap();
            let bytes: Vec<usize> = measured.iter().map(|b| b.n_bytes).collect();
            assert_eq!(bytes, [1 << 20, 1 << 20, 2 << 20]);
            for one in &measured {
                assert_eq!((one.rounds_gb_per_s.len(), one.n_threads), (2, n_threads));
                assert!(one.rounds_gb_per_s.contains(&one.best_gb_per_s));
            }
        }
        // The copy ran last, so all parts of the target are filled.
        assert_eq!(buffers.target, buffers.source);
        assert_eq!(read_just_written(3).rounds_gb_per_s.len(), 3);
    }

    #[test]
    fn rounds_span_all_threads() {
        assert_eq!(span_ns([(10, 20), (5, 12)].into_iter()), 15);
        assert_eq!(span_ns(std::iter::empty()), 0);
    }
}
