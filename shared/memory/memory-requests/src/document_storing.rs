//! Storing of a document: one atomic change that names an upload and the digest of its content.

use crate::jobs::Jobs;
use crate::revision;
use crate::store_client::{By, StoreClient};
use control_protocol::{ContentDigest, DocumentName, Refusal, RefusalKind, Reply};
use perceptual_memory::{MemoryDocument, StoreChange};
use std::sync::Arc;
use tokio::sync::Mutex;

/// Document to be stored, with the upload of its content.
pub(crate) struct UploadedDocument {
    pub(crate) document: DocumentName,
    pub(crate) media_type: String,
    /// Id of the job that holds the content.
    pub(crate) upload: u64,
    pub(crate) digest: ContentDigest,
}

/// Storing of uploaded documents, one at a time, so that one content at most is in memory.
#[derive(Clone)]
pub(crate) struct DocumentStoring {
    store: StoreClient,
    jobs: Arc<Jobs>,
    turn: Arc<Mutex<()>>,
}

impl DocumentStoring {
    pub(crate) fn new(store: StoreClient, jobs: Arc<Jobs>) -> Self {
        Self {
            store,
            jobs,
            turn: Arc::default(),
        }
    }

    /// Stores a document. It goes on without its client once it has its turn, so that clients that
    /// come and go do not fill the memory with contents.
    pub(crate) async fn store(&self, by: By, uploaded: UploadedDocument) -> Result<Reply, Refusal> {
        let turn = Arc::clone(&self.turn).lock_owned().await;
        let storing = self.clone();
        let stored = tokio::spawn(async move {
            let _turn = turn;
            storing.store_in_turn(by, uploaded).await
        });
        stored.await.unwrap_or_else(|lost| {
            let sentence = format!(
                "it is not known if the document was stored ({lost}); send it again with the same \
                 id until it is answered"
            );
            Err(Refusal::new(RefusalKind::UnknownOutcome, sentence))
        })
    }

    async fn store_in_turn(&self, by: By, uploaded: UploadedDocument) -> Result<Reply, Refusal> {
        let UploadedDocument {
            document,
            media_type,
            upload,
            digest,
        } = uploaded;
        let about = document.name.clone();
        let key = revision::key(document)?;
        let content = match self.jobs.document_content(upload, by.user, digest).await {
            Ok(content) => content,
            Err(refusal) => {
                // A repeated request: the upload ended with the change, or with its process.
                let answered = self.store.answered(by.id, &about).await?;
                return answered.ok_or(refusal);
            }
        };
        let change = StoreChange::PutDocument(MemoryDocument {
            key,
            media_type,
            content,
        });
        let reply = self.store.apply(by, change, &about).await?;
        self.jobs.end(upload);
        Ok(reply)
    }
}
