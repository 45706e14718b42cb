//! Documents over the real socket: large ones in pages, replaced, cut off and repeated ones, hostile
//! requests, and models of objects.

use crate::daemon::{Sandbox, WATCHDOG, eventually};
use control_client::{NewDocument, read_document, try_put_document};
use control_protocol::{
    Command, ContentDigest, DOCUMENT_PAGE_BYTES, DocumentKind, DocumentName, DocumentPage,
    JobCommand, JobKind, LearningReport, MAX_DOCUMENT_BYTES, MemoryAnswer, MemoryQuery, MutationId,
    PageRequest, Refusal, RefusalKind, Reply, Revision, RevisionChange, request,
};
use daemon_client::DaemonClient;
use mesh::Vertex;
use message::ProcessKind;
use nalgebra::{Point3, Vector3};
use object_model::{
    DirectionSphere, ModelMesh, ModelView, ObjectModel, RefusedView, UnseenDirections,
};
use random::Random;
use rustix::process::Signal;
use serde_json::Value;
use std::time::{Duration, Instant};

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];
/// Time after which the memory ends an upload that nobody writes to, and a margin.
const UPLOAD_LIFE: Duration = Duration::from_secs(23);

fn connect(sandbox: &Sandbox) -> DaemonClient {
    DaemonClient::connect(&sandbox.domain, &[sandbox.run_folder()], WATCHDOG).unwrap()
}

fn note(name: &str) -> DocumentName {
    DocumentName {
        kind: DocumentKind::TaskKnowledge,
        name: name.to_owned(),
    }
}

/// Bytes that no compression makes smaller.
fn noise(n_bytes: usize, seed: u64) -> Vec<u8> {
    let mut random = Random::from_seed(seed);
    let words = std::iter::repeat_with(|| random.next_u64().to_le_bytes());
    words.flatten().take(n_bytes).collect()
}

pub(crate) fn random_id() -> MutationId {
    MutationId::random().unwrap()
}

/// Stores a document, which must succeed; returns the report.
fn put(client: &mut DaemonClient, name: &DocumentName, content: &[u8]) -> LearningReport {
    let new = NewDocument {
        document: name,
        media_type: "application/octet-stream",
        content,
    };
    let call = |command| client.call(command);
    try_put_document(random_id(), "anna", new, &mut None, call).unwrap()
}

fn read(client: &mut DaemonClient, name: &DocumentName) -> Vec<u8> {
    let document = read_document(name, |command| client.call(command)).unwrap();
    assert_eq!(document.report.digest, ContentDigest::of(&document.content));
    document.content
}

fn refused(reply: Reply) -> Refusal {
    match reply {
        Reply::Refused(refusal) => refusal,
        other => panic!("{other:?}"),
    }
}

fn page(client: &mut DaemonClient, request: PageRequest) -> Result<DocumentPage, Refusal> {
    let query = Command::Memory(MemoryQuery::Document(request));
    match client.call(query).unwrap() {
        Reply::Memory(MemoryAnswer::Document(page)) => Ok(page),
        other => Err(refused(other)),
    }
}

/// Begins the upload of a document; returns its id.
fn begin(client: &mut DaemonClient) -> u64 {
    let begin = Command::Job(JobCommand::Begin(JobKind::Document));
    match client.call(begin).unwrap() {
        Reply::Job(report) => report.job,
        other => panic!("{other:?}"),
    }
}

fn write(client: &mut DaemonClient, job: u64, offset: u64, bytes: &[u8]) -> Reply {
    let bytes = bytes.to_vec();
    let write = Command::Job(JobCommand::Write { job, offset, bytes });
    client.call(write).unwrap()
}

/// Change that stores an upload under a name.
fn change(id: MutationId, name: &DocumentName, upload: u64, content: &[u8]) -> Command {
    Command::Revise(Revision {
        id,
        author: "anna".into(),
        change: RevisionChange::PutDocument {
            document: name.clone(),
            media_type: "text/plain".into(),
            upload,
            digest: ContentDigest::of(content),
        },
    })
}

#[test]
fn document_of_16_mb_is_stored_and_read_and_a_larger_one_refused() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let mut client = connect(&sandbox);
    let content = noise(MAX_DOCUMENT_BYTES as usize, 1);
    let name = note("map");
    let begun = Instant::now();
    put(&mut client, &name, &content);
    let stored = begun.elapsed();
    let begun = Instant::now();
    assert!(read(&mut client, &name) == content, "other bytes are read");
    eprintln!(
        "16 MB: stored in {stored:.2?}, read in {:.2?}",
        begun.elapsed()
    );

    let file = sandbox.home().join("large");
    std::fs::write(&file, [&content[..], b"x"].concat()).unwrap();
    let put_large = ["knowledge", "put", "larger", file.to_str().unwrap()];
    let (code, sentence) = daemon.refused(&put_large);
    assert_eq!(code, 4, "{sentence}");
    assert!(sentence.contains("at most 16777216 bytes"), "{sentence}");
    daemon.stop();

    // The same without a daemon.
    let file = sandbox.home().join("copy");
    let output = sandbox.tabula(&["knowledge", "get", "map"]);
    assert!(output.stdout == content, "{:?}", output.status);
    std::fs::write(&file, &output.stdout[1..]).unwrap();
    let again = ["knowledge", "put", "copy", file.to_str().unwrap()];
    assert!(sandbox.tabula(&again).status.success());
    let output = sandbox.tabula(&["knowledge", "get", "copy"]);
    assert!(output.stdout == content[1..], "{:?}", output.status);
}

#[test]
fn document_that_is_replaced_while_it_is_read_is_refused() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let mut client = connect(&sandbox);
    let name = note("map");
    let (old, new) = (noise(600_000, 1), noise(700_000, 2));
    put(&mut client, &name, &old);
    let request = |digest, offset| PageRequest {
        document: name.clone(),
        digest,
        offset,
    };
    let first = page(&mut client, request(None, 0)).unwrap();
    assert_eq!(first.content, old[..DOCUMENT_PAGE_BYTES]);
    let next = request(Some(first.document.digest), DOCUMENT_PAGE_BYTES as u64);
    let second = page(&mut client, next.clone()).unwrap();
    assert!(old[DOCUMENT_PAGE_BYTES..].starts_with(&second.content));

    let report = put(&mut connect(&sandbox), &name, &new);
    let refusal = page(&mut client, next.clone()).unwrap_err();
    assert_eq!(refusal.kind, RefusalKind::Conflict);
    let expected = format!(
        "was replaced while it was read, by entry {}",
        report.sequence
    );
    assert!(refusal.sentence.contains(&expected), "{refusal}");
    assert_eq!(read(&mut client, &name), new);

    // The old version is back: its reader goes on.
    daemon.ask(&["undo", &report.sequence.to_string()]);
    assert_eq!(
        page(&mut client, next.clone()).unwrap(),
        second_of(&second, &mut client, &name)
    );
    daemon.ask(&["knowledge", "remove", "map"]);
    assert_eq!(
        page(&mut client, next).unwrap_err().kind,
        RefusalKind::NotFound
    );
    daemon.stop();
}

/// The page with the metadata of the present version, which an undo has decided again.
fn second_of(page: &DocumentPage, client: &mut DaemonClient, name: &DocumentName) -> DocumentPage {
    let document = read_document(name, |command| client.call(command)).unwrap();
    DocumentPage {
        document: document.report,
        ..page.clone()
    }
}

#[test]
fn upload_that_is_cut_off_stores_nothing_and_ends() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let content = noise(600_000, 3);
    let name = note("cut");
    let mut client = connect(&sandbox);
    let upload = begin(&mut client);
    write(&mut client, upload, 0, &content[..DOCUMENT_PAGE_BYTES]);
    drop(client);

    let mut client = connect(&sandbox);
    let store = change(random_id(), &name, upload, &content);
    let refusal = refused(client.call(store.clone()).unwrap());
    assert_eq!(refusal.kind, RefusalKind::Invalid);
    assert!(
        refusal.sentence.contains("262144 uploaded bytes"),
        "{refusal}"
    );
    std::thread::sleep(UPLOAD_LIFE);
    let mut client = connect(&sandbox);
    let refusal = refused(client.call(store).unwrap());
    assert_eq!(refusal.kind, RefusalKind::NotFound, "{refusal}");
    let (_, sentence) = daemon.refused(&["knowledge", "get", "cut"]);
    assert!(
        sentence.contains("there is no document \"cut\""),
        "{sentence}"
    );
    let exchange = sandbox.home().join("exchange");
    let left = std::fs::read_dir(exchange).map_or(0, Iterator::count);
    assert_eq!(left, 0, "an upload has no name");
    daemon.stop();
}

#[test]
fn two_uploaders_do_not_disturb_each_other() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    std::thread::scope(|scope| {
        for uploader in 0..2 {
            let sandbox = &sandbox;
            scope.spawn(move || {
                let mut client = connect(sandbox);
                let name = note(&format!("map {uploader}"));
                for round in 0..5 {
                    let content = noise(2_000_000 + round, 10 * uploader + round as u64);
                    put(&mut client, &name, &content);
                    assert!(read(&mut client, &name) == content, "{uploader} {round}");
                }
            });
        }
    });
    let listed = daemon.ask(&["knowledge", "list"]);
    assert_eq!(listed["documents"].as_array().unwrap().len(), 2);
    daemon.stop();
}

#[test]
fn repeated_storing_is_answered_and_not_made_twice() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let mut client = connect(&sandbox);
    let content = noise(300_000, 4);
    let name = note("map");
    let upload = begin(&mut client);
    for (number, part) in content.chunks(DOCUMENT_PAGE_BYTES).enumerate() {
        write(
            &mut client,
            upload,
            (number * DOCUMENT_PAGE_BYTES) as u64,
            part,
        );
    }
    let store = change(random_id(), &name, upload, &content);
    let first = client.call(store.clone()).unwrap();
    assert!(matches!(first, Reply::Learned(_)), "{first:?}");
    // The upload has ended with the change.
    assert_eq!(client.call(store.clone()).unwrap(), first);
    let changes = daemon.changes();
    assert_eq!(changes.len(), 1, "{changes:?}");
    assert_eq!(write_kind(&mut client, upload), RefusalKind::NotFound);

    // Another process, in which another upload has the same id.
    let pid = daemon.pid(ProcessKind::MEMORY);
    daemon.signal(ProcessKind::MEMORY, Signal::KILL);
    eventually("the memory is another process", || {
        let now = daemon.pid(ProcessKind::MEMORY);
        now.is_some() && now != pid
    });
    daemon.wait_for("the memory answers", |_| {
        let folders = [sandbox.run_folder()];
        DaemonClient::ask_once(&sandbox.domain, &folders, WATCHDOG, &request::stats()).is_ok()
    });
    let mut client = connect(&sandbox);
    assert_eq!(begin(&mut client), upload);
    assert_eq!(client.call(store).unwrap(), first);
    assert_eq!(daemon.changes(), changes);
    assert_eq!(read(&mut client, &name), content);
    daemon.stop();
}

fn write_kind(client: &mut DaemonClient, upload: u64) -> RefusalKind {
    refused(write(client, upload, 0, b"x")).kind
}

#[test]
fn hostile_requests_about_documents_are_refused_with_a_sentence() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let mut client = connect(&sandbox);
    let name = note("map");
    let content = noise(1000, 5);
    put(&mut client, &name, &content);
    let mut at = |digest, offset| {
        let document = name.clone();
        page(
            &mut client,
            PageRequest {
                document,
                digest,
                offset,
            },
        )
    };
    assert_eq!(at(None, 1000).unwrap().content, b"");
    assert_eq!(at(None, 999).unwrap().content, content[999..]);
    for offset in [1001, u64::from(u32::MAX), u64::MAX] {
        let refusal = at(None, offset).unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::Invalid, "{offset}");
        assert!(refusal.sentence.contains("1000 bytes"), "{refusal}");
    }
    let other = Some(ContentDigest(7));
    assert_eq!(at(other, 0).unwrap_err().kind, RefusalKind::Conflict);

    let upload = begin(&mut client);
    for offset in [MAX_DOCUMENT_BYTES, u64::MAX - 3, u64::MAX] {
        let refusal = refused(write(&mut client, upload, offset, b"four"));
        assert_eq!(refusal.kind, RefusalKind::Invalid, "{offset}");
        assert!(refusal.sentence.contains("16777216 bytes"), "{refusal}");
    }
    // A hole up to the limit is read as zeros, and takes no disk.
    write(&mut client, upload, MAX_DOCUMENT_BYTES - 1, &[0]);
    let zeros = vec![0; MAX_DOCUMENT_BYTES as usize];
    for (wrong, name, digest_of) in [
        ("digest", note("map"), &b"other"[..]),
        ("its name is empty", note(""), &zeros),
        ("its name is too long", note(&"x".repeat(300)), &zeros),
    ] {
        let store = change(random_id(), &name, upload, digest_of);
        let refusal = refused(client.call(store).unwrap());
        assert_eq!(refusal.kind, RefusalKind::Invalid, "{refusal}");
        assert!(refusal.sentence.contains(wrong), "{refusal}");
    }
    let unknown = change(random_id(), &name, 999, b"");
    let refusal = refused(client.call(unknown).unwrap());
    assert_eq!(refusal.kind, RefusalKind::NotFound);
    assert_eq!(read(&mut client, &name), content, "nothing was changed");
    daemon.stop();
}

/// Stored model of a half box, 100 x 60 x 80 mm, whose back and underside were never seen.
pub(crate) fn store_model(sandbox: &Sandbox, name: &str) -> ObjectModel {
    let vertex = |x: f32, y: f32, z: f32| Vertex {
        position: Point3::new(x, y, z),
        normal: Vector3::y(),
        color: [200, 30, 60],
    };
    let model = ObjectModel {
        mesh: ModelMesh {
            vertices: vec![
                vertex(0.0, 0.0, 0.0),
                vertex(0.1, 0.0, 0.0),
                vertex(0.1, 0.0, 0.08),
                vertex(0.0, 0.06, 0.08),
            ],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        },
        views: vec![ModelView {
            object_from_camera: geometry::RigidTransform::translation(0.0, -0.8, 0.3),
            captured_ns: 1_795_347_556_000_000_000,
            n_points: 4321,
            new_surface_share: 1.0,
        }],
        refused: vec![RefusedView {
            captured_ns: 1_795_347_557_000_000_000,
            reason: "its pose contradicts the surface".into(),
        }],
        is_closed_loop: false,
        unseen: UnseenDirections::of(DirectionSphere::Icosphere162, |d| {
            d.z < -0.75 || (d.z.abs() < 0.7 && d.y > 0.01)
        }),
    };
    let document = DocumentName {
        kind: DocumentKind::ObjectModel,
        name: name.to_owned(),
    };
    let new = NewDocument {
        document: &document,
        media_type: object_model::MEDIA_TYPE,
        content: &model.to_bytes().unwrap(),
    };
    let mut client = connect(sandbox);
    let call = |command| client.call(command);
    try_put_document(random_id(), "anna", new, &mut None, call).unwrap();
    model
}

/// Text that a command prints.
fn printed(sandbox: &Sandbox, arguments: &[&str]) -> String {
    let output = sandbox.tabula(arguments);
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn model_is_shown_exported_and_forgotten_with_and_without_a_daemon() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let none = printed(&sandbox, &["model", "list"]);
    assert!(none.contains("no model is stored"), "{none}");
    let model = store_model(&sandbox, "cereal box");
    daemon.ask(&["knowledge", "put", "cereal box", "/etc/hostname"]);
    let with_daemon = check_model(&sandbox, &model);
    daemon.stop();
    assert_eq!(check_model(&sandbox, &model), with_daemon, "the same words");
    let kept = printed(&sandbox, &["knowledge", "list"]);
    assert!(kept.contains("cereal box"), "a note of the same name stays");
}

/// Checks the commands on a model, forgets it, and restores it; returns what is shown of it.
fn check_model(sandbox: &Sandbox, model: &ObjectModel) -> String {
    let listed = printed(sandbox, &["model", "list"]);
    assert_eq!(listed.lines().count(), 2, "{listed}");
    assert!(listed.contains("cereal box"), "{listed}");
    let shown = printed(sandbox, &["model", "show", "cereal box"]);
    for words in [
        "100 x 60 x 80 mm, 4 vertices, 2 triangles",
        "fused from 1 view(s), not in a closed loop around it; 1 view(s) were refused",
        "missing: the underside, the sides from 0° to 180° (from x towards y of its frame)",
        "stored by ",
        "its pose contradicts the surface",
    ] {
        assert!(shown.contains(words), "{words}: {shown}");
    }
    let file = sandbox.home().join("box.ply");
    let out = ["--out", file.to_str().unwrap()];
    let exported = printed(
        sandbox,
        &[&["model", "export", "cereal box"], &out[..]].concat(),
    );
    assert!(exported.contains("4 vertices"), "{exported}");
    let mesh = dataset::ply::open(&file).unwrap();
    assert_eq!(mesh.triangles, model.mesh.triangles);
    assert_eq!(mesh.vertices[3].color.rgb(), [200, 30, 60]);

    let forgotten = sandbox.tabula(&["model", "forget", "cereal box", "--json"]);
    let report: Value = serde_json::from_slice(&forgotten.stdout).unwrap();
    let entry = report["sequence"].to_string();
    for verb in ["show", "export", "forget"] {
        let gone = sandbox.tabula(&["model", verb, "cereal box"]);
        assert_eq!(gone.status.code(), Some(4), "{gone:?}");
    }
    restore(sandbox, &entry);
    shown.lines().take(2).collect()
}

/// Undoes an entry of the history, with or without a daemon.
fn restore(sandbox: &Sandbox, entry: &str) {
    let undone = sandbox.tabula(&["undo", entry]);
    assert!(undone.status.success(), "{undone:?}");
}

#[test]
fn what_is_no_model_is_told_and_can_be_forgotten() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let name = DocumentName {
        kind: DocumentKind::ObjectModel,
        name: "rubbish".into(),
    };
    put(&mut connect(&sandbox), &name, b"no model");
    for verb in ["show", "export"] {
        let (code, sentence) = daemon.refused(&["model", verb, "rubbish"]);
        assert_eq!(code, 1, "{sentence}");
        assert!(sentence.contains("no object model"), "{sentence}");
    }
    daemon.ask(&["model", "forget", "rubbish"]);
    daemon.stop();
}
