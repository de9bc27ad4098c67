//! How a material's light divides into the specular lobe and the diffuse one below it.

use super::albedo;
use crate::Lobe;

type Rgb = [f64; 3];

/// Reflectances at normal incidence, and how they grow towards grazing incidence.
///
/// A material is a mixture of a dielectric and a metal. Of the dielectric, what the specular lobe
/// reflects (its largest channel, so that no hue arises) does not reach the diffuse lobe, neither
/// on the way in nor on the way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reflectance {
    pub(super) law: Law,
    pub(super) dielectric: Rgb,
    pub(super) metal: Rgb,
    pub(super) metallic: f64,
    /// The diffuse lobe's albedo before the specular lobe takes its part.
    pub(super) diffuse: Rgb,
}

/// How specular reflectance depends on direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Law {
    /// Schlick 1994, eq. 15, over the angle to the half vector, up to this reflectance at grazing
    /// incidence (1 in glTF). Of a GGX lobe.
    Schlick { roughness: f64, grazing: f64 },
    /// The same from everywhere, as in the papers of the Blinn lobe and of the Phong cone.
    Constant,
    /// Karis 2014, "Physically Based Shading on Mobile": GGX's total under Schlick's law, fitted
    /// over roughness and n.v. It belongs to the outgoing direction alone.
    SplitSum { roughness: f64 },
}

/// Shares of the two lobes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Split {
    pub(crate) specular: Rgb,
    pub(crate) diffuse: Rgb,
}

impl Reflectance {
    /// `cos_half` is the cosine between either direction and the half vector, `cos_outgoing` and
    /// `cos_incoming` those between the directions and the normal.
    pub(crate) fn split(&self, cos_half: f64, cos_outgoing: f64, cos_incoming: f64) -> Split {
        let mixed = mix(self.dielectric, self.metal, self.metallic);
        let (specular, transmitted) = match self.law {
            Law::Schlick { roughness, grazing } => (
                schlick(mixed, grazing, cos_half),
                self.coupling(roughness, grazing, cos_outgoing, cos_incoming),
            ),
            Law::Constant => (mixed, 1.0 - largest(self.dielectric)),
            Law::SplitSum { roughness } => {
                let total = split_sum(mixed, roughness, cos_outgoing);
                (total, 1.0 - largest(total))
            }
        };
        Split { specular, diffuse: self.diffuse.map(|albedo| albedo * transmitted) }
    }

    /// The factor of the diffuse lobe below a specular one: what the latter does not reflect on the
    /// way in, times the same on the way out, over its mean, because light that is reflected back
    /// inside tries again (Shirley et al. 1997, "A practitioners' assessment of light reflection
    /// models", with the totals of a rough lobe, as in Kulla and Conty 2017). It is reciprocal, and
    /// a white surface reflects exactly all light in sum.
    fn coupling(&self, roughness: f64, grazing: f64, cos_outgoing: f64, cos_incoming: f64) -> f64 {
        let normal = largest(self.dielectric);
        let passed = |cosine| 1.0 - albedo::directional(roughness, cosine, normal, grazing);
        let mean = 1.0 - albedo::mean(roughness, normal, grazing);
        if mean > 0.0 { passed(cos_outgoing) * passed(cos_incoming) / mean } else { 0.0 }
    }

    /// Whether any direction is reflected by the specular lobe.
    pub(crate) fn has_specular(&self) -> bool {
        let grazing = matches!(self.law, Law::Schlick { grazing, .. } if grazing > 0.0);
        grazing || largest(mix(self.dielectric, self.metal, self.metallic)) > 0.0
    }

    /// Whether any light reaches the diffuse lobe.
    pub(crate) fn has_diffuse(&self) -> bool {
        largest(self.diffuse) > 0.0 && (largest(self.dielectric) < 1.0 || self.law != Law::Constant)
    }
}

impl Law {
    /// The law of a lobe. `ks` is an explicit reflectance: where it is below 0.02, which no real
    /// surface is, grazing reflectance falls with it to zero, so that ks = 0 means no reflection.
    pub(super) fn new(lobe: Lobe, roughness: f64, ks: Option<Rgb>) -> Self {
        match lobe {
            Lobe::Ggx => Self::Schlick { roughness, grazing: ks.map_or(1.0, real_surface) },
            Lobe::Blinn | Lobe::PhongCone => Self::Constant,
            Lobe::DiffusedEnvironment => Self::SplitSum { roughness },
        }
    }
}

/// Reflectance of a clear coat (a refractive index of 1.5) at normal incidence.
pub(super) const COAT: f64 = 0.04;

/// The share of light that a clear coat of full strength reflects in all. glTF's extension takes
/// Schlick's law at n.v; the diffuse-envmap technique its own total.
pub(super) fn coat_share(lobe: Lobe, roughness: f64, cos_outgoing: f64) -> f64 {
    match lobe {
        Lobe::DiffusedEnvironment => split_sum([COAT; 3], roughness, cos_outgoing)[0],
        Lobe::Ggx | Lobe::Blinn | Lobe::PhongCone => schlick([COAT; 3], 1.0, cos_outgoing)[0],
    }
}

fn schlick(normal: Rgb, grazing: f64, cosine: f64) -> Rgb {
    let away = (1.0 - cosine).clamp(0.0, 1.0).powi(5);
    normal.map(|normal| normal + (grazing - normal) * away)
}

fn split_sum(ks: Rgb, roughness: f64, cosine: f64) -> Rgb {
    let smooth = 1.0 - roughness;
    let a = (smooth * smooth).min((-9.28 * cosine).exp2()) * smooth + 0.0425 - 0.0275 * roughness;
    let scale = 1.04 - 0.572 * roughness - 1.04 * a;
    let offset = (1.04 * a - 0.04 + 0.022 * roughness) * real_surface(ks);
    ks.map(|ks| (ks * scale + offset).clamp(0.0, 1.0))
}

/// 1 for all reflectances that exist, falling to 0 from 0.02 down (Lagarde and de Rousiers 2014,
/// "Moving Frostbite to Physically Based Rendering", section 3.2).
fn real_surface(ks: Rgb) -> f64 {
    (50.0 * largest(ks)).min(1.0)
}

pub(super) fn mix(a: Rgb, b: Rgb, share: f64) -> Rgb {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
}

pub(super) fn largest(rgb: Rgb) -> f64 {
    rgb[0].max(rgb[1]).max(rgb[2])
}
