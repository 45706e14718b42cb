use super::*;
use proptest::prelude::*;

/// Test views with the numbers of their categories.
type NumberedViews = Vec<(ViewId, Option<u8>)>;

fn name(number: u8) -> CategoryName {
    CategoryName::new(&format!("category {number}")).unwrap()
}

fn memory() -> impl Strategy<Value = NumberedViews> {
    let view = (0_u64..4, prop::option::of(0_u8..3));
    prop::collection::vec(view, 0..30).prop_map(|views| {
        let id = |(i, (track_id, category))| {
            (
                ViewId {
                    track_id,
                    view_id: i,
                },
                category,
            )
        };
        (0..).zip(views).map(id).collect()
    })
}

fn named(memory: &NumberedViews) -> Vec<(ViewId, Option<CategoryName>)> {
    memory
        .iter()
        .map(|&(id, category)| (id, category.map(name)))
        .collect()
}

fn records(
    views: &[(ViewId, Option<CategoryName>)],
) -> impl Iterator<Item = ViewLabel<'_>> + Clone {
    views.iter().map(|(id, category)| ViewLabel {
        id: *id,
        category: category.as_ref(),
    })
}

/// Applies label changes and checks that each starts from the present label.
fn apply(views: &mut [(ViewId, Option<CategoryName>)], changes: &[LabelChange]) {
    for change in changes {
        let (_, category) = views.iter_mut().find(|(id, _)| *id == change.id).unwrap();
        assert_eq!(*category, change.before);
        assert_ne!(change.before, change.after);
        category.clone_from(&change.after);
    }
}

proptest! {
    #[test]
    fn a_corrected_track_is_in_one_category_and_others_stay(memory in memory(), track_id in 0_u64..4) {
        let before = named(&memory);
        let mut after = before.clone();
        let exists = before.iter().any(|(id, _)| id.track_id == track_id);
        match correct(records(&before), track_id, &name(0)) {
            Ok(changes) => apply(&mut after, &changes),
            Err(refusal) => {
                prop_assert!(!exists);
                prop_assert_eq!(refusal, TeachingError::NoViews { track_id });
            }
        }
        for ((id, old), (_, new)) in before.iter().zip(&after) {
            let expected = if id.track_id == track_id { Some(name(0)) } else { old.clone() };
            prop_assert_eq!(new, &expected);
        }
        if exists {
            prop_assert_eq!(correct(records(&after), track_id, &name(0)), Ok(vec![]));
        }
    }

    #[test]
    fn teaching_is_correcting_unless_there_is_another_label(memory in memory(), track_id in 0_u64..4) {
        let views = named(&memory);
        let present = memory
            .iter()
            .find(|(id, category)| id.track_id == track_id && category.is_some_and(|c| c != 0));
        let taught = teach(records(&views), track_id, &name(0));
        if let Some(&(_, Some(present))) = present {
            let (present, asked) = (name(present), name(0));
            prop_assert_eq!(taught, Err(TeachingError::LabelConflict { track_id, present, asked }));
        } else {
            prop_assert_eq!(taught, correct(records(&views), track_id, &name(0)));
        }
    }

    #[test]
    fn a_forgotten_category_has_no_views(memory in memory()) {
        let before = named(&memory);
        let mut after = before.clone();
        match forget(records(&before), &name(1)) {
            Ok(changes) => apply(&mut after, &changes),
            Err(refusal) => {
                prop_assert_eq!(refusal, TeachingError::UnknownCategory { category: name(1) });
            }
        }
        for ((_, old), (_, new)) in before.iter().zip(&after) {
            prop_assert_eq!(new, &old.clone().filter(|category| *category != name(1)));
        }
    }
}

#[test]
fn error_messages_name_the_remedy() {
    let (mug, cup) = (
        CategoryName::new("mug").unwrap(),
        CategoryName::new("cup").unwrap(),
    );
    let views = [(
        ViewId {
            track_id: 7,
            view_id: 0,
        },
        Some(mug.clone()),
    )];
    let check = |refusal: TeachingError, expected: &str| {
        let sentence = refusal.to_string();
        assert!(sentence.contains(expected), "{sentence}");
    };
    check(
        teach(records(&views), 8, &mug).unwrap_err(),
        "teach it again",
    );
    check(
        teach(records(&views), 7, &cup).unwrap_err(),
        "correct it if cup is right",
    );
    check(
        forget(records(&views), &cup).unwrap_err(),
        "list the categories",
    );
}
