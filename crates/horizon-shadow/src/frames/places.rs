//! Vertices that are one place of the surface: at one position, with one normal.

use std::collections::HashMap;

use glam::DVec3;

/// Cosine of the angle up to which two normals are of one smooth surface: 2.5 degrees, above what
/// files round, below what is meant as an edge.
const SMOOTH: f64 = 0.999;

/// Steps of texture coordinates over 0..1 that count as equal.
const STEPS: f64 = 65_536.0;

/// The places of a mesh.
pub(super) struct Places {
    /// How many there are.
    pub(super) count: usize,
    /// Of each vertex; `None` where its position or normal is unusable.
    pub(super) of_vertex: Vec<Option<usize>>,
}

impl Places {
    /// From positions and unit normals (0 where there is none), of equal number.
    pub(super) fn new(positions: &[[f32; 3]], normals: &[DVec3]) -> Self {
        let mut at_position: HashMap<[u32; 3], Vec<(DVec3, usize)>> = HashMap::with_capacity(positions.len());
        let mut count = 0;
        let mut place = |position: [f32; 3], normal: DVec3| {
            if normal == DVec3::ZERO || !position.iter().all(|value| value.is_finite()) {
                return None;
            }
            let known = at_position.entry(key(position)).or_default();
            if let Some((_, place)) = known.iter().find(|(other, _)| other.dot(normal) > SMOOTH) {
                return Some(*place);
            }
            known.push((normal, count));
            count += 1;
            Some(count - 1)
        };
        let of_vertex =
            positions.iter().zip(normals).map(|(&position, &normal)| place(position, normal)).collect();
        Self { count, of_vertex }
    }

    /// The same, split where the map is torn: vertices of a place stay one whose texture coordinates
    /// differ by whole numbers, as where a map closes around a cylinder. Of equal number as the
    /// vertices.
    pub(super) fn mapped(&self, uvs: &[[f32; 2]]) -> Self {
        let mut known: HashMap<(usize, [i64; 2]), usize> = HashMap::with_capacity(uvs.len());
        let mut mapped = |(place, uv): (&Option<usize>, &[f32; 2])| {
            let count = known.len();
            Some(*known.entry(((*place)?, uv.map(within_repeat))).or_insert(count))
        };
        let of_vertex = self.of_vertex.iter().zip(uvs).map(&mut mapped).collect();
        Self { count: known.len(), of_vertex }
    }
}

/// A texture coordinate without its whole repeats, in steps above the rounding of files.
fn within_repeat(coordinate: f32) -> i64 {
    (f64::from(coordinate).rem_euclid(1.0) * STEPS).round() as i64 % STEPS as i64
}

/// A position's bits, where -0 and 0 are the same.
fn key(position: [f32; 3]) -> [u32; 3] {
    position.map(|value| if value == 0.0 { 0 } else { value.to_bits() })
}
