//! Single-view reprojection of an unorganised cloud onto an image grid.

use super::label_groups::UNLABELLED;
use super::pixel_lattice::PixelLattice;
use super::resampling::{PixelCentres, resample};
use super::view_extent::{ViewExtent, tangents_of};
use point_cloud::{OrganizedCloud, Point, Rgba};
use random::Random;

/// Target number of points of the lattice fit.
const N_FITTED: usize = 16_384;

/// Least share of the finite points in front of the camera of a single view. Chosen.
const SEEN_SHARE_MIN: f64 = 0.98;

/// Greatest share of the points behind others in a single view. Chosen.
const LAYERED_SHARE_MAX: f64 = 0.05;

/// Least share of the points at the usual density when no lattice is found: a camera
/// samples every direction once, a merged cloud does not. Chosen.
const UNIFORM_SHARE_MIN: f64 = 0.75;

/// Ratio of pixel width to mean point spacing without a lattice, so that few pixels stay
/// empty. Chosen.
const PIXEL_WIDENING: f64 = 1.5;

/// Mean point spacing above which columns are merged, pixels, because too many would stay
/// empty. Chosen.
const SPARSE_SPACING_PX: f64 = 1.2;

/// Least distance behind a pixel's surface at which a point belongs to another surface,
/// metres; constant up to 1 m depth, then growing with squared depth. Chosen.
const BEHIND_M: f32 = 0.02;

/// Pixel pitch of a Kinect v1, tangent. Thresholds of the image path count such pixels;
/// finer views are merged to about this pitch.
const KINECT_PITCH: f64 = 1.0 / 585.0;

/// Field of view of a Kinect v1, tangents of width and height. A smaller view gets empty
/// margins up to this size.
const KINECT_VIEW: [f64; 2] = [640.0 * KINECT_PITCH, 480.0 * KINECT_PITCH];

/// Greatest number of pixels of an image; a finer view is downsampled.
const N_PIXELS_MAX: f64 = 4_194_304.0;

/// Greatest number of pixels of an image with margins.
const N_PIXELS_WITH_MARGIN_MAX: f64 = 1_048_576.0;

/// Longest side of an image, pixels.
const SIDE_PX_MAX: f64 = 8192.0;

/// Evidence that a cloud is a single view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ViewEvidence {
    /// Unorganised points that lie on the rows and columns of an image.
    Lattice,
    /// Unorganised points that cover the viewing directions with uniform density.
    UniformDensity,
}

/// Single-view image made last, with buffers.
#[derive(Debug, Default)]
pub(super) struct SingleView {
    extent: ViewExtent,
    tangents: [Vec<f32>; 2],
    columns: Vec<f64>,
    gaps: Vec<f64>,
    size: [usize; 2],
    image: Vec<Point>,
    pixel_of_point: Vec<u32>,
    depths: Vec<f32>,
}

/// Pixel grid of the image to be rendered.
#[derive(Debug, Clone, Copy)]
struct PixelGrid {
    lattices: [PixelLattice; 2],
    first: [i64; 2],
    size: [usize; 2],
}

impl PixelGrid {
    /// Grid around the extent of a view, with margins.
    fn around(extent: &ViewExtent, lattices: [PixelLattice; 2]) -> Self {
        let margined = [0, 1].map(|axis| {
            let half = 0.5 * KINECT_VIEW[axis] as f32;
            let [low, high] = extent.tangents[axis];
            [low.min(-half), high.max(half)]
        });
        let lattices = lattices
            .map(|lattice| lattice.downsampled(n_merged_columns(lattice.pitch(), extent.pitch)));
        let with_margin = Self::over(margined, lattices, 1.0);
        if with_margin.n_pixels() <= N_PIXELS_WITH_MARGIN_MAX {
            return with_margin;
        }
        let mut grid = Self::over(extent.tangents, lattices, 1.0);
        let mut n = 1.0;
        while grid.n_pixels() > N_PIXELS_MAX || grid.longest_side() > SIDE_PX_MAX {
            n += 1.0;
            grid = Self::over(extent.tangents, lattices, n);
        }
        grid
    }

    fn over(tangents: [[f32; 2]; 2], lattices: [PixelLattice; 2], n: f64) -> Self {
        let lattices = lattices.map(|lattice| lattice.downsampled(n));
        let column = |axis: usize, side: usize| lattices[axis].column_of(tangents[axis][side]);
        let size = [0, 1].map(|axis| (column(axis, 1) - column(axis, 0)).max(1) as usize + 1);
        Self {
            lattices,
            first: [column(0, 0), column(1, 0)],
            size,
        }
    }

    fn n_pixels(&self) -> f64 {
        self.size[0] as f64 * self.size[1] as f64
    }

    fn longest_side(&self) -> f64 {
        self.size[0].max(self.size[1]) as f64
    }

    fn centres(&self) -> PixelCentres {
        let first = |axis: usize| self.lattices[axis].tangent_of(self.first[axis]) as f32;
        PixelCentres {
            first: [first(0), first(1)],
            pitch: self.lattices.map(|lattice| lattice.pitch() as f32),
        }
    }

    /// Pixel in whose viewing cone a point lies.
    #[inline]
    fn pixel_of(&self, point: &Point) -> Option<usize> {
        let [u, v] = tangents_of(point)?;
        let column = usize::try_from(self.lattices[0].column_of(u) - self.first[0]).ok()?;
        let row = usize::try_from(self.lattices[1].column_of(v) - self.first[1]).ok()?;
        (column < self.size[0] && row < self.size[1]).then(|| row * self.size[0] + column)
    }
}

/// Number of lattice columns merged into one image column.
fn n_merged_columns(pitch: f64, point_pitch: f64) -> f64 {
    let n_sparse = if point_pitch > SPARSE_SPACING_PX * pitch {
        (PIXEL_WIDENING * point_pitch / pitch).floor()
    } else {
        1.0
    };
    (KINECT_PITCH / pitch).round().max(n_sparse)
}

impl SingleView {
    /// Reproject a cloud onto an image; `None` when it is not a single view from its origin
    /// along z.
    pub(super) fn reproject(&mut self, points: &[Point]) -> Option<ViewEvidence> {
        self.size = [0, 0];
        self.extent.measure(points)?;
        if self.extent.seen_share < SEEN_SHARE_MIN {
            return None;
        }
        let (lattices, trust) = match self.fit_lattices() {
            Some(lattices) => (lattices, ViewEvidence::Lattice),
            None if self.extent.uniform_share < UNIFORM_SHARE_MIN => return None,
            None => (self.uniform_lattices(), ViewEvidence::UniformDensity),
        };
        let grid = PixelGrid::around(&self.extent, lattices);
        self.render(points, &grid);
        let joins = |axis: usize| grid.lattices[axis].pitch() > lattices[axis].pitch();
        if trust == ViewEvidence::UniformDensity || joins(0) || joins(1) {
            let Self { image, depths, .. } = self;
            resample(image, grid.size[0], &grid.centres(), depths);
        }
        let (mut n_placed, mut n_layered) = (0, 0);
        for (i, point) in points.iter().enumerate() {
            if self.pixel_of_point[i] != UNLABELLED {
                n_placed += 1;
                n_layered += usize::from(!self.is_at_surface(i, point));
            }
        }
        (n_layered as f64 <= LAYERED_SHARE_MAX * f64::from(n_placed)).then_some(trust)
    }

    /// Virtual depth image that was made last.
    pub(super) fn image(&self) -> Option<OrganizedCloud<'_>> {
        OrganizedCloud::new(&self.image, self.size[0], self.size[1]).ok()
    }

    /// Pixel whose surface a point belongs to.
    #[inline]
    pub(super) fn surface_pixel(&self, index: usize, point: &Point) -> Option<usize> {
        let pixel = self.pixel_of_point[index];
        (pixel != UNLABELLED && self.is_at_surface(index, point)).then_some(pixel as usize)
    }

    #[inline]
    fn is_at_surface(&self, index: usize, point: &Point) -> bool {
        let surface_m = self.image[self.pixel_of_point[index] as usize].z;
        point.z - surface_m <= BEHIND_M * (surface_m * surface_m).max(1.0)
    }

    fn fit_lattices(&mut self) -> Option<[PixelLattice; 2]> {
        let sample = self.extent.sample();
        let mut random = Random::from_seed(sample.len() as u64);
        self.tangents.iter_mut().for_each(Vec::clear);
        for _ in 0..N_FITTED {
            let [u, v] = sample[random.below(sample.len())];
            self.tangents[0].push(u);
            self.tangents[1].push(v);
        }
        let Self {
            tangents: [u, v],
            columns,
            gaps,
            extent,
            ..
        } = self;
        let columns_of_image = PixelLattice::fit(u, extent.pitch, columns, gaps)?;
        Some([
            columns_of_image,
            PixelLattice::fit(v, extent.pitch, columns, gaps)?,
        ])
    }

    fn uniform_lattices(&self) -> [PixelLattice; 2] {
        let pitch = PIXEL_WIDENING * self.extent.pitch;
        self.extent
            .tangents
            .map(|[low, _]| PixelLattice::new(f64::from(low), pitch))
    }

    /// Render the points with a z-buffer: each pixel keeps the nearest.
    fn render(&mut self, points: &[Point], grid: &PixelGrid) {
        self.size = grid.size;
        self.image.clear();
        self.image.resize(
            grid.size[0] * grid.size[1],
            Point::without_depth(Rgba::default()),
        );
        self.pixel_of_point.clear();
        self.pixel_of_point.extend(points.iter().map(|point| {
            let Some(pixel) = grid.pixel_of(point) else {
                return UNLABELLED;
            };
            let drawn = &mut self.image[pixel];
            if drawn.z.is_nan() || point.z < drawn.z {
                *drawn = *point;
            }
            pixel as u32
        }));
    }
}
