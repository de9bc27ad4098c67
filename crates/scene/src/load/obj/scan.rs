//! Checks an OBJ, and rewrites it as the plain one that tobj is given.
//!
//! tobj tells no line numbers, overflows on extreme indices, wants vertices before their faces,
//! and mixes up corners where only some have a texture coordinate or normal. So every number,
//! index and count is checked here, with its line. The rewritten text has all vertices first, the
//! last texture coordinate and normal standing for those that a corner lacks. Then come the faces
//! of each object and material, whose corners have all three indices: from 1, or -1 for the last.

use std::borrow::Cow;
use std::collections::HashMap;

use crate::load::warnings::Warnings;
use crate::{Error, Limits};

/// The vertex statements; each counts its own.
const VERTICES: [(&str, &str); 3] = [("v", "position"), ("vt", "texture coordinate"), ("vn", "normal")];

/// An OBJ that was checked.
pub(super) struct Scan {
    vertices: String,
    /// Faces by object and material, in the order of their first faces.
    pub(super) groups: Vec<Group>,
    /// Material libraries, with the line that names each.
    pub(super) libraries: Vec<(usize, String)>,
}

/// The faces of one object and material.
pub(super) struct Group {
    pub(super) line: usize,
    pub(super) object: String,
    pub(super) material: String,
    faces: String,
}

impl Scan {
    /// The text for tobj, which makes one model of each group.
    pub(super) fn take_text(&mut self) -> String {
        let mut text = std::mem::take(&mut self.vertices);
        text += "vt nan nan\nvn 0 0 0\nmtllib all\n";
        for group in &mut self.groups {
            text += "o\nusemtl ";
            text += &group.material;
            text += "\n";
            text += &std::mem::take(&mut group.faces);
        }
        text
    }
}

/// Checks an OBJ; it must have a face.
pub(super) fn scan(name: &str, text: &str, limits: &Limits, warnings: &mut Warnings) -> Result<Scan, Error> {
    let mut scanner = Scanner {
        name,
        limits,
        warnings,
        line: 0,
        object: super::short_name(name),
        material: super::NO_MATERIAL.to_owned(),
        group: None,
        group_of_names: HashMap::new(),
        counts: [0; 3],
        highest: [(0, 0); 3],
        triangles: 0,
        scan: Scan { vertices: String::new(), groups: Vec::new(), libraries: Vec::new() },
    };
    for (line, content) in logical_lines(text) {
        scanner.line = line;
        scanner.statement(&content)?;
    }
    scanner.finish()
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

struct Scanner<'a> {
    name: &'a str,
    limits: &'a Limits,
    warnings: &'a mut Warnings,
    line: usize,
    object: String,
    material: String,
    /// The group of faces that follow; none before the first face of an object and material.
    group: Option<usize>,
    group_of_names: HashMap<(String, String), usize>,
    /// Positions, texture coordinates and normals so far.
    counts: [u32; 3],
    /// The highest index of each, and its line: the vertices may stand below the face.
    highest: [(u32, usize); 3],
    triangles: u64,
    scan: Scan,
}

impl Scanner<'_> {
    fn error(&self, found: impl Into<String>, expected: impl Into<String>) -> Error {
        Error::new(self.name, format!("line {}", self.line), found, expected)
    }

    fn warn(&mut self, message: &str) {
        self.warnings.add(format!("line {}", self.line), message);
    }

    fn check_count(&self, what: &str, count: u64, limit: u64) -> Result<(), Error> {
        if count <= limit {
            return Ok(());
        }
        Err(self.error(format!("more than {limit} {what}"), format!("at most {limit} (Limits::{what})")))
    }

    fn statement(&mut self, line: &str) -> Result<(), Error> {
        let (keyword, rest) = super::keyword_and_rest(line);
        match keyword {
            "" | "g" | "s" => {}
            "v" => {
                self.vertex(0, rest)?;
                if rest.split_whitespace().nth(5).is_some() {
                    self.warn("vertex colours are ignored");
                }
            }
            "vt" => self.vertex(1, rest)?,
            "vn" => self.vertex(2, rest)?,
            "f" => self.face(rest)?,
            "o" => {
                self.object = super::name(rest);
                self.group = None;
            }
            "usemtl" => {
                self.material = super::name(rest);
                self.group = None;
            }
            "mtllib" => {
                self.check_count("materials", self.scan.libraries.len() as u64 + 1, self.limits.materials)?;
                self.scan.libraries.push((self.line, rest.to_owned()));
            }
            "l" | "p" => self.warn("points and lines are left out"),
            _ => self.warn("a statement that is not about polygons is ignored"),
        }
        Ok(())
    }

    /// Two numbers for a texture coordinate, of which the second may be left out, else three.
    fn vertex(&mut self, kind: usize, rest: &str) -> Result<(), Error> {
        let next = self.counts[kind] + 1;
        self.check_count("vertices", u64::from(next), self.limits.vertices.min(u64::from(u32::MAX) - 1))?;
        self.counts[kind] = next;
        self.scan.vertices += VERTICES[kind].0;
        let mut words = rest.split_whitespace();
        for place in 0..if kind == 1 { 2 } else { 3 } {
            let missing = if (kind, place) == (1, 1) { "0" } else { "the end of the line" };
            let word = words.next().unwrap_or(missing);
            if !word.parse().is_ok_and(f32::is_finite) {
                return Err(self.error(shorten(word), "finite numbers: three, or one or two after vt"));
            }
            self.scan.vertices += " ";
            self.scan.vertices += word;
        }
        self.scan.vertices += "\n";
        Ok(())
    }

    fn face(&mut self, rest: &str) -> Result<(), Error> {
        if rest.split_whitespace().nth(2).is_none() {
            self.warn("faces of fewer than three corners are left out");
            return Ok(());
        }
        let group = self.group()?;
        let mut faces = std::mem::take(&mut self.scan.groups[group].faces);
        faces += "f";
        for word in rest.split_whitespace() {
            self.corner(word, &mut faces)?;
            self.triangles += 1;
        }
        faces += "\n";
        self.triangles -= 2;
        self.scan.groups[group].faces = faces;
        self.check_count("triangles", self.triangles, self.limits.triangles)
    }

    /// The group of the present object and material.
    fn group(&mut self) -> Result<usize, Error> {
        if let Some(group) = self.group {
            return Ok(group);
        }
        let (object, material) = (self.object.clone(), self.material.clone());
        let next = self.scan.groups.len();
        let group = *self.group_of_names.entry((object.clone(), material.clone())).or_insert(next);
        if group == next {
            self.check_count("nodes", next as u64 + 1, self.limits.nodes)?;
            self.scan.groups.push(Group { line: self.line, object, material, faces: String::new() });
        }
        self.group = Some(group);
        Ok(group)
    }

    /// Copies a corner: `position`, `position/uv`, `position//normal` or `position/uv/normal`.
    fn corner(&mut self, word: &str, faces: &mut String) -> Result<(), Error> {
        let mut parts = word.split('/');
        for kind in 0..3 {
            faces.push(if kind == 0 { ' ' } else { '/' });
            let Some(part) = parts.next().filter(|part| !part.is_empty()) else {
                *faces += "-1";
                continue;
            };
            let index = resolve(part, self.counts[kind]).ok_or_else(|| {
                self.error(shorten(part), "an index: from 1, or backwards from -1, of what stands above")
            })?;
            if index > self.highest[kind].0 {
                self.highest[kind] = (index, self.line);
            }
            if part.starts_with('-') {
                *faces += &index.to_string();
            } else {
                *faces += part;
            }
        }
        if word.starts_with('/') || parts.next().is_some() {
            return Err(self.error(shorten(word), "a corner such as 1, 1/2, 1//3 or 1/2/3"));
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Scan, Error> {
        for ((count, (index, line)), (_, what)) in self.counts.into_iter().zip(self.highest).zip(VERTICES) {
            if index > count {
                self.line = line;
                let expected = format!("1 to {count}, of those that the file has");
                return Err(self.error(format!("{what} {index}"), expected));
            }
        }
        if self.scan.groups.is_empty() {
            return Err(self.error(
                "no face with three corners in the whole file",
                "at least one line that begins with f",
            ));
        }
        Ok(self.scan)
    }
}

/// An index counted from 1; negative ones count backwards from the end of what there is so far.
fn resolve(text: &str, count: u32) -> Option<u32> {
    let number: i64 = text.parse().ok()?;
    let index = if number < 0 { number.checked_add(i64::from(count) + 1)? } else { number };
    u32::try_from(index).ok().filter(|index| (1..u32::MAX).contains(index))
}

/// The start of a word, for messages.
fn shorten(word: &str) -> String {
    format!("{:?}", word.chars().take(40).collect::<String>())
}
