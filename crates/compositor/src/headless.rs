//! One picture without a window.

use crate::{Compositor, Desc, Error, Frame, FrameWork, SceneGpu, Settings};
use gpu_context::{FloatImage, Gpu, Timer, Timing, readback};
use scene::{Camera, Scene, Warning};

/// A rendered picture.
#[derive(Clone, Debug)]
pub struct HdrImage {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `4 * width * height` values, rows from the top: linear scene-referred radiance, and
    /// coverage (1 on a surface, 0 on the background). All finite.
    pub rgba: Vec<f32>,
    /// Values that left the range of half floats on the GPU and were brought back to 65504.
    pub overflowed: usize,
    /// What each pass did.
    pub work: FrameWork,
    /// What each pass took, as far as the device can measure it.
    pub timings: Vec<Timing>,
    /// What was mended while the scene was uploaded.
    pub warnings: Vec<Warning>,
}

/// Uploads a scene and renders one picture of `size` pixels, width and height.
///
/// Fails as [`SceneGpu::upload`] and [`Compositor::render`] do, and with [`Error::Gpu`] where the
/// picture cannot be read back.
pub fn render(
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    size: [u32; 2],
    settings: &Settings,
) -> Result<HdrImage, Error> {
    // There is no next picture to bake on in.
    let horizon_shadow = settings
        .horizon_shadow
        .map(|settings| horizon_shadow::Settings { azimuths_per_prepare: u32::MAX, ..settings });
    let settings = &Settings { horizon_shadow, ..*settings };
    let uploaded = SceneGpu::upload(gpu, scene)?;
    let mut compositor = Compositor::new(gpu, &Desc { display_format: wgpu::TextureFormat::Rgba8UnormSrgb })?;
    let mut timer = Timer::new(gpu)?;
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let frame = Frame { scene: &uploaded, camera, size, timer: &timer };
    let work = compositor.render(gpu, &mut encoder, settings, &frame)?;
    timer.resolve(&mut encoder);
    gpu.queue().submit([encoder.finish()]);
    timer.end_frame()?;
    let image = match compositor.hdr() {
        Some(hdr) => readback::read_texture(gpu, &hdr.texture, 0, 0)?,
        None => FloatImage { width: 0, height: 0, channels: 4, values: Vec::new() },
    };
    let mut rgba = image.values;
    let overflowed = bring_back(&mut rgba);
    let timings = timer.finished_frame().unwrap_or_default();
    let warnings = uploaded.warnings().to_vec();
    Ok(HdrImage { width: image.width, height: image.height, rgba, overflowed, work, timings, warnings })
}

/// Replaces what is not finite, and counts it.
fn bring_back(values: &mut [f32]) -> usize {
    let mut count = 0;
    for value in values.iter_mut().filter(|value| !value.is_finite()) {
        *value = if *value > 0.0 { 65504.0 } else { 0.0 };
        count += 1;
    }
    count
}
