//! Order of a task: its goal, checked against the places of the configuration.

use crate::config::Config;
use control_protocol::{Refusal, RefusalKind, TaskKind, TaskOrder};
use tasks::TaskGoal;

/// Name of the place where a person takes what was fetched.
const HAND_OVER_PLACE: &str = "hand-over";

/// Goal of an order.
///
/// # Errors
/// A refusal about an order that cannot be carried out with these places.
pub(super) fn goal(order: &TaskOrder, config: &Config) -> Result<TaskGoal, Refusal> {
    let invalid = |sentence: String| Refusal::new(RefusalKind::Invalid, sentence);
    if config.places.iter().next().is_none() {
        return Err(invalid(
            "no place is known to which things could be carried; write [places.NAME] into the \
             configuration, see `tabula config explain places.NAME.outline`"
                .to_owned(),
        ));
    }
    match (order.kind, &order.category, order.track_id) {
        (TaskKind::ClearTable, None, None) => Ok(TaskGoal::ClearTable),
        (TaskKind::ClearTable, _, _) => Err(invalid(
            "clearing the table takes no object; fetch one in place of it".to_owned(),
        )),
        (TaskKind::Fetch, Some(category), None) => Ok(TaskGoal::FetchCategory {
            category: category.clone(),
            place: fetched_to(order, config)?,
        }),
        (TaskKind::Fetch, None, Some(track)) => Ok(TaskGoal::FetchTrack {
            track,
            place: fetched_to(order, config)?,
        }),
        (TaskKind::Fetch, _, _) => Err(invalid(
            "a fetch needs a category or a track-id, and not both".to_owned(),
        )),
    }
}

/// Place to which an object is fetched.
fn fetched_to(order: &TaskOrder, config: &Config) -> Result<String, Refusal> {
    let name = order.place.as_deref().unwrap_or(HAND_OVER_PLACE);
    if config.places.get(name).is_some() {
        return Ok(name.to_owned());
    }
    let known: Vec<&str> = config.places.iter().map(|(name, _)| name).collect();
    let known = known.join(", ");
    let sentence = format!("there is no place {name:?}; the places are {known}");
    Err(Refusal::new(RefusalKind::Invalid, sentence))
}
