//! Picture of a soak under systemd, from the lines that `tests/system/run PACKAGE --soak` prints:
//! recovery times as cumulative distributions, and the daemon's holdings over the frames.
//!
//!     cargo run -p tests --example soak_picture -- target/system-test/soak.log docs/guides/soak-systemd.svg
//!
//! Prints the table of the recovery times, too.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program")]

use plot::diagram::{self, Axis, Color, Curve, Diagram, Legend};
use std::collections::BTreeMap;

/// Range of the drawn times, seconds.
const RANGE_S: (f64, f64) = (0.05, 20.0);

/// Longest times after the faults of one kind without a good scene and without an
/// acknowledgement, seconds.
#[derive(Default)]
struct Pauses {
    scene_s: Vec<f64>,
    acknowledged_s: Vec<f64>,
}

/// Faults by name (`kill of camera`), and samples of the holdings: frames, resident memory in kB,
/// open files, threads, files in shared memory.
#[derive(Default)]
struct Soak {
    pauses: BTreeMap<String, Pauses>,
    holdings: Vec<[f64; 5]>,
}

impl Soak {
    /// Reads the log of a soak; other lines than those of faults and holdings are passed over.
    fn parse(log: &str) -> Self {
        let mut soak = Self::default();
        for line in log.lines() {
            let fields: Vec<&str> = line.split(',').collect();
            match fields[..] {
                ["fault", _, fault, process, scene, acknowledged] => {
                    let name = format!("{fault} of {process}");
                    let pauses = soak.pauses.entry(name).or_default();
                    pauses.scene_s.push(number(scene));
                    pauses.acknowledged_s.push(number(acknowledged));
                }
                ["holdings", _, frames, kb, files, threads, shared] => soak
                    .holdings
                    .push([frames, kb, files, threads, shared].map(number)),
                _ => {}
            }
        }
        for pauses in soak.pauses.values_mut() {
            pauses.scene_s.sort_by(f64::total_cmp);
            pauses.acknowledged_s.sort_by(f64::total_cmp);
        }
        soak
    }

    fn print_table(&self) {
        println!("| fault | n | without a good scene, p50, p99, max | next change acknowledged |");
        println!("|---|---|---|---|");
        for (name, pauses) in &self.pauses {
            println!(
                "| {name} | {} | {} | {} |",
                pauses.scene_s.len(),
                percentiles(&pauses.scene_s),
                percentiles(&pauses.acknowledged_s)
            );
        }
    }

    fn picture(&self) -> String {
        let recovery = |title, get: fn(&Pauses) -> &Vec<f64>| Diagram {
            title,
            x: Axis::logarithmic("longest pause after a fault, s", RANGE_S.0..RANGE_S.1),
            y: Axis::linear("share of the faults", 0.0..1.0),
            curves: self.distributions(get),
            legend: Legend::Outside,
        };
        let frames = self.holdings.last().map_or(1.0, |last| last[0]);
        let growth = Diagram {
            title: "Held by the daemon",
            x: Axis::linear("frames, thousands", 0.0..frames / 1000.0),
            y: Axis::linear("ratio to the first sample", 0.0..2.0),
            curves: self.growth(),
            legend: Legend::Outside,
        };
        let pictures = [
            recovery("Scenes", |pauses| &pauses.scene_s),
            recovery("Memory", |pauses| &pauses.acknowledged_s),
            growth,
        ];
        diagram::side_by_side(&pictures).expect("the picture is drawn")
    }

    fn distributions(&self, get: fn(&Pauses) -> &Vec<f64>) -> Vec<Curve<'_>> {
        self.pauses
            .iter()
            .enumerate()
            .map(|(index, (name, pauses))| curve_of(index, name, get(pauses)))
            .collect()
    }

    fn growth(&self) -> Vec<Curve<'_>> {
        let names = [
            "resident memory",
            "open files",
            "threads",
            "shared memory files",
        ];
        let curve = |(index, name)| Curve {
            name,
            color: Color::of_series(index),
            points: self
                .holdings
                .iter()
                .map(|sample| {
                    (
                        sample[0] / 1000.0,
                        sample[index + 1] / self.holdings[0][index + 1],
                    )
                })
                .collect(),
            is_marked: false,
        };
        names.into_iter().enumerate().map(curve).collect()
    }
}

/// Cumulative distribution of sorted times.
fn curve_of<'a>(index: usize, name: &'a str, sorted_s: &[f64]) -> Curve<'a> {
    let n = sorted_s.len() as f64;
    let step = |(i, time): (usize, &f64)| {
        let time = time.clamp(RANGE_S.0, RANGE_S.1);
        [(time, i as f64 / n), (time, (i + 1) as f64 / n)]
    };
    Curve {
        name,
        color: Color::of_series(index),
        points: sorted_s.iter().enumerate().flat_map(step).collect(),
        is_marked: false,
    }
}

/// Median, 99th percentile (nearest rank) and maximum of sorted times.
fn percentiles(sorted_s: &[f64]) -> String {
    let rank = |share: f64| sorted_s[((share * sorted_s.len() as f64).ceil() as usize).max(1) - 1];
    format!("{:.2}, {:.2}, {:.2} s", rank(0.5), rank(0.99), rank(1.0))
}

fn number(field: &str) -> f64 {
    field.parse().expect("a soak prints numbers")
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [log, picture] = &arguments[..] else {
        eprintln!("usage: soak_picture SOAK_LOG PICTURE.svg");
        std::process::exit(2);
    };
    let log = std::fs::read_to_string(log).expect("the log of the soak can be read");
    let soak = Soak::parse(&log);
    soak.print_table();
    std::fs::write(picture, soak.picture()).expect("the picture can be written");
}
