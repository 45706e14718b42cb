//! Golden bytes of all records of the database: a stored name never changes by a renamed type.

use std::path::{Path, PathBuf};

use durable_leveldb::record;
use learning::{CategoryName, ViewId};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_bytes::ByteArray;
use test_data::golden;

use super::fuzz_records::{SEQUENCE, entry};
use crate::archive::ArchiveRecord;
use crate::digest::Digest;
use crate::document::{DocumentContent, DocumentVersion, MemoryDocument};
use crate::document_key::{DocumentKey, DocumentKind};
use crate::exchange::{ForeignDocument, ForeignView};
use crate::history::HistoryEntry;
use crate::index_row::IndexedView;
use crate::keys;
use crate::label_status::{DecisionStamp, LabelStatus, LwwRegister};
use crate::meta::Meta;
use crate::model::{Contradiction, DataLoss, Effect, ImportPart, Operation, Target};
use crate::portable::{PortableBatch, PortableReader, PortableWriter};
use crate::size_record::SizeRecord;
use crate::tombstone::{seal_tombstone, unseal_tombstone};
use crate::view::{CapturedView, Origin, StoredDescriptor};
use crate::view_record::ViewParts;

const VIEW: ViewId = ViewId {
    track_id: 3,
    view_id: 1,
};

fn file(kind: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    folder.join(format!("{kind}.txt"))
}

/// Pins records of one type under a key.
fn check_records<T>(kind: &str, key: &[u8], examples: &[(&str, T)])
where
    T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug,
{
    let encode = |value: &T| record::seal(key, value);
    golden::check(&file(kind), examples, encode, |bytes| {
        record::unseal(key, bytes).unwrap()
    });
}

fn category(name: &str) -> CategoryName {
    CategoryName::new(name).unwrap()
}

fn document(kind: DocumentKind) -> DocumentKey {
    let name = "mug".into();
    DocumentKey { kind, name }
}

fn decided() -> DecisionStamp {
    DecisionStamp {
        author: "bert".into(),
        stamp_ns: 6,
    }
}

fn content() -> DocumentContent {
    DocumentContent {
        digest: Digest::of(b"content"),
        n_bytes: 7,
        media_type: "model/ply".to_owned(),
    }
}

/// Operations on labels.
fn label_operations() -> Vec<(&'static str, Operation)> {
    let (from, to) = (category("cup"), category("mug"));
    let (view, track) = (Target::View(VIEW), Target::Track(3));
    let whole = Target::Category(from.clone());
    let correct = |target| Operation::Correct {
        target,
        category: category("mug"),
    };
    let forget = |target| Operation::Forget { target };
    let teach = Operation::Teach {
        track_id: 3,
        category: to.clone(),
    };
    let rename = Operation::Rename {
        from: from.clone(),
        to: to.clone(),
    };
    let merge = Operation::MergeCategories {
        from: from.clone(),
        into: to.clone(),
    };
    let names = vec![(from.clone(), to)];
    vec![
        ("teach", teach),
        ("correct view", correct(view.clone())),
        ("correct track", correct(track.clone())),
        ("correct category", correct(whole.clone())),
        ("forget view", forget(view)),
        ("forget track", forget(track)),
        ("forget category", forget(whole)),
        ("rename", rename),
        ("merge", merge),
        ("normalise names", Operation::NormaliseNames { names }),
        (
            "limit of a category",
            Operation::EnforceLimit {
                category: Some(from),
            },
        ),
    ]
}

/// Operations on the history, on documents and on the store.
fn other_operations() -> Vec<(&'static str, Operation)> {
    let undo = |redone| Operation::Undo {
        sequence: 4,
        redone,
    };
    let import = |first, is_continued| Operation::Import {
        source: "robot".to_owned(),
        part: ImportPart {
            first,
            is_continued,
        },
    };
    let put = Operation::PutDocument {
        document: document(DocumentKind::ObjectModel),
    };
    let remove = Operation::RemoveDocument {
        document: document(DocumentKind::TaskKnowledge),
    };
    let loss = DataLoss {
        n_history: 1,
        n_views: 2,
        n_clouds: 3,
        n_documents: 4,
    };
    let lost = vec![(2, 3)];
    vec![
        ("store views", Operation::StoreViews),
        ("undo", undo(None)),
        ("redo", undo(Some(3))),
        ("import", import(None, false)),
        ("import part", import(Some(2), true)),
        ("put object model", put),
        ("remove task knowledge", remove),
        ("purge", Operation::Purge),
        (
            "limit of unlabelled views",
            Operation::EnforceLimit { category: None },
        ),
        ("rebuild", Operation::Rebuild { loss, lost }),
        ("migrate", Operation::Migrate { schema: 1 }),
    ]
}

fn effects() -> Vec<Effect> {
    let identity = Digest::of(b"view");
    vec![
        Effect::Stored {
            view: VIEW,
            identity,
        },
        Effect::Changed {
            view: VIEW,
            before: LabelStatus::Unnamed,
            after: LabelStatus::Named(category("mug")),
            decided: None,
        },
        Effect::Changed {
            view: VIEW,
            before: LabelStatus::Named(category("mug")),
            after: LabelStatus::Forgotten,
            decided: Some(decided()),
        },
        Effect::Purged { view: VIEW },
        Effect::Tombstone {
            identity,
            decided: Some(decided()),
        },
        Effect::Tombstone {
            identity,
            decided: None,
        },
        Effect::Document {
            document: document(DocumentKind::ObjectModel),
            before: None,
            after: Some(content()),
            decided: Some(decided()),
        },
        Effect::VersionPurged {
            document: document(DocumentKind::TaskKnowledge),
            sequence: 5,
        },
    ]
}

#[test]
fn golden_history_entries_are_written_and_read() {
    let mut examples: Vec<_> = label_operations()
        .into_iter()
        .chain(other_operations())
        .map(|(name, operation)| (name, entry(operation)))
        .collect();
    let all_effects = HistoryEntry {
        effects: effects(),
        contradiction: Some(Contradiction {
            present: category("cup"),
            decided: decided(),
        }),
        ..entry(Operation::StoreViews)
    };
    let by_the_store = HistoryEntry {
        uid: None,
        mutation: None,
        ..entry(Operation::Purge)
    };
    examples.extend([("effects", all_effects), ("by the store", by_the_store)]);
    golden::check(
        &file("history-entry"),
        &examples,
        |entry| entry.seal().0,
        |bytes| HistoryEntry::unseal(SEQUENCE, bytes).unwrap().0,
    );
}

fn captured_view() -> CapturedView {
    CapturedView {
        id: VIEW,
        descriptor: StoredDescriptor {
            kind: "good".to_owned(),
            values: vec![0.25, -1.0],
        },
        box_in_world: geometry::OrientedBox {
            frame_from_box: nalgebra::Isometry3::translation(1.0, 2.0, 3.0),
            half_sides_m: nalgebra::Vector3::new(0.1, 0.2, 0.3),
        },
        captured_ns: 12,
        frame_sequence: 13,
        source: "camera".to_owned(),
        mean_rgb: Some([1, 2, 3]),
        points: Some(vec![4; 16]),
    }
}

fn view() -> (ViewParts, Origin) {
    let origin = Origin {
        memory_id: 11,
        view: VIEW,
    };
    (ViewParts::of(&captured_view(), origin), origin)
}

#[test]
fn golden_records_of_views_are_written_and_read() {
    let (parts, _) = view();
    let metadata = parts.metadata;
    let without = {
        let mut bare = metadata.clone();
        (bare.mean_rgb, bare.points) = (None, None);
        bare
    };
    let key = keys::view_key(keys::VIEW, VIEW);
    check_records(
        "view",
        &key,
        &[("view", metadata.clone()), ("without points", without)],
    );
    let register = |standing| LwwRegister {
        standing,
        decided: decided(),
        sequence: SEQUENCE,
    };
    let row = |standing| IndexedView::of(&metadata, register(standing));
    let examples = [
        ("unlabelled", row(LabelStatus::Unnamed)),
        ("labelled", row(LabelStatus::Named(category("mug")))),
        ("forgotten", row(LabelStatus::Forgotten)),
    ];
    let key = keys::view_key(keys::ROW, VIEW);
    golden::check(
        &file("index-row"),
        &examples,
        |row| row.seal(VIEW),
        |bytes| IndexedView::unseal(&key, bytes).unwrap(),
    );
    let identity = Digest::of(b"view");
    let key = keys::digest_key(keys::TOMBSTONE, identity);
    golden::check(
        &file("tombstone"),
        &[("tombstone", 6)],
        |forgotten_ns| seal_tombstone(identity, *forgotten_ns),
        |bytes| unseal_tombstone(&key, bytes).unwrap(),
    );
}

#[test]
fn golden_records_of_the_store_are_written_and_read() {
    let meta = Meta {
        store_id: ByteArray::new([1; 16]),
        sequence: 5,
        head: Digest::of(b"head"),
        n_views: 6,
        records: Digest::of(b"records"),
        ..Meta::new(Some(2), 4).unwrap()
    };
    check_records("meta", &[keys::META], &[("meta", meta)]);
    let mut sizes = SizeRecord::default();
    sizes.add(7, 800);
    check_records("sizes", &[keys::SIZES], &[("sizes", sizes)]);
    let archive = ArchiveRecord {
        sequence: 8,
        head: Digest::of(b"head"),
        dropped: 2,
        n_bytes: 900,
        lost: vec![(3, 4)],
    };
    check_records("archive", &[keys::ARCHIVE], &[("archive", archive)]);
    let version = |content| DocumentVersion {
        content,
        decided: decided(),
    };
    let key = keys::document_key(&document(DocumentKind::ObjectModel), SEQUENCE);
    let examples = [
        ("stored", version(Some(content()))),
        ("removed", version(None)),
    ];
    check_records("document-version", &key, &examples);
}

/// Contents of export files: a view, labelled or not, a forgotten view, and documents.
fn exported() -> Vec<(&'static str, PortableBatch)> {
    let (_, origin) = view();
    let batch = |views, documents| PortableBatch { views, documents };
    let present = |standing, decided| ForeignView::Present {
        view: Box::new(captured_view()),
        origin,
        standing,
        decided,
    };
    let forgotten = ForeignView::Forgotten {
        identity: Digest::of(b"view"),
        decided: decided(),
    };
    let key = document(DocumentKind::ObjectModel);
    let foreign_document = |document| ForeignDocument {
        key: key.clone(),
        document,
        decided: decided(),
    };
    let content = MemoryDocument {
        key: key.clone(),
        media_type: "model/ply".to_owned(),
        content: b"ply".to_vec(),
    };
    let labelled = present(LabelStatus::Named(category("mug")), Some(decided()));
    let unlabelled = present(LabelStatus::Unnamed, None);
    vec![
        ("labelled view", batch(vec![labelled], vec![])),
        ("unlabelled view", batch(vec![unlabelled], vec![])),
        ("forgotten view", batch(vec![forgotten], vec![])),
        (
            "document",
            batch(vec![], vec![foreign_document(Some(content))]),
        ),
        (
            "removed document",
            batch(vec![], vec![foreign_document(None)]),
        ),
        ("nothing", PortableBatch::default()),
    ]
}

#[test]
fn golden_export_files_are_written_and_read() {
    let write = |batch: &PortableBatch| {
        let mut bytes = Vec::new();
        let mut writer = PortableWriter::new(&mut bytes).unwrap();
        for view in &batch.views {
            writer.view(view).unwrap();
        }
        for document in &batch.documents {
            writer.document(document).unwrap();
        }
        writer.end().unwrap();
        bytes
    };
    let read = |bytes: &[u8]| {
        let batch = PortableReader::new(bytes).unwrap().batch().unwrap();
        batch.unwrap_or_default()
    };
    golden::check(&file("export"), &exported(), write, read);
}
