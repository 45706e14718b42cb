//! The systemd units: accepted by systemd, hardened, and restarted for ever.

use message::{Duty, ProcessKind};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Greatest exposure by `systemd-analyze security`, 0 (none) to 10, of a unit with a device, and
/// of the others.
const EXPOSURE_MAX: (f64, f64) = (2.0, 1.2);

fn units() -> Vec<PathBuf> {
    let deploy = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../deploy"));
    let folders = ["systemd", "systemd-target"].map(|name| deploy.join(name));
    let entries = folders
        .iter()
        .flat_map(|folder| fs::read_dir(folder).unwrap());
    let mut units: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    units.sort();
    units
}

fn name(path: &Path) -> &str {
    path.file_name().unwrap().to_str().unwrap()
}

/// Number of processes of the daemon with a program of ours; the driver of an arm is the user's.
fn n_processes() -> usize {
    let ours = ProcessKind::all().filter(|process| !process.has(Duty::Driver));
    ours.count()
}

fn services() -> Vec<PathBuf> {
    let mut services = units();
    services.retain(|path| path.extension().is_some_and(|kind| kind == "service"));
    services
}

#[test]
#[ignore = "needs systemd-analyze"]
fn systemd_analyze_accepts_the_units() {
    let folder = tempfile::tempdir().unwrap();
    let copies: Vec<PathBuf> = units()
        .iter()
        .map(|unit| {
            // Without the program and the manual page, which are not installed here.
            let text = fs::read_to_string(unit).unwrap();
            let lines = text
                .lines()
                .filter(|line| !line.starts_with("Documentation="));
            let lines = lines.map(|line| match line.split_once("ExecStart=") {
                Some(("", _)) => "ExecStart=/bin/true".to_owned(),
                _ => line.to_owned(),
            });
            let copy = folder.path().join(name(unit));
            fs::write(&copy, lines.collect::<Vec<_>>().join("\n")).unwrap();
            copy
        })
        .collect();
    // One for each process, and the target.
    assert_eq!(copies.len(), n_processes() + 1);
    let mut verify = Command::new("systemd-analyze");
    let verified = verify.arg("verify").args(&copies).output().unwrap();
    let found = String::from_utf8_lossy(&verified.stderr).into_owned();
    // It also reports the faults of units of this machine.
    let own: Vec<_> = found
        .lines()
        .filter(|line| line.contains("tabula"))
        .collect();
    assert!(verified.status.success() && own.is_empty(), "{found}");
}

#[test]
#[ignore = "needs systemd-analyze"]
fn systemd_analyze_finds_the_units_hardened() {
    for unit in services() {
        let mut analyse = Command::new("systemd-analyze");
        analyse
            .args(["security", "--offline=true", "--no-pager"])
            .arg(&unit);
        let report = String::from_utf8(analyse.output().unwrap().stdout).unwrap();
        let overall = report.lines().last().unwrap();
        let mut words = overall.split_whitespace();
        let exposure: f64 = words.find_map(|word| word.parse().ok()).unwrap();
        let has_device = name(&unit).contains("camera");
        let most = if has_device {
            EXPOSURE_MAX.0
        } else {
            EXPOSURE_MAX.1
        };
        assert!(exposure <= most, "{}: {overall}", name(&unit));
    }
}

#[test]
fn units_notify_are_watched_and_are_restarted_for_ever() {
    assert_eq!(services().len(), n_processes());
    for unit in services() {
        let text = fs::read_to_string(&unit).unwrap();
        for line in [
            "Type=notify",
            "WatchdogSec=",
            "Restart=always",
            "StartLimitIntervalSec=0",
            "RestartPreventExitStatus=2",
            "RuntimeDirectoryPreserve=restart",
        ] {
            let is_there = text.lines().any(|other| other.starts_with(line));
            assert!(is_there, "{} has no {line}", name(&unit));
        }
    }
}
