//! From the text of an .obj file to a text that `tobj` cannot fail on.
//!
//! `tobj` gives up on the whole file at the first bad index, and its index arithmetic can overflow.
//! So the lines are read here first: corners become absolute indices, polygons become fans of
//! triangles, triangles that cannot be drawn are left out and counted, and what this program does
//! not use (lines, points, curves) goes. All positions, texture coordinates and normals come before all
//! triangles, so that an index may point forwards; the first coordinate and the first normal stand for a corner
//! that has none. `tobj` then does the grouping by object and material and the renumbering.

use std::fmt::Write;
use std::path::Path;

use glam::{Vec2, Vec3};

use crate::assets::Dropped;
use crate::error::SceneError;

use super::assemble::flaw;
use super::srgb::linear;
use super::tally::Tally;

/// A clean .obj text and what was left out of it.
#[derive(Debug, Default)]
pub(super) struct CleanObj {
    /// For `tobj`.
    pub(super) text: String,
    /// Which triangle of the file each remaining one is; rising.
    pub(super) triangle_ids: Vec<u32>,
    /// Triangles in the file.
    pub(super) triangles: u32,
    /// Triangles left out.
    pub(super) dropped: Dropped,
    /// Whether a `usemtl` names a material.
    pub(super) uses_materials: bool,
    /// The files that `mtllib` lines name.
    pub(super) libraries: Vec<String>,
    /// Lines that this program does not use.
    pub(super) ignored: Tally,
}

/// What the corners of a file may name.
#[derive(Debug, Default)]
struct Pools {
    positions: Vec<Vec3>,
    /// Linear; as many as positions, or none if no position has one.
    colors: Vec<Vec3>,
    /// v downwards; NaN where the line is no coordinate.
    uvs: Vec<Vec2>,
    /// Zero where the line is no normal.
    normals: Vec<Vec3>,
}

/// Reads `text`, the content of `path`.
///
/// # Errors
/// A line that cannot be understood, with its number.
pub(super) fn clean(path: &Path, text: &str) -> Result<CleanObj, SceneError> {
    let pools = Pools::read(path, text)?;
    let mut clean = CleanObj::default();
    pools.write(&mut clean.text);
    let mut defined = [0; 3];
    for (number, line) in logical_lines(text) {
        let (keyword, rest) = split_keyword(&line);
        match keyword {
            "v" => defined[0] += 1,
            "vt" => defined[1] += 1,
            "vn" => defined[2] += 1,
            "f" => clean.face(&pools, defined, rest).map_err(|message| {
                SceneError::model(path, number, format!("{message} in \"{}\"", line.trim()))
            })?,
            "o" | "g" => clean.name(keyword, if rest.is_empty() { "unnamed" } else { rest }),
            "usemtl" if !rest.is_empty() => {
                clean.uses_materials = true;
                clean.name("usemtl", rest);
            }
            "mtllib" if !rest.is_empty() => clean.libraries.push(rest.to_owned()),
            _ => {
                if let Some(what) = unused(keyword, rest) {
                    clean.ignored.add(&what);
                }
            }
        }
    }
    Ok(clean)
}

/// What a line says that this program does not use; `None` if that is nothing.
fn unused(keyword: &str, rest: &str) -> Option<String> {
    Some(match keyword {
        "" | "usemtl" | "mtllib" => return None,
        "s" if matches!(rest, "" | "off" | "0") => return None,
        comment if comment.starts_with('#') => return None,
        "l" => "lines".to_owned(),
        "p" => "points".to_owned(),
        "s" => "smoothing groups".to_owned(),
        "curv" | "curv2" => "curves".to_owned(),
        "surf" => "free-form surfaces".to_owned(),
        other => format!("\"{}\" lines", other.chars().take(40).collect::<String>()),
    })
}

impl CleanObj {
    fn name(&mut self, keyword: &str, name: &str) {
        let _ = writeln!(self.text, "{keyword} {name}");
    }

    /// A polygon as a fan of triangles, the good ones kept.
    fn face(&mut self, pools: &Pools, defined: [usize; 3], rest: &str) -> Result<(), String> {
        let corners =
            rest.split_whitespace().map(|word| corner(word, defined)).collect::<Result<Vec<_>, _>>()?;
        if corners.len() < 3 {
            self.triangles += 1;
            self.dropped.bad_index += 1;
            return Ok(());
        }
        for pair in corners[1..].windows(2) {
            self.triangle(pools, [corners[0], pair[0], pair[1]]);
        }
        Ok(())
    }

    fn triangle(&mut self, pools: &Pools, corners: [Corner; 3]) {
        let id = self.triangles;
        self.triangles += 1;
        if let Some(flaw) = flaw(corners.map(|[position, ..]| pools.positions.get(position?).copied())) {
            flaw.count(&mut self.dropped);
            return;
        }
        self.triangle_ids.push(id);
        self.text.push('f');
        for corner in corners {
            pools.write_corner(&mut self.text, corner);
        }
        self.text.push('\n');
    }
}

impl Pools {
    /// All `v`, `vt` and `vn` lines. A position must be one; a weight or a colour may follow it.
    fn read(path: &Path, text: &str) -> Result<Self, SceneError> {
        let mut pools = Self::default();
        for (number, line) in logical_lines(text) {
            let (keyword, rest) = split_keyword(&line);
            match keyword {
                "v" => pools.position(rest).ok_or_else(|| {
                    let message = format!("three numbers expected in \"{}\"", line.trim());
                    SceneError::model(path, number, message)
                })?,
                "vt" => {
                    let [u, v] = numbers(rest, f32::NAN);
                    // A line of one number lies on the edge where v is 0.
                    let v = if v.is_nan() && !u.is_nan() { 0.0 } else { v };
                    pools.uvs.push(Vec2::new(u, 1.0 - v));
                }
                "vn" => pools.normals.push(Vec3::from_array(numbers(rest, 0.0))),
                _ => {}
            }
        }
        Ok(pools)
    }

    fn position(&mut self, rest: &str) -> Option<()> {
        let numbers: Vec<_> = rest.split_whitespace().take(8).map(str::parse::<f32>).collect();
        let [Ok(x), Ok(y), Ok(z), more @ ..] = numbers.as_slice() else { return None };
        if let [Ok(r), Ok(g), Ok(b), ..] = more {
            // Those before had none: white.
            self.colors.resize(self.positions.len(), Vec3::ONE);
            let share = |s: f32| linear(if s.is_nan() { 1.0 } else { s.clamp(0.0, 1.0) });
            self.colors.push(Vec3::new(share(*r), share(*g), share(*b)));
        } else if !self.colors.is_empty() {
            self.colors.push(Vec3::ONE);
        }
        self.positions.push(Vec3::new(*x, *y, *z));
        Some(())
    }

    /// Numbers are written as the shortest text that reads back to the same; NaN and infinities too.
    fn write(&self, text: &mut String) {
        for (index, p) in self.positions.iter().enumerate() {
            let _ = write!(text, "v {} {} {}", p.x, p.y, p.z);
            if let Some(color) = self.colors.get(index) {
                let _ = write!(text, " {} {} {}", color.x, color.y, color.z);
            }
            text.push('\n');
        }
        let none = (!self.uvs.is_empty()).then_some(Vec2::NAN);
        for uv in none.iter().chain(&self.uvs) {
            let _ = writeln!(text, "vt {} {}", uv.x, uv.y);
        }
        let none = (!self.normals.is_empty()).then_some(Vec3::ZERO);
        for n in none.iter().chain(&self.normals) {
            let _ = writeln!(text, "vn {} {} {}", n.x, n.y, n.z);
        }
    }

    /// A corner whose position is there; what else it names may not be.
    fn write_corner(&self, text: &mut String, [position, uv, normal]: Corner) {
        let _ = write!(text, " {}", position.unwrap_or_default() + 1);
        // The first one stands for none, so index 0 of the file is the second.
        let place =
            |index: Option<usize>, count: usize| index.filter(|&it| it < count).map_or(1, |it| it + 2);
        match (self.uvs.len(), self.normals.len()) {
            (0, 0) => {}
            (uvs, 0) => {
                let _ = write!(text, "/{}", place(uv, uvs));
            }
            (0, normals) => {
                let _ = write!(text, "//{}", place(normal, normals));
            }
            (uvs, normals) => {
                let _ = write!(text, "/{}/{}", place(uv, uvs), place(normal, normals));
            }
        }
    }
}

/// The first numbers of a line; `none` where there is none.
fn numbers<const N: usize>(rest: &str, none: f32) -> [f32; N] {
    let mut found = [none; N];
    for (number, word) in found.iter_mut().zip(rest.split_whitespace()) {
        *number = word.parse().unwrap_or(none);
    }
    found
}

/// Indices of position, texture coordinate and normal, from 0; `None` where there can be no such thing.
type Corner = [Option<usize>; 3];

/// A corner such as `7`, `7/1`, `7//3` or `-1`. `defined` is how many of each came before the line.
fn corner(word: &str, defined: [usize; 3]) -> Result<Corner, String> {
    let mut corner = [None; 3];
    for (place, index) in word.split('/').take(3).enumerate() {
        if index.is_empty() && place > 0 {
            continue;
        }
        corner[place] =
            absolute(index, defined[place]).map_err(|()| format!("\"{word}\" is not a corner"))?;
    }
    Ok(corner)
}

/// An index from 0; `Err` if `index` is no whole number.
fn absolute(index: &str, defined: usize) -> Result<Option<usize>, ()> {
    let index: i64 = match index.parse() {
        Ok(index) => index,
        Err(_) if is_integer(index) => return Ok(None),
        Err(_) => return Err(()),
    };
    let absolute = if index < 0 {
        i64::try_from(defined).ok().and_then(|n| n.checked_add(index))
    } else {
        index.checked_sub(1)
    };
    Ok(absolute.and_then(|index| usize::try_from(index).ok()))
}

/// Whether this is a whole number, perhaps one too large for any integer type.
fn is_integer(word: &str) -> bool {
    let digits = word.strip_prefix(['-', '+']).unwrap_or(word);
    !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
}

/// Lines with their numbers from 1; a backslash at the end joins a line with the next.
fn logical_lines(text: &str) -> impl Iterator<Item = (usize, std::borrow::Cow<'_, str>)> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (index, line) = lines.next()?;
        let Some(mut head) = line.strip_suffix('\\') else {
            return Some((index + 1, line.into()));
        };
        let mut joined = String::new();
        loop {
            joined.push_str(head);
            joined.push(' ');
            let next = lines.next().map_or("", |(_, line)| line);
            match next.strip_suffix('\\') {
                Some(more) => head = more,
                None => {
                    joined.push_str(next);
                    return Some((index + 1, joined.into()));
                }
            }
        }
    })
}

/// The first word of a line, and the rest without surrounding space.
fn split_keyword(line: &str) -> (&str, &str) {
    let line = line.trim();
    line.split_once(char::is_whitespace).map_or((line, ""), |(keyword, rest)| (keyword, rest.trim()))
}
