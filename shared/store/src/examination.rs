//! Reads the whole index of a database just opened, and checks it against itself.

use learning::{CategoryName, ViewId};

use crate::catalogue::{Catalogue, Entry};
use crate::engine::{Engine, Reader};
use crate::error::{Error, in_words};
use crate::history::PackedEntry;
use crate::keys;
use crate::meta::{Meta, SCHEMA};
use crate::record::unseal;
use crate::view::{Facts, PackedLabel};
use crate::watermark::Mark;

/// What a database holds, and what is wrong with it.
#[derive(Debug, Default)]
pub(crate) struct Examination {
    /// Missing in a database that was just created.
    pub(crate) meta: Option<Meta>,
    pub(crate) catalogue: Catalogue,
    /// Number of history entries read.
    pub(crate) n_history: u64,
    /// What is wrong, in words; empty when all is as it was written.
    pub(crate) findings: Vec<String>,
}

impl Examination {
    /// Whether nothing was ever committed.
    pub(crate) fn is_empty(&self) -> bool {
        self.meta.is_none()
            && self.n_history == 0
            && self.catalogue.n_views() == 0
            && self.findings.is_empty()
    }
}

/// The name in a label's record, when it is one.
pub(crate) fn category_of(label: &PackedLabel) -> Result<Option<CategoryName>, &'static str> {
    match &label.category {
        Some(name) => CategoryName::new(name)
            .map(Some)
            .map_err(|_| "its name is none"),
        None => Ok(None),
    }
}

/// Reads everything but descriptors and clouds.
///
/// # Errors
///
/// [`Error::NewerSchema`]; others only when the database cannot be read at all:
/// damage is among the findings.
pub(crate) fn examine(engine: &mut Engine, mark: Option<&Mark>) -> Result<Examination, Error> {
    let mut reader = engine.reader()?;
    let mut found = Examination::default();
    read_meta(&mut reader, &mut found)?;
    read_views(&mut reader, &mut found)?;
    read_labels(&mut reader, &mut found)?;
    check_category_index(&mut reader, &mut found)?;
    read_history(&mut reader, &mut found)?;
    read_answers(&mut reader, &mut found)?;
    check_counts(&mut found, mark);
    let (n_damages, damages) = engine.damages();
    found.findings.extend(damages);
    if n_damages as usize > found.findings.len() {
        found
            .findings
            .push(format!("{n_damages} damaged places in all"));
    }
    Ok(found)
}

fn read_meta(reader: &mut Reader, found: &mut Examination) -> Result<(), Error> {
    let Some(record) = reader.get(&[keys::META])? else {
        return Ok(());
    };
    match unseal::<Meta>(&[keys::META], &record) {
        Ok(meta) if meta.schema > SCHEMA => Err(Error::NewerSchema {
            found: meta.schema,
            known: SCHEMA,
        }),
        Ok(meta) => {
            found.meta = Some(meta);
            Ok(())
        }
        Err(wrong) => {
            found
                .findings
                .push(format!("the record about the store: {wrong}"));
            Ok(())
        }
    }
}

fn read_views(reader: &mut Reader, found: &mut Examination) -> Result<(), Error> {
    reader.scan_prefix(&[keys::VIEW], |key, record| {
        match (keys::view_of(key), unseal::<Facts>(key, record)) {
            (Some(view), Ok(facts)) => {
                found.catalogue.insert(view, Entry::of(record, &facts));
            }
            (Some(view), Err(wrong)) => found.findings.push(format!("{}: {wrong}", in_words(view))),
            (None, _) => found
                .findings
                .push(format!("a view's key is none: {key:?}")),
        }
    })
}

fn read_labels(reader: &mut Reader, found: &mut Examination) -> Result<(), Error> {
    reader.scan_prefix(&[keys::LABEL], |key, record| {
        let label = unseal::<PackedLabel>(key, record)
            .and_then(|label| Ok((category_of(&label)?, label.wall_ns)));
        match (keys::view_of(key), label) {
            (Some(view), Ok(_)) if found.catalogue.get(view).is_none() => {
                found.findings.push(format!(
                    "{} is missing, though it has a label",
                    in_words(view)
                ));
            }
            (Some(view), Ok((category, wall_ns))) => {
                found
                    .catalogue
                    .relabel(view, category.map(|name| (name, wall_ns)));
            }
            (Some(view), Err(wrong)) => found
                .findings
                .push(format!("label of {}: {wrong}", in_words(view))),
            (None, _) => found
                .findings
                .push(format!("a label's key is none: {key:?}")),
        }
    })
}

/// The index says the same as the labels, so a label that an older value of it
/// replaced is seen.
fn check_category_index(reader: &mut Reader, found: &mut Examination) -> Result<(), Error> {
    let mut n_indexed = 0;
    reader.scan_prefix(&[keys::CATEGORY_INDEX], |key, record| {
        n_indexed += 1;
        if let Err(wrong) = unseal::<()>(key, record) {
            found
                .findings
                .push(format!("an entry of the category index: {wrong}"));
        } else if !index_entry_is_right(key, &found.catalogue) {
            found
                .findings
                .push("the category index and a label differ".to_owned());
        }
    })?;
    let n_labelled = found.catalogue.n_labelled();
    if n_indexed != n_labelled {
        let finding = format!("{n_labelled} views have a name, {n_indexed} are in the index");
        found.findings.push(finding);
    }
    Ok(())
}

fn index_entry_is_right(key: &[u8], catalogue: &Catalogue) -> bool {
    let Some(view) = key.last_chunk::<12>().and_then(|numbers| {
        let (track_id, view_id) = (numbers.first_chunk()?, numbers.last_chunk()?);
        let (track_id, view_id) = (u64::from_be_bytes(*track_id), u32::from_be_bytes(*view_id));
        Some(ViewId { track_id, view_id })
    }) else {
        return false;
    };
    let label = catalogue.get(view).and_then(|entry| entry.label.as_ref());
    label.is_some_and(|(name, _)| keys::category_key(name, view) == key)
}

fn read_history(reader: &mut Reader, found: &mut Examination) -> Result<(), Error> {
    let mut expected = 1;
    reader.scan_prefix(&[keys::HISTORY], |key, record| {
        let Some(sequence) = keys::sequence_of(key) else {
            found
                .findings
                .push(format!("a history entry's key is none: {key:?}"));
            return;
        };
        if sequence != expected {
            let last = sequence.wrapping_sub(1);
            found
                .findings
                .push(format!("history entries {expected} to {last} are missing"));
        }
        expected = sequence.wrapping_add(1);
        let entry = unseal::<PackedEntry>(key, record)
            .and_then(|entry| entry.unpack(sequence).ok_or("a name in it is none"));
        match entry {
            Ok(_) => found.n_history += 1,
            Err(wrong) => found
                .findings
                .push(format!("history entry {sequence}: {wrong}")),
        }
    })
}

fn read_answers(reader: &mut Reader, found: &mut Examination) -> Result<(), Error> {
    reader.scan_prefix(&[keys::ANSWER], |key, _| match keys::mutation_of(key) {
        Some(id) => {
            found.catalogue.answered.insert(id);
        }
        None => found
            .findings
            .push(format!("an answer's key is none: {key:?}")),
    })
}

/// Compares with what was counted when it was written.
fn check_counts(found: &mut Examination, mark: Option<&Mark>) {
    let n_views = found.catalogue.n_views() as u64;
    let Some(meta) = &found.meta else {
        if found.n_history > 0 || n_views > 0 {
            found
                .findings
                .push("the record about the store is missing".to_owned());
        }
        return;
    };
    if meta.sequence != found.n_history {
        let (n, sequence) = (found.n_history, meta.sequence);
        found
            .findings
            .push(format!("{n} of {sequence} history entries are whole"));
    }
    if meta.n_views != n_views {
        let n = meta.n_views;
        found
            .findings
            .push(format!("{n_views} of {n} views are whole"));
    }
    if let Some(mark) = mark
        && mark.store_id == meta.store_id().0
        && mark.sequence > meta.sequence
    {
        let (first, last) = (meta.sequence + 1, mark.sequence);
        found.findings.push(format!(
            "acknowledged history entries {first} to {last} are missing"
        ));
    }
}
