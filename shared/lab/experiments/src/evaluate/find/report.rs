//! Report of queries in words.

use super::TrueQuery;
use super::query_scene::QueryScene;
use crate::arguments::FindArguments;
use point_cloud::ColorTerm;
use referring_expression::Answer;
use serde::Serialize;
use statistics::percentiles::Percentiles;

/// Origin of a query.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum QuerySource {
    Generated,
    File,
}

/// Report of queries in words.
#[derive(Debug, Default, Serialize)]
pub(super) struct FindReport {
    pub(super) n_scenes: u64,
    pub(super) seed: u64,
    pub(super) has_wordnet: bool,
    pub(super) generated: QueryCounts,
    pub(super) from_file: QueryCounts,
    /// Percentiles of the time of a query, milliseconds; `None` without queries.
    pub(super) p50_ms: Option<f64>,
    pub(super) p99_ms: Option<f64>,
    pub(super) max_ms: Option<f64>,
    pub(super) queries: Vec<AskedQuery>,
    pub(super) scenes: Vec<SceneReport>,
}

/// Counts of the queries of one origin.
#[derive(Debug, Default, Serialize)]
pub(super) struct QueryCounts {
    pub(super) n_asked: usize,
    pub(super) n_right: usize,
    /// Number of queries that a wrong object without a doubt answered.
    pub(super) n_wrong_without_doubt: usize,
}

/// Scene of the queries, with its picture.
#[derive(Debug, Serialize)]
pub(super) struct SceneReport {
    pub(super) picture: String,
    pub(super) objects: Vec<SceneObjectReport>,
}

/// Object of a scene.
#[derive(Debug, Serialize)]
pub(super) struct SceneObjectReport {
    pub(super) id: u16,
    pub(super) category: String,
    pub(super) position_m: [f64; 3],
    pub(super) size_m: [f64; 3],
    /// Colour terms with at least a tenth of the surface, with their shares.
    pub(super) colors: Vec<(&'static str, f64)>,
    /// The same as perception sees it; empty when it is not tracked.
    pub(super) seen_colors: Vec<(&'static str, f64)>,
    pub(super) is_tracked: bool,
    pub(super) is_gone: bool,
}

/// Query with its answer.
#[derive(Debug, Serialize)]
pub(super) struct AskedQuery {
    pub(super) scene: u64,
    pub(super) source: QuerySource,
    pub(super) words: String,
    /// Numbers of the objects that are meant, ascending.
    pub(super) expected: Vec<u16>,
    /// Numbers of the objects of the answer, best first; 0 for a track that is no object.
    pub(super) found: Vec<u16>,
    pub(super) is_right: bool,
    pub(super) is_wrong_without_doubt: bool,
    pub(super) sentence: String,
    /// Doubts of all objects of the answer, each once.
    pub(super) doubts: Vec<String>,
    /// Words with their meaning.
    pub(super) understood: Vec<(String, String)>,
    pub(super) not_understood: Vec<String>,
    pub(super) ms: f64,
}

impl AskedQuery {
    /// Compares an answer with the truth: it is right when it has exactly the objects that are
    /// meant.
    pub(super) fn new(
        scene: &QueryScene,
        scene_number: u64,
        query: TrueQuery,
        source: QuerySource,
        answer: Answer,
        ms: f64,
    ) -> Self {
        let number = |track_id| scene.object_of(track_id).map_or(0, |object| object.id);
        let found: Vec<u16> = answer
            .matches
            .iter()
            .map(|one| number(one.track_id))
            .collect();
        let mut sorted = found.clone();
        sorted.sort_unstable();
        let is_wrong = |index: usize| !query.objects.contains(&found[index]);
        let mut matches = answer.matches.iter().enumerate();
        Self {
            scene: scene_number,
            source,
            is_right: sorted == query.objects,
            is_wrong_without_doubt: matches
                .any(|(index, one)| is_wrong(index) && one.doubts.is_empty()),
            words: query.words,
            expected: query.objects,
            found,
            doubts: doubts(&answer),
            sentence: answer.sentence,
            understood: answer
                .understood
                .into_iter()
                .map(|used| (used.words, used.meaning))
                .collect(),
            not_understood: answer.not_understood,
            ms,
        }
    }
}

impl FindReport {
    /// Report without queries.
    pub(super) fn new(arguments: &FindArguments, has_wordnet: bool) -> Self {
        Self {
            n_scenes: arguments.scenes,
            seed: arguments.seed,
            has_wordnet,
            ..Self::default()
        }
    }

    /// Adds an answered query.
    pub(super) fn add(&mut self, asked: AskedQuery) {
        let counts = match asked.source {
            QuerySource::Generated => &mut self.generated,
            QuerySource::File => &mut self.from_file,
        };
        counts.n_asked += 1;
        counts.n_right += usize::from(asked.is_right);
        counts.n_wrong_without_doubt += usize::from(asked.is_wrong_without_doubt);
        self.queries.push(asked);
    }

    /// Adds a scene with its picture.
    pub(super) fn add_scene(&mut self, picture: String, scene: &QueryScene) {
        let object = |object: &super::query_scene::TrueObject| {
            let seen = object.track_id.and_then(|id| scene.seen_colors(id));
            let seen = seen.unwrap_or_default().map(f64::from);
            SceneObjectReport {
                id: object.id,
                category: object.category.clone(),
                position_m: object.centre_in_world_m.into(),
                size_m: object.size_m.into(),
                colors: notable(object.color_shares),
                seen_colors: notable(seen),
                is_tracked: object.track_id.is_some(),
                is_gone: object.is_gone,
            }
        };
        self.scenes.push(SceneReport {
            picture,
            objects: scene.objects.iter().map(object).collect(),
        });
    }

    /// Computes the percentiles of the times.
    pub(super) fn finish(&mut self) {
        let times: Vec<f64> = self.queries.iter().map(|asked| asked.ms).collect();
        self.max_ms = times.iter().copied().max_by(f64::total_cmp);
        let percentiles = Percentiles::of(times);
        self.p50_ms = percentiles.as_ref().map(|percentiles| percentiles.p50);
        self.p99_ms = percentiles.as_ref().map(|percentiles| percentiles.p99);
    }
}

/// Doubts of all objects of an answer, each once.
fn doubts(answer: &Answer) -> Vec<String> {
    let mut distinct: Vec<String> = Vec::new();
    for doubt in answer.matches.iter().flat_map(|found| &found.doubts) {
        if !distinct.contains(doubt) {
            distinct.push(doubt.clone());
        }
    }
    distinct
}

/// Colour terms with at least a tenth, with their shares.
fn notable(shares: [f64; ColorTerm::ALL.len()]) -> Vec<(&'static str, f64)> {
    let named = ColorTerm::ALL.into_iter().zip(shares);
    let notable = named.filter(|(_, share)| *share >= 0.1);
    notable.map(|(term, share)| (term.word(), share)).collect()
}
