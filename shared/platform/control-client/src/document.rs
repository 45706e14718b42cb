//! Documents of the perceptual memory: read and stored page by page.

use crate::authorship::{author_or_user, mutation_id};
use crate::change::{PATIENCE, until_known};
use crate::connection::{call_failure, try_connect};
use crate::memory_client::MemoryClient;
use control_protocol::{
    Command, ContentDigest, DOCUMENT_PAGE_BYTES, DocumentKind, DocumentName, DocumentPage,
    DocumentReport, DocumentVersionReport, JobReport, LearningReport, MAX_DOCUMENT_BYTES,
    MutationId, PageRequest, Refusal, RefusalKind, Reply, Revision, RevisionChange, TypedRequest,
    request,
};
use daemon_client::CallError;
use service::{Failure, exit_code};

/// Number of times that reading begins again because the document was replaced. Chosen: more than
/// a person or a model builder replaces it in the seconds that 16 MB take.
const MAX_READINGS: usize = 4;

/// Document with its whole content.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredDocument {
    /// Metadata of the version that was read.
    pub report: DocumentReport,
    /// Content of that version.
    pub content: Vec<u8>,
}

/// Document to be stored.
#[derive(Debug, Clone, Copy)]
pub struct NewDocument<'a> {
    /// Name of the document; it replaces the one of this name.
    pub document: &'a DocumentName,
    /// Media type (MIME) of the content.
    pub media_type: &'a str,
    /// Content of the document, at most [`MAX_DOCUMENT_BYTES`].
    pub content: &'a [u8],
}

/// Reads a document page by page; `call` sends a command. A document that is replaced meanwhile is
/// read again from its beginning, so that no two versions are mixed.
///
/// # Errors
/// If there is no such document, it is replaced again and again, or the connection ends.
pub fn read_document(
    document: &DocumentName,
    mut call: impl FnMut(Command) -> Result<Reply, CallError>,
) -> Result<StoredDocument, Failure> {
    let mut n_readings = 1;
    loop {
        match read_version(document, &mut call)? {
            Ok(document) => return Ok(document),
            Err(refusal) if refusal.kind == RefusalKind::Conflict && n_readings < MAX_READINGS => {
                n_readings += 1;
            }
            Err(refusal) => return Err(call_failure(CallError::Refusal(refusal))),
        }
    }
}

/// Reads the present version of a document, or gives the refusal of one of its pages.
fn read_version(
    document: &DocumentName,
    call: &mut impl FnMut(Command) -> Result<Reply, CallError>,
) -> Result<Result<StoredDocument, Refusal>, Failure> {
    let mut content = Vec::new();
    let mut digest = None;
    loop {
        let request = PageRequest {
            document: document.clone(),
            digest,
            offset: content.len() as u64,
        };
        let request = request::document(request);
        let reply = call(request.command().clone()).map_err(call_failure)?;
        let page = match request.read(reply) {
            Ok(page) => page,
            Err(refusal) => return Ok(Err(refusal)),
        };
        let DocumentPage {
            document: report,
            content: bytes,
            ..
        } = page;
        digest = Some(report.digest);
        content.extend_from_slice(&bytes);
        if content.len() as u64 == report.bytes && ContentDigest::of(&content) == report.digest {
            return Ok(Ok(StoredDocument { report, content }));
        }
        if bytes.is_empty() || content.len() as u64 >= report.bytes {
            let sentence = format!(
                "the pages of {:?} do not make the document that the memory announced: they have \
                 {} bytes of {}; this is a fault of tabula",
                document.name,
                content.len(),
                report.bytes
            );
            return Err(Failure::general(sentence));
        }
    }
}

/// Stores a document: uploads its content page by page, then makes one change. `upload` is the id
/// of the upload of an earlier attempt, and gets that of this one; an attempt whose change may have
/// been made is repeated with the same `id` and `upload`.
///
/// The document is on disk then.
///
/// # Errors
/// If the document is refused, or the connection ends.
pub fn try_put_document(
    id: MutationId,
    author: &str,
    new: NewDocument<'_>,
    upload: &mut Option<u64>,
    mut call: impl FnMut(Command) -> Result<Reply, CallError>,
) -> Result<LearningReport, CallError> {
    let digest = ContentDigest::of(new.content);
    loop {
        let known = *upload;
        let job = match known {
            Some(job) => job,
            None => *upload.insert(upload_content(new.content, &mut call)?),
        };
        let put = request::revise(Revision {
            id,
            author: author.to_owned(),
            change: RevisionChange::PutDocument {
                document: new.document.clone(),
                media_type: new.media_type.to_owned(),
                upload: job,
                digest,
            },
        });
        let outcome = put.read(call(put.command().clone())?);
        // The upload of an earlier attempt ends with its process, and another may have its id.
        let is_lost = outcome.as_ref().is_err_and(|refusal| {
            matches!(refusal.kind, RefusalKind::NotFound | RefusalKind::Invalid)
        });
        if known.is_none() || !is_lost {
            return outcome.map_err(CallError::Refusal);
        }
        *upload = None;
    }
}

/// Uploads content; returns the id of the upload.
fn upload_content(
    content: &[u8],
    call: &mut impl FnMut(Command) -> Result<Reply, CallError>,
) -> Result<u64, CallError> {
    let mut send = |request: TypedRequest<JobReport>| {
        let reply = call(request.command().clone())?;
        request.read(reply).map_err(CallError::Refusal)
    };
    let job = send(request::upload_document())?.job;
    let mut offset = 0;
    for page in content.chunks(DOCUMENT_PAGE_BYTES) {
        send(request::write_job(job, offset, page.to_vec()))?;
        offset += page.len() as u64;
    }
    Ok(job)
}

/// Documents.
impl MemoryClient {
    /// Documents of a kind, by name.
    ///
    /// # Errors
    /// If the request is refused or the connection ends.
    pub fn documents(&mut self, kind: DocumentKind) -> Result<Vec<DocumentReport>, Failure> {
        let mut all = Vec::new();
        let mut after = None;
        loop {
            let (documents, next) = self.ask(&request::documents(after))?;
            let of_kind = |report: &DocumentReport| report.document.kind == kind;
            all.extend(documents.into_iter().filter(of_kind));
            after = match next {
                Some(next) => Some(next),
                None => return Ok(all),
            };
        }
    }

    /// Versions of a document that the memory keeps, oldest first.
    ///
    /// # Errors
    /// If there is no such document or the connection ends.
    pub fn document_versions(
        &mut self,
        document: &DocumentName,
    ) -> Result<Vec<DocumentVersionReport>, Failure> {
        self.ask(&request::document_versions(document.clone()))
    }

    /// Reads a document with its content; see [`read_document`].
    ///
    /// # Errors
    /// As [`read_document`].
    pub fn document(&mut self, document: &DocumentName) -> Result<StoredDocument, Failure> {
        read_document(document, |command| self.client.call(command))
    }

    /// Stores a document, and repeats that until its outcome is known. The author is the user
    /// unless one is given.
    ///
    /// # Errors
    /// If the content is longer than [`MAX_DOCUMENT_BYTES`]; otherwise as
    /// [`change`](crate::change).
    pub fn put_document(
        &mut self,
        new: NewDocument<'_>,
        author: Option<&str>,
    ) -> Result<LearningReport, Failure> {
        let n_bytes = new.content.len() as u64;
        if n_bytes > MAX_DOCUMENT_BYTES {
            let sentence = format!(
                "{:?} has {n_bytes} bytes, and a document has at most {MAX_DOCUMENT_BYTES}; store \
                 a smaller one",
                new.document.name
            );
            return Err(Failure::new(exit_code::REFUSED, sentence));
        }
        let (id, author) = (mutation_id()?, author_or_user(author));
        let (mut is_repeated, mut upload) = (false, None);
        until_known(PATIENCE, || {
            if std::mem::replace(&mut is_repeated, true)
                && let Some(common) = &self.daemon
            {
                self.client = try_connect(common)?;
            }
            let call = |command| self.client.call(command);
            try_put_document(id, &author, new, &mut upload, call)
        })
    }

    /// Removes a document. The author is the user unless one is given.
    ///
    /// # Errors
    /// If there is no such document; otherwise as [`change`](crate::change).
    pub fn remove_document(
        &mut self,
        document: &DocumentName,
        author: Option<&str>,
    ) -> Result<LearningReport, Failure> {
        self.change(&request::revise(Revision {
            id: mutation_id()?,
            author: author_or_user(author),
            change: RevisionChange::RemoveDocument {
                document: document.clone(),
            },
        }))
    }
}

#[cfg(test)]
mod tests;
