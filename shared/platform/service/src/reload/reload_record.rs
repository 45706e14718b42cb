//! Reload record: a live file of each process with the outcome of its last reload.
//!
//! The records name the processes of a domain that can reload, and hold the outcome.

use channel::{Domain, DomainName, Error, LiveFile, RunFolder};
use control_protocol::ReloadReport;
use message::ProcessKind;
use serde::{Deserialize, Serialize};

/// Name of the record of a process in the run folder; none stands for `tabula run`.
fn file_of(process: Option<ProcessKind>) -> String {
    format!("reload-{}.toml", process.map_or("run", ProcessKind::word))
}

/// Record of one process.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ReloadRecord {
    /// Process id of the parent that passes requests to reload on; none without one.
    pub(super) parent: Option<u32>,
    /// Beginning of the last reload, monotonic clock, nanoseconds; 0 before any.
    pub(super) began_ns: u64,
    /// Outcome of the last reload; before any, only process and id.
    pub(super) report: ReloadReport,
}

impl ReloadRecord {
    /// Records of all living processes of a domain of this user.
    pub(super) fn own(domain: &DomainName) -> Vec<Self> {
        Self::read(domain, &[RunFolder::of_user()])
    }

    fn read(domain: &DomainName, folders: &[RunFolder]) -> Vec<Self> {
        let read = |process| {
            let bytes = LiveFile::read(domain, folders, &file_of(process))?;
            toml::from_str(&String::from_utf8(bytes).ok()?).ok()
        };
        let processes = ProcessKind::all().map(Some);
        std::iter::once(None)
            .chain(processes)
            .filter_map(read)
            .collect()
    }
}

/// Outcomes of the last reload in each living process of a domain; without an outcome in one that
/// has not reloaded.
pub fn last_reloads(domain: &DomainName) -> Vec<ReloadReport> {
    let records = ReloadRecord::read(domain, &RunFolder::candidates());
    records.into_iter().map(|record| record.report).collect()
}

/// Publisher of the record of this process.
#[derive(Debug)]
pub struct ReloadRecordPublisher {
    file: LiveFile,
    record: ReloadRecord,
}

impl ReloadRecordPublisher {
    /// Publishes that a process, or `tabula run` when it is none, takes requests to reload. It must
    /// handle SIGHUP before.
    ///
    /// # Errors
    /// When the run folder is not this user's.
    pub fn new(
        domain: &Domain,
        process: Option<ProcessKind>,
        parent: Option<u32>,
    ) -> Result<Self, Error> {
        let name = process.map_or("run", ProcessKind::word);
        let mut publisher = Self {
            file: LiveFile::new(domain, &file_of(process))?,
            record: ReloadRecord {
                parent,
                began_ns: 0,
                report: ReloadReport {
                    process: name.to_owned(),
                    pid: std::process::id(),
                    ..ReloadReport::default()
                },
            },
        };
        publisher.write();
        Ok(publisher)
    }

    /// Report without an outcome, to be filled.
    pub fn report(&self) -> ReloadReport {
        ReloadReport {
            process: self.record.report.process.clone(),
            pid: self.record.report.pid,
            ..ReloadReport::default()
        }
    }

    /// Publishes the outcome of a reload that began at an instant of the monotonic clock.
    pub fn publish(&mut self, began_ns: u64, report: ReloadReport) {
        self.record.began_ns = began_ns;
        self.record.report = report;
        self.write();
    }

    fn write(&mut self) {
        let written = match toml::to_string(&self.record) {
            Ok(text) => self.file.write(text.as_bytes()).map_err(|e| e.to_string()),
            Err(error) => Err(error.to_string()),
        };
        if let Err(error) = written {
            tracing::warn!(
                "the outcome of a reload of the configuration is in this log only: {error}"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_protocol::KeyChange;
    use std::path::Path;
    use test_data::golden;

    #[test]
    fn golden_records_of_reloads_are_written_and_read() {
        let record = |report| ReloadRecord {
            parent: Some(6),
            began_ns: 5,
            report,
        };
        let before_any = ReloadReport {
            process: "memory".to_owned(),
            pid: 7,
            ..ReloadReport::default()
        };
        let change = |key: &str| KeyChange {
            key: key.to_owned(),
            from: "1".to_owned(),
            to: "2".to_owned(),
        };
        let applied = ReloadReport {
            applied: vec![change("memory.max_views")],
            needs_restart: vec![change("memory.directory")],
            ..before_any.clone()
        };
        let refused = ReloadReport {
            refused: Some("line 3".to_owned()),
            is_unanswered: true,
            ..before_any.clone()
        };
        let without_parent = ReloadRecord {
            parent: None,
            ..record(before_any.clone())
        };
        golden::check(
            &Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/reload.txt"),
            &[
                ("before any", record(before_any)),
                ("applied", record(applied)),
                ("refused", record(refused)),
                ("without a parent", without_parent),
            ],
            |record| toml::to_string(record).unwrap().into_bytes(),
            |bytes| toml::from_str(str::from_utf8(bytes).unwrap()).unwrap(),
        );
    }
}
