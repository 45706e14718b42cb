//! Ray intersection with quadrics, rings, boxes and tori, in the object frame.

use nalgebra::{Point3, Vector3};

/// Half-line; the direction's length is the unit of its parameter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub(super) origin: Point3<f64>,
    pub(super) direction: Vector3<f64>,
}

impl Ray {
    pub(super) fn at(&self, t: f64) -> Point3<f64> {
        self.origin + self.direction * t
    }
}

/// Intersection of a ray with a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    /// Ray parameter of the intersection, > 0.
    pub(super) t: f64,
    /// Unit normal on the side of the ray's origin.
    pub(super) normal: Vector3<f64>,
}

/// Two-sided geometric surface; metres, z up.
#[derive(Debug, Clone, Copy)]
pub(super) enum Surface {
    /// Surface of revolution around z: `x² + y² = a z² + b z + c` for z in a range.
    Revolved { quadric: [f64; 3], z: [f64; 2] },
    /// Flat ring between two radii at a height.
    Ring { z: f64, radii: [f64; 2] },
    /// Closed box along the axes, from corner to corner.
    Cuboid { corners: [[f64; 3]; 2] },
    /// Half torus: axis along y, centre at this x and z, outside the cylinder around z
    /// through that centre.
    Handle { centre: [f64; 2], radii: [f64; 2] },
}

impl Surface {
    pub(super) const fn cylinder(radius: f64, z: [f64; 2]) -> Self {
        Self::Revolved {
            quadric: [0.0, 0.0, radius * radius],
            z,
        }
    }

    /// Truncated cone with one radius at each end of its range of heights.
    pub(super) const fn frustum(radii: [f64; 2], z: [f64; 2]) -> Self {
        let slope = (radii[1] - radii[0]) / (z[1] - z[0]);
        let at_zero = radii[0] - slope * z[0];
        Self::Revolved {
            quadric: [slope * slope, 2.0 * slope * at_zero, at_zero * at_zero],
            z,
        }
    }

    /// Part of a sphere around `(0, 0, centre_z)` within a range of heights.
    pub(super) const fn sphere(radius: f64, centre_z: f64, z: [f64; 2]) -> Self {
        let c = radius * radius - centre_z * centre_z;
        Self::Revolved {
            quadric: [-1.0, 2.0 * centre_z, c],
            z,
        }
    }

    pub(super) const fn disc(radius: f64, z: f64) -> Self {
        Self::Ring {
            z,
            radii: [0.0, radius],
        }
    }

    pub(super) const fn cuboid(from: [f64; 3], to: [f64; 3]) -> Self {
        Self::Cuboid {
            corners: [from, to],
        }
    }

    pub(super) const fn ring(radii: [f64; 2], z: f64) -> Self {
        Self::Ring { z, radii }
    }

    pub(super) const fn handle(centre: [f64; 2], radii: [f64; 2]) -> Self {
        Self::Handle { centre, radii }
    }

    /// Nearest intersection of the surface with a ray.
    pub(super) fn hit(&self, ray: &Ray) -> Option<Hit> {
        let (t, outwards) = match self {
            Self::Revolved { quadric, z } => revolved(*quadric, *z, ray),
            Self::Ring { z, radii } => ring(*z, *radii, ray),
            Self::Cuboid { corners } => cuboid(corners, ray),
            Self::Handle { centre, radii } => handle(*centre, *radii, ray),
        }?;
        let normal = outwards.normalize();
        let normal = if normal.dot(&ray.direction) > 0.0 {
            -normal
        } else {
            normal
        };
        Some(Hit { t, normal })
    }
}

/// Ray intersection with a quadric of revolution: the nearer root within the height
/// range.
fn revolved([a, b, c]: [f64; 3], z: [f64; 2], ray: &Ray) -> Option<(f64, Vector3<f64>)> {
    let (o, d) = (ray.origin, ray.direction);
    let square = d.x * d.x + d.y * d.y - a * d.z * d.z;
    let half_linear = o.x * d.x + o.y * d.y - (a * o.z + 0.5 * b) * d.z;
    let constant = o.x * o.x + o.y * o.y - (a * o.z + b) * o.z - c;
    let discriminant = half_linear * half_linear - square * constant;
    if discriminant < 0.0 || square == 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let (t0, t1) = (
        (-half_linear - root) / square,
        (-half_linear + root) / square,
    );
    [t0.min(t1), t0.max(t1)]
        .into_iter()
        .filter(|t| *t > 0.0)
        .map(|t| (t, ray.at(t)))
        .find(|(_, p)| (z[0]..=z[1]).contains(&p.z))
        .map(|(t, p)| (t, Vector3::new(p.x, p.y, -a * p.z - 0.5 * b)))
}

fn ring(z: f64, radii: [f64; 2], ray: &Ray) -> Option<(f64, Vector3<f64>)> {
    let t = (z - ray.origin.z) / ray.direction.z;
    let radius = ray.at(t).coords.xy().norm();
    (t > 0.0 && (radii[0]..=radii[1]).contains(&radius)).then(|| (t, Vector3::z()))
}

/// Slab method: the box is entered where the last of the three slabs is.
fn cuboid(corners: &[[f64; 3]; 2], ray: &Ray) -> Option<(f64, Vector3<f64>)> {
    let (mut enter, mut leave, mut axis) = (0.0, f64::INFINITY, None);
    for (i, (low, high)) in corners[0].iter().zip(&corners[1]).enumerate() {
        let t0 = (low - ray.origin[i]) / ray.direction[i];
        let t1 = (high - ray.origin[i]) / ray.direction[i];
        if t0.min(t1) > enter {
            (enter, axis) = (t0.min(t1), Some(i));
        }
        leave = leave.min(t0.max(t1));
    }
    let axis = axis.filter(|_| enter <= leave)?;
    Some((enter, Vector3::ith(axis, 1.0)))
}

/// Sphere tracing (Hart 1996): the distance to the nearest surface is a safe step, which
/// avoids the quartic equation of the torus.
fn handle([x, z]: [f64; 2], [major, minor]: [f64; 2], ray: &Ray) -> Option<(f64, Vector3<f64>)> {
    let distance = |p: &Point3<f64>| {
        let from_circle = (p.x - x).hypot(p.z - z) - major;
        let torus = from_circle.hypot(p.y) - minor;
        torus.max(x - p.x.hypot(p.y))
    };
    let speed = ray.direction.norm();
    let centre = Point3::new(x, 0.0, z);
    let closest = (centre - ray.origin).dot(&ray.direction) / (speed * speed);
    let reach = (major + minor) / speed;
    if (ray.at(closest) - centre).norm() > major + minor {
        return None;
    }
    let mut t = (closest - reach).max(0.0);
    while t < closest + reach {
        let p = ray.at(t);
        let free = distance(&p);
        if free < 1e-5 {
            let slope = |i| {
                let step = Vector3::ith(i, 1e-5);
                distance(&(p + step)) - distance(&(p - step))
            };
            return (t > 0.0).then(|| (t, Vector3::new(slope(0), slope(1), slope(2))));
        }
        t += free / speed;
    }
    None
}
