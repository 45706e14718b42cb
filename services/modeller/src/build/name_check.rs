//! Check of the name of a new model: against what the object is recognised as, and against the size
//! of an earlier model of that name.

use crate::object_receiver::TrackedObject;
use control_client::MemoryClient;
use control_protocol::{DocumentKind, DocumentName};
use message::CategoryAnswer;
use nalgebra::Vector2;
use object_model::ObjectModel;
use service::{CommonArguments, Failure, exit_code};

/// Ratios of heights and of widths from which on two sizes contradict each other. Chosen: what one
/// view shows of an object, and how its box is turned, makes less.
const HEIGHT_RATIO_MAX: f64 = 1.5;
const WIDTH_RATIO_MAX: f64 = 2.0;
/// Difference that never contradicts, metres. Chosen: flat things have few pixels.
const DIFFERENCE_MIN_M: f64 = 0.02;

/// Size of an object as it stands, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
struct StandingSize {
    /// Greatest horizontal extent.
    width_m: f64,
    height_m: f64,
}

/// Name of the model of an object: the given one, its label, or its track-id.
///
/// # Errors
/// If no name is given and the label is only probable.
pub(super) fn chosen_name(given: Option<&str>, object: &TrackedObject) -> Result<String, Failure> {
    let track = object.track;
    match (given, &object.label) {
        (Some(name), _) => Ok(name.to_owned()),
        (None, None) => Ok(format!("track-{track}")),
        (None, Some(label)) if object.answer == CategoryAnswer::Probably => {
            let sure = sure(object);
            let sentence = format!(
                "object {track} is only probably {label}{sure}, so that no model {label:?} is made \
                 of it unasked; name the model with --name, or teach the label with `tabula teach \
                 {track} NAME`"
            );
            Err(Failure::new(exit_code::REFUSED, sentence))
        }
        (None, Some(label)) => Ok(label.clone()),
    }
}

/// Probability of the label in brackets; empty when it is not known.
fn sure(object: &TrackedObject) -> String {
    object.probability.map_or_else(String::new, |probability| {
        format!(" ({:.0} % sure)", 100.0 * probability)
    })
}

/// Refuses a name that the object contradicts.
///
/// # Errors
/// If the object is recognised as something that the name does not say, or an earlier model of the
/// name has another size.
pub(super) fn check_name(
    common: &CommonArguments,
    name: &str,
    object: &TrackedObject,
) -> Result<(), Failure> {
    if let Some(sentence) = other_label(name, object) {
        return Err(Failure::new(exit_code::REFUSED, sentence));
    }
    // What cannot be read contradicts nothing; the store tells at the end if it does not answer.
    let earlier = earlier_model(common, name).ok().flatten();
    match earlier.and_then(|model| other_size(name, object, StandingSize::of_model(&model))) {
        Some(sentence) => Err(Failure::new(exit_code::REFUSED, sentence)),
        None => Ok(()),
    }
}

/// Model that is stored under the name; `None` where there is none.
fn earlier_model(common: &CommonArguments, name: &str) -> Result<Option<ObjectModel>, Failure> {
    let mut memory = MemoryClient::open(common)?;
    let kind = DocumentKind::ObjectModel;
    let stored = memory.documents(kind)?;
    if !stored.iter().any(|report| report.document.name == name) {
        return Ok(None);
    }
    let name = name.to_owned();
    let content = memory.document(&DocumentName { kind, name })?.content;
    let model = ObjectModel::from_bytes(&content).map_err(Failure::general)?;
    Ok(Some(model))
}

/// Sentence about an object with another label than the name says; `None` where one is a part of
/// the other, as in "blue mug" for a mug, or the label is only probable.
fn other_label(name: &str, object: &TrackedObject) -> Option<String> {
    let certain = (object.answer == CategoryAnswer::Is).then_some(object.label.as_deref());
    let label = certain.flatten()?;
    let [lower_name, lower_label] = [name, label].map(str::to_lowercase);
    if lower_name.contains(&lower_label) || lower_label.contains(&lower_name) {
        return None;
    }
    let (track, sure) = (object.track, sure(object));
    Some(format!(
        "object {track} is recognised as {label}{sure}, so that no model {name:?} is made of it; \
         leave --name out, or correct the label with `tabula correct {track} NAME`, or add \
         --anyway to name the model so all the same"
    ))
}

/// Sentence about an object whose size is not that of the earlier model of the name.
fn other_size(name: &str, object: &TrackedObject, earlier: StandingSize) -> Option<String> {
    let present = StandingSize::of_box(object.size_m);
    let differ = |a: f64, b: f64, ratio: f64| {
        a.max(b) > ratio * a.min(b) && (a - b).abs() > DIFFERENCE_MIN_M
    };
    let is_other = differ(present.height_m, earlier.height_m, HEIGHT_RATIO_MAX)
        || differ(present.width_m, earlier.width_m, WIDTH_RATIO_MAX);
    is_other.then(|| {
        let track = object.track;
        format!(
            "object {track} is {}, and the stored model {name:?} is {}, so that they are hardly \
             the same; give another name with --name, or add --anyway to replace the model, which \
             stays as an earlier version",
            present.in_words(),
            earlier.in_words()
        )
    })
}

impl StandingSize {
    /// Size of an upright box with these sides.
    fn of_box([x, y, z]: [f32; 3]) -> Self {
        Self {
            width_m: x.max(y).into(),
            height_m: z.into(),
        }
    }

    /// Size of a model, whose z axis points upwards, however it is turned about it.
    fn of_model(model: &ObjectModel) -> Self {
        let [_, _, height_m] = model.summary().extents_m;
        let vertices = model.mesh.vertices.iter();
        let flat: Vec<Vector2<f64>> = vertices
            .map(|vertex| vertex.position.coords.xy().cast())
            .collect();
        let middle = flat.iter().sum::<Vector2<f64>>() / flat.len().max(1) as f64;
        let radius_m = flat.iter().map(|point| (point - middle).norm());
        Self {
            width_m: 2.0 * radius_m.fold(0.0, f64::max),
            height_m,
        }
    }

    fn in_words(self) -> String {
        let [width_mm, height_mm] = [self.width_m, self.height_m].map(|m| 1e3 * m);
        format!("{width_mm:.0} mm wide and {height_mm:.0} mm high")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(label: Option<&str>, size_m: [f32; 3]) -> TrackedObject {
        TrackedObject {
            track: 3,
            label: label.map(str::to_owned),
            answer: CategoryAnswer::of(label.is_some(), Some(0.92)),
            probability: Some(0.92),
            size_m,
            is_seen: true,
        }
    }

    #[test]
    fn name_that_recognition_contradicts_is_refused_with_what_to_do() {
        let told = |name, label| other_label(name, &object(label, [0.066, 0.066, 0.12]));
        for (name, label) in [
            ("teapot", None),
            ("soda can", Some("soda can")),
            ("my Soda Can", Some("soda can")),
            ("can", Some("soda can")),
        ] {
            assert_eq!(told(name, label), None, "{name} {label:?}");
        }
        let sentence = told("teapot", Some("soda can")).unwrap();
        for part in [
            "recognised as soda can (92 % sure)",
            "correct 3",
            "--anyway",
        ] {
            assert!(sentence.contains(part), "{sentence}");
        }
    }

    #[test]
    fn probable_label_neither_names_a_model_nor_contradicts_a_name() {
        let probable = TrackedObject {
            answer: CategoryAnswer::Probably,
            ..object(Some("soda can"), [0.066, 0.066, 0.12])
        };
        assert_eq!(other_label("teapot", &probable), None);
        assert_eq!(chosen_name(Some("teapot"), &probable).unwrap(), "teapot");
        let refused = chosen_name(None, &probable).unwrap_err().to_string();
        assert!(
            refused.contains("only probably soda can (92 % sure)"),
            "{refused}"
        );
        assert!(refused.contains("teach 3"), "{refused}");
        let unknown = object(None, [0.1; 3]);
        assert_eq!(chosen_name(None, &unknown).unwrap(), "track-3");
    }

    #[test]
    fn name_of_a_model_of_another_size_is_refused_with_what_to_do() {
        let told = |size_m, width_m, height_m| {
            let earlier = StandingSize { width_m, height_m };
            other_size("teapot", &object(None, size_m), earlier)
        };
        let can = [0.066, 0.05, 0.12];
        assert_eq!(told(can, 0.066, 0.115), None);
        // Turned by 45°, and its lower part hidden.
        assert_eq!(told(can, 0.094, 0.09), None);
        // A coin.
        assert_eq!(told([0.02, 0.02, 0.004], 0.02, 0.01), None);
        for (width_m, height_m) in [(0.21, 0.13), (0.066, 0.25), (0.03, 0.12)] {
            let sentence = told(can, width_m, height_m).unwrap();
            for part in ["66 mm wide and 120 mm high", "--name", "--anyway"] {
                assert!(sentence.contains(part), "{sentence}");
            }
        }
    }
}
