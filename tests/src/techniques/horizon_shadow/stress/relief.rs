//! Functions that read the height map, on a small one whose every texel is known.

use super::{case, real, within};
use crate::{
    Context, bindings,
    technique::{Bound, Failure, Input, StressCase, Tolerance},
};
use compositor::wgpu;
use gpu_context::upload;
use horizon_shadow::{
    Wrap,
    model::{Map, Point, Ray, Relief},
};
use std::sync::LazyLock;

const SIZE: [u32; 2] = [8, 5];
const RADIUS: f64 = 10.0;
const PARAMETERS: &str = "
fn stage() -> HorizonShadowParameters {
    var p: HorizonShadowParameters;
    p.size = vec2f(8.0, 5.0); p.uv_scale = vec2f(1.0); p.least_height = -1.0; p.greatest_height = 1.0;
    p.height_scale_m = 1.5; p.texels_per_height = 1.5; p.radius_texels = 10.0; p.wrap = 1u; p.march_steps = 40u;
    return p;
}
@group(1) @binding(0) var heights: texture_2d<f32>;
";

static HEIGHTS: LazyLock<Vec<f32>> = LazyLock::new(|| {
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 7.0];
    let texel =
        |i: u32| if i % 11 == 3 { odd[i as usize / 11] } else { ((i * i * 37) % 41) as f32 / 20.5 - 1.0 };
    (0..SIZE[0] * SIZE[1]).map(texel).collect()
});

static RELIEF: LazyLock<Relief> =
    LazyLock::new(|| Relief::new(SIZE, &HEIGHTS, [-1.0, 1.0], [Wrap::Repeat, Wrap::Clamp]));

pub(super) fn cases() -> Vec<StressCase> {
    vec![
        texel(),
        bilinear(),
        height_m(),
        normal(),
        near(),
        march(),
        marched(),
        sanitised(),
        wrapped(),
        reduced(),
    ]
}

fn bind(context: &mut Context) -> Result<Bound, Failure> {
    let gpu = context.gpu();
    let format = wgpu::TextureFormat::R32Float;
    let bytes = bytemuck::cast_slice(&HEIGHTS);
    let texture = upload::texture_2d(gpu, "heights", SIZE[0], SIZE[1], format, bytes, None)?;
    let layout = bindings::layout(
        gpu.device(),
        "heights",
        &[bindings::texture(false, wgpu::TextureViewDimension::D2)],
    );
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("heights"),
        layout: &layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) }],
    });
    Ok(Bound { declarations: PARAMETERS.into(), layout, group })
}

fn staged(
    function: &'static str,
    inputs: Vec<Input>,
    body: &'static str,
    outputs: &'static [&'static str],
    tolerance: Tolerance,
    model: impl Fn(&[f64]) -> Vec<f64> + Sync + 'static,
) -> StressCase {
    StressCase {
        bindings: Some(Box::new(bind)),
        samples: Some(50_000),
        ..case(function, inputs, body, outputs, tolerance, model)
    }
}

fn texel() -> StressCase {
    staged(
        "horizon_shadow_texel",
        vec![Input::Integer { below: 4000 }, Input::Integer { below: 40 }],
        "y[0] = horizon_shadow_texel(heights, stage(), vec2i(vec2u(u[0], u[1])) - vec2i(2000, 20));",
        &["height"],
        within(1e-6, 0.0, "a difference"),
        |x| vec![RELIEF.texel([x[0] as i64 - 2000, x[1] as i64 - 20])],
    )
}

fn bilinear() -> StressCase {
    staged(
        "horizon_shadow_bilinear",
        vec![real(-100.0, 100.0), real(-20.0, 20.0)],
        "y[0] = horizon_shadow_bilinear(heights, stage(), vec2f(x[0], x[1]));",
        &["height"],
        within(4e-5, 0.0, "the place within a texel keeps 2^-17 of it; heights differ by 2"),
        |x| vec![RELIEF.height([x[0], x[1]])],
    )
}

fn height_m() -> StressCase {
    staged(
        "horizon_shadow_height_m",
        vec![real(-3.0, 3.0), real(-0.5, 1.5)],
        "y[0] = horizon_shadow_height_m(heights, stage(), vec2f(x[0], x[1]));",
        &["height"],
        within(2e-5, 0.0, "the place within a texel keeps 2^-18 of it; heights differ by 3 metres"),
        |x| vec![1.5 * (RELIEF.height([x[0] * 8.0 - 0.5, x[1].clamp(0.0, 1.0) * 5.0 - 0.5]) - 1.0)],
    )
}

fn normal() -> StressCase {
    let map = Map { size: [8.0, 5.0], uv_scale: [1.0; 2], height_scale_m: 1.5, texels_per_height: 1.5 };
    staged(
        "horizon_shadow_normal",
        vec![real(-2.0, 2.0), real(0.2, 0.8), real(-3.0, 3.0), real(-3.0, 3.0)],
        "let surface = HorizonShadowSurface(vec2f(x[0], x[1]), vec2f(0.0), vec2f(0.0), vec3f(0.0, 0.0, 1.0),
            vec3f(8.0, x[2], 0.0), vec3f(x[3], 5.0, 0.0), vec3f(0.0));
         let n = horizon_shadow_normal(heights, stage(), surface);
         y[0] = n.x; y[1] = n.y; y[2] = n.z;",
        &["x", "y", "z"],
        within(3e-4, 0.0, "slopes up to 3 of differences whose places keep 2^-18 of a texel"),
        move |x| {
            let at = [x[0] * 8.0 - 0.5, x[1] * 5.0 - 0.5];
            let rise = |u: f64, v: f64| {
                RELIEF.height([at[0] + u, at[1] + v]) - RELIEF.height([at[0] - u, at[1] - v])
            };
            let point = Point {
                uv: [x[0], x[1]],
                normal: [0.0, 0.0, 1.0],
                along_u: [8.0, x[2], 0.0],
                along_v: [x[3], 5.0, 0.0],
                second_form: [0.0; 3],
            };
            point.bump_normal(&map, [12.0 * rise(0.5, 0.0), 7.5 * rise(0.0, 0.5)]).to_vec()
        },
    )
}

/// A point, an azimuth and a curvature.
fn rays() -> Vec<Input> {
    vec![real(0.01, 7.0), real(-0.4, 4.4), real(-3.1, 3.1), real(-0.1, 0.1)]
}

fn ray(x: &[f64]) -> Ray<'static> {
    Ray {
        relief: &RELIEF,
        at: [x[0], x[1]],
        direction: [x[2].cos(), x[2].sin()],
        kappa: x[3],
        texels_per_height: 1.5,
        radius_texels: RADIUS,
    }
}

/// Rays for which rounding decides which cells they cross, or what stands at an edge.
fn is_edge(x: &[f64]) -> bool {
    let near_line = |c: f64| (c - c.round()).abs() < 1e-3;
    near_line(x[0]) || near_line(x[1]) || x[2].cos().abs() < 1e-3 || x[2].sin().abs() < 1e-3
}

fn near() -> StressCase {
    staged(
        "horizon_shadow_near",
        rays(),
        "var view: HorizonShadowView;
         view.at = vec2f(x[0], x[1]); view.direction = vec2f(cos(x[2]), sin(x[2])); view.kappa = x[3];
         view.texels_per_height = 1.5;
         let cell = horizon_shadow_cell(heights, stage(), view.at, view.direction);
         let corners = cell.heights * 1.5;
         let height = dot(horizon_shadow_weights(cell.fraction), corners);
         y[0] = horizon_shadow_sine_of(horizon_shadow_near(heights, stage(), view, cell, corners, height));",
        &["sine"],
        within(2e-3, 0.0, "whether a third cell begins before or after one texel is a matter of rounding"),
        |x| {
            // A cell that begins at one texel may count or not.
            let crossings = ray(x).crossings(0.0, 4.0);
            let on_edge = crossings.iter().take(4).any(|d| (d - 1.0).abs() < 1e-4);
            vec![if is_edge(x) || on_edge { f64::NAN } else { horizon_shadow::model::sine_of(ray(x).near()) }]
        },
    )
}

const MARCH: &str = "var view: HorizonShadowView;
         view.at = vec2f(x[0], x[1]); view.direction = vec2f(cos(x[2]), sin(x[2])); view.kappa = x[3];
         view.texels_per_height = 1.5;
         let height = horizon_shadow_bilinear(heights, stage(), view.at) * 1.5;
         y[0] = horizon_shadow_sine_of(horizon_shadow_march(heights, stage(), view, height, 0.25, 0.25,
            horizon_shadow_floor(view.kappa, height), -1e4, 1e4));";

/// Uniform steps.
fn march() -> StressCase {
    staged(
        "horizon_shadow_march",
        rays(),
        MARCH,
        &["sine"],
        within(
            5e-4,
            0.0,
            "the adapter's sine and cosine, and places that keep 2^-20 of a texel, 4 times as steep",
        ),
        |x| {
            let ray = ray(x);
            let steps = (2..=40).map(|i| ray.tangent(0.25 * f64::from(i)));
            vec![horizon_shadow::model::sine_of(steps.fold(ray.floor(), f64::max))]
        },
    )
}

/// Crossings and the middles between them.
fn marched() -> StressCase {
    staged(
        "horizon_shadow_march [crossings]",
        rays(),
        "var view: HorizonShadowView;
         view.at = vec2f(x[0], x[1]); view.direction = vec2f(cos(x[2]), sin(x[2])); view.kappa = x[3];
         view.texels_per_height = 1.5;
         let height = horizon_shadow_bilinear(heights, stage(), view.at) * 1.5;
         y[0] = horizon_shadow_sine_of(horizon_shadow_march(heights, stage(), view, height, 1.0, 0.0,
            horizon_shadow_floor(view.kappa, height), -1e4, 1e4));",
        &["sine"],
        within(5e-4, 0.0, "crossings closer than 1e-4 of a texel are one, and the adapter's sine and cosine"),
        |x| {
            let ray = ray(x);
            // Whether a crossing lies before or after the start is a matter of rounding.
            if is_edge(x) || ray.crossings(0.99, 1.01).len() > 2 {
                return vec![f64::NAN];
            }
            let best = ray.crossings(1.0, RADIUS).windows(2).fold(ray.floor(), |best, pair| {
                best.max(ray.tangent(0.5 * (pair[0] + pair[1]))).max(ray.tangent(pair[1]))
            });
            vec![horizon_shadow::model::sine_of(best)]
        },
    )
}

fn sanitised() -> StressCase {
    staged(
        "horizon_shadow_sanitised",
        vec![Input::Any { least: -3.0, greatest: 3.0 }],
        "y[0] = horizon_shadow_sanitised(vec4f(x[0]), stage()).y;",
        &["height"],
        within(1e-6, 0.0, "a difference"),
        |x| vec![if x[0].is_finite() { x[0].clamp(-1.0, 1.0) + 1.0 } else { 0.0 }],
    )
}

fn wrapped() -> StressCase {
    staged(
        "horizon_shadow_wrapped",
        vec![Input::Integer { below: 16 }, Input::Integer { below: 12 }],
        "let at = horizon_shadow_wrapped(vec2f(vec2u(u[0], u[1])) - vec2f(5.0, 4.0), stage());
         y[0] = f32(at.x); y[1] = f32(at.y);",
        &["x", "y"],
        within(0.0, 0.0, "whole numbers"),
        |x| RELIEF.wrapped([x[0] as i64 - 5, x[1] as i64 - 4]).map(f64::from).to_vec(),
    )
}

fn reduced() -> StressCase {
    staged(
        "horizon_shadow_reduced",
        vec![real(-1e4, 1e4), real(-1e4, 1e4)],
        "let at = horizon_shadow_reduced(vec2f(x[0], x[1]), stage());
         let turn = 6.283185307 * at.x / 8.0;
         y[0] = cos(turn); y[1] = sin(turn); y[2] = at.y;",
        &["cosine", "sine", "y"],
        within(1e-3, 0.0, "places of 1e4 texels keep 2^-10 of one"),
        |x| {
            let turn = std::f64::consts::TAU * x[0] / 8.0;
            vec![turn.cos(), turn.sin(), x[1].clamp(-1.0, 5.0)]
        },
    )
}
