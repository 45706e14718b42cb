//! `tabula knowledge`: named documents for tasks, stored in the memory.

use crate::arguments::{KnowledgeVerb, PutArguments};
use crate::missing_document::with_stored_names;
use crate::time::utc;
use command_line::{Output, format_table};
use control_client::{MemoryClient, NewDocument, StoredDocument};
use control_protocol::{DocumentKind, DocumentName, DocumentReport, MAX_DOCUMENT_BYTES};
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code};
use std::io::Read;
use std::process::ExitCode;

/// Runs a subcommand of `tabula knowledge`.
pub(crate) fn run(
    common: &CommonArguments,
    verb: &KnowledgeVerb,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let mut memory = MemoryClient::open(common)?;
    match verb {
        KnowledgeVerb::List => list(&mut memory, output),
        KnowledgeVerb::Get { name } => get(&mut memory, name, output),
        KnowledgeVerb::Put(arguments) => put(&mut memory, arguments, output),
        KnowledgeVerb::Remove { name, author } => {
            let document = document(name);
            let removed = memory.remove_document(&document, author.as_deref());
            let report =
                removed.map_err(|failure| with_stored_names(&mut memory, &document, failure))?;
            output.answer(&report, || {
                format!("removed {name:?}, history {}, on disk", report.sequence)
            });
            Ok(ExitCode::SUCCESS)
        }
    }
}

fn document(name: &str) -> DocumentName {
    DocumentName {
        kind: DocumentKind::TaskKnowledge,
        name: name.to_owned(),
    }
}

#[derive(Serialize)]
struct ListDocument {
    documents: Vec<DocumentReport>,
}

fn list(memory: &mut MemoryClient, output: &Output) -> Result<ExitCode, Failure> {
    let documents = memory.documents(DocumentKind::TaskKnowledge)?;
    let document = ListDocument { documents };
    output.answer(&document, || list_text(&document.documents));
    Ok(ExitCode::SUCCESS)
}

fn list_text(documents: &[DocumentReport]) -> String {
    if documents.is_empty() {
        return "nothing is stored; store something with: tabula knowledge put NAME FILE".into();
    }
    let row = |report: &DocumentReport| {
        vec![
            report.document.name.clone(),
            report.media_type.clone(),
            report.bytes.to_string(),
            report.author.clone(),
            utc(report.decided_ns),
        ]
    };
    let rows: Vec<_> = documents.iter().map(row).collect();
    format_table(&["name", "type", "bytes", "by", "when"], &rows)
}

#[derive(Serialize)]
struct GetDocument<'a> {
    name: &'a str,
    media_type: String,
    /// Content as text; `None` if it is not UTF-8.
    text: Option<String>,
    bytes: usize,
}

fn get(memory: &mut MemoryClient, name: &str, output: &Output) -> Result<ExitCode, Failure> {
    let document = document(name);
    let stored = memory.document(&document);
    let stored = stored.map_err(|failure| with_stored_names(memory, &document, failure));
    let StoredDocument { report, content } = stored?;
    if output.is_json() {
        let document = GetDocument {
            name,
            media_type: report.media_type,
            bytes: content.len(),
            text: String::from_utf8(content).ok(),
        };
        output.answer(&document, String::new);
        return Ok(ExitCode::SUCCESS);
    }
    // Raw bytes without a final line feed, since the content may be binary.
    output.print_bytes(&content);
    Ok(ExitCode::SUCCESS)
}

fn put(
    memory: &mut MemoryClient,
    arguments: &PutArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let name = &arguments.name;
    let content = read(arguments)?;
    let new = NewDocument {
        document: &document(name),
        media_type: &arguments.media_type,
        content: &content,
    };
    let report = memory.put_document(new, arguments.author.as_deref())?;
    output.answer(&report, || {
        format!("stored {name:?}, history {}, on disk", report.sequence)
    });
    Ok(ExitCode::SUCCESS)
}

fn read(arguments: &PutArguments) -> Result<Vec<u8>, Failure> {
    let mut content = Vec::new();
    let from = match &arguments.file {
        Some(file) => file.display().to_string(),
        None => "standard input".to_owned(),
    };
    let result = match &arguments.file {
        Some(file) => std::fs::File::open(file)
            .and_then(|file| file.take(MAX_DOCUMENT_BYTES + 1).read_to_end(&mut content)),
        None => std::io::stdin()
            .lock()
            .take(MAX_DOCUMENT_BYTES + 1)
            .read_to_end(&mut content),
    };
    result.map_err(|error| Failure::general(format!("{from} could not be read: {error}")))?;
    if content.len() as u64 > MAX_DOCUMENT_BYTES {
        let sentence =
            format!("{from} is too long: store at most {MAX_DOCUMENT_BYTES} bytes under a name");
        return Err(Failure::new(exit_code::REFUSED, sentence));
    }
    Ok(content)
}
