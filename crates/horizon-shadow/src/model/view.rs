//! A light in the frame of a surface point.

/// How a height map lies on a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Map {
    /// Texels along u and v.
    pub size: [f64; 2],
    /// How often it repeats over 0..1 of the mesh's uv.
    pub uv_scale: [f64; 2],
    /// Metres between the map's 0 and 1.
    pub height_scale_m: f64,
    /// The same in texels, as the tables were baked.
    pub texels_per_height: f64,
}

/// A point of the base surface.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Texture coordinates of the mesh.
    pub uv: [f64; 2],
    /// Normal, of any length above 0.
    pub normal: [f64; 3],
    /// Change of the position along the mesh's u and v, metres per unit.
    pub along_u: [f64; 3],
    /// Along v.
    pub along_v: [f64; 3],
    /// Second fundamental form in those: II(u,u), II(u,v), II(v,v), metres, convex positive.
    pub second_form: [f64; 3],
}

/// What the light's azimuth makes of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The point in texels, centres at whole numbers.
    pub at: [f64; 2],
    /// Unit direction towards the light in texels.
    pub direction: [f64; 2],
    /// How that changes with a texel of height above the base, because normals ahead lean sideways.
    pub turn: [f64; 2],
    /// L.N: sine of the light's elevation.
    pub sine: f64,
    /// |V|: its cosine.
    pub cosine: f64,
    /// Normal curvature along the azimuth, 1 / texel.
    pub kappa: f64,
    /// Metres of a texel along the azimuth.
    pub texel_m: f64,
    /// Texels between the map's 0 and 1 along the azimuth.
    pub texels_per_height: f64,
}

type Vec3 = [f64; 3];

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: Vec3, b: Vec3, times: f64) -> Vec3 {
    [0, 1, 2].map(|i| a[i] - times * b[i])
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// Tangent vectors of the map's uv, without their parts along the unit normal, and their metric.
struct Tangents {
    normal: Vec3,
    u: Vec3,
    v: Vec3,
    metric: [f64; 3],
    determinant: f64,
}

impl Tangents {
    fn new(map: &Map, point: &Point) -> Option<Self> {
        let size = length(point.normal);
        let normal = point.normal.map(|c| c / size);
        let tangent = |along: Vec3, scale: f64| {
            let scaled = along.map(|c| c / scale);
            minus(scaled, normal, dot(scaled, normal))
        };
        let u = tangent(point.along_u, map.uv_scale[0]);
        let v = tangent(point.along_v, map.uv_scale[1]);
        let [e, f, g] = [dot(u, u), dot(u, v), dot(v, v)];
        let determinant = e * g - f * f;
        // Written so that what is not a number has no metric either.
        (determinant > 1e-12 * e * g).then_some(Self { normal, u, v, metric: [e, f, g], determinant })
    }

    /// Contravariant components of a vector: uv per unit of it.
    fn components(&self, vector: Vec3) -> [f64; 2] {
        let [e, f, g] = self.metric;
        let (u, v) = (dot(vector, self.u), dot(vector, self.v));
        [(g * u - f * v) / self.determinant, (e * v - f * u) / self.determinant]
    }
}

impl View {
    /// `None` where the surface has no metric (the parametrisation collapses), so that nobody can
    /// say where the relief lies.
    pub fn new(map: &Map, point: &Point, light: [f64; 3]) -> Option<Self> {
        let tangents = Tangents::new(map, point)?;
        let sine = dot(light, tangents.normal);
        let tangential = minus(light, tangents.normal, sine);
        let cosine = length(tangential);
        // At the zenith every azimuth will do.
        let towards = if cosine > 1e-6 { tangential } else { tangents.u };
        let [lu, lv] = tangents.components(towards);
        let texels = [lu * map.size[0], lv * map.size[1]];
        let rate = texels[0].hypot(texels[1]);
        let texel_m = length(towards) / rate;
        let [e, f, g] = point.second_form;
        let [su, sv] = [lu / map.uv_scale[0], lv / map.uv_scale[1]];
        let bending = (e * su * su + 2.0 * f * su * sv + g * sv * sv) / dot(towards, towards);
        // The tangent vector to the left of `towards`, as long as that, and the geodesic torsion.
        let [wu, wv] = tangents.components(cross(tangents.normal, towards));
        let left = [wu / map.uv_scale[0], wv / map.uv_scale[1]];
        let mixed = e * su * left[0] + f * (su * left[1] + sv * left[0]) + g * sv * left[1];
        let torsion = mixed / dot(towards, towards) * texel_m;
        let turn = [wu * map.size[0], wv * map.size[1]].map(|c| -torsion * c / rate);
        let at = |i: usize| point.uv[i] * map.uv_scale[i] * map.size[i] - 0.5;
        Some(Self {
            at: [at(0), at(1)],
            direction: texels.map(|c| c / rate),
            turn,
            sine,
            cosine,
            kappa: bending * texel_m,
            texel_m,
            texels_per_height: map.height_scale_m / texel_m,
        })
    }

    /// The same towards points that lie so many units of the map above the base's own level: what
    /// Sheen's methods look along, with the height of the point itself.
    ///
    /// With t the unit vector towards the light, w = n x t and the geodesic torsion tau = II(t, w),
    /// the normal at x t + y w leans by tau x towards w, to first order, so that what stands `height`
    /// high there is in the light's plane where y = -tau height x. Distances still are those along t.
    #[must_use]
    pub fn turned(&self, height: f64) -> Self {
        let lean = self.turn.map(|c| c * self.texels_per_height * height);
        // Shorter than the direction, so that some direction is left, however thick the relief.
        let part = (0.75 / lean[0].hypot(lean[1]).max(1e-6)).min(1.0);
        let way = [0, 1].map(|i| self.direction[i] + part * lean[i]);
        // Texels of the turned azimuth for one of the light's.
        let longer = way[0].hypot(way[1]);
        Self {
            direction: way.map(|c| c / longer),
            kappa: self.kappa / longer,
            texel_m: self.texel_m / longer,
            texels_per_height: self.texels_per_height * longer,
            ..*self
        }
    }

    /// Texels between the map's 0 and 1 against those of the bake: what slopes of the tables are
    /// multiplied by.
    pub fn steepening(&self, map: &Map) -> f64 {
        self.texels_per_height / map.texels_per_height
    }
}

impl Point {
    /// Unit normal of a relief whose height in metres changes by `slopes` a unit of the map's uv:
    /// `N - h_u U - h_v V` with the dual basis of the map's uv (Blinn). The base's own normal where the
    /// point has no metric.
    pub fn bump_normal(&self, map: &Map, slopes: [f64; 2]) -> [f64; 3] {
        let size = length(self.normal);
        let Some(tangents) = Tangents::new(map, self) else {
            return self.normal.map(|c| c / size);
        };
        let [e, f, g] = tangents.metric;
        let rise_u = (g * slopes[0] - f * slopes[1]) / tangents.determinant;
        let rise_v = (e * slopes[1] - f * slopes[0]) / tangents.determinant;
        let bumped = minus(minus(tangents.normal, tangents.u, rise_u), tangents.v, rise_v);
        let size = length(bumped);
        bumped.map(|c| c / size)
    }
}
