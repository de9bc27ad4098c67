//! What is built when, and what is skipped.

mod support;

use diffuse_envmap::{
    CHAIN_STANDS, Camera, Desc, DiffuseEnvmap, Environment, Error, Frame, NO_CHAIN_NEEDED, NO_ENVIRONMENT,
    Settings, Surface, Work, wgpu,
};
use support::{Probe, Query};

#[test]
fn the_chain_is_built_once_while_the_map_stands() {
    let mut probe = Probe::new();
    assert_eq!(probe.prepare(&Settings::SHEEN, 0.0, 1.0), Work::skipped(NO_ENVIRONMENT));
    assert_eq!(probe.technique.memory_bytes(), 0);

    probe.set_map(64, 32, &vec![[1.0; 3]; 2048]);
    let first = probe.prepare(&Settings::SHEEN, 0.0, 1.0);
    assert_eq!(first.skipped, None);
    // Six passes find the sources, three levels of 16, 8 and 4 texels, one for the harmonics.
    assert_eq!(first.passes, 10);
    let chain_bytes = 6 * 8 * (16 * 16 + 8 * 8 + 4 * 4);
    assert_eq!(probe.technique.memory_bytes(), chain_bytes + 64 * 32 * 8 + 96 * 6 * 16);

    // Turning it, other settings and more frames build nothing.
    for rotation_rad in [0.0, 0.1, 0.2] {
        let settings = Settings { roughness_offset: rotation_rad, ..Settings::SHEEN };
        assert_eq!(probe.prepare(&settings, rotation_rad, 1.0), Work::skipped(CHAIN_STANDS));
    }
    // Other texels do.
    probe.set_map(64, 32, &vec![[2.0; 3]; 2048]);
    assert_eq!(probe.prepare(&Settings::SHEEN, 0.0, 1.0).passes, 10);
}

#[test]
fn mirrors_and_the_published_method_build_nothing() {
    let mut probe = Probe::new();
    probe.set_map(64, 32, &vec![[1.0; 3]; 2048]);
    assert_eq!(probe.prepare(&Settings::SHEEN, 0.0, 0.0), Work::skipped(NO_CHAIN_NEEDED));
    assert_eq!(probe.prepare(&Settings::PAPER, 0.0, 1.0), Work::skipped(NO_CHAIN_NEEDED));
    assert_eq!(probe.technique.memory_bytes(), 0);
    // A roughness that was not announced is shown as well as the map allows.
    probe.prepare(&Settings::SHEEN, 0.0, 0.0);
    let found = probe.evaluate(&[Query::along([0.0, 1.0, 0.0], 0.02)])[0];
    assert!((found[0] - 1.0).abs() < 1e-3);
    // An offset turns mirrors rough.
    let rough = Settings { roughness_offset: 0.3, ..Settings::SHEEN };
    assert_eq!(probe.prepare(&rough, 0.0, 0.0).passes, 10);
}

#[test]
fn what_does_not_fit_is_an_error() {
    let probe = Probe::new();
    let device = probe.gpu.device();
    let format = wgpu::TextureFormat::Rgba8Uint;
    assert_eq!(
        DiffuseEnvmap::new(&probe.gpu, &Desc { target_format: format }).err(),
        Some(Error::Target { format })
    );

    let texture = |format, size: u32| {
        device
            .create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
            .create_view(&wgpu::TextureViewDescriptor::default())
    };
    let mut technique =
        DiffuseEnvmap::new(&probe.gpu, &Desc { target_format: wgpu::TextureFormat::Rgba16Float }).unwrap();
    let mut prepare = |map: &wgpu::TextureView, surface: Option<Surface<'_>>| {
        let frame = Frame {
            environment: Some(Environment { view: map, revision: 0, intensity: 1.0, rotation_rad: 0.0 }),
            surface,
            camera: Camera { world_from_clip: [[0.0; 4]; 4], eye_world: [0.0; 3] },
            max_roughness: 1.0,
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        technique.prepare(&probe.gpu, &mut encoder, &Settings::SHEEN, &frame)
    };
    let integers = texture(wgpu::TextureFormat::Rgba16Uint, 4);
    let error = prepare(&integers, None).err();
    assert_eq!(error, Some(Error::Environment { format: wgpu::TextureFormat::Rgba16Uint }));

    let half = wgpu::TextureFormat::Rgba16Float;
    let (depth, map) = (texture(wgpu::TextureFormat::Depth32Float, 8), texture(half, 8));
    let (fitting, small) = (texture(half, 8), texture(half, 7));
    let surface = Surface {
        depth: &depth,
        normal_roughness: &fitting,
        specular: &small,
        albedo: &fitting,
        diffuse_normal: None,
    };
    let error = prepare(&map, Some(surface)).err();
    assert_eq!(error, Some(Error::Surface { part: "specular", found: [7, 7], expected: [8, 8] }));
}
