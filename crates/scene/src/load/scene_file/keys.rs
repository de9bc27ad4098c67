//! The tables and keys of a scene file.

use std::fmt;

use serde::de::{Deserialize, Deserializer, SeqAccess, Visitor};
use toml::{Spanned, Table};

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneKeys {
    pub(super) camera: Option<Spanned<CameraKeys>>,
    pub(super) environment: Option<Spanned<EnvironmentKeys>>,
    #[serde(default)]
    pub(super) light: Vec<Spanned<LightKeys>>,
    #[serde(default)]
    pub(super) object: Vec<Spanned<ObjectKeys>>,
    #[serde(rename = "diffuse-envmap")]
    pub(super) diffuse_envmap: Option<Table>,
    #[serde(rename = "glossy-planes")]
    pub(super) glossy_planes: Option<Table>,
    #[serde(rename = "horizon-shadow")]
    pub(super) horizon_shadow: Option<Table>,
    pub(super) glare: Option<Table>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraKeys {
    pub(super) eye: [f32; 3],
    pub(super) target: [f32; 3],
    pub(super) up: Option<[f32; 3]>,
    pub(super) fov_y_deg: Option<f32>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EnvironmentKeys {
    pub(super) file: Option<String>,
    pub(super) builtin: Option<String>,
    pub(super) intensity: Option<f32>,
    pub(super) rotation_deg: Option<f32>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightKeys {
    pub(super) direction: [f32; 3],
    pub(super) irradiance: OneOr<3>,
    pub(super) angular_diameter_deg: Option<f32>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectKeys {
    pub(super) file: Option<String>,
    pub(super) shape: Option<String>,
    pub(super) translation: Option<[f32; 3]>,
    pub(super) rotation: Option<[f32; 3]>,
    pub(super) scale: Option<OneOr<3>>,
    pub(super) base_color: Option<Vec<f32>>,
    pub(super) metallic: Option<f32>,
    pub(super) roughness: Option<f32>,
    pub(super) ks: Option<OneOr<3>>,
    pub(super) shininess: Option<f32>,
    pub(super) spread_deg: Option<f32>,
    pub(super) height_map: Option<String>,
    pub(super) builtin_height_map: Option<String>,
    pub(super) height_scale: Option<f32>,
    pub(super) uv_scale: Option<OneOr<2>>,
}

/// N numbers, or one that stands for all of them.
#[derive(Clone, Copy)]
pub(super) struct OneOr<const N: usize>(pub(super) [f32; N]);

impl<'de, const N: usize> Deserialize<'de> for OneOr<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OneOrVisitor)
    }
}

struct OneOrVisitor<const N: usize>;

impl<'de, const N: usize> Visitor<'de> for OneOrVisitor<N> {
    type Value = OneOr<N>;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "a number or an array of {N} numbers")
    }

    fn visit_f64<E>(self, number: f64) -> Result<Self::Value, E> {
        Ok(OneOr([number as f32; N]))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Self::Value, E> {
        Ok(OneOr([number as f32; N]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
        let mut numbers = [0.0; N];
        for (index, number) in numbers.iter_mut().enumerate() {
            *number =
                sequence.next_element()?.ok_or_else(|| serde::de::Error::invalid_length(index, &self))?;
        }
        match sequence.next_element::<f32>()? {
            None => Ok(OneOr(numbers)),
            Some(_) => Err(serde::de::Error::invalid_length(N + 1, &self)),
        }
    }
}
