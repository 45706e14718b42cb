//! Control socket under hostile clients: places of users, hang-ups, and urgent commands.
#![expect(clippy::unwrap_used, reason = "test helpers may panic")]

use channel::DomainName;
use channel::RunFolder;
use channel::control::{self, Handler, RoleGroups, SocketServer};
use control_protocol::{ArmCommand, Command, Refusal, RefusalKind, Reply, WorldCommand};
use daemon_client::DaemonClient;
use std::io::{Read, Write};
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::time::Duration;

/// Track-id whose request is never answered.
const NEVER: u64 = 99;

/// Connections that a user may have, and a few more.
const MANY: usize = 150;

const STOP: Command = Command::Arm(ArmCommand::Stop);

/// Control socket in a folder of its own.
struct TestSocket {
    name: DomainName,
    folder: RunFolder,
    path: PathBuf,
    _guard: tempfile::TempDir,
    runtime: tokio::runtime::Runtime,
}

impl TestSocket {
    fn serve() -> Self {
        let guard = tempfile::tempdir().unwrap();
        let name: DomainName = "test".parse().unwrap();
        let folder = RunFolder::at(guard.path().to_owned());
        std::fs::create_dir(folder.domain_folder(&name)).unwrap();
        let path = folder.control_socket(&name);
        let groups = RoleGroups {
            teachers: "tabula".into(),
            administrators: "tabula-admin".into(),
        };
        let server =
            SocketServer::bind(&path, &groups, handler("ordinary"), handler("urgent")).unwrap();
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(1)
            .enable_all()
            .build()
            .unwrap();
        runtime.spawn(server.run());
        Self {
            name,
            folder,
            path,
            _guard: guard,
            runtime,
        }
    }

    fn client(&self) -> DaemonClient {
        let folders = [self.folder.clone()];
        DaemonClient::connect(&self.name, &folders, Duration::from_secs(20)).unwrap()
    }

    /// Sends a request on a connection of its own, and does not wait for the answer.
    fn send(&self, command: Command) -> UnixStream {
        let request = control_protocol::Request::from(command);
        let bytes = control_protocol::codec::encode(&request).unwrap();
        let mut message = (bytes.len() as u32).to_le_bytes().to_vec();
        message.extend(bytes);
        let mut stream = UnixStream::connect(&self.path).unwrap();
        stream.write_all(&message).unwrap();
        stream
    }

    fn send_many(&self, n: usize, command: &Command) -> Vec<UnixStream> {
        (0..n).map(|_| self.send(command.clone())).collect()
    }
}

/// Handler that names itself, and never answers for one track.
fn handler(name: &'static str) -> Handler {
    control::handler(move |command, _| async move {
        match command {
            Command::Ask { track_id: NEVER } | Command::World(_) => std::future::pending().await,
            _ => answered_by(name),
        }
    })
}

fn answered_by(name: &str) -> Reply {
    Reply::Refused(Refusal::new(RefusalKind::Invalid, name))
}

#[test]
fn urgent_command_is_answered_while_a_user_holds_all_places() {
    let socket = TestSocket::serve();
    let _silent: Vec<_> = (0..MANY)
        .map(|_| UnixStream::connect(&socket.path).unwrap())
        .collect();
    let _asking = socket.send_many(MANY, &Command::Ask { track_id: NEVER });
    let events = Command::World(WorldCommand::Events {
        since: 0,
        wait_ms: 30_000,
    });
    let _waiting = socket.send_many(MANY, &events);
    let half_a_message: Vec<_> = (0..MANY)
        .map(|_| {
            let mut stream = UnixStream::connect(&socket.path).unwrap();
            stream.write_all(&[0, 0, 4, 0, 1]).unwrap();
            stream
        })
        .collect();
    for urgent in [STOP, Command::Health] {
        assert_eq!(socket.client().call(urgent).unwrap(), answered_by("urgent"));
    }
    let refused = socket.client().call(Command::Categories).unwrap();
    let Reply::Refused(refusal) = refused else {
        panic!("{refused:?}");
    };
    assert_eq!(refusal.kind, RefusalKind::Unavailable);
    assert!(
        refusal.sentence.contains("requests in progress"),
        "{refusal}"
    );
    drop(half_a_message);
}

#[test]
fn place_of_a_peer_that_hung_up_is_free_at_once() {
    let socket = TestSocket::serve();
    for _ in 0..5 {
        let asking = socket.send_many(MANY, &Command::Ask { track_id: NEVER });
        drop(asking);
        let reply = socket.client().call(Command::Categories).unwrap();
        assert_eq!(reply, answered_by("ordinary"));
    }
}

#[test]
fn waiting_requests_take_no_place_of_others() {
    let socket = TestSocket::serve();
    let events = Command::World(WorldCommand::Events {
        since: 0,
        wait_ms: 30_000,
    });
    let waiting = socket.send_many(40, &events);
    let reply = socket.client().call(Command::Categories).unwrap();
    assert_eq!(reply, answered_by("ordinary"));
    let mut n_refused = 0;
    for mut stream in waiting {
        stream
            .set_read_timeout(Some(Duration::from_millis(50)))
            .unwrap();
        n_refused += usize::from(stream.read(&mut [0; 4]).is_ok_and(|n| n == 4));
    }
    assert_eq!(n_refused, 40 - 16);
}

#[test]
fn peer_that_ended_only_its_writing_still_gets_its_reply() {
    let socket = TestSocket::serve();
    let mut stream = socket.send(Command::Categories);
    stream.shutdown(Shutdown::Write).unwrap();
    let mut reply = Vec::new();
    stream.read_to_end(&mut reply).unwrap();
    assert!(String::from_utf8_lossy(&reply).contains("ordinary"));
}

#[test]
fn socket_ends_with_its_future() {
    let socket = TestSocket::serve();
    assert!(UnixStream::connect(&socket.path).is_ok());
    let TestSocket {
        path,
        runtime,
        _guard: _folder,
        ..
    } = socket;
    runtime.shutdown_timeout(Duration::from_secs(5));
    for _ in 0..500 {
        if UnixStream::connect(&path).is_err() {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("the socket is still served");
}

#[test]
fn request_on_behalf_of_another_user_is_refused() {
    let socket = TestSocket::serve();
    let request = control_protocol::Request {
        user: Some(control::own_peer()),
        ..control_protocol::Request::from(Command::Objects)
    };
    let bytes = control_protocol::codec::encode(&request).unwrap();
    let mut stream = UnixStream::connect(&socket.path).unwrap();
    let message = control_protocol::codec::framed(&bytes);
    stream.write_all(&message).unwrap();
    let mut answer = Vec::new();
    stream.shutdown(Shutdown::Write).unwrap();
    stream.read_to_end(&mut answer).unwrap();
    let reply = control_protocol::codec::decode_reply(&answer[4..]);
    assert!(
        matches!(&reply, Reply::Refused(refusal) if refusal.kind == RefusalKind::Invalid),
        "{reply:?}"
    );
}
