#![allow(clippy::all, missing_docs)]
use bevy_ecs::prelude::*;
use glam::*;
use luxel_scene::Name as _N;
use luxel_scene::*;
use std::io::Write;
use std::path::Path;
type V = DVec3;
struct Inst {
    kind: K,
    m: DAffine3,
    inv: DAffine3,
    mat: Option<Material>,
}
enum K {
    S(f64),
    M(usize),
    G(usize),
}
struct Bvh {
    n: Vec<(V, V, usize, usize, usize)>,
    t: Vec<[V; 3]>,
}
fn bx(ts: &[[V; 3]]) -> (V, V) {
    let mut a = V::splat(1e30);
    let mut b = -a;
    for t in ts {
        for p in t {
            a = a.min(*p);
            b = b.max(*p);
        }
    }
    (a, b)
}
fn build(
    t: &mut Vec<[V; 3]>,
    n: &mut Vec<(V, V, usize, usize, usize)>,
    f: usize,
    c: usize,
) -> usize {
    let id = n.len();
    let (a, b) = bx(&t[f..f + c]);
    n.push((a, b, f, c, 0));
    if c > 4 {
        let e = b - a;
        let ax = if e.x > e.y && e.x > e.z {
            0
        } else if e.y > e.z {
            1
        } else {
            2
        };
        t[f..f + c].sort_by(|p, q| {
            (p[0][ax] + p[1][ax] + p[2][ax]).total_cmp(&(q[0][ax] + q[1][ax] + q[2][ax]))
        });
        let h = c / 2;
        build(t, n, f, h);
        let r = build(t, n, f + h, c - h);
        n[id].3 = 0;
        n[id].4 = r;
    }
    id
}
fn slab(a: V, b: V, o: V, i: V) -> (f64, f64) {
    let t0 = (a - o) * i;
    let t1 = (b - o) * i;
    (t0.min(t1).max_element(), t0.max(t1).min_element())
}
struct Grid {
    size: UVec3,
    cells: Vec<u8>,
    pal: Vec<Material>,
}
struct Sc {
    inst: Vec<Inst>,
    bv: Vec<Bvh>,
    gr: Vec<Grid>,
    env: Environment,
    sph: Bvh2,
}
struct Bvh2 {}
struct Rng(u64);
impl Rng {
    fn f(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        let x = ((self.0 >> 18) ^ self.0) >> 27;
        let r = (x as u32).rotate_right((self.0 >> 59) as u32);
        r as f64 / 4294967296.0
    }
    fn unit(&mut self) -> V {
        let z = 1.0 - 2.0 * self.f();
        let p = 6.28318530718 * self.f();
        let r = (1.0 - z * z).max(0.0).sqrt();
        V::new(r * p.cos(), r * p.sin(), z)
    }
}
fn hit(s: &Sc, o: V, d: V) -> Option<(f64, V, Material)> {
    let mut best = 1e20;
    let mut res = None;
    for i in &s.inst {
        let lo = i.inv.transform_point3(o);
        let ld = i.inv.transform_vector3(d);
        match &i.kind {
            K::S(r) => {
                let a = ld.length_squared();
                let b = lo.dot(ld);
                let c = lo.length_squared() - r * r;
                let q = b * b - a * c;
                if q > 0.0 {
                    let q = q.sqrt();
                    for t in [(-b - q) / a, (-b + q) / a] {
                        if t > 1e-6 && t < best {
                            best = t;
                            let n = (lo + ld * t) / *r;
                            res = Some((n, i, i.mat.unwrap()));
                            break;
                        }
                    }
                }
            }
            K::M(m) => {
                let bv = &s.bv[*m];
                let iv = ld.recip();
                let mut st = vec![0usize];
                while let Some(k) = st.pop() {
                    let n = &bv.n[k];
                    let (a, b) = slab(n.0, n.1, lo, iv);
                    if a > b * 1.0000001 + 1e-12 || b < 0.0 || a > best {
                        continue;
                    }
                    if n.3 == 0 {
                        st.push(n.4);
                        st.push(k + 1);
                    } else {
                        for t in &bv.t[n.2..n.2 + n.3] {
                            let e1 = t[1] - t[0];
                            let e2 = t[2] - t[0];
                            let p = ld.cross(e2);
                            let det = e1.dot(p);
                            if det == 0.0 {
                                continue;
                            }
                            let tv = lo - t[0];
                            let u = tv.dot(p) / det;
                            if u < 0.0 || u > 1.0 {
                                continue;
                            }
                            let q = tv.cross(e1);
                            let v = ld.dot(q) / det;
                            if v < 0.0 || u + v > 1.0 {
                                continue;
                            }
                            let tt = e2.dot(q) / det;
                            if tt > 1e-6 && tt < best {
                                best = tt;
                                res = Some((e1.cross(e2), i, i.mat.unwrap()));
                            }
                        }
                    }
                }
            }
            K::G(g) => {
                let g = &s.gr[*g];
                let iv = ld.recip();
                let (a, b) = slab(V::ZERO, g.size.as_dvec3(), lo, iv);
                if a > b || b < 0.0 || a > best {
                    continue;
                }
                let mut t = a.max(0.0) + 1e-7;
                let mut p = (lo + ld * t)
                    .floor()
                    .as_ivec3()
                    .clamp(IVec3::ZERO, g.size.as_ivec3() - 1);
                let mut ax = if a > 0.0 {
                    let t0 = ((V::ZERO - lo) * iv).min((g.size.as_dvec3() - lo) * iv);
                    if t0.x == a {
                        0
                    } else if t0.y == a {
                        1
                    } else {
                        2
                    }
                } else {
                    0
                };
                let inside0 = a < 0.0;
                let mut first = true;
                loop {
                    let c = g.cells[(p.x as usize)
                        + g.size.x as usize * (p.z as usize + g.size.z as usize * p.y as usize)];
                    if c > 0 && !(first && inside0) {
                        if t > 1e-5 && t < best {
                            best = t;
                            let mut n = V::ZERO;
                            n[ax] = -ld[ax].signum();
                            res = Some((n, i, i.mat.unwrap_or(g.pal[c as usize - 1])));
                        }
                        break;
                    }
                    first = false;
                    let nx = V::new(
                        ((p.x + (ld.x > 0.0) as i32) as f64 - lo.x) * iv.x,
                        ((p.y + (ld.y > 0.0) as i32) as f64 - lo.y) * iv.y,
                        ((p.z + (ld.z > 0.0) as i32) as f64 - lo.z) * iv.z,
                    );
                    ax = if nx.x < nx.y && nx.x < nx.z {
                        0
                    } else if nx.y < nx.z {
                        1
                    } else {
                        2
                    };
                    t = nx[ax];
                    p[ax] += ld[ax].signum() as i32;
                    if p[ax] < 0 || p[ax] >= g.size[ax] as i32 || t > best {
                        break;
                    }
                }
            }
        }
    }
    res.map(|(n, i, m)| {
        (
            best,
            DMat3::from(i.inv.matrix3)
                .transpose()
                .mul_vec3(n)
                .normalize(),
            m,
        )
    })
}
fn sky(e: &Environment, d: V) -> V {
    match e {
        Environment::Constant(c) => c.as_dvec3(),
        Environment::Gradient {
            zenith,
            horizon,
            ground,
        } => {
            if d.y > 0.0 {
                horizon.as_dvec3().lerp(zenith.as_dvec3(), d.y)
            } else {
                horizon.as_dvec3().lerp(ground.as_dvec3(), -d.y)
            }
        }
    }
}
fn trace(s: &Sc, mut o: V, mut d: V, r: &mut Rng) -> V {
    let mut tp = V::ONE;
    let mut l = V::ZERO;
    for k in 0..14 {
        let Some((t, n, m)) = hit(s, o, d) else {
            return l + tp * sky(&s.env, d);
        };
        l += tp * m.emission.as_dvec3();
        let p = o + d * t;
        let front = n.dot(d) < 0.0;
        let nn = if front { n } else { -n };
        match m.surface {
            Surface::Lambert { albedo } => {
                tp *= albedo.as_dvec3();
                d = (nn + r.unit()).normalize();
                o = p + nn * 1e-6;
            }
            Surface::Metal { albedo, fuzz } => {
                tp *= albedo.as_dvec3();
                d = (d - 2.0 * d.dot(nn) * nn + r.unit() * fuzz as f64).normalize();
                if d.dot(nn) <= 0.0 {
                    return l;
                }
                o = p + nn * 1e-6;
            }
            Surface::Dielectric { ior } => {
                let eta = if front { 1.0 / ior as f64 } else { ior as f64 };
                let c = -d.dot(nn);
                let k = 1.0 - eta * eta * (1.0 - c * c);
                let r0 = ((1.0 - eta) / (1.0 + eta)).powi(2);
                if k < 0.0 || r.f() < r0 + (1.0 - r0) * (1.0 - c).powi(5) {
                    d = d + 2.0 * c * nn;
                    o = p + nn * 1e-6;
                } else {
                    d = (d * eta + nn * (eta * c - k.sqrt())).normalize();
                    o = p - nn * 1e-6;
                }
            }
        }
        if tp.max_element() <= 0.0 {
            return l;
        }
        if k > 3 {
            let q = tp.max_element().min(0.95);
            if r.f() > q {
                return l;
            }
            tp /= q;
        }
    }
    l
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut w = empty_world();
    let rep = load(Path::new(&a[1]), &mut w).unwrap();
    eprintln!("{rep:?}");
    let spp: u32 = a[3].parse().unwrap();
    let width: u32 = a[4].parse().unwrap();
    let set = *w.resource::<RenderSettings>();
    let height = width * set.height / set.width;
    let assets = w.resource::<Assets>().clone();
    let mut bv = vec![];
    let mut ids = std::collections::HashMap::new();
    for (id, m) in assets.meshes() {
        let mut t: Vec<[V; 3]> = m
            .mesh
            .triangles
            .iter()
            .map(|c| c.map(|i| m.mesh.positions[i as usize].as_dvec3()))
            .collect();
        let mut n = vec![];
        let c = t.len();
        build(&mut t, &mut n, 0, c);
        ids.insert(id, bv.len());
        bv.push(Bvh { n, t });
    }
    let mut gr = vec![];
    for (id, v) in assets.volumes() {
        let z = v.grid.size;
        let mut c = vec![0u8; (z.x * z.y * z.z) as usize];
        for x in &v.grid.voxels {
            let [a, b, d] = x.cell.map(|c| c as usize);
            c[a + z.x as usize * (d + z.z as usize * b)] = x.palette + 1;
        }
        eprintln!("{} voxels {:?}", v.grid.voxels.len(), z);
        ids.insert(id, gr.len());
        gr.push(Grid {
            size: z,
            cells: c,
            pal: v.grid.palette.clone(),
        });
    }
    let mut inst = vec![];
    for (t, sp, mi, vo, mat) in w
        .query::<(
            &Transform,
            Option<&Sphere>,
            Option<&MeshInstance>,
            Option<&VoxelVolume>,
            Option<&Material>,
        )>()
        .iter(&w)
    {
        let k = if let Some(s) = sp {
            K::S(s.radius)
        } else if let Some(m) = mi {
            K::M(ids[&m.mesh])
        } else if let Some(v) = vo {
            K::G(ids[&v.volume])
        } else {
            continue;
        };
        let m = t.affine();
        inst.push(Inst {
            kind: k,
            m,
            inv: m.inverse(),
            mat: mat.copied(),
        });
    }
    let (cam, ct) = w
        .query_filtered::<(&Camera, &Transform), With<ActiveCamera>>()
        .single(&w)
        .unwrap();
    let (cam, ct) = (*cam, ct.affine());
    let s = Sc {
        inst,
        bv,
        gr,
        env: *w.resource::<Environment>(),
        sph: Bvh2 {},
    };
    let mut img = vec![V::ZERO; (width * height) as usize];
    let th = (cam.vertical_fov / 2.0).tan();
    let half = img.len() / 2;
    let (x0, x1) = img.split_at_mut(half);
    std::thread::scope(|sc| {
        for (off, part) in [(0, x0), (half, x1)] {
            let s = &s;
            sc.spawn(move || {
                for (i, px) in part.iter_mut().enumerate() {
                    let i = i + off;
                    let (x, y) = ((i as u32 % width) as f64, (i as u32 / width) as f64);
                    let mut r = Rng(i as u64 * 7919 + 1);
                    let mut sum = V::ZERO;
                    for _ in 0..spp {
                        let u = ((x + r.f()) / width as f64 * 2.0 - 1.0) * th * width as f64
                            / height as f64;
                        let v = (1.0 - (y + r.f()) / height as f64 * 2.0) * th;
                        let f = V::new(u, v, -1.0) * cam.focus_distance;
                        let q = r.f().sqrt() * cam.lens_radius;
                        let p = r.f() * 6.2831853;
                        let o = V::new(q * p.cos(), q * p.sin(), 0.0);
                        let dd = ct.transform_vector3(f - o).normalize();
                        sum += trace(s, ct.transform_point3(o), dd, &mut r).min(V::splat(30.0));
                    }
                    *px = sum / spp as f64;
                }
            });
        }
    });
    let mut f = std::fs::File::create(&a[2]).unwrap();
    write!(f, "P6\n{width} {height}\n255\n").unwrap();
    let e = 2f64.powf(set.exposure as f64);
    let b: Vec<u8> = img
        .iter()
        .flat_map(|c| {
            c.to_array().map(|x| {
                let x = x * e * 0.6;
                let y = ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0);
                (y.powf(1.0 / 2.2) * 255.0 + 0.5) as u8
            })
        })
        .collect();
    f.write_all(&b).unwrap();
    let _ = s.inst[0].m;
}
