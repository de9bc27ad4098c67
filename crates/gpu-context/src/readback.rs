//! Texels and bytes from the GPU to the host. Each call submits a copy and waits for it.

use crate::{Error, Gpu};
use half::f16;
use std::sync::mpsc;
use wgpu::TextureFormat as Format;

/// Bytes of the buffer through which data passes; larger reads take several copies.
const STAGING_BYTES: u64 = 32 << 20;

/// An image of floats on the host.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatImage {
    /// Texels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Values per texel: 1 to 4, as the format has; always in the order red, green, blue, opacity.
    pub channels: u32,
    /// `width * height * channels` values, rows from the top. sRGB colours are decoded to linear.
    pub values: Vec<f32>,
}

impl FloatImage {
    /// The values of one texel, one per channel; `None` outside the image.
    pub fn texel(&self, x: u32, y: u32) -> Option<&[f32]> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let channels = self.channels as usize;
        let start = (y as usize * self.width as usize + x as usize) * channels;
        self.values.get(start..start + channels)
    }
}

/// Reads one mip level of one layer of a two-dimensional, single-sampled texture.
///
/// Formats: 8-bit normalized (with and without sRGB, RGBA or BGRA), 16- and 32-bit floats,
/// `Rg11b10Ufloat`, and except on OpenGL `Rgb9e5Ufloat` and `Depth32Float`. The texture has the
/// usage `COPY_SRC`.
/// [`Error::UnsupportedFormat`] and [`Error::Invalid`] otherwise; [`Error::OutOfMemory`],
/// [`Error::Map`] and [`Error::Lost`] as they come.
pub fn read_texture(gpu: &Gpu, texture: &wgpu::Texture, level: u32, layer: u32) -> Result<FloatImage, Error> {
    let decoder = supported_decoder(gpu, texture.format())?;
    check_texture(texture, level, layer)?;
    let size = texture.size().mip_level_size(level, texture.dimension());
    let row_bytes = size.width * decoder.texel_bytes;
    let pitch = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let count = size.width as usize * size.height as usize * decoder.channels as usize;
    let mut values = reserved(count)?;
    // At least one row at a time; a row is far below the smallest limit on buffers.
    let strip_rows =
        u32::try_from(STAGING_BYTES / u64::from(pitch)).unwrap_or(u32::MAX).clamp(1, size.height);
    let staging = staging_buffer(gpu, u64::from(pitch) * u64::from(strip_rows))?;
    let mut y = 0;
    while y < size.height {
        let rows = strip_rows.min(size.height - y);
        let bytes = u64::from(pitch) * u64::from(rows);
        let source = wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: level,
            origin: wgpu::Origin3d { x: 0, y, z: layer },
            aspect: wgpu::TextureAspect::All,
        };
        let target = wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(pitch),
                rows_per_image: None,
            },
        };
        let extent = wgpu::Extent3d { width: size.width, height: rows, depth_or_array_layers: 1 };
        let copy =
            |encoder: &mut wgpu::CommandEncoder| encoder.copy_texture_to_buffer(source, target, extent);
        read_staging(gpu, &staging, bytes, copy, |bytes| {
            for row in bytes.chunks_exact(pitch as usize) {
                for texel in row[..row_bytes as usize].chunks_exact(decoder.texel_bytes as usize) {
                    (decoder.decode)(texel, &mut values);
                }
            }
        })?;
        y += rows;
    }
    Ok(FloatImage { width: size.width, height: size.height, channels: decoder.channels, values })
}

/// Reads a whole buffer. It has the usage `COPY_SRC` and a size that is a multiple of 4;
/// [`Error::Invalid`] otherwise; [`Error::OutOfMemory`], [`Error::Map`] and [`Error::Lost`] as
/// they come.
pub fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, Error> {
    let size = buffer.size();
    if !buffer.usage().contains(wgpu::BufferUsages::COPY_SRC) {
        let found = format!("{:?}", buffer.usage());
        return Err(Error::invalid("usage of a buffer to read back", found, "COPY_SRC among them"));
    }
    if !size.is_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT) {
        return Err(Error::invalid("size of a buffer to read back", size.to_string(), "a multiple of 4"));
    }
    let mut values = reserved(usize::try_from(size).unwrap_or(usize::MAX))?;
    if size == 0 {
        return Ok(values);
    }
    let staging = staging_buffer(gpu, size.min(STAGING_BYTES))?;
    let mut offset = 0;
    while offset < size {
        let bytes = (size - offset).min(STAGING_BYTES);
        let copy = |encoder: &mut wgpu::CommandEncoder| {
            encoder.copy_buffer_to_buffer(buffer, offset, &staging, 0, Some(bytes));
        };
        read_staging(gpu, &staging, bytes, copy, |bytes| values.extend_from_slice(bytes))?;
        offset += bytes;
    }
    Ok(values)
}

fn check_texture(texture: &wgpu::Texture, level: u32, layer: u32) -> Result<(), Error> {
    let what = |quantity: &str| format!("{quantity} of a texture to read back");
    if !texture.usage().contains(wgpu::TextureUsages::COPY_SRC) {
        return Err(Error::invalid(what("usage"), format!("{:?}", texture.usage()), "COPY_SRC among them"));
    }
    if texture.dimension() != wgpu::TextureDimension::D2 || texture.sample_count() != 1 {
        let found = format!("{:?} with {} samples", texture.dimension(), texture.sample_count());
        return Err(Error::invalid(what("kind"), found, "D2 with 1 sample"));
    }
    for (quantity, found, count) in
        [("level", level, texture.mip_level_count()), ("layer", layer, texture.depth_or_array_layers())]
    {
        if found >= count {
            return Err(Error::invalid(what(quantity), found.to_string(), format!("below {count}")));
        }
    }
    Ok(())
}

/// An empty list with room for `count` values.
fn reserved<T>(count: usize) -> Result<Vec<T>, Error> {
    let mut values = Vec::new();
    values
        .try_reserve_exact(count)
        .map_err(|_| Error::OutOfMemory { what: "host memory for a readback".into() })?;
    Ok(values)
}

fn staging_buffer(gpu: &Gpu, size: u64) -> Result<wgpu::Buffer, Error> {
    gpu.checked("readback", |device| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    })
}

/// Runs `copy`, waits for it and hands the first `size` bytes of `staging` to `read`.
fn read_staging(
    gpu: &Gpu,
    staging: &wgpu::Buffer,
    size: u64,
    copy: impl FnOnce(&mut wgpu::CommandEncoder),
    read: impl FnOnce(&[u8]),
) -> Result<(), Error> {
    let (sender, receiver) = mpsc::channel();
    gpu.checked("readback", |device| {
        let desc = wgpu::CommandEncoderDescriptor { label: Some("readback") };
        let mut encoder = device.create_command_encoder(&desc);
        copy(&mut encoder);
        gpu.queue().submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, ..size, move |result| {
            // The receiver is gone only where the wait below has failed.
            sender.send(result).ok();
        });
    })?;
    gpu.wait()?;
    let map_error = |message: String| Error::Map { what: "readback".into(), message };
    match receiver.try_recv() {
        Ok(result) => result.map_err(|error| map_error(error.to_string()))?,
        Err(_) => return Err(map_error("the device gave no answer".into())),
    }
    {
        let view = staging.get_mapped_range(..size).map_err(|error| map_error(error.to_string()))?;
        read(&view);
    }
    staging.unmap();
    Ok(())
}

/// How a format's texels become floats.
struct Decoder {
    texel_bytes: u32,
    channels: u32,
    decode: Decode,
}

/// Appends the values of one texel, which has as many bytes as its format.
type Decode = fn(&[u8], &mut Vec<f32>);

/// The decoder of a format that this device can copy to a buffer.
fn supported_decoder(gpu: &Gpu, format: Format) -> Result<Decoder, Error> {
    // OpenGL reads textures by way of a colour target, and gives zeros for what cannot be one.
    let on_opengl = gpu.adapter_info().backend == wgpu::Backend::Gl;
    let unreadable = on_opengl && matches!(format, Format::Rgb9e5Ufloat | Format::Depth32Float);
    decoder(format).filter(|_| !unreadable).ok_or(Error::UnsupportedFormat {
        what: "readback of a texture".into(),
        format,
        supported: "8-bit normalized, 16- and 32-bit float formats, Rg11b10Ufloat, and except on OpenGL \
                    Rgb9e5Ufloat and Depth32Float",
    })
}

fn decoder(format: Format) -> Option<Decoder> {
    let (texel_bytes, channels, decode): (_, _, Decode) = match format {
        Format::R8Unorm => (1, 1, unorm8),
        Format::Rg8Unorm => (2, 2, unorm8),
        Format::Rgba8Unorm => (4, 4, unorm8),
        Format::Bgra8Unorm => (4, 4, |texel, values| unorm8(&rgba_of_bgra(texel), values)),
        Format::Rgba8UnormSrgb => (4, 4, srgb8),
        Format::Bgra8UnormSrgb => (4, 4, |texel, values| srgb8(&rgba_of_bgra(texel), values)),
        Format::R16Float => (2, 1, float16),
        Format::Rg16Float => (4, 2, float16),
        Format::Rgba16Float => (8, 4, float16),
        Format::R32Float | Format::Depth32Float => (4, 1, float32),
        Format::Rg32Float => (8, 2, float32),
        Format::Rgba32Float => (16, 4, float32),
        Format::Rg11b10Ufloat => (4, 3, rg11b10),
        Format::Rgb9e5Ufloat => (4, 3, rgb9e5),
        _ => return None,
    };
    Some(Decoder { texel_bytes, channels, decode })
}

fn unorm8(texel: &[u8], values: &mut Vec<f32>) {
    values.extend(texel.iter().map(|&byte| f32::from(byte) / 255.0));
}

/// Decodes the sRGB curve (IEC 61966-2-1) of the first three channels; opacity is linear.
fn srgb8(texel: &[u8], values: &mut Vec<f32>) {
    values.extend(texel.iter().enumerate().map(|(channel, &byte)| {
        let encoded = f32::from(byte) / 255.0;
        match (channel, encoded <= 0.04045) {
            (3, _) => encoded,
            (_, true) => encoded / 12.92,
            (_, false) => ((encoded + 0.055) / 1.055).powf(2.4),
        }
    }));
}

fn rgba_of_bgra(texel: &[u8]) -> [u8; 4] {
    [texel[2], texel[1], texel[0], texel[3]]
}

fn float16(texel: &[u8], values: &mut Vec<f32>) {
    values.extend(texel.chunks_exact(2).map(|bytes| f16::from_le_bytes([bytes[0], bytes[1]]).to_f32()));
}

fn float32(texel: &[u8], values: &mut Vec<f32>) {
    values.extend(words(texel).map(f32::from_bits));
}

/// Unsigned floats with 5 bits of exponent and 6, 6 and 5 bits of mantissa: halves without sign
/// whose last bits were cut.
fn rg11b10(texel: &[u8], values: &mut Vec<f32>) {
    for word in words(texel) {
        let bits = [(word & 0x7ff) << 4, (word >> 11 & 0x7ff) << 4, (word >> 22) << 5];
        values.extend(bits.map(|bits| f16::from_bits(bits as u16).to_f32()));
    }
}

/// Three mantissas of 9 bits under one exponent of 5 bits, biased by 15.
fn rgb9e5(texel: &[u8], values: &mut Vec<f32>) {
    for word in words(texel) {
        let scale = 2f32.powi((word >> 27) as i32 - 15 - 9);
        values.extend([0, 9, 18].map(|shift| (word >> shift & 0x1ff) as f32 * scale));
    }
}

fn words(texel: &[u8]) -> impl Iterator<Item = u32> {
    texel.chunks_exact(4).map(|bytes| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
}
