//! Reader for databases of schema 1, for migration.
//!
//! Schema 1 stored descriptors and point clouds under view ids, had labels instead of label
//! registers, and did not hash-chain its history.

use durable_leveldb::{MutationId, RawDatabase, record::unseal_any};
use learning::{CategoryName, ViewId};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_bytes::{ByteArray, ByteBuf};

use crate::digest::Digest;
use crate::history::HistoryEntry;
use crate::keys;
use crate::label_status::{DecisionStamp, LabelStatus, LwwRegister};
use crate::model::{DataLoss, Effect, Operation, Target};
use crate::recovered_records::{RecordedTotals, RecoveredRecords};
use crate::view::Origin;
use crate::view_record::{Box10, ContentRef, ViewMetadata};

const SCHEMA: u8 = 1;
/// Key prefixes of tables whose meaning or key format changed.
const LABEL: u8 = b'l';
const POINTS: u8 = b'p';

#[derive(Deserialize)]
struct Meta1 {
    store_id: ByteArray<16>,
    next_track_id: u64,
    sequence: u64,
    n_views: u64,
}

#[derive(Deserialize)]
struct Facts1 {
    box_in_world: Box10,
    captured_ns: u64,
    frame_sequence: u64,
    source: String,
    points: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
struct Descriptor1 {
    kind: String,
    values: ByteBuf,
}

#[derive(Deserialize)]
struct Label1 {
    category: Option<CategoryName>,
    author: String,
    wall_ns: u64,
    sequence: u64,
}

#[derive(Deserialize)]
enum Operation1 {
    StoreViews,
    Teach,
    Correct,
    Forget,
    Rebuild,
}

#[derive(Deserialize)]
struct Entry1 {
    wall_ns: u64,
    author: String,
    operation: Operation1,
    mutation: Option<ByteArray<16>>,
    stored: Vec<ViewId>,
    names: Vec<CategoryName>,
    /// Label changes: track-id, view id, index of the name before, index of the name after.
    changes: Vec<(u64, u32, Option<u32>, Option<u32>)>,
}

/// Reads the intact records of a schema-1 database into `recovered`; returns the totals
/// that its metadata record states.
pub(crate) fn read_records(
    raw: &RawDatabase,
    recovered: &mut RecoveredRecords,
) -> Option<RecordedTotals> {
    let meta: Option<Meta1> = unseal_1(&[keys::META], raw.get(&[keys::META]));
    let memory_id = meta
        .as_ref()
        .map_or(0, |meta| u128::from_be_bytes(meta.store_id.into_array()));
    for (key, record) in raw.table(keys::VIEW) {
        if let Some(view) = keys::view_of(key) {
            read_view(raw, recovered, view, unseal_1(key, Some(record)), memory_id);
        }
    }
    for (key, record) in raw.table(LABEL) {
        if let (Some(view), Some(label)) = (keys::view_of(key), unseal_1(key, Some(record))) {
            recovered.registers.insert(view, register(label));
        }
    }
    for (key, record) in raw.table(keys::HISTORY) {
        if let (Some(sequence), Some(entry)) = (keys::sequence_of(key), unseal_1(key, Some(record)))
        {
            let entry = converted(sequence, entry, recovered);
            recovered.history.insert(sequence, entry);
        }
    }
    meta.map(|meta| RecordedTotals {
        memory_id: Some(memory_id),
        next_track_id: meta.next_track_id,
        sequence: meta.sequence,
        n_views: meta.n_views,
    })
}

fn unseal_1<T: DeserializeOwned>(key: &[u8], record: Option<Vec<u8>>) -> Option<T> {
    match unseal_any(key, &record?) {
        Ok((SCHEMA, value)) => Some(value),
        _ => None,
    }
}

/// Converts a view with an intact descriptor, and its point cloud if that is intact.
fn read_view(
    raw: &RawDatabase,
    recovered: &mut RecoveredRecords,
    view: ViewId,
    metadata: Option<Facts1>,
    memory_id: u128,
) -> Option<()> {
    let metadata = metadata?;
    let key = keys::view_key(keys::DESCRIPTOR, view);
    let descriptor: Descriptor1 = unseal_1(&key, raw.get(&key))?;
    let key = keys::view_key(POINTS, view);
    let points: Option<ByteBuf> = unseal_1(&key, raw.get(&key));
    let lost = ContentRef {
        digest: Digest::default(),
        n_bytes: 0,
    };
    let points_extent = points.as_ref().map(|points| ContentRef::of(points));
    let converted = ViewMetadata::from_parts(
        metadata.box_in_world,
        (
            metadata.captured_ns,
            metadata.frame_sequence,
            metadata.source,
        ),
        Origin { memory_id, view },
        (descriptor.kind, ContentRef::of(&descriptor.values)),
        // A damaged point cloud is found to be missing later.
        metadata.points.map(|_| points_extent.unwrap_or(lost)),
    );
    let identity = converted.identity();
    let descriptor = descriptor.values.into_vec();
    recovered
        .converted
        .insert(converted.descriptor.digest, descriptor);
    if let (Some(extent), Some(points)) = (points_extent, points) {
        recovered.converted.insert(extent.digest, points.into_vec());
    }
    recovered.views.insert(view, identity);
    recovered.metadata.insert(identity, converted);
    Some(())
}

fn register(label: Label1) -> LwwRegister {
    LwwRegister {
        standing: LabelStatus::of(label.category),
        decided: DecisionStamp {
            author: label.author.into(),
            stamp_ns: label.wall_ns,
        },
        sequence: label.sequence,
    }
}

fn converted(sequence: u64, entry: Entry1, recovered: &RecoveredRecords) -> HistoryEntry {
    let name = |index: Option<u32>| index.and_then(|i| entry.names.get(i as usize).cloned());
    let stored = entry.stored.iter().map(|&view| Effect::Stored {
        view,
        // Unknown for a lost view, which is then purged.
        identity: recovered.views.get(&view).copied().unwrap_or_default(),
    });
    let changed = entry
        .changes
        .iter()
        .map(|&(track, view, before, after)| Effect::Changed {
            view: ViewId::from((track, view)),
            before: LabelStatus::of(name(before)),
            after: LabelStatus::of(name(after)),
            decided: None,
        });
    let first = entry.changes.first().copied();
    let track_id = first.map_or(0, |(track_id, ..)| track_id);
    let before = first.and_then(|(_, _, before, _)| name(before));
    let after = first.and_then(|(_, _, _, after)| name(after));
    let operation = match (&entry.operation, before, after) {
        (Operation1::Teach, _, Some(category)) => Operation::Teach { track_id, category },
        (Operation1::Correct, _, Some(category)) => Operation::Correct {
            target: Target::Track(track_id),
            category,
        },
        (Operation1::Forget, Some(category), _) => Operation::Forget {
            target: Target::Category(category),
        },
        (Operation1::Rebuild, ..) => Operation::Rebuild {
            loss: DataLoss::default(),
            lost: Vec::new(),
        },
        _ => Operation::StoreViews,
    };
    let effects = stored.chain(changed).collect();
    HistoryEntry {
        sequence,
        previous: Digest::default(),
        wall_ns: entry.wall_ns,
        author: entry.author.into(),
        uid: None,
        operation,
        mutation: entry
            .mutation
            .map(|id| MutationId(u128::from_be_bytes(id.into_array()))),
        effects,
        contradiction: None,
    }
}
