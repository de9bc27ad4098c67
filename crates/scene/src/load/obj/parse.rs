//! Reads the lines of an OBJ.

use std::borrow::Cow;
use std::collections::HashMap;

use glam::{Vec2, Vec3};

use crate::load::warnings::Warnings;
use crate::{Error, Limits};

/// Stands for a corner's texture coordinate or normal where it has none.
pub(super) const NONE: u32 = u32::MAX;

/// An OBJ as it was written.
#[derive(Default)]
pub(super) struct Source {
    pub(super) positions: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    /// Indices, counted from 0, of position, texture coordinate and normal; not yet checked.
    pub(super) corners: Vec<[u32; 3]>,
    pub(super) faces: Vec<Face>,
    pub(super) objects: Vec<String>,
    /// Names of materials that faces use.
    pub(super) materials: Vec<String>,
    /// Material libraries, with the line that names each.
    pub(super) libraries: Vec<(usize, String)>,
}

/// A polygon of at least three corners.
pub(super) struct Face {
    pub(super) line: usize,
    pub(super) object: usize,
    pub(super) material: Option<usize>,
    pub(super) first_corner: usize,
    pub(super) corner_count: usize,
}

/// Parses an OBJ; it must have a face.
pub(super) fn parse(
    name: &str,
    text: &str,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Source, Error> {
    let mut parser = Parser {
        name,
        limits,
        warnings,
        line: 0,
        object: 0,
        material: None,
        triangles: 0,
        index_of_material: HashMap::new(),
        index_of_object: HashMap::new(),
        source: Source { objects: vec![super::short_name(name)], ..Source::default() },
    };
    for (line, content) in logical_lines(text) {
        parser.line = line;
        parser.statement(&content)?;
    }
    if parser.source.faces.is_empty() {
        return Err(parser
            .error("no face with three corners in the whole file", "at least one line that begins with f"));
    }
    Ok(parser.source)
}

/// Lines with their numbers from 1; a line that ends in a backslash goes on in the next.
fn logical_lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (index, line) = lines.next()?;
        let mut joined = Cow::Borrowed(line);
        while let Some(start) = joined.strip_suffix('\\') {
            let mut longer = start.to_owned() + " ";
            longer.push_str(lines.next().map_or("", |(_, line)| line));
            joined = Cow::Owned(longer);
        }
        Some((index + 1, joined))
    })
}

struct Parser<'a> {
    name: &'a str,
    limits: &'a Limits,
    warnings: &'a mut Warnings,
    line: usize,
    object: usize,
    material: Option<usize>,
    triangles: u64,
    index_of_material: HashMap<String, usize>,
    index_of_object: HashMap<String, usize>,
    source: Source,
}

impl Parser<'_> {
    fn error(&self, found: impl Into<String>, expected: impl Into<String>) -> Error {
        Error::new(self.name, format!("line {}", self.line), found, expected)
    }

    fn statement(&mut self, line: &str) -> Result<(), Error> {
        let line = line.split('#').next().unwrap_or_default().trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        match keyword {
            "" | "g" | "s" => {}
            "v" => {
                self.check_count("vertices", self.source.positions.len(), self.limits.vertices)?;
                let position = Vec3::from(self.numbers(rest)?);
                if rest.split_whitespace().nth(5).is_some() {
                    self.warn("vertex colours are ignored");
                }
                self.source.positions.push(position);
            }
            "vt" => {
                self.check_count("vertices", self.source.uvs.len(), self.limits.vertices)?;
                // The second number of a texture coordinate may be left out.
                let [u] = self.numbers(rest)?;
                let v = if rest.contains(char::is_whitespace) { self.numbers::<2>(rest)?[1] } else { 0.0 };
                self.source.uvs.push(Vec2::new(u, v));
            }
            "vn" => {
                self.check_count("vertices", self.source.normals.len(), self.limits.vertices)?;
                let normal = Vec3::from(self.numbers(rest)?);
                self.source.normals.push(normal);
            }
            "f" => self.face(rest)?,
            "o" => self.object = intern(&mut self.source.objects, &mut self.index_of_object, rest),
            "usemtl" => {
                self.check_count("materials", self.source.materials.len(), self.limits.materials)?;
                self.material = Some(intern(&mut self.source.materials, &mut self.index_of_material, rest));
            }
            "mtllib" => {
                self.check_count("materials", self.source.libraries.len(), self.limits.materials)?;
                self.source.libraries.push((self.line, rest.to_owned()));
            }
            "l" | "p" => self.warn("points and lines are left out"),
            _ => self.warn("a statement that is not about polygons is ignored"),
        }
        Ok(())
    }

    fn check_count(&self, what: &str, count: usize, limit: u64) -> Result<(), Error> {
        if (count as u64) < limit {
            return Ok(());
        }
        Err(self.error(format!("more than {limit} {what}"), format!("at most {limit} (Limits::{what})")))
    }

    fn warn(&mut self, message: &str) {
        self.warnings.add(format!("line {}", self.line), message);
    }

    /// The first N numbers of a statement, all finite.
    fn numbers<const N: usize>(&self, text: &str) -> Result<[f32; N], Error> {
        let mut words = text.split_whitespace();
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            let word = words.next().unwrap_or("the end of the line");
            let parsed: Option<f32> = word.parse().ok();
            *number = parsed
                .filter(|number| number.is_finite())
                .ok_or_else(|| self.error(shorten(word), format!("{N} finite numbers")))?;
        }
        Ok(numbers)
    }

    fn face(&mut self, text: &str) -> Result<(), Error> {
        let first_corner = self.source.corners.len();
        for word in text.split_whitespace() {
            let corner = self.corner(word)?;
            self.source.corners.push(corner);
        }
        let corner_count = self.source.corners.len() - first_corner;
        if corner_count < 3 {
            self.source.corners.truncate(first_corner);
            self.warn("faces of fewer than three corners are left out");
            return Ok(());
        }
        self.triangles += corner_count as u64 - 2;
        if self.triangles > self.limits.triangles {
            let limit = self.limits.triangles;
            return Err(self.error(
                format!("more than {limit} triangles"),
                format!("at most {limit} (Limits::triangles)"),
            ));
        }
        let Self { line, object, material, .. } = *self;
        self.source.faces.push(Face { line, object, material, first_corner, corner_count });
        Ok(())
    }

    /// A corner: `position`, `position/uv`, `position//normal` or `position/uv/normal`.
    fn corner(&self, word: &str) -> Result<[u32; 3], Error> {
        let counts = [self.source.positions.len(), self.source.uvs.len(), self.source.normals.len()];
        let mut corner = [NONE; 3];
        let mut parts = word.split('/');
        for (index, count) in corner.iter_mut().zip(counts) {
            let Some(part) = parts.next().filter(|part| !part.is_empty()) else { continue };
            *index = resolve(part, count).ok_or_else(|| {
                self.error(shorten(part), "an index: from 1, or backwards from -1, of what stands above")
            })?;
        }
        if corner[0] == NONE || parts.next().is_some() {
            return Err(self.error(shorten(word), "a corner such as 1, 1/2, 1//3 or 1/2/3"));
        }
        Ok(corner)
    }
}

/// An index counted from 0. Positive ones are checked later, since the file may go on; negative
/// ones count backwards from the end of what there is so far.
fn resolve(text: &str, count: usize) -> Option<u32> {
    let number: i64 = text.parse().ok()?;
    let index = if number < 0 { number.checked_add(count as i64)? } else { number.checked_sub(1)? };
    u32::try_from(index).ok().filter(|index| *index != NONE)
}

/// The index of a name, added at first sight.
fn intern(names: &mut Vec<String>, index_of: &mut HashMap<String, usize>, name: &str) -> usize {
    *index_of.entry(name.to_owned()).or_insert_with(|| {
        names.push(name.to_owned());
        names.len() - 1
    })
}

/// The start of a word, for messages.
fn shorten(word: &str) -> String {
    format!("{:?}", word.chars().take(40).collect::<String>())
}
