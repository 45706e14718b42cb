//! Demonstration at tables: a person teaches every object, then instructs.

use super::demo_table::DemoTable;
use super::play::Play;
use super::report;
use super::run_record::{DemoKind, RunRecord, RunSettings};
use crate::arguments::DemoArguments;
use crate::output_files::{create_folder, write};
use command_line::{Output, StopSignal, progress_bar};
use service::Failure;
use std::path::Path;
use std::process::ExitCode;

/// Plays all tables, and writes the report.
pub(super) fn run(
    kind: DemoKind,
    arguments: &DemoArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    create_folder(&arguments.out)?;
    let stop = StopSignal::install()?;
    let settings = RunSettings {
        kind,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        models: arguments.models.to_string(),
        variant: arguments.variant,
        objects: arguments.objects,
    };
    let bar = progress_bar(u64::from(arguments.seeds), "tables", output);
    let mut records = Vec::new();
    for seed in (arguments.seed..).take(arguments.seeds as usize) {
        let path = arguments.out.join(format!("seed-{seed}.json"));
        let record = match kept(&path, &settings) {
            Some(record) => record,
            None => play(seed, &settings, arguments, (&stop, output))?,
        };
        records.push(record);
        bar.inc(1);
    }
    bar.finish_and_clear();
    report::publish(&records, &settings, &arguments.out, output)
}

/// Record of a table that was played before with the same settings.
fn kept(path: &Path, settings: &RunSettings) -> Option<RunRecord> {
    let text = std::fs::read_to_string(path).ok()?;
    let record: RunRecord = serde_json::from_str(&text).ok()?;
    (record.settings == *settings).then_some(record)
}

/// Plays one table, and writes its record and its contact sheet.
fn play(
    seed: u64,
    settings: &RunSettings,
    arguments: &DemoArguments,
    (stop, output): (&StopSignal, &Output),
) -> Result<RunRecord, Failure> {
    let table = DemoTable::new(seed, settings.kind, arguments)?;
    let mut play = Play::new(&table, arguments, (stop, output))?;
    while !play.frame()? {}
    let out = &arguments.out;
    if let Some(sheet) = play.sheet.png()? {
        write(&out.join(format!("seed-{seed}.png")), &sheet)?;
    }
    let captions = play.sheet.captions().join("\n");
    write(&out.join(format!("seed-{seed}.txt")), captions.as_bytes())?;
    let record = play.record(settings.clone());
    let json = serde_json::to_string_pretty(&record).map_err(Failure::general)?;
    write(&out.join(format!("seed-{seed}.json")), json.as_bytes())?;
    Ok(record)
}
