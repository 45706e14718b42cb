//! Configuration: layers and commands without a daemon, and reload by running processes.

use crate::daemon::{
    Daemon, Sandbox, WATCHDOG, eventually, notification, send_signal, suspend, wait_for_end,
};
use crate::faults::wait_for_frames;
use message::ProcessKind;
use rustix::process::Signal;
use serde_json::Value;
use std::os::unix::net::UnixDatagram;
use std::path::PathBuf;
use std::process::{Child, Stdio};

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];
/// Exit codes of the programs.
const USAGE: i32 = 2;
const REFUSED: i32 = 4;

/// Writes a drop-in of the sandbox's configuration.
fn drop_in(sandbox: &Sandbox, name: &str, text: &str) -> PathBuf {
    let folder = sandbox.home().join("tabula.toml.d");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

/// JSON document and exit code of `tabula config` with arguments.
fn config(sandbox: &Sandbox, arguments: &[&str]) -> (Value, i32) {
    let output = sandbox.tabula(&[&["--json", "config"], arguments].concat());
    let document = serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{output:?}"));
    (document, output.status.code().unwrap())
}

/// Report of one process in the document of `tabula config reload`.
fn report<'a>(document: &'a Value, process: &str) -> Option<&'a Value> {
    let all = document["processes"].as_array()?;
    all.iter().find(|one| one["process"] == process)
}

/// Keys of changes in a report.
fn keys(report: &Value, kind: &str) -> Vec<String> {
    let changes = report[kind].as_array().unwrap();
    let key = |change: &Value| change["key"].as_str().unwrap().to_owned();
    changes.iter().map(key).collect()
}

/// Rule by which candidates become objects, of the newest scene.
fn rule(daemon: &Daemon<'_>) -> String {
    let document = daemon.ask(&["objects"]);
    document["rule"].as_str().unwrap_or_default().to_owned()
}

fn wait_for_rule(daemon: &Daemon<'_>, expected: &str) {
    eventually(expected, || rule(daemon) == expected);
}

#[test]
fn configuration_layers_are_checked_and_shown_without_a_daemon() {
    let sandbox = Sandbox::new();
    let (document, code) = config(&sandbox, &["check"]);
    assert_eq!((code, &document["files"]), (0, &serde_json::json!([])));
    sandbox.configure("[perception]\nworkers = 1\nrange_max_m = 3.0\n");
    let first = drop_in(&sandbox, "10-a.toml", "[perception]\nworkers = 3\n");
    drop_in(
        &sandbox,
        "20-b.toml.dpkg-old",
        "[perception]\nworkers = 4\n",
    );
    let (document, code) = config(&sandbox, &["check"]);
    assert_eq!((code, document["files"].as_array().unwrap().len()), (0, 2));
    let (document, _) = config(&sandbox, &["show"]);
    let value = |key: &str| {
        let values = document["values"].as_array().unwrap();
        values.iter().find(|one| one["key"] == key).unwrap().clone()
    };
    assert_eq!(value("workers")["value"], 3);
    assert_eq!(value("workers")["file"], first.to_str().unwrap());
    assert_eq!(value("range_max_m")["value"], 3.0);
    assert_eq!(value("range_min_m")["file"], Value::Null);
    let (document, _) = config(&sandbox, &["explain", "workers"]);
    let explained = &document["keys"][0];
    assert_eq!(explained["name"], "perception.workers");
    assert_eq!(explained["is_live"], false);
    assert_eq!(explained["value"]["line"], 2);
    let unknown = sandbox.tabula(&["config", "explain", "wrokers"]);
    let sentence = String::from_utf8(unknown.stderr).unwrap();
    assert_eq!(unknown.status.code(), Some(USAGE));
    assert!(sentence.contains("perception.workers"), "{sentence}");
}

#[test]
fn configuration_check_names_file_and_line_of_every_process() {
    let sandbox = Sandbox::new();
    sandbox.configure("[camera]\nsource = 'synthetic:0'\n");
    let check = |text: &str, words: &[&str]| {
        let file = drop_in(&sandbox, "50-wrong.toml", text);
        let output = sandbox.tabula(&["config", "check"]);
        let sentence = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(USAGE), "{sentence}");
        for word in [&[file.to_str().unwrap()], words].concat() {
            assert!(sentence.contains(word), "{word}: {sentence}");
        }
        assert_eq!(sentence.lines().count(), 1, "{sentence}");
    };
    check("\n[run]\nwatchdog_s = 1\n", &["line 3", "watchdog_s", "4"]);
    check("[memory]\nqueue_requests = 'x'\n", &["line 2", "integer"]);
    check("[camera]\nto_frame = 0\n", &["line 2", "to_frame"]);
    check("[simulator]\nscene = 'palace'\n", &["line 2", "palace"]);
    check(
        "[perception]\ncandidate_rule = 'C_table and C_tarck'\n",
        &["line 2", "candidate_rule", "C_tarck"],
    );
    check(
        "[perception]\nrange_min_m = 5\n",
        &["line 2", "range_max_m"],
    );
    check("[perception\n", &["line 1", "TOML"]);
    let (document, code) = config(&sandbox, &["check"]);
    assert_eq!(code, USAGE);
    assert_eq!(document["exit_code"], USAGE, "{document}");
}

#[test]
fn configuration_of_live_keys_changes_without_a_restart() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    wait_for_frames(&daemon, ProcessKind::PERCEPTION);
    let before = daemon.pids();
    drop_in(
        &sandbox,
        "10-rule.toml",
        "[perception]\ncandidate_rule = 'C_table'\nworkers = 3\n[memory]\nmax_unnamed_views = 500\n",
    );
    let (document, code) = config(&sandbox, &["reload"]);
    assert_eq!(code, 0, "{document:#}");
    let perception = report(&document, "perception").unwrap();
    assert_eq!(keys(perception, "applied"), ["perception.candidate_rule"]);
    assert_eq!(keys(perception, "needs_restart"), ["perception.workers"]);
    assert_eq!(perception["needs_restart"][0]["from"], "2");
    let memory = report(&document, "memory").unwrap();
    assert_eq!(keys(memory, "applied"), ["memory.max_unnamed_views"]);
    for quiet in ["run", "camera"] {
        let quiet = report(&document, quiet).unwrap();
        assert_eq!(keys(quiet, "applied"), Vec::<String>::new());
        assert_eq!(quiet["refused"], Value::Null);
    }
    wait_for_rule(&daemon, "C_table");
    // At a signal as well.
    drop_in(
        &sandbox,
        "20-rule.toml",
        "[perception]\ncandidate_rule = 'C_table or C_track'\n",
    );
    daemon.signal_parent(Signal::HUP);
    wait_for_rule(&daemon, "C_table ∨ C_track");
    assert_eq!(daemon.pids(), before);
    let log = daemon.log();
    assert!(
        log.contains("needs restart of perception: perception.workers 2 -> 3"),
        "{log}"
    );
    daemon.stop();
}

#[test]
fn configuration_with_an_error_is_applied_nowhere_and_in_no_part() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    wait_for_frames(&daemon, ProcessKind::PERCEPTION);
    let (before, old_rule) = (daemon.pids(), rule(&daemon));
    let good = "[perception]\ncandidate_rule = 'C_table'\n";
    let check = |wrong: &str, words: [&str; 3]| {
        drop_in(&sandbox, "10.toml", &format!("{good}{wrong}"));
        let (document, code) = config(&sandbox, &["reload"]);
        assert_eq!(code, REFUSED, "{document:#}");
        let sentence = report(&document, "run").unwrap()["refused"]
            .as_str()
            .unwrap();
        for word in words {
            assert!(sentence.contains(word), "{word}: {sentence}");
        }
        assert!(daemon.log().contains(sentence), "{}", daemon.log());
        for spared in ["perception", "memory", "camera"] {
            assert_eq!(report(&document, spared), None, "{document:#}");
        }
    };
    let here = "tabula.toml.d/10.toml";
    check("range_min_m = 0.0\n", [here, "line 3", "range_min_m"]);
    check(
        "[memory]\nworld_kept_max = 5\n",
        [here, "line 4", "world_kept_max"],
    );
    check(
        "[gateway]\nteacher = 'x'\n",
        [here, "line 4", "teacher_group"],
    );
    check("[perception]\n", [here, "line 3", "TOML"]);
    // A rule that only one process can check.
    drop_in(&sandbox, "20.toml", "[memory]\nmax_unnamed_views = 500\n");
    let wrong_rule = drop_in(
        &sandbox,
        "30.toml",
        "[perception]\ncandidate_rule = 'C_tarck'\n",
    );
    check("range_max_m = 3.0\n", ["30.toml", "line 2", "C_tarck"]);
    // One process alone, as systemd has it.
    daemon.signal(ProcessKind::PERCEPTION, Signal::HUP);
    let line = "the configuration is not reloaded by perception, and nothing has changed";
    eventually("perception refuses", || daemon.log().contains(line));
    wait_for_frames(&daemon, ProcessKind::PERCEPTION);
    assert_eq!(rule(&daemon), old_rule);
    std::fs::remove_file(wrong_rule).unwrap();
    let (document, code) = config(&sandbox, &["reload"]);
    assert_eq!(code, 0, "{document:#}");
    let perception = report(&document, "perception").unwrap();
    let applied = ["perception.candidate_rule", "perception.range_max_m"];
    assert_eq!(keys(perception, "applied"), applied, "{document:#}");
    let memory = report(&document, "memory").unwrap();
    assert_eq!(keys(memory, "applied"), ["memory.max_unnamed_views"]);
    wait_for_rule(&daemon, "C_table");
    assert_eq!(daemon.pids(), before);
    daemon.stop();
}

#[test]
fn configuration_of_the_memory_counts_for_the_next_import() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let file = sandbox.shared_file("memory.tabula");
    let file = file.to_str().unwrap();
    daemon.ask(&["memory", "export", file]);
    daemon.ask(&["memory", "import", file]);
    sandbox.configure("[memory]\nfree_disk_min_mb = 1000000\n");
    let (document, _) = config(&sandbox, &["reload"]);
    let memory = report(&document, "memory").unwrap();
    assert_eq!(keys(memory, "applied"), ["memory.free_disk_min_mb"]);
    eventually("the memory has the limit", || {
        let output = sandbox.tabula(&["memory", "import", file]);
        let sentence = String::from_utf8(output.stderr).unwrap();
        !output.status.success() && sentence.contains("kept free")
    });
    sandbox.configure("");
    config(&sandbox, &["reload"]);
    eventually("the memory has the default", || {
        sandbox.tabula(&["memory", "import", file]).status.success()
    });
    daemon.stop();
}

#[test]
fn configuration_of_the_watchdog_counts_for_running_processes() {
    let sandbox = Sandbox::new();
    sandbox.configure("[run]\nwatchdog_s = 3600\nstartup_watchdog_s = 3600\n");
    let daemon = sandbox.start(&TABLE);
    wait_for_frames(&daemon, ProcessKind::PERCEPTION);
    sandbox.configure("[run]\nwatchdog_s = 4\nstartup_watchdog_s = 3600\n");
    let (document, _) = config(&sandbox, &["reload"]);
    assert_eq!(
        keys(report(&document, "run").unwrap(), "applied"),
        ["run.watchdog_s"]
    );
    let pid = daemon.pid(ProcessKind::PERCEPTION).unwrap();
    suspend(pid);
    let line = format!("tabula-perception (process {pid}) has made no progress for");
    eventually("the watchdog finds it", || daemon.log().contains(&line));
    eventually("it is replaced", || {
        daemon
            .pid(ProcessKind::PERCEPTION)
            .is_some_and(|new| new != pid)
    });
    daemon.stop();
}

#[test]
fn configuration_that_changes_the_source_needs_a_restart() {
    let sandbox = Sandbox::new();
    sandbox.configure("[simulator]\nobjects = 1\nrate_hz = 5\n");
    let daemon = sandbox.start(&[]);
    sandbox.configure("[camera]\nsource = 'synthetic'\n[simulator]\nobjects = 2\nrate_hz = 5\n");
    for _ in 0..2 {
        let (document, code) = config(&sandbox, &["reload"]);
        assert_eq!(code, 0, "{document:#}");
        let run = report(&document, "run").unwrap();
        assert_eq!(keys(run, "needs_restart"), ["camera.source"]);
        let simulator = report(&document, "simulator").unwrap();
        assert_eq!(keys(simulator, "needs_restart"), ["simulator.objects"]);
    }
    daemon.stop();
}

/// A daemon that is starting, stopped at the end.
struct Starting<'a> {
    sandbox: &'a Sandbox,
    run: Child,
}

impl Starting<'_> {
    fn is_stopped(&mut self) -> bool {
        let _ = send_signal(self.run.id(), Signal::TERM);
        wait_for_end(&mut self.run, WATCHDOG).is_some()
    }
}

impl Drop for Starting<'_> {
    fn drop(&mut self) {
        if !self.is_stopped() {
            let _ = self.run.kill();
        }
        eventually("all processes have ended", || self.sandbox.is_deserted());
    }
}

#[test]
fn configuration_reload_ends_no_process_that_is_starting() {
    let script = "case \"$*\" in *--check-config*) ;; *) sleep 2;; esac\nexec \"$REAL\" \"$@\"";
    let sandbox = Sandbox::with_script(ProcessKind::CAMERA, script);
    let mut starting = Starting {
        sandbox: &sandbox,
        run: sandbox.launch(&TABLE),
    };
    let folder = sandbox.run_folder().domain_folder(&sandbox.domain);
    eventually("it listens", || folder.join("reload-run.toml").exists());
    eventually("the memory runs", || {
        folder.join("reload-memory.toml").exists()
    });
    for _ in 0..5 {
        send_signal(starting.run.id(), Signal::HUP).unwrap();
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    let camera = || {
        let output = sandbox.tabula(&["status", "--json"]);
        let document: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
        let all = document["expected"].as_array().cloned().unwrap_or_default();
        all.into_iter().find(|one| one["process"] == "camera")
    };
    eventually("the camera runs", || {
        camera().is_some_and(|one| one["state"] == "running")
    });
    assert_eq!(camera().unwrap()["n_ends"], 0);
    assert!(starting.is_stopped());
}

#[test]
fn configuration_reload_follows_the_protocol_of_systemd() {
    let sandbox = Sandbox::new();
    let socket = sandbox.shared_file("notify");
    let manager = UnixDatagram::bind(&socket).unwrap();
    manager.set_read_timeout(Some(WATCHDOG)).unwrap();
    let mut memory = sandbox
        .command("tabula-memory")
        .arg(format!("--domain={}", sandbox.domain))
        .env("NOTIFY_SOCKET", &socket)
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let next = || notification(&manager);
    // State and watchdog are notified in between.
    let next_with = |word: &str| loop {
        let text = next();
        if text.contains(word) {
            return text;
        }
    };
    next_with("READY=1");
    for _ in 0..2 {
        send_signal(memory.id(), Signal::HUP).unwrap();
        let begun = next_with("RELOADING=1");
        let time = begun
            .lines()
            .find_map(|line| line.strip_prefix("MONOTONIC_USEC="));
        assert!(time.unwrap().parse::<u64>().unwrap() > 0, "{begun}");
        next_with("READY=1");
    }
    send_signal(memory.id(), Signal::TERM).unwrap();
    next_with("STOPPING=1");
    assert!(wait_for_end(&mut memory, WATCHDOG).unwrap().success());
    eventually("it has left its domain", || sandbox.is_deserted());
}
