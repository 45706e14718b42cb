//! Process records of a daemon that systemd supervises, from the states of its units.

use super::process_record::{ProcessRecord, RecordedState, Supervisor};
use channel::DomainName;
use message::ProcessKind;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// Domain of the units.
const DOMAIN: &str = "default";
/// Folder that exists where systemd has booted the machine (`sd_booted(3)`).
const SYSTEMD: &str = "/run/systemd/system";
/// Properties of a unit that are asked for.
const PROPERTIES: &str =
    "Id,LoadState,ActiveState,UnitFileState,MainPID,NRestarts,Result,StateChangeTimestamp";

/// Reads the states of the units; `None` where systemd does not run them, or none is enabled.
pub(super) fn read(domain: &DomainName) -> Option<Vec<ProcessRecord>> {
    if domain.to_string() != DOMAIN || !Path::new(SYSTEMD).exists() {
        return None;
    }
    let mut command = Command::new("systemctl");
    command.args(["show", "--no-pager", "--timestamp=unix"]);
    command.arg(format!("--property={PROPERTIES}"));
    command.args(ProcessKind::all().map(unit));
    let answer = command.stdin(Stdio::null()).stderr(Stdio::null()).output();
    let answer = String::from_utf8(answer.ok()?.stdout).ok()?;
    let records = parse(&answer);
    (!records.is_empty()).then_some(records)
}

fn unit(process: ProcessKind) -> String {
    format!("{}.service", process.program())
}

/// Records of the units that should run: those that are enabled, or not idle.
fn parse(answer: &str) -> Vec<ProcessRecord> {
    answer.split("\n\n").filter_map(record).collect()
}

fn record(block: &str) -> Option<ProcessRecord> {
    let properties: BTreeMap<&str, &str> = block
        .lines()
        .filter_map(|line| line.split_once('='))
        .collect();
    let property = |name: &str| properties.get(name).copied().unwrap_or_default();
    let process = ProcessKind::all().find(|process| unit(*process) == property("Id"))?;
    let active = property("ActiveState");
    let is_expected = property("UnitFileState") == "enabled" || active != "inactive";
    if property("LoadState") != "loaded" || !is_expected {
        return None;
    }
    let state = match active {
        "active" | "reloading" => RecordedState::Running,
        "activating" if property("NRestarts") == "0" => RecordedState::Starting,
        "activating" => RecordedState::Failing,
        _ => RecordedState::Stopped,
    };
    let is_working = matches!(state, RecordedState::Running | RecordedState::Starting);
    let seconds = property("StateChangeTimestamp").trim_start_matches('@');
    // Without a time the unit has not been started since the machine was booted.
    let seconds: Option<u64> = seconds.parse().ok();
    Some(ProcessRecord {
        process: process.word().to_owned(),
        pid: property("MainPID").parse().ok().filter(|pid| *pid != 0),
        state,
        since_ns: seconds.map_or(0, |seconds| seconds * 1_000_000_000),
        // systemd counts all restarts, not those in a row.
        n_ends: u32::from(!is_working),
        cause: if is_working {
            String::new()
        } else {
            property("Result").to_owned()
        },
        supervisor: Supervisor::Systemd,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(process: &str, active: &str, enabled: &str, n_restarts: u32) -> String {
        format!(
            "MainPID=71\nNRestarts={n_restarts}\nResult=watchdog\nId=tabula-{process}.service\n\
             LoadState=loaded\nActiveState={active}\nUnitFileState={enabled}\n\
             StateChangeTimestamp=@1700000000\n"
        )
    }

    #[test]
    fn units_that_are_enabled_or_not_idle_are_expected() {
        let answer = [
            block("memory", "active", "enabled", 3),
            block("perception", "activating", "enabled", 2),
            block("camera", "inactive", "enabled", 0),
            block("simulator", "inactive", "disabled", 0),
        ]
        .join("\n");
        let records = parse(&answer);
        let states: Vec<_> = records
            .iter()
            .map(|one| (one.process.as_str(), one.state))
            .collect();
        assert_eq!(
            states,
            [
                ("memory", RecordedState::Running),
                ("perception", RecordedState::Failing),
                ("camera", RecordedState::Stopped),
            ]
        );
        assert_eq!(records[0].trouble(), None);
        let trouble = records[1].trouble().unwrap();
        for word in ["watchdog", "journalctl -u tabula-perception"] {
            assert!(trouble.contains(word), "{trouble}");
        }
        assert!(
            records[2]
                .trouble()
                .unwrap()
                .contains("systemctl start tabula.target")
        );
    }

    #[test]
    fn units_that_are_not_installed_are_not_expected() {
        let missing = block("memory", "inactive", "", 0).replace("loaded", "not-found");
        assert_eq!(parse(&missing), []);
        assert_eq!(parse("nothing of the kind"), []);
    }
}
