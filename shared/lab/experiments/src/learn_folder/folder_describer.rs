//! Describer of the views of a folder, as records that a memory imports.

use crate::learn_folder::LabelledObject;
use crate::metric_views::{MetricViews, extent};
use control_protocol::pack_cloud;
use dataset::object_views::ViewFile;
use description::{AppearanceDescriptor, ObjectPoints};
use geometry::{OrientedBox, RigidTransform};
use learning::DESCRIPTOR_KIND;
use learning::ViewId;
use nalgebra::UnitVector3;
use perceptual_memory::{
    CapturedView, DecisionStamp, Digest, ForeignView, LabelStatus, MAX_NAME_BYTES, Origin,
    StoredDescriptor,
};
use point_cloud::{Point, Rgba};

/// Domain separation of the origin digests.
const ORIGIN_PURPOSE: &str = "tabula files";

/// Describer of the views of a folder.
pub(super) struct FolderDescriber<'a> {
    pub(super) views: &'a MetricViews<'a>,
    /// Files of the views.
    pub(super) files: &'a [ViewFile],
    /// Upward axis given on the command line.
    pub(super) up: Option<UnitVector3<f64>>,
    /// Author and time recorded with the labels.
    pub(super) decided: DecisionStamp,
}

impl FolderDescriber<'_> {
    /// Describes a view as a labelled example of its object. Apart from author and time the record
    /// depends on the files only: a folder learned again, or on another robot, gives the same
    /// views.
    pub(super) fn describe(
        &self,
        appearance: &mut AppearanceDescriptor,
        object: &LabelledObject,
        index: usize,
    ) -> Result<ForeignView, String> {
        let view = self.views.load(index)?;
        let path = &self.files[index].path;
        let source = path.to_string_lossy().into_owned();
        if source.len() > MAX_NAME_BYTES {
            return Err(format!(
                "the view {source} has a path of more than {MAX_NAME_BYTES} bytes in its folder"
            ));
        }
        let up = self.up.as_ref().or(view.up.as_ref());
        let readings = appearance
            .describe(ObjectPoints::all(&view.points), up)
            .map_err(|error| format!("the view {source} cannot be described: {error}"))?;
        let origin = origin(object, &source);
        let cloud = pack_cloud(view.points.iter(), &RigidTransform::identity());
        let view = CapturedView {
            id: origin.view,
            descriptor: StoredDescriptor {
                kind: DESCRIPTOR_KIND.into(),
                values: readings[0].clone(),
            },
            // Without a place in the world: it was never on this table.
            box_in_world: OrientedBox {
                frame_from_box: RigidTransform::identity(),
                half_sides_m: extent(&view) / 2.0,
            },
            // Not known: when the file was written changes when it is copied.
            captured_ns: 0,
            frame_sequence: 0,
            source,
            mean_rgb: mean_rgb(&view.points),
            // In the frame of its file, in metres.
            points: Some(cloud).filter(|cloud| !cloud.is_empty()),
        };
        Ok(ForeignView::Present {
            view: Box::new(view),
            origin,
            standing: LabelStatus::Named(object.category.clone()),
            decided: Some(self.decided.clone()),
        })
    }
}

/// Origin of a view: digest of its object as memory id, digest of its file as view id. A file added
/// to an object leaves the other views unchanged.
fn origin(object: &LabelledObject, source: &str) -> Origin {
    let category = object.category.as_str();
    // No name has a NUL.
    let instance = object.instance.as_deref().unwrap_or("\0");
    let object = [ORIGIN_PURPOSE, category, instance].join("\0");
    let file = Digest::of(source.as_bytes());
    Origin {
        memory_id: Digest::of(object.as_bytes()).0,
        view: ViewId {
            track_id: 0,
            view_id: file.0 as u32,
        },
    }
}

/// Mean colour; `None` for a file without colours, which is read as zeros.
fn mean_rgb(points: &[Point]) -> Option<[u8; 3]> {
    let has_colors = points.iter().any(|point| point.color != Rgba::default());
    let mean = |channel: usize| {
        let values = points
            .iter()
            .map(|point| u64::from(point.color.rgb()[channel]));
        (values.sum::<u64>() / points.len() as u64) as u8
    };
    has_colors.then(|| [0, 1, 2].map(mean))
}

#[cfg(test)]
mod tests {
    use super::*;
    use learning::CategoryName;

    #[test]
    fn mean_colour_needs_colours() {
        let point = |color| Point {
            color,
            ..Point::default()
        };
        let (dark, light) = (Rgba::opaque(0, 10, 20), Rgba::opaque(100, 20, 21));
        assert_eq!(mean_rgb(&[point(dark), point(light)]), Some([50, 15, 20]));
        assert_eq!(mean_rgb(&[Point::default(); 3]), None);
        assert_eq!(mean_rgb(&[]), None);
    }

    #[test]
    fn origin_depends_on_object_names_and_file() {
        let object = |category: &str, instance: Option<&str>| LabelledObject {
            category: CategoryName::new(category).unwrap(),
            instance: instance.map(ToOwned::to_owned),
            views: 0..1,
        };
        let of = |category, instance, file| origin(&object(category, instance), file);
        let first = of("mug", Some("1"), "mug/mug_1/a.pcd");
        assert_eq!(first, of("mug", Some("1"), "mug/mug_1/a.pcd"));
        let second = of("mug", Some("1"), "mug/mug_1/b.pcd");
        assert_eq!(first.memory_id, second.memory_id);
        assert_ne!(first.view, second.view);
        let others = [
            of("mug", Some("2"), "mug/mug_1/a.pcd"),
            of("mug", None, "mug/mug_1/a.pcd"),
            of("mug 1", None, "mug/mug_1/a.pcd"),
            of("cup", Some("1"), "mug/mug_1/a.pcd"),
        ];
        for other in others {
            assert_ne!(first.memory_id, other.memory_id);
        }
    }
}
