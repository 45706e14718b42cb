//! Feedback of lessons: what teaching and correcting show about the answers that were given.

use learning::{CategoryIndex, CategoryName, Feedback};
use std::collections::{BTreeMap, BTreeSet};

/// Reader of lessons that counts each track once for each category that it was taught as.
#[derive(Debug, Clone, Default)]
pub struct LessonFeedback {
    /// Categories that tracks were taught as last.
    taught: BTreeMap<u64, CategoryName>,
    /// Named tracks that were left as they were.
    uncorrected: BTreeSet<u64>,
}

impl LessonFeedback {
    /// Feedback of the lessons between two states of the taught views, given the labels of the
    /// tracks before them, by track-id.
    ///
    /// A track that was taught a category is known if that category was known before, and was
    /// given a false name if it was named without that. A named track that is not corrected while
    /// another one is was named rightly. Names that a person has given the track, and those that
    /// cease to exist, as by a renaming, show nothing.
    pub fn read(
        &mut self,
        labels: &BTreeMap<u64, Option<&CategoryName>>,
        before: &CategoryIndex,
        after: &CategoryIndex,
    ) -> Vec<Feedback> {
        self.taught.retain(|id, _| labels.contains_key(id));
        self.uncorrected.retain(|id| labels.contains_key(id));
        let mut feedback = Vec::new();
        let mut is_corrected = false;
        for (id, category) in after.taught_since(before) {
            let Some(label) = labels.get(&id) else {
                continue;
            };
            let earlier = self.taught.insert(id, category.clone());
            let is_own_name = earlier.is_some() && earlier.as_ref() == *label;
            if earlier.as_ref() == Some(&category)
                || is_own_name
                || label.is_some_and(|label| !after.contains(label))
            {
                continue;
            }
            feedback.extend(match (label, before.contains(&category)) {
                (_, true) => Some(Feedback::Known),
                (Some(_), false) => Some(Feedback::FalseName),
                (None, false) => None,
            });
            is_corrected = true;
        }
        if is_corrected {
            self.add_uncorrected(labels, &mut feedback);
        }
        feedback
    }

    /// Adds the named tracks that were neither taught nor counted yet.
    fn add_uncorrected(
        &mut self,
        labels: &BTreeMap<u64, Option<&CategoryName>>,
        feedback: &mut Vec<Feedback>,
    ) {
        for (&id, label) in labels {
            let is_named = label.is_some() && !self.taught.contains_key(&id);
            if is_named && self.uncorrected.insert(id) {
                feedback.push(Feedback::Known);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::category_index;
    use learning::ViewId;

    fn name(text: &str) -> CategoryName {
        CategoryName::new(text).unwrap()
    }

    fn taught(index: &CategoryIndex, track_id: u64, category: &str) -> CategoryIndex {
        let mut index = index.clone();
        let descriptor = vec![0.1; index.dimension()];
        let view = ViewId {
            track_id,
            view_id: 0,
        };
        index.insert(view, &name(category), &descriptor).unwrap();
        index
    }

    /// Feedback of one lesson to a memory with one mug, where track 1 is named a mug, track 2 has
    /// this label and is taught.
    fn of_lesson(label: Option<&str>, category: &str) -> Vec<Feedback> {
        let before = taught(&category_index(), 9, "mug");
        let after = taught(&before, 2, category);
        let (mug, label) = (name("mug"), label.map(name));
        let labels = BTreeMap::from([(1, Some(&mug)), (2, label.as_ref())]);
        LessonFeedback::default().read(&labels, &before, &after)
    }

    #[test]
    fn lessons_tell_known_objects_from_false_names() {
        use Feedback::{FalseName, Known};
        assert_eq!(of_lesson(None, "mug"), [Known, Known]);
        assert_eq!(of_lesson(Some("mug"), "bowl"), [FalseName, Known]);
        // An unknown object that is new was answered rightly.
        assert_eq!(of_lesson(None, "bowl"), [Known]);
        // A name that is no more was renamed.
        assert_eq!(of_lesson(Some("cup"), "bowl"), []);
    }

    #[test]
    fn correcting_the_own_lesson_shows_nothing() {
        let before = taught(&category_index(), 2, "jar");
        let after = taught(&before, 2, "soda can");
        let jar = name("jar");
        let labels = BTreeMap::from([(2, Some(&jar))]);
        let mut feedback = LessonFeedback::default();
        assert_eq!(feedback.read(&labels, &before, &after), []);
        // Nor where another object has the name that was wrong.
        let untaught = taught(&category_index(), 3, "jar");
        let before = taught(&untaught, 2, "jar");
        let after = taught(&before, 2, "soda can");
        let mut feedback = LessonFeedback::default();
        let unlabelled = BTreeMap::from([(2, None)]);
        assert_eq!(
            feedback.read(&unlabelled, &untaught, &before),
            [Feedback::Known]
        );
        assert_eq!(feedback.read(&labels, &before, &after), []);
    }

    #[test]
    fn each_track_counts_once_for_a_category() {
        let before = taught(&category_index(), 9, "mug");
        let after = taught(&before, 2, "mug");
        let later = taught(&after, 2, "mug");
        let mug = name("mug");
        let labels = BTreeMap::from([(1, Some(&mug)), (2, None)]);
        let mut feedback = LessonFeedback::default();
        assert_eq!(feedback.read(&labels, &before, &after).len(), 2);
        assert_eq!(feedback.read(&labels, &after, &later), []);
        // Nothing changed.
        assert_eq!(feedback.read(&labels, &later, &later), []);
    }
}
