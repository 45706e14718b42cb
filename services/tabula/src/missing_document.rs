//! Failure about a document that is not stored, with the names of those that are.

use control_client::MemoryClient;
use control_protocol::{DocumentKind, DocumentName};
use service::{Failure, probable_name};

/// Most names in a sentence.
const N_NAMED_MAX: usize = 8;

/// Failure of a request about a document. If it is not stored, the failure says so with the names of
/// its kind; any other stays as it is.
pub(crate) fn with_stored_names(
    memory: &mut MemoryClient,
    document: &DocumentName,
    failure: Failure,
) -> Failure {
    if !failure.is_missing {
        return failure;
    }
    // Where the names cannot be read, the reason of the refusal has to do.
    let Ok(stored) = memory.documents(document.kind) else {
        return failure;
    };
    let names: Vec<&str> = stored
        .iter()
        .map(|report| report.document.name.as_str())
        .collect();
    if names.contains(&document.name.as_str()) {
        return failure;
    }
    Failure::new(failure.code, sentence(document, &names))
}

/// Sentence about a document that is not among the stored ones of its kind.
fn sentence(document: &DocumentName, stored: &[&str]) -> String {
    let (what, many, list, first) = match document.kind {
        DocumentKind::ObjectModel => (
            "model",
            "models",
            "tabula model list",
            "tabula model build TRACK",
        ),
        _ => (
            "document",
            "documents",
            "tabula knowledge list",
            "tabula knowledge put NAME FILE",
        ),
    };
    let missing = format!("there is no {what} {:?}", document.name);
    if stored.is_empty() {
        return format!("{missing}, since none is stored yet; store one with: {first}");
    }
    let probable = probable_name(&document.name, stored.iter().copied());
    let meant = probable.map_or_else(String::new, |name| format!("; {name:?} may be meant"));
    let n_more = stored.len().saturating_sub(N_NAMED_MAX);
    let mut named: Vec<String> = stored
        .iter()
        .take(N_NAMED_MAX)
        .map(|name| format!("{name:?}"))
        .collect();
    if n_more > 0 {
        named.push(format!("{n_more} more"));
    }
    format!(
        "{missing}{meant}; the {many} are {}; see `{list}`",
        named.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_document_is_told_with_the_list_of_its_kind_and_the_name_that_is_probably_meant() {
        let told = |kind, name: &str, stored: &[&str]| {
            let name = name.to_owned();
            sentence(&DocumentName { kind, name }, stored)
        };
        let (model, knowledge) = (DocumentKind::ObjectModel, DocumentKind::TaskKnowledge);
        assert_eq!(
            told(model, "teapt", &["mug", "teapot"]),
            "there is no model \"teapt\"; \"teapot\" may be meant; the models are \"mug\", \
             \"teapot\"; see `tabula model list`"
        );
        assert_eq!(
            told(knowledge, "x", &["where-cups-go"]),
            "there is no document \"x\"; the documents are \"where-cups-go\"; see `tabula \
             knowledge list`"
        );
        assert_eq!(
            told(model, "mug", &[]),
            "there is no model \"mug\", since none is stored yet; store one with: tabula model \
             build TRACK"
        );
        let many: Vec<String> = (0..20).map(|i| format!("model-{i}")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        assert!(told(model, "x", &many).contains("\"model-7\", 12 more; see"));
    }
}
