//! Upgrade: views that an earlier version stored are recognised by this one.

use crate::daemon::{Daemon, Sandbox, WATCHDOG};
use crate::skeleton::{id, wait_for_all};
use channel::control::Client;
use channel::{Domain, Role};
use control_protocol::DescriptorBytes;
use control_protocol::{Command, Labelling, LearnedView, MutationId, Reply, StoredView, ViewId};
use message::ProcessKind;

/// Client of the memory with the rights of the daemon's own processes.
struct MemoryClient {
    client: Client,
    runtime: tokio::runtime::Runtime,
}

impl MemoryClient {
    fn of(sandbox: &Sandbox) -> Self {
        let domain = Domain::join(&sandbox.domain, &sandbox.run_folder(), Role::Guest).unwrap();
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .unwrap();
        let client = Client::new(&domain, ProcessKind::MEMORY);
        Self { client, runtime }
    }
}

fn call(memory: &mut MemoryClient, command: Command) -> Reply {
    let answered = memory.client.call(command, WATCHDOG);
    memory.runtime.block_on(answered).unwrap()
}

fn labelled_views(memory: &mut MemoryClient) -> Vec<LearnedView> {
    let Reply::Snapshot(page) = call(memory, Command::Snapshot { after: None }) else {
        panic!("no views are answered")
    };
    page.views
}

/// Stores the points of the labelled views as an earlier version would have: with a descriptor
/// of another kind and length.
fn store_as_earlier_version(memory: &mut MemoryClient, category: &str) {
    let ids: Vec<ViewId> = labelled_views(memory).iter().map(|view| view.id).collect();
    let Reply::Clouds(clouds) = call(memory, Command::Clouds { ids }) else {
        panic!("no points are answered")
    };
    let lease = Command::LeaseTrackIds { count: 1 };
    let Reply::TrackIds { first: track_id } = call(memory, lease) else {
        panic!("no track-id is leased")
    };
    let views = (0..).zip(clouds).map(|(view_id, points)| StoredView {
        id: ViewId { track_id, view_id },
        descriptor_kind: "appearance-0".into(),
        descriptor: DescriptorBytes::encode(&[0.5; 12]),
        position_m: [0.1, 0.2, 0.3],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m: [0.1; 3],
        captured_ns: 5,
        frame_sequence: 7,
        source_name: "earlier version".into(),
        points: points.into_vec(),
        mean_rgb: None,
    });
    let store = Command::StoreViews {
        id: MutationId(1),
        views: views.collect(),
    };
    let stored = call(memory, store);
    assert!(matches!(stored, Reply::Stored), "{stored:?}");
    let teach = Command::Teach(Labelling {
        is_new: false,
        id: MutationId(2),
        author: "anna".to_owned(),
        track_id,
        category: category.to_owned(),
    });
    let taught = call(memory, teach);
    assert!(matches!(taught, Reply::Learned(_)), "{taught:?}");
}

fn label(daemon: &Daemon<'_>, track: &str) -> String {
    let object = daemon.ask(&["ask", track]);
    object["label"].as_str().unwrap_or_default().to_owned()
}

#[test]
fn views_of_an_earlier_version_are_recognised_and_stay_as_they_were_stored() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let track = id(&wait_for_all(&daemon, 0)[0]);
    daemon.ask(&["teach", &track, "mug"]);
    let mut memory = MemoryClient::of(&sandbox);
    store_as_earlier_version(&mut memory, "old mug");
    daemon.ask(&["forget", "mug"]);
    assert_eq!(label(&daemon, &track), "old mug");
    drop(memory);
    daemon.stop();

    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let labels = wait_for_all(&daemon, 0)
        .into_iter()
        .map(|object| label(&daemon, &id(&object)));
    assert_eq!(labels.filter(|label| label == "old mug").count(), 1);
    let mut memory = MemoryClient::of(&sandbox);
    for view in labelled_views(&mut memory) {
        assert_eq!(view.descriptor_kind, "appearance-0");
        assert_eq!(view.descriptor.decode().unwrap(), [0.5; 12]);
    }
    drop(memory);
    daemon.stop();
}
