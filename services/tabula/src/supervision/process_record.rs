//! Process record: what should run in a domain, and the state of each process as its parent
//! sees it. `tabula run` publishes it for `tabula status` and `tabula doctor`.

use super::systemd_units;
use crate::time::utc;
use channel::{Domain, DomainName, Error, LiveFile, RunFolder};
use message::ProcessKind;
use serde::{Deserialize, Serialize};

/// Name of the record in the run folder of the domain.
const FILE: &str = "processes.json";

/// State of a process as its parent sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RecordedState {
    /// Started for the first time, and not ready yet.
    Starting,
    /// Ready, with progress.
    Running,
    /// Without progress for some seconds; killed when this lasts.
    Stalled,
    /// Ended, and not ready again since; it is restarted.
    Failing,
    /// Not running, and not restarted: stopped by a person, or for wrong arguments.
    Stopped,
}

/// Supervisor of a process.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Supervisor {
    /// `tabula run`.
    #[default]
    TabulaRun,
    /// systemd, with a unit for each process.
    Systemd,
}

/// Record of one process that should run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ProcessRecord {
    /// Name of the process, such as `camera`.
    pub(crate) process: String,
    /// Process id; `None` before a restart.
    pub(crate) pid: Option<u32>,
    /// State of the process.
    pub(crate) state: RecordedState,
    /// Beginning of the state, nanoseconds since 1970, UTC; 0 when it has never begun.
    pub(crate) since_ns: u64,
    /// Number of ends in a row, without a run in between that went well for a while.
    pub(crate) n_ends: u32,
    /// Cause of the last end, or of a stall; empty otherwise.
    pub(crate) cause: String,
    /// Supervisor that restarts the process.
    #[serde(default)]
    pub(crate) supervisor: Supervisor,
}

impl ProcessRecord {
    /// Sentence about a process that does not work; `None` for one that starts or runs.
    pub(crate) fn trouble(&self) -> Option<String> {
        let Self {
            process,
            n_ends,
            cause,
            ..
        } = self;
        let since = utc(self.since_ns);
        match self.state {
            RecordedState::Starting | RecordedState::Running => None,
            RecordedState::Stalled => Some(format!(
                "tabula-{process} has made no progress since {since}; `tabula run` restarts it if \
                 this lasts"
            )),
            RecordedState::Failing => {
                let ends = match n_ends {
                    0 | 1 => String::new(),
                    n => format!(", {n} ends in a row"),
                };
                let next = match self.supervisor {
                    Supervisor::TabulaRun => {
                        "`tabula run` restarts it, see its messages in the log".to_owned()
                    }
                    Supervisor::Systemd => {
                        format!("systemd restarts it, see journalctl -u tabula-{process}")
                    }
                };
                Some(format!(
                    "tabula-{process} has not been working since {since} ({cause}{ends}); {next}"
                ))
            }
            RecordedState::Stopped if self.since_ns == 0 => Some(format!(
                "tabula-{process} has not been started since this machine was; start it: systemctl \
                 start tabula.target"
            )),
            RecordedState::Stopped => Some(format!(
                "tabula-{process} does not run since {since} ({cause}); see journalctl -u \
                 tabula-{process}, then start it: systemctl start tabula.target"
            )),
        }
    }

    /// Record without control characters, which would reach a terminal; `None` for an unknown
    /// process.
    fn checked(mut self) -> Option<Self> {
        let is_known = ProcessKind::from_word(&self.process).is_some();
        let printable = |c: char| if c.is_control() { ' ' } else { c };
        self.cause = self.cause.chars().map(printable).collect();
        is_known.then_some(self)
    }
}

/// Reads the records of a domain: those of this user's `tabula run`, else those of the systemd
/// units, else those of another user, who may say what he likes; `None` where nobody runs it.
pub(crate) fn read(domain: &DomainName) -> Option<Vec<ProcessRecord>> {
    let of_run = |folders: &[RunFolder]| parse(&LiveFile::read(domain, folders, FILE)?);
    of_run(&RunFolder::trusted())
        .or_else(|| systemd_units::read(domain))
        .or_else(|| of_run(&RunFolder::candidates()))
}

fn parse(bytes: &[u8]) -> Option<Vec<ProcessRecord>> {
    let records: Vec<ProcessRecord> = serde_json::from_slice(bytes).ok()?;
    Some(
        records
            .into_iter()
            .filter_map(ProcessRecord::checked)
            .collect(),
    )
}

/// Publisher of the record; it writes changes only.
pub(crate) struct RecordPublisher {
    file: LiveFile,
    published: Vec<ProcessRecord>,
    has_failed: bool,
}

impl RecordPublisher {
    /// Prepares the record of a domain.
    ///
    /// # Errors
    /// When the run folder is not this user's.
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            file: LiveFile::new(domain, FILE)?,
            published: Vec::new(),
            has_failed: false,
        })
    }

    /// Publishes the records if they have changed. A failure is logged once.
    pub(crate) fn update(&mut self, records: Vec<ProcessRecord>) {
        if records == self.published && !self.has_failed {
            return;
        }
        let Ok(bytes) = serde_json::to_vec(&records) else {
            return;
        };
        match self.file.write(&bytes) {
            Ok(()) => self.has_failed = false,
            Err(_) if self.has_failed => {}
            Err(error) => {
                self.has_failed = true;
                tracing::warn!(
                    "`tabula status` may show an outdated state until the run folder can be \
                     written again: {error}"
                );
            }
        }
        self.published = records;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use test_data::golden;

    fn record(state: RecordedState) -> ProcessRecord {
        ProcessRecord {
            process: "memory".into(),
            pid: Some(7),
            state,
            since_ns: 1_700_000_000_000_000_000,
            n_ends: 12,
            cause: "exit status: 1".into(),
            supervisor: Supervisor::TabulaRun,
        }
    }

    #[test]
    fn trouble_names_process_cause_and_time() {
        let sentence = record(RecordedState::Failing).trouble().unwrap();
        for word in [
            "tabula-memory",
            "2023-11-14 22:13:20Z",
            "exit status: 1",
            "12 ends",
        ] {
            assert!(sentence.contains(word), "{sentence}");
        }
        let sentence = record(RecordedState::Stalled).trouble().unwrap();
        assert!(
            sentence.contains("no progress since 2023-11-14"),
            "{sentence}"
        );
        assert_eq!(record(RecordedState::Running).trouble(), None);
        assert_eq!(record(RecordedState::Starting).trouble(), None);
    }

    #[test]
    fn record_survives_its_file_without_control_characters() {
        let mut hostile = record(RecordedState::Failing);
        hostile.cause = "\x1b[2Jcleared\n".into();
        let mut unknown = record(RecordedState::Running);
        unknown.process = "../x".into();
        let all = [record(RecordedState::Running), hostile, unknown];
        let read = parse(&serde_json::to_vec(&all).unwrap()).unwrap();
        assert_eq!(read.len(), 2);
        assert_eq!(read[0], all[0]);
        assert_eq!(read[1].cause, " [2Jcleared ");
        assert_eq!(parse(b"no JSON"), None);
    }

    #[test]
    fn golden_records_of_processes_are_written_and_read() {
        let states = [
            ("starting", RecordedState::Starting),
            ("running", RecordedState::Running),
            ("stalled", RecordedState::Stalled),
            ("failing", RecordedState::Failing),
            ("stopped", RecordedState::Stopped),
        ];
        let mut examples = states
            .map(|(name, state)| (name, vec![record(state)]))
            .to_vec();
        let by_systemd = ProcessRecord {
            pid: None,
            supervisor: Supervisor::Systemd,
            ..record(RecordedState::Running)
        };
        examples.push(("by systemd", vec![by_systemd]));
        golden::check(
            &Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/processes.txt"),
            &examples,
            |records| serde_json::to_vec(records).unwrap(),
            |bytes| parse(bytes).unwrap(),
        );
    }
}
