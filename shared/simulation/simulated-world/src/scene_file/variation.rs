//! What differs from seed to seed while a story stays the same.

use crate::chance;
use crate::person::Action;
use crate::scene::{ModelChoice, Placing, Scene};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use random::Random;
use std::collections::BTreeMap;

/// Purpose of the random stream.
const VARY: u64 = 5;

/// How much a scene may differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Variation {
    /// Generated objects become one of so many instances; 0 leaves them.
    pub(super) n_instances: u64,
    /// Farthest shift of a place along x and along y, metres.
    pub(super) shift_m: f64,
    /// Greatest turn of an object about the vertical, radians.
    pub(super) turn_rad: f64,
    /// Whether objects that the script does not name change their places.
    pub(super) is_shuffled: bool,
}

impl Variation {
    /// Varies a scene by its seed. Objects that are alike stay alike.
    pub(super) fn apply(&self, scene: &mut Scene) {
        let mut random = chance::stream(scene.seed, VARY);
        if self.is_shuffled {
            shuffle(scene, &mut random);
        }
        for plan in &mut scene.objects {
            self.vary_placing(&mut plan.placing, &mut random);
        }
        let mut instances = Instances {
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
                // Where it ends is meant exactly: against something, or away from it.
                Action::Slide { .. }
                | Action::Lift { .. }
                | Action::Hide { .. }
                | Action::Remove { .. } => {}
            }
        }
    }

    fn shifted(&self, place_m: [f64; 2], random: &mut Random) -> [f64; 2] {
        place_m.map(|value| value + random.between(-self.shift_m, self.shift_m))
    }

    fn vary_placing(&self, placing: &mut Placing, random: &mut Random) {
        let turn_rad = random.between(-self.turn_rad, self.turn_rad);
        let [dx, dy] = self.shifted([0.0; 2], random);
        match placing {
            Placing::Upright {
                position_m: [x, y],
                yaw_rad,
            } => {
                *x += dx;
                *y += dy;
                *yaw_rad += turn_rad;
            }
            Placing::Dropped { world_from_object } => {
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad);
                world_from_object.append_rotation_wrt_center_mut(&turn);
                world_from_object.append_translation_mut(&Translation3::new(dx, dy, 0.0));
            }
        }
    }
}

/// Which instance stands for which, so that alike objects stay alike.
struct Instances {
    n: u64,
    chosen: BTreeMap<(String, u64), u64>,
}

impl Instances {
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

/// Objects that the script does not name change their places among each other.
fn shuffle(scene: &mut Scene, random: &mut Random) {
    let script = scene.person.iter().flat_map(|plan| &plan.script);
    let named: Vec<usize> = script.filter_map(|timed| timed.action.object()).collect();
    let others: Vec<usize> = (0..scene.objects.len())
        .filter(|index| !named.contains(&(index + 1)))
        .collect();
    for last in (1..others.len()).rev() {
        let (a, b) = (others[last], others[random.below(last + 1)]);
        let placing = scene.objects[a].placing.clone();
        scene.objects[a].placing = std::mem::replace(&mut scene.objects[b].placing, placing);
    }
}
