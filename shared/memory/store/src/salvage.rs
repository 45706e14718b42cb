//! Makes a new database of what is whole in a damaged or older one, and counts the
//! rest.
//!
//! The whole entries of the history are made again, one after the other, on an
//! empty store. What the lost ones did is taken from what else is whole: one last
//! entry says what was lost, and what had to be taken so.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;

use learning::ViewId;
use serde::{Deserialize, Serialize};

use crate::applying::Target;
use crate::catalogue::Catalogue;
use crate::decision::Contents;
use crate::document::DocumentKey;
use crate::engine::Engine;
use crate::error::Error;
use crate::facts::ViewParts;
use crate::history::{Effect, HistoryEntry, Operation};
use crate::meta::Meta;
use crate::raw_database::RawDatabase;
use crate::remains::Remains;
use crate::standing::Standing;
use crate::watermark::Mark;
use crate::writes::Writes;

/// Bytes gathered before they are written to the copy.
const WRITE_BYTES: usize = 1 << 20;

/// Who rebuilds, in the history.
const AUTHOR: &str = "the store itself";

/// What a rebuilt store no longer has.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Loss {
    /// Acknowledged changes that are not in the history any more.
    pub n_history: u64,
    /// Views of which facts or descriptor are gone.
    pub n_views: u64,
    /// Views that are there without their cloud.
    pub n_clouds: u64,
    /// Versions of documents of which the content is gone.
    pub n_documents: u64,
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            n_history,
            n_views,
            n_clouds,
            n_documents,
        } = self;
        write!(
            f,
            "{n_history} history entries, {n_views} views, {n_clouds} clouds, {n_documents} \
             documents"
        )
    }
}

/// What became of a database.
pub(crate) struct Salvaged {
    pub(crate) loss: Loss,
    /// The older schema it had.
    pub(crate) migrated_from: Option<u32>,
}

/// Makes in the empty `copy` what is whole in the database's folder; it is on disk
/// afterwards. None when nothing is whole.
///
/// # Errors
///
/// [`Error::NewerSchema`]; [`Error::Io`] when the folder cannot be read or the copy
/// cannot be written.
pub(crate) fn salvage(
    damaged: &Path,
    copy: &mut Engine,
    mark: Option<&Mark>,
    wall_ns: u64,
) -> Result<Option<Salvaged>, Error> {
    let raw = RawDatabase::read(damaged)?;
    let Some(remains) = Remains::find(&raw, mark)? else {
        return Ok(None);
    };
    let meta = Meta::new(Some(remains.memory_id), remains.next_track_id)?;
    let mut rebuild = Rebuild {
        remains: &remains,
        raw: &raw,
        copy,
        catalogue: Catalogue::default(),
        meta,
        writes: Writes::default(),
    };
    for entry in remains.history.values() {
        rebuild.make_again(entry)?;
    }
    let loss = rebuild.end(wall_ns)?;
    Ok(Some(Salvaged {
        loss,
        migrated_from: remains.migrated_from,
    }))
}

struct Rebuild<'a> {
    remains: &'a Remains,
    raw: &'a RawDatabase,
    copy: &'a mut Engine,
    catalogue: Catalogue,
    meta: Meta,
    writes: Writes,
}

impl Rebuild<'_> {
    /// Makes a whole entry again. A migrated history is chained anew.
    fn make_again(&mut self, entry: &HistoryEntry) -> Result<(), Error> {
        let mut entry = entry.clone();
        if self.remains.migrated_from.is_some() {
            entry.previous = self.meta.head;
        }
        let contents = self.contents_of(&entry.effects);
        self.apply(&entry, &contents)
    }

    fn apply(&mut self, entry: &HistoryEntry, contents: &Contents) -> Result<(), Error> {
        let mut target = Target {
            catalogue: &mut self.catalogue,
            meta: &mut self.meta,
            writes: &mut self.writes,
        };
        target.apply(entry, contents);
        if self.writes.n_bytes() < WRITE_BYTES {
            return Ok(());
        }
        std::mem::take(&mut self.writes).flush(self.copy)
    }

    /// What is whole of the content these effects bring in.
    fn contents_of(&self, effects: &[Effect]) -> Contents {
        let mut contents = Contents::default();
        for effect in effects {
            match effect {
                Effect::Stored { identity, .. } => {
                    let parts = self.remains.parts(self.raw, *identity);
                    if let Some(parts) = parts.filter(ViewParts::are_complete) {
                        contents.views.insert(*identity, parts);
                    }
                }
                Effect::Document {
                    after: Some(content),
                    ..
                } => {
                    if let Some(bytes) = self.remains.blob(self.raw, content.digest) {
                        contents.documents.insert(content.digest, bytes);
                    }
                }
                _ => {}
            }
        }
        contents
    }

    /// Makes the last entry, and has everything on disk.
    fn end(mut self, wall_ns: u64) -> Result<Loss, Error> {
        let lost = self.remains.lost_entries(self.meta.sequence);
        let (effects, contents, mut loss) = self.what_history_does_not_say();
        loss.n_history = lost.iter().map(|(first, last)| last - first + 1).sum();
        let last_sequence = lost.last().map_or(0, |(_, last)| *last);
        let is_whole = loss == Loss::default() && effects.is_empty();
        let operation = match self.remains.migrated_from {
            Some(schema) if is_whole => Operation::Migrate { schema },
            _ => Operation::Rebuild { loss, lost },
        };
        let entry = HistoryEntry {
            sequence: self.meta.sequence.max(last_sequence) + 1,
            previous: self.meta.head,
            wall_ns,
            author: AUTHOR.into(),
            operation,
            mutation: None,
            effects,
            contradiction: None,
        };
        self.apply(&entry, &contents)?;
        self.writes.commit(self.copy, &self.meta)?;
        Ok(loss)
    }

    /// The difference between what the whole entries made and what is whole.
    fn what_history_does_not_say(&self) -> (Vec<Effect>, Contents, Loss) {
        let mut news = News::default();
        let made: BTreeSet<ViewId> = self.catalogue.all().map(|(view, _)| view).collect();
        for (&view, identity) in &self.remains.views {
            if self.catalogue.get(view).is_none()
                && let Some(parts) = self.remains.parts(self.raw, *identity)
            {
                self.take_view(view, parts, &mut news);
            }
        }
        for (&view, register) in &self.remains.registers {
            let known = self.catalogue.get(view).map(|entry| &entry.register);
            if let Some(known) = known
                && known.sequence < register.sequence
                && known.standing != register.standing
            {
                news.effects.push(Effect::Changed {
                    view,
                    before: known.standing.clone(),
                    after: register.standing.clone(),
                    decided: Some(register.decided.clone()),
                });
            }
        }
        for (identity, decided) in &self.remains.tombstones {
            if !self.catalogue.tombstones.contains_key(identity) {
                news.effects.push(Effect::Tombstone {
                    identity: *identity,
                    decided: Some(decided.clone()),
                });
            }
        }
        self.take_documents(&mut news);
        let kept = made.len() + news.n_stored;
        news.give_up(self.remains.stored_by_history.difference(&made));
        news.loss.n_views = self.remains.n_views_expected.saturating_sub(kept as u64);
        (news.effects, news.contents, news.loss)
    }

    /// A view whose entry is lost, or whose cloud is.
    fn take_view(&self, view: ViewId, mut parts: ViewParts, news: &mut News) {
        if self.remains.stored_by_history.contains(&view) {
            // By the history it is one with a cloud.
            news.effects.push(Effect::Purged { view });
        }
        if parts.facts.points.is_some() && parts.points.is_none() {
            parts.facts.points = None;
            news.loss.n_clouds += 1;
        }
        let identity = parts.facts.identity();
        news.effects.push(Effect::Stored { view, identity });
        news.contents.views.insert(identity, parts);
        news.stored.insert(view);
        news.n_stored += 1;
        let standing = self.remains.standing(view);
        if let Some((standing, decided)) = standing.filter(|(s, _)| *s != Standing::Unnamed) {
            news.effects.push(Effect::Changed {
                view,
                before: Standing::Unnamed,
                after: standing,
                decided: Some(decided),
            });
        }
    }

    /// Present versions that the history does not give, and those whose content is gone.
    fn take_documents(&self, news: &mut News) {
        let mut present: BTreeMap<&DocumentKey, u64> = BTreeMap::new();
        for (key, sequence) in self.remains.documents.keys() {
            present.insert(key, *sequence);
        }
        for (key, sequence) in present {
            let known = self.catalogue.document(key);
            let Some(version) = self.remains.documents.get(&(key.clone(), sequence)) else {
                continue;
            };
            if known.is_some_and(|(known, _)| known >= sequence) {
                continue;
            }
            if let Some(content) = &version.content {
                let Some(bytes) = self.remains.blob(self.raw, content.digest) else {
                    let version = (key.clone(), sequence);
                    let is_told = self.remains.versions_by_history.contains(&version);
                    news.loss.n_documents += u64::from(!is_told);
                    continue;
                };
                news.contents.documents.insert(content.digest, bytes);
            }
            news.effects.push(Effect::Document {
                document: key.clone(),
                before: known.and_then(|(_, version)| version.content.clone()),
                after: version.content.clone(),
                decided: Some(version.decided.clone()),
            });
        }
        for (key, sequence) in &self.remains.versions_by_history {
            if !self
                .catalogue
                .versions()
                .any(|(k, s, ..)| (k, s) == (key, *sequence))
            {
                news.loss.n_documents += 1;
                news.effects.push(Effect::VersionPurged {
                    document: key.clone(),
                    sequence: *sequence,
                });
            }
        }
    }
}

/// What the last entry is to say.
#[derive(Default)]
struct News {
    effects: Vec<Effect>,
    contents: Contents,
    stored: BTreeSet<ViewId>,
    n_stored: usize,
    loss: Loss,
}

impl News {
    /// Views of the history that are not there any more.
    fn give_up<'a>(&mut self, views: impl Iterator<Item = &'a ViewId>) {
        let gone = views.filter(|view| !self.stored.contains(view));
        let purged: Vec<Effect> = gone.map(|view| Effect::Purged { view: *view }).collect();
        self.effects.splice(0..0, purged);
    }
}
