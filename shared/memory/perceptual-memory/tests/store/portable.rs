//! Export-file tests: round trip, and refusal of damaged files.

use perceptual_memory::{
    DecisionStamp, Digest, DocumentKey, DocumentKind, ForeignDocument, ForeignView, LabelStatus,
    MemoryDocument, Origin, PortableError, PortableReader, PortableWriter,
};

use crate::builders::{NOW_NS, key, name, view};

fn decided() -> DecisionStamp {
    DecisionStamp {
        author: "anna".into(),
        stamp_ns: NOW_NS,
    }
}

fn present(view_id: u32, standing: LabelStatus) -> ForeignView {
    ForeignView::Present {
        view: Box::new(view(7, view_id, view_id)),
        origin: Origin {
            memory_id: 5,
            view: key(7, view_id),
        },
        standing,
        decided: Some(decided()),
    }
}

fn document(content: Option<&[u8]>) -> ForeignDocument {
    let key = DocumentKey {
        kind: DocumentKind::TaskKnowledge,
        name: "where cups go".into(),
    };
    ForeignDocument {
        key: key.clone(),
        document: content.map(|content| MemoryDocument {
            key,
            media_type: "text/plain".to_owned(),
            content: content.to_vec(),
        }),
        decided: decided(),
    }
}

fn written(views: &[ForeignView], documents: &[ForeignDocument]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut writer = PortableWriter::new(&mut file).unwrap();
    for view in views {
        writer.view(view).unwrap();
    }
    for document in documents {
        writer.document(document).unwrap();
    }
    writer.end().unwrap();
    file
}

type Content = (Vec<ForeignView>, Vec<ForeignDocument>);

fn read(file: &[u8]) -> Result<Content, PortableError> {
    let mut reader = PortableReader::new(file)?;
    let (mut views, mut documents) = (Vec::new(), Vec::new());
    while let Some(batch) = reader.batch()? {
        views.extend(batch.views);
        documents.extend(batch.documents);
    }
    assert_eq!(reader.n_bytes_read(), file.len() as u64);
    Ok((views, documents))
}

fn example() -> Content {
    let views = vec![
        present(0, LabelStatus::Named(name("Mug"))),
        present(1, LabelStatus::Unnamed),
        ForeignView::Forgotten {
            identity: Digest(9),
            decided: decided(),
        },
    ];
    (views, vec![document(Some(b"upper shelf")), document(None)])
}

#[test]
fn export_file_round_trip() {
    let (views, documents) = example();
    let file = written(&views, &documents);
    assert_eq!(read(&file).unwrap(), (views, documents));
    assert_eq!(read(&written(&[], &[])).unwrap(), (vec![], vec![]));
}

#[test]
fn export_file_that_is_damaged_is_refused() {
    let (views, documents) = example();
    let file = written(&views, &documents);
    for n_bytes in 0..file.len() {
        assert!(read(&file[..n_bytes]).is_err(), "cut to {n_bytes}");
        let mut damaged = file.clone();
        damaged[n_bytes] ^= 1 << (n_bytes % 8);
        assert!(read(&damaged).is_err(), "byte {n_bytes}");
    }
    assert!(read(&[&file[..], &[0]].concat()).is_err());
    // Each part is whole, but one is missing.
    let fewer = written(&views[1..], &documents);
    let n_missing = file.len() - fewer.len();
    let without_first = [&file[..16], &file[16 + n_missing..]].concat();
    assert!(read(&without_first).is_err());
    assert!(matches!(
        read(b"some other file"),
        Err(PortableError::NotAnExport)
    ));
    assert!(matches!(
        read(b"TABULA MEMORY 2\n"),
        Err(PortableError::Newer)
    ));
}

/// A corrupted export file is refused, however it is corrupted; what is read before that is
/// bounded by its bytes.
#[test]
fn fuzz_export_files() {
    let named = present(0, LabelStatus::Named(name("Mug")));
    let file = written(&[named], &[document(Some(b"upper"))]);
    let empty = written(&[], &[]);
    let whole = [file.clone(), empty.clone()];
    mutation_fuzzing::fuzz(&whole, |bytes| {
        let is_whole = whole.iter().any(|file| file == bytes);
        assert_eq!(read(bytes).is_ok(), is_whole);
    });
}
