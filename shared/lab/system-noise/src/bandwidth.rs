//! Memory bandwidth, measured by `stress-ng --memrate`.

use crate::measuring_program::{Error, MeasuringProgram};
use serde::{Deserialize, Serialize};

/// Suffix of a rate's key; its megabytes are of 2^20 bytes.
const RATE: &str = "-mb-per-sec";

/// Memory bandwidth on a number of threads: the best method of each kind, summed over the threads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bandwidth {
    /// Number of threads, each with a buffer of its own.
    pub n_threads: usize,
    /// Bandwidth of reading, 10^9 bytes per second.
    pub read_gb_per_s: f64,
    /// Bandwidth of writing, 10^9 bytes per second.
    pub write_gb_per_s: f64,
}

impl Bandwidth {
    /// Reads and writes 256 MB on each thread with each method, `n_rounds` times.
    pub(crate) fn measure(n_threads: usize, n_rounds: u32) -> Result<Self, Error> {
        let arguments = [
            "--metrics".to_owned(),
            "--memrate".to_owned(),
            n_threads.to_string(),
            "--memrate-bytes=256M".to_owned(),
            format!("--memrate-ops={n_rounds}"),
            "--timeout=60".to_owned(),
        ];
        let program = MeasuringProgram::STRESS_NG;
        let text = program.document(&arguments, "--yaml")?;
        Self::of(&text, n_threads).ok_or_else(|| program.document_error(&"it has no rates"))
    }

    fn of(text: &str, n_threads: usize) -> Option<Self> {
        let best = |kind: &str| {
            let rates = text.lines().filter_map(|line| {
                let (key, rate) = line.trim().split_once(": ")?;
                let is_rate = key.starts_with(kind) && key.ends_with(RATE);
                is_rate.then(|| rate.parse::<f64>().ok()).flatten()
            });
            let best = rates.reduce(f64::max)?;
            Some(best * n_threads as f64 * f64::from(1 << 20) / 1e9)
        };
        Some(Self {
            n_threads,
            read_gb_per_s: best("read")?,
            write_gb_per_s: best("write")?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn best_rate_counts_for_every_thread() {
        let text = "metrics:\n    - stressor: memrate\n      read8-mb-per-sec: 10.5\n      \
                    read64-mb-per-sec: 2000.0\n      write64nt-mb-per-sec: 1000.0\n";
        let found = Bandwidth::of(text, 2).unwrap();
        assert!((found.read_gb_per_s - 4.194_304).abs() < 1e-9);
        assert!((found.write_gb_per_s - 2.097_152).abs() < 1e-9);
        assert_eq!(Bandwidth::of("metrics:\n", 1), None);
    }
}
