//! Detection on real labelled scenes.

mod scoring;

use dataset::pcd;
use detection::{Config, Detection, Frame, Workspace, detect};
use point_cloud::OrganizedCloud;
use scoring::{Score, score};
use std::path::PathBuf;

fn scenes() -> Vec<PathBuf> {
    let root = std::env::var("TABULA_DATA")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data").into());
    let folder = PathBuf::from(root).join("tabletop-scenes");
    let entries = std::fs::read_dir(&folder).expect("TABULA_DATA must hold tabletop-scenes");
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("a readable folder").path())
        .collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "pcd"));
    paths.sort_by_key(|path| (path.as_os_str().len(), path.clone()));
    assert!(!paths.is_empty(), "no scenes in {}", folder.display());
    paths
}

fn segments(detection: &Detection, n_points: usize) -> Vec<u32> {
    let mut segment_of = vec![0; n_points];
    for (i, candidate) in detection.candidates.iter().enumerate() {
        for &pixel in detection.points_of(candidate) {
            segment_of[pixel as usize] = i as u32 + 1;
        }
    }
    segment_of
}

fn line(name: &str, s: &Score) -> String {
    format!(
        "{name:10} WOv {:5.1} UOv {:5.1} Fos {:5.1} Fus {:5.1} P50 {:5.1} R50 {:5.1} F50 {:5.1} f75 {:5.1} {}/{}",
        100.0 * s.wov,
        100.0 * s.uov,
        100.0 * s.fos,
        100.0 * s.fus,
        100.0 * s.p50,
        100.0 * s.r50,
        100.0 * s.f50,
        100.0 * s.f75,
        s.n_segments,
        s.n_objects
    )
}

fn mean(scores: &[Score]) -> Score {
    let n = scores.len() as f64;
    let of = |value: fn(&Score) -> f64| scores.iter().map(value).sum::<f64>() / n;
    Score {
        n_objects: scores.iter().map(|s| s.n_objects).sum(),
        n_segments: scores.iter().map(|s| s.n_segments).sum(),
        wov: of(|s| s.wov),
        uov: of(|s| s.uov),
        fos: of(|s| s.fos),
        fus: of(|s| s.fus),
        p50: of(|s| s.p50),
        r50: of(|s| s.r50),
        f50: of(|s| s.f50),
        f75: of(|s| s.f75),
    }
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn objects_of_labelled_scenes_are_found() {
    let (mut workspace, mut detection) = (Workspace::default(), Detection::default());
    let mut scores = Vec::new();
    for path in scenes() {
        let scene = pcd::open(&path).unwrap();
        let cloud = OrganizedCloud::new(&scene.points, scene.width, scene.height).unwrap();
        let frame = Frame {
            cloud,
            up_in_camera: None,
            seed: 1,
        };
        detect(&frame, &Config::default(), &mut workspace, &mut detection).unwrap();
        let found = segments(&detection, scene.points.len());
        if let Some(score) = score(&found, &scene.labels.unwrap()) {
            println!(
                "{}",
                line(path.file_stem().unwrap().to_str().unwrap(), &score)
            );
            scores.push(score);
        }
    }
    let all = mean(&scores);
    println!("{}", line("all", &all));
    // The best peer, LCCP of PCL: WOv 95.3 and F50 92.3 (see reference/peers).
    assert!(all.wov > 0.955 && all.f50 > 0.96, "{all:?}");
}
