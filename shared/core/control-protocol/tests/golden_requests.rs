//! Golden bytes of the requests of the control protocol, as programs of others send them.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use control_protocol::{
    ArmCommand, ArmLease, ArmMotion, Command, ContentDigest, DescriptorBytes, DocumentKind,
    DocumentName, FactFilter, FindQuery, ImportCompletion, JobCommand, JobKind, Labelling,
    MemoryQuery, MutationId, PageRequest, Peer, RecordedStep, Request, Revision, RevisionChange,
    SnapshotCursor, StoredView, TaskCommand, TaskKind, TaskOrder, TaskOutcome, UserRole, ViewId,
    WorldCommand, WorldRegion,
};

use std::path::Path;
use test_data::golden;

const ID: MutationId = MutationId(0x0102);
const VIEW: ViewId = ViewId {
    track_id: 3,
    view_id: 1,
};

fn check(kind: &str, commands: Vec<(&str, Command)>) {
    let requests = commands.into_iter();
    let requests = requests.map(|(name, command)| (name, Request::from(command)));
    check_requests(kind, &requests.collect::<Vec<_>>());
}

fn check_requests(kind: &str, examples: &[(&str, Request)]) {
    let file = format!("{}/tests/golden/{kind}.txt", env!("CARGO_MANIFEST_DIR"));
    let encode = |request: &Request| {
        let mut bytes = Vec::new();
        ciborium::into_writer(request, &mut bytes).unwrap();
        bytes
    };
    let decode = |bytes: &[u8]| ciborium::from_reader(bytes).unwrap();
    golden::check(Path::new(&file), examples, encode, decode);
}

fn anna() -> String {
    "anna".to_owned()
}

fn mug() -> String {
    "mug".to_owned()
}

fn labelling() -> Labelling {
    Labelling {
        id: ID,
        author: anna(),
        track_id: 3,
        category: mug(),
        is_new: true,
    }
}

fn document() -> DocumentName {
    DocumentName {
        kind: DocumentKind::ObjectModel,
        name: mug(),
    }
}

#[test]
fn golden_requests_of_perception_and_lessons_are_written_and_read() {
    let find = FindQuery {
        words: "the red mug".to_owned(),
        speaker: Some(anna()),
        utc_offset_s: 3600,
    };
    let forget = Command::Forget {
        id: ID,
        author: anna(),
        category: mug(),
    };
    let commands = vec![
        ("objects", Command::Objects),
        ("ask", Command::Ask { track_id: 3 }),
        ("question", Command::Question),
        ("find", Command::Find(find)),
        ("health", Command::Health),
        ("depth noise", Command::DepthNoise),
        ("reload", Command::ReloadConfiguration),
        ("teach", Command::Teach(labelling())),
        ("correct", Command::Correct(labelling())),
        ("forget", forget),
        ("categories", Command::Categories),
    ];
    check("requests-of-people", commands);
}

#[test]
fn golden_revisions_of_the_memory_are_written_and_read() {
    let revise = |change| {
        Command::Revise(Revision {
            id: ID,
            author: anna(),
            change,
        })
    };
    let (from, to, into) = (mug(), "cup".to_owned(), "cup".to_owned());
    let changes = [
        ("forget track", RevisionChange::ForgetTrack { track_id: 3 }),
        ("forget view", RevisionChange::ForgetView { view: VIEW }),
        (
            "correct view",
            RevisionChange::CorrectView {
                view: VIEW,
                category: mug(),
                is_new: false,
            },
        ),
        (
            "rename",
            RevisionChange::Rename {
                from: from.clone(),
                to,
                is_new: true,
            },
        ),
        ("merge", RevisionChange::Merge { from, into }),
        ("undo", RevisionChange::Undo { sequence: Some(4) }),
        ("redo", RevisionChange::Redo),
        (
            "put document",
            RevisionChange::PutDocument {
                document: document(),
                media_type: "model/ply".to_owned(),
                upload: 5,
                digest: ContentDigest(6),
            },
        ),
        (
            "remove document",
            RevisionChange::RemoveDocument {
                document: document(),
            },
        ),
    ];
    let commands = changes.map(|(name, change)| (name, revise(change)));
    check("revisions-of-the-memory", commands.into());
}

#[test]
fn golden_queries_of_the_memory_are_written_and_read() {
    let views = MemoryQuery::Views {
        category: Some(mug()),
        track_id: None,
        after: Some(VIEW),
    };
    let page = PageRequest {
        document: document(),
        digest: Some(ContentDigest(6)),
        offset: 7,
    };
    let history = MemoryQuery::History {
        from: Some(1),
        max: 10,
    };
    let documents = MemoryQuery::Documents {
        after: Some(document()),
    };
    let queries = [
        ("stats", MemoryQuery::Stats),
        ("views", views),
        ("history", history),
        ("documents", documents),
        ("document", MemoryQuery::Document(page)),
        ("versions", MemoryQuery::DocumentVersions(document())),
    ];
    let commands = queries.map(|(name, query)| (name, Command::Memory(query)));
    check("queries-of-the-memory", commands.into());
}

#[test]
fn golden_requests_of_jobs_are_written_and_read() {
    let import = JobCommand::Import(ImportCompletion {
        job: 1,
        id: ID,
        author: anna(),
        source: "robot".to_owned(),
        renames: vec![(mug(), "cup".to_owned())],
        prefix: "b-".to_owned(),
        is_new: true,
        restamp: true,
    });
    let write = JobCommand::Write {
        job: 1,
        offset: 2,
        bytes: vec![3, 4],
    };
    let compact = JobKind::Compact {
        forgotten_for_s: 60,
    };
    let jobs = [
        ("verify", JobCommand::Begin(JobKind::Verify)),
        ("repair", JobCommand::Begin(JobKind::Repair)),
        ("compact", JobCommand::Begin(compact)),
        ("export", JobCommand::Begin(JobKind::Export)),
        ("begin import", JobCommand::Begin(JobKind::Import)),
        ("begin document", JobCommand::Begin(JobKind::Document)),
        ("progress", JobCommand::Ask { job: 1 }),
        ("read", JobCommand::Read { job: 1, offset: 2 }),
        ("write", write),
        ("import", import),
    ];
    let jobs = jobs.map(|(name, job)| (name, Command::Job(job)));
    check("requests-of-jobs", jobs.into_iter().collect());
}

#[test]
fn golden_requests_of_the_arm_are_written_and_read() {
    let lease = || ArmLease {
        id: 5,
        holder: anna(),
    };
    let move_to = ArmMotion::MoveTo {
        position_m: [0.5, 1.5, 2.5],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        straight: true,
    };
    let move_joints = ArmMotion::MoveJoints {
        angles_rad: [0.5; 6],
    };
    let motions = [
        ("arm move", move_to),
        ("arm joints", move_joints),
        ("arm home", ArmMotion::Home),
        ("arm open", ArmMotion::Open),
        ("arm open to", ArmMotion::OpenTo { opening_m: 0.5 }),
        ("arm close", ArmMotion::Close),
    ];
    let motions = motions.map(|(name, motion)| {
        let lease = lease();
        (name, ArmCommand::Move { lease, motion })
    });
    let others = [
        ("arm state", ArmCommand::State),
        ("arm hold", ArmCommand::Hold(lease())),
        ("arm release", ArmCommand::Release { lease: 5 }),
        ("arm stop", ArmCommand::Stop),
    ];
    let all = others.into_iter().chain(motions);
    let all = all.map(|(name, command)| (name, Command::Arm(command)));
    check("requests-of-the-arm", all.collect());
}

#[test]
fn golden_requests_of_tasks_are_written_and_read() {
    let start = |order| TaskCommand::Start {
        id: MutationId(7),
        author: anna(),
        order,
    };
    let fetch = TaskOrder {
        kind: TaskKind::Fetch,
        category: Some(mug()),
        track_id: Some(3),
        place: Some("shelf".to_owned()),
    };
    let all = [
        ("task state", TaskCommand::State),
        ("task preview", TaskCommand::Preview(TaskOrder::default())),
        ("task start", start(TaskOrder::default())),
        ("task fetch", start(fetch)),
        ("task pause", TaskCommand::Pause { task_id: 5 }),
        ("task resume", TaskCommand::Resume { task_id: 5 }),
        ("task cancel", TaskCommand::Cancel { task_id: 5 }),
    ];
    let all = all.map(|(name, command)| (name, Command::Task(command)));
    check("requests-of-tasks", all.into_iter().collect());
}

#[test]
fn golden_requests_of_the_world_are_written_and_read() {
    let facts = |region| {
        WorldCommand::Facts(FactFilter {
            track_id: Some(3),
            label: Some(mug()),
            region: Some(region),
            since_ns: Some(1),
            until_ns: Some(2),
            before: Some(9),
            limit: 10,
        })
    };
    let ball = WorldRegion::Ball {
        centre_m: [0.5; 3],
        radius_m: 0.25,
    };
    let bounds = WorldRegion::Box {
        min_m: [0.0; 3],
        max_m: [1.0; 3],
    };
    let start = WorldCommand::StartTask {
        id: ID,
        kind: "clear".to_owned(),
        parameters: "all".to_owned(),
        author: anna(),
    };
    let end = |outcome| WorldCommand::EndTask {
        id: ID,
        task_id: 2,
        outcome,
        reason: "reason".to_owned(),
    };
    let events = WorldCommand::Events {
        since: 4,
        wait_ms: 1000,
    };
    let tasks = WorldCommand::Tasks {
        before: Some(9),
        limit: 10,
    };
    let commands = [
        ("now", WorldCommand::Now),
        ("facts in a ball", facts(ball)),
        ("facts in a box", facts(bounds)),
        ("events", events),
        ("tasks", tasks),
        ("start task", start),
        ("task succeeded", end(TaskOutcome::Succeeded)),
        ("task failed", end(TaskOutcome::Failed)),
        ("task cancelled", end(TaskOutcome::Cancelled)),
    ];
    let commands = commands.map(|(name, command)| (name, Command::World(command)));
    check("requests-of-the-world", commands.into());
}

#[test]
fn golden_requests_of_steps_are_written_and_read() {
    let whole = RecordedStep {
        number: 3,
        state: "held".to_owned(),
        primitive: "lift".to_owned(),
        track_id: 7,
        label: Some(mug()),
        place: Some("shelf".to_owned()),
        attempt: 2,
        reason: "the first grasp slipped".to_owned(),
        plan: "{}".to_owned(),
    };
    let short = RecordedStep {
        label: None,
        place: None,
        reason: String::new(),
        plan: String::new(),
        ..whole.clone()
    };
    let record = |step| WorldCommand::RecordStep { task_id: 2, step };
    let commands = [
        ("task", WorldCommand::Task { task_id: 2 }),
        ("record step", record(whole)),
        ("record step without a plan", record(short)),
    ];
    let commands = commands.map(|(name, command)| (name, Command::World(command)));
    check("requests-of-steps", commands.into());
}

#[test]
fn golden_requests_of_the_daemons_own_processes_are_written_and_read() {
    let view = StoredView {
        id: VIEW,
        descriptor_kind: "good".to_owned(),
        descriptor: DescriptorBytes::encode(&[0.5, -1.0]),
        position_m: [0.5, 1.5, 2.5],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m: [0.125; 3],
        captured_ns: 5,
        frame_sequence: 7,
        source_name: "camera".to_owned(),
        points: vec![1, 2, 3],
        mean_rgb: Some([1, 2, 3]),
    };
    let views = vec![view];
    let commands = vec![
        ("lease", Command::LeaseTrackIds { count: 10 }),
        ("store views", Command::StoreViews { id: ID, views }),
        (
            "snapshot",
            Command::Snapshot {
                after: Some(SnapshotCursor(8)),
            },
        ),
        ("clouds", Command::Clouds { ids: vec![VIEW] }),
        (
            "changes",
            Command::Changes {
                store_id: 9,
                since: 4,
            },
        ),
        (
            "read after",
            Command::ReadAfter {
                store_id: 9,
                sequence: 4,
                command: Box::new(Command::Objects),
            },
        ),
    ];
    check("requests-of-processes", commands);
}

#[test]
fn golden_request_on_behalf_of_a_user_is_written_and_read() {
    let request = Request {
        user: Some(Peer {
            uid: 1000,
            role: UserRole::Teacher,
        }),
        ..Request::from(Command::Objects)
    };
    check_requests("requests-on-behalf", &[("objects of a teacher", request)]);
}
