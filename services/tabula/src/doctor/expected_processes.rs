//! Check of `tabula doctor` on the processes that should run in the domain.

use super::checks::Asked;
use super::{Finding, Severity};
use crate::status::expected_processes;
use crate::supervision::{ProcessRecord, read_records};
use scene_document::HealthDocument;
use service::{CommonArguments, Failure};

const NAME: &str = "processes";

/// Finding: a failure when a process that should run does not.
pub(super) fn finding(common: &CommonArguments, health: &Asked) -> Finding {
    match read_records(&common.domain) {
        None => {
            let sentence =
                "neither `tabula run` nor systemd runs the domain, so no process is expected";
            Finding::new(NAME, Severity::Ok, sentence)
        }
        Some(records) => compare(&records, &reports(health)),
    }
}

fn compare(records: &[ProcessRecord], reports: &Result<Vec<HealthDocument>, Failure>) -> Finding {
    let troubles: Vec<String> = expected_processes(records, reports)
        .into_iter()
        .map(|process| process.trouble)
        .filter(|trouble| !trouble.is_empty())
        .collect();
    if troubles.is_empty() {
        let names: Vec<&str> = records.iter().map(|r| r.process.as_str()).collect();
        let sentence = format!("all that should run do: {}", names.join(", "));
        return Finding::new(NAME, Severity::Ok, sentence);
    }
    Finding::new(NAME, Severity::Failure, troubles.join("; "))
}

fn reports(health: &Asked) -> Result<Vec<HealthDocument>, Failure> {
    match health {
        Ok(Ok(reports)) => Ok(reports.clone()),
        Ok(Err(error)) | Err(error) => Err(Failure::general(error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::supervision::{RecordedState, Supervisor};

    #[test]
    fn missing_process_is_a_failure_with_its_name() {
        let record = |state| ProcessRecord {
            process: "memory".into(),
            pid: None,
            state,
            since_ns: 0,
            n_ends: 1,
            cause: "exit status: 1".into(),
            supervisor: Supervisor::TabulaRun,
        };
        let found = compare(&[record(RecordedState::Failing)], &Ok(vec![]));
        assert_eq!(found.severity, Severity::Failure);
        assert!(found.sentence.contains("tabula-memory"), "{found:?}");
        let found = compare(&[record(RecordedState::Starting)], &Ok(vec![]));
        assert_eq!(found.severity, Severity::Ok, "{found:?}");
    }
}
