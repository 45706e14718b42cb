//! `tabula status`: state of the daemon's processes, with those that should run and do not.

use crate::supervision::{ProcessRecord, RecordedState, read_records};
use command_line::{Output, format_table};
use control_client::ask_once;
use control_protocol::request;
use message::ProcessKind;
use scene_document::HealthDocument;
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code};
use std::process::ExitCode;

/// JSON document of `tabula status`.
#[derive(Serialize)]
struct StatusDocument {
    /// Reports of the processes.
    processes: Vec<HealthDocument>,
    /// Processes that should run in the domain; empty when neither `tabula run` nor systemd runs
    /// it.
    expected: Vec<ExpectedProcess>,
}

/// Process that should run, with the reason when it does not.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct ExpectedProcess {
    #[serde(flatten)]
    record: ProcessRecord,
    /// Sentence about a process that does not work; empty otherwise.
    pub(crate) trouble: String,
}

/// Runs `tabula status`.
pub(crate) fn run(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let records = read_records(&common.domain);
    let reports = reports(common);
    let expected = match (&records, &reports) {
        (None, Err(failure)) => return Err(failure.clone()),
        (None, Ok(_)) => Vec::new(),
        (Some(records), reports) => expected_processes(records, reports),
    };
    let document = StatusDocument {
        processes: reports.unwrap_or_default(),
        expected,
    };
    output.answer(&document, || status_text(&document));
    let is_complete = document.expected.iter().all(|one| one.trouble.is_empty());
    Ok(ExitCode::from(if is_complete {
        0
    } else {
        exit_code::NO_DAEMON
    }))
}

fn reports(common: &CommonArguments) -> Result<Vec<HealthDocument>, Failure> {
    ask_once(common, &request::health())
}

/// Processes that should run, compared with the reports of those that do. The gateway answers for
/// all, so without its answer only the record of the parent is known of the others.
pub(crate) fn expected_processes(
    records: &[ProcessRecord],
    reports: &Result<Vec<HealthDocument>, Failure>,
) -> Vec<ExpectedProcess> {
    let silent = |record: &ProcessRecord| match reports {
        Ok(reports) => {
            let is_reported = reports.iter().any(|report| Some(report.pid) == record.pid);
            let is_silent = record.state == RecordedState::Running && !is_reported;
            is_silent.then(|| {
                let process = &record.process;
                format!("tabula-{process} has sent no health report for 3 s")
            })
        }
        Err(failure) => (record.process == ProcessKind::GATEWAY.word()
            && record.state == RecordedState::Running)
            .then(|| format!("tabula-gateway does not answer: {failure}")),
    };
    let expected = |record: &ProcessRecord| ExpectedProcess {
        record: record.clone(),
        trouble: record
            .trouble()
            .or_else(|| silent(record))
            .unwrap_or_default(),
    };
    records.iter().map(expected).collect()
}

fn status_text(document: &StatusDocument) -> String {
    let heading = [
        "process",
        "pid",
        "state",
        "uptime s",
        "frames",
        "dropped",
        "late",
        "actors",
        "restarts",
        "resident MB",
        "note",
    ];
    let mut rows: Vec<Vec<String>> = document.processes.iter().map(row).collect();
    let is_reported = |expected: &&ExpectedProcess| {
        let name = &expected.record.process;
        document.processes.iter().any(|p| p.process == *name)
    };
    let unreported = document.expected.iter().filter(|one| !is_reported(one));
    rows.extend(unreported.map(unreported_row));
    let troubles = document.expected.iter().map(|one| one.trouble.as_str());
    let lines = std::iter::once(format_table(&heading, &rows)).chain(
        troubles
            .filter(|trouble| !trouble.is_empty())
            .map(str::to_owned),
    );
    lines.collect::<Vec<_>>().join("\n")
}

fn row(process: &HealthDocument) -> Vec<String> {
    vec![
        process.process.clone(),
        process.pid.to_string(),
        process.state.clone(),
        format!("{:.1}", process.uptime_s),
        process.frames.to_string(),
        process.frames_dropped.to_string(),
        process.frames_late.to_string(),
        process.actors.to_string(),
        process.restarts.to_string(),
        (process.resident_bytes / 1_000_000).to_string(),
        process.note.clone(),
    ]
}

/// Row of a process of which only the record of the parent is known.
fn unreported_row(expected: &ExpectedProcess) -> Vec<String> {
    let record = &expected.record;
    let state = match record.state {
        RecordedState::Starting => "starting",
        RecordedState::Running => "running",
        RecordedState::Stalled => "stalled",
        RecordedState::Failing => "failing",
        RecordedState::Stopped => "stopped",
    };
    let unknown = || "-".to_owned();
    let mut row = vec![
        record.process.clone(),
        record.pid.map_or_else(unknown, |pid| pid.to_string()),
        state.to_owned(),
    ];
    row.resize_with(10, unknown);
    row.push(String::new());
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::supervision::Supervisor;

    fn record(process: &str, pid: Option<u32>, state: RecordedState) -> ProcessRecord {
        ProcessRecord {
            process: process.into(),
            pid,
            state,
            since_ns: 1_700_000_000_000_000_000,
            n_ends: 3,
            cause: "signal: 9 (SIGKILL)".into(),
            supervisor: Supervisor::TabulaRun,
        }
    }

    fn report(process: &str, pid: u32) -> HealthDocument {
        HealthDocument {
            stamp_ns: 0,
            started_ns: 0,
            process: process.into(),
            pid,
            state: "ready".into(),
            uptime_s: 1.0,
            frames: 0,
            frames_dropped: 0,
            frames_late: 0,
            allocated_bytes: 0,
            resident_bytes: 0,
            shared_memory_bytes: 0,
            restarts: 0,
            actors: 0,
            abandoned: 0,
            note: String::new(),
        }
    }

    fn troubles(
        records: &[ProcessRecord],
        reports: &Result<Vec<HealthDocument>, Failure>,
    ) -> Vec<String> {
        let expected = expected_processes(records, reports).into_iter();
        expected.map(|one| one.trouble).collect()
    }

    #[test]
    fn expected_processes_that_report_are_well() {
        let records = [
            record("memory", Some(1), RecordedState::Running),
            record("camera", Some(2), RecordedState::Starting),
        ];
        let reports = Ok(vec![report("memory", 1)]);
        assert_eq!(troubles(&records, &reports), ["", ""]);
    }

    #[test]
    fn process_with_another_id_or_without_a_report_is_in_trouble() {
        let records = [record("camera", Some(2), RecordedState::Running)];
        for reports in [vec![], vec![report("camera", 9)]] {
            let troubles = troubles(&records, &Ok(reports));
            assert!(
                troubles[0].contains("tabula-camera has sent no"),
                "{troubles:?}"
            );
        }
    }

    #[test]
    fn failing_process_is_named_with_its_cause_though_its_replacement_reports() {
        let records = [record("camera", Some(2), RecordedState::Failing)];
        let troubles = troubles(&records, &Ok(vec![report("camera", 2)]));
        assert!(troubles[0].contains("SIGKILL"), "{troubles:?}");
    }

    #[test]
    fn gateway_that_does_not_answer_is_in_trouble_and_the_others_are_not() {
        let records = [
            record("gateway", Some(1), RecordedState::Running),
            record("camera", Some(2), RecordedState::Running),
        ];
        let troubles = troubles(&records, &Err(Failure::general("no answer within 5 s")));
        assert!(troubles[0].contains("no answer within 5 s"), "{troubles:?}");
        assert_eq!(troubles[1], "");
    }

    #[test]
    fn text_has_a_row_for_each_process_and_a_line_for_each_trouble() {
        let records = [
            record("memory", None, RecordedState::Failing),
            record("camera", Some(2), RecordedState::Running),
        ];
        let processes = vec![report("camera", 2)];
        let expected = expected_processes(&records, &Ok(processes.clone()));
        let document = StatusDocument {
            processes,
            expected,
        };
        let text = status_text(&document);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 4, "{text}");
        assert!(
            lines[1].contains("camera") && lines[1].contains("ready"),
            "{text}"
        );
        assert!(
            lines[2].contains("memory") && lines[2].contains("failing"),
            "{text}"
        );
        assert!(
            lines[3].starts_with("tabula-memory has not been working since"),
            "{text}"
        );
    }
}
