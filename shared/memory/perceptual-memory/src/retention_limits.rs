//! Retention limits: maximum numbers of views per category and of unlabelled views.

use learning::{CategoryName, ViewId};

use crate::decision::{Decision, change_all};
use crate::digest::Digest;
use crate::error::Error;
use crate::keys;
use crate::label_status::{LIMIT_AUTHOR, LabelStatus};
use crate::model::{Effect, Operation, RetentionLimits};
use crate::perceptual_memory::PerceptualMemory;
use crate::record_reader::read_content;
use crate::view_record;

impl PerceptualMemory {
    /// Stages the enforcement of exceeded limits; `false` if none is exceeded.
    pub(crate) fn stage_limit_enforcement(&mut self) -> Result<bool, Error> {
        let RetentionLimits {
            max_views_per_category,
            max_unnamed_views,
            ..
        } = self.limits;
        let mut is_staged = false;
        for name in self.index.larger_categories(max_views_per_category) {
            let decision =
                self.prune_redundant_views(&name, nine_tenths(max_views_per_category))?;
            self.stage_limit_decision(decision);
            is_staged = true;
        }
        let n_unnamed = self.index.n_unnamed();
        if n_unnamed > max_unnamed_views {
            let decision = self.evict_unlabelled_views(n_unnamed - nine_tenths(max_unnamed_views));
            self.stage_limit_decision(decision);
            is_staged = true;
        }
        Ok(is_staged)
    }

    fn stage_limit_decision(&mut self, decision: Decision) {
        let wall_ns = self.last_wall_ns;
        self.stage_decision(None, (LIMIT_AUTHOR, None), wall_ns, decision);
    }

    /// Forgets the most redundant views of a category until `n_kept` are left.
    fn prune_redundant_views(
        &mut self,
        name: &CategoryName,
        n_kept: usize,
    ) -> Result<Decision, Error> {
        let mut views: Vec<(u64, ViewId, String, Digest)> = self
            .index
            .category(name)
            .map(|(view, entry)| {
                let kind = entry.descriptor_kind.to_string();
                (entry.captured_ns, view, kind, entry.descriptor.digest)
            })
            .collect();
        // Only descriptors of one kind and length are comparable: kind by kind, oldest first.
        views.sort_by(|a, b| (&a.2, a.0, a.1).cmp(&(&b.2, b.0, b.1)));
        let mut n_left_to_drop = views.len().saturating_sub(n_kept);
        let mut spared = Vec::new();
        for of_kind in views.chunk_by(|a, b| a.2 == b.2) {
            let descriptors = self.read(|reader| {
                let values = |(_, _, kind, digest): &(u64, ViewId, String, Digest)| {
                    let key = keys::digest_key(keys::DESCRIPTOR, *digest);
                    let content = read_content(reader, &key)?;
                    Ok(view_record::descriptor(kind.clone(), &content).values)
                };
                of_kind
                    .iter()
                    .map(values)
                    .collect::<Result<Vec<_>, Error>>()
            })?;
            let n_drop = n_left_to_drop.min(of_kind.len().saturating_sub(1));
            // Descriptors of different lengths under one kind: the oldest views go.
            let redundant = learning::redundant_views(&descriptors, n_drop)
                .unwrap_or_else(|_| (0..n_drop).collect());
            n_left_to_drop -= redundant.len();
            spared.extend(redundant.into_iter().map(|i| of_kind[i].1));
        }
        let entries = spared
            .iter()
            .filter_map(|view| Some((*view, self.index.get(*view)?)));
        let effects = change_all(entries, &LabelStatus::Forgotten);
        let category = Some(name.clone());
        Ok(Decision::new(Operation::EnforceLimit { category }, effects))
    }

    fn evict_unlabelled_views(&self, n_drop: usize) -> Decision {
        let is_unnamed = |standing: &LabelStatus| *standing == LabelStatus::Unnamed;
        let oldest = self
            .index
            .all()
            .filter(|(_, entry)| is_unnamed(&entry.register.standing));
        let effects = oldest
            .take(n_drop)
            .map(|(view, _)| Effect::Purged { view })
            .collect();
        Decision::new(Operation::EnforceLimit { category: None }, effects)
    }
}

fn nine_tenths(limit: usize) -> usize {
    limit - limit.div_ceil(10)
}
