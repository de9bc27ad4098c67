//! Textures from arrays of texels.

use crate::{Error, Gpu, Mipmaps, mip_level_count};
use half::f16;

/// How the colours of 8-bit texels are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// Colour with the sRGB transfer curve; opacity is linear. Shaders read linear values.
    Srgb,
    /// Plain numbers in 0..1.
    Linear,
}

impl Encoding {
    /// The texture format of four 8-bit channels in this encoding.
    pub const fn rgba8_format(self) -> wgpu::TextureFormat {
        match self {
            Self::Srgb => wgpu::TextureFormat::Rgba8UnormSrgb,
            Self::Linear => wgpu::TextureFormat::Rgba8Unorm,
        }
    }
}

/// A two-dimensional texture of `width * height` texels of any uncompressed format of one plane.
///
/// `bytes` holds the rows from the top, tightly packed. With `mips` (made for the same format) the
/// texture has a full mip chain, otherwise one level. It can be sampled and copied to and from.
///
/// [`Error::Limit`] for sizes that the device does not allow, [`Error::Invalid`] where the bytes
/// or `mips` do not fit the texture, [`Error::OutOfMemory`] where it does not fit the memory.
pub fn texture_2d(
    gpu: &Gpu,
    label: &str,
    width: u32,
    height: u32,
    format: wgpu::TextureFormat,
    bytes: &[u8],
    mips: Option<&Mipmaps>,
) -> Result<wgpu::Texture, Error> {
    let texel_bytes = texel_bytes(gpu, label, format)?;
    check_size(gpu, label, width, height)?;
    let expected = u64::from(width) * u64::from(height) * u64::from(texel_bytes);
    if bytes.len() as u64 != expected {
        let expected = format!("{expected} ({width} x {height} texels of {format:?})");
        return Err(Error::invalid(format!("bytes of {label}"), bytes.len().to_string(), expected));
    }
    if let Some(mips) = mips.filter(|mips| mips.format() != format) {
        let found = format!("{:?}", mips.format());
        return Err(Error::invalid(format!("mip chain's format for {label}"), found, format!("{format:?}")));
    }
    let desc = descriptor(label, width, height, format, mips.is_some());
    gpu.checked(label, |device| {
        let texture = device.create_texture(&desc);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(width * texel_bytes),
            rows_per_image: None,
        };
        gpu.queue().write_texture(texture.as_image_copy(), bytes, layout, desc.size);
        fill_mips(gpu, &texture, mips).map(|()| texture)
    })?
}

/// Four 8-bit channels a texel, `4 * width * height` bytes with the rows from the top.
/// Otherwise as [`texture_2d`]; `mips` is made for [`Encoding::rgba8_format`].
pub fn rgba8(
    gpu: &Gpu,
    label: &str,
    width: u32,
    height: u32,
    bytes: &[u8],
    encoding: Encoding,
    mips: Option<&Mipmaps>,
) -> Result<wgpu::Texture, Error> {
    texture_2d(gpu, label, width, height, encoding.rgba8_format(), bytes, mips)
}

/// Four channels of 16-bit floats (`Rgba16Float`), `width * height` texels with the rows from the
/// top. Values are rounded to the nearest half; beyond +-65504 they become +-65504, and NaN
/// becomes 0. Otherwise as [`texture_2d`]; `mips` is made for `Rgba16Float`.
pub fn rgba16_float(
    gpu: &Gpu,
    label: &str,
    width: u32,
    height: u32,
    texels: &[[f32; 4]],
    mips: Option<&Mipmaps>,
) -> Result<wgpu::Texture, Error> {
    let expected = u64::from(width) * u64::from(height);
    if texels.len() as u64 != expected {
        let expected = format!("{expected} ({width} x {height})");
        return Err(Error::invalid(format!("texels of {label}"), texels.len().to_string(), expected));
    }
    // Before the halves take memory.
    check_size(gpu, label, width, height)?;
    let mut halves = Vec::new();
    halves
        .try_reserve_exact(texels.len())
        .map_err(|_| Error::OutOfMemory { what: format!("16-bit texels of {label}") })?;
    halves.extend(texels.iter().map(|texel| texel.map(to_half)));
    let bytes = bytemuck::cast_slice(&halves);
    texture_2d(gpu, label, width, height, wgpu::TextureFormat::Rgba16Float, bytes, mips)
}

/// The nearest finite half; 0 for NaN.
fn to_half(value: f32) -> f16 {
    if value.is_nan() {
        return f16::ZERO;
    }
    f16::from_f32(value.clamp(-f16::MAX.to_f32(), f16::MAX.to_f32()))
}

/// [`Error::Limit`] or [`Error::Invalid`] where a texture of this size cannot be made. Call it
/// before making any texture whose size a user chose.
pub fn check_size(gpu: &Gpu, label: &str, width: u32, height: u32) -> Result<(), Error> {
    let limit = gpu.device().limits().max_texture_dimension_2d;
    for (side, size) in [("width", width), ("height", height)] {
        if size == 0 {
            return Err(Error::invalid(format!("{side} of {label}"), "0", "at least 1"));
        }
        if size > limit {
            let what = format!("{side} of {label} in texels");
            return Err(Error::Limit { what, found: size.into(), limit: limit.into() });
        }
    }
    Ok(())
}

/// Bytes a texel of a format that can be written from an array.
fn texel_bytes(gpu: &Gpu, label: &str, format: wgpu::TextureFormat) -> Result<u32, Error> {
    gpu.require(&format!("{label} ({format:?})"), format.required_features())?;
    let writable = !format.is_compressed() && format.planes().is_none() && format.has_color_aspect();
    format.block_copy_size(None).filter(|_| writable).ok_or_else(|| Error::UnsupportedFormat {
        what: label.to_owned(),
        format,
        supported: "uncompressed colour formats of one plane",
    })
}

fn descriptor(
    label: &str,
    width: u32,
    height: u32,
    format: wgpu::TextureFormat,
    mips: bool,
) -> wgpu::TextureDescriptor<'_> {
    let usage =
        wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC;
    wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: if mips { mip_level_count(width, height) } else { 1 },
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: if mips { usage | Mipmaps::USAGES } else { usage },
        view_formats: &[],
    }
}

fn fill_mips(gpu: &Gpu, texture: &wgpu::Texture, mips: Option<&Mipmaps>) -> Result<(), Error> {
    let Some(mips) = mips else { return Ok(()) };
    let desc = wgpu::CommandEncoderDescriptor { label: Some("mipmap") };
    let mut encoder = gpu.device().create_command_encoder(&desc);
    mips.generate(gpu, &mut encoder, texture)?;
    gpu.queue().submit([encoder.finish()]);
    Ok(())
}
