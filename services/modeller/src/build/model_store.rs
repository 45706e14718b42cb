//! Storage of a model in the memory: what has grown so far, and the whole.

use command_line::Output;
use control_client::{MemoryClient, NewDocument};
use control_protocol::{DocumentKind, DocumentName};
use object_model::{MEDIA_TYPE, ObjectModel};
use service::{CommonArguments, Failure};

/// Storage of one model. While it grows, it is kept under a name of its own, so that an earlier
/// model of its name stays what it is, and a builder that is killed loses few views.
pub(super) struct ModelStore<'a> {
    common: &'a CommonArguments,
    author: Option<&'a str>,
    name: &'a str,
    has_unfinished: bool,
}

impl<'a> ModelStore<'a> {
    pub(super) fn new(common: &'a CommonArguments, author: Option<&'a str>, name: &'a str) -> Self {
        Self {
            common,
            author,
            name,
            has_unfinished: false,
        }
    }

    /// Stores what has grown so far. A failure is told, and stops nothing.
    pub(super) fn put_unfinished(&mut self, model: &ObjectModel, output: &Output) {
        match self.put(self.unfinished_name(), model) {
            Ok(_) => self.has_unfinished = true,
            Err(failure) => output.print_status(&format!(
                "the model was not stored while it grows: {failure}; it is stored at the end"
            )),
        }
    }

    /// Stores a model under a name; returns the size of the document, bytes.
    fn put(&self, name: String, model: &ObjectModel) -> Result<usize, Failure> {
        let content = model.to_bytes().map_err(Failure::general)?;
        let new = NewDocument {
            document: &document(name),
            media_type: MEDIA_TYPE,
            content: &content,
        };
        MemoryClient::open(self.common)?.put_document(new, self.author)?;
        Ok(content.len())
    }

    /// Stores the whole model, and removes what was stored while it grew; returns the size of the
    /// document, bytes.
    pub(super) fn finish(&self, model: &ObjectModel) -> Result<usize, Failure> {
        let n_bytes = self.put(self.name.to_owned(), model)?;
        if self.has_unfinished {
            let unfinished = document(self.unfinished_name());
            MemoryClient::open(self.common)?.remove_document(&unfinished, self.author)?;
        }
        Ok(n_bytes)
    }

    fn unfinished_name(&self) -> String {
        format!("{} (unfinished)", self.name)
    }
}

fn document(name: String) -> DocumentName {
    DocumentName {
        kind: DocumentKind::ObjectModel,
        name,
    }
}
