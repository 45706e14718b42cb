//! Views of a data set in metres: their unit is given, known by the layout, or guessed from their
//! sizes.

use crate::parallel;
use dataset::object_views::{ObjectView, ObjectViews, ViewFile};
use indicatif::ProgressBar;
use nalgebra::Vector3;
use simulated_world::ModelUnit;
use std::collections::BTreeMap;

/// Views of a data set in metres, of the size of objects on a table.
pub(crate) struct MetricViews<'a> {
    views: &'a ObjectViews,
    /// Unit of the views of each category.
    units: BTreeMap<&'a str, ModelUnit>,
    /// Sentences about units that were guessed.
    notes: Vec<String>,
}

impl<'a> MetricViews<'a> {
    /// Views with the given unit. Without one it is guessed for each category, whose views are
    /// taken to have one unit, from the median of their longest sides; for this all views are
    /// read.
    pub(crate) fn new(views: &'a ObjectViews, given: Option<ModelUnit>, bar: &ProgressBar) -> Self {
        let known = views.is_unit_known().then_some(ModelUnit::Metre);
        let (mut units, mut notes) = (BTreeMap::new(), Vec::new());
        let is_same = |a: &ViewFile, b: &ViewFile| a.category == b.category;
        let mut start = 0;
        for of_category in views.files().chunk_by(is_same) {
            let category = of_category[0].category.as_str();
            let unit = given.or(known).unwrap_or_else(|| {
                let sides = longest_sides(views, start, of_category.len(), bar);
                let (unit, note) = guessed(category, &sides);
                notes.extend(note);
                unit
            });
            units.insert(category, unit);
            start += of_category.len();
        }
        Self {
            views,
            units,
            notes,
        }
    }

    /// Sentences about units that were guessed.
    pub(crate) fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Reads a view by its index among the files of the data set, its points in metres.
    ///
    /// # Errors
    /// A sentence when it cannot be read, or has not the size of an object on a table.
    pub(crate) fn load(&self, index: usize) -> Result<ObjectView, String> {
        let mut view = self.views.load(index).map_err(|error| error.to_string())?;
        let file = &self.views.files()[index];
        let unit = self.units.get(file.category.as_str());
        let unit = unit.copied().unwrap_or(ModelUnit::Metre);
        unit.check(extent(&view).max() as f32)
            .map_err(|sentence| format!("the view {}: {sentence}", file.path.display()))?;
        // Metres stay as they are, to the bit.
        if unit != ModelUnit::Metre {
            for point in &mut view.points {
                point.x *= unit.metres();
                point.y *= unit.metres();
                point.z *= unit.metres();
            }
            view.viewpoint_m = view.viewpoint_m.map(|at| at * f64::from(unit.metres()));
        }
        Ok(view)
    }
}

/// Longest sides of the views of a category that can be read.
fn longest_sides(views: &ObjectViews, start: usize, n: usize, bar: &ProgressBar) -> Vec<f64> {
    let longest = |(): &mut (), place| views.load(start + place).map(|view| extent(&view).max());
    let sides = parallel::map(n, bar, || (), longest);
    sides.into_iter().flatten().collect()
}

/// Unit that the views of a category suggest, and a sentence unless it is surely metres. Without a
/// suggestion it is metres, in which each view is then refused.
fn guessed(category: &str, longest_sides: &[f64]) -> (ModelUnit, Option<String>) {
    let mut sides = longest_sides.to_vec();
    sides.sort_by(f64::total_cmp);
    let Some(&median) = sides.get(sides.len() / 2) else {
        return (ModelUnit::Metre, None);
    };
    match ModelUnit::suggested_by(median as f32) {
        Some(unit) if !ModelUnit::is_surely_metre(median as f32) => {
            let sentence = format!(
                "the views of {category}: the median of their longest sides is {median:.3}; they \
                 were taken to be in {} (give the unit if it is another)",
                unit.plural()
            );
            (unit, Some(sentence))
        }
        unit => (unit.unwrap_or(ModelUnit::Metre), None),
    }
}

/// Side lengths of the axis-aligned bounding box, in the unit of the points.
pub(crate) fn extent(view: &ObjectView) -> Vector3<f64> {
    let along = |axis: usize| {
        let places = view.points.iter().map(|point| point.position()[axis]);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
            (low.min(place), high.max(place))
        });
        high - low
    };
    [0, 1, 2].map(along).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use dataset::pcd::{Encoding, PcdView, write};
    use geometry::RigidTransform;
    use point_cloud::{Point, Rgba};
    use std::path::Path;

    /// Writes a view of a box whose longest side is given, in the unit of the file.
    fn write_view(root: &Path, path: &str, longest: f32) {
        let color = Rgba::default();
        let corner = |share: f32| {
            let [x, y, z] = [0.4, 0.5, 1.0].map(|side| side * share * longest);
            Point { x, y, z, color }
        };
        let points = [0.0, 0.3, 1.0].map(corner);
        let view = PcdView {
            points: &points,
            labels: None,
            width: points.len(),
            height: 1,
            viewpoint: RigidTransform::identity(),
        };
        let path = root.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, write(view, Encoding::Binary).unwrap()).unwrap();
    }

    /// Sides in metres, or refusals, and notes, of a data set with these views of a mug.
    fn loaded(sides: &[f32], given: Option<ModelUnit>) -> (Vec<Result<f64, String>>, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        for (number, side) in sides.iter().enumerate() {
            write_view(folder.path(), &format!("mug/{number}.pcd"), *side);
        }
        let views = ObjectViews::open(folder.path()).unwrap();
        let metric = MetricViews::new(&views, given, &ProgressBar::hidden());
        let side = |index| metric.load(index).map(|view| extent(&view).max());
        let sides = (0..sides.len()).map(side).collect();
        (sides, metric.notes().to_vec())
    }

    fn is_near(side_m: &Result<f64, String>, expected_m: f64) -> bool {
        side_m
            .as_ref()
            .is_ok_and(|side_m| (side_m / expected_m - 1.0).abs() < 1e-3)
    }

    #[test]
    fn unit_of_views_is_guessed_for_a_category_and_told() {
        let (sides, notes) = loaded(&[99.0, 80.0, 15.0], None);
        for (side, expected_m) in sides.iter().zip([0.099, 0.08, 0.015]) {
            assert!(is_near(side, expected_m), "{side:?}");
        }
        assert_eq!(notes.len(), 1);
        assert!(notes[0].contains("mug") && notes[0].contains("millimetres"));

        let (sides, notes) = loaded(&[0.1, 0.12], None);
        assert!(is_near(&sides[0], 0.1) && is_near(&sides[1], 0.12));
        assert!(notes.is_empty(), "{notes:?}");

        let (sides, notes) = loaded(&[10.0], Some(ModelUnit::Inch));
        assert!(is_near(&sides[0], 0.254) && notes.is_empty(), "{sides:?}");
    }

    #[test]
    fn view_that_is_no_object_on_a_table_is_refused() {
        let (sides, _) = loaded(&[0.1, 0.12, 120.0, 0.001], None);
        assert!(is_near(&sides[0], 0.1) && is_near(&sides[1], 0.12));
        for (index, word) in [(2, "120 metres"), (3, "0.001 metres")] {
            let sentence = sides[index].as_ref().unwrap_err();
            assert!(sentence.contains(word), "{sentence}");
            assert!(sentence.contains(&format!("mug/{index}.pcd")), "{sentence}");
        }
        let (sides, notes) = loaded(&[1e30], None);
        assert!(sides[0].is_err() && notes.is_empty(), "{sides:?}");
        let (sides, _) = loaded(&[99.0], Some(ModelUnit::Metre));
        assert!(sides[0].is_err(), "{sides:?}");
    }
}
