//! Queue of views between a camera that moves and a builder that may be slower.

use crate::object_receiver::ReceivedView;
use std::collections::VecDeque;

/// Maximum number of waiting views. Chosen: two orbits in steps of 6°, 20 MB.
const N_VIEWS_MAX: usize = 120;

/// Waiting views, oldest first. A view that shows the same side as a waiting one is left out, so
/// that a slow builder gets views all around the object, and a fast one every frame.
#[derive(Debug)]
pub(crate) struct ViewQueue {
    views: VecDeque<ReceivedView>,
    step_cosine: f64,
}

impl ViewQueue {
    /// Empty queue of views whose directions are at least `step_rad` apart.
    pub(crate) fn new(step_rad: f64) -> Self {
        Self {
            views: VecDeque::new(),
            step_cosine: step_rad.cos(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.views.len()
    }

    /// Adds a view, unless a waiting one shows the same side.
    pub(crate) fn push(&mut self, view: ReceivedView) {
        if self.views.iter().any(|other| self.is_near(other, &view)) {
            return;
        }
        if self.views.len() == N_VIEWS_MAX {
            self.thin_out();
        }
        self.views.push_back(view);
    }

    /// Takes the oldest view.
    pub(crate) fn pop(&mut self) -> Option<ReceivedView> {
        self.views.pop_front()
    }

    /// Gives back the view that was taken last.
    pub(crate) fn put_back(&mut self, view: ReceivedView) {
        self.views.push_front(view);
    }

    /// `true` if two views are known to be less than a step apart. Views of a camera without a pose,
    /// and of two placements of the object, are not known to be.
    fn is_near(&self, one: &ReceivedView, other: &ReceivedView) -> bool {
        if one.placement != other.placement {
            return false;
        }
        let directions = one.direction.zip(other.direction);
        directions.is_some_and(|(one, other)| one.dot(&other) > self.step_cosine)
    }

    /// Removes the view whose neighbours are nearest to each other in time.
    fn thin_out(&mut self) {
        let gap_ns = |middle: usize| {
            let (before, after) = (&self.views[middle - 1], &self.views[middle + 1]);
            after.captured_ns.saturating_sub(before.captured_ns)
        };
        let inner = 1..self.views.len().saturating_sub(1);
        if let Some(middle) = inner.min_by_key(|&middle| gap_ns(middle)) {
            self.views.remove(middle);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::PinholeCamera;
    use nalgebra::{UnitVector3, Vector3};

    fn view(captured_ns: u64, turn_deg: Option<f64>) -> ReceivedView {
        let direction =
            |turn: f64| UnitVector3::new_normalize(Vector3::new(turn.cos(), turn.sin(), 0.5));
        ReceivedView {
            points: Vec::new(),
            camera: PinholeCamera::KINECT_V1,
            world_from_camera: None,
            up_in_camera: None,
            placement: 0,
            direction: turn_deg.map(|turn| direction(turn.to_radians())),
            captured_ns,
            wall_clock_offset_ns: 0,
        }
    }

    fn times(mut queue: ViewQueue) -> Vec<u64> {
        std::iter::from_fn(|| queue.pop().map(|view| view.captured_ns)).collect()
    }

    #[test]
    fn waiting_views_show_different_sides() {
        let mut queue = ViewQueue::new(6_f64.to_radians());
        for (time, turn_deg) in [
            (0, 0.0),
            (1, 3.0),
            (2, 9.0),
            (3, 12.0),
            (4, 18.0),
            (5, 360.0),
        ] {
            queue.push(view(time, Some(turn_deg)));
        }
        assert_eq!(times(queue), [0, 2, 4]);
    }

    #[test]
    fn view_that_was_taken_makes_room_for_the_next_one() {
        let mut queue = ViewQueue::new(6_f64.to_radians());
        for time in 0..3 {
            queue.push(view(time, Some(0.1 * time as f64)));
            let taken = queue.pop().unwrap();
            assert_eq!(taken.captured_ns, time, "a fast builder gets every frame");
        }
        queue.push(view(7, Some(0.0)));
        let taken = queue.pop().unwrap();
        queue.push(view(8, Some(90.0)));
        queue.put_back(taken);
        assert_eq!(times(queue), [7, 8]);
    }

    #[test]
    fn full_queue_is_thinned_out_evenly_and_keeps_its_ends() {
        let mut queue = ViewQueue::new(6_f64.to_radians());
        let n = 10 * N_VIEWS_MAX as u64;
        for time in 0..n {
            queue.push(view(time, None));
        }
        assert_eq!(queue.len(), N_VIEWS_MAX);
        let times = times(queue);
        assert_eq!((times[0], *times.last().unwrap()), (0, n - 1));
        let gaps = times.windows(2).map(|pair| pair[1] - pair[0]);
        let widest = gaps.max().unwrap();
        assert!(widest <= 20, "{times:?}");
    }
}
