//! `tabula model`: full models of objects, stored in the memory.

mod show;

use crate::arguments::{CliArguments, ModelVerb};
use crate::lab_program::become_modeller;
use crate::missing_document::with_stored_names;
use crate::time::utc;
use command_line::{Output, format_table};
use control_client::{MemoryClient, StoredDocument};
use control_protocol::{DocumentKind, DocumentName, DocumentReport};
use file_access::{OutputFile, check_output};
use object_model::ObjectModel;
use serde::Serialize;
use service::Failure;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Runs a subcommand of `tabula model`.
pub(crate) fn run(
    arguments: &CliArguments,
    verb: &ModelVerb,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let open = || MemoryClient::open(&arguments.common);
    match verb {
        ModelVerb::Build(words) => become_modeller(arguments, ("build", words)),
        ModelVerb::List => list(&mut open()?, output),
        ModelVerb::Show { name } => show::show(&mut open()?, name, output),
        ModelVerb::Export { name, out } => {
            let file = out.clone().unwrap_or_else(|| default_file(name));
            check_output(&file).map_err(Failure::usage)?;
            export(&mut open()?, name, &file, output)
        }
        ModelVerb::Forget { name, author } => forget(&mut open()?, name, author.as_deref(), output),
    }
}

fn document(name: &str) -> DocumentName {
    DocumentName {
        kind: DocumentKind::ObjectModel,
        name: name.to_owned(),
    }
}

/// Reads a model, with the metadata of its document.
fn read(memory: &mut MemoryClient, name: &str) -> Result<(ObjectModel, DocumentReport), Failure> {
    let document = document(name);
    let stored = memory.document(&document);
    let stored = stored.map_err(|failure| with_stored_names(memory, &document, failure));
    let StoredDocument { report, content } = stored?;
    let model = ObjectModel::from_bytes(&content).map_err(|error| {
        let sentence = format!("the model {name:?} cannot be read: {error}");
        Failure::general(sentence)
    })?;
    Ok((model, report))
}

#[derive(Serialize)]
struct ListDocument {
    models: Vec<DocumentReport>,
}

fn list(memory: &mut MemoryClient, output: &Output) -> Result<ExitCode, Failure> {
    let models = memory.documents(DocumentKind::ObjectModel)?;
    let document = ListDocument { models };
    output.answer(&document, || list_text(&document.models));
    Ok(ExitCode::SUCCESS)
}

fn list_text(models: &[DocumentReport]) -> String {
    if models.is_empty() {
        return "no model is stored yet; build one with: tabula model build TRACK".into();
    }
    let row = |report: &DocumentReport| {
        vec![
            report.document.name.clone(),
            report.bytes.to_string(),
            report.author.clone(),
            utc(report.decided_ns),
        ]
    };
    let rows: Vec<_> = models.iter().map(row).collect();
    format_table(&["name", "bytes", "by", "when"], &rows)
}

/// File for a model in the present folder. A name may hold what separates folders.
fn default_file(name: &str) -> PathBuf {
    PathBuf::from(format!("{}.ply", name.replace(['/', '\0'], "-")))
}

#[derive(Serialize)]
struct ExportDocument<'a> {
    file: &'a Path,
    bytes: usize,
    n_vertices: usize,
    n_triangles: usize,
    sequence: u64,
}

fn export(
    memory: &mut MemoryClient,
    name: &str,
    file: &Path,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let (model, report) = read(memory, name)?;
    let ply = model.to_ply().map_err(Failure::general)?;
    let mut partial = OutputFile::create_private(file).map_err(Failure::general)?;
    let written = partial.write_all(&ply);
    written.map_err(|error| {
        let sentence = format!("{} could not be written: {error}", file.display());
        Failure::general(sentence)
    })?;
    partial.finish().map_err(Failure::general)?;
    let document = ExportDocument {
        file,
        bytes: ply.len(),
        n_vertices: model.mesh.vertices.len(),
        n_triangles: model.mesh.triangles.len(),
        sequence: report.sequence,
    };
    output.answer(&document, || {
        format!(
            "exported {name:?} to {}: {} vertices, {} triangles, {} bytes, as of history entry {}",
            file.display(),
            document.n_vertices,
            document.n_triangles,
            document.bytes,
            document.sequence
        )
    });
    Ok(ExitCode::SUCCESS)
}

fn forget(
    memory: &mut MemoryClient,
    name: &str,
    author: Option<&str>,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let document = document(name);
    let removed = memory.remove_document(&document, author);
    let removed = removed.map_err(|failure| with_stored_names(memory, &document, failure));
    let report = removed?;
    output.answer(&report, || {
        let sequence = report.sequence;
        format!(
            "forgot the model {name:?}, history {sequence}, on disk; to undo this: tabula undo \
             {sequence}"
        )
    });
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_list_says_how_to_build_a_model() {
        assert!(list_text(&[]).ends_with("build one with: tabula model build TRACK"));
    }

    #[test]
    fn default_file_is_in_the_present_folder() {
        for (name, file) in [
            ("blue mug", "blue mug.ply"),
            ("../../etc/mug", "..-..-etc-mug.ply"),
            ("..", "...ply"),
        ] {
            let found = default_file(name);
            assert_eq!(found, Path::new(file));
            assert_eq!(found.components().count(), 1);
        }
    }
}
