//! Ports, control transports and clean-up over real shared memory, each test in a
//! separate domain.
#![expect(clippy::unwrap_used, reason = "test helpers may panic")]

use channel::GUEST_PLACES;
use channel::control::{self, Client, RoleGroups, Server, SocketServer};
use channel::topic::{CameraCloud, FinishedFrames, Scene};
use channel::{Domain, DomainName, Error, Publisher, Received, Role, RunFolder, Subscriber};
use control_protocol::{Command, MAX_MESSAGE_BYTES, Peer, Refusal, RefusalKind, Reply, UserRole};
use daemon_client::{CallError, DaemonClient};
use message::{CloudPoint, FrameDone, PlainHeader, ProcessKind, SceneObject, SceneSummary};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// Separate domain of one test, on tmpfs.
struct TestDomain {
    name: DomainName,
    folder: RunFolder,
    _guard: tempfile::TempDir,
}

static N_DOMAINS: AtomicU32 = AtomicU32::new(0);

impl TestDomain {
    fn new() -> Self {
        let number = N_DOMAINS.fetch_add(1, Ordering::Relaxed);
        let name = format!("t{}-{number}", std::process::id()).parse().unwrap();
        let guard = tempfile::tempdir_in("/dev/shm").unwrap();
        Self {
            name,
            folder: RunFolder::at(guard.path().to_owned()),
            _guard: guard,
        }
    }

    fn join(&self) -> Domain {
        Domain::join(&self.name, &self.folder, Role::Guest).unwrap()
    }

    fn shared_memory_files(&self) -> Vec<String> {
        let prefix = format!(
            "tabula_{}_{}_",
            rustix::process::getuid().as_raw(),
            self.name
        );
        let entries = std::fs::read_dir("/dev/shm").unwrap().flatten();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        names.filter(|name| name.starts_with(&prefix)).collect()
    }
}

async fn watched<T>(test: impl Future<Output = T>) -> T {
    tokio::time::timeout(Duration::from_secs(20), test)
        .await
        .expect("the test hangs")
}

fn cloud_point(value: usize) -> CloudPoint {
    CloudPoint {
        x: value as f32,
        y: 0.0,
        z: 1.0,
        argb: 0,
    }
}

#[tokio::test]
async fn publisher_and_subscriber_share_the_memory_of_a_cloud() {
    let test_domain = TestDomain::new();
    let (camera, reader) = (test_domain.join(), test_domain.join());
    watched(async {
        let mut publisher = Publisher::<CameraCloud>::new(&camera).unwrap();
        let mut subscriber = Subscriber::<CameraCloud>::waiting(&reader).unwrap();
        let mut loan = publisher.loan(1000).unwrap();
        for (i, point) in loan.items_mut().iter_mut().enumerate() {
            *point = cloud_point(i);
        }
        let written = publisher.location(&loan);
        loan.header_mut().sequence = 7;
        publisher.send(loan).unwrap();
        let frame = Arc::new(subscriber.next().await.unwrap());
        assert_eq!(frame.header().sequence, 7);
        assert_ne!(written.inode, 0);
        assert_eq!(frame.location(), written);
        let threads: Vec<_> = (0..4)
            .map(|_| {
                let frame = frame.clone();
                std::thread::spawn(move || {
                    frame.items().iter().map(|p| p.x as usize).sum::<usize>()
                })
            })
            .collect();
        for thread in threads {
            assert_eq!(thread.join().unwrap(), 999 * 1000 / 2);
        }
    })
    .await;
}

#[tokio::test]
async fn publisher_reserves_memory_for_larger_frames() {
    const N_POINTS: usize = 1280 * 720;
    let test_domain = TestDomain::new();
    let (camera, reader) = (test_domain.join(), test_domain.join());
    let mut subscriber = Subscriber::<CameraCloud>::polled(&reader).unwrap();
    let mut publisher = Publisher::<CameraCloud>::for_items(&camera, N_POINTS).unwrap();
    assert!(publisher.reservation().bytes() > 34 * 16 * N_POINTS as u64);
    for sequence in 0..40 {
        let mut loan = publisher.loan(N_POINTS).unwrap();
        loan.header_mut().sequence = sequence;
        loan.items_mut()[N_POINTS - 1] = cloud_point(sequence as usize);
        publisher.send(loan).unwrap();
        let frame = subscriber.latest().unwrap().unwrap();
        assert_eq!(frame.header().sequence, sequence);
        assert_eq!(frame.items().len(), N_POINTS);
        assert_eq!(frame.items()[N_POINTS - 1].x, sequence as f32);
    }
    let longer = publisher.loan(N_POINTS + 1);
    assert!(matches!(longer, Err(Error::TooLong { max: N_POINTS, .. })));
}

#[tokio::test]
async fn publisher_of_more_than_the_free_memory_is_refused() {
    let test_domain = TestDomain::new();
    let domain = test_domain.join();
    let Err(error) = Publisher::<CameraCloud>::for_items(&domain, 1 << 40) else {
        panic!("there are not so many terabytes");
    };
    assert!(matches!(error, Error::SharedMemory { .. }), "{error}");
    assert!(Publisher::<CameraCloud>::new(&domain).is_ok());
}

#[tokio::test]
async fn overflow_of_sensor_data_drops_and_counts_the_oldest() {
    let test_domain = TestDomain::new();
    let domain = test_domain.join();
    let mut publisher = Publisher::<CameraCloud>::new(&domain).unwrap();
    let mut subscriber = Subscriber::<CameraCloud>::owner(&domain).unwrap();
    let mut send = |sequence| {
        let mut loan = publisher.loan(1).unwrap();
        loan.header_mut().sequence = sequence;
        publisher.send(loan).unwrap();
    };
    send(0);
    assert!(matches!(
        subscriber.receive().unwrap(),
        Received::Message(_)
    ));
    (1..10).for_each(&mut send);
    let mut seen = Vec::new();
    while let Received::Message(frame) = subscriber.receive().unwrap() {
        seen.push(frame.header().sequence);
    }
    assert_eq!(seen, [8, 9]);
    assert_eq!(subscriber.n_lost(), 7);
}

#[tokio::test]
async fn subscriber_reports_its_borrow_limit_and_recovers() {
    let test_domain = TestDomain::new();
    let domain = test_domain.join();
    let mut publisher = Publisher::<CameraCloud>::new(&domain).unwrap();
    let mut subscriber = Subscriber::<CameraCloud>::owner(&domain).unwrap();
    let mut held = Vec::new();
    loop {
        publisher.send(publisher.loan(1).unwrap()).unwrap();
        match subscriber.receive().unwrap() {
            Received::Message(frame) => held.push(frame),
            Received::BorrowLimitReached => break,
            Received::Nothing => panic!("nothing arrived"),
        }
    }
    assert_eq!(held.len(), 6);
    held.pop();
    assert!(matches!(
        subscriber.receive().unwrap(),
        Received::Message(_)
    ));
}

#[tokio::test]
async fn eight_guests_read_beside_the_owner_and_the_ninth_gets_a_sentence() {
    let test_domain = TestDomain::new();
    let domain = test_domain.join();
    let mut publisher = Publisher::<CameraCloud>::new(&domain).unwrap();
    let guest = || Subscriber::<CameraCloud>::polled(&domain);
    let mut guests: Vec<_> = (0..GUEST_PLACES).map(|_| guest().unwrap()).collect();
    let sentence = guest().unwrap_err().to_string();
    let words = ["all 8 places", "camera/cloud", "guest_places"];
    assert!(
        words.iter().all(|word| sentence.contains(word)),
        "{sentence}"
    );
    // The guests leave the owner its place, and all hold and queue what they may.
    let mut owner = Subscriber::<CameraCloud>::owner(&domain).unwrap();
    let mut held = Vec::new();
    for sequence in 0..20 {
        let mut loan = publisher.loan(1).unwrap();
        loan.header_mut().sequence = sequence;
        publisher.send(loan).unwrap();
        for subscriber in guests.iter_mut().chain([&mut owner]) {
            if let Received::Message(frame) = subscriber.receive().unwrap() {
                held.push(frame);
            }
        }
    }
    assert_eq!(held.len(), 8 * 2 + 6);
    held.clear();
    for guest in &mut guests {
        let newest = guest.latest().unwrap().unwrap();
        assert_eq!(newest.header().sequence, 19);
    }
    guests.pop();
    assert!(guest().is_ok(), "the place of a guest that left is free");
}

#[tokio::test]
async fn overflow_of_reports_is_an_error_for_the_sender() {
    let test_domain = TestDomain::new();
    let domain = test_domain.join();
    let mut publisher = Publisher::<FinishedFrames>::new(&domain).unwrap();
    let _subscriber = Subscriber::<FinishedFrames>::polled(&domain).unwrap();
    let mut send = || publisher.send_copy(PlainHeader::default(), &[FrameDone::default()]);
    for _ in 0..8 {
        send().unwrap();
    }
    assert!(matches!(send(), Err(Error::QueueFull { .. })));
}

#[tokio::test]
async fn history_is_delivered_to_a_late_subscriber() {
    let test_domain = TestDomain::new();
    let domain = test_domain.join();
    let mut publisher = Publisher::<Scene>::new(&domain).unwrap();
    let object = SceneObject {
        track_id: 5,
        ..SceneObject::default()
    };
    let scene = SceneSummary {
        sequence: 3,
        ..SceneSummary::default()
    };
    publisher.send_copy(scene, &[object]).unwrap();
    let mut reader = Subscriber::<Scene>::polled(&domain).unwrap();
    publisher.deliver_history().unwrap();
    let late = reader.latest().unwrap().unwrap();
    assert_eq!((late.header().sequence, late.items()[0].track_id), (3, 5));
}

#[tokio::test]
async fn loan_of_too_many_items_is_refused() {
    let test_domain = TestDomain::new();
    let publisher = Publisher::<Scene>::new(&test_domain.join()).unwrap();
    assert!(matches!(
        publisher.loan(257),
        Err(Error::TooLong { max: 256, .. })
    ));
}

#[tokio::test]
async fn domain_is_removed_by_its_last_member() {
    let test_domain = TestDomain::new();
    let (one, two) = (test_domain.join(), test_domain.join());
    let publisher = Publisher::<CameraCloud>::new(&one).unwrap();
    drop(one);
    assert!(!test_domain.shared_memory_files().is_empty());
    drop(two);
    assert!(
        !test_domain.shared_memory_files().is_empty(),
        "the publisher still belongs to the domain"
    );
    drop(publisher);
    assert!(test_domain.shared_memory_files().is_empty());
    assert!(!test_domain.folder.domain_folder(&test_domain.name).exists());
}

#[tokio::test]
async fn role_is_exclusive() {
    let test_domain = TestDomain::new();
    let role = Role::Only("tabula-camera");
    let first = Domain::join(&test_domain.name, &test_domain.folder, role).unwrap();
    let sentence = Domain::join(&test_domain.name, &test_domain.folder, role)
        .unwrap_err()
        .to_string();
    assert!(
        sentence.contains("running") && sentence.contains("--domain"),
        "{sentence}"
    );
    drop(first);
    assert!(Domain::join(&test_domain.name, &test_domain.folder, role).is_ok());
}

fn echo() -> control::Handler {
    control::handler(|command, _| async move {
        match command {
            Command::Ask { track_id } => Reply::TrackIds { first: track_id },
            Command::LeaseTrackIds { .. } => Reply::Stored,
            other => Reply::Refused(Refusal::new(RefusalKind::Invalid, format!("{other:?}"))),
        }
    })
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn request_server_answers_every_client() {
    let test_domain = TestDomain::new();
    let (server_domain, client_domain) = (test_domain.join(), test_domain.join());
    watched(async {
        let client = Arc::new(Client::new(&client_domain, ProcessKind::PERCEPTION));
        let ask = |track_id| Command::Ask { track_id };
        let early = client.call(ask(1), Duration::from_secs(1)).await;
        assert!(
            matches!(early, Err(CallError::NotThere { .. })),
            "{early:?}"
        );
        let server = Server::bind(&server_domain, ProcessKind::PERCEPTION, echo()).unwrap();
        let running = tokio::spawn(server.run());
        let calls: Vec<_> = (0..200)
            .map(|track_id| {
                let client = client.clone();
                tokio::spawn(async move {
                    client
                        .call(Command::Ask { track_id }, Duration::from_secs(15))
                        .await
                })
            })
            .collect();
        for (track_id, call) in calls.into_iter().enumerate() {
            let reply = call.await.unwrap().unwrap();
            assert_eq!(
                reply,
                Reply::TrackIds {
                    first: track_id as u64
                }
            );
        }
        running.abort();
        let _ = running.await;
        let gone = client.call(ask(1), Duration::from_secs(1)).await;
        assert!(matches!(gone, Err(CallError::NotThere { .. })), "{gone:?}");
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn request_on_behalf_of_a_user_is_that_user_s() {
    use std::os::unix::fs::PermissionsExt;
    let test_domain = TestDomain::new();
    let domain = test_domain.join();
    let user_and_role = |user: Peer| Reply::TrackIds {
        first: u64::from(user.uid) << 8 | user.role as u64,
    };
    let who = control::handler(move |_, user| async move { user_and_role(user) });
    let server = Server::bind(&domain, ProcessKind::MEMORY, who).unwrap();
    let socket = domain.request_socket(ProcessKind::MEMORY);
    let mode = std::fs::metadata(&socket).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    let running = tokio::spawn(server.run());
    let client = Client::new(&domain, ProcessKind::MEMORY);
    let second = Duration::from_secs(15);
    let own = Peer {
        uid: rustix::process::geteuid().as_raw(),
        role: UserRole::Administrator,
    };
    let reply = watched(client.call(Command::Objects, second)).await;
    assert_eq!(reply.unwrap(), user_and_role(own));
    let user = Peer {
        uid: 4711,
        role: UserRole::Reader,
    };
    let reply = watched(client.call_for(user, Command::Objects, second)).await;
    assert_eq!(reply.unwrap(), user_and_role(user));
    running.abort();
    let _ = running.await;
    assert!(!socket.exists());
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn request_to_a_silent_server_times_out() {
    let test_domain = TestDomain::new();
    let domain = test_domain.join();
    let silent = control::handler(|_, _| std::future::pending());
    let server = Server::bind(&domain, ProcessKind::MEMORY, silent).unwrap();
    let running = tokio::spawn(server.run());
    let client = Client::new(&domain, ProcessKind::MEMORY);
    let answer = watched(client.call(Command::Categories, Duration::from_millis(200))).await;
    assert!(
        matches!(answer, Err(CallError::TimedOut { .. })),
        "{answer:?}"
    );
    running.abort();
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn request_after_many_that_were_given_up_is_answered() {
    let test_domain = TestDomain::new();
    let domain = test_domain.join();
    let slow = control::handler(|_, _| async {
        tokio::time::sleep(Duration::from_millis(100)).await;
        Reply::Stored
    });
    let server = Server::bind(&domain, ProcessKind::MEMORY, slow).unwrap();
    let running = tokio::spawn(server.run());
    let client = Client::new(&domain, ProcessKind::MEMORY);
    for _ in 0..10 {
        let given_up = client.call(Command::Categories, Duration::from_millis(5));
        assert!(matches!(given_up.await, Err(CallError::TimedOut { .. })));
    }
    let answer = watched(client.call(Command::Categories, Duration::from_secs(10))).await;
    assert!(matches!(answer, Ok(Reply::Stored)), "{answer:?}");
    running.abort();
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn control_socket_answers_clients_and_refuses_invalid_bytes() {
    use std::io::{Read, Write};
    let test_domain = TestDomain::new();
    let domain = test_domain.join();
    let groups = RoleGroups {
        teachers: "tabula".into(),
        administrators: "tabula-admin".into(),
    };
    let server = SocketServer::bind(&domain.control_socket(), &groups, echo(), echo()).unwrap();
    let running = tokio::spawn(server.run());
    let (name, folder) = (test_domain.name.clone(), test_domain.folder.clone());
    let path = domain.control_socket();
    let people = tokio::task::spawn_blocking(move || {
        let folders = [RunFolder::at("/nowhere".into()), folder];
        let mut client = DaemonClient::connect(&name, &folders, Duration::from_secs(5)).unwrap();
        for track_id in 0..50 {
            let reply = client.call(Command::Ask { track_id }).unwrap();
            assert_eq!(reply, Reply::TrackIds { first: track_id });
        }
        let internal = client.call(Command::Snapshot { after: None }).unwrap();
        assert!(matches!(internal, Reply::Refused(_)));
        for rubbish in [vec![0xff; 4], vec![3, 0, 0, 0, 1, 2, 3], vec![1]] {
            let mut stream = std::os::unix::net::UnixStream::connect(&path).unwrap();
            stream.write_all(&rubbish).unwrap();
            stream.shutdown(std::net::Shutdown::Write).unwrap();
            let mut answer = Vec::new();
            stream.read_to_end(&mut answer).unwrap();
            assert!(answer.len() < MAX_MESSAGE_BYTES);
        }
        assert!(client.call(Command::Ask { track_id: 1 }).is_ok());
        let nobody = "nobody".parse().unwrap();
        let sentence = DaemonClient::connect(&nobody, &folders, Duration::from_secs(1))
            .unwrap_err()
            .to_string();
        assert!(
            sentence.contains("tabula run --domain nobody"),
            "{sentence}"
        );
    });
    watched(people).await.unwrap();
    running.abort();
}

#[test]
fn domain_in_a_run_folder_that_is_a_symbolic_link_is_refused() {
    let test_domain = TestDomain::new();
    let elsewhere = tempfile::tempdir().unwrap();
    let link = test_domain.folder.path().join("run");
    std::os::unix::fs::symlink(elsewhere.path(), &link).unwrap();
    let joined = Domain::join(&test_domain.name, &RunFolder::at(link), Role::Guest);
    assert!(matches!(joined, Err(Error::Untrusted { .. })), "{joined:?}");
    assert_eq!(std::fs::read_dir(elsewhere.path()).unwrap().count(), 0);
}

#[test]
fn domain_whose_role_lock_is_a_symbolic_link_is_refused() {
    let test_domain = TestDomain::new();
    let victim = test_domain.folder.path().join("victim");
    std::fs::write(&victim, "precious").unwrap();
    let folder = test_domain.folder.domain_folder(&test_domain.name);
    std::fs::create_dir(&folder).unwrap();
    std::os::unix::fs::symlink(&victim, folder.join("tabula-camera.lock")).unwrap();
    let joined = Domain::join(
        &test_domain.name,
        &test_domain.folder,
        Role::Only("tabula-camera"),
    );
    assert!(matches!(joined, Err(Error::Untrusted { .. })), "{joined:?}");
    assert_eq!(std::fs::read_to_string(&victim).unwrap(), "precious");
}

#[test]
fn domain_that_cannot_be_joined_leaves_no_folder_behind() {
    let folder_after = |spoil: &dyn Fn(&TestDomain)| {
        let test_domain = TestDomain::new();
        let folder = test_domain.folder.domain_folder(&test_domain.name);
        std::fs::create_dir(&folder).unwrap();
        spoil(&test_domain);
        let joined = Domain::join(&test_domain.name, &test_domain.folder, Role::Guest);
        assert!(joined.is_err(), "{joined:?}");
        folder.exists()
    };
    let without_node = |test_domain: &TestDomain| {
        let folder = test_domain.folder.domain_folder(&test_domain.name);
        std::fs::write(folder.join("iox2"), "not a folder").unwrap();
    };
    assert!(!folder_after(&without_node), "no node can be made");
    let foreign_file = std::cell::Cell::new(None);
    let with_foreign_file = |test_domain: &TestDomain| {
        let uid = rustix::process::getuid().as_raw();
        let name = format!("/dev/shm/tabula_{uid}_{}_x", test_domain.name);
        std::os::unix::fs::symlink(test_domain.folder.path(), &name).unwrap();
        foreign_file.set(Some(name));
    };
    let is_left = folder_after(&with_foreign_file);
    // Nobody else removes what is foreign to the domain.
    std::fs::remove_file(foreign_file.take().unwrap()).unwrap();
    assert!(!is_left, "a name is taken");
}

/// Files of the domain in shared memory, with their sizes and allocated sizes, bytes.
fn segments(test_domain: &TestDomain) -> Vec<(String, u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    let files = test_domain.shared_memory_files();
    let sizes = files.into_iter().map(|name| {
        let file = std::fs::metadata(format!("/dev/shm/{name}")).unwrap();
        (name, file.len(), file.blocks() * 512)
    });
    sizes.collect()
}

#[tokio::test]
async fn segments_of_publishers_are_backed_when_they_are_made() {
    let test_domain = TestDomain::new();
    let domain = test_domain.join();
    let publisher = Publisher::<CameraCloud>::new(&domain).unwrap();
    let _scenes = Publisher::<Scene>::new(&domain).unwrap();
    let data: Vec<_> = segments(&test_domain)
        .into_iter()
        .filter(|(name, ..)| std::path::Path::new(name).extension() == Some("data".as_ref()))
        .collect();
    assert_eq!(data.len(), 2, "{data:?}");
    assert!(
        data.iter()
            .any(|(_, size, _)| *size >= publisher.reservation().slots * 4_915_200)
    );
    for (name, size, allocated) in &data {
        assert!(
            allocated >= size,
            "{name}: {allocated} of {size} bytes are allocated"
        );
    }
}
