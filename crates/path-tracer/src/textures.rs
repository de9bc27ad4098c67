//! Lookups in 8-bit textures.

use glam::DVec2;
use scene::{ColorSpace, Texture, TextureRef, Wrap};

/// The textures of a scene, as they are in memory: 4 bytes a texel.
#[derive(Debug)]
pub(crate) struct Textures {
    textures: Vec<Texture>,
    /// What a byte of a colour means.
    linear_from_srgb: [f64; 256],
}

impl Textures {
    pub(crate) fn new(textures: &[Texture]) -> Self {
        Self {
            textures: textures.to_vec(),
            linear_from_srgb: std::array::from_fn(|byte| linear(byte as f64 / 255.0)),
        }
    }

    /// The texture's value at a uv of the mesh, 1 where there is no texture. Decoded texels are
    /// averaged bilinearly, in the image as it is: there is no mip map, because samples of a pixel
    /// average what it covers.
    pub(crate) fn lookup(&self, reference: Option<&TextureRef>, vertex_uv: DVec2) -> [f64; 4] {
        let Some(reference) = reference else { return [1.0; 4] };
        let Some(texture) = self.textures.get(reference.texture) else { return [1.0; 4] };
        let map = reference.texture_from_vertex_uv.as_daffine2();
        let size = DVec2::new(f64::from(texture.width), f64::from(texture.height));
        let place = map.transform_point2(vertex_uv) * size;
        let texel = |x: f64, y: f64| {
            let column = wrapped(x, texture.width, reference.wrap[0]);
            let row = wrapped(y, texture.height, reference.wrap[1]);
            self.texel(texture, column, row)
        };
        if reference.nearest {
            return texel(place.x.floor(), place.y.floor());
        }
        let corner = (place - 0.5).floor();
        let weight = place - 0.5 - corner;
        let along_row = |y: f64| mix(texel(corner.x, y), texel(corner.x + 1.0, y), weight.x);
        mix(along_row(corner.y), along_row(corner.y + 1.0), weight.y)
    }

    /// The mean of a texture over its image, 1 where there is no texture.
    pub(crate) fn mean(&self, reference: Option<&TextureRef>) -> [f64; 4] {
        let Some(texture) = reference.and_then(|reference| self.textures.get(reference.texture)) else {
            return [1.0; 4];
        };
        let mut sum = [0.0; 4];
        for texel in texture.rgba.as_chunks().0 {
            let value = self.decoded(texture.color_space, *texel);
            sum = std::array::from_fn(|channel| sum[channel] + value[channel]);
        }
        sum.map(|sum| sum / (f64::from(texture.width) * f64::from(texture.height)))
    }

    fn texel(&self, texture: &Texture, column: u32, row: u32) -> [f64; 4] {
        let first = 4 * (row as usize * texture.width as usize + column as usize);
        let bytes = texture.rgba.get(first..first + 4).and_then(|bytes| bytes.try_into().ok());
        self.decoded(texture.color_space, bytes.unwrap_or([0; 4]))
    }

    fn decoded(&self, color_space: ColorSpace, bytes: [u8; 4]) -> [f64; 4] {
        let [r, g, b, a] = bytes;
        let plain = |byte: u8| f64::from(byte) / 255.0;
        let color = |byte: u8| match color_space {
            ColorSpace::Srgb => self.linear_from_srgb[usize::from(byte)],
            ColorSpace::Linear => plain(byte),
        };
        [color(r), color(g), color(b), plain(a)]
    }
}

fn mix(from: [f64; 4], to: [f64; 4], weight: f64) -> [f64; 4] {
    std::array::from_fn(|channel| from[channel] * (1.0 - weight) + to[channel] * weight)
}

/// The column or row that stands for one of any number.
fn wrapped(index: f64, count: u32, wrap: Wrap) -> u32 {
    let count_f = f64::from(count);
    let inside = match wrap {
        Wrap::Repeat => index.rem_euclid(count_f),
        Wrap::Clamp => index,
        Wrap::Mirror => {
            let index = index.rem_euclid(2.0 * count_f);
            if index < count_f { index } else { 2.0 * count_f - 1.0 - index }
        }
    };
    // A cast of what is negative or not a number gives 0.
    (inside as u32).min(count.saturating_sub(1))
}

/// IEC 61966-2-1.
fn linear(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "these numbers are exact")]
mod tests {
    use super::*;
    use glam::Affine2;

    fn textures() -> Textures {
        let ramp = Texture {
            name: "ramp".into(),
            width: 2,
            height: 2,
            rgba: vec![0, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0, 255, 255, 255, 128, 255],
            color_space: ColorSpace::Srgb,
        };
        Textures::new(&[ramp])
    }

    fn reference(wrap: Wrap, nearest: bool) -> TextureRef {
        TextureRef { texture: 0, texture_from_vertex_uv: Affine2::IDENTITY, wrap: [wrap; 2], nearest }
    }

    #[test]
    fn texels_lie_at_their_centres_and_blend_in_linear_light() {
        let (textures, repeat) = (textures(), reference(Wrap::Repeat, false));
        let at = |u, v| textures.lookup(Some(&repeat), DVec2::new(u, v));
        assert_eq!(at(0.25, 0.25), [0.0; 4]);
        assert_eq!(at(0.75, 0.25), [1.0, 0.0, 0.0, 0.0]);
        assert_eq!(at(0.5, 0.25), [0.5, 0.0, 0.0, 0.0]);
        let blue = at(0.75, 0.75)[2];
        assert!((blue - 0.215_860_5).abs() < 1e-6, "{blue}");
        assert_eq!(at(0.5, 0.5), [0.5, 0.5, blue / 4.0, 0.5]);
        assert_eq!(textures.mean(Some(&repeat)), [0.5, 0.5, blue / 4.0, 0.5]);
        assert_eq!(textures.lookup(None, DVec2::ZERO), [1.0; 4]);
    }

    #[test]
    fn what_lies_beyond_the_image_follows_the_wrap_mode() {
        let textures = textures();
        let red = |wrap, nearest, u| textures.lookup(Some(&reference(wrap, nearest)), DVec2::new(u, 0.25))[0];
        assert_eq!([1.25, 1.75, -0.25].map(|u| red(Wrap::Repeat, false, u)), [0.0, 1.0, 1.0]);
        assert_eq!([1.25, 1.75, -0.25].map(|u| red(Wrap::Mirror, false, u)), [1.0, 0.0, 0.0]);
        assert_eq!([1.25, 9.75, -0.25].map(|u| red(Wrap::Clamp, false, u)), [1.0, 1.0, 0.0]);
        assert_eq!(red(Wrap::Repeat, false, 1.0), 0.5);
        assert_eq!(red(Wrap::Mirror, false, 1.0), 1.0);
        assert_eq!([0.01, 0.49, 0.51, 0.99].map(|u| red(Wrap::Clamp, true, u)), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(
            [f64::NAN, f64::INFINITY, 1e300].map(|u| red(Wrap::Repeat, true, u).is_finite()),
            [true; 3]
        );
    }

    #[test]
    fn a_texture_transform_is_applied_before_the_lookup() {
        let textures = textures();
        let mut reference = reference(Wrap::Repeat, true);
        reference.texture_from_vertex_uv =
            Affine2::from_scale_angle_translation(glam::Vec2::splat(0.5), 0.0, glam::Vec2::new(0.5, 0.0));
        assert_eq!(textures.lookup(Some(&reference), DVec2::new(0.1, 0.1))[0], 1.0);
    }
}
