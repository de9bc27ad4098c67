//! Extents of tiles, moments and ambient occlusion against the same from the decoded candidates.

mod bake_support;

use bake_support::{Field, decoded, exact_tangent, gpu, hash, layer, record, texture_layer};
use horizon_shadow::{Bake, Baker, Gpu, Heights, Parts, Search, TableDesc, Wrap};

fn bake_all(gpu: &Gpu, field: &Field, desc: &TableDesc) -> Bake {
    let baker = Baker::new(gpu).expect("pipelines");
    let view = field.view(gpu);
    let heights = Heights { view: &view, range: field.range };
    let parts = Parts { prefilter: true, ambient: true };
    let mut bake = baker.start(gpu, desc, &heights, parts, 0).expect("a bake");
    record(gpu, &baker, &mut bake, Search::Sweep);
    bake
}

/// A relief in f64, and the decoded candidates of one azimuth.
struct Truth<'a> {
    field: &'a Field,
    desc: &'a TableDesc,
    candidates: Vec<Vec<[f32; 2]>>,
}

impl<'a> Truth<'a> {
    fn new(gpu: &Gpu, field: &'a Field, bake: &'a Bake, azimuth: u32) -> Self {
        let desc = bake.desc();
        let layer = layer(gpu, bake, azimuth);
        let candidates = (0..desc.nodes().len()).map(|node| decoded(desc, &layer, node)).collect();
        Self { field, desc, candidates }
    }

    fn texel(&self, x: i64, y: i64) -> f64 {
        let wrapped = |at: i64, axis: usize| {
            let size = i64::from(self.field.size[axis]);
            match self.field.wrap[axis] {
                Wrap::Repeat => at.rem_euclid(size),
                Wrap::Clamp => at.clamp(0, size - 1),
            }
        };
        let index = wrapped(y, 1) * i64::from(self.field.size[0]) + wrapped(x, 0);
        f64::from((self.field.values[index as usize] - self.field.range[0]) * self.desc.texels_per_height)
    }

    fn height(&self, x: f64, y: f64) -> f64 {
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let (i, j) = (x.floor() as i64, y.floor() as i64);
        let row = |j| self.texel(i, j) * (1.0 - fx) + self.texel(i + 1, j) * fx;
        row(j) * (1.0 - fy) + row(j + 1) * fy
    }

    /// Tangent of what a texel sees beyond one texel, the base's own horizon included.
    fn far(&self, x: i64, y: i64, kappa: f64) -> f64 {
        let [width, rows] = self.field.size.map(i64::from);
        let index = (y.rem_euclid(rows) * width + x.rem_euclid(width)) as usize;
        let height = self.texel(x, y);
        let floor = if kappa > 0.0 { -(kappa * height * (2.0 + kappa * height)).sqrt() } else { -1e4 };
        let tangents = self.candidates.iter().map(|node| {
            let [slope, distance] = node[index].map(f64::from);
            exact_tangent(kappa, height, slope, distance)
        });
        tangents.fold(floor, f64::max)
    }

    /// Tangent of the nearest texel.
    fn near(&self, [x, y]: [f64; 2], direction: [f64; 2], kappa: f64) -> f64 {
        let height = self.height(x, y);
        let tangent = |i: i32| {
            let d = f64::from(i) / 16.0;
            let rise = self.height(x + d * direction[0], y + d * direction[1]) - height;
            exact_tangent(kappa, height, rise / d, d)
        };
        (1..=16).map(tangent).fold(-1e4, f64::max)
    }
}

fn sine(tangent: f64) -> f64 {
    tangent / (1.0 + tangent * tangent).sqrt()
}

#[test]
fn extents_hold_every_horizon_of_their_tile() {
    let gpu = gpu();
    for (curvature, wrap) in
        [([0.0, 0.02], Wrap::Repeat), ([-0.01, 0.01], Wrap::Clamp), ([0.005, 0.02], Wrap::Clamp)]
    {
        let field = Field { wrap: [wrap; 2], ..Field::rough([48, 40], 11) };
        let desc = field.desc(2, curvature, 8.0);
        let bake = bake_all(&gpu, &field, &desc);
        let (mut decided, mut tiles) = (0, 0);
        for azimuth in [0, 3, 4, 10, 15] {
            let truth = Truth::new(&gpu, &field, &bake, azimuth);
            let extents = texture_layer(&gpu, bake.tables().extents.texture(), 0, azimuth);
            for (tile, code) in extents.chunks_exact(2).enumerate() {
                let [least, greatest] = [code[0], code[1]].map(|c| f64::from(c) / 255.0 * 2.0 - 1.0);
                tiles += 1;
                decided += u32::from(greatest < 0.98 && least > -0.98);
                for sample in 0..40 {
                    let random = |i: u32| f64::from(hash(tile as u32, sample * 8 + i, azimuth));
                    let corner = [tile as i64 % 6 * 8, tile as i64 / 6 * 8];
                    let at = [corner[0] as f64 + 8.0 * random(0), corner[1] as f64 + 8.0 * random(1)];
                    let kappa = f64::from(curvature[0]) + random(2) * f64::from(curvature[1] - curvature[0]);
                    let angle = (f64::from(azimuth) + random(3) - 0.5) * std::f64::consts::TAU / 16.0;
                    let last = |axis: usize, x: i64| match wrap {
                        Wrap::Repeat => x,
                        Wrap::Clamp => x.min(i64::from(field.size[axis]) - 1),
                    };
                    let cell = [last(0, at[0] as i64 + i64::from(random(4) < 0.5)), last(1, at[1] as i64)];
                    let far = sine(truth.far(cell[0], cell[1], kappa));
                    let near = sine(truth.near(at, [angle.cos(), angle.sin()], kappa));
                    let found = format!("{curvature:?} azimuth {azimuth} tile {tile}: {least}..{greatest}");
                    assert!(far >= least - 1e-4 && far <= greatest + 1e-4, "{found}: far {far}");
                    assert!(near <= greatest + 1e-4, "{found}: near {near}");
                }
            }
        }
        assert!(decided * 2 > tiles, "{decided} of {tiles} tiles say something");
    }
}

#[test]
fn extents_of_gentle_ground_are_narrow() {
    let gpu = gpu();
    let field = Field::new([64, 64], |x, _| (f64::from(x) * std::f64::consts::TAU / 32.0).sin() as f32);
    let desc = field.desc(2, [0.0, 0.001], 1.0);
    let bake = bake_all(&gpu, &field, &desc);
    let extents = texture_layer(&gpu, bake.tables().extents.texture(), 0, 0);
    // Slopes are at most 0.2.
    for code in extents.chunks_exact(2) {
        let [least, greatest] = [code[0], code[1]].map(|c| f64::from(c) / 255.0 * 2.0 - 1.0);
        assert!(least > -0.22 && greatest < 0.24, "{least}..{greatest}");
    }
}

#[test]
fn moments_are_those_of_the_horizons() {
    let gpu = gpu();
    let field = Field::rough([30, 22], 4);
    let desc = field.desc(2, [-0.004, 0.02], 6.0);
    let bake = bake_all(&gpu, &field, &desc);
    for azimuth in [0, 3, 9] {
        let truth = Truth::new(&gpu, &field, &bake, azimuth);
        let image = gpu_context::readback::read_texture(&gpu, bake.tables().moments.texture(), 0, azimuth)
            .expect("readable");
        assert_eq!([image.width, image.height], [8, 6]);
        let angle = f64::from(azimuth) * std::f64::consts::TAU / 16.0;
        let step = 0.5 / angle.cos().abs().max(angle.sin().abs());
        for (block, found) in image.values.chunks_exact(4).enumerate() {
            let (mut sums, mut count) = ([0.0; 4], 0.0);
            let [left, top] = [block as i64 % 8 * 4, block as i64 / 8 * 4];
            for (x, y) in
                (top..(top + 4).min(22)).flat_map(|y| (left..(left + 4).min(30)).map(move |x| (x, y)))
            {
                for (i, kappa) in desc.curvature_per_texel.map(f64::from).into_iter().enumerate() {
                    let height = truth.texel(x, y);
                    let ahead = [x as f64 + step * angle.cos(), y as f64 + step * angle.sin()];
                    let rise = truth.height(ahead[0], ahead[1]) - height;
                    let near = exact_tangent(kappa, height, rise / step, step);
                    let sine = sine(truth.far(x, y, kappa).max(near));
                    sums[2 * i] += sine;
                    sums[2 * i + 1] += sine * sine;
                }
                count += 1.0;
            }
            for (sum, &found) in sums.iter().zip(found) {
                assert!(
                    (sum / count - f64::from(found)).abs() < 2e-3,
                    "{azimuth} {block}: {sums:?} / {count}, {found}"
                );
            }
        }
    }
}

#[test]
fn coarser_levels_are_means() {
    let gpu = gpu();
    let field = Field::rough([50, 26], 4);
    let bake = bake_all(&gpu, &field, &field.desc(2, [0.0, 0.02], 6.0));
    for (texture, layer) in [(bake.tables().moments.texture(), 5), (bake.tables().ambient.texture(), 1)] {
        assert!(texture.mip_level_count() > 3);
        for level in 1..texture.mip_level_count() {
            let read =
                |level| gpu_context::readback::read_texture(&gpu, texture, level, layer).expect("readable");
            let (finer, coarser) = (read(level - 1), read(level));
            for (x, y) in (0..coarser.height).flat_map(|y| (0..coarser.width).map(move |x| (x, y))) {
                let texel = |dx: u32, dy: u32| {
                    let at = [(2 * x + dx).min(finer.width - 1), (2 * y + dy).min(finer.height - 1)];
                    finer.texel(at[0], at[1]).expect("inside")
                };
                for (channel, &found) in coarser.texel(x, y).expect("inside").iter().enumerate() {
                    let four = [texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)];
                    let mean = four.iter().map(|texel| texel[channel]).sum::<f32>() / 4.0;
                    assert!((mean - found).abs() < 3e-3, "level {level} {x},{y}: {mean} {found}");
                }
            }
        }
    }
}

#[test]
fn ambient_occlusion_is_that_of_known_ground() {
    let gpu = gpu();
    // Level ground sees everything, straight up; an even slope sees all above it about its normal.
    let level = Field { range: [0.0, 1.0], ..Field::new([16, 16], |_, _| 0.25) };
    let slope = Field { wrap: [Wrap::Clamp; 2], ..Field::new([64, 64], |x, _| x as f32 / 63.0) };
    let wall = Field::new([64, 16], |x, _| if x == 32 { 1.0 } else { 0.0 });
    let ambient = |field: &Field, scale: f32, texel: [u32; 2]| {
        let desc = TableDesc { azimuths: 64, ..field.desc(1, [0.0, 0.0], scale) };
        let bake = bake_all(&gpu, field, &desc);
        let image = gpu_context::readback::read_texture(&gpu, bake.tables().ambient.texture(), 0, 0);
        let texel = image.expect("readable").texel(texel[0], texel[1]).expect("inside").to_vec();
        [texel[0] * 2.0 - 1.0, texel[1] * 2.0 - 1.0, texel[2]]
    };
    let [x, y, fraction] = ambient(&level, 4.0, [7, 7]);
    assert!(x.abs() < 5e-3 && y.abs() < 5e-3 && fraction > 0.995, "{x} {y} {fraction}");
    // A rise of 1 in 2 along +x: its normal leans by atan(1/2) towards -x, and the rising ground
    // hides nothing of the hemisphere about it.
    let [x, y, fraction] = ambient(&slope, 31.5, [20, 32]);
    assert!(y.abs() < 0.01 && (-0.5..-0.2).contains(&x), "{x} {y}");
    assert!(fraction > 0.97, "{fraction}");
    // Beside a wall without end half of the sky is left: (1 + cos(0)) / 2 of the cosines.
    let [x, _, fraction] = ambient(&wall, 1e4, [31, 8]);
    assert!((fraction - 0.5).abs() < 0.03, "{fraction}");
    assert!(x < -0.3, "the bent normal leans away from the wall: {x}");
}
