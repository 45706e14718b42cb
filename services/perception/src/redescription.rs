//! Re-description: taught views of an earlier descriptor kind, described again from their
//! stored clouds.
//!
//! The memory keeps what was stored, so a robot that is set back to an earlier version
//! loses nothing either.

use control_protocol::{LearnedView, PackedCloud};
use learning::CategoryName;
use learning::DESCRIPTOR_KIND;
use pipeline::StoredViewDescriber;
use point_cloud::Point;

/// Labelled view with a descriptor of this version.
pub(crate) struct DescribedView {
    /// Id of the stored view.
    pub(crate) id: learning::ViewId,
    /// Category that the view was taught as.
    pub(crate) category: CategoryName,
    /// Descriptor values.
    pub(crate) values: Vec<f32>,
}

/// `true` if the stored descriptor of a view is of this version.
pub(crate) fn is_current(view: &LearnedView) -> bool {
    view.descriptor_kind == DESCRIPTOR_KIND
}

/// View with its stored descriptor.
///
/// # Errors
/// A reason when name or descriptor are invalid.
pub(crate) fn as_stored(view: &LearnedView) -> Result<DescribedView, String> {
    let values = view.descriptor.decode();
    described(view, values.map_err(|error| error.to_string())?)
}

/// Views described again from their packed clouds, in the same order.
pub(crate) fn describe_again(
    views: &[LearnedView],
    clouds: &[impl AsRef<[u8]>],
) -> Vec<Result<DescribedView, String>> {
    let mut points = Vec::new();
    let mut describer = StoredViewDescriber::new();
    let pairs = views.iter().zip(clouds);
    let describe = |(view, cloud): (&LearnedView, _)| {
        let describer = describer.as_mut().map_err(|error| error.to_string())?;
        unpack(cloud, &mut points).map_err(|reason| {
            let kind = &view.descriptor_kind;
            format!("it was described as {kind}, not {DESCRIPTOR_KIND}, and {reason}")
        })?;
        let values = describer.describe(&points);
        described(view, values.map_err(|error| error.to_string())?)
    };
    pairs
        .map(|(view, cloud)| (view, cloud.as_ref()))
        .map(describe)
        .collect()
}

fn unpack(cloud: &[u8], points: &mut Vec<Point>) -> Result<(), String> {
    if cloud.is_empty() {
        return Err("its points were not kept".to_owned());
    }
    let cloud = PackedCloud::checked(cloud);
    let cloud = cloud.map_err(|error| format!("its points cannot be read: {error}"))?;
    points.clear();
    points.extend(cloud.points());
    Ok(())
}

fn described(view: &LearnedView, values: Vec<f32>) -> Result<DescribedView, String> {
    let category = CategoryName::stored(&view.category).map_err(|error| error.to_string())?;
    Ok(DescribedView {
        id: view_id(view.id),
        category,
        values,
    })
}

/// Id of a stored view in the index.
pub(crate) fn view_id(id: control_protocol::ViewId) -> learning::ViewId {
    learning::ViewId {
        track_id: id.track_id,
        view_id: id.view_id,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_protocol::{ViewId, pack_cloud};
    use geometry::RigidTransform;
    use point_cloud::Rgba;

    fn view(descriptor_kind: &str) -> LearnedView {
        LearnedView {
            id: ViewId {
                track_id: 7,
                view_id: 1,
            },
            category: "mug".into(),
            descriptor_kind: descriptor_kind.into(),
            descriptor: vec![0; 8].into(),
        }
    }

    fn box_points() -> Vec<Point> {
        let point = |i: u16| {
            let t = f32::from(i);
            Point {
                x: 0.04 * (1.3 * t).sin(),
                y: 0.02 * (1.7 * t).sin(),
                z: 0.05 * (2.1 * t).sin(),
                color: Rgba::opaque(200, 30, 30),
            }
        };
        (0..500).map(point).collect()
    }

    #[test]
    fn views_of_an_earlier_kind_are_described_from_their_points() {
        let points = box_points();
        let cloud = pack_cloud(points.iter(), &RigidTransform::identity());
        let again = describe_again(&[view("appearance-1-upright")], &[cloud]);
        let again = again.into_iter().next().unwrap().unwrap();
        assert_eq!((again.category.as_str(), again.id.track_id), ("mug", 7));
        let expected = StoredViewDescriber::new()
            .unwrap()
            .describe(&points)
            .unwrap();
        let difference = again
            .values
            .iter()
            .zip(&expected)
            .map(|(a, b)| (a - b) * (a - b));
        assert!(difference.sum::<f32>().sqrt() < 0.05);
    }

    #[test]
    fn a_view_without_points_is_told_with_its_kind() {
        let damaged = vec![1, 2, 3];
        for cloud in [Vec::new(), damaged] {
            let again = describe_again(&[view("appearance-1-upright")], &[cloud]);
            let reason = again.into_iter().next().unwrap().err().unwrap();
            assert!(
                reason.contains("appearance-1-upright") && reason.contains("points"),
                "{reason}"
            );
        }
    }
}
