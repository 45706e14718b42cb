//! Demonstrations: a whole table is taught and cleared, twice with the same bytes, and not again.

use crate::daemon::Sandbox;
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Stdio};

/// Seed of the table.
const SEED: &str = "5";
/// Files of a table that repeat.
const REPEATED: [&str; 4] = ["seed-5.json", "seed-5.png", "seed-5.svg", "seed-5.txt"];

/// Plays one table with two objects and a standard item.
fn start(sandbox: &Sandbox, out: &Path) -> Child {
    let words = [
        "--json",
        "demo",
        "clear-table",
        "--seed",
        SEED,
        "--seeds",
        "1",
    ];
    let mut command = sandbox.command("tabula");
    command
        .args(words)
        .args(["--objects", "3", "--out"])
        .arg(out);
    command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn document(demo: Child) -> Value {
    let output = demo.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn demonstration_of_clearing_the_table_repeats_to_the_byte() {
    let sandbox = Sandbox::new();
    let outs = ["first", "second"].map(|name| sandbox.home().join(name));
    // Beside each other: what else the computer does changes nothing.
    let demos = outs.each_ref().map(|out| start(&sandbox, out));
    let [first, second] = demos.map(document);
    assert_eq!(first, second);
    for name in REPEATED {
        let [a, b] = outs
            .each_ref()
            .map(|out| std::fs::read(out.join(name)).unwrap());
        assert!(!a.is_empty() && a == b, "{name} differs");
    }
    let run = &first["runs"][0];
    println!("{run:#}");
    assert_eq!(run["phase"], "succeeded");
    assert_eq!(
        (&run["n_objects"], &run["n_in_place"]),
        (&2.into(), &2.into())
    );
    assert_eq!(first["collisions"], 0);
    assert_eq!(first["standard_items_moved"], 0);
    assert_eq!(run["n_taught"], 3);
    assert!(run["scores"].as_array().unwrap().len() > 50);
    let page = std::fs::read_to_string(outs[0].join("index.html")).unwrap();
    assert!(page.contains("seed-5.png") && page.contains("seed-5.svg"));

    // Its record is kept: the same command plays nothing, and tells the same.
    let record = outs[0].join(REPEATED[0]);
    let written = std::fs::metadata(&record).unwrap().modified().unwrap();
    assert_eq!(document(start(&sandbox, &outs[0])), first);
    assert_eq!(
        std::fs::metadata(&record).unwrap().modified().unwrap(),
        written
    );
}
