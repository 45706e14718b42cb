//! Holding limits: how many views are kept of a category, and of objects that
//! nobody named.

use learning::{CategoryName, ViewId};

use crate::decision::{Decision, change_all};
use crate::digest::Digest;
use crate::error::Error;
use crate::facts;
use crate::history::{Effect, Operation};
use crate::keys;
use crate::perceptual_memory::PerceptualMemory;
use crate::reading::read_content;
use crate::standing::{Decided, Standing};

/// Who does it, in the history.
const AUTHOR: &str = "the store itself, to hold a limit";

/// Whether something was given up for a limit of this store: no other robot need
/// follow.
pub(crate) fn is_own_limit(decided: &Decided) -> bool {
    &*decided.author == AUTHOR
}

/// How much is kept.
///
/// What exceeds a limit is given up until nine tenths of it are left, so that this
/// is not done at every change:
/// - of a category, the views that say least are forgotten: of the two most alike
///   the older one, again and again. They can be brought back until they are purged.
/// - of views without a name, those of the oldest tracks are removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most views of a category.
    pub max_views_per_category: usize,
    /// Most views without a name.
    pub max_unnamed_views: usize,
}

impl Default for Limits {
    /// None.
    fn default() -> Self {
        Self {
            max_views_per_category: usize::MAX,
            max_unnamed_views: usize::MAX,
        }
    }
}

impl PerceptualMemory {
    /// Stages what has to be given up; false when nothing has.
    pub(crate) fn stage_economies(&mut self) -> Result<bool, Error> {
        let Limits {
            max_views_per_category,
            max_unnamed_views,
        } = self.limits;
        let mut is_staged = false;
        for name in self.catalogue.larger_categories(max_views_per_category) {
            let decision = self.spare_views(&name, nine_tenths(max_views_per_category))?;
            self.stage_economy(decision);
            is_staged = true;
        }
        let n_unnamed = self.catalogue.n_unnamed();
        if n_unnamed > max_unnamed_views {
            let decision = self.drop_unnamed(n_unnamed - nine_tenths(max_unnamed_views));
            self.stage_economy(decision);
            is_staged = true;
        }
        Ok(is_staged)
    }

    fn stage_economy(&mut self, decision: Decision) {
        let wall_ns = self.last_wall_ns;
        self.stage_decision(None, AUTHOR, wall_ns, decision);
    }

    /// Forgets the views of a category that say least, until `n_kept` are left.
    fn spare_views(&mut self, name: &CategoryName, n_kept: usize) -> Result<Decision, Error> {
        let mut views: Vec<(u64, ViewId, String, Digest)> = self
            .catalogue
            .category(name)
            .map(|(view, entry)| {
                let kind = entry.descriptor_kind.to_string();
                (entry.captured_ns, view, kind, entry.descriptor.digest)
            })
            .collect();
        // Only descriptors of one kind and length compare: kind by kind, in order of age.
        views.sort_by(|a, b| (&a.2, a.0, a.1).cmp(&(&b.2, b.0, b.1)));
        let mut n_left_to_drop = views.len().saturating_sub(n_kept);
        let mut spared = Vec::new();
        for of_kind in views.chunk_by(|a, b| a.2 == b.2) {
            let descriptors = self.read(|reader| {
                let values = |(_, _, kind, digest): &(u64, ViewId, String, Digest)| {
                    let key = keys::digest_key(keys::DESCRIPTOR, *digest);
                    let content = read_content(reader, &key)?;
                    Ok(facts::descriptor(kind.clone(), &content).values)
                };
                of_kind
                    .iter()
                    .map(values)
                    .collect::<Result<Vec<_>, Error>>()
            })?;
            let n_drop = n_left_to_drop.min(of_kind.len().saturating_sub(1));
            // Of different lengths: a kind that is none. The oldest go.
            let least = learning::least_telling(&descriptors, n_drop)
                .unwrap_or_else(|_| (0..n_drop).collect());
            n_left_to_drop -= least.len();
            spared.extend(least.into_iter().map(|i| of_kind[i].1));
        }
        let entries = spared
            .iter()
            .filter_map(|view| Some((*view, self.catalogue.get(*view)?)));
        let effects = change_all(entries, &Standing::Forgotten);
        let category = Some(name.clone());
        Ok(Decision::new(Operation::Economise { category }, effects))
    }

    fn drop_unnamed(&self, n_drop: usize) -> Decision {
        let is_unnamed = |standing: &Standing| *standing == Standing::Unnamed;
        let oldest = self
            .catalogue
            .all()
            .filter(|(_, entry)| is_unnamed(&entry.register.standing));
        let effects = oldest
            .take(n_drop)
            .map(|(view, _)| Effect::Purged { view })
            .collect();
        Decision::new(Operation::Economise { category: None }, effects)
    }
}

fn nine_tenths(limit: usize) -> usize {
    limit - limit.div_ceil(10)
}
