use super::query_file::SceneChange;
use super::*;
use std::path::Path;

fn arguments(out: &Path) -> FindArguments {
    FindArguments {
        scenes: 2,
        queries_per_scene: 10,
        queries: None,
        wordnet: "no-such-folder".into(),
        seed: 3,
        out: out.to_owned(),
    }
}

#[test]
fn find_report_has_queries_pictures_and_few_wrong_answers() {
    let out = tempfile::tempdir().unwrap();
    run(&arguments(out.path()), &Output::new(true)).unwrap();
    let json = std::fs::read(out.path().join("find.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let count = |key: &str| report["generated"][key].as_u64().unwrap();
    assert!(count("n_asked") >= 12, "{report}");
    assert!(4 * count("n_right") >= 3 * count("n_asked"), "{report}");
    assert!(out.path().join("scenes/02.png").exists());
}

#[test]
fn query_file_of_another_seed_is_refused_or_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("queries.toml");
    let text = "seed = 4\n[[query]]\nscene = 2\nwords = \"the mug\"\nobjects = [3, 1]\n";
    std::fs::write(&file, text).unwrap();
    let queries = query_file::read(Some(&file), 4).unwrap();
    assert_eq!(queries.of_scene(2)[0].objects, [1, 3]);
    let refused = query_file::read(Some(&file), 5).unwrap_err();
    assert!(refused.to_string().contains("seed 4"), "{refused}");
    assert!(
        query_file::read(None, 12345)
            .unwrap()
            .of_scene(1)
            .is_empty()
    );
    std::fs::write(&file, "seed = ").unwrap();
    assert!(query_file::read(Some(&file), 4).is_err());
}

#[test]
fn query_file_teaches_other_names_and_takes_objects_away() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("queries.toml");
    let text = "seed = 4\n[names]\nmug = \"orange-juice\"\n[[scene]]\nnumber = 1\n\
                names = { 2 = \"green-tea\" }\ngone = [2]\n";
    std::fs::write(&file, text).unwrap();
    let queries = query_file::read(Some(&file), 4).unwrap();
    let change = queries.change(1).unwrap();
    assert_eq!(change.names_by_category["mug"], "orange-juice");
    let mut scene = QueryScene::simulate(4, 1).unwrap();
    scene.apply(&change).unwrap();
    let object = |scene: &QueryScene| scene.objects.iter().find(|o| o.id == 2).cloned().unwrap();
    assert_eq!(object(&scene).category, "green-tea");
    let answer = find("the green tea", &scene.world(), None).unwrap();
    assert_eq!(Some(answer.matches[0].track_id), object(&scene).track_id);
    assert!(
        answer.matches[0].doubts[0].contains("is gone"),
        "{answer:?}"
    );
    let refused = scene.apply(&SceneChange {
        gone: vec![99],
        ..SceneChange::default()
    });
    assert!(refused.unwrap_err().to_string().contains("object 99"));
    std::fs::write(&file, text.replace("{ 2 =", "{ mug =")).unwrap();
    let queries = query_file::read(Some(&file), 4).unwrap();
    assert!(queries.change(1).is_err() && queries.change(2).is_ok());
}
