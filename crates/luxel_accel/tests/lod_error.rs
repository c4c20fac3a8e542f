//! The error of showing a voxel node instead of its children, against areas found another way.
use glam::{DVec2, DVec3};
use luxel_accel::lod_error::{DirectionTable, Errors, OctantShares, Sh9, even_directions};
use luxel_geom::lod_error::Place;
use luxel_testkit::Random;

/// Directions of every kind: along axes, diagonals, in planes of symmetry, nearly so, and at random.
fn directions() -> Vec<DVec3> {
    let mut directions = Vec::new();
    for n in 1..27 {
        let signs = [n % 3, n / 3 % 3, n / 9].map(|digit| f64::from(digit) - 1.0);
        directions.extend((signs != [0.0; 3]).then_some(DVec3::from(signs)));
        directions.push(DVec3::from(signs) + DVec3::new(1e-9, 2e-9, 1e-7));
    }
    let mut random = Random::new(3);
    directions.extend((0..200).map(|_| random.direction().as_dvec3()));
    directions
}

/// The area of the union of boxes' projections, and that of the unit cube's, by exact sweeps: between two neighbouring
/// heights at which a corner lies or two outlines cross, the covered width is linear.
fn areas(children: u8, direction: DVec3) -> [f64; 2] {
    let (right, up) = direction.normalize().any_orthonormal_pair();
    let outline = |low: DVec3, edge: f64| {
        let corner = |n: u32| {
            let at = low + edge * DVec3::new(f64::from(n & 1), f64::from(n >> 1 & 1), f64::from(n >> 2));
            DVec2::new(at.dot(right), at.dot(up))
        };
        hull((0..8).map(corner).collect())
    };
    let octants = (0..8u32).filter(|n| children >> n & 1 == 1);
    let half = |n: u32| 0.5 * DVec3::new(f64::from(n & 1), f64::from(n >> 1 & 1), f64::from(n >> 2));
    let outlines: Vec<_> = octants.map(|n| outline(half(n), 0.5)).collect();
    [covered(&outlines), covered(&[outline(DVec3::ZERO, 1.0)])]
}

/// Convex hull, counter-clockwise (Andrew 1979).
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                if (b - a).perp_dot(p - a) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let lower = half(&mut points.iter().copied());
    [lower, half(&mut points.iter().rev().copied())].concat()
}

fn covered(outlines: &[Vec<DVec2>]) -> f64 {
    let edges: Vec<[DVec2; 2]> = outlines
        .iter()
        .flat_map(|outline| (0..outline.len()).map(|n| [outline[n], outline[(n + 1) % outline.len()]]))
        .collect();
    let mut heights: Vec<f64> = edges.iter().map(|edge| edge[0].y).collect();
    for (n, [a, b]) in edges.iter().enumerate() {
        for [c, d] in &edges[n + 1..] {
            let (along, across) = (*b - *a, *d - *c);
            let t = (*c - *a).perp_dot(across) / along.perp_dot(across);
            heights.extend((0.0..=1.0).contains(&t).then_some(a.y + t * along.y));
        }
    }
    heights.sort_by(f64::total_cmp);
    let slab = |pair: &[f64]| (pair[1] - pair[0]) * width(outlines, 0.5 * (pair[0] + pair[1]));
    heights.windows(2).filter(|pair| pair[1] > pair[0]).map(slab).sum()
}

/// The covered width at a height.
fn width(outlines: &[Vec<DVec2>], height: f64) -> f64 {
    let mut spans: Vec<[f64; 2]> = Vec::new();
    for outline in outlines {
        let crossings = (0..outline.len()).filter_map(|n| {
            let (a, b) = (outline[n], outline[(n + 1) % outline.len()]);
            ((a.y < height) != (b.y < height)).then(|| a.x + (b.x - a.x) * (height - a.y) / (b.y - a.y))
        });
        let (low, high) = crossings.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
        spans.extend((low < high).then_some([low, high]));
    }
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut sum, mut end) = (0.0, f64::MIN);
    for [low, high] in spans {
        sum += (high - low.max(end)).max(0.0);
        end = end.max(high);
    }
    sum
}

fn expected(direction: DVec3) -> Errors {
    std::array::from_fn(|children| {
        let [union, cell] = areas(children as u8, direction);
        1.0 - union / cell
    })
}

fn largest_difference(a: &Errors, b: &Errors) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn exact_errors_are_those_of_the_areas() {
    for direction in directions() {
        let off = largest_difference(&OctantShares::exact(direction).errors(), &expected(direction));
        assert!(off < 1e-9, "{direction}: off by {off:e}");
    }
}

#[test]
fn cast_errors_are_those_of_the_areas() {
    for (n, direction) in (0..).zip(directions().into_iter().step_by(9)) {
        let off =
            largest_difference(&OctantShares::by_rays(direction, 512, n).errors(), &expected(direction));
        assert!(off < 0.01, "{direction}: off by {off:e}");
    }
}

#[test]
fn one_child_hides_a_quarter_and_eight_all() {
    for direction in directions() {
        let errors = OctantShares::exact(direction).errors();
        for child in 0..8 {
            assert!(
                (errors[1 << child] - 0.75).abs() < 1e-12,
                "{direction}, child {child}: {}",
                errors[1 << child]
            );
        }
        assert!(errors[255].abs() < 1e-12 && (errors[0] - 1.0).abs() < 1e-12);
        let opposite = OctantShares::exact(-direction).errors();
        assert!(largest_difference(&errors, &opposite) < 1e-12, "{direction}");
    }
}

/// The 48 symmetries of the cube: which axis each axis becomes, and along which it is mirrored.
fn symmetries() -> impl Iterator<Item = ([usize; 3], usize)> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    ORDERS.into_iter().flat_map(|order| (0..8).map(move |signs| (order, signs)))
}

fn moved_children(children: usize, (order, signs): ([usize; 3], usize)) -> usize {
    let moved = |octant: usize| (0..3).fold(0, |to, axis| to | (octant >> axis & 1) << order[axis]) ^ signs;
    (0..8).filter(|octant| children >> octant & 1 == 1).fold(0, |set, octant| set | 1 << moved(octant))
}

fn moved_direction(direction: DVec3, (order, signs): ([usize; 3], usize)) -> DVec3 {
    let mut moved = DVec3::ZERO;
    for axis in 0..3 {
        moved[order[axis]] = direction[axis];
    }
    DVec3::from_array(std::array::from_fn(
        |axis| if signs >> axis & 1 == 1 { -moved[axis] } else { moved[axis] },
    ))
}

#[test]
fn sets_of_children_fall_into_22_classes() {
    let class = |children| symmetries().map(|s| moved_children(children, s)).min();
    let classes: std::collections::BTreeSet<_> = (0..256).map(class).collect();
    assert_eq!(classes.len(), 22);
    for direction in directions().into_iter().step_by(7) {
        let errors = OctantShares::exact(direction).errors();
        for symmetry in symmetries() {
            let moved = OctantShares::exact(moved_direction(direction, symmetry)).errors();
            for (children, error) in errors.iter().enumerate() {
                let off = (error - moved[moved_children(children, symmetry)]).abs();
                assert!(off < 1e-12, "{direction}, {symmetry:?}, {children:08b}: off by {off:e}");
            }
        }
    }
}

#[test]
fn nine_coefficients_are_off_by_as_much_as_a_threshold() {
    let known: Vec<_> =
        even_directions(4096).into_iter().map(|d| (d, OctantShares::exact(d).errors())).collect();
    let sh9 = Sh9::project(&known);
    for children in 0..=255 {
        let [_, first, second, third, ..] = *sh9.coefficients(children);
        assert!([first, second, third].map(f64::abs).into_iter().fold(0.0, f64::max) < 1e-3, "{children}");
    }
    let off = |(direction, errors): &(DVec3, Errors)| largest_difference(&sh9.errors(*direction), errors);
    let worst = known.iter().map(off).fold(0.0, f64::max);
    assert!((0.1..0.2).contains(&worst), "{worst}");
}

#[test]
fn a_table_of_directions_is_off_by_little() {
    let table = DirectionTable::exact();
    let off = |direction: &DVec3| {
        let place = Place::<f32>::of(direction.as_vec3());
        let looked_up =
            std::array::from_fn(|children| f64::from(place.error(table.entries(), children as u32)));
        largest_difference(&looked_up, &OctantShares::exact(*direction).errors())
    };
    let axes = (0..27).map(|n| DVec3::new(f64::from(n % 3), f64::from(n / 3 % 3), f64::from(n / 9)) - 1.0);
    let all = even_directions(4096).into_iter().chain(axes.filter(|d| *d != DVec3::ZERO));
    let worst = all.map(|d| off(&d)).fold(0.0, f64::max);
    assert!(worst < 1e-3, "{worst}");
}
