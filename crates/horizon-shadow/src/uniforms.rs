//! The uniform buffers, bit for bit as the shaders declare them.

use bytemuck::{Pod, Zeroable};

use crate::{
    settings::{Method, Settings, Tables},
    tables::{Contents, Precision, TableDesc, Wrap},
};

/// `HorizonShadowParameters` of `tables-library.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct Parameters {
    pub(crate) size: [f32; 2],
    pub(crate) uv_scale: [f32; 2],
    pub(crate) least_height: f32,
    pub(crate) greatest_height: f32,
    pub(crate) height_scale_m: f32,
    pub(crate) texels_per_height: f32,
    pub(crate) least_curvature: f32,
    pub(crate) greatest_curvature: f32,
    pub(crate) radius_texels: f32,
    pub(crate) slope_scale: f32,
    pub(crate) azimuths: u32,
    pub(crate) candidates: u32,
    pub(crate) contents: u32,
    pub(crate) wrap: u32,
    pub(crate) baked_azimuths: [u32; 2],
    pub(crate) method: u32,
    pub(crate) march_steps: u32,
    pub(crate) flags: u32,
    pub(crate) reserved: [u32; 3],
}

/// What the tables at hand hold besides horizons, and how the heights lie on the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Relief {
    /// Least and greatest height of the map, its own values.
    pub(crate) range: [f32; 2],
    /// Metres between the map's 0 and 1.
    pub(crate) height_scale_m: f32,
    /// How often the map repeats over 0..1 of the mesh's uv.
    pub(crate) uv_scale: [f32; 2],
    /// Slope at which half of the slope code's range is used.
    pub(crate) slope_scale: f32,
    /// Bit i: azimuth i is baked.
    pub(crate) baked_azimuths: u64,
    /// Whether there are moments, ambient occlusion and extents of tiles.
    pub(crate) has_moments: bool,
    pub(crate) has_ambient: bool,
    pub(crate) has_extents: bool,
}

const WRAP_U: u32 = 1;
const WRAP_V: u32 = 2;
const FLAG_PREFILTER: u32 = 1;
const FLAG_AMBIENT: u32 = 2;
const FLAG_EXTENTS: u32 = 4;

/// The most steps of [`Method::Marched`]; more would hang a GPU for no visible gain.
const MAX_MARCH_STEPS: u32 = 1024;

/// `value` in a range, and `fallback` where it is not a number.
fn bounded(value: f32, least: f32, greatest: f32, fallback: f32) -> f32 {
    if value.is_nan() { fallback } else { value.clamp(least, greatest) }
}

impl Parameters {
    /// Values out of range are brought into it, so that no shader meets what is not finite.
    pub(crate) fn new(settings: &Settings, desc: &TableDesc, relief: &Relief) -> Self {
        let [least_height, greatest_height] = relief.range.map(|height| bounded(height, -1e9, 1e9, 0.0));
        let [low, high] = desc.curvature_per_texel.map(|kappa| bounded(kappa, -1e3, 1e3, 0.0));
        let wrap = |index: usize, bit| if desc.wrap[index] == Wrap::Repeat { bit } else { 0 };
        let flag = |condition: bool, bit| if condition { bit } else { 0 };
        let scale = |scale: f32| {
            if scale.is_finite() && scale != 0.0 { scale.clamp(-1e6, 1e6) } else { 1.0 }
        };
        #[allow(clippy::cast_precision_loss, reason = "sizes of textures are far below 2^24")]
        let size = desc.size.map(|texels| texels.max(1) as f32);
        Self {
            size,
            uv_scale: relief.uv_scale.map(scale),
            least_height,
            greatest_height: greatest_height.max(least_height),
            height_scale_m: bounded(relief.height_scale_m, 0.0, 1e9, 0.0),
            texels_per_height: bounded(desc.texels_per_height, 0.0, 1e9, 0.0),
            least_curvature: low.min(high),
            greatest_curvature: high.max(low),
            radius_texels: bounded(desc.radius_texels, 2.0, 4096.0, 2.0),
            slope_scale: bounded(relief.slope_scale, 1e-6, 1e6, 1.0),
            azimuths: desc.azimuths.clamp(4, 64),
            candidates: match desc.contents {
                Contents::Candidates { count, .. } => count.clamp(1, 4),
                _ => 0,
            },
            contents: contents_code(desc.contents),
            wrap: wrap(0, WRAP_U) | wrap(1, WRAP_V),
            baked_azimuths: [
                (relief.baked_azimuths & u64::from(u32::MAX)) as u32,
                (relief.baked_azimuths >> 32) as u32,
            ],
            method: method_code(settings.method),
            march_steps: settings.march_steps.clamp(1, MAX_MARCH_STEPS),
            flags: flag(settings.prefilter && relief.has_moments, FLAG_PREFILTER)
                | flag(settings.ambient && relief.has_ambient, FLAG_AMBIENT)
                | flag(relief.has_extents, FLAG_EXTENTS),
            reserved: [0; 3],
        }
    }
}

/// What a pipeline fixes of the parameters: compilers leave out what such a surface does not need,
/// and software adapters run both sides of the branches that are left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Variant {
    method: u32,
    contents: u32,
    candidates: u32,
    flags: u32,
}

impl Variant {
    /// Values of the `override` constants of `visibility.wgsl`.
    pub(crate) fn constants(self) -> [(&'static str, f64); 4] {
        [
            ("method", self.method.into()),
            ("contents", self.contents.into()),
            ("candidate_count", self.candidates.into()),
            ("flags", self.flags.into()),
        ]
    }
}

impl From<&Parameters> for Variant {
    fn from(parameters: &Parameters) -> Self {
        let Parameters { method, contents, candidates, flags, .. } = *parameters;
        Self { method, contents, candidates, flags }
    }
}

/// `HORIZON_SHADOW_CONTENTS_*` of `tables-library.wgsl`.
pub(crate) fn contents_code(contents: Contents) -> u32 {
    match contents {
        Contents::Flat => 0,
        Contents::Published(Tables::BetaAndDistance) => 1,
        Contents::Published(Tables::DistanceAndHeight) => 2,
        Contents::Candidates { precision: Precision::Compact, .. } => 3,
        Contents::Candidates { precision: Precision::Full, .. } => 4,
    }
}

/// `HORIZON_SHADOW_METHOD_*` of `tables-library.wgsl`.
pub(crate) fn method_code(method: Method) -> u32 {
    match method {
        Method::None => 0,
        Method::Flat => 1,
        Method::Paper => 2,
        Method::Exact => 3,
        Method::Sheen => 4,
        Method::Certified => 5,
        Method::Marched => 6,
    }
}

#[cfg(test)]
mod tests {
    use std::mem::{offset_of, size_of};

    use super::*;

    /// Name and offset of each member of a struct of a module, and the struct's size.
    fn layout(module: &shaders::Module, name: &str) -> (Vec<(String, usize)>, usize) {
        let parsed = naga::front::wgsl::parse_str(&module.source()).expect("the shader parses");
        let (members, span) = parsed
            .types
            .iter()
            .find_map(|(_, ty)| match (&ty.name, &ty.inner) {
                (Some(found), naga::TypeInner::Struct { members, span }) if found == name => {
                    Some((members, span))
                }
                _ => None,
            })
            .expect("the struct exists");
        let members =
            members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize)).collect();
        (members, *span as usize)
    }

    macro_rules! offsets {
        ($type:ty: $($field:ident)*) => {
            vec![$((stringify!($field).to_owned(), offset_of!($type, $field))),*]
        };
    }

    #[test]
    fn the_parameters_match_the_shader() {
        let (members, size) = layout(&shaders::HORIZON_SHADOW_TABLES, "HorizonShadowParameters");
        assert_eq!(size, size_of::<Parameters>());
        let mut expected = offsets!(Parameters: size uv_scale least_height greatest_height height_scale_m
            texels_per_height least_curvature greatest_curvature radius_texels slope_scale azimuths candidates
            contents wrap baked_azimuths method march_steps flags);
        let reserved = offset_of!(Parameters, reserved);
        expected.extend((0..3).map(|i| (format!("reserved_{i}"), reserved + 4 * i)));
        assert_eq!(members, expected);
    }

    /// The value of a constant of the shaders' tables module.
    fn constant(name: &str) -> u32 {
        let text = shaders::HORIZON_SHADOW_TABLES.text;
        let line = text.lines().find(|line| line.starts_with(&format!("const {name}: u32"))).expect(name);
        let value = line.rsplit('=').next().expect("a value").trim().trim_end_matches("u;");
        value.parse().expect("a whole number")
    }

    #[test]
    fn the_codes_match_the_shader() {
        let methods = [
            (Method::None, "NONE"),
            (Method::Flat, "FLAT"),
            (Method::Paper, "PAPER"),
            (Method::Exact, "EXACT"),
            (Method::Sheen, "SHEEN"),
            (Method::Certified, "CERTIFIED"),
            (Method::Marched, "MARCHED"),
        ];
        for (method, name) in methods {
            assert_eq!(method_code(method), constant(&format!("HORIZON_SHADOW_METHOD_{name}")));
        }
        let candidates = |precision| Contents::Candidates { count: 2, precision };
        let contents = [
            (Contents::Flat, "FLAT"),
            (Contents::Published(Tables::BetaAndDistance), "BETA_AND_DISTANCE"),
            (Contents::Published(Tables::DistanceAndHeight), "DISTANCE_AND_HEIGHT"),
            (candidates(Precision::Compact), "COMPACT"),
            (candidates(Precision::Full), "FULL"),
        ];
        for (contents, name) in contents {
            assert_eq!(contents_code(contents), constant(&format!("HORIZON_SHADOW_CONTENTS_{name}")));
        }
        let flags = [("PREFILTER", FLAG_PREFILTER), ("AMBIENT", FLAG_AMBIENT), ("EXTENTS", FLAG_EXTENTS)];
        for (name, flag) in flags {
            assert_eq!(flag, constant(&format!("HORIZON_SHADOW_FLAG_{name}")));
        }
    }

    #[test]
    fn no_value_leaves_its_range() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -1.0, 1e30, -1e30, 1e-30];
        for value in odd {
            let desc = TableDesc {
                size: [0, 0],
                azimuths: 0,
                contents: Contents::Candidates { count: 9, precision: Precision::Compact },
                wrap: [Wrap::Repeat, Wrap::Clamp],
                curvature_per_texel: [value, -value],
                texels_per_height: value,
                radius_texels: value,
            };
            let relief = Relief {
                range: [value, -value],
                height_scale_m: value,
                uv_scale: [value, value],
                slope_scale: value,
                baked_azimuths: 1 << 40,
                has_moments: true,
                has_ambient: true,
                has_extents: false,
            };
            let found = Parameters::new(&Settings { march_steps: 0, ..Settings::SHEEN }, &desc, &relief);
            let floats: &[f32] = bytemuck::cast_slice(&bytemuck::bytes_of(&found)[..48]);
            assert!(floats.iter().all(|x| x.is_finite()), "{value}: {found:?}");
            assert!(found.greatest_height >= found.least_height && found.uv_scale.iter().all(|&s| s != 0.0));
            assert!(found.least_curvature <= found.greatest_curvature && found.radius_texels >= 2.0);
            assert!(
                found.size.iter().all(|&texels| texels >= 1.0)
                    && found.azimuths == 4
                    && found.candidates == 4
            );
            assert_eq!((found.march_steps, found.baked_azimuths, found.wrap), (1, [0, 256], 1));
            assert_eq!(found.flags, FLAG_PREFILTER);
        }
    }
}
