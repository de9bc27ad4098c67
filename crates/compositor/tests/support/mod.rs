//! What the tests share: a device, small scenes, and the surface buffer on the host.

#![allow(dead_code, unreachable_pub, reason = "each test program uses a part of it")]

use compositor::{Compositor, Desc, Frame, FrameWork, SceneGpu, Settings, Target, wgpu};
use glam::{Mat4, Vec3};
use gpu_context::{FloatImage, Gpu, HeadlessDesc, Timer, readback};
use scene::{Camera, Instance, Material, Mesh, Scene};

pub fn gpu() -> Gpu {
    Gpu::headless(&HeadlessDesc::default()).unwrap()
}

/// A camera on +Z at this distance, looking at the origin, 0.6 radians high.
pub fn camera_at(distance: f32) -> Camera {
    Camera { eye: Vec3::Z * distance, target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.6 }
}

/// A scene of one instance.
pub fn scene_of(mesh: Mesh, material: Material, world_from_local: Mat4) -> Scene {
    let instance = Instance { name: "object".into(), mesh: 0, material: 0, world_from_local };
    Scene {
        name: "test".into(),
        meshes: vec![mesh],
        materials: vec![material],
        instances: vec![instance],
        ..Scene::default()
    }
}

/// A square of side 2 that faces +Z, u to the right and v down.
pub fn wall() -> Mesh {
    let corners = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
    Mesh {
        name: "wall".into(),
        positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
        normals: vec![Vec3::Z; 4],
        tangents: vec![Vec3::X.extend(1.0); 4],
        uvs: corners.map(|[x, y]| glam::Vec2::new(0.5 + 0.5 * x, 0.5 - 0.5 * y)).to_vec(),
        triangles: vec![[0, 2, 1], [0, 3, 2]],
    }
}

/// The surface buffer and HDR image on the host.
pub struct Pixels {
    pub size: [u32; 2],
    pub depth: FloatImage,
    pub normal_roughness: FloatImage,
    pub specular: FloatImage,
    pub albedo: FloatImage,
    pub hdr: FloatImage,
    pub work: FrameWork,
}

impl Pixels {
    pub fn all(&self) -> impl Iterator<Item = (u32, u32)> {
        let [width, height] = self.size;
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    pub fn is_covered(&self, x: u32, y: u32) -> bool {
        self.depth.texel(x, y).unwrap()[0] > 0.0
    }

    pub fn covered(&self) -> usize {
        self.all().filter(|&(x, y)| self.is_covered(x, y)).count()
    }

    pub fn normal(&self, x: u32, y: u32) -> Vec3 {
        Vec3::from_slice(self.normal_roughness.texel(x, y).unwrap())
    }

    pub fn radiance(&self, x: u32, y: u32) -> Vec3 {
        Vec3::from_slice(self.hdr.texel(x, y).unwrap())
    }

    pub fn assert_finite(&self) {
        for image in [&self.depth, &self.normal_roughness, &self.specular, &self.albedo, &self.hdr] {
            assert!(image.values.iter().all(|value| value.is_finite()));
        }
    }
}

/// Renders one frame and reads everything back.
pub fn render(gpu: &Gpu, scene: &Scene, camera: &Camera, size: [u32; 2]) -> Pixels {
    render_with(gpu, scene, camera, size, &Settings::default())
}

pub fn render_with(gpu: &Gpu, scene: &Scene, camera: &Camera, size: [u32; 2], settings: &Settings) -> Pixels {
    let scene = SceneGpu::upload(gpu, scene).unwrap();
    let mut compositor = compositor(gpu);
    let work = submit(gpu, &mut compositor, &scene, camera, size, settings).unwrap();
    let surface = compositor.surface().unwrap();
    let read = |target: &Target| readback::read_texture(gpu, &target.texture, 0, 0).unwrap();
    let pixels = Pixels {
        size,
        depth: read(&surface.depth),
        normal_roughness: read(&surface.normal_roughness),
        specular: read(&surface.specular),
        albedo: read(&surface.albedo),
        hdr: read(&surface.hdr),
        work,
    };
    assert_eq!(gpu.take_errors(), []);
    pixels
}

pub fn compositor(gpu: &Gpu) -> Compositor {
    Compositor::new(gpu, &Desc { display_format: wgpu::TextureFormat::Rgba8UnormSrgb }).unwrap()
}

pub fn submit(
    gpu: &Gpu,
    compositor: &mut Compositor,
    scene: &SceneGpu,
    camera: &Camera,
    size: [u32; 2],
    settings: &Settings,
) -> Result<FrameWork, compositor::Error> {
    let timer = Timer::new(gpu).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let frame = Frame { scene, camera, size, timer: &timer };
    let work = compositor.render(gpu, &mut encoder, settings, &frame);
    drop(timer);
    gpu.queue().submit([encoder.finish()]);
    work
}

/// The unit direction through the middle of a pixel, computed from the camera alone.
pub fn pixel_direction(camera: &Camera, size: [u32; 2], x: u32, y: u32) -> Vec3 {
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let tan = (camera.fov_y_rad / 2.0).tan();
    let aspect = size[0] as f32 / size[1] as f32;
    let sx = ((x as f32 + 0.5) / size[0] as f32 * 2.0 - 1.0) * tan * aspect;
    let sy = (1.0 - (y as f32 + 0.5) / size[1] as f32 * 2.0) * tan;
    (forward + right * sx + up * sy).normalize()
}
