//! Pages of documents: their content by byte offset, their list, and their versions.

use crate::{revision, translate};
use control_protocol::{
    ContentDigest, DOCUMENT_PAGE_BYTES, DocumentName, DocumentPage, DocumentReport,
    DocumentVersionReport, MAX_MESSAGE_BYTES, MemoryAnswer, PageRequest, Refusal, RefusalKind,
};
use parking_lot::Mutex;
use perceptual_memory::{Digest, DocumentRevision, DocumentSummary, Error, PerceptualMemory};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Contents that are kept between two pages. Chosen: two readers at a time read each content once,
/// and 32 MB at most are held.
const MAX_CONTENTS: usize = 2;
/// Maximum estimated size of a page of the list, bytes; the rest of the message needs room too.
const LIST_BYTES: usize = MAX_MESSAGE_BYTES / 2;
/// Estimated size of a document in the list without its texts, bytes.
const LISTED_BYTES: usize = 250;

/// Contents of which pages were read lately. A content never changes, since its digest is its
/// key; so the cache is never out of date.
#[derive(Default)]
pub(crate) struct ContentCache(Mutex<Vec<CachedContent>>);

struct CachedContent {
    digest: Digest,
    content: Arc<Vec<u8>>,
    used: Instant,
}

impl ContentCache {
    /// Content of a digest: the cached one, or the one that `read` gives, which is then kept if it
    /// has several pages.
    fn content(
        &self,
        digest: Digest,
        read: impl FnOnce() -> Result<Vec<u8>, Error>,
    ) -> Result<Arc<Vec<u8>>, Error> {
        let mut cached = self.0.lock();
        if let Some(found) = cached.iter_mut().find(|entry| entry.digest == digest) {
            found.used = Instant::now();
            return Ok(Arc::clone(&found.content));
        }
        let content = Arc::new(read()?);
        if content.len() > DOCUMENT_PAGE_BYTES {
            if cached.len() >= MAX_CONTENTS {
                cached.sort_by_key(|entry| entry.used);
                cached.remove(0);
            }
            cached.push(CachedContent {
                digest,
                content: Arc::clone(&content),
                used: Instant::now(),
            });
        }
        Ok(content)
    }

    /// Frees contents of which no page was read for some time. Does not wait for a content that is
    /// just being read.
    pub(crate) fn free_unused(&self, after: Duration) {
        if let Some(mut cached) = self.0.try_lock() {
            cached.retain(|entry| entry.used.elapsed() < after);
        }
    }
}

/// Page of the content of a document's present version.
pub(crate) fn page(
    memory: &mut PerceptualMemory,
    cache: &ContentCache,
    request: PageRequest,
) -> Result<Result<MemoryAnswer, Refusal>, Error> {
    let checked = revision::key(request.document).and_then(|key| {
        let summary = memory.document_summary(&key);
        let summary = summary.map_err(|refusal| translate::refusal(&refusal.into()))?;
        check(&summary, request.digest, request.offset)?;
        let report = report(&summary).ok_or_else(|| unknown_kind(&summary))?;
        Ok((summary, report))
    });
    let (summary, document) = match checked {
        Ok(checked) => checked,
        Err(refusal) => return Ok(Err(refusal)),
    };
    let reference = &summary.content;
    let content = cache.content(reference.digest, || memory.document_content(reference))?;
    let rest = content.get(request.offset as usize..).unwrap_or_default();
    Ok(Ok(MemoryAnswer::Document(DocumentPage {
        document,
        offset: request.offset,
        content: rest[..rest.len().min(DOCUMENT_PAGE_BYTES)].to_vec(),
    })))
}

/// Refuses a page of another version than the present one, or behind its end.
fn check(
    summary: &DocumentSummary,
    digest: Option<ContentDigest>,
    offset: u64,
) -> Result<(), Refusal> {
    let DocumentSummary {
        key,
        content,
        decided,
        sequence,
    } = summary;
    if digest.is_some_and(|digest| digest.0 != content.digest.0) {
        let sentence = format!(
            "{key} was replaced while it was read, by entry {sequence} of {}; read it again from \
             its first page",
            decided.author
        );
        return Err(Refusal::new(RefusalKind::Conflict, sentence));
    }
    let n_bytes = content.n_bytes;
    if offset > u64::from(n_bytes) {
        let sentence = format!(
            "byte {offset} of {key} was asked for, which has {n_bytes} bytes; read it from byte 0"
        );
        return Err(Refusal::new(RefusalKind::Invalid, sentence));
    }
    Ok(())
}

fn unknown_kind(summary: &DocumentSummary) -> Refusal {
    let sentence = format!("{} is of a kind that the protocol lacks", summary.key);
    Refusal::new(RefusalKind::Internal, sentence)
}

/// Page of the list of all documents, by kind and name.
pub(crate) fn list(
    memory: &PerceptualMemory,
    after: Option<DocumentName>,
) -> Result<MemoryAnswer, Refusal> {
    let after = after.map(revision::key).transpose()?;
    let mut n_bytes = 0;
    let mut documents = Vec::new();
    let mut next = None;
    for summary in memory.documents() {
        if after.as_ref().is_some_and(|after| summary.key <= *after) {
            continue;
        }
        let Some(report) = report(&summary) else {
            continue;
        };
        n_bytes += LISTED_BYTES
            + report.document.name.len()
            + report.media_type.len()
            + report.author.len();
        if n_bytes > LIST_BYTES && !documents.is_empty() {
            next = documents
                .last()
                .map(|last: &DocumentReport| last.document.clone());
            break;
        }
        documents.push(report);
    }
    Ok(MemoryAnswer::Documents { documents, next })
}

/// Versions of a document, oldest first.
pub(crate) fn versions(
    memory: &PerceptualMemory,
    name: DocumentName,
) -> Result<MemoryAnswer, Refusal> {
    let versions = memory.document_versions(&revision::key(name)?);
    let versions = versions.map_err(|refusal| translate::refusal(&refusal.into()))?;
    let reports = versions.iter().map(version_report).collect();
    Ok(MemoryAnswer::DocumentVersions(reports))
}

fn version_report(version: &DocumentRevision) -> DocumentVersionReport {
    let content = version.content.as_ref();
    DocumentVersionReport {
        sequence: version.sequence,
        decided_ns: version.decided.stamp_ns,
        author: version.decided.author.to_string(),
        bytes: content.map(|content| u64::from(content.n_bytes)),
        digest: content.map(|content| ContentDigest(content.digest.0)),
    }
}

/// Report of a document; `None` for a kind that the protocol lacks.
fn report(summary: &DocumentSummary) -> Option<DocumentReport> {
    Some(DocumentReport {
        document: revision::name(&summary.key)?,
        media_type: summary.content.media_type.clone(),
        bytes: u64::from(summary.content.n_bytes),
        digest: ContentDigest(summary.content.digest.0),
        author: summary.decided.author.to_string(),
        decided_ns: summary.decided.stamp_ns,
        sequence: summary.sequence,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn long(value: u8) -> Vec<u8> {
        vec![value; DOCUMENT_PAGE_BYTES + 1]
    }

    /// Content of a digest, and true if it was read from the store.
    fn get(cache: &ContentCache, content: &[u8]) -> bool {
        let mut is_read = false;
        let found = cache.content(Digest::of(content), || {
            is_read = true;
            Ok(content.to_vec())
        });
        assert_eq!(**found.as_ref().unwrap(), content);
        is_read
    }

    #[test]
    fn contents_are_read_once_for_two_readers_and_then_freed() {
        let cache = ContentCache::default();
        for value in [1, 2] {
            assert!(get(&cache, &long(value)), "{value}");
        }
        for value in [1, 2, 2, 1] {
            assert!(!get(&cache, &long(value)), "{value}");
        }
        assert!(get(&cache, &long(3)), "it takes the place of 2");
        assert!(!get(&cache, &long(1)));
        assert!(get(&cache, &long(2)));
        cache.free_unused(Duration::from_secs(60));
        assert!(!get(&cache, &long(2)));
        cache.free_unused(Duration::ZERO);
        assert!(get(&cache, &long(2)));
    }

    #[test]
    fn content_of_one_page_is_not_kept() {
        let cache = ContentCache::default();
        assert!(get(&cache, b"note") && get(&cache, b"note"));
        assert!(cache.0.lock().is_empty());
    }

    #[test]
    fn digests_of_the_protocol_are_those_of_the_store() {
        for content in [&b""[..], b"note", &long(7)] {
            assert_eq!(ContentDigest::of(content).0, Digest::of(content).0);
        }
    }

    #[test]
    fn failed_reading_is_not_kept() {
        let cache = ContentCache::default();
        let failed = cache.content(Digest::of(b"x"), || Err(Error::Stopped));
        assert!(failed.is_err());
        assert!(cache.0.lock().is_empty());
    }
}
