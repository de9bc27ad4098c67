//! The profile of a relief along one azimuth, on a base of constant curvature.

use super::{NEAR_TEXELS, NO_HORIZON, Relief, View, exact, exact_slope, floor};

/// What is seen from a point of a relief along an azimuth.
#[derive(Clone, Copy, Debug)]
pub struct Ray<'a> {
    /// The relief.
    pub relief: &'a Relief,
    /// Where the point lies, in texels.
    pub at: [f64; 2],
    /// Unit direction in texels.
    pub direction: [f64; 2],
    /// Curvature of the base along it, 1 / texel, convex positive.
    pub kappa: f64,
    /// Texels between the map's 0 and 1.
    pub texels_per_height: f64,
    /// How far points are looked at, in texels.
    pub radius_texels: f64,
}

impl<'a> Ray<'a> {
    /// Towards the light of a view, as the published methods look.
    pub fn new(relief: &'a Relief, view: &View, radius_texels: f64) -> Self {
        let View { at, direction, kappa, texels_per_height, .. } = *view;
        Self { relief, at, direction, kappa, texels_per_height, radius_texels }
    }

    /// Turned by the base's torsion, as Sheen's methods look.
    pub fn turned(relief: &'a Relief, view: &View, radius_texels: f64) -> Self {
        Self::new(relief, &view.turned(relief.least() + relief.height(view.at)), radius_texels)
    }
}

impl Ray<'_> {
    /// Height of the relief above its least, `distance` texels ahead, in texels.
    pub fn height(&self, distance: f64) -> f64 {
        let point = |i: usize| self.at[i] + distance * self.direction[i];
        self.texels_per_height * self.relief.height([point(0), point(1)])
    }

    /// tan(beta') of the point `distance` ahead.
    pub fn tangent(&self, distance: f64) -> f64 {
        let height = self.height(0.0);
        exact(self.kappa, distance, self.height(distance) - height, height)
    }

    /// tan(beta') of the points at once ahead: the relief's own slope.
    pub fn own_tangent(&self) -> f64 {
        let slope = self.texels_per_height * self.relief.tangent(self.at, self.direction);
        exact_slope(self.kappa, 0.0, slope, self.height(0.0))
    }

    /// The smooth base's horizon.
    pub fn floor(&self) -> f64 {
        floor(self.kappa, self.height(0.0))
    }

    /// Distances in `least..greatest` at which the ray crosses a line of the map's grid, both ends
    /// included, ascending. Between two of them the relief is a parabola.
    pub fn crossings(&self, least: f64, greatest: f64) -> Vec<f64> {
        let mut all = vec![least];
        for i in 0..2 {
            let speed = self.direction[i];
            if speed.abs() < 1e-9 {
                continue;
            }
            let (a, b) = (self.at[i] + least * speed, self.at[i] + greatest * speed);
            let lines = (a.min(b).ceil() as i64)..=(a.max(b).floor() as i64);
            all.extend(lines.map(|line| (line as f64 - self.at[i]) / speed));
        }
        all.push(greatest);
        all.retain(|d| (least..=greatest).contains(d));
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        all
    }

    /// The exact horizon of the relief as it is: tan(beta') of the largest of the slope at once
    /// ahead, all crossings with the grid, and so many points between each two, up to the radius; and
    /// of the smooth base.
    pub fn march_exact(&self, between: u32) -> f64 {
        let start = self.floor().max(self.own_tangent());
        let crossings = self.crossings(0.0, self.radius_texels);
        crossings.windows(2).fold(start, |best, pair| {
            let (from, length) = (pair[0], pair[1] - pair[0]);
            let part = |i| from + length * f64::from(i) / f64::from(between + 1);
            (1..=between + 1).fold(best, |best, i| best.max(self.tangent(part(i))))
        })
    }

    /// What marching in `steps` uniform steps over the radius finds, and the smooth base.
    pub fn march(&self, steps: u32) -> f64 {
        let step = self.radius_texels / f64::from(steps);
        (1..=steps).map(|i| self.tangent(f64::from(i) * step)).fold(self.floor(), f64::max)
    }

    /// What the near field finds: the slope at once ahead, and the ends of the own cell and of the
    /// one or two after it that begin nearer than [`NEAR_TEXELS`], with the steepest places of the
    /// latter. So it is exact on a flat base, and nearly so on others.
    pub fn near(&self) -> f64 {
        let crossings: Vec<f64> =
            self.crossings(0.0, 4.0).into_iter().filter(|&distance| distance > 1e-9).collect();
        let mut best = self.own_tangent();
        let mut begin = 0.0;
        for (i, &end) in crossings.iter().take(3).enumerate() {
            if i > 0 {
                if begin >= NEAR_TEXELS {
                    break;
                }
                best = best.max(self.tangent(self.steepest(begin, end)));
            }
            best = best.max(self.tangent(end));
            begin = end;
        }
        best.max(NO_HORIZON)
    }

    /// Where between two crossings the line of sight over a flat base is steepest; `end` where that
    /// is not between them. The rise is c0 + c1 d + c2 d^2 there, its slope c0 / d + c1 + c2 d, and
    /// that greatest at sqrt(c0 / c2) if both are negative.
    fn steepest(&self, begin: f64, end: f64) -> f64 {
        let middle = 0.5 * (begin + end);
        let rise = |distance: f64| self.height(distance) - self.height(0.0);
        let [first, second, third] = [begin, middle, end].map(rise);
        let c2 = 2.0 * (first - 2.0 * second + third) / (end - begin).powi(2);
        let c1 = (third - first) / (end - begin) - c2 * (begin + end);
        let c0 = first - c1 * begin - c2 * begin * begin;
        if c0 < 0.0 && c2 < 0.0 { (c0 / c2).sqrt().clamp(begin, end) } else { end }
    }
}
