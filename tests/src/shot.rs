//! A frame on the host: the HDR image, and for each pixel the ray and the surface it met.

use crate::technique::Failure;
use compositor::{Compositor, Frame, FrameWork, SceneGpu, Settings, Target, wgpu};
use diffuse_envmap::model;
use glam::Vec3;
use gpu_context::{FloatImage, Gpu, Timer, readback};
use image_error::Image;
use scene::{Camera, Scene};

/// A frame that was rendered and read back.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Pixels per row, and rows.
    pub size: [u32; 2],
    /// All pixels, rows from the top.
    pub pixels: Vec<Pixel>,
    /// What each pass did.
    pub work: FrameWork,
}

/// One pixel of a [`Shot`].
#[derive(Clone, Copy, Debug)]
pub struct Pixel {
    /// Column.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// Linear scene-referred radiance.
    pub radiance: [f64; 3],
    /// Whether a surface is there.
    pub is_covered: bool,
    /// Unit direction from the eye through the pixel's centre, from the camera alone.
    pub view_world: [f64; 3],
    /// The surface buffer's normal, in half floats as the techniques see it; zero without surface.
    pub normal_world: [f64; 3],
}

impl Shot {
    /// Uploads a scene and renders one frame of it.
    ///
    /// # Panics
    /// Where the scene cannot be uploaded, rendered or read back, or the device raised an error.
    pub fn new(
        gpu: &Gpu,
        compositor: &mut Compositor,
        scene: &Scene,
        camera: &Camera,
        size: [u32; 2],
        settings: &Settings,
    ) -> Self {
        let uploaded = SceneGpu::upload(gpu, scene).expect("the scene uploads");
        Self::next(gpu, compositor, &uploaded, camera, size, settings)
    }

    /// Renders one frame of a scene that is on the GPU already.
    ///
    /// # Panics
    /// As [`Shot::new`].
    pub fn next(
        gpu: &Gpu,
        compositor: &mut Compositor,
        scene: &SceneGpu,
        camera: &Camera,
        size: [u32; 2],
        settings: &Settings,
    ) -> Self {
        Self::try_next(gpu, compositor, scene, camera, size, settings)
            .unwrap_or_else(|error| panic!("{error}"))
    }

    /// As [`Shot::next`], with what went wrong as a value: an error of the compositor or of reading
    /// back, or the errors that the device raised meanwhile.
    pub fn try_next(
        gpu: &Gpu,
        compositor: &mut Compositor,
        scene: &SceneGpu,
        camera: &Camera,
        size: [u32; 2],
        settings: &Settings,
    ) -> Result<Self, Failure> {
        let timer = Timer::new(gpu)?;
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let frame = Frame { scene, camera, size, timer: &timer };
        let work = compositor.render(gpu, &mut encoder, settings, &frame)?;
        gpu.queue().submit([encoder.finish()]);
        let surface = compositor.surface().ok_or("the frame left no surface buffer")?;
        let read = |target: &Target| readback::read_texture(gpu, &target.texture, 0, 0);
        let (hdr, normals) = (read(&surface.hdr)?, read(&surface.normal_roughness)?);
        no_errors(gpu)?;
        let pixel = |index: u32| {
            let (x, y) = (index % size[0], index / size[0]);
            let ([red, green, blue, coverage], [nx, ny, nz, _]) = (texel(&hdr, x, y), texel(&normals, x, y));
            Pixel {
                x,
                y,
                radiance: [red, green, blue],
                is_covered: coverage > 0.5,
                view_world: pixel_direction(camera, size, [x, y]),
                normal_world: [nx, ny, nz],
            }
        };
        Ok(Self { size, pixels: (0..size[0] * size[1]).map(pixel).collect(), work })
    }

    /// The HDR image.
    pub fn image(&self) -> Result<Image, Failure> {
        let pixels = self.pixels.iter().map(|pixel| pixel.radiance.map(|value| value as f32)).collect();
        Ok(Image::new(self.size[0] as usize, self.size[1] as usize, pixels)?)
    }

    /// Whether a surface is there, pixel by pixel.
    pub fn mask(&self) -> Vec<bool> {
        self.pixels.iter().map(|pixel| pixel.is_covered).collect()
    }

    /// The pixels with a surface.
    pub fn covered(&self) -> impl Iterator<Item = &Pixel> {
        self.pixels.iter().filter(|pixel| pixel.is_covered)
    }
}

/// Fails with what the device reported outside of any call's result.
pub(crate) fn no_errors(gpu: &Gpu) -> Result<(), Failure> {
    let errors: Vec<String> = gpu.take_errors().iter().map(ToString::to_string).collect();
    if errors.is_empty() { Ok(()) } else { Err(format!("on the device: {}", errors.join("; ")).into()) }
}

fn texel(image: &FloatImage, x: u32, y: u32) -> [f64; 4] {
    let values = image.texel(x, y).expect("a pixel of the image");
    std::array::from_fn(|channel| f64::from(values[channel]))
}

/// The unit direction from the eye through the centre of a pixel, in f64 from the camera's own
/// numbers: no matrix is shared with what renders.
pub fn pixel_direction(camera: &Camera, size: [u32; 2], pixel: [u32; 2]) -> [f64; 3] {
    let wide = |v: Vec3| v.to_array().map(f64::from);
    let unit = |v| model::normalize_or(v, [0.0; 3]);
    let forward = unit(model::add_scaled(wide(camera.target), wide(camera.eye), -1.0));
    let right = unit(cross(forward, wide(camera.up)));
    let up = cross(right, forward);
    let tan = (f64::from(camera.fov_y_rad) / 2.0).tan();
    let [width, height] = size.map(f64::from);
    let [x, y] = pixel.map(|index| f64::from(index) + 0.5);
    let (sideways, upward) = ((2.0 * x / width - 1.0) * tan * width / height, (1.0 - 2.0 * y / height) * tan);
    unit(model::add_scaled(model::add_scaled(forward, right, sideways), up, upward))
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
