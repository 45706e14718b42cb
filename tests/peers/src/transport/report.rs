//! Report of the transport benchmark as a text table or as JSON.

use crate::benchmark_case::{ReceiveMode, System};
use crate::latency_summary::LatencySummary;
use serde_json::{Value, json};
use std::fmt::Write;

/// Summary of one benchmark case.
pub struct SummaryRow {
    /// Transport under test.
    pub system: System,
    /// Waiting strategy of the receiver.
    pub mode: ReceiveMode,
    /// Size of the payload, bytes.
    pub payload_bytes: usize,
    /// Latency statistics.
    pub figures: LatencySummary,
}

impl SummaryRow {
    /// Ratio of the median latency to the reference system's; NaN if that was not measured.
    fn ratio(&self, rows: &[Self]) -> f64 {
        let is_reference = |row: &&Self| {
            let case = (row.mode, row.payload_bytes);
            row.system == System::REFERENCE && case == (self.mode, self.payload_bytes)
        };
        let reference = rows.iter().find(is_reference);
        reference.map_or(f64::NAN, |row| self.figures.p50_us / row.figures.p50_us)
    }

    /// Processor times of sender and receiver, microseconds per message; `None` if polling, which takes
    /// a whole processor.
    fn cpu_us(&self) -> Option<[f64; 2]> {
        let cpu_us = [self.figures.sender_us, self.figures.receiver_us];
        (self.mode == ReceiveMode::Blocking).then_some(cpu_us)
    }
}

/// Column titles.
const TABLE_HEADER: &str = "mode      bytes    system                    p50 µs      ×     p90 µs     p99 µs   p99.9 µs     max µs   touch µs    fill µs  cpu sender  cpu recv  lost\n";

/// Text table with one row per case.
pub fn table(rows: &[SummaryRow]) -> String {
    let mut text = String::from(TABLE_HEADER);
    for row in rows {
        let f = &row.figures;
        let begin = if row.system == System::REFERENCE {
            "\n"
        } else {
            ""
        };
        let (mode, bytes, system) = (row.mode.name(), row.payload_bytes, row.system.name());
        let _ = write!(text, "{begin}{mode:<9} {bytes:<8} {system:<20}");
        let _ = write!(text, "{:>12.2} {:>6.2}", f.p50_us, row.ratio(rows));
        let others = [
            f.p90_us, f.p99_us, f.p999_us, f.max_us, f.touch_us, f.fill_us,
        ];
        for figure in others {
            let _ = write!(text, "{figure:>11.2}");
        }
        let _ = match row.cpu_us() {
            Some([sender, receiver]) => write!(text, "{sender:>12.1}{receiver:>10.1}"),
            None => write!(text, "{:>12}{:>10}", "-", "-"),
        };
        let _ = writeln!(text, "{:>6}", f.n_lost);
    }
    text
}

/// JSON object with an array of one object per row.
pub fn json(rows: &[SummaryRow]) -> Value {
    let object = |row: &SummaryRow| {
        let f = &row.figures;
        let cpu_us = row.cpu_us();
        json!({
            "system": row.system.name(),
            "payload_bytes": row.payload_bytes,
            "mode": row.mode.name(),
            "p50_us": f.p50_us,
            "p90_us": f.p90_us,
            "p99_us": f.p99_us,
            "p999_us": f.p999_us,
            "max_us": f.max_us,
            "ratio_to_raw": row.ratio(rows),
            "touch_us": f.touch_us,
            "fill_us": f.fill_us,
            "cpu_us_sender": cpu_us.map(|[sender, _]| sender),
            "cpu_us_receiver": cpu_us.map(|[_, receiver]| receiver),
            "messages": f.n_messages,
            "lost": f.n_lost,
        })
    };
    json!({ "transport": rows.iter().map(object).collect::<Value>() })
}
