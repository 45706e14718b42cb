//! Pairs of views of models on the simulated turntable.

use super::trials::ViewPair;
use crate::arguments::RegistrationArguments;
use crate::parallel;
use crate::simulate::turntable::{SegmentedView, Turntable, TurntableRoom};
use command_line::Output;
use dataset::washington::CAMERA;
use nalgebra::Point3;
use service::Failure;
use simulated_world::{ModelChoice, ModelLibrary, ModelSource};

/// Height of the camera, as an index of the turntable's elevations: 30°.
const HEIGHT: usize = 0;

/// Points of one view in the world frame, metres, and the place of its camera.
type WorldView = (Vec<[f32; 3]>, Point3<f64>);

/// Simulates a pair of views of each object. Objects that detection does not find in both views
/// are left out.
pub(super) fn simulate(
    models: &ModelSource,
    arguments: &RegistrationArguments,
    output: &Output,
) -> Result<Vec<ViewPair>, Failure> {
    let library = ModelLibrary::open(models).map_err(Failure::usage)?;
    let models = library.choose(arguments.objects as usize, arguments.seed);
    let pairs = parallel::try_map(models.len(), "objects", output, |object| {
        pair(&models[object], &library, object, arguments)
    })?;
    let pairs: Vec<ViewPair> = pairs.into_iter().flatten().collect();
    if pairs.is_empty() {
        let sentence = "detection found none of the objects in both views; choose other models";
        return Err(Failure::general(sentence));
    }
    Ok(pairs)
}

fn pair(
    model: &ModelChoice,
    library: &ModelLibrary,
    object: usize,
    arguments: &RegistrationArguments,
) -> Result<Option<ViewPair>, Failure> {
    let room = TurntableRoom::default();
    let seed = (arguments.seed, object as u64);
    let mut turntable =
        Turntable::new(model, library.clone(), CAMERA, room, seed).map_err(Failure::general)?;
    let mut view = |turn: f64| -> Result<Option<WorldView>, Failure> {
        let view = turntable.view(HEIGHT, turn).map_err(Failure::general)?;
        Ok(view.as_ref().map(in_world))
    };
    let (target, source) = (view(0.0)?, view(arguments.angle / 360.0)?);
    Ok(target.zip(source).map(|(target, source)| ViewPair {
        name: format!("{:02}-{}", object + 1, model.category()),
        target: target.0,
        source: source.0,
        viewpoints: Some([target.1, source.1]),
    }))
}

fn in_world(view: &SegmentedView<'_>) -> WorldView {
    let world_from_camera = view.world_from_camera;
    let in_world = |&index: &u32| {
        let point = view.cloud[index as usize];
        let in_camera = Point3::new(point.x, point.y, point.z).cast::<f64>();
        (world_from_camera * in_camera).cast::<f32>().into()
    };
    let points = view.point_indices.iter().map(in_world).collect();
    (points, Point3::from(world_from_camera.translation.vector))
}
