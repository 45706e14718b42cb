//! Model-based test of undo and redo: several users, a list of states, and a stack of undo and redo
//! for each user.

use std::collections::BTreeMap;

use learning::ViewId;
use perceptual_memory::{
    DecisionStamp, DocumentKey, DocumentKind, Error, ForeignView, ImportPart, LabelStatus,
    MemoryDocument, Mutation, Origin, PerceptualMemory, Requester, StoreChange, StoreRefusal,
    Target,
};
use proptest::prelude::*;
use tempfile::TempDir;

use crate::archiving;
use crate::builders::{NOW_NS, fast_folder, key, mutation, name, open, view};

const NAMES: [&str; 3] = ["Mug", "Bowl", "Cup"];
const N_TRACKS: u64 = 3;
const N_FOREIGN: u32 = 4;
const FOREIGN_MEMORY: u128 = 7;
/// Two teachers, and an administrator.
const USERS: [(&str, u32, bool); 3] = [
    ("anna", 1000, false),
    ("ben", 1001, false),
    ("root", 0, true),
];
const PERCEPTION: usize = USERS.len();

#[derive(Debug, Clone)]
enum Step {
    Teach(u64, usize),
    Correct(u64, usize),
    Forget(u64),
    ForgetCategory(usize),
    Rename(usize, usize),
    Merge(usize, usize),
    Put(usize, u8),
    /// Import of the first foreign views under a name, in one or two entries.
    Import(u32, usize, bool),
    Undo,
    Redo,
    /// Undo of the n-th last entry.
    UndoEntry(u64),
    OpenAgain,
    Archive,
}

fn step() -> impl Strategy<Value = Step> {
    let track = 1..=N_TRACKS;
    let name = 0..NAMES.len();
    prop_oneof![
        4 => (track.clone(), name.clone()).prop_map(|(t, n)| Step::Teach(t, n)),
        4 => (track.clone(), name.clone()).prop_map(|(t, n)| Step::Correct(t, n)),
        1 => track.prop_map(Step::Forget),
        1 => name.clone().prop_map(Step::ForgetCategory),
        2 => (name.clone(), name.clone()).prop_map(|(a, b)| Step::Rename(a, b)),
        1 => (name.clone(), name.clone()).prop_map(|(a, b)| Step::Merge(a, b)),
        1 => (0..2_usize, 0..3_u8).prop_map(|(d, c)| Step::Put(d, c)),
        2 => (2..=N_FOREIGN, name, any::<bool>()).prop_map(|(v, n, p)| Step::Import(v, n, p)),
        10 => Just(Step::Undo),
        6 => Just(Step::Redo),
        3 => (0..8_u64).prop_map(Step::UndoEntry),
        1 => Just(Step::OpenAgain),
        1 => Just(Step::Archive),
    ]
}

/// View by its origin, or document by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Item {
    View(u128, ViewId),
    Document(usize),
}

/// Label of each view that is not forgotten, and content of each document.
type State = BTreeMap<Item, String>;

/// Change of the model: what it made of each item, and of what.
#[derive(Debug, Clone)]
struct Change {
    user: usize,
    before: BTreeMap<Item, Option<String>>,
    after: BTreeMap<Item, Option<String>>,
    /// Entry that made, undid or redid it last.
    last: u64,
    /// Changes of each item that it was made on.
    beneath: BTreeMap<Item, Vec<usize>>,
}

/// Undo list and redo list of a user, by the numbers of the changes.
#[derive(Debug, Clone, Default)]
struct Lists {
    undo: Vec<usize>,
    redo: Vec<usize>,
}

#[derive(Default)]
struct Model {
    state: State,
    changes: Vec<Change>,
    users: Vec<Lists>,
    /// Changes of each item that are in effect.
    stacks: BTreeMap<Item, Vec<usize>>,
    /// User of each entry, the change that it is about, and `true` if the change is in effect
    /// after it.
    entries: Vec<(usize, Option<(usize, bool)>)>,
}

/// Expected outcome of a request.
#[derive(Debug, PartialEq)]
enum Expected {
    Done,
    Refused,
    NothingToUndo,
    NothingToRedo,
    /// Another change of an item came later.
    Obstacle,
}

impl Model {
    /// Views of a track or with a label, as items.
    fn views(&self, is_meant: impl Fn(&Item, &str) -> bool) -> Vec<Item> {
        let meant = self
            .state
            .iter()
            .filter(|(item, label)| matches!(item, Item::View(..)) && is_meant(item, label));
        meant.map(|(item, _)| *item).collect()
    }

    fn of_track(&self, track: u64) -> Vec<Item> {
        self.views(|item, _| matches!(item, Item::View(memory, view) if *memory != FOREIGN_MEMORY && view.track_id == track))
    }

    fn of_category(&self, name: usize) -> Vec<Item> {
        self.views(|_, label| label == NAMES[name])
    }

    /// New values of the items that a step changes; `None` for a refusal.
    fn values(&self, step: &Step) -> Option<BTreeMap<Item, Option<String>>> {
        let label = |name: usize| Some(NAMES[name].to_owned());
        let some = |items: Vec<Item>| (!items.is_empty()).then_some(items);
        let (items, value) = match *step {
            Step::Teach(track, name) => {
                let items = some(self.of_track(track))?;
                let is_other = |item: &&Item| ![NAMES[name], "-"].contains(&&*self.state[*item]);
                if items.iter().any(|item| is_other(&item)) {
                    return Some(BTreeMap::new());
                }
                (items, label(name))
            }
            Step::Correct(track, name) => (some(self.of_track(track))?, label(name)),
            Step::Forget(track) => (some(self.of_track(track))?, None),
            Step::ForgetCategory(name) => (some(self.of_category(name))?, Some("-".to_owned())),
            Step::Rename(from, to) => {
                let items = some(self.of_category(from))?;
                if !self.of_category(to).is_empty() {
                    return None;
                }
                (items, label(to))
            }
            Step::Merge(from, into) => {
                some(self.of_category(into))?;
                (some(self.of_category(from))?, label(into))
            }
            Step::Put(document, content) => {
                (vec![Item::Document(document)], Some(content.to_string()))
            }
            // The decision of an import is a change, even if the label stays.
            Step::Import(n_views, name, _) => {
                let items = (0..n_views).map(foreign);
                return Some(items.map(|item| (item, label(name))).collect());
            }
            _ => return None,
        };
        let new = items.into_iter().map(|item| (item, value.clone()));
        let is_new =
            |(item, value): &(Item, Option<String>)| self.state.get(item) != value.as_ref();
        Some(new.filter(is_new).collect())
    }

    fn set(&mut self, values: &BTreeMap<Item, Option<String>>) {
        for (item, value) in values {
            match value {
                Some(value) => drop(self.state.insert(*item, value.clone())),
                None => drop(self.state.remove(item)),
            }
        }
    }

    /// Makes a new change, in `n_entries` entries.
    fn make(&mut self, user: usize, after: BTreeMap<Item, Option<String>>, n_entries: usize) {
        let change = self.changes.len();
        let about = (!after.is_empty()).then_some((change, true));
        self.entries.extend(vec![(user, about); n_entries]);
        if after.is_empty() {
            return;
        }
        let mut made = Change {
            user,
            before: BTreeMap::new(),
            last: self.entries.len() as u64,
            beneath: BTreeMap::new(),
            after,
        };
        for item in made.after.keys() {
            made.before.insert(*item, self.state.get(item).cloned());
            let stack = self.stacks.entry(*item).or_default();
            made.beneath.insert(*item, stack.clone());
            stack.push(change);
        }
        self.set(&made.after);
        self.changes.push(made);
        self.users[user].redo.clear();
        self.users[user].undo.push(change);
    }

    /// Undoes or redoes a change by a user, if nothing of it was changed since.
    fn reverse(&mut self, user: usize, change: usize, is_redo: bool) -> Expected {
        let reversed = self.changes[change].clone();
        let is_free = |item: &Item| {
            let mut expected = reversed.beneath[item].clone();
            if !is_redo {
                expected.push(change);
            }
            self.stacks[item] == expected
        };
        if !reversed.after.keys().all(is_free) {
            return Expected::Obstacle;
        }
        for item in reversed.after.keys() {
            let stack = self.stacks.get_mut(item).unwrap();
            if is_redo {
                stack.push(change);
            } else {
                stack.pop();
            }
        }
        self.set(if is_redo {
            &reversed.after
        } else {
            &reversed.before
        });
        for lists in &mut self.users {
            lists.undo.retain(|listed| *listed != change);
            lists.redo.retain(|listed| *listed != change);
        }
        if is_redo {
            self.users[user].undo.push(change);
            if reversed.user != user {
                self.users[reversed.user].undo.push(change);
            }
        } else {
            self.users[user].redo.push(change);
        }
        self.entries.push((user, Some((change, is_redo))));
        self.changes[change].last = self.entries.len() as u64;
        Expected::Done
    }

    fn undo_entry(&mut self, user: usize, sequence: u64) -> Expected {
        let Some(index) = (sequence as usize).checked_sub(1) else {
            return Expected::Refused;
        };
        let (author, about) = self.entries[index];
        let Some((change, is_done)) = about else {
            return Expected::Refused;
        };
        let last = self.changes[change].last as usize;
        let is_in_effect = self.entries[last - 1].1 == Some((change, is_done));
        if !is_in_effect || !(USERS[user].2 || author == user) {
            return Expected::Refused;
        }
        self.reverse(user, change, !is_done)
    }

    fn apply(&mut self, user: usize, step: &Step) -> Expected {
        match step {
            Step::Undo => match self.users[user].undo.last() {
                Some(change) => self.reverse(user, *change, false),
                None => Expected::NothingToUndo,
            },
            Step::Redo => match self.users[user].redo.last() {
                Some(change) => self.reverse(user, *change, true),
                None => Expected::NothingToRedo,
            },
            Step::UndoEntry(back) => {
                let last = self.entries.len() as u64;
                self.undo_entry(user, last.saturating_sub(*back))
            }
            step => match self.values(step) {
                Some(values) => {
                    let n_entries = 1 + usize::from(matches!(step, Step::Import(_, _, true)));
                    self.make(user, values, n_entries);
                    Expected::Done
                }
                None => Expected::Refused,
            },
        }
    }
}

fn foreign(n: u32) -> Item {
    Item::View(FOREIGN_MEMORY, key(1, n))
}

fn document(n: usize) -> DocumentKey {
    DocumentKey {
        kind: DocumentKind::TaskKnowledge,
        name: NAMES[n].into(),
    }
}

/// Foreign views with a label that was decided at a time.
fn foreign_views(numbers: std::ops::Range<u32>, label: usize, stamp_ns: u64) -> Vec<ForeignView> {
    let view = |n| ForeignView::Present {
        view: Box::new(view(1, n, 9)),
        origin: Origin {
            memory_id: FOREIGN_MEMORY,
            view: key(1, n),
        },
        standing: LabelStatus::Named(name(NAMES[label])),
        decided: Some(DecisionStamp {
            author: "eve".into(),
            stamp_ns,
        }),
    };
    numbers.map(view).collect()
}

/// Store under test, with the number of the last mutation.
struct Store {
    folder: TempDir,
    memory: PerceptualMemory,
    id: u128,
}

impl Store {
    fn apply(&mut self, user: usize, change: StoreChange) -> Result<u64, Error> {
        self.id += 1;
        let (author, uid, may_undo_others) =
            USERS
                .get(user)
                .copied()
                .unwrap_or(("perception", 990, false));
        let mutation = Mutation {
            author: author.to_owned(),
            requester: Requester {
                uid: Some(uid),
                may_undo_others,
            },
            ..mutation(self.id, change)
        };
        Ok(self.memory.apply(&mutation)?.sequence)
    }

    fn import(
        &mut self,
        user: usize,
        (n_views, label, is_split): (u32, usize, bool),
    ) -> Result<u64, Error> {
        let stamp_ns = NOW_NS + self.id as u64 + 1;
        let part = |numbers, part| StoreChange::Import {
            source: "eve".to_owned(),
            views: foreign_views(numbers, label, stamp_ns),
            documents: Vec::new(),
            part,
        };
        if !is_split {
            return self.apply(user, part(0..n_views, ImportPart::default()));
        }
        let is_continued = true;
        let first = None;
        let first = self.apply(
            user,
            part(
                0..1,
                ImportPart {
                    first,
                    is_continued,
                },
            ),
        )?;
        let last = ImportPart {
            first: Some(first),
            is_continued: false,
        };
        self.apply(user, part(1..n_views, last))
    }

    fn make(&mut self, user: usize, step: &Step) -> Result<u64, Error> {
        let category = |n: &usize| name(NAMES[*n]);
        let change = match step {
            Step::Teach(track_id, n) => StoreChange::Teach {
                track_id: *track_id,
                category: category(n),
            },
            Step::Correct(track_id, n) => StoreChange::Correct {
                target: Target::Track(*track_id),
                category: category(n),
            },
            Step::Forget(track_id) => StoreChange::Forget(Target::Track(*track_id)),
            Step::ForgetCategory(n) => StoreChange::Forget(Target::Category(category(n))),
            Step::Rename(from, to) => StoreChange::Rename {
                from: category(from),
                to: category(to),
            },
            Step::Merge(from, into) => StoreChange::MergeCategories {
                from: category(from),
                into: category(into),
            },
            Step::Put(n, content) => StoreChange::PutDocument(MemoryDocument {
                key: document(*n),
                media_type: "text/plain".to_owned(),
                content: content.to_string().into_bytes(),
            }),
            Step::Import(n_views, label, is_split) => {
                return self.import(user, (*n_views, *label, *is_split));
            }
            Step::Undo => StoreChange::Undo { sequence: None },
            Step::Redo => StoreChange::Redo,
            Step::UndoEntry(back) => StoreChange::Undo {
                sequence: Some(self.memory.sequence().saturating_sub(*back)),
            },
            Step::OpenAgain | Step::Archive => unreachable!("no mutation"),
        };
        self.apply(user, change)
    }

    fn open_again(self) -> Self {
        drop(self.memory);
        let (memory, report) = open(&self.folder);
        assert!(!report.is_damage(), "{report}");
        Self { memory, ..self }
    }

    fn state(&mut self) -> State {
        let own = self.memory.memory_id();
        let views = self.memory.views(None, None, 1000).unwrap();
        let label = |standing: &LabelStatus| {
            standing
                .category()
                .map_or("-", |name| name.as_str())
                .to_owned()
        };
        let views = views.iter().map(|view| {
            let memory = view.origin.memory_id;
            let memory = if memory == own { 0 } else { memory };
            (Item::View(memory, view.origin.view), label(&view.standing))
        });
        let mut state: State = views.collect();
        for n in 0..2 {
            if let Ok(document) = self.memory.document(&document(n)) {
                let content = String::from_utf8(document.content).unwrap();
                state.insert(Item::Document(n), content);
            }
        }
        state
    }
}

/// Store with unlabelled views, and its model.
fn begun() -> (Store, Model) {
    let folder = fast_folder();
    let (memory, _) = open(&folder);
    let mut store = Store {
        folder,
        memory,
        id: 0,
    };
    store.memory.lease_track_ids(N_TRACKS).unwrap();
    let mut model = Model {
        users: vec![Lists::default(); USERS.len() + 1],
        ..Model::default()
    };
    for track in 1..=N_TRACKS {
        let views = vec![view(track, 0, 0), view(track, 1, 0)];
        let items = views
            .iter()
            .map(|view| (Item::View(0, view.id), Some("-".to_owned())));
        model.make(PERCEPTION, items.collect(), 1);
        store
            .apply(PERCEPTION, StoreChange::StoreViews(views))
            .unwrap();
    }
    (store, model)
}

fn assert_as_expected(outcome: &Result<u64, Error>, expected: &Expected, context: &str) {
    let is_expected = match (outcome, expected) {
        (Ok(_), Expected::Done) => true,
        (Err(Error::Refused(refusal)), expected) => match expected {
            Expected::Done => false,
            Expected::Refused => !matches!(refusal, StoreRefusal::ChangedSince { .. }),
            Expected::NothingToUndo => *refusal == StoreRefusal::NothingToUndo,
            Expected::NothingToRedo => *refusal == StoreRefusal::NothingToRedo,
            // The entry in the way is later, and somebody made it.
            Expected::Obstacle => matches!(
                refusal,
                StoreRefusal::ChangedSince { sequence, by, author: Some(_), .. } if by > sequence
            ),
        },
        _ => false,
    };
    assert!(is_expected, "{context}: {outcome:?}, expected {expected:?}");
}

fn check(steps: &[(usize, Step)]) {
    let (mut store, mut model) = begun();
    for (user, step) in steps {
        match step {
            Step::OpenAgain => store = store.open_again(),
            Step::Archive => {
                store.memory.set_limits(archiving::limits());
                archiving::archive(&mut store.memory);
            }
            step => {
                let expected = model.apply(*user, step);
                let outcome = store.make(*user, step);
                let context = format!("{:?} {step:?}", USERS[*user].0);
                assert_as_expected(&outcome, &expected, &context);
            }
        }
        assert_eq!(store.memory.sequence(), model.entries.len() as u64);
        assert_eq!(store.state(), model.state, "after {user} {step:?}");
    }
    let found = store.memory.checkpoint().unwrap().open().unwrap();
    assert_eq!(found.verify(|_| {}).unwrap().findings, [""; 0]);
}

/// States of one user's changes, to the beginning by undo and to the end by redo.
fn check_walk(steps: &[Step]) {
    let (mut store, mut model) = begun();
    let mut states = vec![store.state()];
    for step in steps {
        let n_listed = model.users[0].undo.len();
        model.apply(0, step);
        // A refused step changes nothing, and is in no list.
        let _ = store.make(0, step);
        if model.users[0].undo.len() > n_listed {
            states.push(store.state());
        }
    }
    store = store.open_again();
    for state in states.iter().rev().skip(1) {
        store.make(0, &Step::Undo).unwrap();
        assert_eq!(store.state(), *state);
    }
    let nothing = store.make(0, &Step::Undo);
    assert_as_expected(&nothing, &Expected::NothingToUndo, "at the beginning");
    store = store.open_again();
    for state in states.iter().skip(1) {
        store.make(0, &Step::Redo).unwrap();
        assert_eq!(store.state(), *state);
    }
    let nothing = store.make(0, &Step::Redo);
    assert_as_expected(&nothing, &Expected::NothingToRedo, "at the end");
}

fn steps(most: usize) -> impl Strategy<Value = Vec<(usize, Step)>> {
    prop::collection::vec((0..USERS.len(), step()), 1..most)
}

fn changes() -> impl Strategy<Value = Vec<Step>> {
    let is_change = |step: &Step| {
        !matches!(
            step,
            Step::Undo | Step::Redo | Step::UndoEntry(_) | Step::OpenAgain | Step::Archive
        )
    };
    prop::collection::vec(step().prop_filter("a change", is_change), 1..20)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, ..ProptestConfig::default() })]

    #[test]
    fn undo_equals_its_reference_model(steps in steps(40)) {
        check(&steps);
    }

    #[test]
    fn undo_walks_to_the_beginning_and_redo_to_the_end(steps in changes()) {
        check_walk(&steps);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4_000, ..ProptestConfig::default() })]

    #[test]
    #[ignore = "long"]
    fn long_undo_equals_its_reference_model(steps in steps(120)) {
        check(&steps);
    }
}
