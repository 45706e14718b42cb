//! Golden bytes of the replies of the control protocol, as programs of others read them.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use control_protocol::{
    AheadDecision, ArmReport, ChangesPage, ContentDigest, DepthNoiseReport, DescriptorBytes,
    DocumentKind, DocumentName, DocumentPage, DocumentReport, DocumentVersionReport, ExportReport,
    FindReport, FoundObjectReport, HistoryOperation, HistoryReport, ImportReport, JobOutcome,
    JobReport, KeyChange, LearnedChange, LearnedView, LearningReport, LeftObjectReport,
    MemoryAnswer, MemoryStats, MutationId, PlannedObjectReport, QuestionKind, QuestionReport,
    QuestionsReport, Refusal, RefusalKind, ReloadReport, Reply, SnapshotCursor, SnapshotPage,
    TaskReport, VerificationReport, ViewId, ViewReport, WordUseReport, WorldReply,
};
use scene_document::{
    CategoryAnswer, CategoryDocument, EventsDocument, FactsDocument, HealthDocument,
    ObjectDocument, SceneDocument, TaskDocument, TaskStepDocument, TasksDocument, WorldDocument,
};
use std::path::Path;
use test_data::golden;

const VIEW: ViewId = ViewId {
    track_id: 3,
    view_id: 1,
};

fn check(kind: &str, examples: &[(&str, Reply)]) {
    let file = format!("{}/tests/golden/{kind}.txt", env!("CARGO_MANIFEST_DIR"));
    let encode = |reply: &Reply| {
        let mut bytes = Vec::new();
        ciborium::into_writer(reply, &mut bytes).unwrap();
        bytes
    };
    let decode = |bytes: &[u8]| ciborium::from_reader(bytes).unwrap();
    golden::check(Path::new(&file), examples, encode, decode);
}

/// Reply of a golden file of an earlier form.
fn old_reply(kind: &str, name: &str) -> Reply {
    let file = format!("{}/tests/golden/{kind}.txt", env!("CARGO_MANIFEST_DIR"));
    let replies = golden::read(Path::new(&file));
    let (_, bytes) = replies.iter().find(|(its, _)| its == name).unwrap();
    ciborium::from_reader(bytes.as_slice()).unwrap()
}

fn mug() -> String {
    "mug".to_owned()
}

fn object() -> ObjectDocument {
    ObjectDocument {
        track_id: 3,
        label: Some(mug()),
        ..ObjectDocument::default()
    }
}

#[test]
fn golden_replies_about_the_live_scene_are_written_and_read() {
    let scene = SceneDocument {
        objects: vec![object()],
        ..SceneDocument::default()
    };
    let question = QuestionReport {
        track_id: 3,
        kind: QuestionKind::NewSide,
        uncertainty: 0.25,
        categories: Vec::new(),
        position_m: [0.1, 0.2, 0.3],
        sentence: "what is it?".to_owned(),
    };
    let questions = QuestionsReport {
        question: Some(question),
    };
    let noise = DepthNoiseReport {
        law: "stereo".to_owned(),
        ratio: Some(1.5),
        table_depth_m: None,
    };
    let examples = [
        ("objects", Reply::Objects(Box::new(scene))),
        ("object", Reply::Object(Box::new(object()))),
        ("question", Reply::Question(questions)),
        ("found", Reply::Found(Box::new(found()))),
        ("depth noise", Reply::DepthNoise(noise)),
    ];
    check("replies-about-the-scene-2", &examples);
}

#[test]
fn golden_reply_of_the_arm_is_written_and_read() {
    let arm = ArmReport {
        command_id: 4,
        activity: "moving".to_owned(),
        note: String::new(),
        joint_angles_rad: [0.5; 6],
        opening_m: 0.05,
        position_m: [0.1, 0.2, 0.3],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        is_holding: true,
        commander: Some("anna".to_owned()),
    };
    check("replies-of-the-arm", &[("arm", Reply::Arm(arm))]);
    let report = TaskReport {
        task_id: Some(5),
        kind: "fetch".to_owned(),
        phase: "carry".to_owned(),
        track_id: Some(3),
        label: Some(mug()),
        attempt: 1,
        planned: vec![PlannedObjectReport {
            track_id: 3,
            label: Some(mug()),
            place: "shelf".to_owned(),
        }],
        left: vec![LeftObjectReport {
            track_id: 4,
            reason: "Left unknown object 4: it needs a name.".to_owned(),
        }],
        ..TaskReport::default()
    };
    check(
        "replies-of-tasks",
        &[("task", Reply::Task(Box::new(report)))],
    );
}

#[test]
fn golden_reply_of_an_arm_without_leases_is_still_read() {
    let Reply::Arm(report) = old_reply("replies-about-the-scene", "arm") else {
        panic!("another reply");
    };
    assert_eq!((report.command_id, report.commander), (4, None));
}

#[test]
fn golden_found_objects_of_0_2_are_still_read() {
    let Reply::Found(report) = old_reply("replies-about-the-scene", "found") else {
        panic!("another reply");
    };
    let found = &report.matches[0];
    assert_eq!(found.answer.shown(found.label.as_deref()), "mug");
}

fn found() -> FindReport {
    let object = FoundObjectReport {
        track_id: 3,
        score: 0.75,
        doubts: vec!["its side is hidden".to_owned()],
        label: Some(mug()),
        answer: CategoryAnswer::Probably,
        state: "tracked".to_owned(),
        position_m: Some([0.1, 0.2, 0.3]),
    };
    let word = WordUseReport {
        words: "red".to_owned(),
        meaning: "colour".to_owned(),
    };
    FindReport {
        query: "the red mug".to_owned(),
        sentence: "it is track 3".to_owned(),
        matches: vec![object],
        wants_one: true,
        understood: vec![word],
        not_understood: vec!["please".to_owned()],
        remarks: Vec::new(),
        scene_age_s: Some(0.5),
        is_stale: false,
    }
}

#[test]
fn golden_replies_of_the_gateway_and_refusals_are_written_and_read() {
    let reload = ReloadReport {
        process: "camera".to_owned(),
        pid: 7,
        refused: None,
        is_unanswered: false,
        applied: vec![KeyChange {
            key: "camera.rate_hz".to_owned(),
            from: "30".to_owned(),
            to: "15".to_owned(),
        }],
        needs_restart: Vec::new(),
    };
    let mut examples = vec![
        ("health", Reply::Health(vec![HealthDocument::default()])),
        ("reloaded", Reply::Reloaded(vec![reload])),
    ];
    for (name, kind) in [
        ("not found", RefusalKind::NotFound),
        ("invalid", RefusalKind::Invalid),
        ("conflict", RefusalKind::Conflict),
        ("unavailable", RefusalKind::Unavailable),
        ("timed out", RefusalKind::TimedOut),
        ("forbidden", RefusalKind::Forbidden),
        ("version", RefusalKind::Version),
        ("internal", RefusalKind::Internal),
        ("unknown outcome", RefusalKind::UnknownOutcome),
    ] {
        examples.push((name, Reply::Refused(Refusal::new(kind, "why"))));
    }
    check("replies-of-the-gateway", &examples);
}

fn document() -> DocumentReport {
    DocumentReport {
        document: DocumentName {
            kind: DocumentKind::ObjectModel,
            name: mug(),
        },
        media_type: "model/mesh".to_owned(),
        bytes: 3,
        digest: ContentDigest(5),
        author: "anna".to_owned(),
        decided_ns: 6,
        sequence: 7,
    }
}

fn view() -> ViewReport {
    ViewReport {
        id: VIEW,
        category: Some(mug()),
        author: "anna".to_owned(),
        decided_ns: 1,
        sequence: 2,
        identity: 3,
        origin_memory: 4,
        origin: VIEW,
        captured_ns: 5,
        frame_sequence: 6,
        source: "camera".to_owned(),
        descriptor_kind: "kind".to_owned(),
        position_m: [0.1, 0.2, 0.3],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m: [0.1; 3],
        mean_rgb: Some([1, 2, 3]),
        descriptor_bytes: 8,
        cloud_bytes: 9,
    }
}

fn history() -> HistoryReport {
    HistoryReport {
        sequence: 1,
        wall_ns: 2,
        author: "anna".to_owned(),
        uid: Some(1000),
        what: "taught".to_owned(),
        operation: HistoryOperation::Teach,
        track_id: Some(3),
        view: Some(VIEW),
        category: Some(mug()),
        from: None,
        to: None,
        undone: None,
        redone: None,
        document: None,
        source: None,
        n_views: 4,
        contradiction: None,
        kept_category: None,
        kept_author: None,
        mutation: Some(MutationId(5)),
        previous: 6,
    }
}

fn stats() -> MemoryStats {
    MemoryStats {
        store_id: 1,
        memory_id: 2,
        schema: 3,
        sequence: 4,
        n_lost_entries: 5,
        n_named: 6,
        n_unnamed: 7,
        n_forgotten: 8,
        n_categories: 9,
        n_documents: 10,
        n_tombstones: 11,
        content_bytes: 12,
        disk_bytes: 13,
        next_track_id: 14,
        n_archived_entries: 15,
        n_dropped_entries: 16,
        archive_bytes: 17,
        damaged_bytes: 18,
        bytes_in_a_year: Some(19),
    }
}

#[test]
fn golden_answers_of_the_memory_are_written_and_read() {
    let learned = LearningReport {
        sequence: 9,
        category: mug(),
        n_views_changed: 2,
    };
    let category = CategoryDocument {
        category: mug(),
        n_views: 2,
        bytes: 100,
        last_taught_ns: 5,
    };
    let views = MemoryAnswer::Views {
        views: vec![view()],
        next: Some(VIEW),
    };
    let history = MemoryAnswer::History {
        entries: vec![history()],
        last_sequence: 8,
    };
    let documents = MemoryAnswer::Documents {
        documents: vec![document()],
        next: None,
    };
    let page = DocumentPage {
        document: document(),
        offset: 0,
        content: vec![1, 2, 3],
    };
    let version = DocumentVersionReport {
        sequence: 7,
        decided_ns: 6,
        author: "anna".to_owned(),
        bytes: Some(3),
        digest: None,
    };
    let versions = MemoryAnswer::DocumentVersions(vec![version]);
    let examples = [
        ("learned", Reply::Learned(learned)),
        ("categories", Reply::Categories(vec![category])),
        ("stats", Reply::Memory(MemoryAnswer::Stats(stats()))),
        ("views", Reply::Memory(views)),
        ("history", Reply::Memory(history)),
        ("documents", Reply::Memory(documents)),
        ("document", Reply::Memory(MemoryAnswer::Document(page))),
        ("document versions", Reply::Memory(versions)),
    ];
    check("answers-of-the-memory", &examples);
}

#[test]
fn golden_reports_of_jobs_are_written_and_read() {
    let verification = VerificationReport {
        sequence: 1,
        n_history: 2,
        n_views: 3,
        n_documents: 4,
        content_bytes: 5,
        n_findings: 1,
        findings: vec!["a view".to_owned()],
    };
    let exported = ExportReport {
        bytes: 1,
        n_views: 2,
        n_forgotten: 3,
        n_documents: 4,
        sequence: 5,
    };
    let imported = ImportReport {
        n_views: 1,
        n_views_changed: 2,
        n_documents: 3,
        sequence: 4,
        n_left_out: 1,
        n_restamped: 0,
        ahead: vec![AheadDecision {
            what: "a view".to_owned(),
            author: "anna".to_owned(),
            decided_ns: 9,
        }],
    };
    let repaired = JobOutcome::Repaired {
        verification: verification.clone(),
        what: "rebuilt".to_owned(),
        is_loss: true,
    };
    let compacted = JobOutcome::Compacted {
        n_purged: 1,
        disk_bytes_before: 2,
        disk_bytes: 3,
    };
    let job = |outcome: Option<JobOutcome>| {
        Reply::Job(JobReport {
            job: 1,
            done: 2,
            total: 3,
            outcome,
        })
    };
    let examples = [
        ("running", job(None)),
        ("verified", job(Some(JobOutcome::Verified(verification)))),
        ("repaired", job(Some(repaired))),
        ("compacted", job(Some(compacted))),
        ("exported", job(Some(JobOutcome::Exported(exported)))),
        ("imported", job(Some(JobOutcome::Imported(imported)))),
        ("failed", job(Some(JobOutcome::Failed("why".to_owned())))),
        ("bytes", Reply::JobBytes { bytes: vec![1, 2] }),
    ];
    check("reports-of-jobs", &examples);
}

fn now() -> WorldDocument {
    WorldDocument {
        now_ns: 1,
        scene_age_s: Some(0.5),
        capture_stamp_ns: None,
        is_stale: false,
        objects: Vec::new(),
        surfaces: Vec::new(),
        robot: None,
        newest_event: 7,
    }
}

#[test]
fn golden_replies_of_the_world_and_to_processes_are_written_and_read() {
    let learned = LearnedView {
        id: VIEW,
        category: mug(),
        descriptor_kind: "kind".to_owned(),
        descriptor: DescriptorBytes::encode(&[0.5]),
    };
    let snapshot = SnapshotPage {
        store_id: 1,
        sequence: 2,
        views: vec![learned.clone()],
        next: Some(SnapshotCursor(3)),
    };
    let changes = ChangesPage::Changes {
        up_to: 4,
        changes: vec![
            LearnedChange::Assigned(learned),
            LearnedChange::Unassigned(VIEW),
        ],
        more: false,
    };
    let world = |reply| Reply::World(reply);
    let examples = [
        ("now", world(WorldReply::Now(Box::new(now())))),
        (
            "facts",
            world(WorldReply::Facts(FactsDocument {
                facts: Vec::new(),
                next: Some(4),
            })),
        ),
        (
            "events",
            world(WorldReply::Events(EventsDocument {
                events: Vec::new(),
                newest: 5,
            })),
        ),
        (
            "tasks",
            world(WorldReply::Tasks(TasksDocument {
                tasks: Vec::new(),
                next: None,
            })),
        ),
        ("task", world(WorldReply::Task(Box::default()))),
        ("track ids", Reply::TrackIds { first: 64 }),
        ("stored", Reply::Stored),
        ("snapshot", Reply::Snapshot(snapshot)),
        (
            "clouds",
            Reply::Clouds(vec![serde_bytes::ByteBuf::from(vec![1, 2])]),
        ),
        ("changes", Reply::Changes(changes)),
        ("reload", Reply::Changes(ChangesPage::Reload)),
    ];
    check("replies-of-the-world-3", &examples);
}

#[test]
fn golden_task_with_steps_is_written_and_read() {
    let step = TaskStepDocument {
        number: 1,
        state: "held".to_owned(),
        primitive: "lift".to_owned(),
        track_id: 7,
        label: Some(mug()),
        place: Some("shelf".to_owned()),
        attempt: 2,
        reason: "the first grasp slipped".to_owned(),
        plan: "{}".to_owned(),
        started_ns: 5,
        ended_ns: None,
    };
    let task = TaskDocument {
        task_id: 2,
        steps: vec![step],
        ..TaskDocument::default()
    };
    let reply = Reply::World(WorldReply::Task(Box::new(task)));
    check("replies-with-steps", &[("task with a step", reply)]);
}

#[test]
fn golden_task_without_steps_is_still_read() {
    let Reply::World(WorldReply::Task(task)) = old_reply("replies-of-the-world-2", "task") else {
        panic!("another reply");
    };
    assert_eq!(*task, TaskDocument::default());
}

#[test]
fn golden_world_of_0_2_is_still_read() {
    let Reply::World(WorldReply::Now(world)) = old_reply("replies-of-the-world", "now") else {
        panic!("another reply");
    };
    assert!(world.surfaces.is_empty() && world.newest_event == 7);
}
