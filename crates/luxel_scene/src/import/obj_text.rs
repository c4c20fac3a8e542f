//! From the text of an .obj file to a text that `tobj` cannot fail on.
//!
//! `tobj` gives up on the whole file at the first bad index, and its index arithmetic can overflow.
//! So the lines are read here first: corners become absolute position indices, polygons become fans
//! of triangles, triangles that cannot be drawn are left out and counted, and what this program
//! does not use (texture coordinates, normals, lines, points) goes. All positions come before all
//! triangles, so that an index may point forwards. `tobj` then does the grouping by object and
//! material and the renumbering.

use std::fmt::Write;
use std::path::Path;

use glam::{DVec3, Vec3};

use crate::assets::Dropped;
use crate::error::SceneError;

/// The farthest coordinate of a corner, 2⁶⁰: beyond it, squares of lengths leave single precision, and
/// what bake places is left out as a whole.
const FARTHEST: f64 = (1u64 << 60) as f64;

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
}

/// Reads `text`, the content of `path`.
///
/// # Errors
/// A line that cannot be understood, with its number.
pub(super) fn clean(path: &Path, text: &str) -> Result<CleanObj, SceneError> {
    let positions = read_positions(path, text)?;
    let mut clean = CleanObj::default();
    for p in &positions {
        // Shortest text that reads back to the same number; NaN and infinities too.
        let _ = writeln!(clean.text, "v {} {} {}", p.x, p.y, p.z);
    }
    let mut defined = 0;
    for (number, line) in logical_lines(text) {
        let (keyword, rest) = split_keyword(&line);
        match keyword {
            "v" => defined += 1,
            "f" => clean.face(&positions, defined, rest).map_err(|message| {
                SceneError::model(path, number, format!("{message} in \"{}\"", line.trim()))
            })?,
            "o" | "g" => clean.name(keyword, if rest.is_empty() { "unnamed" } else { rest }),
            "usemtl" if !rest.is_empty() => {
                clean.uses_materials = true;
                clean.name("usemtl", rest);
            }
            "mtllib" if !rest.is_empty() => clean.libraries.push(rest.to_owned()),
            _ => {}
        }
    }
    Ok(clean)
}

impl CleanObj {
    fn name(&mut self, keyword: &str, name: &str) {
        let _ = writeln!(self.text, "{keyword} {name}");
    }

    /// A polygon as a fan of triangles, the good ones kept.
    fn face(&mut self, positions: &[Vec3], defined: usize, rest: &str) -> Result<(), String> {
        let corners =
            rest.split_whitespace().map(|word| corner(word, defined)).collect::<Result<Vec<_>, _>>()?;
        if corners.len() < 3 {
            self.triangles += 1;
            self.dropped.bad_index += 1;
            return Ok(());
        }
        for pair in corners[1..].windows(2) {
            self.triangle(positions, [corners[0], pair[0], pair[1]]);
        }
        Ok(())
    }

    fn triangle(&mut self, positions: &[Vec3], corners: [Option<usize>; 3]) {
        let id = self.triangles;
        self.triangles += 1;
        let found = corners.map(|corner| positions.get(corner?).map(|p| p.as_dvec3()));
        let [Some(a), Some(b), Some(c)] = found else {
            self.dropped.bad_index += 1;
            return;
        };
        if ![a, b, c].into_iter().all(is_in_range) {
            self.dropped.out_of_range += 1;
        } else if (b - a).cross(c - a) == DVec3::ZERO {
            self.dropped.zero_area += 1;
        } else {
            self.triangle_ids.push(id);
            let [a, b, c] = corners.map(|corner| corner.unwrap_or_default() + 1);
            let _ = writeln!(self.text, "f {a} {b} {c}");
        }
    }
}

fn is_in_range(position: DVec3) -> bool {
    position.is_finite() && position.abs().max_element() <= FARTHEST
}

/// All `v` lines: the first three numbers of each (a weight or a colour may follow).
fn read_positions(path: &Path, text: &str) -> Result<Vec<Vec3>, SceneError> {
    let mut positions = Vec::new();
    for (number, line) in logical_lines(text) {
        let (keyword, rest) = split_keyword(&line);
        if keyword == "v" {
            let mut words = rest.split_whitespace().map(str::parse::<f32>);
            let (Some(Ok(x)), Some(Ok(y)), Some(Ok(z))) = (words.next(), words.next(), words.next()) else {
                let message = format!("three numbers expected in \"{}\"", line.trim());
                return Err(SceneError::model(path, number, message));
            };
            positions.push(Vec3::new(x, y, z));
        }
    }
    Ok(positions)
}

/// Position index of a corner such as `7`, `7/1`, `7//3` or `-1`, from 0; `None` if there can be no
/// such position. `defined` is how many positions came before the line.
fn corner(word: &str, defined: usize) -> Result<Option<usize>, String> {
    let index = word.split('/').next().unwrap_or_default();
    let index: i64 = match index.parse() {
        Ok(index) => index,
        Err(_) if is_integer(index) => return Ok(None),
        Err(_) => return Err(format!("\"{word}\" is not a corner")),
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
