//! Documents conform to their own JSON schemas, whatever numbers they hold.
#![expect(clippy::unwrap_used, reason = "test helpers may panic")]

use message::{
    ActorEvent, ArmState, Health, MemoryChange, ObjectViewHeader, PersonBody, ProcessKind,
    RejectedCandidate, SceneObject, SceneSummary, WireCapsule, WireSurface, document,
};
use recording::documents::{
    ActorEventDocument, ArmDocument, MemoryChangeDocument, ObjectViewDocument, PersonDocument,
};
use scene_document::{Document, schema};
use serde_json::Value;

/// Name of a value's type in JSON schema.
fn type_name(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(number) if number.is_f64() => "number",
        Value::Number(_) => "integer",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    }
}

/// Asserts the keywords of JSON schema that the schemas of documents use.
fn check(value: &Value, schema: &Value, place: &str) {
    // A document or null; the words of an enumeration.
    if let Value::Array(choices) = &schema["anyOf"] {
        let is_null = |schema: &&Value| schema["type"] == "null";
        let choice = choices.iter().find(|one| is_null(one) == value.is_null());
        return check(value, choice.unwrap(), place);
    }
    if let Value::Array(choices) = &schema["oneOf"] {
        assert!(
            choices.iter().any(|one| one["const"] == *value),
            "{place}: {value}"
        );
        return;
    }
    let name = type_name(value);
    let is_allowed = match &schema["type"] {
        Value::Array(types) => types.iter().any(|allowed| allowed == name),
        allowed => allowed == name,
    };
    assert!(is_allowed, "{place}: {value} is no {}", schema["type"]);
    if let Value::Array(items) = value {
        for key in ["minItems", "maxItems"] {
            let n = schema[key].as_u64();
            assert!(n.is_none_or(|n| n == items.len() as u64), "{place}");
        }
        for item in items {
            check(item, &schema["items"], place);
        }
    }
    if let Value::Object(fields) = value {
        for (key, field) in fields {
            check(field, &schema["properties"][key], &format!("{place}.{key}"));
        }
        let required = schema["required"].as_array().into_iter().flatten();
        for key in required {
            let key = key.as_str().unwrap();
            assert!(fields.contains_key(key), "{place} has no {key}");
        }
    }
}

fn check_document<D: Document>(document: &D) {
    check(
        &serde_json::to_value(document).unwrap(),
        schema::<D>().as_value(),
        D::NAME,
    );
}

#[test]
fn documents_with_any_number_conform_to_their_schemas() {
    for number in [0.5, f64::NAN, f64::INFINITY] {
        let capsule = WireCapsule {
            from_m: [number; 3],
            to_m: [number; 3],
            radius_m: number,
        };
        let arm = ArmState {
            opening_m: number,
            joint_angles_rad: [number; 6],
            ..ArmState::default()
        };
        check_document(&ArmDocument::new(&arm, &[capsule]));
        check_document(&PersonDocument::new(&PersonBody::default(), &[capsule]));
        let object = SceneObject {
            distance: number as f32,
            velocity_m_s: [number as f32; 3],
            ..SceneObject::default()
        };
        let mut scene = SceneSummary {
            n_surfaces: 1,
            n_ignored: 1,
            ..SceneSummary::default()
        };
        scene.ignored[0] = RejectedCandidate::default();
        scene.surfaces[0] = WireSurface {
            plane: [number; 4],
            kind: 1,
            n_corners: 1,
            ..WireSurface::default()
        };
        check_document(&document::scene(&scene, &[object], 0));
        let view = ObjectViewHeader {
            distance: number as f32,
            ..ObjectViewHeader::default()
        };
        check_document(&ObjectViewDocument::new(&view, &[number as f32]));
    }
    let health = Health {
        process: ProcessKind::MEMORY.code(),
        ..Health::default()
    };
    check_document(&document::health(&health).unwrap());
    check_document(&ActorEventDocument::from(&ActorEvent::default()));
    check_document(&MemoryChangeDocument::from(&MemoryChange::default()));
}
