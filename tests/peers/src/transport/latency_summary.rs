//! What was measured of one system with one payload in one mode.

use crate::answer::{Answer, BadAnswer};

/// One turn: a pair of processes.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// Of each message, until the receiver can read it.
    pub latency_ns: Vec<u64>,
    /// Of each message, reading one byte in each 4 kB of it.
    pub touch_ns: Vec<u64>,
    /// Of each message, processor time of writing it.
    pub fill_ns: Vec<u64>,
    /// Processor time a message, writing it left out.
    pub sender_ns: f64,
    pub receiver_ns: f64,
    pub n_lost: u64,
}

impl Turn {
    /// What sender and receiver have answered.
    pub fn new(sender: &Answer, receiver: &Answer) -> Result<Self, BadAnswer> {
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

/// All turns of one case and system, in microseconds.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    pub p50_us: f64,
    pub p90_us: f64,
    pub p99_us: f64,
    pub p999_us: f64,
    pub max_us: f64,
    pub touch_us: f64,
    pub fill_us: f64,
    pub sender_us: f64,
    pub receiver_us: f64,
    pub n_messages: usize,
    pub n_lost: u64,
}

impl Figures {
    /// Medians of the turns; p99.9 and the longest are those of all messages.
    pub fn new(turns: &[Turn]) -> Self {
        let of_turns = |series: fn(&Turn) -> &[u64], share: f64| {
            median(turns.iter().map(|turn| quantile_us(series(turn), share)))
        };
        let latency = |share| of_turns(|turn| &turn.latency_ns, share);
        let all: Vec<u64> = turns.iter().flat_map(|t| &t.latency_ns).copied().collect();
        Self {
            p50_us: latency(0.5),
            p90_us: latency(0.9),
            p99_us: latency(0.99),
            p999_us: quantile_us(&all, 0.999),
            max_us: quantile_us(&all, 1.0),
            touch_us: of_turns(|turn| &turn.touch_ns, 0.5),
            fill_us: of_turns(|turn| &turn.fill_ns, 0.5),
            sender_us: median(turns.iter().map(|turn| turn.sender_ns / 1e3)),
            receiver_us: median(turns.iter().map(|turn| turn.receiver_ns / 1e3)),
            n_messages: all.len(),
            n_lost: turns.iter().map(|turn| turn.n_lost).sum(),
        }
    }
}

fn quantile_us(values_ns: &[u64], share: f64) -> f64 {
    quantile(values_ns.iter().map(|&ns| ns as f64 / 1e3), share)
}

/// The value that `share` of all do not exceed; NaN of none.
pub fn quantile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let rank = (share * values.len() as f64).ceil() as usize;
    values.get(rank.max(1) - 1).copied().unwrap_or(f64::NAN)
}

pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantile_is_the_value_that_so_many_do_not_exceed() {
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

    fn turn(latency_ns: &[u64]) -> Turn {
        Turn {
            latency_ns: latency_ns.to_vec(),
            touch_ns: vec![1_000],
            fill_ns: vec![2_000],
            sender_ns: 3_000.0,
            receiver_ns: 4_000.0,
            n_lost: 1,
        }
    }

    #[test]
    fn one_disturbed_turn_moves_the_longest_only() {
        let quiet = turn(&[1_000, 2_000, 3_000]);
        let disturbed = turn(&[70_000, 80_000, 90_000]);
        let figures = Figures::new(&[quiet.clone(), disturbed, quiet]);
        assert_eq!(figures.p50_us, 2.0);
        assert_eq!(figures.p90_us, 3.0);
        assert_eq!(figures.max_us, 90.0);
        assert_eq!((figures.n_messages, figures.n_lost), (9, 3));
        let others = [figures.touch_us, figures.fill_us, figures.sender_us];
        assert_eq!(others, [1.0, 2.0, 3.0]);
    }

    #[test]
    fn writing_the_payload_is_not_the_senders_cost() {
        let sender = Answer::parse("cpu_ns 1000\nfill_ns 100 200\nend\n").unwrap();
        let receiver = "cpu_ns 90\nlost 1\nlatency_ns 5 6 7\ntouch_ns 1 1 1\nend\n";
        let receiver = Answer::parse(receiver).unwrap();
        let turn = Turn::new(&sender, &receiver).unwrap();
        assert_eq!((turn.sender_ns, turn.receiver_ns), (350.0, 30.0));
        assert_eq!((&turn.latency_ns[..], turn.n_lost), (&[5, 6, 7][..], 1));
        assert!(Turn::new(&receiver_without_latency(), &sender).is_err());
    }

    fn receiver_without_latency() -> Answer {
        Answer::parse("cpu_ns 90\nend\n").unwrap()
    }
}
