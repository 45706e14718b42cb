//! Boxes and labels of the tracked objects.

use super::{WORLD, quaternion, vector};
use foxglove::messages::scene_entity_deletion;
use foxglove::messages::{
    Color, CubePrimitive, Pose, SceneEntity, SceneEntityDeletion, SceneUpdate, TextPrimitive,
    Timestamp,
};
use message::{SceneObject, TrackState};

/// Height of the labels, pixels.
const FONT_PX: f64 = 14.0;
/// Distance of a label from its box, metres.
const LABEL_GAP_M: f64 = 0.03;
/// Opacity of a box that was measured, and of one that was not.
const OPACITIES: [f64; 2] = [0.4, 0.15];

/// Boxes of a scene, in the place of those before.
pub(super) fn update(objects: &[SceneObject], timestamp: Timestamp) -> SceneUpdate {
    let all = SceneEntityDeletion {
        timestamp: Some(timestamp),
        r#type: scene_entity_deletion::Type::All as i32,
        id: String::new(),
    };
    let entity = |object| entity(object, timestamp);
    SceneUpdate {
        deletions: vec![all],
        entities: objects.iter().filter_map(entity).collect(),
    }
}

/// Box of an object; `None` when its pose is impossible.
fn entity(object: &SceneObject, timestamp: Timestamp) -> Option<SceneEntity> {
    object.pose.checked()?;
    let pose = |[x, y, z]: [f64; 3]| Pose {
        position: Some(vector([x, y, z])),
        orientation: Some(quaternion(object.pose.orientation_xyzw)),
    };
    let [x, y, z] = object.pose.position_m;
    let size = object.size_m.map(f64::from);
    let is_measured = TrackState::from_code(object.state) == Some(TrackState::Tracked);
    let largest = size.iter().copied().fold(0.0, f64::max);
    Some(SceneEntity {
        timestamp: Some(timestamp),
        frame_id: WORLD.into(),
        id: object.track_id.to_string(),
        cubes: vec![CubePrimitive {
            pose: Some(pose([x, y, z])),
            size: Some(vector(size)),
            color: Some(color(
                object.mean_argb,
                OPACITIES[usize::from(!is_measured)],
            )),
        }],
        texts: vec![TextPrimitive {
            pose: Some(pose([x, y, z + largest / 2.0 + LABEL_GAP_M])),
            billboard: true,
            font_size: FONT_PX,
            scale_invariant: true,
            color: Some(color(u32::MAX, 1.0)),
            text: format!(
                "{} {}",
                object.track_id,
                object.answer().shown(object.label())
            ),
        }],
        ..SceneEntity::default()
    })
}

fn color(argb: u32, a: f64) -> Color {
    let [_, r, g, b] = argb.to_be_bytes().map(|byte| f64::from(byte) / 255.0);
    Color { r, g, b, a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use message::WirePose;

    #[test]
    fn object_is_a_box_with_its_number_and_label() {
        let object = SceneObject {
            track_id: 7,
            pose: WirePose {
                orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
                ..WirePose::default()
            },
            ..SceneObject::default()
        };
        let impossible = SceneObject::default();
        let update = update(&[object, impossible], Timestamp::MIN);
        assert_eq!((update.deletions.len(), update.entities.len()), (1, 1));
        assert_eq!(update.entities[0].texts[0].text, "7 unknown");
        assert_eq!(update.entities[0].cubes.len(), 1);
    }
}
