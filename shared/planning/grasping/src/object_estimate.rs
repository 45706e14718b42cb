//! Estimate of an object as a whole: contact points of all its sides, centre of mass, mass.

use crate::contact_point::ContactPoint;
use crate::grasp_scene::GraspScene;
use crate::grasp_settings::GraspSettings;
use crate::hand_fit::PackedContact;
use crate::mirror_symmetry::{hidden_side, mirror_plane};
use crate::observed_surface::observed_surface;
use nalgebra::{Point3, Vector3};

/// Share of its bounding box that an object fills.
const FILLED_SHARE: f64 = 0.6;

/// Estimate of an object as a whole.
pub(crate) struct ObjectEstimate {
    pub(crate) contacts: Vec<ContactPoint>,
    pub(crate) packed: Vec<PackedContact>,
    pub(crate) centre_of_mass: Point3<f64>,
    pub(crate) mass_kg: f64,
}

/// Contact points of an object: its stored model, or what is seen with the hidden side by symmetry.
pub fn contact_surface(scene: &GraspScene<'_>, object: usize) -> Vec<ContactPoint> {
    if !scene.objects[object].model.is_empty() {
        return scene.objects[object].model.clone();
    }
    let mut contacts = observed_surface(scene, object);
    if let Some(plane) = mirror_plane(scene, object, &contacts) {
        let hidden = hidden_side(scene, &contacts, &plane);
        contacts.extend(hidden);
    }
    contacts
}

impl ObjectEstimate {
    /// Estimate by contact points.
    pub(crate) fn of(contacts: Vec<ContactPoint>, settings: &GraspSettings) -> Self {
        let (mut low, mut high) = (
            Vector3::repeat(f64::INFINITY),
            Vector3::repeat(f64::NEG_INFINITY),
        );
        let mut sum = Vector3::zeros();
        for contact in &contacts {
            low = low.inf(&contact.position.coords);
            high = high.sup(&contact.position.coords);
            sum += contact.position.coords;
        }
        let volume_m3 = (high - low).product().max(0.0) * FILLED_SHARE;
        Self {
            centre_of_mass: (sum / contacts.len().max(1) as f64).into(),
            mass_kg: volume_m3 * settings.density_kg_m3,
            packed: contacts.iter().map(PackedContact::from).collect(),
            contacts,
        }
    }
}
