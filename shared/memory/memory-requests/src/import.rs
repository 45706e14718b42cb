//! Import job: validates a complete export file, then merges it batch by batch.

use crate::job_context::{JobContext, Progress, publish_position, wall_ns};
use crate::translate;
use learning::CategoryName;
use message::control::{ImportReport, JobOutcome, MutationId, Refusal, RefusalKind};
use perceptual_memory::{Digest, Mutation, PortableBatch, PortableReader, StoreChange};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::BufReader;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

/// Parameters of an import into the store.
pub(crate) struct ImportRequest {
    id: MutationId,
    author: String,
    source: String,
    renames: BTreeMap<CategoryName, CategoryName>,
    prefix: String,
}

impl ImportRequest {
    pub(crate) fn new(
        id: MutationId,
        author: String,
        source: String,
        renames: Vec<(String, String)>,
        prefix: String,
    ) -> Result<Self, Refusal> {
        let rename = |(from, to): (String, String)| {
            Ok((translate::category(&from)?, translate::category(&to)?))
        };
        if !prefix.is_empty() {
            translate::category(&prefix)?;
        }
        Ok(Self {
            id,
            author,
            source,
            renames: renames.into_iter().map(rename).collect::<Result<_, _>>()?,
            prefix,
        })
    }

    /// Local category name of an imported category.
    fn name(&self, name: &CategoryName) -> Result<CategoryName, String> {
        if let Some(name) = self.renames.get(name) {
            return Ok(name.clone());
        }
        let prefixed = format!("{}{name}", self.prefix);
        CategoryName::new(&prefixed).map_err(|error| format!("{prefixed:?}: {error}"))
    }
}

/// Path of the upload file of a job.
pub(crate) fn path(scratch: &Path, job: u64) -> PathBuf {
    scratch.join(format!("import-{job}"))
}

/// Writes received bytes to the upload file.
pub(crate) fn write(path: &Path, offset: u64, bytes: &[u8]) -> Result<(), Refusal> {
    let refused = |error| {
        let sentence = format!(
            "the bytes of the import cannot be kept in {}: {error}; see that the disk has room",
            path.display()
        );
        Refusal::new(RefusalKind::Unavailable, sentence)
    };
    if let Some(scratch) = path.parent() {
        fs::create_dir_all(scratch).map_err(refused)?;
    }
    let file = fs::OpenOptions::new()
        .create(true)
        .truncate(false)
        .write(true)
        .open(path)
        .map_err(refused)?;
    file.write_all_at(bytes, offset).map_err(refused)
}

/// Imports the file, or nothing of it if it is invalid.
pub(crate) fn run(
    context: &JobContext,
    progress: &Progress,
    path: &Path,
    request: &ImportRequest,
) -> Result<JobOutcome, String> {
    let outcome = try_run(context, progress, path, request);
    // A file that remains is removed at the next start.
    let _ = fs::remove_file(path);
    outcome.map(JobOutcome::Imported)
}

fn try_run(
    context: &JobContext,
    progress: &Progress,
    path: &Path,
    request: &ImportRequest,
) -> Result<ImportReport, String> {
    let n_bytes = check(context, path, request, progress)?;
    let mut reader = open(path)?;
    let mut n_views_changed = 0;
    let mut part = 0;
    while let Some(batch) = reader.batch().map_err(|error| error.to_string())? {
        n_views_changed += take_over(context, request, part, batch)?;
        part += 1;
        progress.set(n_bytes + reader.n_bytes_read(), 2 * n_bytes);
    }
    let position = context.store.position();
    publish_position(&context.position, position);
    let counts = reader.counts();
    Ok(ImportReport {
        n_views: counts.n_views + counts.n_forgotten,
        n_views_changed,
        n_documents: counts.n_documents,
        sequence: position.sequence,
    })
}

/// Validates the complete file; returns its length.
fn check(
    context: &JobContext,
    path: &Path,
    request: &ImportRequest,
    progress: &Progress,
) -> Result<u64, String> {
    let n_bytes = fs::metadata(path).map_or(0, |metadata| metadata.len());
    let mut reader = open(path)?;
    let mut other_kinds = BTreeSet::new();
    let mut n_other = 0;
    while let Some(batch) = reader.batch().map_err(|error| error.to_string())? {
        for view in &batch.views {
            if let Some(name) = view.standing().category() {
                request.name(name)?;
            }
            let kind = view.descriptor_kind();
            if let Some(other) = kind.filter(|kind| *kind != context.descriptor_kind) {
                n_other += 1;
                other_kinds.insert(other.to_owned());
            }
        }
        progress.set(reader.n_bytes_read(), 2 * n_bytes);
    }
    if n_other == 0 {
        return Ok(n_bytes);
    }
    let kinds: Vec<String> = other_kinds.into_iter().collect();
    Err(format!(
        "{n_other} of its views are described as {}, which cannot be compared with {} as this \
         robot describes; nothing was taken over, export from a robot of the same version",
        kinds.join(", "),
        context.descriptor_kind
    ))
}

fn open(path: &Path) -> Result<PortableReader<BufReader<File>>, String> {
    let file = File::open(path).map_err(|error| format!("no byte of it has come: {error}"))?;
    PortableReader::new(BufReader::new(file)).map_err(|error| error.to_string())
}

/// Imports one batch of views and documents; returns the number of changed views.
fn take_over(
    context: &JobContext,
    request: &ImportRequest,
    part: u64,
    mut batch: PortableBatch,
) -> Result<u64, String> {
    for view in &mut batch.views {
        view.rename(|name| request.name(name).ok());
    }
    // The same part of the same request has the same id, so that a retry is idempotent.
    let id = [request.id.0.to_le_bytes().as_slice(), &part.to_le_bytes()].concat();
    let mutation = Mutation {
        id: perceptual_memory::MutationId(Digest::of(&id).0),
        author: request.author.clone(),
        wall_ns: wall_ns(),
        change: StoreChange::Import {
            source: request.source.clone(),
            views: batch.views,
            documents: batch.documents,
        },
    };
    let answer = context.store.mutate_and_wait(mutation);
    answer
        .map(|answer| answer.n_views)
        .map_err(|error| error.to_string())
}
