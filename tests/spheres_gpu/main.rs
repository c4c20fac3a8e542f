//! The sphere cases of robustness.md on the GPU, through the kernel that finds hits, for every structure over the
//! spheres. On the CPU they are in `crates/luxel_cpu/tests/` (`cloud_*.rs`, `spheres.rs`).
//!
//! | case | what | test |
//! |---|---|---|
//! | O01 | small and large spheres, a million rays; how often the report's heuristic errs | `o01` |
//! | O02 | inside one sphere that spans everything | `shapes::o02_inside_one_that_spans_everything` |
//! | O03, B03 | nested and equal spheres | `shapes::o03_b03_nested`, `shapes::o03_equal_spheres_go_by_stable_id` |
//! | O04 | centres on dividing planes | `shapes::o04_centres_on_dividing_planes` |
//! | O05 | rays through corners of cells, zeros of both signs | `shapes::o05_lattice_rays_through_cell_corners` |
//! | O06 | where the ray comes in | `shapes::o06_where_the_ray_comes_in` |
//! | O07 | directions an ulp from a diagonal | `shapes::o07_directions_an_ulp_from_a_diagonal` |
//! | O08 | a sphere an ulp beside a dividing plane | `shapes::o08_a_sphere_an_ulp_beside_a_dividing_plane` |
//! | B06 | centres at powers of two: a deep tree | `shapes::a_tree_deeper_than_the_stack` |
//! | X03 | dust, ball and landscape | `shapes::x03_dust_on_a_table_in_a_landscape` |
//! | S01, S02 | far spheres of every size; scaling by powers of two | `accuracy::s01_…`, `accuracy::s02_…` |
//! | S03 | grazing a planet | `accuracy::s03_grazing_a_planet` |
//! | S04 | tangent rays | `accuracy::s04_tangent_rays` |
//! | S05 | starts on the surface, inside, at the centre | `accuracy::s05_…` |
//! | S06 | between two mirrors | `mirrors::s06_between_two_mirrors` |
//! | S08 | bad radii | `accuracy::s08_bad_radii_are_never_hit` |
//!
//! Besides: a structure that is exchanged within one world (`upload`), and a driver that ends long loops (`cuts`; in meshes,
//! volumes and the TLAS, too).
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod accuracy;
mod compare;
mod cuts;
mod mirrors;
mod o01;
mod scene;
mod shapes;
mod upload;
