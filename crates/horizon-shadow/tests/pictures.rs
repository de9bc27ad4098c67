//! Shadows whose place is known, on whole pictures of the ready pass.

mod stage;

use gpu_context::HeadlessDesc;
use horizon_shadow::{Gpu, Light, Method, Settings, wgpu};
use stage::known::{CURVED, SHADOWED, TEXEL_M, bumps, check_shadow, column, difference, ridge, row, with};
use stage::{Map, Mesh, SIDE, Stage, from_above, save, scaled, towards};

#[test]
fn a_ridge_casts_its_shadow_on_a_plane_whatever_the_map_s_size() {
    let mut stage = Stage::new();
    let light = [towards([1.0, 1.0, 0.0])];
    let mut draw = |map: &Map, method, light: &[Light]| {
        stage.set_map(map);
        let plane = Mesh::plane();
        let prepared = stage.prepare_with(&with(method), &plane, &scaled(1.0), |frame| {
            frame.surface.texel_m = TEXEL_M;
        });
        prepared.expect("prepare");
        let picture = stage.draw(&plane, &scaled(1.0), &from_above(1.0), light);
        assert_eq!(stage.gpu.take_errors(), []);
        picture
    };
    // Not powers of two and a single row among them; the ridge is the same in each.
    for size in [[64, 64], [64, 37], [64, 1]] {
        let pictures = SHADOWED.map(|method| draw(&ridge(size), method, &light));
        save(&format!("ridge-{}", size[1]), &pictures);
        for (method, picture) in SHADOWED.iter().zip(&pictures) {
            check_shadow(&format!("{method:?} {size:?}"), picture, 23..30, column);
        }
    }
    // A single column: the same ridge along u, the light over +z.
    let across = Map::new([1, 64], |_, j| if (30..32).contains(&j) { 8.0 * TEXEL_M } else { 0.0 });
    for method in SHADOWED {
        let picture = draw(&across, method, &[towards([0.0, 1.0, 1.0])]);
        check_shadow(&format!("{method:?} one column"), &picture, 23..30, row);
    }
}

#[test]
fn without_shadows_everything_is_visible() {
    let mut stage = Stage::new();
    stage.set_map(&ridge([64, 64]));
    let lights = [towards([1.0, 0.1, 0.0]), towards([0.0, -1.0, 0.0])];
    let picture = stage.picture(&with(Method::None), &Mesh::plane(), &scaled(1.0), &from_above(1.0), &lights);
    assert!(picture.iter().all(|pixel| *pixel == Some([1.0; 4])));
}

#[test]
fn four_lights_have_a_channel_each_and_absent_ones_are_visible() {
    let mut stage = Stage::new();
    stage.set_map(&ridge([64, 64]));
    let mut draw = |lights: &[Light]| {
        stage.picture(&with(Method::Sheen), &Mesh::plane(), &scaled(1.0), &from_above(1.0), lights)
    };
    let alone = [[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.1]]
        .map(|direction| (towards(direction), draw(&[towards(direction)])));
    let together = draw(&alone.each_ref().map(|(light, _)| *light));
    for (i, pixel) in together.iter().enumerate() {
        let pixel = pixel.unwrap();
        for (channel, (_, alone)) in alone.iter().enumerate() {
            assert_eq!(alone[i], Some([pixel[channel], 1.0, 1.0, 1.0]), "channel {channel}, pixel {i}");
        }
    }
    // Lights that are none: no direction, no numbers, none that shaders could take.
    let nowhere = [
        towards([0.0; 3]),
        towards([f32::NAN, 1.0, 0.0]),
        Light::Point { position_world: [f32::INFINITY, 0.0, 0.0], radius_m: 0.0 },
        Light::Directional { direction_world: [0.0, 1.0, 0.0], angular_diameter_rad: f32::NAN },
    ];
    assert!(draw(&nowhere).iter().all(|pixel| *pixel == Some([0.0; 4])));
}

#[test]
fn point_lights_are_seen_from_each_point() {
    let mut stage = Stage::new();
    stage.set_map(&ridge([64, 64]));
    let mut draw = |lights: &[Light]| {
        stage.picture(&with(Method::Sheen), &Mesh::plane(), &scaled(1.0), &from_above(1.0), lights)
    };
    let far = draw(&[Light::Point { position_world: [1e6, 1e6, 0.0], radius_m: 0.0 }]);
    check_shadow("far away", &far, 23..30, column);
    // Over the ridge's left edge (texel 30, 8 texels high, at x = -0.047), half a metre (16 texels)
    // above the plane: shadows reach as far from it as the light is above it, here 0.
    let above = draw(&[Light::Point { position_world: [-0.046875, 0.5, 0.0], radius_m: 0.0 }]);
    let lit = above.iter().enumerate().filter(|(i, _)| row(*i) == 32 && !(29..34).contains(&column(*i)));
    assert!(lit.clone().count() > 50 && lit.clone().all(|(_, pixel)| pixel.unwrap()[0] > 0.99));
    // At the surface and below it, inside its own radius, and enormous: finite all the same.
    for (position_world, radius_m) in [
        ([0.0, 0.0, 0.0], 0.0),
        ([0.0, -1.0, 0.0], 0.0),
        ([0.0, 0.1, 0.0], 10.0),
        ([0.0, 1e30, 0.0], 1e29),
        ([1e-30, 1e-30, 0.0], f32::MAX),
    ] {
        let picture = draw(&[Light::Point { position_world, radius_m }]);
        assert!(picture.iter().all(|pixel| pixel.is_some_and(|p| (0.0..=1.0).contains(&p[0]))));
    }
}

#[test]
fn large_lights_cast_soft_shadows() {
    let mut stage = Stage::new();
    stage.set_map(&ridge([64, 64]));
    let light = Light::Directional { direction_world: [1.0, 1.0, 0.0], angular_diameter_rad: 0.3 };
    let pictures = CURVED
        .map(|method| stage.picture(&with(method), &Mesh::plane(), &scaled(1.0), &from_above(1.0), &[light]));
    save("soft", &pictures);
    for (method, picture) in CURVED.iter().zip(&pictures) {
        let at = |x: usize| picture[SIDE as usize * 20 + x].unwrap()[0];
        // The top of the ridge is seen from texel 22 at 45 degrees: half the disc is above it.
        assert!((at(22) - 0.5).abs() < 0.1, "{method:?}: {}", at(22));
        // From 20 at atan(0.8), 6.3 degrees lower than the light's middle, of its 8.6 to the rim;
        // from 24 at atan(8 / 6), 8.1 degrees above the middle.
        assert!(
            (at(20) - 0.94).abs() < 0.05 && (at(24) - 0.015).abs() < 0.03,
            "{method:?}: {} {}",
            at(20),
            at(24)
        );
        assert!((1..28).all(|x| at(x) <= at(x - 1) + 0.01), "{method:?}");
    }
}

#[test]
fn the_back_is_lit_from_behind() {
    let mut stage = Stage::new();
    stage.set_map(&ridge([64, 64]));
    let mut mesh = Mesh::plane();
    for triangle in mesh.indices.chunks_exact_mut(3) {
        triangle.swap(1, 2);
    }
    let lights = [towards([1.0, 1.0, 0.0]), towards([1.0, -1.0, 0.0])];
    for method in SHADOWED {
        let picture = stage.picture(&with(method), &mesh, &scaled(1.0), &from_above(1.0), &lights);
        assert!(picture.iter().all(|pixel| *pixel == Some([0.0, 1.0, 1.0, 1.0])), "{method:?}");
    }
}

#[test]
fn opengl_shows_the_same() {
    let on = |backends| Gpu::headless(&HeadlessDesc { backends, ..HeadlessDesc::default() }).ok();
    let (Some(vulkan), Some(opengl)) = (on(wgpu::Backends::VULKAN), on(wgpu::Backends::GL)) else {
        println!("skipped: needs an adapter for Vulkan and one for OpenGL");
        return;
    };
    let light = Light::Directional { direction_world: [0.7, 0.4, -0.4], angular_diameter_rad: 0.02 };
    // 24 square layers could be taken for four cube maps.
    for (method, azimuths) in SHADOWED.into_iter().flat_map(|method| [(method, 24), (method, 32)]) {
        let settings = Settings { azimuths, prefilter: true, ambient: true, ..with(method) };
        let [vulkan, opengl] = [&vulkan, &opengl].map(|gpu| {
            let mut stage = Stage::on(gpu.clone());
            stage.set_map(&Map::new([64, 64], bumps));
            stage.picture(&settings, &Mesh::dome(48), &scaled(1.0), &from_above(1.1), &[light])
        });
        let found = difference(&vulkan, &opengl);
        assert!(found < 0.005, "{method:?}, {azimuths} azimuths: {found}");
    }
}
