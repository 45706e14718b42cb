//! Questions to a person about an object, by which a lesson would help most.

use scene_document::{CategoryAnswer, NearCategoryDocument, ObjectDocument, TrackState};
use serde::{Deserialize, Serialize};

/// Probability of the best category below which an unknown object is taken for a new one, and not
/// for a new side of a known one. `evaluate cross-validation --protocol other-side` separates the
/// two best between 0.2 and 0.3.
const NEW_OBJECT_MAX: f64 = 0.25;

/// Least number of described views of an object that is asked about: it has come to rest. Chosen.
const N_VIEWS_MIN: u32 = 5;

/// Greatest speed of an object that is asked about, metres per second. Chosen.
const SPEED_MAX_M_S: f64 = 0.05;

/// Kind of a question about an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum QuestionKind {
    /// It is like nothing that was taught.
    NewObject,
    /// It is unknown, and has some likeness with a taught category: a new side of it, or another
    /// object.
    NewSide,
    /// It is probably of the category that is its label.
    UnsureLabel,
}

impl QuestionKind {
    /// Kind of the question about an unknown object, given the probability of its best category.
    pub fn of_unknown(probability: f64) -> Self {
        if probability < NEW_OBJECT_MAX {
            Self::NewObject
        } else {
            Self::NewSide
        }
    }
}

/// Question to a person about the object whose name would teach most.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QuestionReport {
    /// Track-id of the object.
    pub track_id: u64,
    /// Kind of the question.
    pub kind: QuestionKind,
    /// Probability that the best category is wrong, 0 to 1: the worth of an answer.
    pub uncertainty: f64,
    /// Most probable categories, best first.
    pub categories: Vec<NearCategoryDocument>,
    /// Centre of the object's box in the world, metres.
    pub position_m: [f64; 3],
    /// The question as a sentence.
    pub sentence: String,
}

/// Answer to [`Command::Question`](crate::Command::Question).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct QuestionsReport {
    /// Question that would help most; null when all objects in view are known, or none is.
    pub question: Option<QuestionReport>,
}

impl QuestionReport {
    /// Question about the object whose best category is least sure, if a lesson about one of the
    /// objects would teach anything. Objects that are not in full view and at rest are left out.
    ///
    /// *Source*: uncertainty sampling by least confidence, Lewis and Gale, "A sequential algorithm
    /// for training text classifiers", 1994.
    pub fn most_useful<'a>(objects: impl IntoIterator<Item = &'a ObjectDocument>) -> Option<Self> {
        let questions = objects.into_iter().filter_map(Self::about);
        questions.max_by(|a, b| {
            let by_uncertainty = a.uncertainty.total_cmp(&b.uncertainty);
            // The older track of two that are equally unknown.
            by_uncertainty.then(b.track_id.cmp(&a.track_id))
        })
    }

    /// Question about one object; `None` when it is known, or cannot be seen well.
    fn about(object: &ObjectDocument) -> Option<Self> {
        let speed_m_s = object.velocity_m_s.map_or(0.0, |v| {
            v.iter().map(|part| part * part).sum::<f64>().sqrt()
        });
        let is_well_seen = object.state == TrackState::Tracked.word()
            && !object.cut_by_image
            && object.n_views >= N_VIEWS_MIN
            && speed_m_s < SPEED_MAX_M_S;
        let best = object.categories.first();
        let probability = best.map_or(0.0, |near| near.probability);
        let kind = match &object.label {
            Some(_) if probability >= CategoryAnswer::IS_PROBABILITY_MIN => return None,
            Some(_) => QuestionKind::UnsureLabel,
            None => QuestionKind::of_unknown(probability),
        };
        is_well_seen.then(|| Self {
            track_id: object.track_id,
            kind,
            uncertainty: 1.0 - probability,
            sentence: sentence(object, kind),
            categories: object.categories.clone(),
            position_m: object.position_m,
        })
    }
}

fn sentence(object: &ObjectDocument, kind: QuestionKind) -> String {
    let track = object.track_id;
    let [x, y, z] = object.position_m;
    let place = format!("track {track} at ({x:.2} {y:.2} {z:.2})");
    let best = object.categories.first();
    let best = best.map_or_else(String::new, |near| {
        format!("{} ({:.0} %)", near.label, 100.0 * near.probability)
    });
    match kind {
        QuestionKind::NewObject if best.is_empty() => format!("what is {place}?"),
        QuestionKind::NewObject => {
            format!("what is {place}? It looks like nothing that was taught; the nearest is {best}")
        }
        QuestionKind::NewSide => {
            format!("what is {place}? It may be a new side of {best}, or a new object")
        }
        QuestionKind::UnsureLabel => format!("is {place} really {best}?"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(track_id: u64, label: Option<&str>, probable: &[(&str, f64)]) -> ObjectDocument {
        let near = |&(label, probability): &(&str, f64)| NearCategoryDocument {
            label: label.to_owned(),
            distance: 0.4,
            probability,
        };
        ObjectDocument {
            track_id,
            state: TrackState::Tracked.word().to_owned(),
            label: label.map(str::to_owned),
            position_m: [0.1, 0.2, 0.8],
            n_views: 40,
            categories: probable.iter().map(near).collect(),
            ..ObjectDocument::default()
        }
    }

    #[test]
    fn question_is_about_the_least_certain_object() {
        let objects = [
            object(1, Some("mug"), &[("mug", 0.97)]),
            object(2, None, &[("mug", 0.4), ("bowl", 0.2)]),
            object(3, None, &[("bowl", 0.05)]),
            object(4, Some("bowl"), &[("bowl", 0.6)]),
        ];
        let asked = QuestionReport::most_useful(&objects).unwrap();
        assert_eq!((asked.track_id, asked.kind), (3, QuestionKind::NewObject));
        let asked = QuestionReport::most_useful(&objects[..2]).unwrap();
        assert_eq!((asked.track_id, asked.kind), (2, QuestionKind::NewSide));
        assert!(
            asked.sentence.contains("new side of mug (40 %)"),
            "{asked:?}"
        );
        let asked = QuestionReport::most_useful(&objects[3..]).unwrap();
        assert_eq!(asked.kind, QuestionKind::UnsureLabel);
        assert_eq!(QuestionReport::most_useful(&objects[..1]), None);
        assert_eq!(QuestionReport::most_useful(&[]), None);
    }

    #[test]
    fn question_before_any_lesson_is_about_the_oldest_object() {
        let objects = [object(7, None, &[]), object(5, None, &[])];
        let asked = QuestionReport::most_useful(&objects).unwrap();
        assert_eq!(asked.track_id, 5);
        assert_eq!(asked.sentence, "what is track 5 at (0.10 0.20 0.80)?");
    }

    #[test]
    fn question_leaves_out_what_is_moving_new_cut_or_out_of_view() {
        let unknown = object(1, None, &[]);
        let hidden = [
            ObjectDocument {
                state: "occluded".into(),
                ..unknown.clone()
            },
            ObjectDocument {
                cut_by_image: true,
                ..unknown.clone()
            },
            ObjectDocument {
                n_views: 2,
                ..unknown.clone()
            },
            ObjectDocument {
                velocity_m_s: Some([0.0, 0.2, 0.0]),
                ..unknown.clone()
            },
        ];
        assert_eq!(QuestionReport::most_useful(&hidden), None);
        assert!(QuestionReport::most_useful([&unknown]).is_some());
    }
}
