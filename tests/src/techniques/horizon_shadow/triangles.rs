//! The second truth: a displaced ground as dense triangles in the path tracer's hierarchy, which
//! shares nothing with the rays of [`super::rays`] but the ground and its heights.

use super::{
    grounds::Ground,
    rays::{Displaced, Heights},
};
use crate::{
    Context,
    technique::{Fact, Failure, Measurement},
};
use glam::{DVec2, DVec3, Mat4};
use horizon_shadow::Wrap;
use path_tracer::PathTracer;
use rayon::prelude::*;
use scene::{Instance, Material, Mesh, Scene, builtin};

/// Length of a texel, metres.
const TEXEL_M: f64 = 1.0 / 128.0;

/// Cells of triangles along a texel. The lines between the map's cells, which the relief's ridges
/// are, are edges of triangles.
const CELLS_PER_TEXEL: usize = 4;
/// The same among the places that are asked about. Flat triangles on relief that is bent are off in
/// slope by a part of their size, and the slope at a place decides about grazing light.
const CELLS_PER_TEXEL_NEAR: usize = 24;
/// Half the side of the square of places that are asked about, in texels.
const HALF_WINDOW: usize = 6;
/// Where rays leave their triangle behind, in texels.
const OFFSET_TEXELS: f64 = 1e-3;
/// Answers may differ where a light that is so much higher or lower has the other answer, degrees.
const NEAR_DEG: f64 = 0.1;

/// How the two truths agree about places and lights.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Agreement {
    /// How many were asked about.
    pub(super) samples: usize,
    /// How many lie in shadow, as the triangles say.
    pub(super) dark: usize,
    /// How many answers differ.
    pub(super) differing: usize,
    /// How many of these are not within a tenth of a degree of the horizon of the rays.
    pub(super) differing_far: usize,
}

impl Agreement {
    /// The share of the answers that differ.
    pub(super) fn differing_share(&self) -> f64 {
        self.differing as f64 / self.samples as f64
    }
}

/// Asks both truths about so many places within 6 texels of `center`, each with a light of any
/// azimuth and an elevation of -10 to 50 degrees over the ground. None is left out.
pub(super) fn agreement(
    displaced: &Displaced<'_>,
    center: DVec2,
    samples: usize,
) -> Result<Agreement, Failure> {
    let triangles = Triangles::new(displaced, center)?;
    let one = |i: usize| {
        let part = |step: f64| (step * (i + 1) as f64).fract();
        // A lattice of rank one in four dimensions.
        let spread = DVec2::new(part(0.856_674_883_854_503), part(0.733_891_856_627_126)) - 0.5;
        let uv = (triangles.middle + 0.5 + spread * (2 * HALF_WINDOW) as f64) / triangles.texels_per_uv;
        let (azimuth_deg, elevation_deg) =
            (360.0 * part(0.628_706_721_039_703), -10.0 + 60.0 * part(0.538_597_256_886_091));
        let by_rays = |more_deg: f64| {
            displaced.hit_m(uv, light(displaced, uv, azimuth_deg, elevation_deg + more_deg)).is_some()
        };
        let is_dark = triangles.is_dark(uv, light(displaced, uv, azimuth_deg, elevation_deg));
        let differs = by_rays(0.0) != is_dark;
        let is_far = || by_rays(NEAR_DEG) != is_dark && by_rays(-NEAR_DEG) != is_dark;
        Agreement {
            samples: 1,
            dark: usize::from(is_dark),
            differing: usize::from(differs),
            differing_far: usize::from(differs && is_far()),
        }
    };
    Ok((0..samples).into_par_iter().map(one).reduce(Agreement::default, |a, b| Agreement {
        samples: a.samples + b.samples,
        dark: a.dark + b.dark,
        differing: a.differing + b.differing,
        differing_far: a.differing_far + b.differing_far,
    }))
}

/// Unit vector to a light over a place of the ground.
fn light(displaced: &Displaced<'_>, uv: DVec2, azimuth_deg: f64, elevation_deg: f64) -> DVec3 {
    let point = displaced.ground.point(uv);
    let across = point.along_u.normalize_or(DVec3::X);
    let (sin, cos) = azimuth_deg.to_radians().sin_cos();
    let (up, out) = elevation_deg.to_radians().sin_cos();
    (across * cos + point.normal.cross(across) * sin) * out + point.normal * up
}

/// The part of a displaced ground that rays from the middle of it reach.
struct Triangles {
    tracer: PathTracer,
    /// Row by row, as the tracer has them.
    positions: Vec<DVec3>,
    /// Where the rows and columns of positions lie, in texels from the middle.
    lines: Vec<f64>,
    /// The middle in texels, whose centres are whole numbers.
    middle: DVec2,
    texels_per_uv: DVec2,
    texel_m: f64,
    longest_m: f64,
}

impl Triangles {
    fn new(displaced: &Displaced<'_>, center: DVec2) -> Result<Self, Failure> {
        let Displaced { ground, heights, texel_m, longest_m } = *displaced;
        let texels_per_uv = heights.uv_scale * DVec2::from(heights.size.map(|size| size as f64));
        // A third more than the ray's length, for texels that are shorter than those of the middle.
        let lines = lines(HALF_WINDOW + (1.34 * longest_m / texel_m).ceil() as usize);
        let middle = (center * texels_per_uv - 0.5).round();
        let mut mesh = Mesh { name: "displaced ground".into(), ..Mesh::default() };
        for &y in &lines {
            for &x in &lines {
                let uv = (middle + DVec2::new(x, y) + 0.5) / texels_per_uv;
                mesh.positions.push(displaced.position(uv).as_vec3());
                mesh.normals.push(ground.point(uv).normal.as_vec3());
            }
        }
        let cells = lines.len() - 1;
        let corner = |i: usize, across: usize, down: usize| {
            ((i / cells + down) * lines.len() + i % cells + across) as u32
        };
        mesh.triangles = (0..cells * cells)
            .flat_map(|i| {
                let [a, b, c, d] = [corner(i, 0, 0), corner(i, 1, 0), corner(i, 0, 1), corner(i, 1, 1)];
                [[a, c, b], [b, c, d]]
            })
            .collect();
        let positions = mesh.positions.iter().map(|position| position.as_dvec3()).collect();
        let scene = Scene {
            meshes: vec![mesh],
            materials: vec![Material { double_sided: true, ..Material::default() }],
            instances: vec![Instance {
                name: String::new(),
                mesh: 0,
                material: 0,
                world_from_local: Mat4::IDENTITY,
            }],
            ..Scene::default()
        };
        let tracer = PathTracer::new(&scene)?;
        Ok(Self { tracer, positions, lines, middle, texels_per_uv, texel_m, longest_m })
    }

    /// Whether a ray from the triangle above u, v meets another one, or its own from below.
    fn is_dark(&self, uv: DVec2, direction: DVec3) -> bool {
        let (origin, normal) = self.place(uv);
        if normal.dot(direction) <= 0.0 {
            return true;
        }
        let offset = OFFSET_TEXELS * self.texel_m;
        let distance = self.tracer.trace_distance(origin + direction * offset, direction);
        distance.is_some_and(|distance| distance + offset < self.longest_m)
    }

    /// The place of a triangle above u, v, and the triangle's normal.
    fn place(&self, uv: DVec2) -> (DVec3, DVec3) {
        let at = uv * self.texels_per_uv - 0.5 - self.middle;
        let (column, x) = self.cell(at.x);
        let (row, y) = self.cell(at.y);
        let f = DVec2::new(x, y);
        let position =
            |across: usize, down: usize| self.positions[(row + down) * self.lines.len() + column + across];
        let (b, c) = (position(1, 0), position(0, 1));
        let (corner, to_b, to_c) = if f.x + f.y < 1.0 {
            let a = position(0, 0);
            (a, (b - a) * f.x, (c - a) * f.y)
        } else {
            let d = position(1, 1);
            (d, (b - d) * (1.0 - f.y), (c - d) * (1.0 - f.x))
        };
        let (one, other) = if f.x + f.y < 1.0 { (c - corner, b - corner) } else { (b - corner, c - corner) };
        (corner + to_b + to_c, one.cross(other).normalize_or_zero())
    }

    /// The line before a place, and the part of the way to the next.
    fn cell(&self, at: f64) -> (usize, f64) {
        let next = self.lines.partition_point(|&line| line <= at).clamp(1, self.lines.len() - 1);
        let [before, after] = [self.lines[next - 1], self.lines[next]];
        (next - 1, (at - before) / (after - before))
    }
}

/// Lines so many texels to both sides of 0, denser near it.
fn lines(half: usize) -> Vec<f64> {
    let parts = |texel: i32| {
        let is_near = texel >= -(HALF_WINDOW as i32) && texel < HALF_WINDOW as i32;
        let cells = if is_near { CELLS_PER_TEXEL_NEAR } else { CELLS_PER_TEXEL };
        (0..cells).map(move |part| f64::from(texel) + part as f64 / cells as f64)
    };
    (-(half as i32)..half as i32).flat_map(parts).chain([half as f64]).collect()
}

/// Rough ground on every kind of surface: names, and the surfaces over 128 x 128 texels.
fn grounds() -> [(&'static str, Ground); 7] {
    const RISE: [[f64; 4]; 4] =
        [[0.0, 0.16, 0.1, -0.1], [0.1, 0.42, 0.34, 0.0], [0.06, 0.36, 0.3, -0.06], [-0.12, 0.1, 0.06, -0.2]];
    let place = |index: usize| index as f64 / 3.0 - 0.5;
    let control = |row: usize, column: usize| DVec3::new(place(column), RISE[row][column], place(row));
    let patch = std::array::from_fn(|row| std::array::from_fn(|column| control(row, column)));
    let (ring, tube) = (80.0 * TEXEL_M, 40.0 * TEXEL_M);
    [
        ("plane", Ground::Plane(DVec2::ONE)),
        ("sphere", Ground::Sphere(TEXEL_M / 0.015, DVec2::ONE)),
        ("cylinder", Ground::Cylinder(TEXEL_M / 0.015, DVec2::ONE)),
        ("cylinder from within", Ground::Cylinder(-TEXEL_M / 0.008, DVec2::ONE)),
        ("torus", Ground::Torus(ring, tube, DVec2::ONE / DVec2::new(ring + tube, tube))),
        ("saddle", Ground::Saddle(0.008 / TEXEL_M, 1.0)),
        ("Bezier patch", Ground::Bezier(Box::new(patch))),
    ]
}

/// The agreement on one of these, of the built-in rough map at its height.
fn rough_agreement(ground: &Ground) -> Result<Agreement, Failure> {
    const SAMPLES: usize = 20_000;
    const REACH_TEXELS: f64 = 40.0;
    let map = builtin::height_map("fbm").ok_or("no such height map")?;
    let texels = f64::from(builtin::height_map_texels("fbm").ok_or("no such height map")?);
    let values_m: Vec<f64> = map.heights.iter().map(|&h| f64::from(h) * texels * TEXEL_M).collect();
    let heights = Heights {
        size: [map.width as usize, map.height as usize],
        greatest_m: values_m.iter().copied().fold(0.0, f64::max),
        values_m,
        wrap: [Wrap::Repeat; 2],
        uv_scale: DVec2::ONE,
    };
    let longest_m = REACH_TEXELS * TEXEL_M;
    agreement(
        &Displaced { ground, heights: &heights, texel_m: TEXEL_M, longest_m },
        DVec2::splat(0.5),
        SAMPLES,
    )
}

/// How far the two truths agree, for the report.
pub(super) fn measurement() -> Measurement {
    let run = |context: &mut Context| {
        let grounds = grounds();
        let some = if context.scope().quick { 2 } else { grounds.len() };
        grounds[..some].iter().map(|(name, ground)| fact(name, ground)).collect()
    };
    Measurement {
        name: "horizon-shadow two truths".into(),
        how: "share of 20,000 places and lights on rough ground whose shadow differs between rays in f64 and dense \
              triangles; none left out"
            .into(),
        run: Box::new(run),
    }
}

fn fact(name: &str, ground: &Ground) -> Result<Fact, Failure> {
    let found = rough_agreement(ground)?;
    let far = 100.0 * found.differing_far as f64 / found.samples as f64;
    Ok(Fact {
        name: name.into(),
        value: 100.0 * found.differing_share(),
        unit: "%".into(),
        note: format!("goal 0.1; {far:.3} % more than {NEAR_DEG} degrees from the horizon"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_truths_agree() {
        for (name, ground) in grounds() {
            let found = rough_agreement(&ground).unwrap();
            println!("{name}: {found:?} {:.3} %", 100.0 * found.differing_share());
            assert!(found.dark > 4_000 && found.dark < 12_000, "{name} {found:?}");
            assert!(found.differing_share() <= 0.001, "{name} {found:?}");
        }
    }
}
