//! Model-based test: random operations on the store and on a reference model, with reopenings.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use learning::{CategoryName, ViewId};
use perceptual_memory::{
    CapturedView, Condition, DocumentKey, DocumentKind, Error, MemoryDocument, Mutation,
    MutationReceipt, PerceptualMemory, StoreChange, Target,
};
use proptest::prelude::*;

use crate::archiving;
use crate::builders::{
    NOW_NS, correct, fast_folder, forget, key, mutation, name, name_of, open, store, teach, undo,
    view,
};
use crate::reading::Follower;

const NAMES: [&str; 3] = ["Mug", "Bowl", "Cup"];
const N_TRACKS: u64 = 4;

#[derive(Debug, Clone)]
enum ModelOperation {
    Store(Vec<(u64, u32, u32)>),
    Teach(u64, usize),
    Correct(u64, usize),
    CorrectView(u64, u32, usize),
    Forget(usize),
    ForgetTrack(u64),
    ForgetView(u64, u32),
    Rename(usize, usize),
    Merge(usize, usize),
    /// Undo of the n-th last history entry.
    Undo(u64),
    Put(usize, u8),
    Remove(usize),
    /// Purge of content forgotten up to the n-th last mutation.
    Purge(u64),
    /// Repetition of the n-th last mutation.
    Repeat(usize),
    Lease(u64),
    Archive,
    OpenAgain,
    Rebuild,
    Replay,
}

fn operations() -> impl Strategy<Value = ModelOperation> {
    let track = 0..N_TRACKS;
    let view = 0..3_u32;
    let name = 0..NAMES.len();
    let a_view = (
        track.clone(),
        view.clone(),
        prop::sample::select(vec![0, 0, 0, 0, 1_u32]),
    );
    let two_names = (name.clone(), name.clone());
    prop_oneof![
        6 => prop::collection::vec(a_view, 1..4).prop_map(ModelOperation::Store),
        6 => (track.clone(), name.clone()).prop_map(|(t, n)| ModelOperation::Teach(t, n)),
        3 => (track.clone(), name.clone()).prop_map(|(t, n)| ModelOperation::Correct(t, n)),
        1 => (track.clone(), view.clone(), name.clone())
            .prop_map(|(t, v, n)| ModelOperation::CorrectView(t, v, n)),
        2 => name.clone().prop_map(ModelOperation::Forget),
        1 => track.clone().prop_map(ModelOperation::ForgetTrack),
        1 => (track, view).prop_map(|(t, v)| ModelOperation::ForgetView(t, v)),
        1 => two_names.clone().prop_map(|(a, b)| ModelOperation::Rename(a, b)),
        1 => two_names.prop_map(|(a, b)| ModelOperation::Merge(a, b)),
        5 => (0..6_u64).prop_map(ModelOperation::Undo),
        2 => (name.clone(), 0..3_u8).prop_map(|(n, c)| ModelOperation::Put(n, c)),
        1 => name.prop_map(ModelOperation::Remove),
        1 => (0..12_u64).prop_map(ModelOperation::Purge),
        3 => (0..8_usize).prop_map(ModelOperation::Repeat),
        1 => (1..5_u64).prop_map(ModelOperation::Lease),
        2 => Just(ModelOperation::Archive),
        2 => Just(ModelOperation::OpenAgain),
        1 => Just(ModelOperation::Rebuild),
        1 => Just(ModelOperation::Replay),
    ]
}

/// Label status in the model: a label, none, or forgotten.
type ModelStatus = Result<Option<String>, Forgotten>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Forgotten {
    stamp_ns: u64,
}

/// Content of the store, without its history.
#[derive(Debug, Clone, Default, PartialEq)]
struct ModelState {
    views: BTreeMap<ViewId, (CapturedView, ModelStatus)>,
    documents: BTreeMap<String, Vec<u8>>,
}

/// Entry in the model: state before, and touched items.
struct ModelEntry {
    before: ModelState,
    touched_views: BTreeSet<ViewId>,
    touched_documents: BTreeSet<String>,
    is_purge: bool,
    /// Entry that made the change that this one makes, undoes or redoes, and `true` if the change
    /// is in effect after this one.
    about: (usize, bool),
}

impl ModelEntry {
    fn touches(&self, view: Option<ViewId>, document: Option<&String>) -> bool {
        view.is_some_and(|view| self.touched_views.contains(&view))
            || document.is_some_and(|name| self.touched_documents.contains(name))
    }
}

/// Reference model of the store.
struct ReferenceModel {
    state: ModelState,
    entries: Vec<ModelEntry>,
    answers: HashMap<u128, (u64, u64)>,
    /// Time of the last label decision on each view.
    stamps_ns: BTreeMap<ViewId, u64>,
    next_track_id: u64,
}

impl ReferenceModel {
    /// Sequence number and number of views of the answer; `None` for a refusal.
    fn apply(&mut self, mutation: &Mutation) -> Option<(u64, u64)> {
        if let Some(answer) = self.answers.get(&mutation.id.0) {
            return Some(*answer);
        }
        let before = self.state.clone();
        let mut after = self.change(mutation)?;
        let touched_views: BTreeSet<ViewId> = all_views(&before, &after)
            .filter(|view| {
                let standing = |state: &ModelState| state.views.get(view).map(|(_, s)| s.clone());
                standing(&before) != standing(&after)
            })
            .collect();
        let touched_documents = ["Mug", "Bowl", "Cup"]
            .map(str::to_owned)
            .into_iter()
            .filter(|name| before.documents.get(name) != after.documents.get(name))
            .collect();
        self.stamp(&touched_views, mutation.wall_ns, &mut after);
        let n_views = touched_views.len() as u64;
        let about = match &mutation.change {
            StoreChange::Undo { sequence: Some(n) } => {
                let (change, is_done) = self.entries[*n as usize - 1].about;
                (change, !is_done)
            }
            _ => (self.entries.len(), true),
        };
        self.entries.push(ModelEntry {
            before,
            touched_views,
            touched_documents,
            is_purge: matches!(mutation.change, StoreChange::Purge { .. }),
            about,
        });
        self.state = after;
        let answer = (self.entries.len() as u64, n_views);
        self.answers.insert(mutation.id.0, answer);
        Some(answer)
    }

    /// Dates the decisions on the touched views. Each is later than the one before, even if a
    /// mutation that was refused first is repeated later.
    fn stamp(&mut self, touched: &BTreeSet<ViewId>, wall_ns: u64, after: &mut ModelState) {
        for view in touched {
            let Some((_, standing)) = after.views.get_mut(view) else {
                self.stamps_ns.remove(view);
                continue;
            };
            // Storing decides nothing.
            if self.state.views.contains_key(view) {
                let last_ns = self.stamps_ns.entry(*view).or_default();
                *last_ns = wall_ns.max(*last_ns + 1);
                if let Err(forgotten) = standing {
                    forgotten.stamp_ns = *last_ns;
                }
            }
        }
    }

    /// The state with these views; `None` for a view that differs from the stored one, or
    /// is new under a track-id that was never leased.
    fn with_views(&self, views: &[CapturedView]) -> Option<ModelState> {
        let mut state = self.state.clone();
        for view in views {
            let is_known = self.state.views.contains_key(&view.id);
            let is_leased = view.id.track_id < self.next_track_id;
            let slot = state.views.entry(view.id);
            let (known, _) = slot.or_insert((view.clone(), Ok(None)));
            if known != view || !(is_known || is_leased) {
                return None;
            }
        }
        Some(state)
    }

    fn change(&self, mutation: &Mutation) -> Option<ModelState> {
        let mut state = self.state.clone();
        match &mutation.change {
            StoreChange::StoreViews(views) => return self.with_views(views),
            StoreChange::Teach { track_id, category } => {
                let of_track = state.of(&Target::Track(*track_id))?;
                let is_other = |view: &ViewId| {
                    let standing = &state.views[view].1;
                    matches!(standing, Ok(Some(known)) if known != category.as_str())
                };
                if !of_track.iter().any(is_other) {
                    state.rename(&of_track, category);
                }
            }
            StoreChange::Correct { target, category } => {
                let views = state.of(target)?;
                state.rename(&views, category);
            }
            StoreChange::Forget(target) => {
                let stamp_ns = mutation.wall_ns;
                let standing = match target {
                    Target::Category(_) => Ok(None),
                    _ => Err(Forgotten { stamp_ns }),
                };
                for view in state.of(target)? {
                    state.set(view, standing.clone());
                }
            }
            StoreChange::Rename { from, to } => {
                let views = state.of(&Target::Category(from.clone()))?;
                if state.of(&Target::Category(to.clone())).is_some() {
                    return None;
                }
                state.rename(&views, to);
            }
            StoreChange::MergeCategories { from, into } => {
                let views = state.of(&Target::Category(from.clone()))?;
                state.of(&Target::Category(into.clone()))?;
                state.rename(&views, into);
            }
            StoreChange::Undo { sequence } => return self.undone(sequence.unwrap(), mutation.wall_ns),
            StoreChange::PutDocument(MemoryDocument { key, content, .. }) => {
                state.documents.insert(key.name.to_string(), content.clone());
            }
            StoreChange::RemoveDocument(key) => {
                state.documents.remove(&*key.name)?;
            }
            StoreChange::Purge { before_ns } => state.views.retain(|_, (_, standing)| {
                !matches!(standing, Err(forgotten) if forgotten.stamp_ns < *before_ns)
            }),
            other => unreachable!("{other:?}"),
        }
        Some(state)
    }

    /// Changes of a view or document that are in effect after the first entries, oldest first.
    fn stack(
        &self,
        n_entries: usize,
        view: Option<ViewId>,
        document: Option<&String>,
    ) -> Vec<usize> {
        let entries = self.entries[..n_entries].iter();
        let mut stack = Vec::new();
        for entry in entries.filter(|entry| entry.touches(view, document)) {
            match entry.about {
                (change, true) => stack.push(change),
                (_, false) => drop(stack.pop()),
            }
        }
        stack
    }

    /// State with the touched items reverted, if what later entries made of them is undone.
    fn undone(&self, sequence: u64, wall_ns: u64) -> Option<ModelState> {
        let index = sequence.checked_sub(1)? as usize;
        let entry = self.entries.get(index)?;
        if entry.is_purge || (entry.touched_views.is_empty() && entry.touched_documents.is_empty())
        {
            return None;
        }
        let is_about = |other: &ModelEntry| other.about.0 == entry.about.0;
        let last = self.entries.iter().rposition(is_about)?;
        if self.entries[last].about != entry.about {
            return None;
        }
        let entry = &self.entries[last];
        let is_free = |view, document| {
            let [then, now] = [last + 1, self.entries.len()];
            self.stack(then, view, document) == self.stack(now, view, document)
        };
        let mut views = entry.touched_views.iter();
        let mut documents = entry.touched_documents.iter();
        if !views.all(|view| is_free(Some(*view), None))
            || !documents.all(|name| is_free(None, Some(name)))
        {
            return None;
        }
        let mut state = self.state.clone();
        for view in &entry.touched_views {
            let before = entry.before.views.get(view).map(|(_, s)| s.clone());
            // Views that did not exist before are forgotten; forgotten views are
            // forgotten again, with the new time stamp.
            let forgotten = Forgotten { stamp_ns: wall_ns };
            let standing = before.unwrap_or(Err(forgotten));
            state.set(*view, standing.map_err(|_| forgotten));
        }
        for name in &entry.touched_documents {
            match entry.before.documents.get(name) {
                Some(content) => state.documents.insert(name.clone(), content.clone()),
                None => state.documents.remove(name),
            };
        }
        Some(state)
    }

    /// `true` for the undo of a replaced document whose earlier content may be purged, which the
    /// model does not track.
    fn may_lack_content(&self, change: &StoreChange) -> bool {
        let StoreChange::Undo { sequence: Some(n) } = change else {
            return false;
        };
        let mut since = self.entries.iter().skip((*n as usize).saturating_sub(1));
        let is_of_document = since
            .next()
            .is_some_and(|e| !e.touched_documents.is_empty());
        is_of_document && since.any(|entry| entry.is_purge)
    }

    fn check(&self, memory: &mut PerceptualMemory) {
        assert_eq!(memory.sequence(), self.entries.len() as u64);
        let present = |track: u64| {
            self.state
                .views
                .values()
                .filter_map(move |(view, standing)| {
                    (view.id.track_id == track).then_some((view, standing.as_ref().ok()?))
                })
        };
        for track in 0..N_TRACKS {
            let stored = memory.views_of_track(track).unwrap();
            let stored: Vec<_> = stored.iter().map(|s| (&s.view, name_of(s))).collect();
            let expected: Vec<_> = present(track).map(|(v, n)| (v, n.as_deref())).collect();
            assert_eq!(stored, expected);
        }
        let named = (0..N_TRACKS).flat_map(present).filter_map(|(view, name)| {
            Some((view.id, (name.clone()?, view.descriptor.values.clone())))
        });
        assert_eq!(Follower::load(memory, 400, |_| {}).names, named.collect());
        let documents = memory.documents().into_iter().map(|summary| {
            let document = memory.document(&summary.key).unwrap();
            (summary.key.name.to_string(), document.content)
        });
        assert_eq!(documents.collect::<BTreeMap<_, _>>(), self.state.documents);
        let history = memory.history(1, usize::MAX).unwrap();
        let sequences = history.iter().map(|entry| entry.sequence);
        assert!(sequences.eq(1..=self.entries.len() as u64));
        let found = memory.checkpoint().unwrap().open().unwrap();
        let found = found.verify(|_| {}).unwrap();
        assert_eq!(found.findings, [""; 0]);
    }
}

fn all_views<'a>(a: &'a ModelState, b: &'a ModelState) -> impl Iterator<Item = ViewId> + 'a {
    let all: BTreeSet<ViewId> = a.views.keys().chain(b.views.keys()).copied().collect();
    all.into_iter()
}

impl ModelState {
    /// Views of a target; `None` if there are none.
    fn of(&self, target: &Target) -> Option<Vec<ViewId>> {
        let is_meant = |view: &ViewId, name: &Option<String>| match target {
            Target::View(meant) => view == meant,
            Target::Track(track_id) => view.track_id == *track_id,
            Target::Category(meant) => name.as_deref() == Some(meant.as_str()),
        };
        let meant = self.views.iter().filter_map(|(view, (_, standing))| {
            let name = standing.as_ref().ok()?;
            is_meant(view, name).then_some(*view)
        });
        let meant: Vec<ViewId> = meant.collect();
        (!meant.is_empty()).then_some(meant)
    }

    fn set(&mut self, view: ViewId, standing: ModelStatus) {
        if let Some(slot) = self.views.get_mut(&view) {
            slot.1 = standing;
        }
    }

    fn rename(&mut self, views: &[ViewId], category: &CategoryName) {
        for view in views {
            self.set(*view, Ok(Some(category.as_str().to_owned())));
        }
    }
}

fn document(name: usize) -> DocumentKey {
    DocumentKey {
        kind: DocumentKind::TaskKnowledge,
        name: NAMES[name].into(),
    }
}

/// Mutation of an operation; `None` for the other operations.
fn asked_for(operation: &ModelOperation, id: u128, asked: &[Mutation], n: u64) -> Option<Mutation> {
    let change = match operation {
        ModelOperation::Store(views) => {
            let views = views.iter().map(|&(t, v, content)| view(t, v, content));
            return Some(store(id, views.collect()));
        }
        ModelOperation::Teach(track, name) => return Some(teach(id, *track, NAMES[*name])),
        ModelOperation::Correct(track, name) => return Some(correct(id, *track, NAMES[*name])),
        ModelOperation::Forget(name) => return Some(forget(id, NAMES[*name])),
        ModelOperation::Undo(back) => return Some(undo(id, n.saturating_sub(*back))),
        ModelOperation::Repeat(back) => return asked.iter().rev().nth(*back).cloned(),
        ModelOperation::CorrectView(track, view, category) => StoreChange::Correct {
            target: Target::View(key(*track, *view)),
            category: name(NAMES[*category]),
        },
        ModelOperation::ForgetTrack(track) => StoreChange::Forget(Target::Track(*track)),
        ModelOperation::ForgetView(track, view) => {
            StoreChange::Forget(Target::View(key(*track, *view)))
        }
        ModelOperation::Rename(from, to) => StoreChange::Rename {
            from: name(NAMES[*from]),
            to: name(NAMES[*to]),
        },
        ModelOperation::Merge(from, into) => StoreChange::MergeCategories {
            from: name(NAMES[*from]),
            into: name(NAMES[*into]),
        },
        ModelOperation::Put(name, content) => StoreChange::PutDocument(MemoryDocument {
            key: document(*name),
            media_type: "text/plain".to_owned(),
            content: vec![*content; 40],
        }),
        ModelOperation::Remove(name) => StoreChange::RemoveDocument(document(*name)),
        ModelOperation::Purge(back) => StoreChange::Purge {
            before_ns: NOW_NS + (id as u64).saturating_sub(*back),
        },
        _ => return None,
    };
    Some(mutation(id, change))
}

/// Runs the operations on store and model; mutation ids count from one.
fn check(operations: Vec<ModelOperation>) {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    let mut model = ReferenceModel {
        state: ModelState::default(),
        entries: Vec::new(),
        answers: HashMap::new(),
        stamps_ns: BTreeMap::new(),
        next_track_id: 1,
    };
    // The last track is leased by the operations, or never.
    assert_eq!(memory.lease_track_ids(N_TRACKS - 2).unwrap(), 1);
    model.next_track_id = N_TRACKS - 1;
    let mut asked: Vec<Mutation> = Vec::new();
    let mut follower = Follower::load(&mut memory, 0, |_| {});
    for operation in operations {
        let id = asked.len() as u128 + 1;
        let n = model.entries.len() as u64;
        let Some(mutation) = asked_for(&operation, id, &asked, n) else {
            memory = between(&operation, memory, &folder, &mut model);
            if matches!(operation, ModelOperation::Archive) {
                follower = Follower::load(&mut memory, 0, |_| {});
            }
            if matches!(operation, ModelOperation::Rebuild) {
                assert!(!follower.follow(&mut memory, 300), "it is another store");
                follower = Follower::load(&mut memory, 0, |_| {});
            }
            continue;
        };
        if model.may_lack_content(&mutation.change) {
            continue;
        }
        match (memory.apply(&mutation), model.apply(&mutation)) {
            (Ok(answer), Some(expected)) => {
                let MutationReceipt {
                    sequence, n_views, ..
                } = answer;
                assert_eq!((sequence, n_views), expected, "{mutation:?}");
            }
            (Err(Error::Refused(_)), None) => {}
            (told, expected) => panic!("{mutation:?}: {told:?}, expected {expected:?}"),
        }
        asked.push(mutation);
    }
    model.check(&mut memory);
    assert!(follower.follow(&mut memory, 300));
    assert_eq!(follower, Follower::load(&mut memory, 0, |_| {}));
}

/// Runs an operation that is no mutation.
fn between(
    operation: &ModelOperation,
    mut memory: PerceptualMemory,
    folder: &tempfile::TempDir,
    model: &mut ReferenceModel,
) -> PerceptualMemory {
    match operation {
        ModelOperation::Lease(count) => {
            assert_eq!(memory.lease_track_ids(*count).unwrap(), model.next_track_id);
            model.next_track_id += count;
            memory
        }
        ModelOperation::Archive => {
            memory.set_limits(archiving::limits());
            archiving::archive(&mut memory);
            memory
        }
        ModelOperation::OpenAgain => {
            drop(memory);
            let (mut memory, report) = open(folder);
            let is_sound = matches!(report.condition, Condition::Sound | Condition::New);
            assert!(is_sound, "{report}");
            model.check(&mut memory);
            memory
        }
        ModelOperation::Rebuild => rebuild(memory, folder, model),
        ModelOperation::Replay => {
            let copy = fast_folder();
            let (mut again, _) = memory.replay_into(copy.path()).unwrap();
            // The copy has all of its history in the database.
            let is_content = |key: &Vec<u8>| !matches!(key.first(), Some(b'h' | b'a'));
            let [mut again_records, mut records] =
                [&mut again, &mut memory].map(archiving::records);
            again_records.retain(|key, _| is_content(key));
            records.retain(|key, _| is_content(key));
            assert_eq!(again_records, records);
            let all = |memory: &mut PerceptualMemory| memory.history(1, usize::MAX).unwrap();
            assert_eq!(all(&mut again), all(&mut memory));
            memory
        }
        _ => memory,
    }
}

/// Rebuilds an undamaged store: nothing is lost, and the history gets one more entry.
fn rebuild(
    memory: PerceptualMemory,
    folder: &tempfile::TempDir,
    model: &mut ReferenceModel,
) -> PerceptualMemory {
    drop(memory);
    let (mut memory, report) =
        PerceptualMemory::open_and_rebuild(folder.path(), 5).expect("the store opens");
    match &report.condition {
        Condition::Rebuilt { loss, .. } => {
            assert_eq!(*loss, perceptual_memory::DataLoss::default(), "{report}");
        }
        other => panic!("{other:?}"),
    }
    let state = model.state.clone();
    let about = (model.entries.len(), true);
    model.entries.push(ModelEntry {
        before: state,
        touched_views: BTreeSet::new(),
        touched_documents: BTreeSet::new(),
        is_purge: false,
        about,
    });
    model.check(&mut memory);
    memory
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn store_equals_its_reference_model(operations in prop::collection::vec(operations(), 1..40)) {
        check(operations);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, ..ProptestConfig::default() })]

    #[test]
    #[ignore = "long"]
    fn long_store_equals_its_reference_model(
        operations in prop::collection::vec(operations(), 1..120),
    ) {
        check(operations);
    }
}

#[test]
fn mutation_refused_and_repeated_is_decided_last() {
    check(vec![
        ModelOperation::Store(vec![(2, 0, 0)]),
        ModelOperation::ForgetTrack(2),
        // Refused: it is forgotten already.
        ModelOperation::ForgetTrack(2),
        ModelOperation::Undo(0),
        // The refused one, older than the undoing.
        ModelOperation::Repeat(1),
        // Between the two stamps that it could have.
        ModelOperation::Purge(1),
    ]);
}

#[test]
fn document_purge_keeps_the_date_of_the_next_version() {
    check(vec![
        // Refused: there is none yet.
        ModelOperation::Remove(0),
        ModelOperation::Put(0, 0),
        // The refused one, older than the document.
        ModelOperation::Repeat(1),
        ModelOperation::Purge(0),
        ModelOperation::Replay,
    ]);
}
