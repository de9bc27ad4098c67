//! Texels and bytes go to the GPU and come back.

use gpu_context::{Error, Gpu, HeadlessDesc, readback, upload, wgpu};
use wgpu::TextureFormat as Format;

mod common;
use common::all_backends;

/// Odd sizes, so that rows need padding.
const SIZES: [[u32; 2]; 4] = [[1, 1], [3, 5], [67, 2], [257, 9]];

fn default_gpu() -> Gpu {
    Gpu::headless(&HeadlessDesc::default()).unwrap()
}

/// Uploads `bytes` in `format` and expects them back as `expected`.
fn assert_round_trip(gpu: &Gpu, format: Format, [width, height]: [u32; 2], bytes: &[u8], expected: &[f32]) {
    let context = format!("{format:?} {width} x {height} on {}", gpu.adapter_label());
    let texture = upload::texture_2d(gpu, "image", width, height, format, bytes, None)
        .unwrap_or_else(|error| panic!("{context}: {error}"));
    let image =
        readback::read_texture(gpu, &texture, 0, 0).unwrap_or_else(|error| panic!("{context}: {error}"));
    assert_eq!((image.width, image.height), (width, height), "{context}");
    assert_eq!(image.values, expected, "{context}");
    assert_eq!(gpu.take_errors(), [], "{context}");
}

#[test]
fn floats_of_32_bits_are_exact() {
    for gpu in all_backends() {
        for (format, channels) in [(Format::R32Float, 1), (Format::Rg32Float, 2), (Format::Rgba32Float, 4)] {
            for size in SIZES {
                let count = size[0] * size[1] * channels;
                let values: Vec<f32> = (0..count).map(|i| 1e30 / (i as f32 - 7.5)).collect();
                assert_round_trip(&gpu, format, size, bytemuck::cast_slice(&values), &values);
            }
        }
    }
}

#[test]
fn floats_of_16_bits_are_exact() {
    for gpu in all_backends() {
        for (format, channels) in [(Format::R16Float, 1), (Format::Rg16Float, 2), (Format::Rgba16Float, 4)] {
            for size in SIZES {
                let count = size[0] * size[1] * channels;
                let halves: Vec<_> =
                    (0..count).map(|i| half::f16::from_f32(300.0 - 1.25 * i as f32)).collect();
                let values: Vec<f32> = halves.iter().map(|half| half.to_f32()).collect();
                assert_round_trip(&gpu, format, size, bytemuck::cast_slice(&halves), &values);
            }
        }
    }
}

#[test]
fn bytes_are_fractions_of_255() {
    for gpu in all_backends() {
        for (format, channels) in [(Format::R8Unorm, 1), (Format::Rg8Unorm, 2), (Format::Rgba8Unorm, 4)] {
            for size in SIZES {
                let bytes: Vec<u8> = (0..size[0] * size[1] * channels).map(|i| (i * 31) as u8).collect();
                let values: Vec<f32> = bytes.iter().map(|&byte| f32::from(byte) / 255.0).collect();
                assert_round_trip(&gpu, format, size, &bytes, &values);
            }
        }
    }
}

#[test]
fn bgra_comes_back_as_rgba() {
    for gpu in all_backends() {
        assert_round_trip(&gpu, Format::Bgra8Unorm, [1, 1], &[51, 102, 153, 204], &[0.6, 0.4, 0.2, 0.8]);
    }
}

#[test]
fn srgb_is_decoded_to_linear() {
    // 188 is the code nearest to half the light; opacity is not encoded.
    for gpu in all_backends() {
        let texture =
            upload::rgba8(&gpu, "c", 1, 1, &[0, 10, 188, 188], upload::Encoding::Srgb, None).unwrap();
        let values = readback::read_texture(&gpu, &texture, 0, 0).unwrap().values;
        let expected = [0.0, 10.0 / 255.0 / 12.92, 0.502886, 188.0 / 255.0];
        for (value, expected) in values.iter().zip(expected) {
            assert!((value - expected).abs() < 1e-6, "{values:?}");
        }
    }
}

#[test]
fn packed_floats_are_decoded() {
    for gpu in all_backends() {
        // 1.0 is exponent 15 with an empty mantissa: 0x3c0 of 11 bits, 0x1e0 of 10 bits.
        let word: u32 = 0x3c0 | (0x400 << 11) | (0x1d0 << 22);
        assert_round_trip(&gpu, Format::Rg11b10Ufloat, [1, 1], &word.to_le_bytes(), &[1.0, 2.0, 0.75]);
        // Exponent 16 scales the mantissas by 2^(16 - 24).
        let word: u32 = 128 | (256 << 9) | (511 << 18) | (16 << 27);
        let bytes = word.to_le_bytes();
        if gpu.adapter_info().backend == wgpu::Backend::Gl {
            let texture = upload::texture_2d(&gpu, "t", 1, 1, Format::Rgb9e5Ufloat, &bytes, None).unwrap();
            let error = readback::read_texture(&gpu, &texture, 0, 0).unwrap_err();
            assert!(matches!(error, Error::UnsupportedFormat { .. }), "{error}");
        } else {
            let expected = [0.5, 1.0, 511.0 / 256.0];
            assert_round_trip(&gpu, Format::Rgb9e5Ufloat, [1, 1], &bytes, &expected);
        }
    }
}

#[test]
fn values_beyond_16_bits_are_clamped() {
    let gpu = default_gpu();
    let texels = [[1e9, -1e9, f32::INFINITY, f32::NAN], [0.1, -0.0, 65519.0, 1e-9]];
    let texture = upload::rgba16_float(&gpu, "extremes", 2, 1, &texels, None).unwrap();
    let values = readback::read_texture(&gpu, &texture, 0, 0).unwrap().values;
    assert_eq!(values, [65504.0, -65504.0, 65504.0, 0.0, 0.099975586, 0.0, 65504.0, 0.0]);
}

/// A depth texture with two layers and two levels, each cleared to a value of its own.
fn depth_texture(gpu: &Gpu) -> wgpu::Texture {
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("depth"),
        size: wgpu::Extent3d { width: 35, height: 7, depth_or_array_layers: 2 },
        mip_level_count: 2,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: Format::Depth32Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    for (level, layer) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_mip_level: level,
            mip_level_count: Some(1),
            base_array_layer: layer,
            array_layer_count: Some(1),
            ..wgpu::TextureViewDescriptor::default()
        });
        let clear =
            wgpu::Operations { load: wgpu::LoadOp::Clear(depth(level, layer)), store: wgpu::StoreOp::Store };
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(clear),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        }));
    }
    gpu.queue().submit([encoder.finish()]);
    texture
}

fn depth(level: u32, layer: u32) -> f32 {
    0.1 + 0.2 * level as f32 + 0.4 * layer as f32
}

#[test]
fn depth_of_each_level_and_layer_comes_back() {
    for gpu in all_backends() {
        let texture = depth_texture(&gpu);
        if gpu.adapter_info().backend == wgpu::Backend::Gl {
            let error = readback::read_texture(&gpu, &texture, 0, 0).unwrap_err();
            assert!(matches!(error, Error::UnsupportedFormat { .. }), "{error}");
            continue;
        }
        for (level, layer) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let image = readback::read_texture(&gpu, &texture, level, layer).unwrap();
            assert_eq!([image.width, image.height], if level == 0 { [35, 7] } else { [17, 3] });
            assert_eq!(image.values, vec![depth(level, layer); (image.width * image.height) as usize]);
        }
        assert!(matches!(readback::read_texture(&gpu, &texture, 2, 0), Err(Error::Invalid { .. })));
        assert!(matches!(readback::read_texture(&gpu, &texture, 0, 2), Err(Error::Invalid { .. })));
        assert_eq!(gpu.take_errors(), []);
    }
}

#[test]
fn images_larger_than_the_staging_buffer_are_whole() {
    // 36 MiB in copies of at most 32: the second is a short one.
    let gpu = default_gpu();
    let (width, height) = (1023, 9001);
    let values: Vec<f32> = (0..width * height).map(|i| i as f32).collect();
    assert_round_trip(&gpu, Format::R32Float, [width, height], bytemuck::cast_slice(&values), &values);
}

#[test]
fn buffers_come_back_whole() {
    for gpu in all_backends() {
        for size in [0u64, 4, 1028, (33 << 20) + 4] {
            let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("bytes"),
                size,
                usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            let bytes: Vec<u8> = (0..size).map(|i| (i * 7 + (i >> 8)) as u8).collect();
            gpu.queue().write_buffer(&buffer, 0, &bytes);
            assert!(readback::read_buffer(&gpu, &buffer).unwrap() == bytes, "{size} bytes");
            assert_eq!(gpu.take_errors(), []);
        }
    }
}

#[test]
fn a_buffer_that_cannot_be_copied_is_refused() {
    let gpu = default_gpu();
    for (size, usage) in [(6, wgpu::BufferUsages::COPY_SRC), (8, wgpu::BufferUsages::VERTEX)] {
        let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("bytes"),
            size,
            usage,
            mapped_at_creation: false,
        });
        assert!(matches!(readback::read_buffer(&gpu, &buffer), Err(Error::Invalid { .. })));
    }
}

#[test]
fn sizes_beyond_the_device_are_refused_before_memory_is_taken() {
    for gpu in all_backends() {
        let limit = gpu.device().limits().max_texture_dimension_2d;
        let error = upload::texture_2d(&gpu, "wide", limit + 1, 1, Format::R8Unorm, &[], None).unwrap_err();
        let Error::Limit { what, found, limit: named } = &error else { panic!("{error}") };
        assert!(what.contains("width of wide"), "{error}");
        assert_eq!((*found, *named), (u64::from(limit) + 1, u64::from(limit)));
        let error = upload::rgba16_float(&gpu, "empty", 0, 4, &[], None).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
        assert_eq!(gpu.take_errors(), []);
    }
}

#[test]
fn a_buffer_beyond_the_limit_is_an_error() {
    for gpu in all_backends() {
        let limit = gpu.device().limits().max_buffer_size;
        let result = gpu.checked("huge buffer", |device| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("huge"),
                size: (limit & !3).saturating_add(4),
                usage: wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        });
        assert!(matches!(result, Err(Error::Validation { .. })), "{result:?}");
        assert_eq!(gpu.take_errors(), []);
    }
}

#[test]
fn a_texture_that_fits_no_memory_is_an_error() {
    // wgpu's OpenGL reports no exhausted memory.
    for gpu in all_backends().into_iter().filter(|gpu| gpu.adapter_info().backend != wgpu::Backend::Gl) {
        let limits = gpu.device().limits();
        let side = limits.max_texture_dimension_2d;
        let layers = limits.max_texture_array_layers;
        // Terabytes, but each of its sizes is allowed.
        let result = gpu.checked("huge texture", |device| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("huge"),
                size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: layers },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: Format::Rgba32Float,
                usage: wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        });
        assert!(matches!(result, Err(Error::OutOfMemory { .. })), "{result:?}");
        // The device lives on.
        assert_round_trip(&gpu, Format::R8Unorm, [1, 1], &[255], &[1.0]);
    }
}

#[test]
fn bytes_that_do_not_fit_the_size_are_refused() {
    let gpu = default_gpu();
    let error = upload::texture_2d(&gpu, "short", 3, 3, Format::Rgba8Unorm, &[0; 35], None).unwrap_err();
    let text = error.to_string();
    for part in ["short", "35", "36"] {
        assert!(text.contains(part), "{part} is not in: {text}");
    }
}

#[test]
fn formats_that_cannot_be_transferred_are_refused() {
    let gpu = default_gpu();
    let error = upload::texture_2d(&gpu, "depth", 1, 1, Format::Depth32Float, &[0; 4], None).unwrap_err();
    assert!(matches!(error, Error::UnsupportedFormat { .. }), "{error}");
    let error = upload::texture_2d(&gpu, "bc1", 4, 4, Format::Bc1RgbaUnorm, &[0; 8], None).unwrap_err();
    assert!(matches!(error, Error::UnsupportedFormat { .. } | Error::MissingFeature { .. }), "{error}");
    let desc = HeadlessDesc { optional_features: wgpu::Features::empty(), ..HeadlessDesc::default() };
    let plain = Gpu::headless(&desc).unwrap();
    let error = upload::texture_2d(&plain, "norm", 1, 1, Format::R16Unorm, &[0; 2], None).unwrap_err();
    assert!(matches!(error, Error::MissingFeature { .. }), "{error}");
    assert!(error.to_string().contains("TEXTURE_FORMAT_16BIT_NORM"), "{error}");
    let integers = upload::texture_2d(&gpu, "integers", 1, 1, Format::R32Uint, &[0; 4], None).unwrap();
    let error = readback::read_texture(&gpu, &integers, 0, 0).unwrap_err();
    assert!(error.to_string().contains("R32Uint"), "{error}");
}
