//! Ports, carriers and clean-up over real shared memory, each test in a domain
//! of its own.
#![expect(clippy::unwrap_used, reason = "helpers of tests panic as tests do")]

use channel::control::{AnswerFuture, CallError, Client, Server, SocketClient, SocketServer};
use channel::topic::{CameraCloud, FrameFinished, Scene};
use channel::{Domain, DomainName, Error, Publisher, Received, Role, RunFolder, Subscriber};
use message::control::{Command, MAX_MESSAGE_BYTES, Refusal, RefusalKind, Reply};
use message::{CloudPoint, FrameDone, PlainHeader, ProcessKind, SceneObject, SceneSummary};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// A domain of a test's own, on tmpfs.
struct Place {
    name: DomainName,
    folder: RunFolder,
    _guard: tempfile::TempDir,
}

static N_PLACES: AtomicU32 = AtomicU32::new(0);

impl Place {
    fn new() -> Self {
        let number = N_PLACES.fetch_add(1, Ordering::Relaxed);
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

    fn shared_memory_files(&self) -> usize {
        let prefix = format!(
            "tabula_{}_{}_",
            rustix::process::getuid().as_raw(),
            self.name
        );
        let entries = std::fs::read_dir("/dev/shm").unwrap().flatten();
        entries
            .filter(|e| e.file_name().to_string_lossy().starts_with(&prefix))
            .count()
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
async fn a_cloud_is_written_once_and_read_where_it_was_written() {
    let place = Place::new();
    let (camera, reader) = (place.join(), place.join());
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
async fn sensor_data_drops_the_oldest_and_counts_it() {
    let place = Place::new();
    let domain = place.join();
    let mut publisher = Publisher::<CameraCloud>::new(&domain).unwrap();
    let mut subscriber = Subscriber::<CameraCloud>::polled(&domain).unwrap();
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
async fn a_subscriber_that_holds_all_it_may_says_so_and_goes_on() {
    let place = Place::new();
    let domain = place.join();
    let mut publisher = Publisher::<CameraCloud>::new(&domain).unwrap();
    let mut subscriber = Subscriber::<CameraCloud>::polled(&domain).unwrap();
    let mut held = Vec::new();
    loop {
        publisher.send(publisher.loan(1).unwrap()).unwrap();
        match subscriber.receive().unwrap() {
            Received::Message(frame) => held.push(frame),
            Received::HoldsAll => break,
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
async fn reports_that_must_arrive_are_refused_when_the_queue_is_full() {
    let place = Place::new();
    let domain = place.join();
    let mut publisher = Publisher::<FrameFinished>::new(&domain).unwrap();
    let _subscriber = Subscriber::<FrameFinished>::polled(&domain).unwrap();
    let mut send = || publisher.send_copy(PlainHeader::default(), &[FrameDone::default()]);
    for _ in 0..8 {
        send().unwrap();
    }
    assert!(matches!(send(), Err(Error::QueueFull { .. })));
}

#[tokio::test]
async fn a_late_reader_gets_the_latest_scene() {
    let place = Place::new();
    let domain = place.join();
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
    publisher.greet_new_subscribers().unwrap();
    let late = reader.latest().unwrap().unwrap();
    assert_eq!((late.header().sequence, late.items()[0].track_id), (3, 5));
}

#[tokio::test]
async fn too_many_items_are_refused() {
    let place = Place::new();
    let publisher = Publisher::<Scene>::new(&place.join()).unwrap();
    assert!(matches!(
        publisher.loan(257),
        Err(Error::TooLong { max: 256, .. })
    ));
}

#[tokio::test]
async fn the_last_one_out_leaves_nothing() {
    let place = Place::new();
    let (one, two) = (place.join(), place.join());
    let publisher = Publisher::<CameraCloud>::new(&one).unwrap();
    drop(one);
    assert!(place.shared_memory_files() > 0);
    drop(two);
    assert!(
        place.shared_memory_files() > 0,
        "the publisher still belongs to the domain"
    );
    drop(publisher);
    assert_eq!(place.shared_memory_files(), 0);
    assert!(!place.folder.of_domain(&place.name).exists());
}

#[tokio::test]
async fn a_role_is_taken_once() {
    let place = Place::new();
    let role = Role::Only("tabula-camera");
    let first = Domain::join(&place.name, &place.folder, role).unwrap();
    let sentence = Domain::join(&place.name, &place.folder, role)
        .unwrap_err()
        .to_string();
    assert!(
        sentence.contains("running") && sentence.contains("--domain"),
        "{sentence}"
    );
    drop(first);
    assert!(Domain::join(&place.name, &place.folder, role).is_ok());
}

fn echo() -> channel::control::Handler {
    Arc::new(|command| -> AnswerFuture {
        Box::pin(async move {
            match command {
                Command::Ask { track_id } => Reply::TrackIds { first: track_id },
                Command::LeaseTrackIds { .. } => Reply::Stored,
                other => Reply::Refused(Refusal::new(RefusalKind::Invalid, format!("{other:?}"))),
            }
        })
    })
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn requests_between_processes_are_answered_each() {
    let place = Place::new();
    let (server_domain, client_domain) = (place.join(), place.join());
    watched(async {
        let client = Arc::new(Client::new(&client_domain, ProcessKind::Perception).unwrap());
        let ask = |track_id| Command::Ask { track_id };
        let early = client.call(ask(1), Duration::from_secs(1)).await;
        assert!(
            matches!(early, Err(CallError::NotThere { .. })),
            "{early:?}"
        );
        let server = Server::new(&server_domain, ProcessKind::Perception, echo()).unwrap();
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
async fn a_server_that_says_nothing_is_a_timeout() {
    let place = Place::new();
    let domain = place.join();
    let silent: channel::control::Handler =
        Arc::new(|_| -> AnswerFuture { Box::pin(std::future::pending()) });
    let server = Server::new(&domain, ProcessKind::Memory, silent).unwrap();
    let running = tokio::spawn(server.run());
    let client = Client::new(&domain, ProcessKind::Memory).unwrap();
    let answer = watched(client.call(Command::Categories, Duration::from_millis(200))).await;
    assert!(
        matches!(answer, Err(CallError::TimedOut { .. })),
        "{answer:?}"
    );
    running.abort();
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_socket_answers_people_and_refuses_rubbish() {
    use std::io::{Read, Write};
    let place = Place::new();
    let domain = place.join();
    let server = SocketServer::bind(&domain.control_socket(), echo()).unwrap();
    let running = tokio::spawn(server.run());
    let (name, folder) = (place.name.clone(), place.folder.clone());
    let path = domain.control_socket();
    let people = tokio::task::spawn_blocking(move || {
        let folders = [RunFolder::at("/nowhere".into()), folder];
        let mut client = SocketClient::connect(&name, &folders, Duration::from_secs(5)).unwrap();
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
        let sentence = SocketClient::connect(&nobody, &folders, Duration::from_secs(1))
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
    let place = Place::new();
    let elsewhere = tempfile::tempdir().unwrap();
    let link = place.folder.path().join("run");
    std::os::unix::fs::symlink(elsewhere.path(), &link).unwrap();
    let joined = Domain::join(&place.name, &RunFolder::at(link), Role::Guest);
    assert!(matches!(joined, Err(Error::Untrusted { .. })), "{joined:?}");
    assert_eq!(std::fs::read_dir(elsewhere.path()).unwrap().count(), 0);
}

#[test]
fn domain_whose_role_lock_is_a_symbolic_link_is_refused() {
    let place = Place::new();
    let victim = place.folder.path().join("victim");
    std::fs::write(&victim, "precious").unwrap();
    let folder = place.folder.of_domain(&place.name);
    std::fs::create_dir(&folder).unwrap();
    std::os::unix::fs::symlink(&victim, folder.join("tabula-camera.lock")).unwrap();
    let joined = Domain::join(&place.name, &place.folder, Role::Only("tabula-camera"));
    assert!(matches!(joined, Err(Error::Untrusted { .. })), "{joined:?}");
    assert_eq!(std::fs::read_to_string(&victim).unwrap(), "precious");
}
