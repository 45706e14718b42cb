//! Long work: each job in a thread of its own, followed by asking.
//!
//! A job reads a checkpoint or asks the store in small steps, so that whoever
//! teaches meanwhile does not wait for it. One that nobody has asked about for a
//! while is given up.

use crate::desk::MemoryDeskConfig;
use crate::{compacting, exporting, importing, verifying};
use message::control::{JobCommand, JobKind, JobOutcome, JobReport, Refusal, RefusalKind, Reply};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use store::{Position, StoreHandle};
use tokio::sync::watch;

/// Most jobs at a time.
const MAX_JOBS: usize = 4;
/// A job nobody asks about is given up after this time.
const PATIENCE: Duration = Duration::from_secs(60);

/// What every job needs.
#[derive(Clone)]
pub(crate) struct Surroundings {
    pub(crate) store: StoreHandle,
    pub(crate) scratch: PathBuf,
    pub(crate) descriptor_kind: &'static str,
    pub(crate) position: watch::Sender<Position>,
}

/// The jobs there are.
pub(crate) struct Jobs {
    surroundings: Surroundings,
    jobs: Mutex<BTreeMap<u64, Entry>>,
    next: AtomicU64,
}

struct Entry {
    kind: JobKind,
    progress: Arc<Progress>,
    asked: Instant,
}

/// How far a job is, and the bytes it hands on; shared with its thread.
#[derive(Default)]
pub(crate) struct Progress {
    pub(crate) done: AtomicU64,
    pub(crate) total: AtomicU64,
    is_given_up: AtomicBool,
    outcome: Mutex<Option<JobOutcome>>,
    pub(crate) bytes: Mutex<exporting::Buffer>,
    pub(crate) bytes_moved: Condvar,
}

impl Progress {
    /// Whether nobody waits for the job any more.
    pub(crate) fn is_given_up(&self) -> bool {
        self.is_given_up.load(Ordering::Relaxed)
    }

    /// Says how far the job is.
    pub(crate) fn set(&self, done: u64, total: u64) {
        self.total.store(total, Ordering::Relaxed);
        self.done.store(done, Ordering::Relaxed);
    }
}

impl Drop for Entry {
    fn drop(&mut self) {
        self.progress.is_given_up.store(true, Ordering::Relaxed);
        self.progress.bytes_moved.notify_all();
    }
}

/// Nothing that is locked here is left half changed.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Jobs {
    pub(crate) fn new(config: MemoryDeskConfig, position: watch::Sender<Position>) -> Self {
        // What an earlier process left of unfinished imports.
        let _ = std::fs::remove_dir_all(&config.scratch);
        Self {
            surroundings: Surroundings {
                store: config.store,
                scratch: config.scratch,
                descriptor_kind: config.descriptor_kind,
                position,
            },
            jobs: Mutex::new(BTreeMap::new()),
            next: AtomicU64::new(1),
        }
    }

    pub(crate) fn answer(&self, command: JobCommand) -> Result<Reply, Refusal> {
        let mut jobs = lock(&self.jobs);
        jobs.retain(|_, entry| entry.asked.elapsed() < PATIENCE);
        match command {
            JobCommand::Begin(kind) => self.begin(&mut jobs, kind),
            JobCommand::Ask { job } => {
                let entry = find(&mut jobs, job)?;
                let report = report(job, &entry.progress);
                if report.outcome.is_some() && entry.is_all_told() {
                    jobs.remove(&job);
                }
                Ok(Reply::Job(report))
            }
            JobCommand::Read { job, offset } => {
                let entry = find(&mut jobs, job)?;
                let bytes = exporting::read(&entry.progress, offset);
                Ok(Reply::JobBytes { bytes })
            }
            JobCommand::Write { job, offset, bytes } => {
                let entry = find(&mut jobs, job)?;
                if entry.kind != JobKind::Import {
                    return Err(not_that_kind(job));
                }
                let path = importing::path(&self.surroundings.scratch, job);
                importing::write(&path, offset, &bytes)?;
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
                let request = importing::Request::new(id, author, source, renames, prefix)?;
                let path = importing::path(&self.surroundings.scratch, job);
                let progress = entry.progress.clone();
                self.spawn(progress.clone(), move |surroundings, progress| {
                    importing::run(surroundings, progress, &path, &request)
                })?;
                Ok(Reply::Job(report(job, &progress)))
            }
            other => Err(Refusal::new(
                RefusalKind::Invalid,
                format!("this memory does not know the job {other:?}"),
            )),
        }
    }

    fn begin(&self, jobs: &mut BTreeMap<u64, Entry>, kind: JobKind) -> Result<Reply, Refusal> {
        if jobs.len() >= MAX_JOBS {
            return Err(Refusal::new(
                RefusalKind::Unavailable,
                format!("{MAX_JOBS} jobs are running on the memory already; try again later"),
            ));
        }
        let progress = Arc::new(Progress::default());
        match &kind {
            JobKind::Verify => self.spawn(progress.clone(), verifying::verify)?,
            JobKind::Repair => self.spawn(progress.clone(), verifying::repair)?,
            JobKind::Export => self.spawn(progress.clone(), exporting::run)?,
            JobKind::Compact { forgotten_for_s } => {
                let forgotten_for_s = *forgotten_for_s;
                self.spawn(progress.clone(), move |surroundings, progress| {
                    compacting::run(surroundings, progress, forgotten_for_s)
                })?;
            }
            // Begins when all bytes are there.
            JobKind::Import => {}
            other => {
                let sentence = format!("this memory does not know the job {other:?}");
                return Err(Refusal::new(RefusalKind::Invalid, sentence));
            }
        }
        let job = self.next.fetch_add(1, Ordering::Relaxed);
        let entry = Entry {
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
        work: impl FnOnce(&Surroundings, &Progress) -> Result<JobOutcome, String> + Send + 'static,
    ) -> Result<(), Refusal> {
        let surroundings = self.surroundings.clone();
        let run = move || {
            let outcome = work(&surroundings, &progress).unwrap_or_else(JobOutcome::Failed);
            *lock(&progress.outcome) = Some(outcome);
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

impl Entry {
    /// Whether the client has everything that the job hands on.
    fn is_all_told(&self) -> bool {
        self.kind != JobKind::Export
    }
}

fn find(jobs: &mut BTreeMap<u64, Entry>, job: u64) -> Result<&mut Entry, Refusal> {
    let entry = jobs.get_mut(&job).ok_or_else(|| {
        Refusal::new(
            RefusalKind::NotFound,
            format!("there is no job {job}; it was given up or has been told already"),
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
        outcome: lock(&progress.outcome).clone(),
    }
}
