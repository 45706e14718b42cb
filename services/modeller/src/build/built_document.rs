//! Answer of `tabula model build`.

use super::construction::Constructed;
use crate::growth::Growth;
use crate::next_move::NextMove;
use object_model::ObjectModel;
use serde::Serialize;

/// Built model as a JSON document.
#[derive(Debug, Serialize)]
pub(super) struct BuiltDocument {
    name: String,
    track: u64,
    /// Time from the start to the stored model, seconds.
    seconds: f64,
    views: usize,
    refused: usize,
    /// Number of views that were taken and not added.
    left_out: usize,
    /// Reasons of the refused views with their numbers.
    reasons: Vec<(String, usize)>,
    is_closed_loop: bool,
    /// `true` if the views were brought into agreement at the end.
    is_agreed: bool,
    /// Share of all directions from which the object was seen, 0 to 1.
    completeness: f64,
    /// Parts that are still missing, in words.
    missing: Vec<String>,
    /// Move of the camera to what is missing; null where nothing more can be seen.
    next_move: Option<NextMove>,
    vertices: usize,
    triangles: usize,
    extents_mm: [f64; 3],
    /// Median time of a view, milliseconds.
    view_ms: f64,
    bytes: usize,
    end: &'static str,
}

impl BuiltDocument {
    /// Document of a model that is stored with a name and a number of bytes.
    pub(super) fn new(
        constructed: &Constructed,
        model: &ObjectModel,
        (name, track): (&str, u64),
        bytes: usize,
    ) -> Self {
        let growth = &constructed.growth;
        let mut times = growth.view_ms().to_vec();
        times.sort_unstable_by(f64::total_cmp);
        Self {
            name: name.to_owned(),
            track,
            seconds: constructed.begun.elapsed().as_secs_f64(),
            views: model.views.len(),
            refused: growth.n_refused(),
            left_out: constructed.n_left_out,
            reasons: reasons(growth),
            is_agreed: constructed.is_agreed,
            is_closed_loop: model.is_closed_loop,
            completeness: model.unseen.completeness(),
            missing: model.unseen.in_words(),
            next_move: growth.next_move(&model.unseen),
            vertices: model.mesh.vertices.len(),
            triangles: model.mesh.triangles.len(),
            extents_mm: model.summary().extents_m.map(|side| 1e3 * side),
            view_ms: times.get(times.len() / 2).copied().unwrap_or(0.0),
            bytes,
            end: constructed.end.word(),
        }
    }

    /// Sentences for a person.
    pub(super) fn text(&self) -> String {
        let [width, depth, height] = self.extents_mm;
        let mut lines = vec![format!(
            "the model {:?} is stored: {} views, {} triangles, {width:.0} x {depth:.0} x \
             {height:.0} mm, {:.0} % of all directions seen; {}",
            self.name,
            self.views,
            self.triangles,
            100.0 * self.completeness,
            self.end
        )];
        if !self.missing.is_empty() {
            lines.push(format!("missing: {}", self.missing.join(", ")));
        }
        if let Some(next) = self.next_move {
            lines.push(format!("to see more of it: {}", next.in_words()));
        }
        if self.left_out > 0 {
            lines.push(format!("{} views were left out", self.left_out));
        }
        if !self.is_agreed {
            lines.push("the views were not brought into agreement".to_owned());
        }
        if let Some((reason, _)) = self.reasons.first() {
            lines.push(format!(
                "{} views were refused, most of them: {reason}",
                self.refused
            ));
        }
        lines.push(format!(
            "export it with: tabula model export {:?}",
            self.name
        ));
        lines.join("\n")
    }
}

/// Reasons of the refused views, the most frequent first, with their numbers. Sentences that differ
/// in figures only are one reason.
fn reasons(growth: &Growth) -> Vec<(String, usize)> {
    let without_figures = |text: &str| text.replace(|c: char| c.is_ascii_digit(), "");
    let mut reasons: Vec<(String, usize)> = Vec::new();
    for refused in growth.refused() {
        let kind = without_figures(&refused.reason);
        match reasons
            .iter_mut()
            .find(|(reason, _)| without_figures(reason) == kind)
        {
            Some((_, n)) => *n += 1,
            None => reasons.push((refused.reason.clone(), 1)),
        }
    }
    reasons.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    reasons
}
