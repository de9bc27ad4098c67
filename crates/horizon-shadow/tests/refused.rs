//! What is refused, with an error that says what to do.

mod stage;

use gpu_context::HeadlessDesc;
use horizon_shadow::{
    Contents, Desc, Error, Frame, Gpu, HeightMap, HorizonShadow, Light, Precision, Settings, Surface,
    TableDesc, View, VisibilityPass, Work, Wrap, wgpu,
};
use stage::known::bumps_map;
use stage::{Mesh, Stage, scaled, vertex_buffers};

const SHEEN: Settings = Settings { azimuths: 12, prefilter: false, ..Settings::SHEEN };

fn stage() -> Stage {
    let mut stage = Stage::new();
    stage.set_map(&bumps_map([64, 48]));
    stage
}

#[test]
fn numbers_out_of_range_are_errors_that_name_them() {
    let mut stage = stage();
    let mut refused = |settings: &Settings, change: &dyn Fn(&mut Frame<'_>)| {
        let error = stage.prepare_with(settings, &Mesh::plane(), &scaled(1.0), change).err();
        assert!(stage.surface.bind_group().is_none(), "there is nothing to draw with");
        assert_eq!(stage.gpu.take_errors(), []);
        error.map_or_else(|| "no error".to_owned(), |error| error.to_string())
    };
    let settings = [
        (Settings { azimuths: 3, ..SHEEN }, "azimuths"),
        (Settings { azimuths: 65, ..SHEEN }, "azimuths"),
        (Settings { candidates: 0, ..SHEEN }, "candidates"),
        (Settings { candidates: 5, ..SHEEN }, "candidates"),
        (Settings { radius_texels: 1.0, ..SHEEN }, "radius"),
        (Settings { radius_texels: f32::NAN, ..SHEEN }, "radius"),
    ];
    for (settings, what) in settings {
        let error = refused(&settings, &|_| {});
        assert!(error.contains(what) && error.contains("expected"), "{settings:?}: {error}");
    }
    for bad in [f32::NAN, f32::INFINITY, 0.0, -1.0] {
        let error = refused(&SHEEN, &|frame| frame.surface.texel_m = bad);
        assert!(error.contains("texel_m") && error.contains("above 0"), "{bad}: {error}");
    }
    for bad in [[f32::NAN, 1.0], [1.0, 0.0], [0.0, f32::INFINITY]] {
        let error = refused(&SHEEN, &|frame| frame.surface.curvature_per_m = bad);
        assert!(error.contains("curvature_per_m"), "{bad:?}: {error}");
        let error = refused(&SHEEN, &|frame| frame.height_map.as_mut().unwrap().range = bad);
        assert!(error.contains("range of heights"), "{bad:?}: {error}");
    }
    for bad in [f32::NAN, -0.1, 1e30] {
        let error = refused(&SHEEN, &|frame| frame.height_map.as_mut().unwrap().height_scale_m = bad);
        assert!(error.contains("height_scale_m"), "{bad}: {error}");
    }
    for bad in [f32::NAN, 0.0, f32::NEG_INFINITY] {
        let error = refused(&SHEEN, &|frame| frame.height_map.as_mut().unwrap().uv_scale = [1.0, bad]);
        assert!(error.contains("uv_scale"), "{bad}: {error}");
    }
}

/// A texture of a height map that is unlike others.
fn odd_texture(gpu: &Gpu, change: impl FnOnce(&mut wgpu::TextureDescriptor<'_>)) -> wgpu::Texture {
    let mut desc = wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 8, height: 8, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    change(&mut desc);
    gpu.device().create_texture(&desc)
}

fn prepare_texture(gpu: &Gpu, texture: &wgpu::Texture, settings: &Settings) -> Result<Work, Error> {
    let frame = Frame {
        height_map: Some(HeightMap {
            view: &texture.create_view(&wgpu::TextureViewDescriptor::default()),
            revision: 1,
            changed_rows: None,
            range: [0.0, 1.0],
            height_scale_m: 1.0,
            uv_scale: [1.0; 2],
            wrap: [Wrap::Clamp; 2],
        }),
        surface: Surface { texel_m: 1.0, curvature_per_m: [0.0; 2] },
        needed_azimuths: u64::MAX,
    };
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let work = HorizonShadow::new(gpu)?.prepare(gpu, &mut encoder, settings, &frame);
    gpu.queue().submit([encoder.finish()]);
    assert_eq!(gpu.take_errors(), []);
    work
}

#[test]
fn maps_that_cannot_be_read_are_errors_and_others_are_not() {
    let gpu = Gpu::headless(&HeadlessDesc::default()).expect("an adapter");
    let unreadable = [
        (odd_texture(&gpu, |desc| desc.format = wgpu::TextureFormat::Rgba8Uint), "R32Float"),
        (odd_texture(&gpu, |desc| desc.dimension = wgpu::TextureDimension::D3), "two-dimensional"),
        (odd_texture(&gpu, |desc| desc.usage = wgpu::TextureUsages::RENDER_ATTACHMENT), "TEXTURE_BINDING"),
        (
            odd_texture(&gpu, |desc| {
                desc.sample_count = 4;
                desc.usage |= wgpu::TextureUsages::RENDER_ATTACHMENT;
            }),
            "sample count",
        ),
    ];
    for (texture, expected) in unreadable {
        let error = prepare_texture(&gpu, &texture, &SHEEN).unwrap_err();
        assert!(matches!(error, Error::HeightMap { .. }), "{error}");
        assert!(error.to_string().contains(expected), "{error}");
    }
    for format in [
        wgpu::TextureFormat::R8Unorm,
        wgpu::TextureFormat::R16Float,
        wgpu::TextureFormat::R32Float,
        wgpu::TextureFormat::Rgba8Unorm,
        wgpu::TextureFormat::Rgba16Float,
    ] {
        let work = prepare_texture(&gpu, &odd_texture(&gpu, |desc| desc.format = format), &SHEEN);
        assert!(work.is_ok_and(|work| work.passes > 0), "{format:?}");
    }
}

#[test]
fn a_map_of_8193_texels_works_where_the_device_allows_it() {
    let gpu = Gpu::headless(&HeadlessDesc::default()).expect("an adapter");
    let desc = |width| TableDesc {
        size: [width, 2],
        azimuths: 4,
        contents: Contents::Candidates { count: 2, precision: Precision::Compact },
        wrap: [Wrap::Repeat; 2],
        curvature_per_texel: [0.0, 0.01],
        texels_per_height: 1.0,
        radius_texels: 8.0,
    };
    let limit = gpu.device().limits().max_texture_dimension_2d;
    let error = desc(limit + 1).check_device(&gpu).unwrap_err().to_string();
    assert!(error.contains(&limit.to_string()) && error.contains("use a smaller size"), "{error}");
    if limit < 8193 {
        println!("skipped: the adapter's limit is {limit}");
        return;
    }
    let texture = odd_texture(&gpu, |desc| {
        desc.size = wgpu::Extent3d { width: 8193, height: 2, depth_or_array_layers: 1 };
    });
    let settings = Settings { azimuths: 4, radius_texels: 8.0, ..SHEEN };
    assert!(prepare_texture(&gpu, &texture, &settings).is_ok_and(|work| work.passes > 0));
}

#[test]
fn a_pass_takes_four_channels_and_four_lights() {
    use wgpu::TextureFormat as Format;

    let gpu = Gpu::headless(&HeadlessDesc::default()).expect("an adapter");
    let make = |target_format| {
        let desc = Desc {
            target_format,
            depth_stencil: None,
            vertex_buffers: &vertex_buffers(),
            primitive: wgpu::PrimitiveState::default(),
        };
        VisibilityPass::new(&gpu, &desc)
    };
    for format in
        [Format::R8Unorm, Format::Rg16Float, Format::Rgba8Uint, Format::Depth32Float, Format::Bc7RgbaUnorm]
    {
        assert_eq!(make(format).err(), Some(Error::Target { format }));
    }
    for format in [Format::Rgba8Unorm, Format::Bgra8Unorm, Format::Rgba16Float] {
        assert!(make(format).is_ok(), "{format:?}");
    }
    let view = View { clip_from_world: [[0.0; 4]; 4] };
    let light = Light::Directional { direction_world: [0.0, 1.0, 0.0], angular_diameter_rad: 0.0 };
    let mut pass = make(Format::Rgba8Unorm).unwrap();
    assert!(pass.prepare(&gpu, &view, &[light; 4], []).is_ok());
    let error = pass.prepare(&gpu, &view, &[light; 5], []).unwrap_err().to_string();
    assert!(error.contains('5') && error.contains("at most 4"), "{error}");
    assert_eq!(gpu.take_errors(), []);
}
