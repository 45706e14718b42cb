//! Tests of scene files: valid files, and the message of each fault.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a failing set-up must fail the test"
)]

use simulated_world::{
    ModelChoice, ModelLibrary, ObjectPlacement, ObjectPlan, ObjectState, Scene, World,
};
use std::path::Path;

fn parsed(text: &str) -> Result<(Scene, ModelLibrary), simulated_world::Error> {
    Scene::from_toml(text, Path::new(""), None)
}

fn sentence(text: &str) -> String {
    match parsed(text) {
        Ok((scene, _)) => panic!("accepted: {text}\n{scene:?}"),
        Err(error) => error.to_string(),
    }
}

const EVERYTHING: &str = r#"
seed = 12
kind = "isolated"
objects = 3

[table]
size_m = [1.6, 1.0]
height_m = 0.8

[bin]
inner_size_m = [0.3, 0.3, 0.1]

[camera]
look_at_m = [0.0, 0.1, 0.8]
distance_m = 1.2
elevation_deg = 50
azimuth_deg = -20
orbit_deg_s = 3

[arm]
position_m = [-0.5, -0.6, 0.8]
yaw_deg = 45

[[object]]
category = "mug"
instance = 4
position_m = [0.3, 0.2]
yaw_deg = 90

[[object]]
category = "banana"
position_m = [-0.3, 0.2]
roll_deg = 30
drop_from_m = 0.1

[person]
by_chance = true
every_s = [3, 5]

[[person.action]]
at_s = 6
do = "remove"
object = 2

[[person.action]]
at_s = 1
do = "put"
category = "egg"
to_m = [0.1, 0.1]

[[person.action]]
at_s = 2
do = "move"
object = 1
to_m = [0.1, -0.1]

[[person.action]]
at_s = 3
do = "lift"
object = 1
for_s = 1

[[person.action]]
at_s = 4
do = "hide"
object = 1

[sensor]
preset = "perfect"
off = ["color"]
"#;

#[test]
fn scene_file_with_all_keys_is_parsed() {
    let (scene, library) = parsed(EVERYTHING).unwrap();
    assert_eq!(scene.seed, 12);
    assert_eq!(scene.objects.len(), 5);
    assert!((scene.table.height_m - 0.8).abs() < 1e-12);
    assert_eq!(scene.bin.unwrap().inner_size_m, [0.3, 0.3, 0.1]);
    assert!((scene.camera.azimuth_deg + 20.0).abs() < 1e-12);
    assert!((scene.arm.unwrap().yaw_deg - 45.0).abs() < 1e-12);
    assert!(matches!(
        scene.objects[3].placement,
        ObjectPlacement::Upright {
            position_m: [0.3, 0.2],
            ..
        }
    ));
    let ObjectPlacement::Dropped { world_from_object } = &scene.objects[4].placement else {
        panic!("{:?}", scene.objects[4]);
    };
    assert!((world_from_object.translation.z - 0.9).abs() < 1e-12);
    let person = scene.person.as_ref().unwrap();
    assert_eq!(person.random_pause_s, Some([3.0, 5.0]));
    let times: Vec<f64> = person.script.iter().map(|action| action.at_s).collect();
    assert_eq!(times, [1.0, 2.0, 3.0, 4.0, 6.0], "sorted by time");
    let world = World::new(scene, library).unwrap();
    assert!(world.arm_status().is_some());
    assert!(!world.person_capsules().is_empty());
}

/// Scenario with two equal objects, of which the script names the first.
const SCENARIO: &str = r#"
duration_s = 9.5

[vary]
instances = 1000
shift_m = 0.02
turn_deg = 90.0
shuffle = true

[[object]]
category = "mug"
position_m = [0.0, -0.2]

[[object]]
category = "mug"
position_m = [-0.3, 0.0]

[[object]]
category = "soda-can"
position_m = [0.3, 0.0]

[[object]]
category = "bowl"
position_m = [0.0, 0.2]

[person]
pace = 2

[[person.action]]
at_s = 1
do = "move"
object = 1
to_m = [0.1, 0.0]
"#;

/// Instances and positions of the scenario's objects.
fn varied_objects(seed: u64) -> Vec<(u64, [f64; 2])> {
    let (scene, _) = Scene::from_toml(SCENARIO, Path::new(""), Some(seed)).unwrap();
    assert_eq!(scene.duration_s, Some(9.5));
    assert_eq!(scene.person.unwrap().pace, 2.0);
    let objects = scene.objects.iter().map(|plan| match plan {
        ObjectPlan {
            model: ModelChoice::Generated { instance, .. },
            placement: ObjectPlacement::Upright { position_m, .. },
        } => (*instance, *position_m),
        other => panic!("{other:?}"),
    });
    objects.collect()
}

#[test]
fn scene_variation_changes_instances_and_positions_by_seed() {
    let places = [[0.0, -0.2], [-0.3, 0.0], [0.3, 0.0], [0.0, 0.2]];
    let mut is_shuffled = false;
    for seed in 1..=20 {
        let objects = varied_objects(seed);
        assert_eq!(objects, varied_objects(seed));
        assert_eq!(objects[0].0, objects[1].0, "alike objects stay alike");
        assert_ne!(objects, varied_objects(seed + 20));
        let place_of = |at: &[f64; 2]| {
            let is_near = |place: &&[f64; 2]| (0..2).all(|i| (at[i] - place[i]).abs() <= 0.02);
            places.iter().position(|place| is_near(&place)).unwrap()
        };
        let mut found: Vec<usize> = objects.iter().map(|(_, at)| place_of(at)).collect();
        assert_eq!(found[0], 0, "the script's object stays");
        is_shuffled |= found != [0, 1, 2, 3];
        found.sort_unstable();
        assert_eq!(found, [0, 1, 2, 3], "each place is taken once");
    }
    assert!(is_shuffled);
}

#[test]
fn empty_scene_file_is_an_empty_table() {
    let (scene, library) = parsed("").unwrap();
    assert!(scene.objects.is_empty() && scene.arm.is_none() && scene.person.is_none());
    let world = World::new(scene, library).unwrap();
    assert!(world.objects().is_empty());
}

#[test]
fn scene_file_parsing_is_deterministic() {
    let objects = || parsed(EVERYTHING).unwrap().0.objects;
    assert_eq!(objects(), objects());
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table of faults")]
fn scene_file_errors_name_the_key_and_the_rule() {
    let object = |keys: &str| format!("[[object]]\nposition_m = [0, 0]\n{keys}");
    let mug = |keys: &str| object(&format!("category = \"mug\"\n{keys}"));
    let action = |keys: &str| format!("[[person.action]]\nat_s = 1\n{keys}");
    let cases = [
        ("colour = 3".to_owned(), "colour"),
        ("[table]\nwidth_m = 3".to_owned(), "width_m"),
        ("[table]\nheight_m = nan".to_owned(), "[table] height_m"),
        ("[table]\nsize_m = [9.0, 0.8]".to_owned(), "[table] size_m"),
        ("[table]\nsize_m = [1.0]".to_owned(), "size_m"),
        (
            "[bin]\ninner_size_m = [0.3, 0.3, inf]".to_owned(),
            "[bin] inner_size_m",
        ),
        (
            "[camera]\ndistance_m = 0.1".to_owned(),
            "[camera] distance_m",
        ),
        (
            "[camera]\nelevation_deg = 90".to_owned(),
            "[camera] elevation_deg",
        ),
        (
            "[camera]\nlook_at_m = [0, nan, 0]".to_owned(),
            "[camera] look_at_m",
        ),
        ("[arm]\nyaw_deg = 1e9".to_owned(), "[arm] yaw_deg"),
        ("kind = \"heap\"".to_owned(), "`heap` is no kind of scene"),
        ("objects = 3".to_owned(), "needs a `kind`"),
        ("kind = \"pile\"\nobjects = 61".to_owned(), "at most 60"),
        ("kind = \"pile\"\nobjects = -1".to_owned(), "objects"),
        ("seed = -1".to_owned(), "seed"),
        (object(""), "[[object]] 1"),
        (mug("model = \"mug.ply\""), "either `category` or `model`"),
        (mug("yaw_deg = nan"), "[[object]] 1 yaw_deg"),
        (mug("drop_from_m = 3"), "[[object]] 1 drop_from_m"),
        (mug("instance = -1"), "instance"),
        (
            format!(
                "{}\n[[object]]\ncategory = \"egg\"\nposition_m = [4, 0]",
                mug("")
            ),
            "[[object]] 2 position_m",
        ),
        ("[[object]]\ncategory = \"mug\"".to_owned(), "position_m"),
        ("[person]\nevery_s = [5, 3]".to_owned(), "[person] every_s"),
        (action("do = \"dance\""), "`dance` is nothing"),
        (
            action("do = \"put\"\nto_m = [0, 0]"),
            "[[person.action]] 1 category",
        ),
        (
            action("do = \"put\"\ncategory = \"egg\""),
            "[[person.action]] 1 to_m",
        ),
        (
            action("do = \"move\"\nto_m = [0, 0]"),
            "[[person.action]] 1 object",
        ),
        (
            action("do = \"move\"\nobject = 1"),
            "[[person.action]] 1 to_m",
        ),
        (
            action("do = \"move\"\nobject = 1\nto_m = [nan, 0]"),
            "[[person.action]] 1 to_m",
        ),
        (action("do = \"lift\""), "[[person.action]] 1 object"),
        (action("do = \"hide\""), "[[person.action]] 1 object"),
        (action("do = \"remove\""), "[[person.action]] 1 object"),
        (
            action("do = \"lift\"\nobject = 1\nfor_s = nan"),
            "[[person.action]] 1 for_s",
        ),
        (
            "[[person.action]]\nat_s = -1\ndo = \"remove\"\nobject = 1".to_owned(),
            "[[person.action]] 1 at_s",
        ),
        (
            "[sensor]\npreset = \"kinect\"".to_owned(),
            "[sensor] preset",
        ),
        ("[sensor]\noff = [\"noise\"]".to_owned(), "[sensor] off"),
        ("models = \"no-such-folder\"".to_owned(), "no-such-folder"),
        ("this is no TOML".to_owned(), "not a scene"),
    ];
    for (text, expected) in cases {
        let message = sentence(&text);
        assert!(message.contains(expected), "{text}\n→ {message}");
    }
}

#[test]
fn scene_file_errors_name_missing_models() {
    for (text, expected) in [
        (
            "[[object]]\ncategory = \"unicorn\"\nposition_m = [0, 0]",
            "`unicorn`",
        ),
        (
            "[[object]]\nmodel = \"missing.ply\"\nposition_m = [0, 0]",
            "missing.ply",
        ),
    ] {
        let message = sentence(text);
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn scene_file_with_more_than_sixty_objects_is_rejected() {
    let one = "[[object]]\ncategory = \"dice\"\nposition_m = [0, 0]\n";
    assert_eq!(parsed(&one.repeat(60)).unwrap().0.objects.len(), 60);
    let message = sentence(&one.repeat(61));
    assert!(
        message.contains("[[object]]") && message.contains("at most 60"),
        "{message}"
    );
    let message = sentence(&format!("kind = \"pile\"\nobjects = 60\n{one}"));
    assert!(message.contains("at most 60"), "{message}");
}

#[test]
fn scene_file_that_is_too_large_or_no_text_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |path: &Path| Scene::open(path, None).unwrap_err().to_string();
    let large = folder.path().join("large.toml");
    std::fs::write(&large, "# nothing\n".repeat(200_000)).unwrap();
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, [0x73, 0xff, 0xfe, 0x00]).unwrap();
    let missing = folder.path().join("missing.toml");
    for path in [large.as_path(), &binary, &missing, folder.path()] {
        let message = refused(path);
        assert!(message.contains(&*path.to_string_lossy()), "{message}");
    }
    assert!(refused(&large).contains("1 MiB"));
}

#[test]
fn scene_file_paths_are_relative_to_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.toml");
    let text = "[[object]]\nmodel = \"things/cup.ply\"\nposition_m = [0, 0]";
    std::fs::write(&file, text).unwrap();
    let message = Scene::open(&file, None).unwrap_err().to_string();
    let expected = folder.path().join("things/cup.ply");
    assert!(message.contains(&*expected.to_string_lossy()), "{message}");
}

#[test]
fn fallen_object_is_reported_once() {
    let text = "[[object]]\ncategory = \"mug\"\nposition_m = [1.0, 0.0]\n\
                [[object]]\ncategory = \"egg\"\nposition_m = [0.0, 0.0]";
    let (scene, library) = parsed(text).unwrap();
    let mut world = World::new(scene, library).unwrap();
    assert_eq!(world.objects()[0].state, ObjectState::OnFloor);
    assert_eq!(world.objects()[1].state, ObjectState::Settled);
    let notes = world.take_notes();
    let fallen = notes
        .iter()
        .filter(|note| note.contains("fell off the table"));
    assert_eq!(fallen.count(), 1, "{notes:?}");
    for _ in 0..120 {
        world.step();
    }
    assert_eq!(world.take_notes(), Vec::<String>::new());
}
