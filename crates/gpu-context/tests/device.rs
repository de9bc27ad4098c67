//! Bring-up, errors as values, and timings.

use gpu_context::{DeviceError, Error, Gpu, HeadlessDesc, Timer, upload, wgpu};

mod common;
use common::all_backends;

fn default_gpu() -> Gpu {
    Gpu::headless(&HeadlessDesc::default()).unwrap()
}

/// A buffer that validation refuses: mappable for reading and a vertex buffer at once.
fn refused_buffer(device: &wgpu::Device) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("refused"),
        size: 16,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    })
}

#[test]
fn vulkan_goes_before_opengl() {
    let gpu = default_gpu();
    let has_vulkan =
        Gpu::headless(&HeadlessDesc { backends: wgpu::Backends::VULKAN, ..HeadlessDesc::default() }).is_ok();
    if has_vulkan {
        assert_eq!(gpu.adapter_info().backend, wgpu::Backend::Vulkan);
    }
}

#[test]
fn an_adapter_is_found_by_part_of_its_name() {
    let name = default_gpu().adapter_info().name.to_uppercase();
    let part = &name[..name.len().min(5)];
    let gpu = Gpu::headless(&HeadlessDesc { adapter_name: Some(part), ..HeadlessDesc::default() }).unwrap();
    assert!(gpu.adapter_label().to_uppercase().contains(part));
}

#[test]
fn an_absent_adapter_is_an_error_that_lists_those_seen() {
    let seen_name = default_gpu().adapter_info().name.clone();
    let desc = HeadlessDesc { adapter_name: Some("no such adapter"), ..HeadlessDesc::default() };
    let error = Gpu::headless(&desc).unwrap_err();
    let text = error.to_string();
    for part in ["no such adapter", &seen_name, "has another name", "mesa-vulkan-drivers"] {
        assert!(text.contains(part), "{part} is not in: {text}");
    }
    assert!(matches!(error, Error::NoAdapter { .. }));
}

#[test]
fn limits_that_no_adapter_has_are_named() {
    let required_limits = wgpu::Limits { max_texture_dimension_2d: 1 << 30, ..wgpu::Limits::default() };
    let error = Gpu::headless(&HeadlessDesc { required_limits, ..HeadlessDesc::default() }).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("max_texture_dimension_2d") && text.contains("1073741824"), "{text}");
}

#[test]
fn features_that_no_adapter_has_are_named() {
    // A feature of phones: most adapters lack it, and one that has it must grant it.
    let required_features = wgpu::Features::TEXTURE_COMPRESSION_ASTC_HDR;
    match Gpu::headless(&HeadlessDesc { required_features, ..HeadlessDesc::default() }) {
        Ok(gpu) => assert!(gpu.device().features().contains(required_features)),
        Err(error) => assert!(error.to_string().contains("TEXTURE_COMPRESSION_ASTC_HDR"), "{error}"),
    }
}

#[test]
fn checked_returns_the_error_and_leaves_none_behind() {
    for gpu in all_backends() {
        let error = gpu.checked("the vertex buffer", refused_buffer).unwrap_err();
        assert!(matches!(&error, Error::Validation { what, .. } if what == "the vertex buffer"), "{error}");
        assert!(error.to_string().contains("the vertex buffer"), "{error}");
        assert_eq!(gpu.take_errors(), []);
        assert_eq!(gpu.checked("a number", |_| 7), Ok(7));
    }
}

#[test]
fn uncaptured_errors_arrive_as_values() {
    for gpu in all_backends() {
        assert_eq!(gpu.take_errors(), []);
        drop(refused_buffer(gpu.device()));
        let errors = gpu.take_errors();
        assert!(
            matches!(&errors[..], [DeviceError::Validation(text)] if text.contains("refused")),
            "{errors:?}"
        );
        assert_eq!(gpu.take_errors(), []);
    }
}

#[test]
fn loss_of_the_device_is_a_value() {
    for gpu in all_backends() {
        gpu.wait().unwrap();
        gpu.device().destroy();
        // The loss is reported when the device is next polled.
        gpu.wait().ok();
        assert!(matches!(gpu.wait(), Err(Error::Lost { .. })));
        assert!(matches!(gpu.take_errors()[..], [DeviceError::Lost(_)]));
        assert!(matches!(gpu.checked("a number", |_| 7), Err(Error::Lost { .. })));
        assert!(upload::texture_2d(&gpu, "t", 1, 1, wgpu::TextureFormat::R8Unorm, &[1], None).is_err());
    }
}

#[test]
fn a_hosts_error_handler_stays_until_collection_is_asked_for() {
    use std::sync::{Arc, atomic::AtomicUsize, atomic::Ordering};
    let own = default_gpu();
    let seen_by_host = Arc::new(AtomicUsize::new(0));
    let counter = Arc::clone(&seen_by_host);
    own.device().on_uncaptured_error(Arc::new(move |_| {
        counter.fetch_add(1, Ordering::Relaxed);
    }));
    let gpu = Gpu::from_host(own.device().clone(), own.queue().clone(), own.adapter_info().clone());
    drop(refused_buffer(gpu.device()));
    assert_eq!(seen_by_host.load(Ordering::Relaxed), 1);
    assert_eq!(gpu.take_errors(), []);
    gpu.collect_errors();
    drop(refused_buffer(gpu.device()));
    assert_eq!(seen_by_host.load(Ordering::Relaxed), 1);
    assert_eq!(gpu.take_errors().len(), 1);
}

/// Records a frame with a span around a pass that clears a texture.
fn timed_frame(gpu: &Gpu, timer: &mut Timer) {
    let target = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("target"),
        size: wgpu::Extent3d { width: 256, height: 256, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let view = target.create_view(&wgpu::TextureViewDescriptor::default());
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut frame = timer.scope("frame", &mut encoder);
        let attachment = wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations::default(),
        };
        let descriptor = wgpu::RenderPassDescriptor {
            color_attachments: &[Some(attachment)],
            ..wgpu::RenderPassDescriptor::default()
        };
        drop(frame.scoped_render_pass("clear", descriptor));
    }
    timer.resolve(&mut encoder);
    gpu.queue().submit([encoder.finish()]);
    timer.end_frame().unwrap();
}

#[test]
fn spans_are_timed_where_the_device_can_and_none_elsewhere() {
    for gpu in all_backends() {
        let mut timer = Timer::new(&gpu).unwrap();
        let features = gpu.device().features();
        let mut timed = 0;
        for _ in 0..4 {
            timed_frame(&gpu, &mut timer);
            gpu.wait().unwrap();
            let frame = timer.finished_frame().unwrap();
            let [span] = &frame[..] else { panic!("{frame:?}") };
            let [pass] = &span.children[..] else { panic!("{frame:?}") };
            assert_eq!((&*span.label, &*pass.label), ("frame", "clear"));
            println!("{}: frame {:?} ms, pass {:?} ms", gpu.adapter_label(), span.time_ms, pass.time_ms);
            for (time_ms, feature) in [
                (span.time_ms, wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS),
                (pass.time_ms, wgpu::Features::TIMESTAMP_QUERY),
            ] {
                assert!(time_ms.is_none() || features.contains(feature));
                assert!(time_ms.is_none_or(|time_ms| time_ms > 0.0), "{time_ms:?}");
            }
            timed += u32::from(pass.time_ms.is_some());
        }
        // A coarse clock may miss one pass, not each of them.
        assert_eq!(timed > 0, features.contains(wgpu::Features::TIMESTAMP_QUERY));
        assert_eq!(gpu.take_errors(), []);
    }
}

#[test]
fn spans_without_the_feature_are_none() {
    let desc = HeadlessDesc { optional_features: wgpu::Features::empty(), ..HeadlessDesc::default() };
    let gpu = Gpu::headless(&desc).unwrap();
    let mut timer = Timer::new(&gpu).unwrap();
    timed_frame(&gpu, &mut timer);
    gpu.wait().unwrap();
    let frame = timer.finished_frame().unwrap();
    assert_eq!(frame.len(), 1);
    assert_eq!(frame[0].time_ms, None);
    assert_eq!(frame[0].children[0].time_ms, None);
}

#[test]
fn a_frame_that_was_not_resolved_is_an_error() {
    let gpu = default_gpu();
    if !gpu.device().features().contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS) {
        return;
    }
    let mut timer = Timer::new(&gpu).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    drop(timer.scope("span", &mut encoder));
    gpu.queue().submit([encoder.finish()]);
    assert!(matches!(timer.end_frame(), Err(Error::Timer { .. })));
}
