//! Random operations on the store and on a model of it, opened again in between.

use std::collections::{BTreeMap, HashMap};

use learning::ViewId;
use proptest::prelude::*;
use store::{Answer, Change, Condition, Error, Mutation, PerceptualMemory, View};

use crate::builders::{correct, fast_folder, forget, open, store, teach, view};
use crate::reading::Follower;

const NAMES: [&str; 3] = ["Mug", "Bowl", "Cup"];

#[derive(Debug, Clone)]
enum Operation {
    Store(Vec<(u64, u32, u32)>),
    Teach(u64, usize),
    Correct(u64, usize),
    Forget(usize),
    /// Asks the n-th last mutation again.
    Repeat(usize),
    Lease(u64),
    OpenAgain,
    Rebuild,
}

fn operations() -> impl Strategy<Value = Operation> {
    let track = 0..4_u64;
    let name = 0..NAMES.len();
    let a_view = (
        track.clone(),
        0..3_u32,
        prop::sample::select(vec![0, 0, 0, 0, 1_u32]),
    );
    prop_oneof![
        6 => prop::collection::vec(a_view, 1..4).prop_map(Operation::Store),
        6 => (track.clone(), name.clone()).prop_map(|(t, n)| Operation::Teach(t, n)),
        4 => (track, name.clone()).prop_map(|(t, n)| Operation::Correct(t, n)),
        2 => name.prop_map(Operation::Forget),
        3 => (0..8_usize).prop_map(Operation::Repeat),
        1 => (1..5_u64).prop_map(Operation::Lease),
        2 => Just(Operation::OpenAgain),
        1 => Just(Operation::Rebuild),
    ]
}

/// What the store should be, written down as plainly as possible.
#[derive(Default)]
struct Model {
    views: BTreeMap<ViewId, (View, Option<String>)>,
    answers: HashMap<u128, Answer>,
    sequence: u64,
    next_track_id: u64,
}

impl Model {
    /// The answer, or none for a refusal.
    fn apply(&mut self, mutation: &Mutation) -> Option<Answer> {
        if let Some(answer) = self.answers.get(&mutation.id.0) {
            return Some(*answer);
        }
        let n_views = match &mutation.change {
            Change::StoreViews(views) => self.store(views)?,
            Change::Teach { track_id, category } => {
                let others = |name: &str| name != category.as_str();
                let mut of_track = self
                    .views
                    .iter()
                    .filter(|(view, _)| view.track_id == *track_id);
                if of_track.any(|(_, (_, name))| name.as_deref().is_some_and(others)) {
                    return None;
                }
                self.name(*track_id, category.as_str())?
            }
            Change::Correct { track_id, category } => self.name(*track_id, category.as_str())?,
            Change::Forget { category } => {
                let all = self.views.values_mut().map(|(_, name)| name);
                let those = all.filter(|name| name.as_deref() == Some(category.as_str()));
                let n_views = those.map(|name| *name = None).count() as u64;
                (n_views > 0).then_some(n_views)?
            }
            _ => unreachable!("no other change is made here"),
        };
        self.sequence += u64::from(n_views > 0);
        let answer = Answer {
            sequence: self.sequence,
            n_views,
        };
        self.answers.insert(mutation.id.0, answer);
        Some(answer)
    }

    fn store(&mut self, views: &[View]) -> Option<u64> {
        let mut after = self.views.clone();
        for view in views {
            let (known, _) = after.entry(view.id).or_insert((view.clone(), None));
            if known != view {
                return None;
            }
        }
        let n_views = (after.len() - self.views.len()) as u64;
        self.views = after;
        let last = self
            .views
            .last_key_value()
            .map_or(0, |(view, _)| view.track_id);
        self.next_track_id = self.next_track_id.max(last + 1);
        Some(n_views)
    }

    fn name(&mut self, track_id: u64, name: &str) -> Option<u64> {
        let views = self
            .views
            .iter_mut()
            .filter(|(view, _)| view.track_id == track_id);
        let names: Vec<_> = views.map(|(_, (_, name))| name).collect();
        if names.is_empty() {
            return None;
        }
        let changed = names
            .into_iter()
            .filter(|known| known.as_deref() != Some(name));
        Some(changed.map(|known| *known = Some(name.to_owned())).count() as u64)
    }

    fn check(&self, memory: &mut PerceptualMemory) {
        assert_eq!(memory.sequence(), self.sequence);
        for track in 0..4 {
            let stored = memory.views_of_track(track).unwrap();
            let stored: Vec<_> = stored
                .into_iter()
                .map(|s| {
                    (
                        s.view,
                        s.label.map(|label| label.category.as_str().to_owned()),
                    )
                })
                .collect();
            let expected: Vec<_> = self
                .views
                .values()
                .filter(|(v, _)| v.id.track_id == track)
                .cloned()
                .collect();
            assert_eq!(stored, expected);
        }
        let named = self.views.values().filter_map(|(view, name)| {
            Some((view.id, (name.clone()?, view.descriptor.values.clone())))
        });
        assert_eq!(Follower::load(memory, 400, |_| {}).names, named.collect());
        let history = memory.history(1, usize::MAX).unwrap();
        assert!(
            history
                .iter()
                .map(|entry| entry.sequence)
                .eq(1..=self.sequence)
        );
    }
}

/// Runs the operations on both; ids of mutations count up from one.
fn check(operations: Vec<Operation>) {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    let mut model = Model {
        next_track_id: 1,
        ..Model::default()
    };
    let mut asked: Vec<Mutation> = Vec::new();
    let mut follower = Follower::load(&mut memory, 0, |_| {});
    for operation in operations {
        let id = asked.len() as u128 + 1;
        let mutation = match operation {
            Operation::Store(views) => store(
                id,
                views
                    .into_iter()
                    .map(|(t, v, content)| view(t, v, content))
                    .collect(),
            ),
            Operation::Teach(track, name) => teach(id, track, NAMES[name]),
            Operation::Correct(track, name) => correct(id, track, NAMES[name]),
            Operation::Forget(name) => forget(id, NAMES[name]),
            Operation::Repeat(back) if back < asked.len() => asked[asked.len() - 1 - back].clone(),
            Operation::Repeat(_) => continue,
            Operation::Lease(count) => {
                assert_eq!(memory.lease_track_ids(count).unwrap(), model.next_track_id);
                model.next_track_id += count;
                continue;
            }
            Operation::OpenAgain => {
                drop(memory);
                let (opened, report) = open(&folder);
                memory = opened;
                assert_eq!(report.condition, Condition::Sound, "{report}");
                model.check(&mut memory);
                continue;
            }
            Operation::Rebuild => {
                memory = rebuild(memory, &folder, &mut model);
                assert!(!follower.follow(&mut memory, 0), "another store id");
                follower = Follower::load(&mut memory, 0, |_| {});
                continue;
            }
        };
        match memory.apply(&mutation) {
            Ok(answer) => assert_eq!(Some(answer), model.apply(&mutation), "{mutation:?}"),
            Err(Error::Refused(refusal)) => {
                assert_eq!(None, model.apply(&mutation), "{mutation:?}: {refusal}");
            }
            Err(error) => panic!("{error}"),
        }
        asked.push(mutation);
    }
    model.check(&mut memory);
    assert!(follower.follow(&mut memory, 300));
    assert_eq!(follower, Follower::load(&mut memory, 0, |_| {}));
}

/// A rebuilt store that was not damaged has lost nothing; its history has one
/// entry more, which no mutation asked for.
fn rebuild(
    memory: PerceptualMemory,
    folder: &tempfile::TempDir,
    model: &mut Model,
) -> PerceptualMemory {
    drop(memory);
    let (mut memory, report) =
        PerceptualMemory::open_and_rebuild(folder.path(), 5).expect("the store opens");
    match &report.condition {
        // Nothing was ever stored: there is nothing to copy.
        Condition::Rebuilt { loss, .. } => assert_eq!(*loss, store::Loss::default(), "{report}"),
        other => panic!("{other:?}"),
    }
    model.sequence += 1;
    model.check(&mut memory);
    memory
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn the_store_is_what_the_model_is(operations in prop::collection::vec(operations(), 1..40)) {
        check(operations);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, ..ProptestConfig::default() })]

    #[test]
    #[ignore = "long"]
    fn long_the_store_is_what_the_model_is(
        operations in prop::collection::vec(operations(), 1..120),
    ) {
        check(operations);
    }
}
