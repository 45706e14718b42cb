//! `tabula model show`: size, views, missing parts and versions of a model.

use super::{document, read};
use crate::time::utc;
use command_line::{Output, format_table};
use control_client::MemoryClient;
use control_protocol::{DocumentReport, DocumentVersionReport};
use object_model::{ModelView, ObjectModel, RefusedView};
use scene_document::{ModelDocument, ModelViewDocument, RefusedViewDocument};
use serde::Serialize;
use service::Failure;
use std::process::ExitCode;

/// Model with its versions, as a JSON document.
#[derive(Serialize)]
struct ShownModel {
    #[serde(flatten)]
    model: ModelDocument,
    versions: Vec<DocumentVersionReport>,
}

/// Runs `tabula model show`.
pub(super) fn show(
    memory: &mut MemoryClient,
    name: &str,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let (model, report) = read(memory, name)?;
    let versions = memory.document_versions(&document(name))?;
    let shown = ShownModel {
        model: model_document(&model, report),
        versions,
    };
    output.answer(&shown, || shown.text());
    Ok(ExitCode::SUCCESS)
}

fn model_document(model: &ObjectModel, report: DocumentReport) -> ModelDocument {
    let summary = model.summary();
    let unseen = model.unseen.directions().into_iter();
    ModelDocument {
        name: report.document.name,
        bytes: report.bytes,
        author: report.author,
        decided_ns: report.decided_ns,
        sequence: report.sequence,
        extents_m: summary.extents_m,
        n_vertices: summary.n_vertices,
        n_triangles: summary.n_triangles,
        is_closed_loop: model.is_closed_loop,
        completeness: summary.completeness,
        missing: model.unseen.in_words(),
        unseen_directions: unseen.map(Into::into).collect(),
        views: model.views.iter().map(view_document).collect(),
        refused: model.refused.iter().map(refused_document).collect(),
    }
}

fn view_document(view: &ModelView) -> ModelViewDocument {
    let pose = view.object_from_camera;
    ModelViewDocument {
        captured_ns: view.captured_ns,
        n_points: view.n_points,
        new_surface_share: view.new_surface_share,
        position_m: pose.translation.vector.into(),
        orientation_xyzw: pose.rotation.coords.into(),
    }
}

impl ShownModel {
    /// The model in sentences and tables.
    fn text(&self) -> String {
        let [x, y, z] = self.model.extents_m.map(|extent_m| 1000.0 * extent_m);
        let mut lines = vec![
            format!(
                "the model {:?}: {x:.0} x {y:.0} x {z:.0} mm, {} vertices, {} triangles, {} bytes",
                self.model.name, self.model.n_vertices, self.model.n_triangles, self.model.bytes
            ),
            self.views_sentence(),
            self.missing_sentence(),
            format!(
                "stored by {}, {}, history {}",
                self.model.author,
                utc(self.model.decided_ns),
                self.model.sequence
            ),
        ];
        if !self.model.views.is_empty() {
            let rows: Vec<_> = self.model.views.iter().map(view_row).collect();
            let columns = ["view captured", "points", "new surface"];
            lines.push(format_table(&columns, &rows));
        }
        for RefusedViewDocument {
            captured_ns,
            reason,
        } in &self.model.refused
        {
            lines.push(format!(
                "refused the view of {}: {reason}",
                utc(*captured_ns)
            ));
        }
        lines.push(self.versions_text());
        lines.join("\n")
    }

    fn views_sentence(&self) -> String {
        let how = if self.model.is_closed_loop {
            "in a closed loop around it"
        } else {
            "not in a closed loop around it"
        };
        let (n_views, n_refused) = (self.model.views.len(), self.model.refused.len());
        format!("fused from {n_views} view(s), {how}; {n_refused} view(s) were refused")
    }

    fn missing_sentence(&self) -> String {
        let percent = 100.0 * self.model.completeness;
        if self.model.missing.is_empty() {
            return "seen from all directions; nothing is missing".to_owned();
        }
        let missing = self.model.missing.join(", ");
        let angles = if missing.contains('°') {
            " (from x towards y of its frame)"
        } else {
            ""
        };
        format!("seen from {percent:.0} % of all directions; missing: {missing}{angles}")
    }

    fn versions_text(&self) -> String {
        let present = self.model.sequence;
        let row = |version: &DocumentVersionReport| {
            let mark = if version.sequence == present {
                "present"
            } else {
                ""
            };
            vec![
                version.sequence.to_string(),
                utc(version.decided_ns),
                version.author.clone(),
                version
                    .bytes
                    .map_or("forgotten".into(), |bytes| bytes.to_string()),
                mark.to_owned(),
            ]
        };
        let rows: Vec<_> = self.versions.iter().map(row).collect();
        let table = format_table(&["version", "when", "by", "bytes", ""], &rows);
        if self.versions.len() < 2 {
            return table;
        }
        format!(
            "{table}\nthe version before the present one comes back with: tabula undo {present}"
        )
    }
}

fn refused_document(view: &RefusedView) -> RefusedViewDocument {
    RefusedViewDocument {
        captured_ns: view.captured_ns,
        reason: view.reason.clone(),
    }
}

fn view_row(view: &ModelViewDocument) -> Vec<String> {
    vec![
        utc(view.captured_ns),
        view.n_points.to_string(),
        format!("{:.0} %", 100.0 * view.new_surface_share),
    ]
}
