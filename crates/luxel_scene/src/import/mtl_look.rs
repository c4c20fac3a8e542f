//! What a material of an .mtl file looks like: the nearest of our materials, and its textures.

use glam::{Vec2, Vec3};

use crate::material::{Material, Opacity, Principled, Surface};
use crate::textures::{TextureRef, Wrap};

/// A material and the textures that it names.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct MtlLook {
    pub(crate) material: Material,
    pub(crate) maps: Vec<(Role, Map)>,
}

/// What a texture is for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Role {
    Color,
    /// Opacity from a picture that is not the colour's.
    Mask,
    Emission,
    SpecularColor,
    /// Roughness and, in the same picture, metal.
    MetallicRoughness,
    Normal,
    /// A normal map if it is coloured, heights if it is grey.
    Bump,
}

/// A texture as a line names it.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Map {
    /// As it is in the file.
    pub(crate) file: String,
    offset: Vec2,
    scale: Vec2,
    clamp: bool,
    /// `-bm`
    strength: f32,
}

/// Options of a texture line and how many words follow each (`-o`, `-s` and `-t` take one to three numbers).
const OPTIONS: [(&str, usize); 11] = [
    ("-blendu", 1),
    ("-blendv", 1),
    ("-boost", 1),
    ("-mm", 2),
    ("-texres", 1),
    ("-clamp", 1),
    ("-bm", 1),
    ("-imfchan", 1),
    ("-type", 1),
    ("-cc", 1),
    ("-colorspace", 1),
];

impl Map {
    /// A line after its keyword: options, then the name of a file, which may hold spaces.
    pub(super) fn parse(line: &str) -> Option<Self> {
        let mut map =
            Self { file: String::new(), offset: Vec2::ZERO, scale: Vec2::ONE, clamp: false, strength: 1.0 };
        let mut rest = line.trim();
        while rest.starts_with('-') {
            let (option, more) = word(rest);
            rest = match option {
                "-o" => vector(more, &mut map.offset),
                "-s" => vector(more, &mut map.scale),
                "-t" => {
                    let mut turbulence = Vec2::ZERO;
                    vector(more, &mut turbulence)
                }
                _ => {
                    let Some((_, count)) = OPTIONS.iter().find(|(name, _)| *name == option) else { break };
                    match (option, word(more).0) {
                        ("-clamp", value) => map.clamp = value == "on",
                        ("-bm", value) => map.strength = finite(value).unwrap_or(1.0),
                        _ => {}
                    }
                    (0..*count).fold(more, |rest, _| word(rest).1)
                }
            };
        }
        map.file = rest.trim_matches('"').to_owned();
        (!map.file.is_empty()).then_some(map)
    }

    /// Whether both lie on the surface alike.
    pub(super) fn lies_like(&self, other: &Self) -> bool {
        (self.offset, self.scale, self.clamp) == (other.offset, other.scale, other.clamp)
    }

    /// The texture on an image. In these files v runs upwards, here downwards.
    pub(super) fn texture(&self, image: crate::AssetId) -> TextureRef {
        let wrap = if self.clamp { Wrap::Clamp } else { Wrap::Repeat };
        // 1 − (s (1 − v) + o) = s v + (1 − s − o)
        let offset = Vec2::new(self.offset.x, 1.0 - self.scale.y - self.offset.y);
        TextureRef {
            offset,
            scale: self.scale,
            wrap_u: wrap,
            wrap_v: wrap,
            normal_scale: self.strength,
            ..TextureRef::new(image)
        }
    }
}

fn word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    text.split_once(char::is_whitespace).map_or((text, ""), |(word, rest)| (word, rest.trim_start()))
}

/// One to three numbers, the first two into `value`; gives what follows.
fn vector<'a>(text: &'a str, value: &mut Vec2) -> &'a str {
    let mut rest = text;
    for axis in 0..3 {
        let (number, more) = word(rest);
        let Some(number) = finite(number).filter(|_| !more.is_empty()) else { break };
        if axis < 2 {
            value[axis] = number;
        }
        rest = more;
    }
    rest
}

fn finite(text: &str) -> Option<f32> {
    text.parse().ok().filter(|value: &f32| value.is_finite())
}

/// The nearest of our looks.
///
/// `illum` 4, 6, 7 and 9 are glass (as is anything more transparent than not), 3, 5 and 8 mirrors; what says `Pr` or
/// `Pm` is metallic-roughness; what shines by `Ks` and `Ns` is a plastic with a lobe as wide as Phong's; all else is
/// matt.
pub(super) fn look(from: &tobj::Material) -> MtlLook {
    let maps = maps(from);
    let has = |role| maps.iter().any(|(found, _)| *found == role);
    // Where a picture says opacity, a number beside it, often 0, is no factor.
    let has_cutout = has(Role::Mask);
    let transparency = from.dissolve.filter(|_| !has_cutout);
    let surface = match from.illumination_model {
        Some(4 | 6 | 7 | 9) => glass(from),
        _ if transparency.is_some_and(|opacity| opacity < 0.5) => glass(from),
        _ if number(from, "Pr").or(number(from, "Pm")).is_some() || has(Role::MetallicRoughness) => {
            physical(from, has(Role::Color))
        }
        Some(3 | 5 | 8) => mirror(from),
        Some(0 | 1) => matt(from, has(Role::Color)),
        _ if shine(from) > 0.0 && from.shininess.is_some_and(|n| n > 0.0) => plastic(from, has(Role::Color)),
        _ => matt(from, has(Role::Color)),
    };
    let is_glass = matches!(surface, Surface::Dielectric { .. });
    let opacity = match transparency {
        _ if has_cutout => Opacity::Mask { alpha: 1.0, cutoff: 0.5 },
        Some(alpha) if alpha < 1.0 && !is_glass => Opacity::Blend { alpha: alpha.clamp(0.0, 1.0) },
        _ => Opacity::Opaque,
    };
    let glow = from.emissive.map(Vec3::from_array).unwrap_or_default().max(Vec3::ZERO);
    let emission = if glow == Vec3::ZERO && has(Role::Emission) { Vec3::ONE } else { glow };
    MtlLook { material: Material { surface, emission, opacity }, maps }
}

fn number(from: &tobj::Material, key: &str) -> Option<f32> {
    finite(from.unknown_param.get(key)?.split_whitespace().next()?)
}

fn share(from: &tobj::Material, key: &str) -> Option<f32> {
    number(from, key).map(|value| value.clamp(0.0, 1.0))
}

fn color(rgb: Option<[f32; 3]>, or: f32) -> Vec3 {
    rgb.map_or(Vec3::splat(or), Vec3::from_array).clamp(Vec3::ZERO, Vec3::ONE)
}

/// `Kd`; where a texture takes its place and it is black, as some programs write it, white.
fn albedo(from: &tobj::Material, is_textured: bool) -> Vec3 {
    let albedo = color(from.diffuse, if is_textured { 1.0 } else { 0.73 });
    if is_textured && albedo == Vec3::ZERO { Vec3::ONE } else { albedo }
}

fn shine(from: &tobj::Material) -> f32 {
    color(from.specular, 0.0).max_element()
}

fn matt(from: &tobj::Material, is_textured: bool) -> Surface {
    Surface::Lambert { albedo: albedo(from, is_textured) }
}

fn glass(from: &tobj::Material) -> Surface {
    let ior = from.optical_density.filter(|&ior| ior > 1.0).unwrap_or(1.5);
    Surface::Dielectric { ior, schlick: false }
}

/// A metal whose roughness undoes Blender's export, Ns = 1000 (1 − roughness)².
fn mirror(from: &tobj::Material) -> Surface {
    let roughness = 1.0 - (from.shininess.unwrap_or(1000.0) / 1000.0).clamp(0.0, 1.0).sqrt();
    Surface::Principled(Principled {
        base_color: color(from.specular, 0.9),
        metallic: 1.0,
        roughness,
        ..Principled::default()
    })
}

/// Phong's exponent n is a lobe as wide as a microfacet's of α² = 2 / (n + 2) (Walter et al. 2007, section 5.2), and
/// α = roughness².
fn lobe(from: &tobj::Material) -> f32 {
    let exponent = from.shininess.unwrap_or(0.0).max(0.0);
    (2.0 / (exponent + 2.0)).powf(0.25)
}

fn plastic(from: &tobj::Material, is_textured: bool) -> Surface {
    Surface::Principled(Principled {
        base_color: albedo(from, is_textured),
        roughness: lobe(from),
        ior: reflecting_ior(from),
        // Half is what programs write for a usual plastic.
        specular: (2.0 * shine(from)).min(1.0),
        ..Principled::default()
    })
}

fn physical(from: &tobj::Material, is_textured: bool) -> Surface {
    Surface::Principled(Principled {
        base_color: albedo(from, is_textured),
        metallic: share(from, "Pm").unwrap_or(0.0),
        roughness: share(from, "Pr").unwrap_or(1.0),
        ior: reflecting_ior(from),
        clearcoat: share(from, "Pc").unwrap_or(0.0),
        clearcoat_roughness: share(from, "Pcr").unwrap_or(0.0),
        ..Principled::default()
    })
}

/// `Ni`; 1, which programs write without a thought, would not reflect at all.
fn reflecting_ior(from: &tobj::Material) -> f32 {
    from.optical_density.filter(|&ior| ior > 1.0).map_or(1.5, |ior| ior.min(10.0))
}

/// The textures that are understood; see [`KEYWORDS`].
fn maps(from: &tobj::Material) -> Vec<(Role, Map)> {
    let named = |keyword: &str| map(from, keyword);
    let roles = [
        (Role::Color, ["map_Kd"].as_slice()),
        (Role::Mask, &["map_d"]),
        (Role::Emission, &["map_Ke"]),
        (Role::SpecularColor, &["map_Ks"]),
        (Role::MetallicRoughness, &["map_Pr", "map_RMA", "map_ORM"]),
        (Role::Normal, &["norm", "map_Kn"]),
        (Role::Bump, &["map_Bump", "map_bump", "bump"]),
    ];
    let found = roles
        .iter()
        .filter_map(|(role, keywords)| Some((*role, keywords.iter().find_map(|keyword| named(keyword))?)));
    found.collect()
}

fn map(from: &tobj::Material, keyword: &str) -> Option<Map> {
    Map::parse(from.unknown_param.get(&renamed(keyword))?)
}

/// The lines that name textures.
pub(super) const KEYWORDS: [&str; 12] = [
    "map_Kd", "map_d", "map_Ke", "map_Ks", "map_Pr", "map_RMA", "map_ORM", "norm", "map_Kn", "map_Bump",
    "map_bump", "bump",
];

/// A keyword as one that `tobj`, which does not know the options of such a line, hands on as it is.
pub(super) fn renamed(keyword: &str) -> String {
    format!("texture_{keyword}")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn texture_lines_have_options_before_a_name_with_spaces() {
        let map = Map::parse("-s 2 3 1 -o 0.5 0.25 -bm 0.7 -clamp on -imfchan l my picture.png").unwrap();
        assert_eq!(map.file, "my picture.png");
        assert_eq!((map.scale, map.offset), (Vec2::new(2.0, 3.0), Vec2::new(0.5, 0.25)));
        assert!(map.clamp && map.strength == 0.7);
        assert_eq!(Map::parse("-s 2 7.png").unwrap().file, "7.png");
        assert_eq!(Map::parse("-odd.png").unwrap().file, "-odd.png");
        assert_eq!(Map::parse(" -bm 1 "), None);
        assert_eq!(Map::parse(""), None);
    }

    #[test]
    fn offsets_of_textures_run_upwards() {
        let texture = Map::parse("-s 1 2 -o 0 0.25 a.png").unwrap().texture(crate::AssetId(1));
        // The lower edge (v = 0 there, 1 here) shows v = 0.25 there, which is 0.75 here.
        let shown = |v: f32| texture.scale.y * v + texture.offset.y;
        assert_eq!((shown(1.0), shown(0.5)), (0.75, -0.25));
    }
}
