//! How a surface reflects light: a diffuse and a specular lobe, and a clear coat over them.
//!
//! Directions are unit vectors in the local shading frame, whose z is the normal; both point away
//! from the surface. Nothing is reflected where one of them is not above the horizon.

mod albedo;
mod blinn;
mod ggx;
mod reflectance;
mod round;
mod shape;
#[cfg(test)]
mod tests;

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;

use crate::{Lobe, frame::Frame};
use reflectance::{COAT, Law, Reflectance, coat_share, largest};
use shape::Shape;

/// What decides how a surface reflects. Values out of range are brought into it, and what is not
/// a number counts as absent, or as the default where nothing can be absent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    /// Albedo of the dielectric part, reflectance of the metal part; 0..=1.
    pub(crate) base_color: [f64; 3],
    /// 0 = dielectric, 1 = metal.
    pub(crate) metallic: f64,
    /// Perceptual roughness 0..=1; alpha is its square.
    pub(crate) roughness: f64,
    /// Specular reflectance at normal incidence 0..=1, instead of 0.04 for the dielectric part and
    /// the base colour for the metal part.
    pub(crate) ks: Option<[f64; 3]>,
    /// Blinn exponent, at least 0, instead of 2 / alpha^2 - 2. The Phong cone takes a quarter of it.
    pub(crate) shininess: Option<f64>,
    /// Half-angle of the Phong cone, 0..=pi / 2, instead of where its weight is 1 %.
    pub(crate) spread_rad: Option<f64>,
    /// Strength of the clear coat 0..=1.
    pub(crate) clearcoat: f64,
    /// Perceptual roughness of the clear coat 0..=1.
    pub(crate) clearcoat_roughness: f64,
    /// The clear coat's own normal in the local frame, a unit vector.
    pub(crate) clearcoat_normal: DVec3,
    /// The occlusion texture's value, 0..=1. It dims the diffuse part of
    /// [`Lobe::DiffusedEnvironment`], as that technique does, and nothing else: all other light
    /// is occluded by tracing it.
    pub(crate) ambient_occlusion: f64,
}

impl Default for Parameters {
    /// A white, fully rough dielectric.
    fn default() -> Self {
        Self {
            base_color: [1.0; 3],
            metallic: 0.0,
            roughness: 1.0,
            ks: None,
            shininess: None,
            spread_rad: None,
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
            clearcoat_normal: DVec3::Z,
            ambient_occlusion: 1.0,
        }
    }
}

impl Parameters {
    fn in_range(&self) -> Self {
        let default = Self::default();
        let unit = |value: f64, default: f64| if value.is_nan() { default } else { value.clamp(0.0, 1.0) };
        let rgb = |value: [f64; 3]| value.map(|value| unit(value, 0.0));
        let normal = self.clearcoat_normal;
        Self {
            base_color: rgb(self.base_color),
            metallic: unit(self.metallic, default.metallic),
            roughness: unit(self.roughness, default.roughness),
            ks: self.ks.map(rgb),
            shininess: self.shininess.filter(|n| !n.is_nan()).map(|n| n.max(0.0)),
            spread_rad: self.spread_rad.filter(|angle| !angle.is_nan()).map(|a| a.clamp(0.0, FRAC_PI_2)),
            clearcoat: unit(self.clearcoat, default.clearcoat),
            clearcoat_roughness: unit(self.clearcoat_roughness, default.clearcoat_roughness),
            clearcoat_normal: normal.try_normalize().unwrap_or(default.clearcoat_normal),
            ambient_occlusion: unit(self.ambient_occlusion, default.ambient_occlusion),
        }
    }
}

/// A direction drawn by [`Bsdf::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sampled {
    /// Where the light comes from; above the horizon.
    pub(crate) incoming: DVec3,
    /// What to multiply its radiance by: BSDF times cosine over density.
    pub(crate) weight: [f64; 3],
    /// Density per steradian of all lobes together, above 0. For a mirror direction, the chance
    /// that it was chosen, which is not comparable with a density.
    pub(crate) pdf: f64,
    /// Whether it is a mirror direction, which no other sampler can find.
    pub(crate) is_delta: bool,
}

/// The value of a [`Bsdf`] for two directions, mirrors left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Evaluated {
    /// BSDF times the incoming direction's cosine, per steradian.
    pub(crate) value: [f64; 3],
    /// Density per steradian with which [`Bsdf::sample`] finds the incoming direction.
    pub(crate) pdf: f64,
}

/// The reflection of one point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bsdf {
    specular: Shape,
    reflectance: Reflectance,
    coat: Option<Coat>,
}

/// A clear coat (`KHR_materials_clearcoat`): its lobe takes the place of everything below by a
/// share that depends on the outgoing direction alone. So a coated surface is not reciprocal.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Coat {
    shape: Shape,
    strength: f64,
    roughness: f64,
    lobe: Lobe,
    frame: Frame,
}

/// The lobes of a [`Bsdf`] in the order in which chances are listed.
const DIFFUSE: usize = 0;
const SPECULAR: usize = 1;
const COATING: usize = 2;

/// A lobe that reflects anything at all is drawn at least this often beside the other one below
/// the coat, because its share was estimated for the mirror direction only.
const LEAST_CHANCE: f64 = 0.1;

impl Bsdf {
    /// The reflection of a material whose specular part is `lobe`.
    ///
    /// With [`Lobe::Ggx`] it is glTF 2.0's metallic-roughness material (appendix B). The specular
    /// lobe is that of the appendix's sample implementation: microfacets lose what they would
    /// reflect twice. The diffuse lobe is not: there Fresnel's term at the half vector says what
    /// reaches it, by which a smooth white surface reflects up to 1.85 times the light that falls
    /// on it at 89 degrees. Here light reaches it that the specular lobe does not reflect, on the way in and
    /// on the way out, and a white dielectric reflects exactly all light. The other lobes have the specular reflectance that their technique gives them: constant for
    /// Blinn and for the Phong cone, Karis's fit for the diffused environment.
    pub(crate) fn new(parameters: &Parameters, lobe: Lobe) -> Self {
        let parameters = parameters.in_range();
        let Parameters { base_color, metallic, roughness, ks, .. } = parameters;
        let open = if lobe == Lobe::DiffusedEnvironment { parameters.ambient_occlusion } else { 1.0 };
        let coat = Coat {
            shape: Shape::coat(parameters.clearcoat_roughness, lobe),
            strength: parameters.clearcoat,
            roughness: parameters.clearcoat_roughness,
            lobe,
            frame: Frame::new(parameters.clearcoat_normal),
        };
        Self {
            specular: Shape::specular(&parameters, lobe),
            reflectance: Reflectance {
                law: Law::new(lobe, roughness, ks),
                dielectric: ks.unwrap_or([COAT; 3]),
                metal: ks.unwrap_or(base_color),
                metallic,
                diffuse: base_color.map(|albedo| albedo * (1.0 - metallic) * open),
            },
            coat: (coat.strength > 0.0).then_some(coat),
        }
    }

    /// Draws an incoming direction from three numbers of 0..1. None where nothing is reflected, or
    /// where the drawn direction is below the horizon: an outcome like any other, of weight 0.
    pub(crate) fn sample(&self, outgoing: DVec3, u: [f64; 3]) -> Option<Sampled> {
        if !is_above(outgoing) {
            return None;
        }
        let u = u.map(|u| if u >= 0.0 { u.min(1.0 - f64::EPSILON) } else { 0.0 });
        let chances = self.chances(outgoing);
        let chosen = choose(chances, u[2])?;
        let (shape, incoming) = match (chosen, &self.coat) {
            (COATING, Some(coat)) => (coat.shape, coat.sample(outgoing, [u[0], u[1]])?),
            (DIFFUSE, _) => (Shape::Lambert, Shape::Lambert.sample(outgoing, [u[0], u[1]])),
            _ => (self.specular, self.specular.sample(outgoing, [u[0], u[1]])),
        };
        if !is_above(incoming) {
            return None;
        }
        if shape.is_delta() {
            let pdf = chances[chosen];
            let weight = self.mirror_share(outgoing, chosen).map(|share| share / pdf);
            return Some(Sampled { incoming, weight, pdf, is_delta: true });
        }
        let Evaluated { value, pdf } = self.evaluate(outgoing, incoming);
        (pdf > 0.0).then(|| Sampled { incoming, weight: value.map(|v| v / pdf), pdf, is_delta: false })
    }

    /// The value for two directions, and the density with which the second is drawn for the first.
    pub(crate) fn evaluate(&self, outgoing: DVec3, incoming: DVec3) -> Evaluated {
        if !(is_above(outgoing) && is_above(incoming)) {
            return Evaluated::default();
        }
        let chances = self.chances(outgoing);
        let below = self.transmitted_by_coat(outgoing);
        let cos_half = outgoing.dot(half_vector(outgoing, incoming));
        let split = self.reflectance.split(cos_half, outgoing.z, incoming.z);
        let [diffuse, diffuse_pdf] = Shape::Lambert.evaluate(outgoing, incoming);
        let [specular, specular_pdf] = self.specular.evaluate(outgoing, incoming);
        let [coat, coat_pdf] = self.coat.map_or([0.0; 2], |coat| coat.evaluate(outgoing, incoming));
        Evaluated {
            value: std::array::from_fn(|i| {
                below * (split.diffuse[i] * diffuse + split.specular[i] * specular) + coat
            }),
            pdf: chances[DIFFUSE] * diffuse_pdf
                + chances[SPECULAR] * specular_pdf
                + chances[COATING] * coat_pdf,
        }
    }

    /// Whether all reflection is that of perfect mirrors, which only [`Self::sample`] finds.
    pub(crate) fn is_delta_only(&self) -> bool {
        (self.specular.is_delta() || !self.reflectance.has_specular())
            && !self.reflectance.has_diffuse()
            && self.coat.is_none_or(|coat| coat.shape.is_delta())
    }

    /// The share of what is below the clear coat, emission included, that leaves it.
    pub(crate) fn transmitted_by_coat(&self, outgoing: DVec3) -> f64 {
        self.coat.map_or(1.0, |coat| 1.0 - coat.share(outgoing))
    }

    /// Chances of the lobes: in proportion to what each would reflect of an even light, roughly.
    /// They sum to one, or are all zero where nothing is reflected.
    fn chances(&self, outgoing: DVec3) -> [f64; 3] {
        let split = self.reflectance.split(outgoing.z, outgoing.z, outgoing.z);
        let (diffuse, specular) = (largest(split.diffuse), largest(split.specular));
        let at_least = |share: f64, possible: bool, other: f64| {
            if possible { share.max(LEAST_CHANCE * other).max(1e-6) } else { 0.0 }
        };
        let below = self.transmitted_by_coat(outgoing);
        let shares = [
            below * at_least(diffuse, self.reflectance.has_diffuse(), specular),
            below * at_least(specular, self.reflectance.has_specular(), diffuse),
            1.0 - below,
        ];
        let total: f64 = shares.iter().sum();
        if total > 0.0 { shares.map(|share| share / total) } else { [0.0; 3] }
    }

    /// What a chosen mirror reflects of its direction's radiance.
    fn mirror_share(&self, outgoing: DVec3, chosen: usize) -> [f64; 3] {
        let below = self.transmitted_by_coat(outgoing);
        if chosen == COATING {
            return [1.0 - below; 3];
        }
        self.reflectance.split(outgoing.z, outgoing.z, outgoing.z).specular.map(|share| share * below)
    }
}

impl Coat {
    /// The share of light that the coat reflects.
    fn share(&self, outgoing: DVec3) -> f64 {
        let cosine = outgoing.dot(self.frame.z).abs().min(1.0);
        self.strength * coat_share(self.lobe, self.roughness, cosine)
    }

    /// A direction on the same side of the coat's relief as `outgoing`; seen from behind, the
    /// relief shows no reflection.
    fn sample(&self, outgoing: DVec3, u: [f64; 2]) -> Option<DVec3> {
        let outgoing = Some(self.frame.local_from_world(outgoing)).filter(|local| is_above(*local))?;
        let incoming = Some(self.shape.sample(outgoing, u)).filter(|local| is_above(*local))?;
        Some(self.frame.world_from_local(incoming))
    }

    /// Value, with the coat's share, and density.
    fn evaluate(&self, outgoing: DVec3, incoming: DVec3) -> [f64; 2] {
        let local = |v| self.frame.local_from_world(v);
        let [value, pdf] = self.shape.evaluate(local(outgoing), local(incoming));
        [self.share(outgoing) * value, pdf]
    }
}

/// The first entry at which the running sum of `chances` exceeds `u`; None if all are zero.
fn choose(chances: [f64; 3], u: f64) -> Option<usize> {
    let mut sum = 0.0;
    let found = chances.iter().position(|&chance| {
        sum += chance;
        chance > 0.0 && u < sum
    });
    // Rounding may leave the sum below u.
    found.or_else(|| chances.iter().rposition(|&chance| chance > 0.0))
}

/// Above the horizon, and a number.
fn is_above(direction: DVec3) -> bool {
    direction.z > 0.0 && direction.is_finite()
}

/// The mirror direction about z.
fn mirrored(outgoing: DVec3) -> DVec3 {
    DVec3::new(-outgoing.x, -outgoing.y, outgoing.z)
}

/// The direction half-way between two; z where they cancel.
fn half_vector(a: DVec3, b: DVec3) -> DVec3 {
    (a + b).try_normalize().unwrap_or(DVec3::Z)
}

/// A direction by sine and cosine of its angle from z, and its share of a turn.
fn azimuthal(sine: f64, cosine: f64, turn: f64) -> DVec3 {
    let (y, x) = (TAU * turn).sin_cos();
    DVec3::new(sine * x, sine * y, cosine)
}
