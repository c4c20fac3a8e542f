//! Light trees: every node bounds its lights, every trail leads to its light, no depth is too deep, the same input
//! gives the same tree.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
use glam::Vec3;
use luxel_accel::{LightBounds, build_light_tree, validate_light_tree};
use luxel_flat::NONE;
use luxel_testkit::Random;

fn triangle(random: &mut Random, center: Vec3, size: f32) -> LightBounds {
    let axis = random.direction().normalize();
    LightBounds {
        lo: center - size,
        hi: center + size,
        axis,
        cos_normals: 1.0,
        cos_emission: 0.0,
        two_sided: true,
        intensity: f64::from(random.log_between(1e-3, 1e3)),
    }
}

fn point(random: &mut Random, center: Vec3) -> LightBounds {
    LightBounds {
        lo: center,
        hi: center,
        cos_normals: -1.0,
        two_sided: false,
        ..triangle(random, center, 0.0)
    }
}

fn spot(random: &mut Random, center: Vec3) -> LightBounds {
    let (a, b) = (random.between(0.1, 0.9), random.between(0.1, 0.9));
    let (cos_normals, cos_emission) = (f64::from(a), f64::from(b));
    LightBounds { cos_normals, cos_emission, ..point(random, center) }
}

fn mixed(count: usize, seed: u32) -> Vec<LightBounds> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|i| {
            let center = random.direction() * random.log_between(1e-2, 1e2);
            match i % 4 {
                0 | 1 => triangle(&mut random, center, 0.05),
                2 => point(&mut random, center),
                _ => spot(&mut random, center),
            }
        })
        .collect()
}

fn check(lights: &[LightBounds], first: u32) {
    let tree = build_light_tree(lights, first).unwrap();
    validate_light_tree(&tree.nodes, &tree.trails, lights, first).unwrap();
    assert_eq!(tree, build_light_tree(lights, first).unwrap());
}

#[test]
fn trees_of_all_sizes_are_sound() {
    for count in [0, 1, 2, 3, 4, 5, 17, 300, 5000] {
        check(&mixed(count, count as u32), 7);
    }
}

#[test]
fn lights_in_one_place_and_on_a_line_are_split() {
    let mut random = Random::new(1);
    check(&(0..3000).map(|_| point(&mut random, Vec3::ONE)).collect::<Vec<_>>(), 0);
    check(&(0..3000).map(|i| point(&mut random, Vec3::X * i as f32)).collect::<Vec<_>>(), 0);
    // Each twice as far out as the last: a split by cost peels them off one by one.
    check(&(0..100).map(|i| point(&mut random, Vec3::X * (i as f32 / 4.0).exp2())).collect::<Vec<_>>(), 0);
    check(&(0..120).map(|i| point(&mut random, Vec3::X * ((i - 60) as f32).exp2())).collect::<Vec<_>>(), 0);
}

#[test]
fn dark_and_broken_lights_are_left_out() {
    let mut lights = mixed(40, 3);
    lights[3].intensity = 0.0;
    lights[11].intensity = f64::NAN;
    lights[20].lo = Vec3::NAN;
    let tree = build_light_tree(&lights, 0).unwrap();
    assert_eq!([3, 11, 20].map(|i: usize| tree.trails[i]), [NONE; 3]);
    validate_light_tree(&tree.nodes, &tree.trails, &lights, 0).unwrap();
    let dark = vec![LightBounds { intensity: 0.0, ..lights[0] }; 5];
    assert!(build_light_tree(&dark, 0).unwrap().nodes.is_empty());
}

#[test]
fn a_damaged_tree_is_found() {
    let lights = mixed(60, 4);
    let tree = build_light_tree(&lights, 0).unwrap();
    let breaks: [fn(&mut luxel_accel::LightTree); 4] = [
        |tree| tree.trails[9] ^= 1,
        |tree| tree.nodes[0].hi[1] = 0.0,
        |tree| tree.nodes[1].power *= 1e3,
        |tree| tree.nodes[0].cos_emission = 0.5,
    ];
    for damage in breaks {
        let mut broken = tree.clone();
        damage(&mut broken);
        assert!(validate_light_tree(&broken.nodes, &broken.trails, &lights, 0).is_err());
    }
}

#[test]
fn ten_thousand_lights_are_quickly_built() {
    let lights = mixed(10_000, 5);
    let start = std::time::Instant::now();
    let tree = build_light_tree(&lights, 0).unwrap();
    println!("10,000 lights: {:?}, {} nodes", start.elapsed(), tree.nodes.len());
    validate_light_tree(&tree.nodes, &tree.trails, &lights, 0).unwrap();
}
