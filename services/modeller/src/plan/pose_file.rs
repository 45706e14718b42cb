//! Files of camera poses: a JSON list of positions and orientations.

use geometry::RigidTransform;
use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector3};
use serde::Deserialize;
use serde_json::Value;
use service::Failure;
use std::path::Path;

/// Number of poses of a file at most, as of spread candidates.
const N_POSES_MAX: usize = 1000;
/// Size of a file at most, bytes.
const FILE_BYTES_MAX: u64 = 1 << 20;
/// Deviation of a quaternion's length from 1 that rounding to two digits explains.
const LENGTH_TOLERANCE: f64 = 0.02;
/// Format of a file for the sentences of its errors.
const FORMAT: &str = "[{\"position_m\": [x, y, z], \"orientation_xyzw\": [x, y, z, w]}, …]";

/// Camera pose of a file; other keys are ignored.
#[derive(Deserialize)]
struct FilePose {
    position_m: [f64; 3],
    orientation_xyzw: [f64; 4],
}

/// Reads the poses of a file; the list may be empty.
///
/// # Errors
/// When the file cannot be read, is no list, or has a bad entry, which is named by its index.
pub(crate) fn read(path: &Path) -> Result<Vec<RigidTransform>, Failure> {
    let cannot = |what: &dyn std::fmt::Display| {
        Failure::usage(format!("the file of poses {} {what}", path.display()))
    };
    let size = std::fs::metadata(path).map(|metadata| metadata.len());
    let size = size.map_err(|error| cannot(&format!("cannot be read: {error}")))?;
    if size > FILE_BYTES_MAX {
        return Err(cannot(&format!(
            "has {size} bytes, and at most {FILE_BYTES_MAX} are read; give fewer poses"
        )));
    }
    let text = std::fs::read_to_string(path);
    let text = text.map_err(|error| cannot(&format!("cannot be read: {error}")))?;
    parse(&text).map_err(|what| cannot(&what))
}

/// Poses of a JSON text; the error continues a sentence that begins with the file.
fn parse(text: &str) -> Result<Vec<RigidTransform>, String> {
    let entries: Vec<Value> = serde_json::from_str(text)
        .map_err(|error| format!("is no JSON list ({error}); write {FORMAT}"))?;
    if entries.len() > N_POSES_MAX {
        let n = entries.len();
        return Err(format!(
            "has {n} poses, and at most {N_POSES_MAX} are read; give fewer"
        ));
    }
    let numbered = entries.into_iter().enumerate();
    numbered
        .map(|(index, entry)| {
            let pose = FilePose::deserialize(entry)
                .map_err(|error| format!("has a bad entry {index} ({error}); write {FORMAT}"))?;
            rigid(&pose).map_err(|what| format!("has a bad entry {index}: {what}"))
        })
        .collect()
}

fn rigid(pose: &FilePose) -> Result<RigidTransform, String> {
    let [x, y, z, w] = pose.orientation_xyzw;
    let orientation = Quaternion::new(w, x, y, z);
    let length = orientation.norm();
    // NaN is in no range.
    if !(1.0 - LENGTH_TOLERANCE..=1.0 + LENGTH_TOLERANCE).contains(&length) {
        return Err(format!(
            "its orientation_xyzw has the length {length:.3}; give a unit quaternion"
        ));
    }
    if !pose.position_m.iter().all(|c| c.is_finite()) {
        return Err("its position_m is not finite; give metres".into());
    }
    let position = Vector3::from(pose.position_m);
    Ok(RigidTransform::from_parts(
        Translation3::from(position),
        UnitQuaternion::from_quaternion(orientation),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_are_read_and_rounded_quaternions_made_unit() {
        let text = r#"[{"position_m": [0.5, -0.2, 1.25], "orientation_xyzw": [0.71, 0, 0, 0.71],
                        "name": "left"}]"#;
        let poses = parse(text).unwrap();
        assert_eq!(poses.len(), 1);
        assert_eq!(poses[0].translation.vector, Vector3::new(0.5, -0.2, 1.25));
        assert!((poses[0].rotation.angle() - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
        assert_eq!(parse("[]").unwrap(), []);
    }

    #[test]
    fn bad_files_are_refused_with_the_index_of_the_bad_entry() {
        let good = r#"{"position_m": [0, 0, 1], "orientation_xyzw": [1, 0, 0, 0]}"#;
        for (text, words) in [
            ("", "is no JSON list"),
            ("{}", "is no JSON list"),
            ("[1]", "bad entry 0"),
            (
                &format!("[{good}, {{\"position_m\": [0, 0, 1]}}]"),
                "bad entry 1 (missing field",
            ),
            (
                r#"[{"position_m": [0, 0], "orientation_xyzw": [1, 0, 0, 0]}]"#,
                "bad entry 0 (invalid length 2",
            ),
            (
                &format!("[{good},{good},{}]", good.replace("[1, 0", "[2, 0")),
                "bad entry 2: its orientation_xyzw has the length 2.000",
            ),
            (
                &format!("[{}{good}]", format!("{good},").repeat(1000)),
                "has 1001 poses",
            ),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
        let missing = read(Path::new("/nowhere/poses.json")).unwrap_err();
        assert!(
            missing
                .sentence
                .contains("/nowhere/poses.json cannot be read"),
            "{missing}"
        );
    }
}
