//! Request to reload, to all processes of a domain.

use super::reload_record::ReloadRecord;
use crate::monotonic_ns;
use channel::Domain;
use control_protocol::ReloadReport;
use rustix::process::{Pid, Signal, kill_process};
use std::time::{Duration, Instant};

/// Pause between two looks at the records. Chosen.
const POLL_PERIOD: Duration = Duration::from_millis(20);

/// Lets all processes of a domain reload their configuration, by SIGHUP, and waits for the
/// outcomes. A parent is asked first: it checks the configuration for all its children, and passes
/// the request on when it is valid.
///
/// The outcome of a process that does not answer in time is unknown.
pub async fn reload_processes(domain: &Domain, deadline: Duration) -> Vec<ReloadReport> {
    let (asked_ns, begun) = (monotonic_ns(), Instant::now());
    let asked = ReloadRecord::own(domain.name());
    for record in &asked {
        if !has_parent(record, &asked) {
            hang_up(record.report.pid);
        }
    }
    loop {
        let records = ReloadRecord::own(domain.name());
        let is_over = begun.elapsed() >= deadline;
        let outcomes: Vec<_> = asked
            .iter()
            .map(|one| outcome(one, &records, asked_ns))
            .collect();
        if let Some(reports) = decided(&asked, &outcomes) {
            return reports;
        }
        if is_over {
            let late = asked.iter().zip(outcomes);
            return late
                .map(|(one, outcome)| outcome.unwrap_or_else(|| unanswered(one, deadline)))
                .collect();
        }
        tokio::time::sleep(POLL_PERIOD).await;
    }
}

/// True when a parent that has a record itself passes requests on to the process.
fn has_parent(record: &ReloadRecord, all: &[ReloadRecord]) -> bool {
    let is_parent = |other: &ReloadRecord| Some(other.report.pid) == record.parent;
    all.iter().any(is_parent)
}

/// Outcome of a process, once it has begun its reload after the request.
fn outcome(asked: &ReloadRecord, now: &[ReloadRecord], asked_ns: u64) -> Option<ReloadReport> {
    let is_it = |one: &&ReloadRecord| one.report.pid == asked.report.pid;
    let newest = now.iter().find(is_it)?;
    (newest.began_ns >= asked_ns).then(|| newest.report.clone())
}

/// All reports, when all are there: that of a parent that refuses stands for its children.
fn decided(asked: &[ReloadRecord], outcomes: &[Option<ReloadReport>]) -> Option<Vec<ReloadReport>> {
    let refusing: Vec<u32> = outcomes
        .iter()
        .flatten()
        .filter(|report| report.refused.is_some())
        .map(|report| report.pid)
        .collect();
    let is_spared =
        |one: &ReloadRecord| one.parent.is_some_and(|parent| refusing.contains(&parent));
    let mut reports = Vec::new();
    for (one, outcome) in asked.iter().zip(outcomes) {
        match outcome {
            Some(report) => reports.push(report.clone()),
            None if is_spared(one) => {}
            None => return None,
        }
    }
    Some(reports)
}

fn unanswered(record: &ReloadRecord, deadline: Duration) -> ReloadReport {
    tracing::warn!(
        "{} has not answered a request to reload within {} s",
        record.report.process,
        deadline.as_secs_f64()
    );
    ReloadReport {
        refused: None,
        is_unanswered: true,
        applied: Vec::new(),
        needs_restart: Vec::new(),
        ..record.report.clone()
    }
}

/// Sends SIGHUP to a living process, which holds its record.
fn hang_up(pid: u32) {
    if let Some(pid) = Pid::from_raw(pid.cast_signed())
        && let Err(error) = kill_process(pid, Signal::HUP)
    {
        tracing::warn!("a process could not be asked to reload: {error}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(pid: u32, parent: Option<u32>, began_ns: u64, refused: Option<&str>) -> ReloadRecord {
        ReloadRecord {
            parent,
            began_ns,
            report: ReloadReport {
                process: "memory".into(),
                pid,
                refused: refused.map(str::to_owned),
                ..ReloadReport::default()
            },
        }
    }

    fn pids(asked: &[ReloadRecord], now: &[ReloadRecord]) -> Option<Vec<u32>> {
        let outcomes: Vec<_> = asked.iter().map(|one| outcome(one, now, 100)).collect();
        let reports = decided(asked, &outcomes)?;
        Some(reports.into_iter().map(|report| report.pid).collect())
    }

    #[test]
    fn request_is_over_when_all_have_begun_after_it() {
        let asked = [record(1, None, 0, None), record(2, Some(1), 0, None)];
        assert!(!has_parent(&asked[0], &asked) && has_parent(&asked[1], &asked));
        assert_eq!(pids(&asked, &asked), None);
        let begun = |first_ns, second_ns| {
            [
                record(1, None, first_ns, None),
                record(2, Some(1), second_ns, None),
            ]
        };
        assert_eq!(pids(&asked, &begun(100, 99)), None, "an earlier reload");
        assert_eq!(pids(&asked, &begun(100, 101)), Some(vec![1, 2]));
        let gone = [record(1, None, 100, None)];
        assert_eq!(pids(&asked, &gone), None, "a process has ended meanwhile");
    }

    #[test]
    fn refusal_of_a_parent_spares_its_children() {
        let asked = [
            record(1, None, 0, None),
            record(2, Some(1), 0, None),
            record(3, None, 0, None),
        ];
        let refused = [
            record(1, None, 100, Some("wrong")),
            record(2, Some(1), 0, None),
            record(3, None, 100, None),
        ];
        assert_eq!(pids(&asked, &refused), Some(vec![1, 3]));
    }
}
