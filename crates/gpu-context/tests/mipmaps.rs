//! Mip chains against the area average on the CPU.

use gpu_context::{Error, Gpu, Mipmaps, mip_level_count, readback, upload, wgpu};
use wgpu::TextureFormat as Format;

mod common;
use common::all_backends;

/// One channel of an image in f64.
struct Image {
    width: usize,
    height: usize,
    values: Vec<f64>,
}

impl Image {
    /// Half the size, each texel the integral over the area that it covers: the overlap of two
    /// intervals along each axis, without any case for odd or even sizes.
    fn halved(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let mut values = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let mut sum = 0.0;
                for source_y in 0..self.height {
                    let weight_y = overlap(y, height, source_y, self.height);
                    for source_x in 0..self.width {
                        let weight = weight_y * overlap(x, width, source_x, self.width);
                        sum += weight * self.values[source_y * self.width + source_x];
                    }
                }
                values.push(sum);
            }
        }
        Self { width, height, values }
    }
}

/// The share of interval `target` of `targets` on 0..1 that lies in interval `source` of `sources`.
fn overlap(target: usize, targets: usize, source: usize, sources: usize) -> f64 {
    let start = (target as f64 / targets as f64).max(source as f64 / sources as f64);
    let end = ((target + 1) as f64 / targets as f64).min((source + 1) as f64 / sources as f64);
    (end - start).max(0.0) * targets as f64
}

/// Values without pattern in 0..1.
fn noise(index: usize) -> f32 {
    let mut bits = (index as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (bits >> 40) as f32 / (1u64 << 24) as f32
}

#[test]
fn levels_are_area_averages_for_every_size() {
    for gpu in all_backends() {
        // OpenGL does not render to 32-bit floats; 16 bits show the same to 11 bits, for each of
        // up to 7 levels.
        let (format, tolerance) = match Mipmaps::new(&gpu, Format::R32Float) {
            Ok(_) => (Format::R32Float, 1e-6),
            Err(_) => (Format::R16Float, 3e-3),
        };
        let mips = Mipmaps::new(&gpu, format).unwrap();
        for [width, height] in
            [[1, 1], [2, 2], [3, 3], [5, 1], [1, 6], [64, 32], [37, 23], [129, 2], [15, 100]]
        {
            let texels: Vec<f32> = (0..width as usize * height as usize).map(noise).collect();
            let halves: Vec<half::f16> = texels.iter().map(|&value| half::f16::from_f32(value)).collect();
            let bytes = match format {
                Format::R32Float => bytemuck::cast_slice(&texels),
                _ => bytemuck::cast_slice(&halves),
            };
            let texture =
                upload::texture_2d(&gpu, "noise", width, height, format, bytes, Some(&mips)).unwrap();
            assert_eq!(texture.mip_level_count(), mip_level_count(width, height));
            let mut expected = Image {
                width: width as usize,
                height: height as usize,
                values: texels.iter().map(|&value| f64::from(value)).collect(),
            };
            let mean = expected.values.iter().sum::<f64>() / texels.len() as f64;
            for level in 1..texture.mip_level_count() {
                expected = expected.halved();
                let image = readback::read_texture(&gpu, &texture, level, 0).unwrap();
                assert_eq!((image.width as usize, image.height as usize), (expected.width, expected.height));
                for (value, expected) in image.values.iter().zip(&expected.values) {
                    assert!(
                        (f64::from(*value) - expected).abs() < tolerance,
                        "{width} x {height}, level {level}: {value} instead of {expected}"
                    );
                }
                let level_mean = image.values.iter().map(|&value| f64::from(value)).sum::<f64>()
                    / image.values.len() as f64;
                assert!((level_mean - mean).abs() < tolerance, "{width} x {height}, level {level}");
            }
        }
        assert_eq!(gpu.take_errors(), []);
    }
}

#[test]
fn srgb_is_averaged_in_linear_light() {
    for gpu in all_backends() {
        let mips = Mipmaps::new(&gpu, Format::Rgba8UnormSrgb).unwrap();
        let bytes = [0, 0, 0, 0, 255, 255, 255, 255];
        let texture = upload::rgba8(&gpu, "edge", 2, 1, &bytes, upload::Encoding::Srgb, Some(&mips)).unwrap();
        let values = readback::read_texture(&gpu, &texture, 1, 0).unwrap().values;
        // One code of sRGB is 0.006 of linear light here; averaging the codes would give 0.21.
        for value in values {
            assert!((value - 0.5).abs() < 0.004, "{value}");
        }
    }
}

#[test]
fn every_format_that_can_be_filled_keeps_a_constant() {
    for gpu in all_backends() {
        for format in [
            Format::R8Unorm,
            Format::Rg8Unorm,
            Format::Rgba8Unorm,
            Format::Bgra8Unorm,
            Format::R16Float,
            Format::Rg16Float,
            Format::Rgba16Float,
            Format::Rg32Float,
            Format::Rgba32Float,
        ] {
            let mips = match Mipmaps::new(&gpu, format) {
                Ok(mips) => mips,
                Err(Error::UnsupportedFormat { .. }) => {
                    println!("{format:?} cannot be rendered to on {}", gpu.adapter_label());
                    assert_eq!(gpu.adapter_info().backend, wgpu::Backend::Gl);
                    continue;
                }
                Err(error) => panic!("{format:?}: {error}"),
            };
            let texel_bytes = format.block_copy_size(None).unwrap() as usize;
            // The same byte all over is a small finite number in each of these formats.
            let bytes = vec![0x33; 7 * 5 * texel_bytes];
            let texture = upload::texture_2d(&gpu, "constant", 7, 5, format, &bytes, Some(&mips)).unwrap();
            let constant = readback::read_texture(&gpu, &texture, 0, 0).unwrap().values[0];
            for level in 1..3 {
                for value in readback::read_texture(&gpu, &texture, level, 0).unwrap().values {
                    assert!((value - constant).abs() <= 2e-3 * constant, "{format:?}: {value}, {constant}");
                }
            }
        }
        assert_eq!(gpu.take_errors(), []);
    }
}

#[test]
fn infinity_stays_within_its_area() {
    for gpu in all_backends() {
        let mips = Mipmaps::new(&gpu, Format::Rgba16Float).unwrap();
        // Only a 16-bit texture made of bytes can hold infinity: floats are clamped on upload.
        let mut texels = [half::f16::ONE; 4 * 16];
        // The corner nearest to the other three areas.
        texels[4 * 10] = half::f16::INFINITY;
        let bytes = bytemuck::cast_slice(&texels);
        let texture =
            upload::texture_2d(&gpu, "infinity", 4, 4, Format::Rgba16Float, bytes, Some(&mips)).unwrap();
        let image = readback::read_texture(&gpu, &texture, 1, 0).unwrap();
        let red: Vec<f32> = image.values.iter().step_by(4).copied().collect();
        assert_eq!(red, [1.0, 1.0, 1.0, f32::INFINITY]);
    }
}

#[test]
fn textures_that_do_not_fit_are_refused() {
    let gpu = &all_backends()[0];
    for format in [Format::Depth32Float, Format::R32Uint, Format::Rgb9e5Ufloat] {
        assert!(matches!(Mipmaps::new(gpu, format), Err(Error::UnsupportedFormat { .. })), "{format:?}");
    }
    let mips = Mipmaps::new(gpu, Format::R8Unorm).unwrap();
    let error = upload::texture_2d(gpu, "other", 2, 2, Format::Rg8Unorm, &[0; 8], Some(&mips)).unwrap_err();
    assert!(matches!(error, Error::Invalid { .. }), "{error}");
    assert_refused(gpu, &mips, Format::R8Unorm, wgpu::TextureUsages::TEXTURE_BINDING, 1);
    assert_refused(gpu, &mips, Format::R16Float, Mipmaps::USAGES, 1);
    assert_refused(gpu, &mips, Format::R8Unorm, Mipmaps::USAGES, 2);
}

fn assert_refused(gpu: &Gpu, mips: &Mipmaps, format: Format, usage: wgpu::TextureUsages, layers: u32) {
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 4, height: 4, depth_or_array_layers: layers },
        mip_level_count: 3,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    });
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let error = mips.generate(gpu, &mut encoder, &texture).unwrap_err();
    assert!(matches!(error, Error::Invalid { .. }), "{error}");
}
