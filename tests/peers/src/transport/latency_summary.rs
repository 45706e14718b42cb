//! Latency statistics of one benchmark case: quantiles over messages and process pairs.

use crate::child_report::{ChildReport, ReportError};

/// Measurements of one process pair.
#[derive(Debug, Clone, PartialEq)]
pub struct PairRun {
    /// Latency of each message from sending until it is readable, nanoseconds.
    pub latency_ns: Vec<u64>,
    /// Time to read one byte per 4 kB of each message, nanoseconds.
    pub touch_ns: Vec<u64>,
    /// Processor time of writing each payload, nanoseconds.
    pub fill_ns: Vec<u64>,
    /// Processor time of the sender per message without writing the payload, nanoseconds.
    pub sender_ns: f64,
    /// Processor time of the receiver per message, nanoseconds.
    pub receiver_ns: f64,
    /// Number of overwritten messages.
    pub n_lost: u64,
}

impl PairRun {
    /// Measurements from the reports of sender and receiver.
    ///
    /// # Errors
    /// If a series is missing.
    pub fn new(sender: &ChildReport, receiver: &ChildReport) -> Result<Self, ReportError> {
        let fill_ns = sender.series("fill_ns")?;
        let latency_ns = receiver.series("latency_ns")?;
        let fills_ns: u64 = fill_ns.iter().sum();
        let n_sent = fill_ns.len() as f64;
        Ok(Self {
            latency_ns: latency_ns.to_vec(),
            touch_ns: receiver.series("touch_ns")?.to_vec(),
            sender_ns: sender.figure("cpu_ns")?.saturating_sub(fills_ns) as f64 / n_sent,
            receiver_ns: receiver.figure("cpu_ns")? as f64 / latency_ns.len() as f64,
            n_lost: receiver.figure("lost")?,
            fill_ns: fill_ns.to_vec(),
        })
    }
}

/// Summary of all runs of a case; times in microseconds.
#[derive(Debug, Clone, PartialEq)]
pub struct LatencySummary {
    /// Median latency.
    pub p50_us: f64,
    /// 90th percentile of the latency.
    pub p90_us: f64,
    /// 99th percentile of the latency.
    pub p99_us: f64,
    /// 99.9th percentile of the latency of all messages.
    pub p999_us: f64,
    /// Maximum latency of all messages.
    pub max_us: f64,
    /// Median time to touch the pages of a message.
    pub touch_us: f64,
    /// Median processor time of writing a payload.
    pub fill_us: f64,
    /// Processor time of the sender per message, without writing the payload.
    pub sender_us: f64,
    /// Processor time of the receiver per message.
    pub receiver_us: f64,
    /// Number of measured messages that were received.
    pub n_messages: usize,
    /// Number of overwritten messages.
    pub n_lost: u64,
}

impl LatencySummary {
    /// Medians over the runs; p99.9 and the maximum are over all messages.
    pub fn new(runs: &[PairRun]) -> Self {
        let of_runs = |series: fn(&PairRun) -> &[u64], share: f64| {
            median(runs.iter().map(|run| quantile_us(series(run), share)))
        };
        let latency = |share| of_runs(|run| &run.latency_ns, share);
        let all: Vec<u64> = runs.iter().flat_map(|t| &t.latency_ns).copied().collect();
        Self {
            p50_us: latency(0.5),
            p90_us: latency(0.9),
            p99_us: latency(0.99),
            p999_us: quantile_us(&all, 0.999),
            max_us: quantile_us(&all, 1.0),
            touch_us: of_runs(|run| &run.touch_ns, 0.5),
            fill_us: of_runs(|run| &run.fill_ns, 0.5),
            sender_us: median(runs.iter().map(|run| run.sender_ns / 1e3)),
            receiver_us: median(runs.iter().map(|run| run.receiver_ns / 1e3)),
            n_messages: all.len(),
            n_lost: runs.iter().map(|run| run.n_lost).sum(),
        }
    }
}

/// Quantile of nanoseconds at `share`, in microseconds.
fn quantile_us(values_ns: &[u64], share: f64) -> f64 {
    quantile(values_ns.iter().map(|&ns| ns as f64 / 1e3), share)
}

/// Quantile by nearest rank: the smallest value that at least `share` (0 to 1) of all do not exceed.
///
/// NaN if there are no values.
pub fn quantile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let rank = (share * values.len() as f64).ceil() as usize;
    values.get(rank.max(1) - 1).copied().unwrap_or(f64::NAN)
}

/// Median by nearest rank (the lower one of an even number); NaN if there are no values.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantile_uses_the_nearest_rank() {
        let values: Vec<f64> = (1..=1000).rev().map(f64::from).collect();
        for (share, expected) in [(0.5, 500.0), (0.9, 900.0), (0.999, 999.0), (1.0, 1000.0)] {
            assert_eq!(quantile(values.iter().copied(), share), expected);
            let n = values.iter().filter(|&&value| value <= expected).count();
            assert_eq!(n as f64, share * 1000.0);
        }
        assert_eq!(quantile([7.0], 0.99), 7.0);
        assert_eq!(median([3.0, 1.0, 2.0]), 2.0);
        assert!(median([]).is_nan());
    }

    fn run(latency_ns: &[u64]) -> PairRun {
        PairRun {
            latency_ns: latency_ns.to_vec(),
            touch_ns: vec![1_000],
            fill_ns: vec![2_000],
            sender_ns: 3_000.0,
            receiver_ns: 4_000.0,
            n_lost: 1,
        }
    }

    #[test]
    fn one_disturbed_run_changes_only_the_maximum() {
        let quiet = run(&[1_000, 2_000, 3_000]);
        let disturbed = run(&[70_000, 80_000, 90_000]);
        let figures = LatencySummary::new(&[quiet.clone(), disturbed, quiet]);
        assert_eq!(figures.p50_us, 2.0);
        assert_eq!(figures.p90_us, 3.0);
        assert_eq!(figures.max_us, 90.0);
        assert_eq!((figures.n_messages, figures.n_lost), (9, 3));
        let others = [figures.touch_us, figures.fill_us, figures.sender_us];
        assert_eq!(others, [1.0, 2.0, 3.0]);
    }

    #[test]
    fn sender_cost_excludes_writing_the_payload() {
        let sender = ChildReport::parse("cpu_ns 1000\nfill_ns 100 200\nend\n").unwrap();
        let receiver = "cpu_ns 90\nlost 1\nlatency_ns 5 6 7\ntouch_ns 1 1 1\nend\n";
        let receiver = ChildReport::parse(receiver).unwrap();
        let run = PairRun::new(&sender, &receiver).unwrap();
        assert_eq!((run.sender_ns, run.receiver_ns), (350.0, 30.0));
        assert_eq!((&run.latency_ns[..], run.n_lost), (&[5, 6, 7][..], 1));
        assert!(PairRun::new(&receiver_without_latency(), &sender).is_err());
    }

    fn receiver_without_latency() -> ChildReport {
        ChildReport::parse("cpu_ns 90\nend\n").unwrap()
    }
}
