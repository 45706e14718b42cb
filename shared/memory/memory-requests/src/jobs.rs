//! Background jobs on the memory, each in its own thread and polled by the user who began it.
//!
//! A job reads a checkpoint or sends small requests to the store, so that teaching is not delayed.
//! A job that its client no longer polls is ended: its thread, and its files, are freed.

mod admission;
mod document_upload;

use crate::job_context::{JobContext, Progress};
use crate::upload::Upload;
use crate::{compaction, export, import, verification};
use control_protocol::{
    ImportCompletion, JobCommand, JobKind, JobOutcome, JobReport, MAX_DOCUMENT_BYTES, Refusal,
    RefusalKind, Reply,
};
use parking_lot::Mutex;
use perceptual_memory::Requester;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time without polling after which a job is abandoned. Chosen.
pub(crate) const ABANDON_AFTER: Duration = Duration::from_secs(20);

/// Table of the long-running jobs.
pub(crate) struct Jobs {
    context: JobContext,
    jobs: Mutex<BTreeMap<u64, Job>>,
    next: AtomicU64,
}

struct Job {
    kind: JobKind,
    owner: Requester,
    progress: Arc<Progress>,
    /// File of an import or a document.
    upload: Option<Arc<Upload>>,
    /// `true` once an import has begun to read its file.
    is_importing: bool,
    asked: Instant,
}

impl Drop for Job {
    fn drop(&mut self) {
        self.progress.abandon();
    }
}

impl Jobs {
    pub(crate) fn new(context: JobContext) -> Self {
        // Uploads of earlier versions, which had names.
        let _ = std::fs::remove_dir_all(&context.scratch);
        Self {
            context,
            jobs: Mutex::new(BTreeMap::new()),
            next: AtomicU64::new(1),
        }
    }

    /// Ends jobs that were not polled for some time.
    pub(crate) fn end_abandoned(&self, after: Duration) {
        self.jobs
            .lock()
            .retain(|_, job| job.asked.elapsed() < after);
    }

    pub(crate) async fn answer(
        &self,
        command: JobCommand,
        requester: Requester,
    ) -> Result<Reply, Refusal> {
        match command {
            JobCommand::Begin(kind) => self.begin(kind, requester),
            JobCommand::Ask { job } => self.ask(job, requester),
            JobCommand::Read { job, offset } => {
                let progress = self.with(job, requester, |entry| entry.progress.clone())?;
                let bytes = export::read(&progress, offset);
                Ok(Reply::JobBytes { bytes })
            }
            JobCommand::Write { job, offset, bytes } => {
                self.write(job, requester, offset, bytes).await
            }
            JobCommand::Import(ImportCompletion {
                job,
                id,
                author,
                source,
                renames,
                prefix,
                is_new,
                restamp,
            }) => {
                let options = import::ImportOptions {
                    renames,
                    prefix,
                    is_new,
                    restamp,
                };
                let request = import::ImportRequest::new(id, author, requester, source, options)?;
                self.import(job, requester, request)
            }
        }
    }

    fn begin(&self, kind: JobKind, owner: Requester) -> Result<Reply, Refusal> {
        let mut jobs = self.jobs.lock();
        admission::make_room(&mut jobs, &kind, owner)?;
        let progress = Arc::new(Progress::default());
        let mut upload = None;
        match &kind {
            JobKind::Verify => self.spawn(progress.clone(), verification::verify)?,
            JobKind::Repair => self.spawn(progress.clone(), move |context, progress| {
                verification::repair(context, progress, owner)
            })?,
            JobKind::Export => self.spawn(progress.clone(), export::run)?,
            JobKind::Compact { forgotten_for_s } => {
                let forgotten_for_s = *forgotten_for_s;
                self.spawn(progress.clone(), move |context, progress| {
                    compaction::run(context, progress, forgotten_for_s, owner)
                })?;
            }
            // Starts when the upload is complete.
            JobKind::Import => upload = Some(Upload::of_import(&self.context.scratch)?),
            JobKind::Document => {
                let scratch = &self.context.scratch;
                upload = Some(Upload::of_document(scratch, MAX_DOCUMENT_BYTES));
            }
        }
        let job = self.next.fetch_add(1, Ordering::Relaxed);
        let entry = Job {
            kind,
            owner,
            progress: progress.clone(),
            upload: upload.map(Arc::new),
            is_importing: false,
            asked: Instant::now(),
        };
        jobs.insert(job, entry);
        Ok(Reply::Job(report(job, &progress)))
    }

    fn ask(&self, job: u64, requester: Requester) -> Result<Reply, Refusal> {
        let (report, is_over) = self.with(job, requester, |entry| {
            let report = report(job, &entry.progress);
            let is_over = report.outcome.is_some() && !entry.has_bytes_to_read();
            (report, is_over)
        })?;
        if is_over {
            self.jobs.lock().remove(&job);
        }
        Ok(Reply::Job(report))
    }

    /// Writes a part of an upload, on a thread that may wait for the disk.
    async fn write(
        &self,
        job: u64,
        requester: Requester,
        offset: u64,
        bytes: Vec<u8>,
    ) -> Result<Reply, Refusal> {
        let (upload, progress) = self.with(job, requester, |entry| {
            let upload = entry.upload.clone().filter(|_| !entry.is_importing);
            (upload, entry.progress.clone())
        })?;
        let upload = upload.ok_or_else(|| not_that_kind(job))?;
        let n_others = self.n_uploaded_bytes(job);
        let limits = *self.context.uploads.lock();
        let write = move || upload.write(offset, &bytes, n_others, &limits);
        let written = tokio::task::spawn_blocking(write).await;
        written.unwrap_or_else(|lost| {
            let sentence = format!("the uploaded bytes were not kept: {lost}; send them again");
            Err(Refusal::new(RefusalKind::Internal, sentence))
        })?;
        Ok(Reply::Job(report(job, &progress)))
    }

    /// Bytes of all uploads but that of one job.
    fn n_uploaded_bytes(&self, but: u64) -> u64 {
        let jobs = self.jobs.lock();
        let others = jobs.iter().filter(|(job, _)| **job != but);
        let uploads = others.filter_map(|(_, entry)| entry.upload.as_ref());
        uploads.map(|upload| upload.n_bytes()).sum()
    }

    fn import(
        &self,
        job: u64,
        requester: Requester,
        request: import::ImportRequest,
    ) -> Result<Reply, Refusal> {
        let (upload, progress) = self.with(job, requester, |entry| {
            let is_import = entry.kind == JobKind::Import;
            let is_first = is_import && !std::mem::replace(&mut entry.is_importing, true);
            let upload = entry.upload.clone().filter(|_| is_first);
            (upload, entry.progress.clone())
        })?;
        let upload = upload.ok_or_else(|| not_that_kind(job))?;
        let file = upload.open()?;
        self.spawn(progress.clone(), move |context, progress| {
            import::run(context, progress, &file, &request)
        })?;
        Ok(Reply::Job(report(job, &progress)))
    }

    /// Looks a job of this user up, which counts as polling it.
    fn with<T>(
        &self,
        job: u64,
        requester: Requester,
        look: impl FnOnce(&mut Job) -> T,
    ) -> Result<T, Refusal> {
        let mut jobs = self.jobs.lock();
        let entry = jobs
            .get_mut(&job)
            .filter(|entry| entry.owner.uid == requester.uid);
        let entry = entry.ok_or_else(|| {
            let sentence = format!(
                "there is no job {job} of this user; it was cancelled, or its outcome was \
                 delivered already"
            );
            Refusal::new(RefusalKind::NotFound, sentence)
        })?;
        entry.asked = Instant::now();
        Ok(look(entry))
    }

    fn spawn(
        &self,
        progress: Arc<Progress>,
        work: impl FnOnce(&JobContext, &Progress) -> Result<JobOutcome, String> + Send + 'static,
    ) -> Result<(), Refusal> {
        let context = self.context.clone();
        let run = move || {
            let worked = catch_unwind(AssertUnwindSafe(|| work(&context, &progress)));
            let outcome = worked.unwrap_or_else(|_| {
                Err("it ended by a fault of tabula; see the log of tabula-memory".to_owned())
            });
            *progress.outcome.lock() = Some(outcome.unwrap_or_else(JobOutcome::Failed));
        };
        let spawned = std::thread::Builder::new()
            .name("memory-job".into())
            .spawn(run);
        spawned.map(drop).map_err(|error| {
            let sentence = format!("no thread can be started for this job: {error}");
            Refusal::new(RefusalKind::Unavailable, sentence)
        })
    }
}

impl Job {
    /// `true` for an export that has not failed: its bytes are read after its outcome, and again
    /// when an answer was lost.
    fn has_bytes_to_read(&self) -> bool {
        let has_failed = matches!(*self.progress.outcome.lock(), Some(JobOutcome::Failed(_)));
        self.kind == JobKind::Export && !has_failed
    }

    /// `true` for an export of which all bytes were read. It stays for a client that has lost the
    /// last answer, until another job begins.
    fn is_delivered(&self) -> bool {
        match &*self.progress.outcome.lock() {
            Some(JobOutcome::Exported(report)) => {
                self.progress.n_read.load(Ordering::Relaxed) >= report.bytes
            }
            _ => false,
        }
    }
}

fn not_that_kind(job: u64) -> Refusal {
    let sentence = format!(
        "job {job} is no upload of this kind, or all its bytes were sent already; begin another one"
    );
    Refusal::new(RefusalKind::Invalid, sentence)
}

fn report(job: u64, progress: &Progress) -> JobReport {
    JobReport {
        job,
        done: progress.done.load(Ordering::Relaxed),
        total: progress.total.load(Ordering::Relaxed),
        outcome: progress.outcome.lock().clone(),
    }
}

#[cfg(test)]
mod document_tests;
#[cfg(test)]
mod tests;
