//! The surface buffer against analytic surfaces.

mod support;

use glam::{Affine2, Mat4, Quat, Vec3, Vec4};
use scene::{AlphaMode, ColorSpace, Material, Texture, TextureRef, Wrap, shapes};
use support::*;

const SIZE: [u32; 2] = [120, 96];

fn texture(width: u32, height: u32, rgba: Vec<u8>, color_space: ColorSpace) -> Texture {
    Texture { name: "texture".into(), width, height, rgba, color_space }
}

fn whole(texture: usize) -> TextureRef {
    TextureRef { texture, texture_from_vertex_uv: Affine2::IDENTITY, wrap: [Wrap::Clamp; 2], nearest: false }
}

/// Distance along a ray to a sphere about the origin.
fn hit_sphere(eye: Vec3, direction: Vec3, radius: f32) -> Option<f32> {
    let b = eye.dot(direction);
    let discriminant = b * b - eye.length_squared() + radius * radius;
    (discriminant > 0.0).then(|| -b - discriminant.sqrt())
}

#[test]
fn a_sphere_has_its_normals_and_depth() {
    let gpu = gpu();
    let scene =
        scene_of(shapes::sphere(128), Material { roughness: 0.3, ..Material::default() }, Mat4::IDENTITY);
    let mut camera = camera_at(5.0);
    (camera.eye, camera.target) = (Vec3::new(3.0, 2.0, -4.0), Vec3::new(0.3, 0.1, 0.0));
    let pixels = render(&gpu, &scene, &camera, SIZE);
    let view =
        compositor::View::new(&camera, SIZE, compositor::SceneGpu::upload(&gpu, &scene).unwrap().bounds())
            .unwrap();
    let forward = (camera.target - camera.eye).normalize();
    let mut checked = 0;
    for (x, y) in pixels.all() {
        let direction = pixel_direction(&camera, SIZE, x, y);
        let hit = hit_sphere(camera.eye, direction, 0.995);
        if hit.is_none() {
            // Outside the true sphere, with a margin for the tessellation.
            let outside = hit_sphere(camera.eye, direction, 1.005).is_none();
            assert!(!outside || !pixels.is_covered(x, y), "({x}, {y}) is covered");
            continue;
        }
        let distance = hit_sphere(camera.eye, direction, 1.0).unwrap();
        let position = camera.eye + direction * distance;
        let depth = pixels.depth.texel(x, y).unwrap()[0];
        let along_axis = view.near_m / depth;
        let cosine = -position.dot(direction);
        if cosine < 0.1 {
            continue;
        }
        // The chord of a triangle lies inside by at most (pi / 128)^2 / 2, seen at this cosine.
        assert!(
            (along_axis - distance * forward.dot(direction)).abs() < 1e-3 / cosine,
            "depth at ({x}, {y})"
        );
        let world = view.world_from_clip.project_point3(Vec3::new(
            (x as f32 + 0.5) / SIZE[0] as f32 * 2.0 - 1.0,
            1.0 - (y as f32 + 0.5) / SIZE[1] as f32 * 2.0,
            depth,
        ));
        assert!(world.distance(position) < 2e-3 / cosine, "{world} at ({x}, {y}), expected {position}");
        // Half floats and interpolation.
        assert!(pixels.normal(x, y).distance(position) < 3e-3 / cosine, "normal at ({x}, {y})");
        assert!((pixels.normal_roughness.texel(x, y).unwrap()[3] - 0.3).abs() < 2e-4);
        checked += 1;
    }
    assert!(checked > 2000, "{checked}");
}

#[test]
fn materials_become_reflectances() {
    let gpu = gpu();
    let base_color = Vec4::new(0.8, 0.4, 0.1, 1.0);
    let center = |material: Material| {
        let pixels = render(&gpu, &scene_of(wall(), material, Mat4::IDENTITY), &camera_at(4.0), [16, 16]);
        let at = |image: &gpu_context::FloatImage| <[f32; 4]>::try_from(image.texel(8, 8).unwrap()).unwrap();
        (at(&pixels.specular), at(&pixels.albedo), at(&pixels.hdr))
    };
    let near = |found: [f32; 4], expected: [f32; 4], tolerance: f32| {
        let close = |(f, e): (f32, f32)| (f - e).abs() <= tolerance * e.abs().max(1.0);
        assert!(found.into_iter().zip(expected).all(close), "{found:?}, expected {expected:?}");
    };

    let dielectric =
        Material { base_color, roughness: 0.5, emissive: Vec3::new(0.0, 7.0, 0.25), ..Material::default() };
    let (specular, albedo, hdr) = center(dielectric.clone());
    // alpha = 0.25, n = 2 / 0.0625 - 2.
    near(specular, [0.04, 0.04, 0.04, 30.0], 1e-3);
    near(albedo, [0.8, 0.4, 0.1, 1.0], 4e-3);
    near(hdr, [0.0, 7.0, 0.25, 1.0], 1e-3);

    let (specular, albedo, _) = center(Material { metallic: 1.0, ..dielectric.clone() });
    near(specular, [0.8, 0.4, 0.1, 30.0], 1e-3);
    near(albedo, [0.0, 0.0, 0.0, 1.0], 0.0);

    let (specular, ..) = center(Material { metallic: 0.5, roughness: 0.0, ..dielectric.clone() });
    near(specular, [0.42, 0.22, 0.07, 65504.0], 1e-3);

    let given = Material { ks: Some(Vec3::new(0.1, 0.2, 0.3)), shininess: Some(12.5), ..dielectric };
    let (specular, ..) = center(given);
    near(specular, [0.1, 0.2, 0.3, 12.5], 1e-3);
}

#[test]
fn back_faces_are_culled_or_turned() {
    let gpu = gpu();
    let turned = Mat4::from_rotation_y(std::f32::consts::PI);
    let single = scene_of(wall(), Material::default(), turned);
    assert_eq!(render(&gpu, &single, &camera_at(4.0), SIZE).covered(), 0);

    let double = scene_of(wall(), Material { double_sided: true, ..Material::default() }, turned);
    let pixels = render(&gpu, &double, &camera_at(4.0), SIZE);
    assert!(pixels.covered() > 1000);
    assert!(pixels.normal(60, 48).distance(Vec3::Z) < 1e-3, "{}", pixels.normal(60, 48));
}

#[test]
fn a_mirrored_instance_keeps_its_front_and_its_normals() {
    let gpu = gpu();
    let mirrored = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let pixels =
        render(&gpu, &scene_of(shapes::sphere(64), Material::default(), mirrored), &camera_at(5.0), SIZE);
    let camera = camera_at(5.0);
    let mut checked = 0;
    for (x, y) in pixels.all() {
        let direction = pixel_direction(&camera, SIZE, x, y);
        if let Some(distance) = hit_sphere(camera.eye, direction, 0.9) {
            let outside = hit_sphere(camera.eye, direction, 1.0).unwrap();
            assert!(distance > outside);
            let expected = camera.eye + direction * outside;
            assert!(pixels.normal(x, y).distance(expected) < 0.02, "({x}, {y})");
            checked += 1;
        }
    }
    assert!(checked > 1000);
}

#[test]
fn a_stretched_instance_has_the_ellipsoids_normals() {
    let gpu = gpu();
    let scale = Vec3::new(1.5, 0.5, 1.0);
    let rotation = Quat::from_rotation_z(0.4);
    let matrix = Mat4::from_quat(rotation) * Mat4::from_scale(scale);
    let camera = camera_at(6.0);
    let pixels = render(&gpu, &scene_of(shapes::sphere(128), Material::default(), matrix), &camera, SIZE);
    let inverse = matrix.inverse();
    let mut checked = 0;
    for (x, y) in pixels.all() {
        let direction = pixel_direction(&camera, SIZE, x, y);
        let (eye, local) =
            (inverse.transform_point3(camera.eye), inverse.transform_vector3(direction).normalize());
        let Some(distance) = hit_sphere(eye, local, 1.0) else { continue };
        let on_sphere = eye + local * distance;
        let normal = (rotation * (on_sphere / scale)).normalize();
        if normal.dot(-direction) > 0.3 {
            assert!(pixels.normal(x, y).distance(normal) < 0.01, "({x}, {y})");
            checked += 1;
        }
    }
    assert!(checked > 800, "{checked}");
}

/// A wall whose normal map leans by this much along texture +u and +v up.
fn leaning(lean: [u8; 2], matrix: Mat4, double_sided: bool) -> scene::Scene {
    let texel = [lean[0], lean[1], 230, 255];
    let material = Material { normal_texture: Some(whole(0)), double_sided, ..Material::default() };
    let mut scene = scene_of(wall(), material, matrix);
    scene.textures.push(texture(2, 2, texel.repeat(4), ColorSpace::Linear));
    scene
}

#[test]
fn a_normal_map_leans_along_its_tangents() {
    let gpu = gpu();
    let center =
        |scene: &scene::Scene, camera: &scene::Camera| render(&gpu, scene, camera, SIZE).normal(60, 48);
    let front = camera_at(4.0);
    let expected = |x: u8, y: u8| {
        let decode = |texel: u8| f32::from(texel) / 255.0 * 2.0 - 1.0;
        Vec3::new(decode(x), decode(y), decode(230)).normalize()
    };
    for lean in [[200, 128], [128, 200], [60, 170]] {
        let local = expected(lean[0], lean[1]);
        let found = center(&leaning(lean, Mat4::IDENTITY, false), &front);
        assert!(found.distance(local) < 2e-3, "{lean:?}: {found}, expected {local}");

        // Turned about the view axis, the lean turns with the wall.
        let turn = Mat4::from_rotation_z(0.9);
        let found = center(&leaning(lean, turn, false), &front);
        assert!(found.distance(turn.transform_vector3(local)) < 2e-3, "{lean:?} turned: {found}");

        // Mirrored, everything about the relief is mirrored.
        let mirror = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
        let found = center(&leaning(lean, mirror, false), &front);
        assert!(found.distance(mirror.transform_vector3(local)) < 2e-3, "{lean:?} mirrored: {found}");

        // From behind, the relief is the same surface with the opposite normal.
        let back = scene::Camera { eye: Vec3::Z * -4.0, ..front };
        let found = center(&leaning(lean, Mat4::IDENTITY, true), &back);
        assert!(found.distance(-local) < 2e-3, "{lean:?} from behind: {found}");
    }
}

#[test]
fn a_normal_that_faces_away_is_bent_back() {
    let gpu = gpu();
    let mut mesh = wall();
    mesh.normals = vec![Vec3::new(1.0, 0.0, -0.5).normalize(); 4];
    let pixels = render(&gpu, &scene_of(mesh, Material::default(), Mat4::IDENTITY), &camera_at(4.0), SIZE);
    for (x, y) in pixels.all().filter(|&(x, y)| pixels.is_covered(x, y)) {
        let normal = pixels.normal(x, y);
        let cosine = -normal.dot(pixel_direction(&camera_at(4.0), SIZE, x, y));
        assert!(cosine > 0.0 && cosine < 0.01, "{cosine} at ({x}, {y})");
        assert!((normal.length() - 1.0).abs() < 2e-3);
    }
}

/// A wall with opacity rising from 0 at the left to 1 at the right.
fn ramp(alpha_mode: AlphaMode) -> scene::Scene {
    let texels: Vec<u8> = (0..=255).flat_map(|opacity| [255, 255, 255, opacity]).collect();
    let material = Material { base_color_texture: Some(whole(0)), alpha_mode, ..Material::default() };
    let mut scene = scene_of(wall(), material, Mat4::from_scale(Vec3::splat(4.0)));
    scene.textures.push(texture(256, 1, texels, ColorSpace::Srgb));
    scene
}

#[test]
fn opacity_masks_and_dithers() {
    let gpu = gpu();
    let camera = camera_at(10.0);
    let size = [128, 128];
    // Opacity at the middle of a column: the wall is 8 wide, the picture 2 * 10 * tan(0.3).
    let opacity = |x: u32| 0.5 + (((x as f32 + 0.5) / 128.0 - 0.5) * 20.0 * 0.3_f32.tan()) / 8.0;

    assert_eq!(render(&gpu, &ramp(AlphaMode::Opaque), &camera, size).covered(), 128 * 128);
    let masked = render(&gpu, &ramp(AlphaMode::Mask { cutoff: 0.6 }), &camera, size);
    for (x, y) in masked.all() {
        if (opacity(x) - 0.6).abs() > 0.01 {
            assert_eq!(masked.is_covered(x, y), opacity(x) > 0.6, "({x}, {y})");
        }
    }
    let blended = render(&gpu, &ramp(AlphaMode::Blend), &camera, size);
    assert_eq!(blended.work.get("geometry").unwrap().skipped, Some(compositor::skips::BLENDED));
    for column in 0..16 {
        let inside = |&(x, y): &(u32, u32)| x / 8 == column && blended.is_covered(x, y);
        let share = blended.all().filter(inside).count() as f32 / (8.0 * 128.0);
        assert!((share - opacity(column * 8 + 3)).abs() < 0.04, "{share} in column {column}");
    }
}

#[test]
fn textures_follow_their_uvs_transform_and_wrap() {
    let gpu = gpu();
    // Red, green / blue, white: rows from the top.
    let texels = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
    let quadrant = |transform: Affine2, wrap: Wrap| {
        let reference =
            TextureRef { texture: 0, texture_from_vertex_uv: transform, wrap: [wrap; 2], nearest: true };
        let material = Material { base_color_texture: Some(reference), ..Material::default() };
        let mut scene = scene_of(wall(), material, Mat4::IDENTITY);
        scene.textures.push(texture(2, 2, texels.concat(), ColorSpace::Srgb));
        let mut camera = camera_at(1.0 / 0.3_f32.tan());
        camera.up = Vec3::Y;
        let pixels = render(&gpu, &scene, &camera, [64, 64]);
        [(16, 16), (48, 16), (16, 48), (48, 48)].map(|(x, y)| {
            Vec3::from_slice(pixels.albedo.texel(x, y).unwrap()).round().to_array().map(|c| c as u8)
        })
    };
    let [red, green, blue, white] = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]];
    assert_eq!(quadrant(Affine2::IDENTITY, Wrap::Clamp), [red, green, blue, white]);
    let shift = Affine2::from_translation(glam::Vec2::new(1.0, 0.0));
    assert_eq!(quadrant(shift, Wrap::Repeat), [red, green, blue, white]);
    assert_eq!(quadrant(shift, Wrap::Mirror), [green, red, white, blue]);
    assert_eq!(quadrant(shift, Wrap::Clamp), [green, green, white, white]);
    // u' = v, v' = u.
    let swap = Affine2::from_mat2(glam::Mat2::from_cols(glam::Vec2::Y, glam::Vec2::X));
    assert_eq!(quadrant(swap, Wrap::Clamp), [red, blue, green, white]);
}

#[test]
fn metallic_roughness_and_occlusion_come_from_their_channels() {
    let gpu = gpu();
    let material = Material {
        metallic: 0.5,
        roughness: 0.8,
        metallic_roughness_texture: Some(whole(0)),
        occlusion_texture: Some(whole(0)),
        occlusion_strength: 0.5,
        ..Material::default()
    };
    let mut scene = scene_of(wall(), material, Mat4::IDENTITY);
    scene.textures.push(texture(1, 1, vec![51, 102, 204, 255], ColorSpace::Linear));
    let pixels = render(&gpu, &scene, &camera_at(4.0), [16, 16]);
    let albedo = pixels.albedo.texel(8, 8).unwrap();
    // metallic 0.5 * 0.8, roughness 0.8 * 0.4, occlusion 1 + 0.5 * (0.2 - 1).
    assert!((pixels.normal_roughness.texel(8, 8).unwrap()[3] - 0.32).abs() < 1e-3);
    assert!((albedo[0] - 0.6).abs() < 4e-3, "{albedo:?}");
    assert!((albedo[3] - 0.6).abs() < 4e-3, "{albedo:?}");
}
