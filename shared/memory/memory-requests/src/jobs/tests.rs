use super::*;
use crate::job_context::wall_ns;
use crate::jobs::admission::{MAX_JOBS, MAX_JOBS_OF_USER};
use crate::upload::UploadLimits;
use control_protocol::MutationId;
use perceptual_memory::{
    DecisionStamp, Digest, ForeignView, PortableWriter, RetentionLimits, StoreConfig, StoreThread,
    WRITE_BUFFER_BYTES,
};
use tokio::sync::watch;

pub(super) const ANNA: Requester = Requester {
    uid: Some(1000),
    may_undo_others: true,
};
pub(super) const BEN: Requester = Requester {
    uid: Some(1001),
    may_undo_others: true,
};

/// Jobs on an empty store.
pub(super) struct Fixture {
    pub(super) jobs: Jobs,
    pub(super) runtime: tokio::runtime::Runtime,
    _store: StoreThread,
    folder: tempfile::TempDir,
}

impl Fixture {
    pub(super) fn new(max_bytes: u64) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (thread, store, _) = StoreThread::start(StoreConfig {
            folder: folder.path().join("store"),
            queue_capacity: 16,
            limits: RetentionLimits::default(),
            write_buffer_bytes: WRITE_BUFFER_BYTES,
            wall_clock: || 1,
            on_reopened: Box::new(|_| {}),
            on_notice: Box::new(|_| {}),
        })
        .unwrap();
        let jobs = Jobs::new(JobContext {
            position: watch::channel(store.position()).0,
            store,
            scratch: folder.path().join("exchange"),
            uploads: Arc::new(Mutex::new(UploadLimits {
                max_bytes,
                free_disk_min_bytes: 0,
            })),
            descriptor_kind: "test",
        });
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .unwrap();
        Self {
            jobs,
            runtime,
            _store: thread,
            folder,
        }
    }

    pub(super) fn answer(&self, command: JobCommand, user: Requester) -> Result<Reply, Refusal> {
        self.runtime.block_on(self.jobs.answer(command, user))
    }

    pub(super) fn begin(&self, kind: JobKind, user: Requester) -> Result<u64, Refusal> {
        match self.answer(JobCommand::Begin(kind), user)? {
            Reply::Job(report) => Ok(report.job),
            other => panic!("{other:?}"),
        }
    }

    fn write(&self, job: u64, n_bytes: usize, user: Requester) -> Result<Reply, Refusal> {
        let bytes = vec![7; n_bytes];
        let offset = 0;
        self.answer(JobCommand::Write { job, offset, bytes }, user)
    }

    fn outcome(&self, job: u64) -> JobOutcome {
        loop {
            match self.answer(JobCommand::Ask { job }, ANNA).unwrap() {
                Reply::Job(JobReport {
                    outcome: Some(outcome),
                    ..
                }) => return outcome,
                _ => std::thread::sleep(Duration::from_millis(1)),
            }
        }
    }
}

pub(super) fn kind(refused: Result<impl std::fmt::Debug, Refusal>) -> RefusalKind {
    refused.unwrap_err().kind
}

#[test]
fn job_is_followed_by_its_user_only() {
    let fixture = Fixture::new(1000);
    let job = fixture.begin(JobKind::Import, ANNA).unwrap();
    assert_eq!(kind(fixture.write(job, 1, BEN)), RefusalKind::NotFound);
    let asked = fixture.answer(JobCommand::Ask { job }, BEN);
    assert_eq!(kind(asked), RefusalKind::NotFound);
    fixture.write(job, 1, ANNA).unwrap();
}

#[test]
fn jobs_of_one_user_leave_room_for_others() {
    let fixture = Fixture::new(1000);
    for _ in 0..MAX_JOBS_OF_USER {
        fixture.begin(JobKind::Import, ANNA).unwrap();
    }
    let refused = fixture.begin(JobKind::Import, ANNA);
    assert_eq!(kind(refused), RefusalKind::Unavailable);
    fixture.begin(JobKind::Import, BEN).unwrap();
}

#[test]
fn uploads_have_one_limit_and_free_it_when_they_are_abandoned() {
    let fixture = Fixture::new(1000);
    let first = fixture.begin(JobKind::Import, ANNA).unwrap();
    let second = fixture.begin(JobKind::Import, BEN).unwrap();
    fixture.write(first, 900, ANNA).unwrap();
    assert_eq!(kind(fixture.write(second, 200, BEN)), RefusalKind::Invalid);
    fixture.jobs.end_abandoned(Duration::ZERO);
    assert_eq!(kind(fixture.write(first, 1, ANNA)), RefusalKind::NotFound);
    let third = fixture.begin(JobKind::Import, BEN).unwrap();
    fixture.write(third, 1000, BEN).unwrap();
    let exchange = fixture.folder.path().join("exchange");
    assert_eq!(std::fs::read_dir(exchange).unwrap().count(), 0);
}

#[test]
fn import_of_rubbish_fails_once_and_takes_no_more_bytes() {
    let fixture = Fixture::new(1000);
    let job = fixture.begin(JobKind::Import, ANNA).unwrap();
    fixture.write(job, 100, ANNA).unwrap();
    let import = || {
        JobCommand::Import(ImportCompletion {
            is_new: false,
            job,
            id: MutationId(1),
            author: "anna".into(),
            source: "rubbish".into(),
            renames: Vec::new(),
            prefix: String::new(),
            restamp: false,
        })
    };
    fixture.answer(import(), ANNA).unwrap();
    assert_eq!(kind(fixture.answer(import(), ANNA)), RefusalKind::Invalid);
    assert_eq!(kind(fixture.write(job, 1, ANNA)), RefusalKind::Invalid);
    assert!(matches!(fixture.outcome(job), JobOutcome::Failed(_)));
}

/// Outcome of the import of an export file.
fn imported(fixture: &Fixture, bytes: Vec<u8>, restamp: bool) -> JobOutcome {
    let job = fixture.begin(JobKind::Import, ANNA).unwrap();
    let offset = 0;
    let write = JobCommand::Write { job, offset, bytes };
    fixture.answer(write, ANNA).unwrap();
    let import = JobCommand::Import(ImportCompletion {
        job,
        id: MutationId(u128::from(job)),
        author: "anna".into(),
        source: "backup".into(),
        renames: Vec::new(),
        prefix: String::new(),
        is_new: false,
        restamp,
    });
    fixture.answer(import, ANNA).unwrap();
    fixture.outcome(job)
}

/// Export file with forgotten views that were decided so many hours from now.
fn backup(ahead_h: &[u64]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = PortableWriter::new(&mut bytes).unwrap();
    for (number, hours) in (0..).zip(ahead_h) {
        let stamp_ns = wall_ns() + hours * 3_600_000_000_000;
        let view = ForeignView::Forgotten {
            identity: Digest::of(&[number]),
            decided: DecisionStamp {
                author: "ben".into(),
                stamp_ns,
            },
        };
        writer.view(&view).unwrap();
    }
    writer.end().unwrap();
    bytes
}

#[test]
fn import_takes_over_all_but_the_decisions_from_the_future() {
    for (restamp, n_taken_over) in [(false, 2), (true, 3)] {
        let fixture = Fixture::new(1 << 20);
        let report = match imported(&fixture, backup(&[0, 9000, 0]), restamp) {
            JobOutcome::Imported(report) => report,
            other => panic!("{other:?}"),
        };
        let n_ahead = (report.n_left_out, report.n_restamped);
        assert_eq!(n_ahead, (u64::from(!restamp), u64::from(restamp)));
        assert_eq!((report.n_views, report.ahead.len()), (3, 1));
        assert_eq!(report.ahead[0].author, "ben");
        let export = fixture.begin(JobKind::Export, ANNA).unwrap();
        match fixture.outcome(export) {
            JobOutcome::Exported(report) => assert_eq!(report.n_forgotten, n_taken_over),
            other => panic!("{other:?}"),
        }
    }

    let fixture = Fixture::new(1 << 20);
    let before = fixture.jobs.context.store.position();
    match imported(&fixture, backup(&[9000, 9001]), false) {
        JobOutcome::Failed(sentence) => assert!(sentence.contains("--restamp"), "{sentence}"),
        other => panic!("{other:?}"),
    }
    assert_eq!(fixture.jobs.context.store.position(), before);
}

#[test]
fn export_that_was_read_leaves_its_room_to_others() {
    let fixture = Fixture::new(1000);
    let export = || {
        let job = fixture.begin(JobKind::Export, ANNA)?;
        let mut offset = 0;
        loop {
            let read = fixture.answer(JobCommand::Read { job, offset }, ANNA);
            let Reply::JobBytes { bytes } = read.unwrap() else {
                panic!("no bytes");
            };
            offset += bytes.len() as u64;
            let Reply::Job(report) = fixture.answer(JobCommand::Ask { job }, ANNA).unwrap() else {
                panic!("no report");
            };
            match report.outcome {
                Some(JobOutcome::Exported(report)) if report.bytes == offset => return Ok(job),
                _ => std::thread::sleep(Duration::from_millis(1)),
            }
        }
    };
    for _ in 0..2 * MAX_JOBS {
        let job = export().unwrap();
        // An answer that was lost is read again.
        let again = JobCommand::Read { job, offset: 0 };
        fixture.answer(again, ANNA).unwrap();
    }
    // One that is being read keeps its room.
    for _ in 0..MAX_JOBS_OF_USER {
        fixture.begin(JobKind::Export, ANNA).unwrap();
    }
    let refused: Result<u64, Refusal> = export();
    assert_eq!(kind(refused), RefusalKind::Unavailable);
}

/// A reader of an export that goes away frees its thread and its checkpoint.
#[test]
fn abandoned_export_ends() {
    let fixture = Fixture::new(1000);
    fixture.begin(JobKind::Export, ANNA).unwrap();
    let progress = {
        let jobs = fixture.jobs.jobs.lock();
        jobs.values().next().unwrap().progress.clone()
    };
    fixture.jobs.end_abandoned(Duration::ZERO);
    while Arc::strong_count(&progress) > 1 {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(progress.is_abandoned());
}
