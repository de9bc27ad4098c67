//! What a surface does to light: coats, reliefs, transparency and sides.

#![allow(clippy::float_cmp, reason = "black is exactly 0")]

mod common;

use common::{add, camera, furnace, lamp, matt, mean, render, settings};
use glam::{Affine2, Mat4, Vec3, Vec4};
use path_tracer::{Lobe, Settings};
use scene::{AlphaMode, ColorSpace, Environment, Material, Scene, Texture, TextureRef, Wrap, shapes};

fn texture(
    scene: &mut Scene,
    side: u32,
    color_space: ColorSpace,
    texel: impl Fn(u32, u32) -> [u8; 4],
) -> TextureRef {
    let rgba = (0..side * side).flat_map(|index| texel(index % side, index / side)).collect();
    scene.textures.push(Texture { name: String::new(), width: side, height: side, rgba, color_space });
    TextureRef {
        texture: scene.textures.len() - 1,
        texture_from_vertex_uv: Affine2::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        nearest: true,
    }
}

/// Normals that lean up to 70 degrees to all sides.
fn strong_relief(scene: &mut Scene) -> TextureRef {
    texture(scene, 32, ColorSpace::Linear, |x, y| {
        let lean = 1.2 * ((x * 7 + y * 13) % 32) as f32 / 31.0;
        let (sine, cosine) = (((x * 5 + y * 11) % 16) as f32 / 16.0 * std::f32::consts::TAU).sin_cos();
        let byte = |value: f32| (127.5 * (value + 1.0)) as u8;
        [byte(lean.sin() * cosine), byte(lean.sin() * sine), byte(lean.cos()), 255]
    })
}

/// Under an even light a white relief stays white, at the terminator and on the outline as well.
#[test]
fn strong_normal_maps_lose_no_energy() {
    let mirror = Material { metallic: 1.0, roughness: 0.0, ks: Some(Vec3::ONE), ..matt(1.0) };
    for (material, what, samples) in [(matt(1.0), "Lambert", 512), (mirror, "mirror", 32)] {
        let mut scene = furnace(1.0);
        let normal_texture = Some(strong_relief(&mut scene));
        add(&mut scene, shapes::sphere(32), Material { normal_texture, ..material }, Mat4::IDENTITY);
        let film = render(&scene, &camera([0.0, 0.5, 4.0], [0.0; 3]), &settings(32, samples));
        let (mean, error) = mean(&film);
        println!("{what} relief: {mean:.6} +- {error:.1e}");
        assert!((mean - 1.0).abs() < 1e-3 && error < 3e-4, "{what}: {mean}");
    }
}

/// No surface reflects more than it meets, whatever its lobe, roughness and coat; except for glTF's
/// own dielectric, whose white diffuse part is not quite dimmed by what its gloss takes at grazing
/// incidence: 0.8 % of a sphere.
#[test]
fn no_material_adds_energy() {
    let lobes = [Lobe::Ggx, Lobe::Blinn, Lobe::PhongCone, Lobe::DiffusedEnvironment];
    for (lobe, metallic) in lobes.into_iter().flat_map(|lobe| [(lobe, 0.0), (lobe, 1.0)]) {
        for roughness in [0.0, 0.1, 0.4, 1.0] {
            for coat in [0.0, 1.0] {
                let mut scene = furnace(1.0);
                let mut material =
                    Material { metallic, roughness, double_sided: true, ..Material::default() };
                material.clearcoat.factor = coat;
                material.clearcoat.roughness = 0.3 * roughness;
                add(&mut scene, shapes::sphere(24), material, Mat4::IDENTITY);
                let film = render(
                    &scene,
                    &camera([0.0, 0.5, 2.5], [0.0; 3]),
                    &Settings { lobe, ..settings(12, 256) },
                );
                let (mean, error) = mean(&film);
                println!(
                    "{lobe:?} metallic {metallic} roughness {roughness} coat {coat}: {mean:.4} +- {error:.1e}"
                );
                let most = if (lobe, metallic) == (Lobe::Ggx, 0.0) { 1.01 } else { 1.0 };
                assert!(mean < most + 1e-3 + 4.0 * error, "{lobe:?} {metallic} {roughness} {coat}: {mean}");
                assert!(mean > 0.3, "{lobe:?} {metallic} {roughness} {coat}: {mean}");
            }
        }
    }
}

/// A black plane of the given material in front of an even light of radiance 1.
fn veil(material: Material, with: impl FnOnce(&mut Scene) -> Option<TextureRef>, samples: u32) -> (f64, f64) {
    let mut scene = furnace(1.0);
    let base_color_texture = with(&mut scene);
    let stand = Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2) * Mat4::from_scale(Vec3::splat(10.0));
    add(&mut scene, shapes::plane(1), Material { base_color_texture, ..material }, stand);
    mean(&render(&scene, &camera([0.3, 0.2, 5.0], [0.3, 0.2, 0.0]), &settings(16, samples)))
}

#[test]
fn blending_lets_a_share_of_the_light_through() {
    let mut material = Material { alpha_mode: AlphaMode::Blend, ..matt(0.0) };
    material.base_color.w = 0.3;
    let (shown, error) = veil(material.clone(), |_| None, 256);
    println!("{shown:.5} +- {error:.1e}");
    assert!((shown - 0.7).abs() < 4.0 * error && error < 5e-3);
    // What does not blend is opaque, whatever its opacity.
    let opaque = Material { alpha_mode: AlphaMode::Opaque, ..material };
    assert_eq!(veil(opaque, |_| None, 4).0, 0.0);
}

#[test]
fn masks_cut_holes_where_the_texture_is_below_the_cutoff() {
    let with = |scene: &mut Scene| {
        let mut reference =
            texture(scene, 4, ColorSpace::Srgb, |x, y| [0, 0, 0, if (x + y) % 4 == 0 { 100 } else { 200 }]);
        reference.texture_from_vertex_uv = Affine2::from_scale(glam::Vec2::splat(16.0));
        Some(reference)
    };
    let shown = |cutoff| veil(Material { alpha_mode: AlphaMode::Mask { cutoff }, ..matt(0.0) }, with, 64).0;
    assert_eq!([0.3, 0.9].map(shown), [0.0, 1.0]);
    let half = shown(0.5);
    assert!((half - 0.25).abs() < 0.03, "{half}");
}

/// Shadows of what blends are as light as what is seen through it.
#[test]
fn blending_lets_the_same_share_of_a_shadow_ray_through() {
    let mut scene = Scene { name: "test".into(), ..Scene::default() };
    add(&mut scene, shapes::plane(1), matt(0.5), Mat4::from_scale(Vec3::splat(1e-2)));
    let mut glass = Material { alpha_mode: AlphaMode::Blend, ..matt(0.0) };
    glass.base_color.w = 0.3;
    add(&mut scene, shapes::plane(1), glass, Mat4::from_translation(Vec3::Y * 0.5));
    // One lamp that itself is half there.
    let mut sign = lamp(2.0);
    sign.alpha_mode = AlphaMode::Blend;
    sign.base_color.w = 0.5;
    let turned = Mat4::from_rotation_x(std::f32::consts::PI);
    add(&mut scene, shapes::plane(1), sign, Mat4::from_translation(Vec3::Y * 1.0) * turned);
    let eye = scene::Camera { fov_y_rad: 1e-4, ..camera([1.0, 0.2, 0.0], [0.0; 3]) };
    let (shown, error) = mean(&render(&scene, &eye, &Settings { max_bounces: 1, ..settings(16, 1024) }));
    // Siegel and Howell, configuration factor B-3, for a square of 2 x 2 at a height of 1.
    let quarter = 2.0 / 2.0_f64.sqrt() * (1.0 / 2.0_f64.sqrt()).atan() / std::f64::consts::TAU;
    let expected = 0.5 * 4.0 * quarter * 2.0 * 0.7 * 0.5;
    println!("{shown:.5} +- {error:.1e}, expected {expected:.5}");
    assert!((shown - expected).abs() < 4.0 * error && error < 5e-3 * expected);
}

/// As the rasteriser culls them, back faces of single-sided materials are not there.
#[test]
fn single_sided_surfaces_are_seen_from_their_front_only() {
    for (double_sided, turn, expected) in
        [(true, 1.0, 0.0), (true, -1.0, 0.0), (false, 1.0, 0.0), (false, -1.0, 1.0)]
    {
        let mut scene = furnace(1.0);
        let place =
            Mat4::from_rotation_x(turn * std::f32::consts::FRAC_PI_2) * Mat4::from_scale(Vec3::splat(10.0));
        add(&mut scene, shapes::plane(1), Material { double_sided, ..matt(0.0) }, place);
        let shown = mean(&render(&scene, &camera([0.0, 0.0, 5.0], [0.0; 3]), &settings(4, 4))).0;
        assert_eq!(shown, expected, "{double_sided} {turn}");
    }
}

#[test]
fn textures_are_decoded_and_multiply_their_factors() {
    // sRGB 188 is 0.5029 in linear light.
    let linear = 0.502_886_5;
    let mut scene = furnace(1.0);
    let grey = texture(&mut scene, 1, ColorSpace::Srgb, |_, _| [188, 188, 188, 255]);
    let mut material = matt(0.8);
    material.base_color_texture = Some(grey.clone());
    add(&mut scene, shapes::sphere(24), material, Mat4::IDENTITY);
    let near = camera([0.0, 0.0, 1.2], [0.0; 3]);
    let (shown, error) = mean(&render(&scene, &near, &settings(8, 1024)));
    assert!((shown - 0.8 * linear).abs() < 4.0 * error && error < 2e-3, "{shown} {error}");

    let mut scene = Scene { name: "test".into(), textures: scene.textures, ..Scene::default() };
    let material = Material { emissive: Vec3::splat(3.0), emissive_texture: Some(grey), ..matt(0.0) };
    add(&mut scene, shapes::sphere(24), material, Mat4::IDENTITY);
    let (shown, _) = mean(&render(&scene, &near, &settings(4, 1)));
    assert!((shown - 3.0 * linear).abs() < 1e-5, "{shown}");
}

/// Without occlusion a concave white surface in a furnace is white by direct light alone; with it
/// the surface is darker until further reflections come in.
#[test]
fn the_far_field_knows_no_occlusion() {
    let mut scene = furnace(1.0);
    add(&mut scene, shapes::plane(1), matt(1.0), Mat4::IDENTITY);
    add(
        &mut scene,
        shapes::plane(1),
        matt(1.0),
        Mat4::from_translation(Vec3::new(0.0, 1.0, -1.0))
            * Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2),
    );
    let eye = camera([0.0, 0.5, 1.0], [0.0, 0.0, -0.9]);
    let shown =
        |occlusion| mean(&render(&scene, &eye, &Settings { occlusion, max_bounces: 1, ..settings(16, 256) }));
    let ((open, error), (occluded, _)) = (shown(false), shown(true));
    assert!((open - 1.0).abs() < (4.0 * error).min(5e-3), "{open} {error}");
    assert!(occluded < 0.95, "{occluded}");
}

/// In the far field the shading normal counts, not the triangle: a plane with the normals of
/// another reflects like that other one.
#[test]
fn the_far_field_uses_the_shading_normal_as_it_is() {
    // Bright above, black below.
    let pixels = (0..1024 * 512).map(|index| [if index < 1024 * 256 { 1.0 } else { 0.0 }; 3]).collect();
    let environment = Some(Environment::new("half", 1024, 512, pixels).unwrap());
    let mut scene = Scene { name: "test".into(), environment, ..Scene::default() };
    let mut plane = shapes::plane(1);
    let lean = 1.0_f32;
    plane.normals.fill(Vec3::new(0.0, lean.cos(), lean.sin()));
    plane.tangents.fill(Vec4::new(1.0, 0.0, 0.0, 1.0));
    add(&mut scene, plane, matt(1.0), Mat4::from_scale(Vec3::new(20.0, 20.0, 20.0)));
    let eye = camera([0.0, 1.0, 2.0], [0.0; 3]);
    let shown = |occlusion| {
        mean(&render(&scene, &eye, &Settings { occlusion, max_bounces: 1, ..settings(12, 1024) }))
    };
    let (open, error) = shown(false);
    // The upper half of the sphere over a surface that leans: (1 + cos) / 2.
    let expected = f64::from(0.5 * (1.0 + lean.cos()));
    assert!((open - expected).abs() < 4.0 * error + 2e-3 && error < 2e-3, "{open} {error} {expected}");
    // With occlusion what would go below the triangle is not lost.
    let (folded, error) = shown(true);
    assert!((folded - 1.0).abs() < 4.0 * error && error < 2e-3, "{folded} {error}");
}
