//! `tabula config reload`: reload by the running daemon, and the outcome in each process.

use command_line::Output;
use control_client::ask_once;
use control_protocol::{ReloadReport, request};
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code};
use std::process::ExitCode;

/// JSON document of `tabula config reload`.
#[derive(Serialize)]
struct ReloadDocument {
    processes: Vec<ReloadReport>,
}

/// Runs `tabula config reload`.
pub(super) fn run(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let processes = ask_once(common, &request::reload_configuration())?;
    if processes.is_empty() {
        let sentence = "no process of the daemon takes requests to reload; see its log";
        return Err(Failure::general(sentence));
    }
    let is_refused = processes.iter().any(|report| report.refused.is_some());
    let is_unanswered = processes.iter().any(|report| report.is_unanswered);
    let document = ReloadDocument { processes };
    output.answer(&document, || text(&document.processes));
    Ok(match (is_refused, is_unanswered) {
        (true, _) => ExitCode::from(exit_code::REFUSED),
        (false, true) => ExitCode::from(exit_code::TIMED_OUT),
        (false, false) => ExitCode::SUCCESS,
    })
}

fn text(reports: &[ReloadReport]) -> String {
    let lines = reports.iter().flat_map(lines);
    lines.collect::<Vec<_>>().join("\n")
}

/// Lines of one process: each change, or that there is none.
fn lines(report: &ReloadReport) -> Vec<String> {
    let ReloadReport {
        process,
        pid,
        refused,
        is_unanswered,
        applied,
        needs_restart,
    } = report;
    let line = |text: String| format!("{process} ({pid}): {text}");
    if let Some(sentence) = refused {
        return vec![line(format!("refused, nothing is applied: {sentence}"))];
    }
    if *is_unanswered {
        let text = "has not answered, and may still apply it; `tabula doctor` tells the outcome";
        return vec![line(text.to_owned())];
    }
    let applied = applied.iter().map(|change| format!("applied {change}"));
    let waiting = needs_restart
        .iter()
        .map(|change| format!("needs restart for {change}"));
    let mut lines: Vec<String> = applied.chain(waiting).map(line).collect();
    if lines.is_empty() {
        lines.push(line("nothing to apply".to_owned()));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_protocol::KeyChange;

    #[test]
    fn every_change_has_a_line_with_its_process() {
        let change = |key: &str| KeyChange {
            key: key.into(),
            from: "1".into(),
            to: "2".into(),
        };
        let report = ReloadReport {
            process: "perception".into(),
            pid: 7,
            applied: vec![change("perception.a")],
            needs_restart: vec![change("perception.b")],
            refused: None,
            is_unanswered: false,
        };
        let quiet = ReloadReport {
            process: "run".into(),
            pid: 8,
            ..ReloadReport::default()
        };
        let refusing = ReloadReport {
            refused: Some("it is wrong".into()),
            ..quiet.clone()
        };
        let late = ReloadReport {
            is_unanswered: true,
            ..quiet.clone()
        };
        assert_eq!(
            text(&[report, quiet, refusing, late]),
            "perception (7): applied perception.a 1 -> 2\n\
             perception (7): needs restart for perception.b 1 -> 2\n\
             run (8): nothing to apply\n\
             run (8): refused, nothing is applied: it is wrong\n\
             run (8): has not answered, and may still apply it; `tabula doctor` tells the outcome"
        );
    }
}
