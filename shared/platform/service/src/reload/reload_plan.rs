//! Reload plan: the differences of two configurations, split into those that a running process
//! takes and those that need a restart.

use crate::configuration::{as_number, one_line};
use crate::{Configuration, KeyReference, SECTIONS};
use control_protocol::KeyChange;
use std::collections::BTreeSet;
use toml::Value;

/// Text for a key that has no value.
const NO_VALUE: &str = "(none)";

/// Differences in one section between the configuration of a running process and a new one.
#[derive(Debug, Clone, PartialEq)]
pub struct ReloadPlan {
    /// New configuration, but with the old values of the keys that need a restart.
    pub effective: Configuration,
    /// Changes that the process takes.
    pub applied: Vec<KeyChange>,
    /// Changes that need a restart of the process.
    pub needs_restart: Vec<KeyChange>,
}

impl ReloadPlan {
    /// Compares a section. `running` is the effective configuration of the process.
    pub fn new(running: &Configuration, found: &Configuration, section: &str) -> Self {
        let mut plan = Self {
            effective: found.clone(),
            applied: Vec::new(),
            needs_restart: Vec::new(),
        };
        let Some(section) = SECTIONS.into_iter().find(|known| *known == section) else {
            return plan;
        };
        let keys: BTreeSet<&str> = running.keys(section).chain(found.keys(section)).collect();
        for key in keys {
            let values = (
                running.effective(section, key),
                found.effective(section, key),
            );
            if is_equal(values.0, values.1) {
                continue;
            }
            let change = KeyChange {
                key: format!("{section}.{key}"),
                from: text_of(values.0),
                to: text_of(values.1),
            };
            let description = KeyReference::get().key(section, key);
            if description.is_some_and(|one| one.is_live) {
                plan.applied.push(change);
                continue;
            }
            plan.needs_restart.push(change);
            match running.setting(section, key) {
                Some(old) => plan.effective.set(section, key.to_owned(), old.clone()),
                None => plan.effective.unset(section, key),
            }
        }
        plan
    }
}

/// Equality of values, 5 and 5.0 included.
fn is_equal(one: Option<&Value>, other: Option<&Value>) -> bool {
    let number = |value: Option<&Value>| value.and_then(as_number);
    match (number(one), number(other)) {
        (Some(one), Some(other)) => one == other,
        _ => one == other,
    }
}

fn text_of(value: Option<&Value>) -> String {
    value.map_or_else(|| NO_VALUE.to_owned(), |value| one_line(&value.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn read(text: &str) -> Configuration {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        Configuration::find(Some(file.path()), Path::new("/nowhere")).unwrap()
    }

    fn names(changes: &[KeyChange]) -> Vec<String> {
        changes.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn plan_splits_live_changes_from_those_that_need_a_restart() {
        let running =
            read("[perception]\nworkers = 1\nrange_max_m = 3.0\n[memory]\nworld_kept_max = 200\n");
        let found = read("[perception]\nworkers = 3\nrange_min_m = 1\n");
        let plan = ReloadPlan::new(&running, &found, "perception");
        let applied = [
            "perception.range_max_m 3.0 -> 2.0",
            "perception.range_min_m 0.35 -> 1",
        ];
        assert_eq!(names(&plan.applied), applied);
        assert_eq!(names(&plan.needs_restart), ["perception.workers 1 -> 3"]);
        let effective = |key| {
            plan.effective
                .effective("perception", key)
                .unwrap()
                .to_string()
        };
        assert_eq!(effective("workers"), "1");
        assert_eq!(effective("range_min_m"), "1");
        assert_eq!(effective("range_max_m"), "2.0");
        // A restart is still needed at the next reload, and not when the change is taken back.
        let again = ReloadPlan::new(&plan.effective, &found, "perception");
        assert_eq!(again.applied, []);
        assert_eq!(names(&again.needs_restart), ["perception.workers 1 -> 3"]);
        let back = read("[perception]\nworkers = 1\nrange_min_m = 1.0\n");
        let back = ReloadPlan::new(&plan.effective, &back, "perception");
        assert_eq!((back.applied, back.needs_restart), (vec![], vec![]));
    }

    #[test]
    fn plan_of_equal_values_is_empty() {
        let written = read("[camera]\nrate_hz = 30\nlockstep = false\n");
        let plan = ReloadPlan::new(&Configuration::default(), &written, "camera");
        assert_eq!(
            (&plan.applied[..], &plan.needs_restart[..]),
            (&[][..], &[][..])
        );
        let named = read("[camera]\nsource = 'kinect'\n");
        let plan = ReloadPlan::new(&Configuration::default(), &named, "camera");
        let change = "camera.source (none) -> \"kinect\"";
        assert_eq!(names(&plan.needs_restart), [change]);
        assert_eq!(plan.effective.setting("camera", "source"), None);
    }
}
