//! Picture of a chaos test: cumulative distributions of the recovery times by kind of fault.

use super::Recovery;
use plot::diagram::{self, Axis, Color, Curve, Diagram, Legend};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

/// Range of the drawn times, seconds.
const RANGE_S: (f64, f64) = (0.01, 20.0);

/// Kind of a fault: the first word of its name, or two for a disk.
fn kind(name: &str) -> &'static str {
    const KINDS: [&str; 10] = [
        "kill",
        "stop",
        "starve",
        "hostile",
        "full disk",
        "sparse",
        "full shared memory",
        "write errors",
        "read errors",
        "clock",
    ];
    KINDS
        .into_iter()
        .find(|kind| name.starts_with(kind))
        .unwrap_or("other")
}

/// Writes `chaos.svg` into a folder.
pub(super) fn write(folder: &Path, recoveries: &BTreeMap<String, Vec<Recovery>>) {
    let mut by_kind: BTreeMap<&str, Vec<Recovery>> = BTreeMap::new();
    for (name, all) in recoveries {
        by_kind.entry(kind(name)).or_default().extend(all);
    }
    let diagram = |title, label, get: &dyn Fn(&Recovery) -> Duration| Diagram {
        title,
        x: Axis::logarithmic(label, RANGE_S.0..RANGE_S.1),
        y: Axis::linear("share of the faults", 0.0..1.0),
        curves: curves(&by_kind, get),
        legend: Legend::Outside,
    };
    let pictures = [
        diagram("Scene", "without a good scene, s", &|r| r.without_scene),
        diagram("Memory", "until a change is acknowledged, s", &|r| {
            r.until_acknowledged
        }),
    ];
    let svg = diagram::side_by_side(&pictures).unwrap();
    std::fs::create_dir_all(folder).unwrap();
    std::fs::write(folder.join("chaos.svg"), svg).unwrap();
}

/// Cumulative distribution of a time for each kind of fault.
fn curves<'a>(
    by_kind: &BTreeMap<&'a str, Vec<Recovery>>,
    get: &dyn Fn(&Recovery) -> Duration,
) -> Vec<Curve<'a>> {
    let curve = |(index, (name, all)): (usize, (&&'a str, &Vec<Recovery>))| {
        let mut times: Vec<f64> = all.iter().map(|r| get(r).as_secs_f64()).collect();
        times.sort_by(f64::total_cmp);
        let n = times.len() as f64;
        let step = |(i, time): (usize, &f64)| {
            let time = time.clamp(RANGE_S.0, RANGE_S.1);
            [(time, i as f64 / n), (time, (i + 1) as f64 / n)]
        };
        Curve {
            name,
            color: Color::of_series(index),
            points: times.iter().enumerate().flat_map(step).collect(),
            is_marked: false,
        }
    };
    by_kind.iter().enumerate().map(curve).collect()
}
