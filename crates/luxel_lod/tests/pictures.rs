//! The renderers over small octrees: what they must agree in to the bit, what they may cost, and what they count.
#![allow(clippy::unwrap_used)]
use glam::{UVec3, Vec3};
use luxel_accel::{Svo, SvoVoxel, build_svo};
use luxel_lod::{
    Adaptive, Contrast, ErrorAware, ErrorTable, LuminanceAware, MISSED, NodeError, Octree, PIXEL_LEVEL,
    Picture, VarianceScale, View, adaptive, error_aware, plain, reference, variances,
};
use luxel_testkit::Random;

const EDGE: u16 = 64;

/// Hills of noisy colours with poles on them.
fn land() -> Svo {
    let mut random = Random::new(11);
    let mut voxels = Vec::new();
    for (x, z) in (0..EDGE).flat_map(|z| (0..EDGE).map(move |x| (x, z))) {
        let height = 8 + (x / 3 + z / 5) % 9 + random.below(2) as u16;
        let shade = random.below(200) as u8;
        let pole = if random.below(40) == 0 { 12 } else { 0 };
        voxels.extend((height - 3..height + pole).map(|y| SvoVoxel {
            cell: [x, y, z],
            color: [shade, shade / 2, 255 - shade],
            material: 0,
        }));
    }
    build_svo(&voxels, UVec3::splat(u32::from(EDGE))).unwrap()
}

fn views() -> Vec<View> {
    let middle = Vec3::splat(32.0);
    vec![
        View::down(Vec3::new(32.3, 60.0, 31.6), 20),
        View::toward(Vec3::new(-20.0, 50.0, -9.0), middle, 1.2, 24),
        View::cube(Vec3::new(30.0, 30.0, 30.0), 8)[4],
    ]
}

fn refined(octree: &Octree<'_>, view: &View, table: &ErrorTable, threshold: f32) -> Picture {
    let error = NodeError { table, decay: 0.2 };
    error_aware(octree, view, &ErrorAware { error, threshold, keeps_ray: false, luminance: None })
}

fn rgb(picture: &Picture) -> Vec<[u32; 3]> {
    picture.pixels.iter().map(|pixel| pixel.rgb.to_array().map(f32::to_bits)).collect()
}

#[test]
fn an_unreachable_threshold_is_plain_and_a_negative_one_the_reference() {
    let svo = land();
    let octree = Octree::of(&svo);
    for table in [ErrorTable::directions(), ErrorTable::Exact] {
        for view in views() {
            assert_eq!(refined(&octree, &view, &table, 10.0), plain(&octree, &view));
            let forced = refined(&octree, &view, &table, -1.0);
            assert_eq!(rgb(&forced), rgb(&reference(&octree, &view)));
        }
    }
}

#[test]
fn a_pixel_costs_at_most_21_rays_and_forcing_costs_them() {
    let svo = land();
    let octree = Octree::of(&svo);
    let table = ErrorTable::directions();
    let view = views()[0];
    let forced = refined(&octree, &view, &table, -1.0);
    assert_eq!(forced.pixels.iter().map(|pixel| pixel.cost.rays).max(), Some(21));
    let some = refined(&octree, &view, &table, 0.3);
    for pixel in &some.pixels {
        let allowed = match pixel.finest {
            // Rays were discarded for others that missed.
            MISSED => 0..=21,
            // Rays that missed are not counted.
            0 => 3..=21,
            1 => 2..=5,
            _ => 1..=1,
        };
        assert!(allowed.contains(&pixel.cost.rays), "{pixel:?}");
        assert!(pixel.cost.steps >= pixel.cost.rays);
    }
    assert!(some.count(0) > 0 && some.count(1) > 0 && some.count(2) > 0);
}

#[test]
fn rays_that_meet_nothing_are_not_counted() {
    let svo = land();
    let view = View::toward(Vec3::new(32.0, 200.0, 32.0), Vec3::new(32.0, 400.0, 32.0), 1.0, 8);
    for picture in [plain(&Octree::of(&svo), &view), reference(&Octree::of(&svo), &view)] {
        assert_eq!((picture.cost().rays, picture.count(MISSED)), (0, 64));
    }
}

#[test]
fn lower_thresholds_cost_more_and_are_nearer_to_the_reference() {
    let svo = land();
    let octree = Octree::of(&svo);
    let table = ErrorTable::directions();
    let view = View::down(Vec3::new(32.3, 60.0, 31.6), 32);
    let wanted = reference(&octree, &view).codes();
    let measured = [1.0, 0.4, 0.2, 0.1, -1.0].map(|threshold| {
        let picture = refined(&octree, &view, &table, threshold);
        let error: f32 = picture.codes().iter().zip(&wanted).map(|(a, b)| (a - b) * (a - b)).sum();
        (picture.cost().rays, error)
    });
    for pair in measured.windows(2) {
        assert!(pair[0].0 <= pair[1].0 && pair[0].1 >= pair[1].1, "{measured:?}");
    }
    assert_eq!(measured[4].1, 0.0);
}

#[test]
fn the_error_of_a_node_is_its_own_and_a_share_of_its_childrens() {
    // A child with one voxel and one with eight, above each other: seen from above, the upper hides the lower.
    let at = |x, y, z| SvoVoxel { cell: [x, y, z], color: [9; 3], material: 0 };
    let full = (0..8u16).map(|i| at(i & 1, 2 + (i >> 1 & 1), i >> 2));
    let svo = build_svo(&full.chain([at(0, 0, 0)]).collect::<Vec<_>>(), UVec3::splat(4)).unwrap();
    let table = ErrorTable::Exact;
    let error = NodeError { table: &table, decay: 0.2 };
    // Two children in one column cover a quarter from above, and half from the side.
    let from_above = error.of(&Octree::of(&svo), 0, -Vec3::Y);
    assert!((from_above - (0.75 + 0.2 * 0.75 / 2.0)).abs() < 1e-6, "{from_above}");
    let from_side = error.of(&Octree::of(&svo), 0, 3.0 * Vec3::X);
    assert!((from_side - (0.5 + 0.2 * 0.75 / 2.0)).abs() < 1e-6, "{from_side}");
}

#[test]
fn variance_is_of_the_neighbourhood_that_shows_something() {
    let svo = land();
    let mut picture = plain(&Octree::of(&svo), &View::down(Vec3::new(32.0, 60.0, 32.0), 8));
    for pixel in &mut picture.pixels {
        pixel.rgb = Vec3::ZERO;
    }
    picture.pixels[27].rgb = Vec3::ONE;
    let all = variances(&picture);
    // One of nine is white: (1 − 1/9)² + 8 (1/9)² = 8/9; at a corner of the neighbourhood just as well.
    for near in [18, 19, 20, 26, 27, 28, 34, 35, 36] {
        assert!((all[near] - 8.0 / 9.0).abs() < 1e-5, "{near}: {}", all[near]);
    }
    assert_eq!(all.iter().filter(|v| **v > 0.0).count(), 9);
    picture.pixels[28].finest = MISSED;
    let without = variances(&picture);
    assert_eq!(without[28], 0.0);
    assert!((without[27] - 7.0 / 8.0).abs() < 1e-5);
}

#[test]
fn adaptive_makes_pixels_again_where_the_picture_varies() {
    let svo = land();
    let octree = Octree::of(&svo);
    let view = View::down(Vec3::new(32.3, 60.0, 31.6), 32);
    let settings = Adaptive::document(VarianceScale(0.1));
    let first = plain(&octree, &view);
    let picture = adaptive(&octree, &view, &settings);
    let full = reference(&octree, &view);
    let mut counts = [0; 3];
    for (index, variance) in variances(&first).into_iter().enumerate() {
        let (before, after) = (&first.pixels[index], &picture.pixels[index]);
        if before.finest == MISSED || variance < 0.25 * 0.1 {
            assert_eq!(before, after);
            counts[0] += 1;
        } else if variance < 0.75 * 0.1 {
            assert!(after.finest == 1 && after.cost.rays <= 5);
            counts[1] += 1;
        } else {
            assert_eq!(
                (after.rgb, after.cost.rays),
                (full.pixels[index].rgb, full.pixels[index].cost.rays + 1)
            );
            counts[2] += 1;
        }
    }
    assert!(counts.into_iter().all(|count| count > 20), "{counts:?}");
    let twice = adaptive(&octree, &view, &Adaptive { iterations: 2, ..settings });
    assert!(twice.cost().rays > picture.cost().rays);
    assert_eq!(first.count(PIXEL_LEVEL as u8) + first.count(MISSED), 32 * 32);
}

#[test]
fn a_kept_ray_is_one_of_sixteen_and_forcing_gives_the_reference() {
    let svo = land();
    let octree = Octree::of(&svo);
    let table = ErrorTable::directions();
    let error = NodeError { table: &table, decay: 0.2 };
    let kept = |threshold| ErrorAware { error, threshold, keeps_ray: true, luminance: None };
    for view in views() {
        let forced = error_aware(&octree, &view, &kept(-1.0));
        let wanted = reference(&octree, &view);
        assert_eq!(rgb(&forced), rgb(&wanted));
        assert_eq!(forced.cost().rays, wanted.cost().rays);
        let some = error_aware(&octree, &view, &kept(0.3));
        let discarded = refined(&octree, &view, &table, 0.3);
        assert!(some.pixels.iter().all(|pixel| pixel.cost.rays <= 16));
        assert!(some.cost().rays < discarded.cost().rays);
    }
}

#[test]
fn contrast_is_the_deviation_of_the_voxels_below() {
    let at = |cell: [u16; 3], shade: u8| SvoVoxel { cell, color: [shade; 3], material: 0 };
    let voxels = [at([0, 0, 0], 0), at([1, 0, 0], 0), at([1, 1, 1], 255), at([3, 0, 0], 51)];
    let svo = build_svo(&voxels, UVec3::splat(4)).unwrap();
    let contrast = Contrast::of(&Octree::of(&svo));
    // The root's: 0, 0, 1, 0.2, mean 0.3; its first child's: 0, 0, 1; its second's one voxel.
    let deviation = |squares: f32, mean: f32| (squares - mean * mean).sqrt();
    let wanted = [deviation(1.04 / 4.0, 0.3), deviation(1.0 / 3.0, 1.0 / 3.0), 0.0];
    for (node, wanted) in (0..).zip(wanted) {
        assert!((contrast.below(node) - wanted).abs() < 1.5e-3, "{node}: {}", contrast.below(node));
    }
}

#[test]
fn what_looks_alike_needs_no_rays_but_a_silhouette_does() {
    let (land, grey) = (land(), 0x5a_5a5a);
    let colors = vec![grey; land.nodes.len()];
    let octree = Octree::of(&land).with_colors(&colors);
    let (table, contrast) = (ErrorTable::directions(), Contrast::of(&octree));
    let luminance = Some(LuminanceAware { contrast: &contrast, weight: 1.0 });
    let error = NodeError { table: &table, decay: 0.2 };
    let blind = ErrorAware { error, threshold: 0.3, keeps_ray: false, luminance: None };
    // Grey on black differs by more than a third.
    let aware = ErrorAware { threshold: 0.1, luminance, ..blind };
    let view = View::toward(Vec3::new(32.0, 60.0, 32.0), Vec3::new(0.0, 6.0, 32.0), 0.5, 16);
    let (all, some) = (error_aware(&octree, &view, &blind), error_aware(&octree, &view, &aware));
    let first = plain(&octree, &view);
    let is_border = |n: usize| {
        let near = |d: isize| first.pixels.get(n.wrapping_add_signed(d)).is_some_and(|p| p.finest == MISSED);
        first.pixels[n].finest != MISSED && [-1, 1, -16, 16].into_iter().any(near)
    };
    let is_refined = |picture: &Picture, n: usize| picture.pixels[n].cost.rays > 1;
    let border: Vec<usize> =
        (17..239).filter(|n| (1..15).contains(&(n % 16)) && is_border(*n) && is_refined(&all, *n)).collect();
    assert!(border.len() > 3, "{}", border.len());
    assert!(border.iter().all(|n| is_refined(&some, *n)), "a silhouette was let go");
    let above = View::toward(Vec3::new(32.0, 60.0, 20.0), Vec3::new(32.0, 0.0, 34.0), 0.4, 16);
    assert!(error_aware(&octree, &above, &blind).cost().rays > 1000);
    assert_eq!(error_aware(&octree, &above, &aware).cost().rays, 256, "equal colours need one ray each");
}
