//! Notifications to systemd: readiness, watchdog, longer starts, and the readiness marker, by
//! processes that believe systemd has started them.

use crate::daemon::{Sandbox, WATCHDOG, eventually, notification, send_signal, wait_for_end};
use rustix::process::Signal;
use std::os::unix::net::UnixDatagram;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Socket of systemd, and the folder of `RuntimeDirectory=`.
struct Systemd {
    socket: UnixDatagram,
    folder: tempfile::TempDir,
}

impl Systemd {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let socket = UnixDatagram::bind(folder.path().join("notify")).unwrap();
        socket.set_read_timeout(Some(WATCHDOG)).unwrap();
        Self { socket, folder }
    }

    fn command(&self, sandbox: &Sandbox, program: &str) -> Command {
        let mut command = sandbox.command(program);
        command
            .env("NOTIFY_SOCKET", self.folder.path().join("notify"))
            .env("RUNTIME_DIRECTORY", self.folder.path())
            .stderr(Stdio::null());
        command
    }

    fn start(&self, sandbox: &Sandbox, program: &str) -> Child {
        self.command(sandbox, program).spawn().unwrap()
    }

    /// Next notification: lines of assignments.
    fn next(&self) -> String {
        notification(&self.socket)
    }

    /// Notifications up to the first that contains a text, which is the last.
    fn until(&self, text: &str) -> Vec<String> {
        let mut all = vec![self.next()];
        while !all.last().unwrap().contains(text) {
            all.push(self.next());
        }
        all
    }

    fn marker(&self) -> PathBuf {
        self.folder.path().join("has-been-ready")
    }
}

fn stop(mut child: Child) -> i32 {
    send_signal(child.id(), Signal::TERM).unwrap();
    wait_for_end(&mut child, WATCHDOG).unwrap().code().unwrap()
}

#[test]
fn memory_is_ready_when_it_answers_and_feeds_the_watchdog() {
    let (sandbox, systemd) = (Sandbox::new(), Systemd::new());
    let _gateway = sandbox.start_program("tabula-gateway");
    eventually("the gateway answers", || {
        sandbox.tabula(&["status"]).status.success()
    });
    let memory = systemd.start(&sandbox, "tabula-memory");
    let news = systemd.until("READY=1");
    let (_, before) = news.split_last().unwrap();
    assert!(!before.iter().any(|one| one.contains("WATCHDOG=1")));
    // At once, without a repetition.
    let answer = sandbox.tabula(&["categories", "--json"]);
    assert!(answer.status.success(), "{answer:?}");
    eventually("the marker is there", || systemd.marker().exists());
    systemd.until("WATCHDOG=1");
    systemd.until("WATCHDOG=1");
    assert_eq!(stop(memory), 0);
    systemd.until("STOPPING=1");
    assert!(!systemd.marker().exists());
}

#[test]
fn perception_without_a_memory_is_degraded_and_keeps_nobody_waiting() {
    let (sandbox, systemd) = (Sandbox::new(), Systemd::new());
    let perception = systemd.start(&sandbox, "tabula-perception");
    let starting = systemd.until("READY=1");
    assert!(
        starting
            .iter()
            .any(|one| one.contains("EXTEND_TIMEOUT_USEC=")),
        "{starting:?}"
    );
    assert!(
        starting
            .last()
            .unwrap()
            .contains("the memory does not answer")
    );
    let memory = sandbox
        .command("tabula-memory")
        .stderr(Stdio::null())
        .spawn();
    systemd.until("STATUS=ready");
    assert_eq!(stop(perception), 0);
    assert_eq!(stop(memory.unwrap()), 0);
}

#[test]
fn wrong_configuration_is_final_unless_the_process_has_been_ready() {
    let (sandbox, systemd) = (Sandbox::new(), Systemd::new());
    sandbox.configure("[perception]\nworkers = 99\n");
    let code = || {
        let mut command = systemd.command(&sandbox, "tabula-perception");
        command.status().unwrap().code().unwrap()
    };
    assert_eq!(code(), 2);
    std::fs::write(systemd.marker(), "").unwrap();
    assert_eq!(code(), 1);
}

#[test]
fn service_waits_for_a_source_that_is_not_there_yet() {
    let (sandbox, systemd) = (Sandbox::new(), Systemd::new());
    let folder = sandbox.home().join("not mounted yet");
    sandbox.configure(&format!("[camera]\nsource = \"{}\"\n", folder.display()));
    let mut camera = systemd.start(&sandbox, "tabula-camera");
    let news = systemd.until("READY=1");
    assert!(news.last().unwrap().contains("degraded"), "{news:?}");
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(camera.try_wait().unwrap(), None);
    assert_eq!(stop(camera), 0);
}
