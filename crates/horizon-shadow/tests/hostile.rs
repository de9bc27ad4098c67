//! Inputs that break naive code, on whole pictures of the ready pass: what is known is compared,
//! and nothing may be an error of the device.

mod stage;

use gpu_context::HeadlessDesc;
use horizon_shadow::{Gpu, VertexFrame, Wrap, wgpu};
use stage::known::{CURVED, SHADOWED, TEXEL_M, bumps, check_shadow, column, difference, ridge, row, with};
use stage::{Instance, Map, Mesh, Picture, SIDE, Stage, diagonal, from_above, place, save, scaled, towards};

/// Lit exactly where the unit dome faces the light; pixels within `margin` of the terminator and
/// of the rim do not count.
fn check_smooth_dome(what: &str, picture: &Picture, light: [f32; 3], margin: f32) {
    let mut counts = [0; 2];
    for (i, pixel) in picture.iter().enumerate() {
        let [x, z] = place(i).map(|x| x * 1.1);
        let up = 1.0 - x * x - z * z;
        let Some(pixel) = pixel.filter(|_| up > 0.02) else { continue };
        let length = light.iter().map(|x| x * x).sum::<f32>().sqrt();
        let n_l = (x * light[0] + up.sqrt() * light[1] + z * light[2]) / length;
        if n_l.abs() > margin {
            let expected = f32::from(n_l > 0.0);
            assert!((pixel[0] - expected).abs() < 0.01, "{what}: {} where n.l = {n_l}", pixel[0]);
            counts[usize::from(n_l > 0.0)] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 100), "{what}: {counts:?} dark and lit pixels");
}

#[test]
fn an_azimuth_of_half_a_turn_is_no_seam() {
    let mut stage = Stage::new();
    stage.set_map(&ridge([64, 64]));
    for z in [0.0, -0.0, 1e-9, -1e-9, 1e-5, -1e-5, f32::MIN_POSITIVE] {
        for method in SHADOWED {
            let lights = [towards([-1.0, 1.0, z])];
            let picture =
                stage.picture(&with(method), &Mesh::plane(), &scaled(1.0), &from_above(1.0), &lights);
            check_shadow(&format!("{method:?} {z}"), &picture, 32..39, column);
        }
    }
}

#[test]
fn heights_that_are_no_numbers_count_as_the_least() {
    let mut stage = Stage::new();
    let mut map = ridge([64, 64]);
    let clean = map.clone();
    for (i, value) in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -f32::NAN].into_iter().enumerate() {
        for place in [3, 17, 25, 40, 64 * 9 + 50, 64 * 33 + 12, 64 * 50 + 5] {
            map.values[place + 64 * i] = value;
        }
    }
    for method in SHADOWED {
        let mut draw = |map: &Map| {
            stage.set_map(map);
            let lights = [towards([1.0, 1.0, 0.0])];
            stage.picture(&with(method), &Mesh::plane(), &scaled(1.0), &from_above(1.0), &lights)
        };
        assert!(draw(&map) == draw(&clean), "{method:?}");
    }
    // Nothing but such heights: a plane.
    let mut nothing = Map::new([8, 8], |_, _| f32::NAN);
    nothing.range = [0.0, 1.0];
    stage.set_map(&nothing);
    for method in SHADOWED {
        let lights = [towards([1.0, 0.2, 0.3]), towards([1.0, -0.2, 0.3])];
        let picture = stage.picture(&with(method), &Mesh::plane(), &scaled(1.0), &from_above(1.0), &lights);
        assert!(picture.iter().all(|p| *p == Some([1.0, 0.0, 1.0, 1.0])), "{method:?}");
    }
}

/// 4 texels of height everywhere at a curvature of 0.015 / texel: texels of 0.015 m on the dome.
fn constant_height(range: [f32; 2]) -> Map {
    let side = (std::f32::consts::PI / 0.015).round() as u32;
    Map { range, ..Map::new([side, side], |_, _| 4.0 * 0.015) }
}

#[test]
fn a_constant_height_is_the_smooth_surface() {
    let mut stage = Stage::new();
    let light = [0.8, 0.3, 0.2];
    for (what, range, methods) in [
        ("known to be constant", [0.06, 0.06], &SHADOWED[..]),
        // The tables are baked; the answer of the exact methods is that of the smooth sphere too.
        ("not known", [0.0, 0.12], &CURVED[..]),
    ] {
        stage.set_map(&constant_height(range));
        let pictures: Vec<_> = methods
            .iter()
            .map(|&method| {
                let lights = [towards(light)];
                stage.picture(&with(method), &Mesh::dome(64), &scaled(1.0), &from_above(1.1), &lights)
            })
            .collect();
        save(&format!("constant-{what}"), &pictures);
        for (method, picture) in methods.iter().zip(&pictures) {
            check_smooth_dome(&format!("{method:?}, {what}"), picture, light, 0.004);
        }
    }
}

#[test]
fn one_texel_is_a_constant_map() {
    let mut stage = Stage::new();
    let light = [0.8, 0.3, 0.2];
    stage.set_map(&Map { range: [0.0, 0.2], ..Map::new([1, 1], |_, _| 0.1) });
    for method in SHADOWED {
        let lights = [towards(light)];
        let picture = stage.picture(&with(method), &Mesh::plane(), &scaled(1.0), &from_above(1.0), &lights);
        assert!(picture.iter().all(|pixel| *pixel == Some([1.0; 4])), "{method:?}");
    }
}

#[test]
fn spikes_and_steps_stay_where_they_are() {
    let mut stage = Stage::new();
    let mut draw = |map: &Map, method| {
        stage.set_map(map);
        let lights = [towards([1.0, 1.0, 0.0])];
        stage.picture(&with(method), &Mesh::plane(), &scaled(1.0), &from_above(1.0), &lights)
    };
    let spike = Map::new([64, 64], |i, j| if (i, j) == (40, 20) { 12.0 * TEXEL_M } else { 0.0 });
    let pictures = SHADOWED.map(|method| draw(&spike, method));
    save("spike", &pictures);
    for (method, picture) in SHADOWED.iter().zip(&pictures) {
        let at = |x: usize, y: usize| picture[y * SIDE as usize + x].unwrap()[0];
        assert!((30..40).all(|x| at(x, 20) < 0.01), "{method:?}");
        assert!((0..27).chain(42..64).all(|x| at(x, 20) > 0.99), "{method:?}");
        let away = (0..64).filter(|y| !(17..24).contains(y));
        assert!(away.flat_map(|y| (0..64).map(move |x| (x, y))).all(|(x, y)| at(x, y) > 0.99), "{method:?}");
    }
    // A wall of 31 metres, a thousand texels.
    let mut wall = Map::new([64, 64], |i, _| if i >= 32 { 1000.0 * TEXEL_M } else { 0.0 });
    wall.wrap = [Wrap::Clamp; 2];
    for method in SHADOWED {
        check_shadow(&format!("{method:?}, wall"), &draw(&wall, method), 0..32, column);
    }
}

#[test]
fn mirrored_uvs_and_mirrored_instances_show_the_same() {
    let gpu = Gpu::headless(&HeadlessDesc::default()).expect("an adapter");
    let mut stage = Stage::on(gpu.clone());
    let mut mirror = Stage::with(gpu, wgpu::TextureFormat::Rgba8Unorm, wgpu::FrontFace::Cw);
    let side = 64;
    let bumps = |i: u32, j: u32| ((i * 7 % side + j * 3 % side) as f32 * 0.19).sin().max(0.0) * 0.1;
    let map = Map::new([side, side], bumps);
    let turned = Map::new([side, side], |i, j| bumps(side - 1 - i, j));
    let lights = [towards([0.7, 0.4, -0.4])];
    for mesh in [Mesh::plane(), Mesh::dome(48)] {
        for method in CURVED {
            stage.set_map(&map);
            let plain = stage.picture(&with(method), &mesh, &scaled(1.0), &from_above(1.1), &lights);
            stage.set_map(&turned);
            let uvs = mesh.clone().with_mirrored_uv();
            let uvs = stage.picture(&with(method), &uvs, &scaled(1.0), &from_above(1.1), &lights);
            mirror.set_map(&turned);
            let instance = diagonal([-1.0, 1.0, 1.0]);
            let instance = mirror.picture(&with(method), &mesh, &instance, &from_above(1.1), &lights);
            save(
                &format!("mirror-{method:?}-{}", mesh.vertices.len()),
                &[plain.clone(), uvs.clone(), instance.clone()],
            );
            let [uvs, instance] = [uvs, instance].map(|picture| difference(&plain, &picture));
            assert!(uvs < 0.005 && instance < 0.005, "{method:?}: {uvs} {instance}");
        }
    }
}

#[test]
fn millimetres_and_kilometres_are_as_metres() {
    let mut stage = Stage::new();
    let lights = [towards([0.7, 0.4, -0.4])];
    for method in SHADOWED {
        let mut draw = |scale: f32| {
            let map = Map::new([64, 64], bumps);
            stage.set_map(&Map { height_scale_m: scale, ..map });
            stage.picture(&with(method), &Mesh::dome(48), &scaled(scale), &from_above(1.1 * scale), &lights)
        };
        let metres = draw(1.0);
        for scale in [1e-6, 1e-3, 1e3, 1e6] {
            let found = difference(&draw(scale), &metres);
            assert!(found < 0.003, "{method:?} at {scale}: {found}");
        }
    }
}

#[test]
fn a_hundred_times_denser_along_u_changes_nothing_across() {
    let mut stage = Stage::new();
    let mut map = Map::new([64, 64], |_, j| if (30..32).contains(&j) { 8.0 * TEXEL_M } else { 0.0 });
    map.uv_scale = [100.0, 1.0];
    stage.set_map(&map);
    for method in SHADOWED {
        for direction in [[0.0, 1.0, 1.0], [0.9, 0.3, 0.1]] {
            let lights = [towards(direction)];
            // Texels along v count, as the ridge is across it.
            let prepared = stage.prepare_with(&with(method), &Mesh::plane(), &scaled(1.0), |frame| {
                frame.surface.texel_m = TEXEL_M;
            });
            prepared.expect("prepare");
            let picture = stage.draw(&Mesh::plane(), &scaled(1.0), &from_above(1.0), &lights);
            assert_eq!(stage.gpu.take_errors(), []);
            if direction[0] == 0.0 {
                check_shadow(&format!("{method:?}"), &picture, 23..30, row);
            }
        }
    }
}

#[test]
fn where_nothing_is_known_of_the_metric_the_surface_counts_as_smooth() {
    let mut stage = Stage::new();
    stage.set_map(&ridge([64, 64]));
    let light = [0.8, 0.3, 0.2];
    let odd = [0.0, f32::NAN, f32::INFINITY, 1e-30, 1e30];
    for value in odd {
        let mut mesh = Mesh::dome(32);
        for vertex in &mut mesh.vertices {
            vertex.frame = VertexFrame { along_u: [value; 3], along_v: [value; 3], second_form: [value; 3] };
        }
        for method in SHADOWED {
            let lights = [towards(light)];
            let picture = stage.picture(&with(method), &mesh, &scaled(1.0), &from_above(1.1), &lights);
            check_smooth_dome(&format!("{method:?} {value}"), &picture, light, 0.01);
        }
    }
}

#[test]
fn at_the_pole_of_a_sphere_the_surface_counts_as_smooth() {
    let mut stage = Stage::new();
    stage.set_map(&constant_height([0.0, 0.12]));
    // Latitude and longitude about +y: the whole row v = 0 is the pole in the picture's middle.
    let mesh = Mesh {
        curvature_per_m: [1.0; 2],
        metres_per_uv: std::f32::consts::PI,
        ..Mesh::grid(64, |u, v| {
            let (longitude, polar) = (u * std::f32::consts::TAU, v * 1.5);
            let (s, c) = (polar.sin(), polar.cos());
            let normal = [s * longitude.cos(), c, -s * longitude.sin()];
            let tau = std::f32::consts::TAU;
            let along_u = [-tau * s * longitude.sin(), 0.0, -tau * s * longitude.cos()];
            let along_v = [1.5 * c * longitude.cos(), -1.5 * s, -1.5 * c * longitude.sin()];
            let second_form = [tau * tau * s * s, 0.0, 2.25];
            let frame = VertexFrame { along_u, along_v, second_form };
            stage::Vertex { position: normal, normal, uv: [u, v], frame }
        })
    };
    let light = [0.8, 0.3, 0.2];
    for method in CURVED {
        let lights = [towards(light)];
        let picture = stage.picture(&with(method), &mesh, &scaled(1.0), &from_above(1.1), &lights);
        save(&format!("pole-{method:?}"), std::slice::from_ref(&picture));
        let covered = picture.iter().flatten().count();
        assert!(covered > 2000, "{covered}");
        check_smooth_dome(&format!("{method:?}"), &picture, light, 0.03);
    }
}

#[test]
fn instances_without_volume_and_meshes_without_area_do_no_harm() {
    let gpu = Gpu::headless(&HeadlessDesc::default()).expect("an adapter");
    let mut stage = Stage::with(gpu, wgpu::TextureFormat::Rgba16Float, wgpu::FrontFace::Ccw);
    stage.set_map(&ridge([64, 64]));
    let flat: Instance = diagonal([1.0, 0.0, 1.0]);
    let lights = [towards([1.0, 1.0, 0.0])];
    let mut no_area = Mesh::dome(16);
    no_area.vertices.iter_mut().step_by(3).for_each(|vertex| *vertex = stage::Vertex::default());
    for method in SHADOWED {
        for (mesh, instance) in [(&Mesh::dome(16), flat), (&no_area, scaled(1.0))] {
            let picture = stage.picture(&with(method), mesh, &instance, &from_above(1.1), &lights);
            assert!(picture.iter().flatten().flatten().all(|x| (0.0..=1.0).contains(x)), "{method:?}");
        }
    }
}
