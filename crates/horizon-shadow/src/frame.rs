//! What the host lends for one `prepare`.

use std::ops::Range;

use gpu_context::{Gpu, wgpu};

use crate::{Error, Wrap};

/// Everything that the tables depend on.
#[derive(Clone, Debug)]
pub struct Frame<'a> {
    /// The height map; `None` where the surface has none: then nothing is made and nothing costs.
    pub height_map: Option<HeightMap<'a>>,
    /// The surface that it lies on.
    pub surface: Surface,
    /// Which azimuths are needed, bit i for azimuth i; [`u64::MAX`] for all. Others are neither
    /// searched nor written.
    pub needed_azimuths: u64,
}

/// A height map on the GPU.
#[derive(Clone, Debug)]
pub struct HeightMap<'a> {
    /// A two-dimensional view of any format that a shader can load as f32 (`R8Unorm`,
    /// `R16Float`, `R32Float` ...) that starts at the texture's first level; red counts. Heights
    /// that are not finite count as the least.
    pub view: &'a wgpu::TextureView,
    /// Changed by the host whenever the heights change. While it and the view's texture stay the
    /// same, nothing is baked again.
    pub revision: u64,
    /// Rows that changed since the revision that is one less, `None` where any may have: what does
    /// not depend on others is not baked again. An edit that counts the revision up by more than one
    /// bakes everything.
    pub changed_rows: Option<Range<u32>>,
    /// Least and greatest height of the map, finite; heights beyond are brought into the range.
    pub range: [f32; 2],
    /// Metres between the map's 0 and 1.
    pub height_scale_m: f32,
    /// How often the map repeats over 0..1 of the mesh's uv, along u and v.
    pub uv_scale: [f32; 2],
    /// What lies beyond the map along u and v.
    pub wrap: [Wrap; 2],
}

/// What the tables must suit: see [`crate::frames`] for how it follows from a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Typical length of a texel of the map on the surface, metres.
    pub texel_m: f32,
    /// Least and greatest normal curvature, 1 / metre, convex positive.
    pub curvature_per_m: [f32; 2],
}

impl HeightMap<'_> {
    /// Texels along u and v.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.view.texture().width(), self.view.texture().height()]
    }

    /// Whether shaders can read the view, and every number is one that means something.
    pub(crate) fn check(&self, gpu: &Gpu) -> Result<(), Error> {
        let texture = self.view.texture();
        let unfit = |what, found: String, expected| Err(Error::HeightMap { what, found, expected });
        if texture.dimension() != wgpu::TextureDimension::D2 {
            return unfit("texture", format!("{:?}", texture.dimension()), "two-dimensional");
        }
        if texture.sample_count() != 1 {
            return unfit("sample count", texture.sample_count().to_string(), "1");
        }
        if !texture.usage().contains(wgpu::TextureUsages::TEXTURE_BINDING) {
            return unfit("usage", format!("{:?}", texture.usage()), "one with TEXTURE_BINDING");
        }
        let format = texture.format();
        let sampled = format.sample_type(None, Some(gpu.device().features()));
        if !matches!(sampled, Some(wgpu::TextureSampleType::Float { .. })) {
            let expected = "one that shaders read as floats, such as R32Float, R16Float or R8Unorm";
            return unfit("format", format!("{format:?}"), expected);
        }
        let [least, greatest] = self.range;
        value(
            "range of heights",
            format!("{least}..{greatest}"),
            least.is_finite() && greatest.is_finite() && least <= greatest && (greatest - least).is_finite(),
            "finite numbers, the least first",
        )?;
        let scale = self.height_scale_m;
        value("height_scale_m", scale, (0.0..=1e9).contains(&scale), "0 to 1e9 metres")?;
        let is_scale = |x: f32| x.is_finite() && x != 0.0;
        let [u, v] = self.uv_scale;
        value("uv_scale", format!("{u}, {v}"), is_scale(u) && is_scale(v), "two finite numbers other than 0")
    }
}

impl Surface {
    /// Whether every number is one that means something.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let texel_m = self.texel_m;
        value("texel_m", texel_m, texel_m.is_finite() && texel_m > 0.0, "a finite length above 0 metres")?;
        let [least, greatest] = self.curvature_per_m;
        value(
            "curvature_per_m",
            format!("{least}..{greatest}"),
            least.is_finite() && greatest.is_finite() && least <= greatest,
            "finite numbers, the least first",
        )
    }
}

fn value(
    what: &'static str,
    found: impl std::fmt::Display,
    holds: bool,
    expected: &str,
) -> Result<(), Error> {
    if holds {
        return Ok(());
    }
    Err(Error::Value { what, found: found.to_string(), expected: expected.to_owned() })
}
