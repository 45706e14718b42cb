//! Grouping of test views into tracks: views of several sides of one object.

use crate::recogniser::LabelledView;
use std::collections::BTreeMap;

/// Groups of `n_sides` views of the same object among `views`, which are indices of
/// `labels`. The views of a group are as far apart in their order as possible, so that
/// they show different sides. An object with fewer views is one group; up to `n_sides -
/// 1` of its views are left over otherwise. With one side, or where the object of a view
/// is unknown, each view is a group.
pub fn view_groups(labels: &[LabelledView], views: &[usize], n_sides: usize) -> Vec<Vec<usize>> {
    let mut groups = Vec::new();
    let mut objects: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for &view in views {
        match labels[view].instance {
            Some(instance) if n_sides > 1 => {
                let object = (labels[view].category, instance);
                objects.entry(object).or_default().push(view);
            }
            _ => groups.push(vec![view]),
        }
    }
    for views in objects.into_values() {
        let n_groups = (views.len() / n_sides).max(1);
        let group = |first| views.iter().skip(first).step_by(n_groups).take(n_sides);
        groups.extend((0..n_groups).map(|first| group(first).copied().collect::<Vec<_>>()));
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(instances: &[Option<u32>]) -> Vec<LabelledView> {
        let label = |&instance: &Option<u32>| LabelledView {
            category: 0,
            instance,
        };
        instances.iter().map(label).collect()
    }

    #[test]
    fn sides_of_an_object_are_spread_over_its_views() {
        let labels = labels(&[Some(1); 12]);
        let views: Vec<usize> = (0..12).collect();
        let groups = view_groups(&labels, &views, 3);
        assert_eq!(groups[0], [0, 4, 8]);
        assert_eq!(groups[3], [3, 7, 11]);
        assert_eq!(view_groups(&labels, &views, 1).len(), 12);
        // Seven views make two groups of three.
        assert_eq!(view_groups(&labels, &views[..7], 3), [[0, 2, 4], [1, 3, 5]]);
        assert_eq!(view_groups(&labels, &views[..2], 3), [[0, 1]]);
    }

    #[test]
    fn views_of_different_or_unknown_objects_are_not_grouped() {
        let labels = labels(&[Some(1), None, Some(2), None, Some(1)]);
        let groups = view_groups(&labels, &[0, 1, 2, 3, 4], 2);
        assert_eq!(groups, [vec![1], vec![3], vec![0, 4], vec![2]]);
    }
}
