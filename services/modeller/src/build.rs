//! `tabula model build`: a model grows while the camera moves around the object.

mod build_thread;
mod built_document;
mod construction;
mod model_store;
mod name_check;

use crate::arguments::BuildArguments;
use crate::growth::Growth;
use crate::model_document::object_model;
use crate::object_receiver::{ObjectReceiver, TrackedObject};
use crate::presence::require_daemon;
use built_document::BuiltDocument;
use channel::{Domain, Role, RunFolder};
use command_line::{Output, StopSignal};
use construction::Construction;
use control_client::TrackScope;
use model_construction::Config;
use model_store::ModelStore;
use name_check::{check_name, chosen_name};
use scene_client::camera_depth_noise;
use sensor_noise::DepthNoise;
use service::{CommonArguments, Failure};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Polling period of the topics, and of the end of the construction.
const POLL_PERIOD: Duration = Duration::from_millis(5);
/// Time for which a scene with the object is awaited.
const SCENE_PATIENCE: Duration = Duration::from_secs(5);

/// Builds and stores the model of an object.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &BuildArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let stop = StopSignal::install()?;
    require_daemon(&common.domain)?;
    let domain = Domain::join(&common.domain, &RunFolder::of_user(), Role::Guest)?;
    let mut receiver = ObjectReceiver::new(&domain)?;
    let track = arguments.track.as_ref();
    let track = track.map(|track| track.resolve(common, TrackScope::LOOK, None));
    let object = chosen_object(&mut receiver, track.transpose()?, &stop)?;
    let name = chosen_name(arguments.name.as_deref(), &object)?;
    if !arguments.anyway {
        check_name(common, &name, &object)?;
    }
    output.print_status(&format!(
        "looking at object {}, which becomes the model {name:?}; move the camera slowly around \
         it, or turn it by some 30° at a time; Ctrl-C ends",
        object.track
    ));
    let mut store = ModelStore::new(common, arguments.author.as_deref(), &name);
    let config = config(common, arguments, output);
    let construction = Construction::new(
        &common.domain,
        arguments,
        config,
        (&stop, output),
        &mut store,
    )?;
    let constructed = construction.run(&mut receiver, object.track)?;
    require_views(&constructed.growth, object.track)?;
    let model = object_model(&constructed.growth);
    let n_bytes = store.finish(&model)?;
    let document = BuiltDocument::new(&constructed, &model, (&name, object.track), n_bytes);
    output.answer(&document, || document.text());
    Ok(ExitCode::SUCCESS)
}

/// Configuration of the construction, for the depth noise of the daemon's camera.
fn config(common: &CommonArguments, arguments: &BuildArguments, output: &Output) -> Config {
    let noise = camera_depth_noise(common).unwrap_or_else(|failure| {
        output.print_status(&format!(
            "the depth noise of the camera is not known ({failure}); that of a Kinect is assumed"
        ));
        DepthNoise::default()
    });
    arguments.config(noise)
}

/// Fails where no view could be used.
fn require_views(growth: &Growth, track: u64) -> Result<(), Failure> {
    if !growth.builder().views().is_empty() {
        return Ok(());
    }
    Err(Failure::general(match growth.refused().first() {
        Some(refused) => format!("no view of the object could be used: {}", refused.reason),
        None => format!(
            "object {track} was never seen, so that there is no model of it; show it to the \
             camera whole"
        ),
    }))
}

/// Object of a track-id, or the one nearest to the middle of the image.
fn chosen_object(
    receiver: &mut ObjectReceiver,
    track: Option<u64>,
    stop: &StopSignal,
) -> Result<TrackedObject, Failure> {
    let begun = Instant::now();
    let mut known: Vec<u64> = Vec::new();
    while begun.elapsed() < SCENE_PATIENCE && !stop.is_raised() {
        if let Some(objects) = receiver.objects()? {
            let is_chosen = |object: &&TrackedObject| match track {
                Some(track) => object.track == track,
                None => object.is_seen,
            };
            if let Some(object) = objects.iter().find(is_chosen) {
                return Ok(object.clone());
            }
            known = objects.iter().map(|object| object.track).collect();
        }
        stop.sleep(POLL_PERIOD);
    }
    let known: Vec<String> = known.iter().map(u64::to_string).collect();
    let sentence = match track {
        Some(track) if known.is_empty() => {
            format!("there is no object {track}: the scene is empty; see `tabula objects`")
        }
        Some(track) => {
            format!("there is no object {track}; there are {}", known.join(", "))
        }
        None => "no object is seen whole; point the camera at one".to_owned(),
    };
    Err(Failure::general(sentence))
}
