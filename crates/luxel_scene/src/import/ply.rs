//! Stanford .ply: triangles with what their corners carry, through `ply-rs-bw`.
//!
//! The library is asked for one element at a time, so that a count in a header allocates nothing: what is not in
//! the file ends the reading.

use std::io::BufRead;
use std::path::Path;

use glam::{Vec2, Vec3, Vec4};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess};

use crate::assets::{Dropped, MeshAsset, MeshSource, TriangleMesh};
use crate::error::SceneError;
use crate::report::LoadReport;

use super::assemble::{Assembled, assemble};
use super::guard::guarded;
use super::ply_elements::{Face, Skipped, Vertex, is_known};
use super::{counted, file_name, one_line, read_model};

/// The most triangles of a file.
const MAX_TRIANGLES: usize = 200_000_000;

/// A whole .ply file.
#[derive(Debug)]
pub(crate) struct PlyFile {
    /// At least one triangle.
    pub(crate) mesh: TriangleMesh,
    dropped: Dropped,
    total: u32,
    ignored: Vec<String>,
    mended_normals: u32,
}

impl PlyFile {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// A file that cannot be read, is damaged, or has no triangle that is any good.
    pub(crate) fn read(path: &Path) -> Result<Self, SceneError> {
        let bytes = read_model(path)?;
        guarded(path, || Self::parse(path, &bytes))
    }

    fn parse(path: &Path, bytes: &[u8]) -> Result<Self, SceneError> {
        let content = Content::read(path, bytes)?;
        let Content { vertices, triangles, header, .. } = content;
        let position = |index: u32| vertices.positions.get(index as usize).copied();
        let total = triangles.len();
        let mut assembled = assemble(vertices.positions.len(), position, triangles.into_iter());
        if assembled.mesh.triangles.is_empty() {
            let message = match total {
                0 => "has no triangle".to_owned(),
                n => format!("none of its {n} triangles can be used ({})", assembled.dropped),
            };
            return Err(SceneError::unusable(path, message));
        }
        let mended_normals = vertices.dress(&mut assembled);
        let Assembled { mesh, dropped, total, .. } = assembled;
        Ok(Self { mesh, dropped, total, ignored: ignored(&header), mended_normals })
    }

    /// The file as an asset.
    pub(crate) fn into_asset(self, path: &Path) -> MeshAsset {
        MeshAsset { source: MeshSource::File(path.to_owned()), mesh: self.mesh, dropped: self.dropped }
    }

    /// What the user should be told.
    pub(crate) fn report(&self, path: &Path) -> LoadReport {
        let (name, count) = (file_name(path), self.dropped.total());
        let mesh = &self.mesh;
        let carried = [
            ("normals", !mesh.normals.is_empty()),
            ("texture coordinates", !mesh.uvs[0].is_empty()),
            ("colours", !mesh.colors.is_empty()),
        ];
        let carried = carried.iter().filter(|(_, is_there)| *is_there).map(|(what, _)| (*what).to_owned());
        let dropped = format!("{name}: dropped {count} of {} triangles ({})", self.total, self.dropped);
        let normals = self.mended_normals;
        let warning = format!("{name}: {normals} normals are none and were made from the faces around");
        LoadReport {
            scenes: Vec::new(),
            used: [counted(mesh.triangles.len(), "triangle")].into_iter().chain(carried).collect(),
            ignored: self.ignored.clone(),
            dropped: (count > 0).then_some(dropped).into_iter().collect(),
            warnings: (normals > 0).then_some(warning).into_iter().collect(),
        }
    }
}

/// Elements and properties that are not understood.
fn ignored(header: &Header) -> Vec<String> {
    let mut ignored = Vec::new();
    for (name, element) in &header.elements {
        let name = one_line(name);
        if !matches!(name.as_str(), "vertex" | "face") {
            ignored.push(format!("{name} elements ({})", element.count));
            continue;
        }
        let unknown =
            element.properties.iter().map(|(property, _)| property).filter(|it| !is_known(&name, it));
        ignored.extend(unknown.map(|property| format!("{} of each {name}", one_line(property))));
    }
    ignored
}

/// What corners carry; an attribute that the header does not announce is empty.
#[derive(Debug, Default)]
struct Vertices {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    colors: Vec<Vec4>,
}

impl Vertices {
    fn push(&mut self, vertex: Vertex, has: Has) {
        self.positions.push(Vec3::from_array(vertex.position));
        if has.normals {
            self.normals.push(Vec3::from_array(vertex.normal));
        }
        if has.uvs {
            // Upwards in these files, downwards here.
            self.uvs.push(Vec2::new(vertex.uv[0], 1.0 - vertex.uv[1]));
        }
        if has.colors {
            self.colors.push(Vec4::from_array(vertex.color));
        }
    }

    /// Gives `assembled` what there is; returns how many normals were none.
    fn dress(&self, assembled: &mut Assembled) -> u32 {
        if !self.uvs.is_empty() {
            assembled.set_uvs(0, |index| self.uvs.get(index as usize).copied().unwrap_or_default());
        }
        if !self.colors.is_empty() {
            assembled.set_colors(|index| self.colors.get(index as usize).copied().unwrap_or(Vec4::ONE));
        }
        if self.normals.is_empty() {
            return 0;
        }
        assembled.set_normals(|index| self.normals.get(index as usize).copied().unwrap_or_default())
    }
}

/// Which attributes a header announces.
#[derive(Clone, Copy, Debug, Default)]
struct Has {
    normals: bool,
    uvs: bool,
    colors: bool,
}

impl Has {
    fn of(element: &ElementDef) -> Self {
        let has = |names: &[&str]| names.iter().all(|&name| element.properties.contains_key(name));
        let pairs = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];
        Self {
            normals: has(&["nx", "ny", "nz"]),
            uvs: pairs.iter().any(|pair| has(pair)),
            colors: has(&["red", "green", "blue"])
                || has(&["diffuse_red", "diffuse_green", "diffuse_blue"])
                || has(&["r", "g", "b"]),
        }
    }
}

/// A file, read but not judged.
struct Content {
    header: Header,
    vertices: Vertices,
    triangles: Vec<[u32; 3]>,
}

impl Content {
    fn read(path: &Path, bytes: &[u8]) -> Result<Self, SceneError> {
        let mut reader = Reader::new(bytes);
        let header = Parser::<Skipped>::new()
            .read_header(&mut reader)
            .map_err(|error| damaged(path, error.line().unwrap_or(1), &error))?;
        let mut source = Source {
            path,
            encoding: header.encoding,
            line: reader.line().saturating_sub(1),
            rest: reader.into_inner(),
        };
        let (mut vertices, mut triangles) = (Vertices::default(), Vec::new());
        for (name, element) in &header.elements {
            match name.as_str() {
                "vertex" => {
                    let has = Has::of(element);
                    source.each(element, |vertex: Vertex| {
                        vertices.push(vertex, has);
                        true
                    })?;
                }
                "face" => {
                    source.each(element, |face: Face| face.triangulate(&mut triangles, MAX_TRIANGLES))?
                }
                _ => source.each(element, |_: Skipped| true)?,
            }
        }
        Ok(Self { header, vertices, triangles })
    }
}

fn damaged(path: &Path, line: usize, error: &ParseError) -> SceneError {
    SceneError::model(path, line, plain(error))
}

/// Characters of a file's own text that an error quotes.
const QUOTED: usize = 60;

/// What the library says, without its own line number and the insides of its parser: its first line, and the text that
/// it stumbled over.
fn plain(error: &ParseError) -> String {
    let text = error.to_string();
    let own = error.line().map_or_else(String::new, |line| format!("Line {line}: "));
    let text = text.strip_prefix(&own).unwrap_or(&text);
    let first = text.lines().next().unwrap_or_default();
    let what = first.split_once(", but saw").map_or(first, |(what, _)| what);
    // A value in braces is a record of the library's.
    let what = if what.contains('{') { what.split('\'').step_by(2).collect() } else { what.to_owned() };
    let what = one_line(&what).trim_end_matches(['.', ':']).to_owned();
    let quoted = ["\n\tString: '", "\n\tValue: '"].iter().find_map(|mark| text.split_once(mark));
    let Some((_, quoted)) = quoted else { return what };
    let quoted = quoted.split("\n\tError: ").next().unwrap_or_default();
    let quoted: String = one_line(quoted.trim_end_matches('\'')).chars().take(QUOTED).collect();
    format!("{what}: '{}'", quoted.trim_end())
}

/// Writes numbers that are none as one beyond all range, which the library can read: they cost their triangles only.
fn with_readable_numbers(line: &mut String) {
    let is_none = |word: &str| word.parse().is_ok_and(|number: f64| !number.is_finite());
    if line.split_whitespace().any(is_none) {
        let words = line.split_whitespace().map(|word| if is_none(word) { "1e999" } else { word });
        *line = words.collect::<Vec<_>>().join(" ");
    }
}

/// The elements of a file that are still to be read.
struct Source<'a> {
    path: &'a Path,
    encoding: Encoding,
    line: usize,
    rest: &'a [u8],
}

impl Source<'_> {
    /// Hands on each element, until `take` has enough, which is an error.
    fn each<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut take: impl FnMut(E) -> bool,
    ) -> Result<(), SceneError> {
        if element.properties.is_empty() && self.encoding != Encoding::Ascii {
            return Ok(());
        }
        let parser = Parser::<E>::new();
        let mut line = String::new();
        for _ in 0..element.count {
            let read = match self.encoding {
                Encoding::Ascii => {
                    self.next_line(element, &mut line)?;
                    with_readable_numbers(&mut line);
                    parser.read_ascii_element(&line, element)
                }
                Encoding::BinaryBigEndian => parser.read_big_endian_element(&mut self.rest, element),
                Encoding::BinaryLittleEndian => parser.read_little_endian_element(&mut self.rest, element),
            };
            let read = read.map_err(|error| damaged(self.path, self.line, &error))?;
            if !take(read) {
                let message = format!("has more than {MAX_TRIANGLES} triangles");
                return Err(SceneError::unusable(self.path, message));
            }
        }
        Ok(())
    }

    /// The next line that is not blank.
    fn next_line(&mut self, element: &ElementDef, line: &mut String) -> Result<(), SceneError> {
        loop {
            line.clear();
            let mut bytes = Vec::new();
            let length = self.rest.read_until(b'\n', &mut bytes).unwrap_or(0);
            if length == 0 {
                let message = format!("the file is cut short: a {} is missing", one_line(&element.name));
                return Err(SceneError::model(self.path, self.line, message));
            }
            self.line += 1;
            line.push_str(&String::from_utf8_lossy(&bytes));
            if !line.trim().is_empty() || element.properties.is_empty() {
                return Ok(());
            }
        }
    }
}
