//! `tabula model show`: size, views, missing parts and versions of a model.

use super::{document, read};
use crate::time::utc;
use command_line::{Output, format_table};
use control_client::MemoryClient;
use message::control::{DocumentReport, DocumentVersionReport};
use object_model::{ModelView, ObjectModel, RefusedView};
use serde::Serialize;
use service::Failure;
use std::process::ExitCode;

/// JSON document of a model.
#[derive(Serialize)]
struct ModelDocument {
    name: String,
    bytes: u64,
    author: String,
    decided_ns: u64,
    sequence: u64,
    extents_m: [f64; 3],
    n_vertices: usize,
    n_triangles: usize,
    is_closed_loop: bool,
    completeness: f64,
    missing: Vec<String>,
    unseen_directions: Vec<[f32; 3]>,
    views: Vec<ViewDocument>,
    refused: Vec<RefusedDocument>,
    versions: Vec<DocumentVersionReport>,
}

/// View that was fused into the model.
#[derive(Serialize)]
struct ViewDocument {
    captured_ns: u64,
    n_points: u32,
    new_surface_share: f32,
    position_m: [f64; 3],
    orientation_xyzw: [f64; 4],
}

/// View that was not fused.
#[derive(Serialize)]
struct RefusedDocument {
    captured_ns: u64,
    reason: String,
}

/// Runs `tabula model show`.
pub(super) fn show(
    memory: &mut MemoryClient,
    name: &str,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let (model, report) = read(memory, name)?;
    let versions = memory.document_versions(&document(name))?;
    let shown = ModelDocument::new(&model, report, versions);
    output.answer(&shown, || shown.text());
    Ok(ExitCode::SUCCESS)
}

impl ModelDocument {
    fn new(
        model: &ObjectModel,
        report: DocumentReport,
        versions: Vec<DocumentVersionReport>,
    ) -> Self {
        let summary = model.summary();
        let unseen = model.unseen.directions().into_iter();
        Self {
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
            views: model.views.iter().map(ViewDocument::of).collect(),
            refused: model.refused.iter().map(RefusedDocument::of).collect(),
            versions,
        }
    }

    /// The model in sentences and tables.
    fn text(&self) -> String {
        let [x, y, z] = self.extents_m.map(|extent_m| 1000.0 * extent_m);
        let mut lines = vec![
            format!(
                "the model {:?}: {x:.0} x {y:.0} x {z:.0} mm, {} vertices, {} triangles, {} bytes",
                self.name, self.n_vertices, self.n_triangles, self.bytes
            ),
            self.views_sentence(),
            self.missing_sentence(),
            format!(
                "stored by {}, {}, history {}",
                self.author,
                utc(self.decided_ns),
                self.sequence
            ),
        ];
        if !self.views.is_empty() {
            let rows: Vec<_> = self.views.iter().map(ViewDocument::row).collect();
            let columns = ["view captured", "points", "new surface"];
            lines.push(format_table(&columns, &rows));
        }
        for RefusedDocument {
            captured_ns,
            reason,
        } in &self.refused
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
        let how = if self.is_closed_loop {
            "in a closed loop around it"
        } else {
            "not in a closed loop around it"
        };
        let (n_views, n_refused) = (self.views.len(), self.refused.len());
        format!("fused from {n_views} view(s), {how}; {n_refused} view(s) were refused")
    }

    fn missing_sentence(&self) -> String {
        let percent = 100.0 * self.completeness;
        if self.missing.is_empty() {
            return "seen from all directions; nothing is missing".to_owned();
        }
        let missing = self.missing.join(", ");
        let angles = if missing.contains('°') {
            " (from x towards y of its frame)"
        } else {
            ""
        };
        format!("seen from {percent:.0} % of all directions; missing: {missing}{angles}")
    }

    fn versions_text(&self) -> String {
        let present = self.sequence;
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

impl ViewDocument {
    fn of(view: &ModelView) -> Self {
        let pose = view.object_from_camera;
        Self {
            captured_ns: view.captured_ns,
            n_points: view.n_points,
            new_surface_share: view.new_surface_share,
            position_m: pose.translation.vector.into(),
            orientation_xyzw: pose.rotation.coords.into(),
        }
    }

    fn row(&self) -> Vec<String> {
        vec![
            utc(self.captured_ns),
            self.n_points.to_string(),
            format!("{:.0} %", 100.0 * self.new_surface_share),
        ]
    }
}

impl RefusedDocument {
    fn of(view: &RefusedView) -> Self {
        Self {
            captured_ns: view.captured_ns,
            reason: view.reason.clone(),
        }
    }
}
