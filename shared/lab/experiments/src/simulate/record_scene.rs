//! `tabula-lab simulate scene`: RGB-D sequence of a simulated scene with ground truth.

use crate::arguments::SceneArguments;
use command_line::{Output, progress_bar};
use crossbeam::channel::{Receiver, Sender, bounded};
use dataset::rgbd_sequence::{FrameView, SequenceWriter};
use geometry::{PinholeCamera, RigidTransform};
use indicatif::ProgressBar;
use nalgebra::Vector3;
use point_cloud::Point;
use serde::Serialize;
use service::Failure;
use simulated_world::{
    ModelLibrary, STEPS_PER_SECOND, Scene, SceneKind, SimulatedKinect, World, truth_json,
};
use std::process::ExitCode;

/// Capacity of the queue between renderer and writer, frames. Chosen.
const FRAMES_AHEAD: usize = 3;

/// Rendered frame of a recorded scene.
struct RenderedFrame {
    color: Vec<u8>,
    depth_mm: Vec<u16>,
    mask: Vec<u16>,
    world_from_camera: RigidTransform,
    truth: String,
}

#[derive(Serialize)]
struct RecordedSceneReport<'a> {
    folder: &'a str,
    frames: u64,
    objects: usize,
    notes: Vec<String>,
}

/// Renders and writes the frames of a scene, on one thread each.
pub(super) fn run(arguments: &SceneArguments, output: &Output) -> Result<ExitCode, Failure> {
    let world = set_up(arguments)?;
    let n_objects = world.objects().len();
    let down = -Vector3::z_axis();
    let camera = PinholeCamera::KINECT_V1;
    let writer =
        SequenceWriter::create(&arguments.out, &camera, Some(down)).map_err(Failure::general)?;
    let bar = progress_bar(arguments.frames, "frames", output);
    let (sender, receiver) = bounded(FRAMES_AHEAD);
    let (rendered, written) = std::thread::scope(|scope| {
        let renderer = scope.spawn(move || render(world, arguments, &sender));
        let written = write(writer, &receiver, &bar);
        // A writer that has failed takes no more frames, which ends the renderer.
        drop(receiver);
        let rendered = renderer.join();
        (rendered, written)
    });
    bar.finish_and_clear();
    written?;
    let notes = rendered.map_err(|_| Failure::general("the renderer has panicked"))??;
    let folder = arguments.out.display().to_string();
    let document = RecordedSceneReport {
        folder: &folder,
        frames: arguments.frames,
        objects: n_objects,
        notes,
    };
    output.answer(&document, || text(&document));
    Ok(ExitCode::SUCCESS)
}

fn text(document: &RecordedSceneReport<'_>) -> String {
    let notes = document.notes.iter().map(|note| format!("{note}\n"));
    format!(
        "{}{} frames of {} objects are in {folder}\nplay them with: tabula run --source {folder}",
        notes.collect::<String>(),
        document.frames,
        document.objects,
        folder = document.folder
    )
}

fn set_up(arguments: &SceneArguments) -> Result<World, Failure> {
    if !(0.1..=f64::from(STEPS_PER_SECOND)).contains(&arguments.rate) {
        let rule = "--rate must lie between 0.1 and 120 frames per second";
        return Err(Failure::usage(rule));
    }
    let (scene, library) = match (&arguments.file, &arguments.kind) {
        (Some(file), None) if arguments.objects.is_none() && arguments.models.is_none() => {
            Scene::open(file, arguments.seed).map_err(Failure::usage)?
        }
        (Some(_), _) => {
            let rule = "a scene file says itself what kind of scene it is, how many objects it \
                        has and of which models; leave --kind, --objects and --models out";
            return Err(Failure::usage(rule));
        }
        (None, kind) => generated(kind.as_deref(), arguments)?,
    };
    World::new(scene, library).map_err(Failure::usage)
}

fn generated(
    kind: Option<&str>,
    arguments: &SceneArguments,
) -> Result<(Scene, ModelLibrary), Failure> {
    let kind = kind.map_or(Ok(SceneKind::Isolated), str::parse);
    let kind: SceneKind = kind.map_err(Failure::usage)?;
    let source = arguments.models.clone().unwrap_or_default();
    let mut library = ModelLibrary::open(&source).map_err(Failure::usage)?;
    let n_objects = arguments.objects.unwrap_or(kind.default_n_objects());
    let seed = arguments.seed.unwrap_or(1);
    let scene = Scene::generate(kind, n_objects, seed, &mut library).map_err(Failure::usage)?;
    Ok((scene, library))
}

/// Renders all frames; returns the notes of the simulation.
fn render(
    mut world: World,
    arguments: &SceneArguments,
    frames: &Sender<RenderedFrame>,
) -> Result<Vec<String>, Failure> {
    let camera = PinholeCamera::KINECT_V1;
    let mut kinect = SimulatedKinect::new(&world, camera).map_err(Failure::general)?;
    let mut points = vec![Point::default(); camera.n_pixels()];
    let mut notes = world.take_notes();
    for frame in 0..arguments.frames {
        while world.time_s() * arguments.rate + 1e-6 < frame as f64 {
            world.step();
        }
        let truth = kinect
            .look(&world, frame, &mut points)
            .map_err(Failure::general)?;
        notes.append(&mut world.take_notes());
        let frame = RenderedFrame {
            color: kinect.sensor().color().as_flattened().to_vec(),
            depth_mm: kinect.sensor().depth_mm().to_vec(),
            mask: kinect.mask().to_vec(),
            world_from_camera: world.world_from_camera(),
            truth: truth_json(frame, world.time_s(), &truth),
        };
        if frames.send(frame).is_err() {
            break;
        }
    }
    Ok(notes)
}

fn write(
    mut writer: SequenceWriter,
    frames: &Receiver<RenderedFrame>,
    bar: &ProgressBar,
) -> Result<(), Failure> {
    for frame in frames {
        writer
            .write(&FrameView {
                color: &frame.color,
                depth_mm: &frame.depth_mm,
                instances: Some(&frame.mask),
                world_from_camera: Some(frame.world_from_camera),
                truth: Some(frame.truth.as_bytes()),
            })
            .map_err(Failure::general)?;
        bar.inc(1);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::{Path, PathBuf};

    fn arguments(out: &Path) -> SceneArguments {
        SceneArguments {
            file: None,
            kind: Some("isolated".into()),
            objects: Some(3),
            models: None,
            seed: Some(5),
            frames: 2,
            rate: 30.0,
            out: out.to_owned(),
        }
    }

    #[test]
    fn recording_is_reproducible_and_readable() {
        let folder = tempfile::tempdir().unwrap();
        let output = Output::new(true);
        let folders: [PathBuf; 2] = ["a", "b"].map(|name| folder.path().join(name));
        for out in &folders {
            run(&arguments(out), &output).unwrap();
        }
        let names = |folder: &Path| -> Vec<_> {
            let files = std::fs::read_dir(folder).unwrap();
            let mut names: Vec<_> = files.map(|file| file.unwrap().file_name()).collect();
            names.sort();
            names
        };
        assert_eq!(names(&folders[0]), names(&folders[1]));
        for name in names(&folders[0]) {
            let [a, b] = [0, 1].map(|i: usize| std::fs::read(folders[i].join(&name)).unwrap());
            assert!(a == b, "{} differs", name.display());
        }
        let sequence = dataset::rgbd_sequence::RgbdSequence::open(&folders[0]).unwrap();
        assert_eq!(sequence.n_frames(), 2);
        assert!(
            run(&arguments(&folders[0]), &output).is_err(),
            "written twice"
        );
    }
}
