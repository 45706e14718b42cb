//! Replication tests: snapshot plus change feed give the state of the store.

use std::collections::BTreeMap;

use learning::ViewId;
use perceptual_memory::{Changes, NameChange, PerceptualMemory, Position};

use crate::builders::{apply, correct, folder, forget, key, open, store, teach, view};

/// Reader with its labelled views and position.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Follower {
    pub(crate) names: BTreeMap<ViewId, (String, Vec<f32>)>,
    position: Position,
}

impl Follower {
    /// Loads all pages of a snapshot; `between` runs after each.
    pub(crate) fn load(
        memory: &mut PerceptualMemory,
        max_bytes: usize,
        mut between: impl FnMut(&mut PerceptualMemory),
    ) -> Self {
        let mut follower = Self {
            names: BTreeMap::new(),
            position: memory.position(),
        };
        let mut cursor = None;
        let mut is_first = true;
        loop {
            let page = memory.snapshot(cursor, max_bytes).unwrap();
            if std::mem::take(&mut is_first) {
                follower.position = page.position;
            }
            for known in page.views {
                let what = (known.category.as_str().to_owned(), known.descriptor.values);
                follower.names.insert(known.view, what);
            }
            between(memory);
            cursor = page.next;
            if cursor.is_none() {
                return follower;
            }
        }
    }

    /// Applies all changes; `false` if a new snapshot is needed.
    pub(crate) fn follow(&mut self, memory: &mut PerceptualMemory, max_bytes: usize) -> bool {
        loop {
            let Changes::Entries {
                entries,
                last_sequence,
            } = memory.changes(self.position, max_bytes).unwrap()
            else {
                return false;
            };
            for entry in entries {
                assert_eq!(entry.sequence, self.position.sequence + 1, "no gap");
                self.position.sequence = entry.sequence;
                self.apply(entry.names);
            }
            if self.position.sequence == last_sequence {
                return true;
            }
        }
    }

    fn apply(&mut self, names: Vec<NameChange>) {
        for change in names {
            match change {
                NameChange::Assigned(known) => {
                    let what = (known.category.as_str().to_owned(), known.descriptor.values);
                    self.names.insert(known.view, what);
                }
                NameChange::Unassigned(view) => {
                    self.names.remove(&view);
                }
            }
        }
    }
}

fn ten_tracks() -> (tempfile::TempDir, PerceptualMemory) {
    let folder = folder();
    let (mut memory, _) = open(&folder);
    for track in 1..=10 {
        let views = (0..3).map(|i| view(track, i, 0)).collect();
        apply(&mut memory, &[store(track as u128, views)]);
        if track % 3 != 0 {
            let category = if track < 5 { "Mug" } else { "Bowl" };
            apply(&mut memory, &[teach(100 + track as u128, track, category)]);
        }
    }
    (folder, memory)
}

#[test]
fn snapshot_pages_hold_every_labelled_view_once() {
    let (_folder, mut memory) = ten_tracks();
    for max_bytes in [0, 1, 700, usize::MAX] {
        let mut n_pages = 0;
        let follower = Follower::load(&mut memory, max_bytes, |_| n_pages += 1);
        assert_eq!(follower.names.len(), 21);
        assert!(
            follower
                .names
                .iter()
                .all(|(view, _)| view.track_id % 3 != 0)
        );
        assert_eq!(
            follower.names[&key(4, 1)].1,
            view(4, 1, 0).descriptor.values
        );
        assert!(
            (max_bytes == usize::MAX) == (n_pages == 1),
            "{n_pages} pages of {max_bytes}"
        );
    }
}

#[test]
fn change_feed_catches_up_after_a_concurrent_snapshot() {
    for max_bytes in [0, 700, usize::MAX] {
        let (_folder, mut memory) = ten_tracks();
        let mut changes = vec![
            forget(200, "Mug"),
            correct(201, 10, "Cup"),
            teach(202, 3, "Mug"),
            store(203, vec![view(2, 7, 0)]),
            correct(204, 1, "Cup"),
            correct(205, 5, "Mug"),
            forget(206, "Bowl"),
            teach(207, 2, "Bowl"),
        ]
        .into_iter();
        let mut follower = Follower::load(&mut memory, max_bytes, |memory| {
            if let Some(change) = changes.next() {
                memory.apply(&change).unwrap();
            }
        });
        for change in changes {
            memory.apply(&change).unwrap();
        }
        assert!(follower.follow(&mut memory, max_bytes));
        let fresh = Follower::load(&mut memory, usize::MAX, |_| {});
        assert_eq!(follower, fresh);
        // Applied once more from the beginning, the changes lead to the same state.
        let mut again = Follower {
            position: Position {
                sequence: 0,
                ..follower.position
            },
            ..follower.clone()
        };
        assert!(again.follow(&mut memory, max_bytes));
        assert_eq!(again, fresh);
    }
}

#[test]
fn change_feed_position_of_another_store_or_ahead_means_reload() {
    let (_folder, mut memory) = ten_tracks();
    let now = memory.position();
    let ahead = Position {
        sequence: now.sequence + 1,
        ..now
    };
    assert_eq!(memory.changes(ahead, 1).unwrap(), Changes::Reload);
    let (_other_folder, other) = ten_tracks();
    assert_ne!(other.store_id(), memory.store_id());
    assert_eq!(
        memory.changes(other.position(), 1).unwrap(),
        Changes::Reload
    );
    let nothing = Changes::Entries {
        entries: vec![],
        last_sequence: now.sequence,
    };
    assert_eq!(memory.changes(now, 1).unwrap(), nothing);
}
