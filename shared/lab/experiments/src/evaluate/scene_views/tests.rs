use super::*;
use crate::arguments::AblationVariant;
use std::fs;

#[test]
fn scene_views_find_most_objects_and_are_reproducible() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join(PICTURES)).unwrap();
    let method = RecognitionMethod::of_ablation(AblationVariant::Ours, 15);
    let output = Output::new(true);
    let simulated = || simulate(12, 4, method, folder.path(), &output).unwrap();
    let views = simulated();
    let n_visible: u32 = views.statistics.n_visible.iter().sum();
    assert_eq!(n_visible + views.statistics.n_hidden, 2 * 41);
    let n_found = views.table.labels.len();
    assert!(
        n_found > 60 && n_found <= n_visible as usize,
        "{n_found} of {n_visible}"
    );
    let n_clutter = views.scenes_of_clutter.len();
    assert_eq!(views.descriptions.len(), n_found + n_clutter);
    assert_eq!(views.kinds, (0..12).collect::<Vec<_>>());
    for (_, place) in &views.statistics.pictures {
        assert!(folder.path().join(place).is_file(), "{place}");
    }
    assert_eq!(views.statistics.pictures.len(), 12);
    let again = simulated();
    assert_eq!(again.table.labels, views.table.labels);
    assert_eq!(again.descriptions, views.descriptions);
}
