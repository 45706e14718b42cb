//! Background jobs on the memory, each in its own thread and polled by the client.
//!
//! A job reads a checkpoint or sends small requests to the store, so that teaching is not delayed.
//! A job that no client polls is abandoned after a while.

use crate::job_context::{JobContext, Progress};
use crate::{compaction, export, import, verification};
use message::control::{JobCommand, JobKind, JobOutcome, JobReport, Refusal, RefusalKind, Reply};
use parking_lot::Mutex;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Maximum number of concurrent jobs.
const MAX_JOBS: usize = 4;
/// Time without polling after which a job is abandoned.
const ABANDON_AFTER: Duration = Duration::from_secs(60);

/// Table of the long-running jobs.
pub(crate) struct Jobs {
    context: JobContext,
    jobs: Mutex<BTreeMap<u64, Job>>,
    next: AtomicU64,
}

struct Job {
    kind: JobKind,
    progress: Arc<Progress>,
    asked: Instant,
}

impl Drop for Job {
    fn drop(&mut self) {
        self.progress.is_abandoned.store(true, Ordering::Relaxed);
        self.progress.bytes_moved.notify_all();
    }
}

impl Jobs {
    pub(crate) fn new(context: JobContext) -> Self {
        // Unfinished uploads of an earlier process.
        let _ = std::fs::remove_dir_all(&context.scratch);
        Self {
            context,
            jobs: Mutex::new(BTreeMap::new()),
            next: AtomicU64::new(1),
        }
    }

    pub(crate) fn answer(&self, command: JobCommand) -> Result<Reply, Refusal> {
        let mut jobs = self.jobs.lock();
        jobs.retain(|_, entry| entry.asked.elapsed() < ABANDON_AFTER);
        match command {
            JobCommand::Begin(kind) => self.begin(&mut jobs, kind),
            JobCommand::Ask { job } => {
                let entry = find(&mut jobs, job)?;
                let report = report(job, &entry.progress);
                if report.outcome.is_some() && entry.is_complete_once_reported() {
                    jobs.remove(&job);
                }
                Ok(Reply::Job(report))
            }
            JobCommand::Read { job, offset } => {
                let entry = find(&mut jobs, job)?;
                let bytes = export::read(&entry.progress, offset);
                Ok(Reply::JobBytes { bytes })
            }
            JobCommand::Write { job, offset, bytes } => {
                let entry = find(&mut jobs, job)?;
                if entry.kind != JobKind::Import {
                    return Err(not_that_kind(job));
                }
                let path = import::path(&self.context.scratch, job);
                import::write(&path, offset, &bytes)?;
                Ok(Reply::Job(report(job, &entry.progress)))
            }
            JobCommand::Import {
                job,
                id,
                author,
                source,
                renames,
                prefix,
            } => {
                let entry = find(&mut jobs, job)?;
                if entry.kind != JobKind::Import {
                    return Err(not_that_kind(job));
                }
                let request = import::ImportRequest::new(id, author, source, renames, prefix)?;
                let path = import::path(&self.context.scratch, job);
                let progress = entry.progress.clone();
                self.spawn(progress.clone(), move |context, progress| {
                    import::run(context, progress, &path, &request)
                })?;
                Ok(Reply::Job(report(job, &progress)))
            }
            other => Err(Refusal::new(
                RefusalKind::Invalid,
                format!("this memory does not know the job {other:?}"),
            )),
        }
    }

    fn begin(&self, jobs: &mut BTreeMap<u64, Job>, kind: JobKind) -> Result<Reply, Refusal> {
        if jobs.len() >= MAX_JOBS {
            return Err(Refusal::new(
                RefusalKind::Unavailable,
                format!("{MAX_JOBS} jobs are running on the memory already; try again later"),
            ));
        }
        let progress = Arc::new(Progress::default());
        match &kind {
            JobKind::Verify => self.spawn(progress.clone(), verification::verify)?,
            JobKind::Repair => self.spawn(progress.clone(), verification::repair)?,
            JobKind::Export => self.spawn(progress.clone(), export::run)?,
            JobKind::Compact { forgotten_for_s } => {
                let forgotten_for_s = *forgotten_for_s;
                self.spawn(progress.clone(), move |context, progress| {
                    compaction::run(context, progress, forgotten_for_s)
                })?;
            }
            // Starts when the upload is complete.
            JobKind::Import => {}
            other => {
                let sentence = format!("this memory does not know the job {other:?}");
                return Err(Refusal::new(RefusalKind::Invalid, sentence));
            }
        }
        let job = self.next.fetch_add(1, Ordering::Relaxed);
        let entry = Job {
            kind,
            progress: progress.clone(),
            asked: Instant::now(),
        };
        jobs.insert(job, entry);
        Ok(Reply::Job(report(job, &progress)))
    }

    fn spawn(
        &self,
        progress: Arc<Progress>,
        work: impl FnOnce(&JobContext, &Progress) -> Result<JobOutcome, String> + Send + 'static,
    ) -> Result<(), Refusal> {
        let context = self.context.clone();
        let run = move || {
            let outcome = work(&context, &progress).unwrap_or_else(JobOutcome::Failed);
            *progress.outcome.lock() = Some(outcome);
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
    /// `true` if the job can be removed once its outcome is reported: an export has bytes left to
    /// read.
    fn is_complete_once_reported(&self) -> bool {
        self.kind != JobKind::Export
    }
}

fn find(jobs: &mut BTreeMap<u64, Job>, job: u64) -> Result<&mut Job, Refusal> {
    let entry = jobs.get_mut(&job).ok_or_else(|| {
        Refusal::new(
            RefusalKind::NotFound,
            format!(
                "there is no job {job}; it was cancelled, or its outcome was delivered already"
            ),
        )
    })?;
    entry.asked = Instant::now();
    Ok(entry)
}

fn not_that_kind(job: u64) -> Refusal {
    let sentence = format!("job {job} is no import");
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
