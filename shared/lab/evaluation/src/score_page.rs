//! HTML page of segmentation scores and scene pictures.

use crate::segmentation_score::{MEASURE_NAMES, SegmentationScore};
use plot::html_page::{self, escaped, linked_picture};

const LEGEND: &str = "<h2>Scenes, worst first</h2>\n<p>Left: colour image; middle: \
    ground truth; right: result. A hypothesis has the colour of the object that it is matched \
    with. Green: the table, in the ground truth all labelled background. Striped: hypotheses \
    rejected by ψ. Grey: hypotheses too small to count. Dark: pixels without depth.</p>";

/// Row of a score table: name, number of scenes, mean scores.
#[derive(Debug, Clone, PartialEq)]
pub struct ScoreLine {
    /// Name of the group of scenes.
    pub name: String,
    /// Number of scenes in the group.
    pub n_scenes: usize,
    /// Mean segmentation scores of the group.
    pub score: SegmentationScore,
    /// Median duration of detection, milliseconds.
    pub detection_ms: f64,
}

/// Mean scores over all scenes and over groups.
#[derive(Debug, Clone, PartialEq)]
pub struct ScoreTable {
    /// Title of the score table.
    pub title: String,
    /// Rows of the score table.
    pub lines: Vec<ScoreLine>,
}

/// Scene with its picture and scores.
#[derive(Debug, Clone, PartialEq)]
pub struct PicturedScene {
    /// Name of the scene.
    pub name: String,
    /// Name of the scene's group.
    pub group: String,
    /// Segmentation scores of the scene.
    pub score: SegmentationScore,
    /// Median duration of detection, milliseconds.
    pub detection_ms: f64,
    /// Path of the picture, relative to the page; plain text.
    pub picture: String,
}

/// HTML page that depends on no other file but the pictures; scenes stay in the given order.
pub fn html(
    title: &str,
    notes: &[String],
    tables: &[ScoreTable],
    scenes: &[PicturedScene],
) -> String {
    let tables = tables.iter().map(table);
    let legend = std::iter::once(LEGEND.to_owned());
    html_page::html(
        title,
        notes,
        tables.chain(legend).chain(scenes.iter().map(figure)),
    )
}

fn table(ScoreTable { title, lines }: &ScoreTable) -> String {
    let heads = MEASURE_NAMES.join("</th><th>");
    let mut rows = vec![format!(
        "<table>\n<caption>{}</caption>\n<tr><th>%</th><th>scenes</th><th>{heads}</th>\
         <th>hypotheses</th><th>objects</th><th>ms</th></tr>",
        escaped(title)
    )];
    rows.extend(lines.iter().map(|line| {
        let name = escaped(&line.name);
        let cells = percent(&line.score).join("</td><td>");
        let (n_scenes, score) = (line.n_scenes, &line.score);
        format!(
            "<tr><td>{name}</td><td>{n_scenes}</td><td>{cells}</td><td>{}</td><td>{}</td>\
             <td>{:.2}</td></tr>",
            score.n_hypotheses, score.n_objects, line.detection_ms
        )
    }));
    rows.push("</table>".to_owned());
    rows.join("\n")
}

/// Segmentation scores in percent.
fn percent(score: &SegmentationScore) -> Vec<String> {
    let values = score.values();
    let percent = values.iter().map(|value| format!("{:.1}", 100.0 * value));
    percent.collect()
}

fn figure(scene: &PicturedScene) -> String {
    let score = &scene.score;
    let measures = MEASURE_NAMES.iter().zip(percent(score));
    let measures: Vec<String> = measures
        .map(|(name, value)| format!("{name} {value}"))
        .collect();
    let (name, group) = (escaped(&scene.name), escaped(&scene.group));
    format!(
        "<figure id=\"{name}\">\n<figcaption><b>{name}</b> ({group}): {}; {} hypotheses, {} \
         objects; {:.2} ms</figcaption>\n{}\n</figure>",
        measures.join(" "),
        score.n_hypotheses,
        score.n_objects,
        scene.detection_ms,
        linked_picture(&scene.picture, &format!("{name}: colour, truth, result"))
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_escaped_on_the_page() {
        let score = SegmentationScore {
            n_objects: 3,
            wov: 0.5,
            ..SegmentationScore::default()
        };
        let scene = |name: &str| PicturedScene {
            name: name.to_owned(),
            group: "a&b".to_owned(),
            score,
            detection_ms: 1.25,
            picture: format!("scenes/{name}.png"),
        };
        let line = ScoreLine {
            name: "<all>".into(),
            n_scenes: 2,
            score,
            detection_ms: 2.5,
        };
        let table = ScoreTable {
            title: "before & after".into(),
            lines: vec![line],
        };
        let scenes = [scene("a \"<b>#1"), scene("learn2")];
        let page = html("title", &["x < y".into()], &[table], &scenes);
        for part in [
            "<td>&lt;all&gt;</td><td>2</td><td>50.0</td>",
            "x &lt; y",
            "before &amp; after",
            "<td>2.50</td>",
            "a &quot;&lt;b&gt;#1",
            "src=\"scenes/a%20%22%3Cb%3E%231.png\"",
            "src=\"scenes/learn2.png\"",
            "a&amp;b",
            "wov 50.0",
        ] {
            assert!(page.contains(part), "{part} is not in {page}");
        }
        assert!(!page.contains("<b>#1"));
        assert!(!page.contains("http"));
        // Scenes stay in the caller's order.
        assert!(page.find("%231.png") < page.find("learn2.png"));
    }
}
