//! Tests of the uploads of documents.

use super::admission::{MAX_DOCUMENT_UPLOADS, MAX_DOCUMENT_UPLOADS_OF_USER};
use super::tests::{ANNA, BEN, Fixture, kind};
use super::*;
use control_protocol::{ContentDigest, DOCUMENT_PAGE_BYTES};

const CARLA: Requester = Requester {
    uid: Some(1002),
    may_undo_others: false,
};

impl Fixture {
    fn content(&self, job: u64, user: Requester, of: &[u8]) -> Result<Vec<u8>, Refusal> {
        let read = self.jobs.document_content(job, user, ContentDigest::of(of));
        self.runtime.block_on(read)
    }

    fn write_at(&self, job: u64, offset: u64, bytes: &[u8]) -> Result<Reply, Refusal> {
        let bytes = bytes.to_vec();
        self.answer(JobCommand::Write { job, offset, bytes }, ANNA)
    }
}

#[test]
fn uploaded_document_is_read_by_its_digest_and_by_its_user() {
    let fixture = Fixture::new(u64::MAX);
    let job = fixture.begin(JobKind::Document, ANNA).unwrap();
    fixture.write_at(job, 3, b"lo").unwrap();
    fixture.write_at(job, 0, b"hel").unwrap();
    assert_eq!(fixture.content(job, ANNA, b"hello").unwrap(), b"hello");
    assert_eq!(
        kind(fixture.content(job, ANNA, b"hullo")),
        RefusalKind::Invalid
    );
    assert_eq!(
        kind(fixture.content(job, BEN, b"hello")),
        RefusalKind::NotFound
    );
    fixture.jobs.end(job);
    assert_eq!(
        kind(fixture.content(job, ANNA, b"hello")),
        RefusalKind::NotFound
    );
}

#[test]
fn document_without_bytes_is_uploaded_too() {
    let fixture = Fixture::new(u64::MAX);
    let job = fixture.begin(JobKind::Document, ANNA).unwrap();
    assert_eq!(fixture.content(job, ANNA, b"").unwrap(), b"");
}

#[test]
fn document_has_a_maximum_size_whatever_the_offset() {
    let fixture = Fixture::new(u64::MAX);
    let job = fixture.begin(JobKind::Document, ANNA).unwrap();
    let page = vec![1; DOCUMENT_PAGE_BYTES];
    let last = MAX_DOCUMENT_BYTES - DOCUMENT_PAGE_BYTES as u64;
    fixture.write_at(job, last, &page).unwrap();
    for offset in [last + 1, MAX_DOCUMENT_BYTES, u64::MAX - 1, u64::MAX] {
        let refused = fixture.write_at(job, offset, &page).unwrap_err();
        assert_eq!(refused.kind, RefusalKind::Invalid);
        assert!(refused.sentence.contains("16777216 bytes"), "{refused}");
    }
}

/// The place of an import would let a document grow beyond its limit, and the other way round.
#[test]
fn document_is_no_import_and_an_import_no_document() {
    let fixture = Fixture::new(u64::MAX);
    let document = fixture.begin(JobKind::Document, ANNA).unwrap();
    let import = JobCommand::Import(ImportCompletion {
        is_new: false,
        job: document,
        id: control_protocol::MutationId(1),
        author: "anna".into(),
        source: "a document".into(),
        renames: Vec::new(),
        prefix: String::new(),
        restamp: false,
    });
    assert_eq!(kind(fixture.answer(import, ANNA)), RefusalKind::Invalid);
    let import = fixture.begin(JobKind::Import, ANNA).unwrap();
    assert_eq!(
        kind(fixture.content(import, ANNA, b"")),
        RefusalKind::Invalid
    );
}

#[test]
fn documents_are_uploaded_beside_long_jobs_and_leave_room_for_others() {
    let fixture = Fixture::new(u64::MAX);
    for _ in 0..admission::MAX_JOBS_OF_USER {
        fixture.begin(JobKind::Import, ANNA).unwrap();
    }
    let begin = |user| fixture.begin(JobKind::Document, user);
    for user in [ANNA, BEN] {
        for _ in 0..MAX_DOCUMENT_UPLOADS_OF_USER {
            begin(user).unwrap();
        }
        assert_eq!(kind(begin(user)), RefusalKind::Unavailable);
    }
    assert_eq!(2 * MAX_DOCUMENT_UPLOADS_OF_USER, MAX_DOCUMENT_UPLOADS);
    assert_eq!(kind(begin(CARLA)), RefusalKind::Unavailable);
    fixture.jobs.end_abandoned(Duration::ZERO);
    begin(CARLA).unwrap();
}

#[test]
fn silent_upload_gives_its_place_to_a_newer_one_of_its_user() {
    let fixture = Fixture::new(u64::MAX);
    let begin = |user| fixture.begin(JobKind::Document, user);
    let first = begin(ANNA).unwrap();
    let of_another = begin(BEN).unwrap();
    for _ in 1..MAX_DOCUMENT_UPLOADS_OF_USER {
        begin(ANNA).unwrap();
    }
    assert_eq!(kind(begin(ANNA)), RefusalKind::Unavailable);
    let long_ago = Instant::now().checked_sub(Duration::from_secs(3)).unwrap();
    let mut jobs = fixture.jobs.jobs.lock();
    for job in [first, of_another] {
        jobs.get_mut(&job).unwrap().asked = long_ago;
    }
    drop(jobs);
    begin(ANNA).unwrap();
    assert_eq!(
        kind(fixture.write_at(first, 0, b"x")),
        RefusalKind::NotFound
    );
    assert_eq!(fixture.content(of_another, BEN, b"").unwrap(), b"");
    assert_eq!(
        kind(begin(ANNA)),
        RefusalKind::Unavailable,
        "one place only"
    );
}
