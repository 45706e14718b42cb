//! Synthetic test meshes and a table scene made of them.

#![allow(dead_code, reason = "each user needs only a part of it")]
#![allow(
    clippy::unwrap_used,
    reason = "a fixture of tests, benchmarks and examples"
)]

use geometry::{PinholeCamera, RigidTransform};
use mesh::{Surface, Triangle, TriangleMesh, Vertex};
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use rendering::{Instance, Lights, PreparedMesh, Rasterizer, StaticScene, Texture};
use std::f32::consts::{PI, TAU};

/// Grid mesh over `(u, v)` in 0..=1, two triangles per cell.
pub(crate) fn patch(
    mesh: &mut TriangleMesh,
    (n_u, n_v): (u32, u32),
    color: [u8; 3],
    at: impl Fn(f32, f32) -> (Vector3<f32>, Vector3<f32>),
) {
    let first = mesh.vertices.len() as u32;
    for j in 0..=n_v {
        for i in 0..=n_u {
            let (position, normal) = at(i as f32 / n_u as f32, j as f32 / n_v as f32);
            mesh.vertices.push(Vertex {
                position: Point3::from(position),
                normal: normal.normalize(),
                color,
            });
        }
    }
    let at = |i: u32, j: u32| first + j * (n_u + 1) + i;
    for j in 0..n_v {
        for i in 0..n_u {
            let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            for vertices in [
                [corners[0], corners[1], corners[2]],
                [corners[0], corners[2], corners[3]],
            ] {
                mesh.triangles.push(Triangle {
                    vertices,
                    surface: 0,
                });
            }
        }
    }
}

/// Rectangle around the origin in x and y, facing +z.
pub(crate) fn rectangle(width: f32, depth: f32, n: u32, color: [u8; 3]) -> TriangleMesh {
    let mut mesh = matte();
    patch(&mut mesh, (n, n), color, |u, v| {
        (
            Vector3::new((u - 0.5) * width, (v - 0.5) * depth, 0.0),
            Vector3::z(),
        )
    });
    mesh
}

/// Box around the origin, `n` cells along each edge.
pub(crate) fn cuboid(sides: [f32; 3], n: u32, color: [u8; 3]) -> TriangleMesh {
    let mut mesh = matte();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            patch(&mut mesh, (n, n), color, |u, v| {
                let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut position = Vector3::zeros();
                position[axis] = sign * sides[axis] / 2.0;
                position[a] = sign * (u - 0.5) * sides[a];
                position[b] = (v - 0.5) * sides[b];
                let mut normal = Vector3::zeros();
                normal[axis] = sign;
                (position, normal)
            });
        }
    }
    mesh
}

/// Sphere around the origin with `4 n²` triangles.
pub(crate) fn ball(radius: f32, n: u32, color: [u8; 3]) -> TriangleMesh {
    let mut mesh = matte();
    patch(&mut mesh, (2 * n, n), color, |u, v| {
        let (longitude, latitude) = (u * TAU, (v - 0.5) * PI);
        let normal = Vector3::new(
            latitude.cos() * longitude.cos(),
            latitude.cos() * longitude.sin(),
            latitude.sin(),
        );
        (normal * radius, normal)
    });
    mesh
}

/// Closed cylinder around z, centred at the origin.
pub(crate) fn cylinder(radius: f32, height: f32, n: u32, color: [u8; 3]) -> TriangleMesh {
    let mut mesh = matte();
    let rim = |u: f32| Vector3::new((u * TAU).cos(), (u * TAU).sin(), 0.0);
    patch(&mut mesh, (2 * n, n / 2), color, |u, v| {
        (rim(u) * radius + Vector3::z() * (v - 0.5) * height, rim(u))
    });
    for sign in [-1.0_f32, 1.0] {
        patch(&mut mesh, (2 * n, n / 2), color, |u, v| {
            (
                rim(sign * u) * radius * (1.0 - v) + Vector3::z() * sign * height / 2.0,
                Vector3::z() * sign,
            )
        });
    }
    mesh
}

fn matte() -> TriangleMesh {
    TriangleMesh {
        surfaces: vec![Surface::MATTE],
        ..TriangleMesh::default()
    }
}

/// Replaces the surface finish of a mesh.
pub(crate) fn with_surface(mut mesh: TriangleMesh, specular: f32, infrared: f32) -> TriangleMesh {
    mesh.surfaces = vec![Surface { specular, infrared }];
    mesh
}

pub(crate) fn at(x: f64, y: f64, z: f64) -> RigidTransform {
    RigidTransform::translation(x, y, z)
}

pub(crate) fn turned(x: f64, y: f64, z: f64, angles: [f64; 3]) -> RigidTransform {
    RigidTransform::from_parts(
        Translation3::new(x, y, z),
        UnitQuaternion::from_euler_angles(angles[0], angles[1], angles[2]),
    )
}

/// Look-at camera pose from one point to another, image upright.
pub(crate) fn looking(from: [f64; 3], to: [f64; 3]) -> RigidTransform {
    let (from, to) = (Vector3::from(from), Vector3::from(to));
    let forward = (to - from).normalize();
    let right = forward.cross(&Vector3::z()).normalize();
    let down = forward.cross(&right);
    let rotation =
        Rotation3::from_matrix_unchecked(nalgebra::Matrix3::from_columns(&[right, down, forward]));
    Isometry3::from_parts(
        Translation3::from(from),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}

/// Room with a table, whose top is at z = 0, and objects on it.
pub(crate) struct TableScene {
    room: Vec<(PreparedMesh, RigidTransform, Texture)>,
    objects: Vec<(TriangleMesh, PreparedMesh, RigidTransform)>,
    room_meshes: Vec<TriangleMesh>,
}

impl TableScene {
    /// Scene with `n_objects` objects of about 4 000 triangles each.
    pub(crate) fn new(n_objects: usize) -> Self {
        let room: Vec<_> = room();
        let meshes = object_meshes();
        let objects = (0..n_objects)
            .map(|i| {
                let (mesh, height) = &meshes[i % meshes.len()];
                (
                    mesh.clone(),
                    PreparedMesh::new(mesh),
                    object_pose(i, n_objects, f64::from(*height)),
                )
            })
            .collect();
        Self {
            room_meshes: room.iter().map(|(mesh, ..)| mesh.clone()).collect(),
            room: room
                .into_iter()
                .map(|(mesh, pose, texture)| (PreparedMesh::new(&mesh), pose, texture))
                .collect(),
            objects,
        }
    }

    pub(crate) fn world_from_camera() -> RigidTransform {
        looking([0.0, -0.95, 0.62], [0.0, 0.05, 0.0])
    }

    /// Camera pose of an orbit around the table, half a degree per frame.
    pub(crate) fn orbiting_camera(frame_index: u64) -> RigidTransform {
        let (sin, cos) = ((frame_index % 720) as f64 * std::f64::consts::PI / 360.0).sin_cos();
        looking([0.95 * sin, -0.95 * cos, 0.62], [0.0, 0.05, 0.0])
    }

    pub(crate) fn background(&self) -> Vec<Instance<'_>> {
        self.room
            .iter()
            .enumerate()
            .map(|(i, (mesh, pose, texture))| Instance {
                texture: *texture,
                ..Instance::new(mesh, *pose, i as u16 + 1)
            })
            .collect()
    }

    pub(crate) fn objects(&self) -> Vec<Instance<'_>> {
        self.objects
            .iter()
            .enumerate()
            .map(|(i, (_, mesh, pose))| Instance::new(mesh, *pose, i as u16 + 10))
            .collect()
    }

    /// Rasterizer that has rendered the room.
    pub(crate) fn prepared_rasterizer(&self, camera: PinholeCamera) -> Rasterizer {
        let mut rasterizer = Rasterizer::new(camera).unwrap();
        rasterizer
            .prepare(&StaticScene {
                world_from_camera: Self::world_from_camera(),
                lights: Lights::ROOM,
                background: &self.background(),
            })
            .unwrap();
        rasterizer
    }

    /// All source meshes with their poses.
    pub(crate) fn meshes(&self) -> Vec<(&TriangleMesh, RigidTransform)> {
        let room = self.room_meshes.iter().zip(&self.room);
        room.map(|(mesh, (_, pose, _))| (mesh, *pose))
            .chain(self.objects.iter().map(|(mesh, _, pose)| (mesh, *pose)))
            .collect()
    }
}

fn room() -> Vec<(TriangleMesh, RigidTransform, Texture)> {
    let wood = Texture::WoodGrain {
        board_m: 0.14,
        contrast: 0.45,
    };
    let tiles = Texture::Tiles {
        side_m: 0.3,
        joint_m: 0.006,
    };
    let plaster = Texture::Mottle {
        scale_m: 0.25,
        contrast: 0.12,
    };
    let mut parts = vec![
        (
            cuboid([1.4, 0.8, 0.03], 2, [196, 148, 98]),
            at(0.0, 0.0, -0.015),
            wood,
        ),
        (
            rectangle(6.0, 6.0, 6, [150, 145, 138]),
            at(0.0, 0.0, -0.72),
            tiles,
        ),
        (
            rectangle(6.0, 4.0, 6, [214, 208, 190]),
            turned(0.0, 1.5, 0.6, [std::f64::consts::FRAC_PI_2, 0.0, 0.0]),
            plaster,
        ),
    ];
    for (x, y) in [(-0.65, -0.35), (0.65, -0.35), (-0.65, 0.35), (0.65, 0.35)] {
        parts.push((
            cuboid([0.05, 0.05, 0.69], 1, [120, 90, 60]),
            at(x, y, -0.375),
            Texture::None,
        ));
    }
    parts
}

/// Object meshes with the height of their centres.
fn object_meshes() -> Vec<(TriangleMesh, f32)> {
    vec![
        (
            with_surface(cylinder(0.04, 0.10, 32, [190, 40, 36]), 0.25, 1.0),
            0.05,
        ),
        (cuboid([0.09, 0.06, 0.16], 18, [52, 96, 170]), 0.08),
        (with_surface(ball(0.05, 32, [226, 140, 30]), 0.1, 1.0), 0.05),
        (
            with_surface(cylinder(0.033, 0.12, 32, [176, 178, 182]), 0.85, 1.0),
            0.06,
        ),
        (
            with_surface(cuboid([0.12, 0.08, 0.05], 18, [36, 36, 40]), 0.1, 0.08),
            0.025,
        ),
        (cylinder(0.10, 0.025, 32, [232, 230, 222]), 0.0125),
        (cuboid([0.06, 0.06, 0.22], 18, [96, 160, 70]), 0.11),
        (
            with_surface(ball(0.035, 32, [170, 40, 120]), 0.3, 1.0),
            0.035,
        ),
    ]
}

fn object_pose(index: usize, n: usize, height: f64) -> RigidTransform {
    let per_row = (n as f64).sqrt().ceil().max(4.0) as usize;
    let (column, row) = (index % per_row, index / per_row);
    let x = (column as f64 + 0.5) / per_row as f64 * 1.1 - 0.55 + 0.03 * (row % 2) as f64;
    let y = -0.2 + 0.5 * row as f64 / (per_row as f64 - 1.0);
    turned(x, y, height, [0.0, 0.0, 0.7 * index as f64])
}
