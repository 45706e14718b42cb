//! Import job: validates a complete export file, then merges it batch by batch.

use crate::job_context::{JobContext, Progress, publish_position, wall_ns};
use crate::translate;
use learning::CategoryName;
use message::control::{ImportReport, JobOutcome, MutationId, Refusal};
use perceptual_memory::{
    Digest, ImportPart, Mutation, MutationReceipt, PortableBatch, PortableReader, Requester,
    StoreChange,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{BufReader, Seek};

/// Parameters of an import into the store.
pub(crate) struct ImportRequest {
    id: MutationId,
    author: String,
    requester: Requester,
    source: String,
    renames: BTreeMap<CategoryName, CategoryName>,
    prefix: String,
    is_new: bool,
}

/// Names of imported categories as they are to be in this memory.
pub(crate) struct NamesOfImport {
    pub(crate) renames: Vec<(String, String)>,
    pub(crate) prefix: String,
    /// `true` if a new category may have a name like that of another one.
    pub(crate) is_new: bool,
}

impl ImportRequest {
    pub(crate) fn new(
        id: MutationId,
        author: String,
        requester: Requester,
        source: String,
        names: NamesOfImport,
    ) -> Result<Self, Refusal> {
        let NamesOfImport {
            renames,
            prefix,
            is_new,
        } = names;
        let rename = |(from, to): (String, String)| {
            Ok((translate::category(&from)?, translate::category(&to)?))
        };
        if !prefix.is_empty() {
            translate::category(&prefix)?;
        }
        Ok(Self {
            id,
            author,
            requester,
            source,
            renames: renames.into_iter().map(rename).collect::<Result<_, _>>()?,
            prefix,
            is_new,
        })
    }

    /// Local category name of an imported category.
    fn name(&self, name: &CategoryName) -> Result<CategoryName, String> {
        let renamed = self.renames.get(name);
        if let Some(name) = renamed.or_else(|| self.renames.get(&name.normalised())) {
            return Ok(name.clone());
        }
        let prefixed = format!("{}{name}", self.prefix);
        CategoryName::new(&prefixed).map_err(|error| format!("{prefixed:?}: {error}"))
    }
}

/// Imports the file, or nothing of it if it is invalid or its client goes before it is checked.
pub(crate) fn run(
    context: &JobContext,
    progress: &Progress,
    file: &File,
    request: &ImportRequest,
) -> Result<JobOutcome, String> {
    let n_bytes = check(context, file, request, progress)?;
    let mut reader = open(file)?;
    let mut n_views_changed = 0;
    let mut n_parts = 0;
    let mut entry = EntryOfImport::default();
    let mut next = batch_of(&mut reader)?;
    while let Some(batch) = next {
        next = batch_of(&mut reader)?;
        entry.part.is_continued = next.is_some();
        let receipt = take_over(context, request, (n_parts, entry.part), batch)?;
        entry.follow(receipt.sequence);
        n_views_changed += receipt.n_views;
        n_parts += 1;
        progress.set(n_bytes + reader.n_bytes_read(), 2 * n_bytes);
    }
    let position = context.store.position();
    publish_position(&context.position, position);
    let counts = reader.counts();
    Ok(JobOutcome::Imported(ImportReport {
        n_views: counts.n_views + counts.n_forgotten,
        n_views_changed,
        n_documents: counts.n_documents,
        sequence: entry.last.unwrap_or(position.sequence),
    }))
}

/// Place of the next entry of an import, and its last one so far.
#[derive(Default)]
struct EntryOfImport {
    part: ImportPart,
    last: Option<u64>,
}

impl EntryOfImport {
    fn follow(&mut self, sequence: u64) {
        self.part.first.get_or_insert(sequence);
        self.last = Some(sequence);
    }
}

fn batch_of<R: std::io::Read>(
    reader: &mut PortableReader<R>,
) -> Result<Option<PortableBatch>, String> {
    reader.batch().map_err(|error| error.to_string())
}

/// Validates the complete file; returns its length.
fn check(
    context: &JobContext,
    file: &File,
    request: &ImportRequest,
    progress: &Progress,
) -> Result<u64, String> {
    let n_bytes = file.metadata().map_or(0, |metadata| metadata.len());
    let mut reader = open(file)?;
    let mut other_kinds = BTreeSet::new();
    let mut n_other = 0;
    let mut names = BTreeSet::new();
    while let Some(batch) = reader.batch().map_err(|error| error.to_string())? {
        for view in &batch.views {
            if let Some(name) = view.standing().category() {
                names.insert(request.name(name)?);
            }
            let kind = view.descriptor_kind();
            if let Some(other) = kind.filter(|kind| *kind != context.descriptor_kind) {
                n_other += 1;
                other_kinds.insert(other.to_owned());
            }
        }
        progress.set(reader.n_bytes_read(), 2 * n_bytes);
        if progress.is_abandoned() {
            return Err("its client has gone; nothing was taken over".to_owned());
        }
    }
    if n_other == 0 {
        if !request.is_new {
            check_names(context, names)?;
        }
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

fn check_names(context: &JobContext, names: BTreeSet<CategoryName>) -> Result<(), String> {
    let checked = context
        .store
        .read_and_wait(move |memory| memory.check_new_names(&names));
    checked.map_err(|error| format!("{error}; nothing was taken over"))
}

fn open(mut file: &File) -> Result<PortableReader<BufReader<&File>>, String> {
    let rewound = file.rewind();
    rewound.map_err(|error| format!("its bytes cannot be read again: {error}"))?;
    PortableReader::new(BufReader::new(file)).map_err(|error| error.to_string())
}

/// Imports one batch of views and documents, by its number and its place in the history.
fn take_over(
    context: &JobContext,
    request: &ImportRequest,
    (n, part): (u64, ImportPart),
    mut batch: PortableBatch,
) -> Result<MutationReceipt, String> {
    for view in &mut batch.views {
        view.rename(|name| request.name(name).ok());
    }
    // The same part of the same request has the same id, so that a retry is idempotent.
    let id = [request.id.0.to_le_bytes().as_slice(), &n.to_le_bytes()].concat();
    let mutation = Mutation {
        id: perceptual_memory::MutationId(Digest::of(&id).0),
        author: request.author.clone(),
        requester: request.requester,
        wall_ns: wall_ns(),
        change: StoreChange::Import {
            source: request.source.clone(),
            views: batch.views,
            documents: batch.documents,
            part,
        },
    };
    let receipt = context.store.mutate_and_wait(mutation);
    receipt.map_err(|error| error.to_string())
}
