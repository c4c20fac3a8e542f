//! From corners and indices that nobody has checked to a [`TriangleMesh`] that keeps its promises.

use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::assets::{Dropped, TriangleMesh};

/// The farthest coordinate of a corner, 2⁶⁰: beyond it, squares of lengths leave single precision, and
/// what bake places is left out as a whole.
const FARTHEST: f64 = (1u64 << 60) as f64;

/// Why a triangle cannot be drawn; `None` if it can.
pub(super) fn flaw(corners: [Option<Vec3>; 3]) -> Option<Flaw> {
    let [Some(a), Some(b), Some(c)] = corners.map(|corner| corner.map(Vec3::as_dvec3)) else {
        return Some(Flaw::BadIndex);
    };
    if ![a, b, c].into_iter().all(is_in_range) {
        Some(Flaw::OutOfRange)
    } else if (b - a).cross(c - a) == DVec3::ZERO {
        Some(Flaw::ZeroArea)
    } else {
        None
    }
}

fn is_in_range(position: DVec3) -> bool {
    position.is_finite() && position.abs().max_element() <= FARTHEST
}

/// Why a triangle cannot be drawn.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Flaw {
    /// A corner does not exist.
    BadIndex,
    /// A corner is not finite or too far away.
    OutOfRange,
    /// Its corners are in line.
    ZeroArea,
}

impl Flaw {
    /// Counts it.
    pub(super) fn count(self, dropped: &mut Dropped) {
        match self {
            Self::BadIndex => dropped.bad_index += 1,
            Self::OutOfRange => dropped.out_of_range += 1,
            Self::ZeroArea => dropped.zero_area += 1,
        }
    }
}

/// A mesh of the good triangles, and which corner of the source each of its corners is.
#[derive(Debug, Default)]
pub(super) struct Assembled {
    pub(super) mesh: TriangleMesh,
    /// As many as the mesh has positions.
    pub(super) sources: Vec<u32>,
    pub(super) dropped: Dropped,
    /// Triangles of the source.
    pub(super) total: u32,
}

/// Where each corner of the source that is used stands in the mesh.
///
/// A table where it is not much larger than what is in it, else a map: a file may have many small meshes that
/// share one long list of corners.
enum Places {
    Table(Vec<u32>),
    Map(HashMap<u32, u32>),
}

/// No place yet.
const NOWHERE: u32 = u32::MAX;

impl Places {
    fn new(corners: usize, triangles: usize) -> Self {
        if corners <= 16 * triangles {
            Self::Table(vec![NOWHERE; corners])
        } else {
            Self::Map(HashMap::new())
        }
    }

    /// The place of `corner`; the first time it is the one that `add` gives.
    fn get(&mut self, corner: u32, add: impl FnOnce() -> u32) -> u32 {
        match self {
            Self::Table(table) => match table.get_mut(corner as usize) {
                Some(place) if *place == NOWHERE => {
                    *place = add();
                    *place
                }
                Some(place) => *place,
                None => add(),
            },
            Self::Map(map) => *map.entry(corner).or_insert_with(add),
        }
    }
}

/// Keeps the triangles that can be drawn and the corners that they use, in the order of their first use. The source
/// has `corners` corners, which `position` knows.
pub(super) fn assemble(
    corners: usize,
    position: impl Fn(u32) -> Option<Vec3>,
    triangles: impl Iterator<Item = [u32; 3]>,
) -> Assembled {
    let mut assembled = Assembled::default();
    let mut places = Places::new(corners, triangles.size_hint().0);
    for corners in triangles {
        let id = assembled.total;
        assembled.total += 1;
        let found = corners.map(&position);
        if let Some(flaw) = flaw(found) {
            flaw.count(&mut assembled.dropped);
            continue;
        }
        let mesh = &mut assembled.mesh;
        mesh.triangle_ids.push(id);
        mesh.triangles.push([0, 1, 2].map(|corner: usize| {
            places.get(corners[corner], || {
                mesh.positions.extend(found[corner]);
                assembled.sources.push(corners[corner]);
                mesh.positions.len() as u32 - 1
            })
        }));
    }
    assembled
}

impl Assembled {
    /// Sets unit normals; those that are none become the mean of the faces around. Returns how many.
    pub(super) fn set_normals(&mut self, normal: impl Fn(u32) -> Vec3) -> u32 {
        let given = self.sources.iter().map(|&source| normal(source).as_dvec3().try_normalize());
        let given: Vec<Option<DVec3>> = given.collect();
        let mended = given.iter().filter(|normal| normal.is_none()).count() as u32;
        let faces = if mended > 0 { face_sums(&self.mesh) } else { Vec::new() };
        let normals = given.into_iter().enumerate().map(|(index, normal)| {
            let mean = || faces.get(index).and_then(|sum| sum.try_normalize());
            normal.or_else(mean).unwrap_or(DVec3::Y).as_vec3()
        });
        self.mesh.normals = normals.collect();
        mended
    }

    /// Sets unit tangents with their sign in w; if one is none, all go, for tracers can make them anew.
    /// Returns whether they stayed.
    pub(super) fn set_tangents(&mut self, tangent: impl Fn(u32) -> Vec4) -> bool {
        let tangents = self.sources.iter().map(|&source| {
            let tangent = tangent(source);
            let unit = tangent.truncate().as_dvec3().try_normalize()?.as_vec3();
            tangent.w.is_finite().then(|| unit.extend(if tangent.w < 0.0 { -1.0 } else { 1.0 }))
        });
        self.mesh.tangents = tangents.collect::<Option<_>>().unwrap_or_default();
        self.mesh.tangents.len() == self.sources.len()
    }

    /// Sets a set of texture coordinates; those that are not finite become 0.
    pub(super) fn set_uvs(&mut self, set: usize, uv: impl Fn(u32) -> Vec2) {
        let finite = |value: f32| if value.is_finite() { value } else { 0.0 };
        let uvs = self.sources.iter().map(|&source| {
            let uv = uv(source);
            Vec2::new(finite(uv.x), finite(uv.y))
        });
        if let Some(place) = self.mesh.uvs.get_mut(set) {
            *place = uvs.collect();
        }
    }

    /// Sets linear colours with opacity, held in [0, 1]; what is no number becomes 1.
    pub(super) fn set_colors(&mut self, color: impl Fn(u32) -> Vec4) {
        let share = |value: f32| if value.is_nan() { 1.0 } else { value.clamp(0.0, 1.0) };
        let colors = self.sources.iter().map(|&source| Vec4::from_array(color(source).to_array().map(share)));
        self.mesh.colors = colors.collect();
    }
}

/// The sum of the normals of the faces around each corner, weighted by area.
fn face_sums(mesh: &TriangleMesh) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|index| mesh.positions[index as usize].as_dvec3());
        let normal = (b - a).cross(c - a);
        for &index in corners {
            sums[index as usize] += normal;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_triangles_go_and_good_ones_keep_their_numbers() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(f32::NAN), Vec3::X * 2.0, Vec3::Z];
        let triangles = [[0, 1, 9], [5, 0, 1], [0, 1, 3], [0, 1, 4], [0, 2, 1]];
        let built = assemble(6, |index| positions.get(index as usize).copied(), triangles.into_iter());
        assert_eq!((built.mesh.triangle_ids, built.total), (vec![1, 4], 5));
        assert_eq!(built.sources, [5, 0, 1, 2]);
        assert_eq!(built.mesh.triangles, [[0, 1, 2], [1, 3, 2]]);
        let dropped = built.dropped;
        assert_eq!((dropped.bad_index, dropped.out_of_range, dropped.zero_area), (1, 1, 1));
    }

    #[test]
    fn attributes_are_finite_whatever_the_file_says() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let mut built = assemble(99, |index| positions.get(index as usize).copied(), [[0, 1, 2]].into_iter());
        let bad = [f32::NAN, f32::INFINITY, 0.0];
        assert_eq!(built.set_normals(|index| Vec3::splat(bad[index as usize])), 3);
        assert_eq!(built.mesh.normals, [Vec3::Z; 3]);
        assert!(!built.set_tangents(|index| Vec4::splat(bad[index as usize])));
        assert!(built.mesh.tangents.is_empty());
        assert!(built.set_tangents(|_| Vec4::new(0.0, 2.0, 0.0, -0.5)));
        assert_eq!(built.mesh.tangents, [Vec4::new(0.0, 1.0, 0.0, -1.0); 3]);
        built.set_uvs(1, |index| Vec2::splat(bad[index as usize]));
        assert_eq!(built.mesh.uvs, [vec![], vec![Vec2::ZERO; 3]]);
        built.set_colors(|_| Vec4::new(f32::NAN, f32::INFINITY, -1.0, 0.5));
        assert_eq!(built.mesh.colors, [Vec4::new(1.0, 1.0, 0.0, 0.5); 3]);
    }
}
