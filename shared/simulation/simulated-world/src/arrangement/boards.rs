//! Free positions on boards: the table, the boards of a shelf, the floor of a tray.

use crate::furniture::{Shelf, TableDimensions, Tray};
use crate::object_model::ObjectModel;
use crate::scene::{ObjectPlacement, Scene};
use random::Random;
use std::f64::consts::PI;

/// Distance of an isolated object from the table's edge, metres. Chosen.
const TABLE_RIM_M: f64 = 0.05;
/// Distance of an object from the edge of a board of the shelf, metres. Chosen.
const BOARD_RIM_M: f64 = 0.02;
/// Half sides of the part of the table that the default camera sees well, metres.
const IN_VIEW_HALF_M: [f64; 2] = [0.46, 0.30];
/// Free height over an object below the next board, metres. Chosen.
const HEADROOM_M: f64 = 0.05;
/// Number of tries of rejection sampling per object. Chosen.
const N_TRIES: usize = 400;

/// Rectangle around the vertical through the middle of the table on which objects are put.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Board {
    /// Half sides of the usable part, metres.
    half_sides_m: [f64; 2],
    /// Height over the table, metres.
    raised_m: f64,
    /// Height of the tallest object that fits, metres.
    headroom_m: f64,
    /// Half sides of a part that is taken by something else, metres; 0 for none.
    taken_half_m: [f64; 2],
}

/// Occupied disc of a board: its middle and its radius, metres.
pub(crate) type Disc = ([f64; 2], f64);

impl Board {
    fn of(size_m: [f64; 2], rim_m: f64, raised_m: f64) -> Self {
        Self {
            half_sides_m: size_m.map(|side| side / 2.0 - rim_m),
            raised_m,
            headroom_m: f64::INFINITY,
            taken_half_m: [0.0; 2],
        }
    }

    fn table(table: &TableDimensions, tray: Option<&Tray>) -> Self {
        let rim_m = 2.0 * Tray::RIM_WIDTH_M;
        Self {
            taken_half_m: tray.map_or([0.0; 2], |tray| {
                tray.inner_size_m.map(|side| side / 2.0 + rim_m)
            }),
            ..Self::of(table.size_m, TABLE_RIM_M, 0.0)
        }
    }

    /// Rejection sampling of a free position for a disc of `radius_m`, at least `gap_m` from the
    /// taken discs and in the part of the table that the default camera sees well.
    pub(crate) fn free_position(
        &self,
        taken: &[Disc],
        radius_m: f64,
        gap_m: f64,
        random: &mut Random,
    ) -> Option<[f64; 2]> {
        let half: [f64; 2] = std::array::from_fn(|axis| {
            (self.half_sides_m[axis] - radius_m).min(IN_VIEW_HALF_M[axis])
        });
        if half.iter().any(|&half| half < 0.0) {
            return None;
        }
        (0..N_TRIES).find_map(|_| {
            let spot = half.map(|half| random.between(-half, half));
            let is_free = taken.iter().all(|&(other, other_radius_m)| {
                let distance_m = (spot[0] - other[0]).hypot(spot[1] - other[1]);
                distance_m > radius_m + other_radius_m + gap_m
            });
            (is_free && !self.is_taken(spot, radius_m)).then_some(spot)
        })
    }

    /// True if a disc reaches into the part that is taken by something else.
    fn is_taken(&self, spot: [f64; 2], radius_m: f64) -> bool {
        let beside_m: [f64; 2] =
            std::array::from_fn(|axis| (spot[axis].abs() - self.taken_half_m[axis]).max(0.0));
        self.taken_half_m[0] > 0.0 && beside_m[0].hypot(beside_m[1]) < radius_m
    }

    /// True if an object fits onto the empty board.
    pub(crate) fn fits(&self, model: &ObjectModel) -> bool {
        let radius_m = model.footprint_radius_m();
        let is_short = 2.0 * model.half_sides_m.z < self.headroom_m;
        is_short && self.half_sides_m.iter().all(|&half_m| half_m > radius_m)
    }
}

/// Boards of a scene: the tray, the boards of the shelf from the lowest, and the table.
pub(crate) fn boards(scene: &Scene) -> Vec<Board> {
    let mut boards = Vec::new();
    if let Some(tray) = &scene.tray {
        boards.push(Board::of(tray.inner_size_m, 0.0, tray.floor_m));
    }
    if let Some(shelf) = &scene.shelf {
        let under_m = shelf.spacing_m - Shelf::BOARD_M - HEADROOM_M;
        let board = |raised_m| Board {
            headroom_m: if raised_m < shelf.height_m() {
                under_m
            } else {
                f64::INFINITY
            },
            ..Board::of(scene.table.size_m, BOARD_RIM_M, raised_m)
        };
        boards.extend(shelf.board_heights_m().map(board));
        boards.push(board(0.0));
        return boards;
    }
    boards.push(Board::table(&scene.table, scene.tray.as_ref()));
    boards
}

/// Places as many isolated objects as fit, the largest first and on the boards in turn; returns
/// placements in the models' order.
pub(crate) fn place_apart(
    models: &[&ObjectModel],
    boards: &[Board],
    gap_m: f64,
    random: &mut Random,
) -> Vec<ObjectPlacement> {
    let radii: Vec<f64> = models.iter().map(|m| m.footprint_radius_m()).collect();
    let mut order: Vec<usize> = (0..models.len()).collect();
    order.sort_by(|&a, &b| radii[b].total_cmp(&radii[a]));
    let mut taken: Vec<Vec<Disc>> = vec![Vec::new(); boards.len()];
    let mut places = vec![None; models.len()];
    for (turn, index) in order.into_iter().enumerate() {
        let in_turn = (0..boards.len()).map(|step| (turn + step) % boards.len());
        let place = in_turn
            .filter(|&number| boards[number].fits(models[index]))
            .find_map(|number| {
                let board = &boards[number];
                let spot = board.free_position(&taken[number], radii[index], gap_m, random)?;
                Some((number, spot))
            });
        let Some((number, spot)) = place else {
            continue;
        };
        taken[number].push((spot, radii[index]));
        places[index] = Some(ObjectPlacement::Upright {
            position_m: spot,
            yaw_rad: random.between(-PI, PI),
            raised_m: boards[number].raised_m,
        });
    }
    places.into_iter().flatten().collect()
}
