//! Uploaded content of a document.

use super::Jobs;
use control_protocol::{ContentDigest, JobKind, Refusal, RefusalKind};
use perceptual_memory::Requester;

impl Jobs {
    /// Content of an upload of this user, read on a thread that may wait for the disk. The upload
    /// stays until [`Self::end`].
    pub(crate) async fn document_content(
        &self,
        job: u64,
        requester: Requester,
        digest: ContentDigest,
    ) -> Result<Vec<u8>, Refusal> {
        let upload = self.with(job, requester, |entry| {
            let is_document = entry.kind == JobKind::Document;
            entry.upload.clone().filter(|_| is_document)
        })?;
        let upload = upload.ok_or_else(|| {
            let sentence = format!("job {job} is no upload of a document; begin one");
            Refusal::new(RefusalKind::Invalid, sentence)
        })?;
        let read = move || {
            let content = upload.read()?;
            let found = ContentDigest::of(&content);
            Ok((content, found))
        };
        let read = tokio::task::spawn_blocking(read).await;
        let (content, found) = read.unwrap_or_else(|lost| {
            let sentence = format!("the uploaded bytes were not read: {lost}; send this again");
            Err(Refusal::new(RefusalKind::Internal, sentence))
        })?;
        if found == digest {
            return Ok(content);
        }
        let sentence = format!(
            "the {} uploaded bytes have the digest {found}, not {digest}; upload the document again",
            content.len()
        );
        Err(Refusal::new(RefusalKind::Invalid, sentence))
    }

    /// Ends a job, and frees what it holds.
    pub(crate) fn end(&self, job: u64) {
        self.jobs.lock().remove(&job);
    }
}
