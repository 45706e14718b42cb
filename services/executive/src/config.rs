//! Configuration of the executive: its own section, the gripper and the places.

use arm_kinematics::GripperModel;
use geometry::ConvexPolygon;
use grasp_scene::{PLACES_SECTION, Places};
use nalgebra::Point2;
use serde::Deserialize;
use service::{Configuration, Failure};
use std::time::Duration;
use tasks::{NamedPlace, TaskRules, UnnamedPolicy};

/// Name of the section.
const SECTION: &str = "executive";
/// Section with the gripper.
const GRIPPER_SECTION: &str = "gripper";

/// Section `[executive]` as written in TOML.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawConfig {
    standard_items: Vec<String>,
    unnamed: Unnamed,
    doubts_are_unnamed: bool,
    ask_patience_s: f64,
    person_distance_m: f64,
    planning_time_s: f64,
}

/// Policy for objects without a name, as written in TOML.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Unnamed {
    Ask,
    Leave,
    UnknownPlace,
}

/// Validated configuration of the executive.
#[derive(Debug, Clone)]
pub(crate) struct Config {
    /// Rules of the tasks.
    pub(crate) rules: TaskRules,
    /// Time for which a person is asked for names.
    pub(crate) ask_patience: Duration,
    /// Distance from a person within which the arm waits, metres.
    pub(crate) person_distance_m: f64,
    /// Time of the source that passes for each planning in lockstep.
    pub(crate) planning_time: Duration,
    /// Gripper of the arm.
    pub(crate) gripper: GripperModel,
    /// Places of the configuration.
    pub(crate) places: Places,
    /// The same places as a task sees them.
    pub(crate) named_places: Vec<NamedPlace>,
}

impl Config {
    /// Reads the sections of the configuration.
    ///
    /// # Errors
    /// A usage failure that names the value and its rule.
    pub(crate) fn new(found: &Configuration) -> Result<Self, Failure> {
        let raw: RawConfig = found.section_with_defaults(SECTION)?;
        let by_name = found.section(PLACES_SECTION)?;
        let wrong = |cause: String| found.wrong(PLACES_SECTION, &[], cause);
        let places = Places::checked(by_name).map_err(wrong)?;
        Ok(Self {
            named_places: named(&places),
            rules: TaskRules {
                standard_items: raw.standard_items,
                unnamed: match raw.unnamed {
                    Unnamed::Ask => UnnamedPolicy::Ask,
                    Unnamed::Leave => UnnamedPolicy::Leave,
                    Unnamed::UnknownPlace => UnnamedPolicy::UnknownPlace,
                },
                doubts_are_unnamed: raw.doubts_are_unnamed,
                is_answer_overdue: false,
            },
            ask_patience: Duration::from_secs_f64(raw.ask_patience_s),
            person_distance_m: raw.person_distance_m,
            planning_time: Duration::from_secs_f64(raw.planning_time_s),
            gripper: found.section(GRIPPER_SECTION)?,
            places,
        })
    }
}

/// Places as a task sees them.
fn named(places: &Places) -> Vec<NamedPlace> {
    let named = places.iter().map(|(name, place)| {
        let corners = place.outline.iter().copied();
        let mut corners: Vec<Point2<f64>> = corners.map(Point2::from).collect();
        NamedPlace {
            name: name.to_owned(),
            categories: place.categories.clone(),
            outline: ConvexPolygon::convex_hull_of(&mut corners),
        }
    });
    named.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn section_agrees_with_the_key_reference() {
        service::check_section_reference(SECTION, Config::new).unwrap();
    }
}
