//! Admission of jobs: how many run at a time, in all and of one user.

use super::Job;
use control_protocol::{JobKind, Refusal, RefusalKind};
use perceptual_memory::Requester;
use std::collections::BTreeMap;
use std::time::Duration;

/// Maximum number of concurrent jobs other than uploads of documents. Chosen: each has a thread.
pub(super) const MAX_JOBS: usize = 4;
/// Maximum number of such jobs of one user.
pub(super) const MAX_JOBS_OF_USER: usize = 2;
/// Maximum number of concurrent uploads of documents. Chosen: 128 MB of the disk.
pub(super) const MAX_DOCUMENT_UPLOADS: usize = 8;
/// Maximum number of concurrent uploads of documents of one user.
pub(super) const MAX_DOCUMENT_UPLOADS_OF_USER: usize = 4;
/// Silence after which an upload of a document gives its place to a newer one of its user. Chosen:
/// a client sends a page in some milliseconds, and one whose connection broke begins again.
const SILENT_AFTER: Duration = Duration::from_secs(2);

/// Makes room for a job of a user, or refuses it. An export that was read to its end needs none.
pub(super) fn make_room(
    jobs: &mut BTreeMap<u64, Job>,
    kind: &JobKind,
    owner: Requester,
) -> Result<(), Refusal> {
    jobs.retain(|_, job| !job.is_delivered());
    let is_document = *kind == JobKind::Document;
    let is_alike = |job: &Job| (job.kind == JobKind::Document) == is_document;
    let is_own = |job: &Job| is_alike(job) && job.owner.uid == owner.uid;
    let (most, most_own) = if is_document {
        (MAX_DOCUMENT_UPLOADS, MAX_DOCUMENT_UPLOADS_OF_USER)
    } else {
        (MAX_JOBS, MAX_JOBS_OF_USER)
    };
    let n_own = |jobs: &BTreeMap<u64, Job>| jobs.values().filter(|job| is_own(job)).count();
    if is_document && n_own(jobs) >= most_own {
        let own = jobs.iter().filter(|(_, job)| is_own(job));
        let silent = own.max_by_key(|(_, job)| job.asked.elapsed());
        let silent = silent.filter(|(_, job)| job.asked.elapsed() >= SILENT_AFTER);
        if let Some(job) = silent.map(|(job, _)| *job) {
            jobs.remove(&job);
        }
    }
    let n_all = jobs.values().filter(|job| is_alike(job)).count();
    if n_all < most && n_own(jobs) < most_own {
        return Ok(());
    }
    let sentence = if is_document {
        format!(
            "at most {most} documents are uploaded at a time, {most_own} of one user; try again \
             in some seconds"
        )
    } else {
        format!("at most {most} jobs run on the memory, {most_own} of one user; try again later")
    };
    Err(Refusal::new(RefusalKind::Unavailable, sentence))
}
