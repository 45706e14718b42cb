//! Import job: validates a complete export file, then merges it batch by batch.

use crate::ahead_decisions::AheadDecisions;
use crate::job_context::{JobContext, Progress, publish_position, wall_ns};
use crate::translate;
use control_protocol::{ImportReport, JobOutcome, MutationId, Refusal};
use learning::CategoryName;
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
    /// Decisions from too far ahead get the present time, and are not left out.
    restamp: bool,
}

/// Options of an import: the names of its categories in this memory, and the decisions from too
/// far ahead.
pub(crate) struct ImportOptions {
    pub(crate) renames: Vec<(String, String)>,
    pub(crate) prefix: String,
    /// `true` if a new category may have a name like that of another one.
    pub(crate) is_new: bool,
    /// `true` if decisions from too far ahead get the present time; else they are left out.
    pub(crate) restamp: bool,
}

impl ImportRequest {
    pub(crate) fn new(
        id: MutationId,
        author: String,
        requester: Requester,
        source: String,
        options: ImportOptions,
    ) -> Result<Self, Refusal> {
        let ImportOptions {
            renames,
            prefix,
            is_new,
            restamp,
        } = options;
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
            restamp,
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
/// Decisions from too far ahead of this clock are left out, or restamped.
pub(crate) fn run(
    context: &JobContext,
    progress: &Progress,
    file: &File,
    request: &ImportRequest,
) -> Result<JobOutcome, String> {
    let n_bytes = check(context, file, request, progress)?;
    let mut n_views_changed = 0;
    let mut batches = BatchReader::new(file, request.restamp)?;
    let mut entry = EntryOfImport::default();
    let mut next = batches.next()?;
    while let Some(batch) = next {
        next = batches.next()?;
        entry.part.is_continued = next.is_some();
        let receipt = take_over(context, request, batch, entry.part)?;
        entry.follow(receipt.sequence);
        n_views_changed += receipt.n_views;
        progress.set(n_bytes + batches.reader.n_bytes_read(), 2 * n_bytes);
    }
    let position = context.store.position();
    publish_position(&context.position, position);
    let (counts, ahead) = (batches.reader.counts(), batches.ahead);
    Ok(JobOutcome::Imported(ImportReport {
        n_views: counts.n_views + counts.n_forgotten,
        n_views_changed,
        n_documents: counts.n_documents,
        sequence: entry.last.unwrap_or(position.sequence),
        n_left_out: ahead.n_left_out,
        n_restamped: ahead.n_restamped,
        ahead: ahead.first,
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

/// Batch with something to take over.
struct NumberedBatch {
    /// Number of the batch in the file.
    n: u64,
    /// Present time that it was read at, and that its restamped decisions have.
    wall_ns: u64,
    content: PortableBatch,
}

/// Reader of the batches of an export file that leaves out decisions from too far ahead, or
/// restamps them.
struct BatchReader<'a> {
    reader: PortableReader<BufReader<&'a File>>,
    n_read: u64,
    restamp: bool,
    ahead: AheadDecisions,
}

impl<'a> BatchReader<'a> {
    fn new(file: &'a File, restamp: bool) -> Result<Self, String> {
        Ok(Self {
            reader: open(file)?,
            n_read: 0,
            restamp,
            ahead: AheadDecisions::default(),
        })
    }

    /// Next batch that is not empty; `None` at the end of the file.
    fn next(&mut self) -> Result<Option<NumberedBatch>, String> {
        while let Some(mut content) = self.reader.batch().map_err(|error| error.to_string())? {
            let (n, wall_ns) = (self.n_read, wall_ns());
            self.n_read += 1;
            self.ahead.treat(&mut content, self.restamp, wall_ns);
            if !content.views.is_empty() || !content.documents.is_empty() {
                return Ok(Some(NumberedBatch {
                    n,
                    wall_ns,
                    content,
                }));
            }
        }
        Ok(None)
    }
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
    let (mut ahead, mut n_kept) = (AheadDecisions::default(), 0);
    while let Some(mut batch) = reader.batch().map_err(|error| error.to_string())? {
        ahead.treat(&mut batch, request.restamp, wall_ns());
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
        n_kept += batch.views.len() + batch.documents.len();
        progress.set(reader.n_bytes_read(), 2 * n_bytes);
        if progress.is_abandoned() {
            return Err("its client has gone; nothing was taken over".to_owned());
        }
    }
    if n_other == 0 && n_kept == 0 && ahead.n_left_out > 0 {
        return Err(format!(
            "all that it has was decided more than a day ahead of the clock of this robot, {}; \
             nothing was taken over, set the clock that is wrong, or import it with --restamp, \
             which gives these decisions the present time",
            ahead.n_left_out
        ));
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

/// Imports one batch of views and documents, by its place among the entries of the import.
fn take_over(
    context: &JobContext,
    request: &ImportRequest,
    batch: NumberedBatch,
    part: ImportPart,
) -> Result<MutationReceipt, String> {
    let NumberedBatch {
        n,
        wall_ns,
        content: mut batch,
    } = batch;
    for view in &mut batch.views {
        view.rename(|name| request.name(name).ok());
    }
    // The same part of the same request has the same id, so that a retry is idempotent.
    let id = [request.id.0.to_le_bytes().as_slice(), &n.to_le_bytes()].concat();
    let mutation = Mutation {
        id: perceptual_memory::MutationId(Digest::of(&id).0),
        author: request.author.clone(),
        requester: request.requester,
        wall_ns,
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
