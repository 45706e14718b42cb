//! Raw scene file (TOML) and its validation.

use super::scene_variation::SceneVariation;
use super::{MAX_OBJECTS, RANDOM_PAUSE_S, generated_objects};
use crate::action::{Action, PersonPlan, TimedAction};
use crate::arm_mount::ArmMount;
use crate::arrangement::SceneSetting;
use crate::camera_mount::CameraMount;
use crate::error::Error;
use crate::furniture::{Bin, Shelf, TableDimensions, Tray};
use crate::lighting::Lighting;
use crate::model_choice::{ModelChoice, ModelSource};
use crate::model_library::ModelLibrary;
use crate::scene::{ObjectPlacement, ObjectPlan, Scene, SceneKind};
use geometry::RigidTransform;
use nalgebra::{Translation3, UnitQuaternion};
use rendering::kinect::SensorModel;
use serde::Deserialize;
use std::ops::RangeInclusive;
use std::path::Path;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawScene {
    #[serde(default = "one")]
    seed: u64,
    kind: Option<String>,
    objects: Option<usize>,
    models: Option<String>,
    duration_s: Option<f64>,
    lighting: Option<String>,
    vary: Option<RawVariation>,
    arm: Option<RawArm>,
    #[serde(default)]
    table: RawTable,
    bin: Option<RawBin>,
    shelf: Option<RawShelf>,
    tray: Option<RawTray>,
    #[serde(default)]
    camera: RawCamera,
    #[serde(default)]
    object: Vec<RawObject>,
    person: Option<RawPerson>,
    #[serde(default)]
    sensor: RawSensor,
}

fn one() -> u64 {
    1
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct RawTable {
    size_m: Option<[f64; 2]>,
    height_m: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct RawBin {
    inner_size_m: Option<[f64; 3]>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct RawShelf {
    boards: Option<usize>,
    spacing_m: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct RawTray {
    inner_size_m: Option<[f64; 2]>,
    floor_m: Option<f64>,
    rim_m: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct RawCamera {
    look_at_m: Option<[f64; 3]>,
    distance_m: Option<f64>,
    elevation_deg: Option<f64>,
    azimuth_deg: Option<f64>,
    orbit_deg_s: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct RawArm {
    position_m: Option<[f64; 3]>,
    yaw_deg: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct RawVariation {
    instances: u64,
    shift_m: f64,
    turn_deg: f64,
    shuffle: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawObject {
    category: Option<String>,
    #[serde(default)]
    instance: u64,
    model: Option<String>,
    position_m: [f64; 2],
    #[serde(default)]
    yaw_deg: f64,
    #[serde(default)]
    pitch_deg: f64,
    #[serde(default)]
    roll_deg: f64,
    drop_from_m: Option<f64>,
    raised_m: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPerson {
    #[serde(default)]
    by_chance: bool,
    every_s: Option<[f64; 2]>,
    pace: Option<f64>,
    #[serde(default)]
    action: Vec<RawAction>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawAction {
    at_s: f64,
    #[serde(rename = "do")]
    what: String,
    object: Option<u16>,
    category: Option<String>,
    #[serde(default)]
    instance: u64,
    to_m: Option<[f64; 2]>,
    for_s: Option<f64>,
    by_deg: Option<f64>,
}

/// Sensor preset and names of the error terms to switch off.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct RawSensor {
    preset: Option<String>,
    off: Vec<String>,
}

fn wrong(place: impl Into<String>, rule: impl Into<String>) -> Error {
    Error::Scene {
        place: place.into(),
        rule: rule.into(),
    }
}

/// Checks that a value lies within its range; NaN does not.
fn checked(place: &str, value: f64, range: RangeInclusive<f64>) -> Result<f64, Error> {
    if range.contains(&value) {
        return Ok(value);
    }
    let (low, high) = range.into_inner();
    Err(wrong(
        place,
        format!("it must lie between {low} and {high}, not {value}"),
    ))
}

pub(super) fn scene(
    text: &str,
    folder: &Path,
    seed: Option<u64>,
) -> Result<(Scene, ModelLibrary), Error> {
    let raw: RawScene = toml::from_str(text)
        .map_err(|error| wrong("text is not a scene", error.to_string().trim().to_owned()))?;
    let source = raw.models.as_ref().map_or(ModelSource::Generated, |path| {
        ModelSource::Folder(folder.join(path))
    });
    let mut library = ModelLibrary::open(&source)?;
    let kind = raw.kind.as_deref().map(str::parse::<SceneKind>);
    let kind = kind.transpose().map_err(|rule| wrong("kind", rule))?;
    let seed = seed.unwrap_or(raw.seed);
    let setting = SceneSetting::of(kind, seed);
    let table = table(&raw.table, &setting.table())?;
    let n_objects = raw
        .objects
        .or(kind.map(SceneKind::default_n_objects))
        .unwrap_or(0);
    let mut scene = Scene {
        seed,
        table,
        table_finish: setting.table_finish(),
        lighting: lighting(raw.lighting.as_deref())?,
        bin: bin(raw.bin.as_ref(), kind)?,
        shelf: shelf(raw.shelf.as_ref(), kind)?,
        tray: tray(raw.tray.as_ref(), kind)?,
        camera: camera(&raw.camera, setting.camera(&table, n_objects))?,
        objects: Vec::new(),
        arm: raw.arm.as_ref().map(arm).transpose()?,
        person: raw.person.as_ref().map(person).transpose()?,
        sensor: sensor(&raw.sensor)?,
        duration_s: duration_s(raw.duration_s)?,
    };
    if let Some(kind) = kind {
        scene.objects = generated_objects(&scene, kind, n_objects, &mut library)?;
    } else if raw.objects.is_some() {
        return Err(wrong(
            "objects",
            "a number of objects needs a `kind` that lays them",
        ));
    }
    for (index, raw) in raw.object.iter().enumerate() {
        scene
            .objects
            .push(object(raw, index, folder, &scene.table)?);
    }
    if let Some(raw) = &raw.vary {
        variation(raw)?.apply(&mut scene);
    }
    if scene.objects.len() > MAX_OBJECTS {
        let n = scene.objects.len();
        return Err(wrong(
            "[[object]]",
            format!("at most {MAX_OBJECTS} objects fit a scene, not {n}"),
        ));
    }
    Ok((scene, library))
}

fn lighting(word: Option<&str>) -> Result<Lighting, Error> {
    let known = word.map_or(Ok(Lighting::default()), str::parse);
    known.map_err(|rule| wrong("lighting", rule))
}

fn duration_s(raw: Option<f64>) -> Result<Option<f64>, Error> {
    raw.map(|duration_s| checked("duration_s", duration_s, 0.1..=86_400.0))
        .transpose()
}

fn variation(raw: &RawVariation) -> Result<SceneVariation, Error> {
    Ok(SceneVariation {
        n_instances: raw.instances,
        shift_m: checked("[vary] shift_m", raw.shift_m, 0.0..=0.5)?,
        turn_rad: checked("[vary] turn_deg", raw.turn_deg, 0.0..=180.0)?.to_radians(),
        is_shuffled: raw.shuffle,
    })
}

/// Table of a scene file; missing keys are those of `default`.
fn table(raw: &RawTable, default: &TableDimensions) -> Result<TableDimensions, Error> {
    let [x, y] = raw.size_m.unwrap_or(default.size_m);
    Ok(TableDimensions {
        size_m: [
            checked("[table] size_m", x, 0.2..=4.0)?,
            checked("[table] size_m", y, 0.2..=3.0)?,
        ],
        height_m: checked(
            "[table] height_m",
            raw.height_m.unwrap_or(default.height_m),
            0.1..=1.5,
        )?,
    })
}

fn bin(raw: Option<&RawBin>, kind: Option<SceneKind>) -> Result<Option<Bin>, Error> {
    let Some(raw) = raw else {
        return Ok((kind == Some(SceneKind::Bin)).then(Bin::default));
    };
    let size = raw.inner_size_m.unwrap_or(Bin::default().inner_size_m);
    for side in size {
        checked("[bin] inner_size_m", side, 0.02..=1.5)?;
    }
    Ok(Some(Bin { inner_size_m: size }))
}

fn shelf(raw: Option<&RawShelf>, kind: Option<SceneKind>) -> Result<Option<Shelf>, Error> {
    let default = Shelf::default();
    let Some(raw) = raw else {
        return Ok((kind == Some(SceneKind::Shelf)).then_some(default));
    };
    let n_boards = raw.boards.unwrap_or(default.n_boards);
    if !(1..=6).contains(&n_boards) {
        let rule = format!("it must lie between 1 and 6, not {n_boards}");
        return Err(wrong("[shelf] boards", rule));
    }
    let spacing_m = raw.spacing_m.unwrap_or(default.spacing_m);
    Ok(Some(Shelf {
        n_boards,
        spacing_m: checked("[shelf] spacing_m", spacing_m, 0.1..=1.0)?,
    }))
}

fn tray(raw: Option<&RawTray>, kind: Option<SceneKind>) -> Result<Option<Tray>, Error> {
    let default = Tray::default();
    let Some(raw) = raw else {
        return Ok((kind == Some(SceneKind::Tray)).then_some(default));
    };
    let [x, y] = raw.inner_size_m.unwrap_or(default.inner_size_m);
    Ok(Some(Tray {
        inner_size_m: [
            checked("[tray] inner_size_m", x, 0.1..=1.5)?,
            checked("[tray] inner_size_m", y, 0.1..=1.5)?,
        ],
        floor_m: checked(
            "[tray] floor_m",
            raw.floor_m.unwrap_or(default.floor_m),
            0.002..=0.2,
        )?,
        rim_m: checked(
            "[tray] rim_m",
            raw.rim_m.unwrap_or(default.rim_m),
            0.0..=0.4,
        )?,
    }))
}

fn camera(raw: &RawCamera, default: CameraMount) -> Result<CameraMount, Error> {
    let look_at_m = raw.look_at_m.unwrap_or(default.look_at_m);
    for value in look_at_m {
        checked("[camera] look_at_m", value, -5.0..=5.0)?;
    }
    let number = |name: &str, value: Option<f64>, default: f64, range| {
        checked(&format!("[camera] {name}"), value.unwrap_or(default), range)
    };
    Ok(CameraMount {
        look_at_m,
        distance_m: number("distance_m", raw.distance_m, default.distance_m, 0.3..=5.0)?,
        elevation_deg: number(
            "elevation_deg",
            raw.elevation_deg,
            default.elevation_deg,
            -89.0..=89.0,
        )?,
        azimuth_deg: number(
            "azimuth_deg",
            raw.azimuth_deg,
            default.azimuth_deg,
            -360.0..=360.0,
        )?,
        orbit_deg_s: number(
            "orbit_deg_s",
            raw.orbit_deg_s,
            default.orbit_deg_s,
            -180.0..=180.0,
        )?,
    })
}

fn arm(raw: &RawArm) -> Result<ArmMount, Error> {
    let default = ArmMount::default();
    let position_m = raw.position_m.unwrap_or(default.position_m);
    for value in position_m {
        checked("[arm] position_m", value, -3.0..=3.0)?;
    }
    let yaw_deg = raw.yaw_deg.unwrap_or(default.yaw_deg);
    Ok(ArmMount {
        position_m,
        yaw_deg: checked("[arm] yaw_deg", yaw_deg, -360.0..=360.0)?,
        ..default
    })
}

fn object(
    raw: &RawObject,
    index: usize,
    folder: &Path,
    table: &TableDimensions,
) -> Result<ObjectPlan, Error> {
    let place = |key: &str| format!("[[object]] {} {key}", index + 1);
    let model = match (&raw.category, &raw.model) {
        (Some(category), None) => generated(category, raw.instance)?,
        (None, Some(path)) => model_file(&folder.join(path))?,
        _ => {
            return Err(wrong(
                place(""),
                "it needs either `category` or `model`, not both and not neither",
            ));
        }
    };
    for value in raw.position_m {
        checked(&place("position_m"), value, -3.0..=3.0)?;
    }
    let angle =
        |key: &str, value: f64| checked(&place(key), value, -360.0..=360.0).map(f64::to_radians);
    let yaw_rad = angle("yaw_deg", raw.yaw_deg)?;
    let (pitch, roll) = (
        angle("pitch_deg", raw.pitch_deg)?,
        angle("roll_deg", raw.roll_deg)?,
    );
    let raised_m = checked(&place("raised_m"), raw.raised_m.unwrap_or(0.0), 0.0..=2.0)?;
    let placing = match raw.drop_from_m {
        None if pitch == 0.0 && roll == 0.0 => ObjectPlacement::Upright {
            position_m: raw.position_m,
            yaw_rad,
            raised_m,
        },
        drop_from_m => {
            let drop_m = checked(
                &place("drop_from_m"),
                drop_from_m.unwrap_or(0.25),
                0.0..=2.0,
            )?;
            let [x, y] = raw.position_m;
            ObjectPlacement::Dropped {
                world_from_object: RigidTransform::from_parts(
                    Translation3::new(x, y, table.height_m + raised_m + drop_m),
                    UnitQuaternion::from_euler_angles(roll, pitch, yaw_rad),
                ),
            }
        }
    };
    Ok(ObjectPlan {
        model,
        placement: placing,
    })
}

fn generated(category: &str, instance: u64) -> Result<ModelChoice, Error> {
    if household::category(category).is_none() {
        return Err(Error::UnknownCategory {
            category: category.to_owned(),
        });
    }
    Ok(ModelChoice::Generated {
        category: category.to_owned(),
        instance,
    })
}

/// Checks that a model file exists; its contents are validated when it is opened.
fn model_file(path: &Path) -> Result<ModelChoice, Error> {
    if !path.is_file() {
        return Err(Error::unreadable(path, &"there is no such file"));
    }
    Ok(ModelChoice::File(path.to_owned()))
}

fn person(raw: &RawPerson) -> Result<PersonPlan, Error> {
    let random_pause_s = match (raw.by_chance, raw.every_s) {
        (false, None) => None,
        (_, every_s) => {
            let [shortest, longest] = every_s.unwrap_or(RANDOM_PAUSE_S);
            checked("[person] every_s", shortest, 0.0..=3600.0)?;
            checked("[person] every_s", longest, shortest..=3600.0)?;
            Some([shortest, longest])
        }
    };
    let mut script = Vec::new();
    for (index, raw) in raw.action.iter().enumerate() {
        script.push(timed_action(raw, index)?);
    }
    script.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    let pace = checked("[person] pace", raw.pace.unwrap_or(1.0), 0.1..=10.0)?;
    Ok(PersonPlan {
        script,
        pace,
        random_pause_s,
    })
}

fn timed_action(raw: &RawAction, index: usize) -> Result<TimedAction, Error> {
    let place = |key: &str| format!("[[person.action]] {} {key}", index + 1);
    let needs = |key: &str| wrong(place(key), format!("`{}` needs `{key}`", raw.what));
    let at_s = checked(&place("at_s"), raw.at_s, 0.0..=86_400.0)?;
    let object = || match raw.object {
        Some(0) => Err(wrong(place("object"), "objects are counted from 1")),
        object => object.ok_or_else(|| needs("object")),
    };
    let to_m = || {
        let [x, y] = raw.to_m.ok_or_else(|| needs("to_m"))?;
        checked(&place("to_m"), x, -2.0..=2.0)?;
        checked(&place("to_m"), y, -2.0..=2.0)?;
        Ok::<_, Error>([x, y])
    };
    let for_s = checked(&place("for_s"), raw.for_s.unwrap_or(2.0), 0.0..=3600.0)?;
    let by_rad = || {
        let by_deg = raw.by_deg.ok_or_else(|| needs("by_deg"))?;
        Ok::<_, Error>(checked(&place("by_deg"), by_deg, -360.0..=360.0)?.to_radians())
    };
    let action = match raw.what.as_str() {
        "put" => Action::Put {
            model: generated(
                raw.category.as_ref().ok_or_else(|| needs("category"))?,
                raw.instance,
            )?,
            to_m: to_m()?,
        },
        "move" => Action::Move {
            object: object()?,
            to_m: to_m()?,
        },
        "slide" => Action::Slide {
            object: object()?,
            to_m: to_m()?,
        },
        "lift" => Action::Lift {
            object: object()?,
            for_s,
        },
        "turn" => Action::Turn {
            object: object()?,
            by_rad: by_rad()?,
        },
        "hide" => Action::Hide {
            object: object()?,
            for_s,
        },
        "remove" => Action::Remove { object: object()? },
        other => {
            return Err(wrong(
                place("do"),
                format!(
                    "`{other}` is nothing a person does; there are put, move, slide, lift, \
                     turn, hide, remove"
                ),
            ));
        }
    };
    Ok(TimedAction { at_s, action })
}

fn sensor(raw: &RawSensor) -> Result<SensorModel, Error> {
    let mut model = match raw.preset.as_deref() {
        None | Some("kinect-v1") => SensorModel::KINECT_V1,
        Some("stereo") => SensorModel::STEREO,
        Some("perfect") => SensorModel::PERFECT,
        Some(other) => {
            return Err(wrong(
                "[sensor] preset",
                format!("`{other}` is no preset; there are kinect-v1, stereo and perfect"),
            ));
        }
    };
    for term in &raw.off {
        let Some((_, switch_off)) = TERMS.iter().find(|(name, _)| name == term) else {
            let names = TERMS.map(|(name, _)| name).join(", ");
            let rule = format!("`{term}` is no error term; there are {names}");
            return Err(wrong("[sensor] off", rule));
        };
        switch_off(&mut model);
    }
    Ok(model)
}

/// Error term of the sensor: its name and its switch.
type ErrorTerm = (&'static str, fn(&mut SensorModel));

/// Error terms that a scene can switch off.
const TERMS: [ErrorTerm; 11] = [
    ("quantisation", |model| model.quantisation = None),
    ("axial-noise", |model| model.axial_noise = None),
    ("lateral-noise", |model| model.lateral_noise = None),
    ("edge-fattening", |model| model.edge_fattening = None),
    ("matching-window", |model| model.matching_window = None),
    ("projector-shadow", |model| model.projector_shadow = None),
    ("weak-signal", |model| model.weak_signal = None),
    ("border-speckle", |model| model.border_speckle = None),
    ("range", |model| model.range = None),
    ("blind-columns", |model| model.n_blind_columns = 0),
    ("color", |model| model.color = SensorModel::PERFECT.color),
];
