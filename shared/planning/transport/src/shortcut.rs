//! Shortcuts of a path in joint space: places on it are joined straight where nothing is in the way
//! (Geraerts and Overmars 2007).

use crate::arm_collision::motion_m;
use arm_kinematics::JointVector;
use random::Random;

/// Number of shortcuts that are tried.
const N_TRIES: usize = 40;

/// Path with the same ends that is not longer, all of whose motions are free.
pub(crate) fn shortened(
    mut path: Vec<JointVector>,
    random: &mut Random,
    is_free: impl Fn(&JointVector, &JointVector) -> bool,
) -> Vec<JointVector> {
    for _ in 0..N_TRIES {
        if path.len() < 3 {
            break;
        }
        let mut cuts = [random.unit(), random.unit()];
        cuts.sort_by(f64::total_cmp);
        let [(first, from), (last, to)] = cuts.map(|cut| place_at(&path, cut));
        if first == last || !is_free(&from, &to) {
            continue;
        }
        let mut joined = path[..=first].to_vec();
        joined.extend([from, to]);
        joined.extend_from_slice(&path[last + 1..]);
        joined.dedup_by(|a, b| motion_m(a, b) < 1e-9);
        path = joined;
    }
    without_needless(&path, is_free)
}

/// Motion and configuration at a share of a path's length.
fn place_at(path: &[JointVector], share: f64) -> (usize, JointVector) {
    let length_m = |pair: &[JointVector]| motion_m(&pair[0], &pair[1]);
    let total_m: f64 = path.windows(2).map(length_m).sum();
    let mut rest_m = share * total_m;
    for (index, pair) in path.windows(2).enumerate() {
        let motion_m = length_m(pair);
        if rest_m <= motion_m && motion_m > 0.0 {
            return (index, pair[0] + (pair[1] - pair[0]) * (rest_m / motion_m));
        }
        rest_m -= motion_m;
    }
    (path.len() - 2, path[path.len() - 1])
}

/// Path without the configurations that can be left out.
fn without_needless(
    path: &[JointVector],
    is_free: impl Fn(&JointVector, &JointVector) -> bool,
) -> Vec<JointVector> {
    let mut kept = vec![path[0]];
    let mut at = 0;
    while at + 1 < path.len() {
        let mut farther = (at + 2..path.len()).rev();
        let next = farther.find(|next| is_free(&path[at], &path[*next]));
        at = next.unwrap_or(at + 1);
        kept.push(path[at]);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shortcuts_keep_the_ends_and_what_is_free() {
        // The square 0 to 1 of the first two joints is closed.
        let is_free = |from: &JointVector, to: &JointVector| {
            (0..=100).all(|k| {
                let place = from + (to - from) * (f64::from(k) / 100.0);
                !((0.0..1.0).contains(&place[0]) && (0.0..1.0).contains(&place[1]))
            })
        };
        let corner = |x: f64, y: f64| JointVector::from([x, y, 0.0, 0.0, 0.0, 0.0]);
        let path = vec![
            corner(-0.5, 0.5),
            corner(-2.0, 3.0),
            corner(0.5, 4.0),
            corner(3.0, 3.0),
            corner(1.5, 0.5),
        ];
        let length_m = |path: &[JointVector]| -> f64 {
            path.windows(2)
                .map(|pair| motion_m(&pair[0], &pair[1]))
                .sum()
        };
        let before_m = length_m(&path);
        let short = shortened(path.clone(), &mut Random::from_seed(1), is_free);
        assert_eq!((short[0], short[short.len() - 1]), (path[0], path[4]));
        assert!(short.windows(2).all(|pair| is_free(&pair[0], &pair[1])));
        assert!(length_m(&short) < 0.7 * before_m, "{}", length_m(&short));
    }

    #[test]
    fn open_path_becomes_straight() {
        let corner = |x: f64| JointVector::from([x, x * x, 0.0, 0.0, 0.0, 0.0]);
        let path: Vec<JointVector> = (0..6).map(|k| corner(f64::from(k))).collect();
        let short = shortened(path.clone(), &mut Random::from_seed(1), |_, _| true);
        assert_eq!(short, [path[0], path[5]]);
    }
}
