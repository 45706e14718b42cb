//! Random variation of a scenario between seeds (domain randomisation).

use crate::action::Action;
use crate::model_choice::ModelChoice;
use crate::random_stream::random_stream;
use crate::scene::{ObjectPlacement, Scene};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use random::Random;
use std::collections::BTreeMap;

/// Random stream of the variation.
const STREAM_VARIATION: u64 = 5;

/// Limits of the random variation of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SceneVariation {
    /// Number of instances to choose from for generated objects; 0 keeps the given ones.
    pub(super) n_instances: u64,
    /// Greatest shift of a position along x and along y, metres.
    pub(super) shift_m: f64,
    /// Greatest rotation of an object about the vertical, radians.
    pub(super) turn_rad: f64,
    /// True if objects that the script does not name swap their positions.
    pub(super) is_shuffled: bool,
}

impl SceneVariation {
    /// Varies a scene by its seed. Objects with the same instance keep a common one.
    pub(super) fn apply(&self, scene: &mut Scene) {
        let mut random = random_stream(scene.seed, STREAM_VARIATION);
        if self.is_shuffled {
            shuffle(scene, &mut random);
        }
        for plan in &mut scene.objects {
            self.vary_placing(&mut plan.placement, &mut random);
        }
        let mut instances = InstanceSubstitution {
            n: self.n_instances,
            chosen: BTreeMap::new(),
        };
        for plan in &mut scene.objects {
            instances.vary(&mut plan.model, &mut random);
        }
        let script = scene.person.iter_mut().flat_map(|plan| &mut plan.script);
        for timed in script {
            match &mut timed.action {
                Action::Put { model, to_m } => {
                    instances.vary(model, &mut random);
                    *to_m = self.shifted(*to_m, &mut random);
                }
                Action::Move { to_m, .. } => *to_m = self.shifted(*to_m, &mut random),
                // The target position is exact: against something, or away from it.
                Action::Slide { .. }
                | Action::Lift { .. }
                | Action::Turn { .. }
                | Action::Hide { .. }
                | Action::Remove { .. } => {}
            }
        }
    }

    fn shifted(&self, place_m: [f64; 2], random: &mut Random) -> [f64; 2] {
        place_m.map(|value| value + random.between(-self.shift_m, self.shift_m))
    }

    fn vary_placing(&self, placing: &mut ObjectPlacement, random: &mut Random) {
        let turn_rad = random.between(-self.turn_rad, self.turn_rad);
        let [dx, dy] = self.shifted([0.0; 2], random);
        match placing {
            ObjectPlacement::Upright {
                position_m: [x, y],
                yaw_rad,
                ..
            } => {
                *x += dx;
                *y += dy;
                *yaw_rad += turn_rad;
            }
            ObjectPlacement::Lowered {
                position_m: [x, y],
                rotation,
            } => {
                *x += dx;
                *y += dy;
                *rotation =
                    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad) * *rotation;
            }
            ObjectPlacement::Dropped { world_from_object } => {
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad);
                world_from_object.append_rotation_wrt_center_mut(&turn);
                world_from_object.append_translation_mut(&Translation3::new(dx, dy, 0.0));
            }
        }
    }
}

/// Substitution of instances, so that equal instances stay equal.
struct InstanceSubstitution {
    n: u64,
    chosen: BTreeMap<(String, u64), u64>,
}

impl InstanceSubstitution {
    fn vary(&mut self, model: &mut ModelChoice, random: &mut Random) {
        if let ModelChoice::Generated { category, instance } = model
            && self.n > 0
        {
            let key = (category.clone(), *instance);
            let chosen = self.chosen.entry(key);
            *instance = *chosen.or_insert_with(|| random.below(self.n as usize) as u64);
        }
    }
}

/// Shuffles the positions of the objects that the script does not name.
fn shuffle(scene: &mut Scene, random: &mut Random) {
    let script = scene.person.iter().flat_map(|plan| &plan.script);
    let named: Vec<usize> = script.filter_map(|timed| timed.action.object()).collect();
    let others: Vec<usize> = (0..scene.objects.len())
        .filter(|index| !named.contains(&(index + 1)))
        .collect();
    for last in (1..others.len()).rev() {
        let (a, b) = (others[last], others[random.below(last + 1)]);
        let placing = scene.objects[a].placement.clone();
        scene.objects[a].placement = std::mem::replace(&mut scene.objects[b].placement, placing);
    }
}
