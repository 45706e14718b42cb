//! Places of the configuration: named areas in which objects are set down.

use geometry::ConvexPolygon;
use nalgebra::{Point2, Point3};
use scene_client::PlanningFrame;
use serde::Deserialize;
use std::collections::BTreeMap;
use tasks::place_of_category;
use transport::PlaceArea;

/// Section of the configuration with the places.
pub const PLACES_SECTION: &str = "places";

/// One place of the configuration.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaceConfig {
    /// Corners seen from above, in their order around the convex area, world, metres.
    pub outline: Vec<[f64; 2]>,
    /// Categories whose objects belong there.
    #[serde(default)]
    pub categories: Vec<String>,
    /// Height of its surface in the world, metres; `None` for the highest one that is seen there.
    pub height_m: Option<f64>,
}

/// All places of the configuration, by name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Places {
    by_name: BTreeMap<String, PlaceConfig>,
}

impl Places {
    /// Places in which each category has one.
    ///
    /// # Errors
    /// A sentence about a category with two places.
    pub fn checked(by_name: BTreeMap<String, PlaceConfig>) -> Result<Self, String> {
        let mut owners = BTreeMap::<&str, &str>::new();
        for (name, place) in &by_name {
            for category in &place.categories {
                if let Some(other) = owners.insert(category, name) {
                    return Err(format!(
                        "the category {category:?} has two places, {other} and {name}; leave it at one"
                    ));
                }
            }
        }
        Ok(Self { by_name })
    }

    /// Places with their names, in alphabetical order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &PlaceConfig)> {
        self.by_name
            .iter()
            .map(|(name, place)| (name.as_str(), place))
    }

    /// Place of a name.
    pub fn get(&self, name: &str) -> Option<&PlaceConfig> {
        self.by_name.get(name)
    }

    /// Name of the place of a category; that of unknown objects for none.
    pub fn of_category(&self, category: Option<&str>) -> Option<&str> {
        let places = self.iter();
        place_of_category(
            places.map(|(name, place)| (name, &*place.categories)),
            category,
        )
    }
}

impl PlaceConfig {
    /// Area of the place in a frame of planning.
    pub fn area(&self, name: &str, frame: &PlanningFrame) -> PlaceArea {
        let plan_from_world = frame.world_from_plan.inverse();
        let height_m = self.height_m.unwrap_or_default();
        let in_plan = |[x, y]: &[f64; 2]| plan_from_world * Point3::new(*x, *y, height_m);
        let mut corners: Vec<Point2<f64>> = self
            .outline
            .iter()
            .map(|corner| in_plan(corner).xy())
            .collect();
        let height_in_plan = || self.outline.first().map(|corner| in_plan(corner).z);
        PlaceArea {
            name: name.to_owned(),
            outline: ConvexPolygon::convex_hull_of(&mut corners),
            height_m: self.height_m.and_then(|_| height_in_plan()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::RigidTransform;

    fn place(categories: &[&str]) -> PlaceConfig {
        PlaceConfig {
            outline: vec![[0.2, 0.0], [0.4, 0.0], [0.4, 0.1]],
            categories: categories.iter().map(|one| (*one).to_owned()).collect(),
            height_m: Some(0.7),
        }
    }

    fn places(named: &[(&str, &[&str])]) -> Result<Places, String> {
        let named = named.iter();
        Places::checked(
            named
                .map(|(name, all)| ((*name).to_owned(), place(all)))
                .collect(),
        )
    }

    #[test]
    fn category_has_one_place_and_unknown_objects_have_theirs() {
        let found = places(&[("shelf", &["mug", "bowl"]), ("unknown", &[])]).unwrap();
        assert_eq!(found.of_category(Some("bowl")), Some("shelf"));
        assert_eq!(found.of_category(Some("spoon")), None);
        assert_eq!(found.of_category(None), Some("unknown"));
        assert_eq!(found.iter().count(), 2);
        let twice = places(&[("shelf", &["mug"]), ("box", &["mug"])]).unwrap_err();
        assert!(twice.contains("mug") && twice.contains("shelf"), "{twice}");
    }

    #[test]
    fn area_is_in_the_frame_of_planning() {
        let frame = PlanningFrame {
            world_from_plan: RigidTransform::translation(0.1, 0.2, 0.5),
            plan_from_camera: RigidTransform::identity(),
            table_in_plan: None,
            notes: Vec::new(),
        };
        let area = place(&[]).area("shelf", &frame);
        assert!((area.height_m.unwrap() - 0.2).abs() < 1e-12);
        assert!(area.outline.contains(&Point2::new(0.25, -0.18)));
        assert!(!area.outline.contains(&Point2::new(0.05, -0.18)));
    }
}
