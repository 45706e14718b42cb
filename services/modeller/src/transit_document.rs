//! Path of the arm as a JSON document.

use arm_kinematics::Arm;
use serde::Serialize;
use transport::TransitPath;

/// Path of the arm: straight motions of its joints from one configuration to the next.
#[derive(Debug, Serialize)]
pub(crate) struct PathDocument {
    /// `over_safe_height` or `random_tree`.
    pub(crate) kind: &'static str,
    /// Joint angles of each configuration, radians; the first are those at which it begins.
    pub(crate) waypoints_rad: Vec<[f64; 6]>,
    /// Time that the arm needs at its full speed.
    pub(crate) seconds: f64,
    /// Number of nodes of the random tree; 0 without one.
    pub(crate) n_nodes: usize,
}

/// Document of a path.
pub(crate) fn path(path: &TransitPath, arm: &Arm) -> PathDocument {
    PathDocument {
        kind: path.kind.word(),
        waypoints_rad: path
            .waypoints_rad
            .iter()
            .map(|joints| (*joints).into())
            .collect(),
        seconds: path.duration_s(arm),
        n_nodes: path.n_nodes,
    }
}

/// Path in words.
pub(crate) fn path_words(path: &PathDocument) -> String {
    let kind = match path.kind {
        "over_safe_height" => "over what stands there",
        _ => "around what stands there",
    };
    let n = path.waypoints_rad.len().saturating_sub(1);
    let motions = if n == 1 { "motion" } else { "motions" };
    format!("{n} {motions} {kind}, {:.1} s", path.seconds)
}
