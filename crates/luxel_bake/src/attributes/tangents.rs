//! Tangents as Mikkelsen's algorithm makes them, which is what normal maps are baked for.
use bevy_mikktspace::{Geometry, TangentSpace};
use glam::{Vec2, Vec3};
use luxel_scene::TriangleMesh;

use super::corners::{Tangent, at};

/// A mesh as the algorithm sees it: a face per triangle.
struct Surface<'a, N> {
    mesh: &'a TriangleMesh,
    uvs: &'a [Vec2],
    normals_at: N,
    tangents: Vec<[Option<Tangent>; 3]>,
}

/// The tangents of every triangle's corners; `None` where texture coordinates do not say.
pub(super) fn compute(
    mesh: &TriangleMesh,
    uvs: &[Vec2],
    normals_at: impl Fn(usize) -> [Vec3; 3],
) -> Vec<[Option<Tangent>; 3]> {
    let tangents = vec![[None; 3]; mesh.triangles.len()];
    let mut surface = Surface { mesh, uvs, normals_at, tangents };
    // Its error has no values: what cannot be computed is `None`.
    _ = bevy_mikktspace::generate_tangents(&mut surface);
    surface.tangents
}

impl<N: Fn(usize) -> [Vec3; 3]> Geometry for Surface<'_, N> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, vert: usize) -> [f32; 3] {
        at(&self.mesh.positions, self.mesh.triangles[face])[vert].to_array()
    }

    fn normal(&self, face: usize, vert: usize) -> [f32; 3] {
        (self.normals_at)(face)[vert].to_array()
    }

    fn tex_coord(&self, face: usize, vert: usize) -> [f32; 2] {
        // The algorithm's v goes upwards.
        let Vec2 { x, y } = at(self.uvs, self.mesh.triangles[face])[vert];
        [x, 1.0 - y]
    }

    fn set_tangent(&mut self, tangent_space: Option<TangentSpace>, face: usize, vert: usize) {
        self.tangents[face][vert] = tangent_space.and_then(|space| {
            let [x, y, z, sign] = space.tangent_encoded();
            Some((Vec3::new(x, y, z).try_normalize()?, sign < 0.0))
        });
    }
}
