//! `tabula knowledge`: named documents for tasks, stored in the memory.

use crate::arguments::{KnowledgeVerb, PutArguments};
use crate::time::utc;
use command_line::{Output, format_table};
use control_client::{MemoryClient, author_or_user, mutation_id, unexpected_reply};
use message::control::{
    Command, DocumentKind, DocumentName, DocumentReport, LearningReport, MemoryAnswer, MemoryQuery,
    Reply, Revision, RevisionChange,
};
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code};
use std::io::{Read, Write};
use std::process::ExitCode;

/// Maximum size of a document, bytes: the part of a message that one request leaves for it.
const MAX_BYTES: u64 = 384 * 1024;

/// Runs a subcommand of `tabula knowledge`.
pub(crate) fn run(
    common: &CommonArguments,
    verb: &KnowledgeVerb,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let mut memory = MemoryClient::open(common, output)?;
    match verb {
        KnowledgeVerb::List => list(&mut memory, output),
        KnowledgeVerb::Get { name } => get(&mut memory, name, output),
        KnowledgeVerb::Put(arguments) => put(&mut memory, arguments, output),
        KnowledgeVerb::Remove { name, author } => {
            let change = RevisionChange::RemoveDocument {
                document: document(name),
            };
            let report = revise(&mut memory, author.as_deref(), change)?;
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

fn revise(
    memory: &mut MemoryClient,
    author: Option<&str>,
    change: RevisionChange,
) -> Result<LearningReport, Failure> {
    let revision = Revision {
        id: mutation_id()?,
        author: author_or_user(author),
        change,
    };
    match memory.change(&Command::Revise(revision))? {
        Reply::Learned(report) => Ok(report),
        other => Err(unexpected_reply(&other)),
    }
}

#[derive(Serialize)]
struct ListDocument {
    documents: Vec<DocumentReport>,
}

fn list(memory: &mut MemoryClient, output: &Output) -> Result<ExitCode, Failure> {
    let mut documents = match memory.call(Command::Memory(MemoryQuery::Documents))? {
        Reply::Memory(MemoryAnswer::Documents(documents)) => documents,
        other => return Err(unexpected_reply(&other)),
    };
    documents.retain(|report| report.document.kind == DocumentKind::TaskKnowledge);
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
    let query = MemoryQuery::Document(document(name));
    let (media_type, content) = match memory.call(Command::Memory(query))? {
        Reply::Memory(MemoryAnswer::Document {
            media_type,
            content,
        }) => (media_type, content),
        other => return Err(unexpected_reply(&other)),
    };
    if output.is_json() {
        let document = GetDocument {
            name,
            media_type,
            bytes: content.len(),
            text: String::from_utf8(content).ok(),
        };
        output.answer(&document, String::new);
        return Ok(ExitCode::SUCCESS);
    }
    // Raw bytes without a final line feed, since the content may be binary. A closed pipe is no
    // failure.
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(&content).and_then(|()| out.flush());
    Ok(ExitCode::SUCCESS)
}

fn put(
    memory: &mut MemoryClient,
    arguments: &PutArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let name = &arguments.name;
    let content = read(arguments)?;
    let change = RevisionChange::PutDocument {
        document: document(name),
        media_type: arguments.media_type.clone(),
        content,
    };
    let report = revise(memory, arguments.author.as_deref(), change)?;
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
            .and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut content)),
        None => std::io::stdin()
            .lock()
            .take(MAX_BYTES + 1)
            .read_to_end(&mut content),
    };
    result.map_err(|error| Failure::general(format!("{from} could not be read: {error}")))?;
    if content.len() as u64 > MAX_BYTES {
        let sentence = format!("{from} is too long: store at most {MAX_BYTES} bytes under a name");
        return Err(Failure::new(exit_code::REFUSED, sentence));
    }
    Ok(content)
}
