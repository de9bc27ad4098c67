//! Lights in the frame of a surface point, and what of the tables they fall on.

use super::{case, real, within};
use crate::technique::{Input, StressCase, Tolerance};
use horizon_shadow::model::{self, Map, Point, Slices, View};

pub(super) fn cases() -> Vec<StressCase> {
    vec![
        view(),
        turned(),
        middle(),
        map_uv(),
        slices(),
        is_baked(),
        node(),
        node_position(),
        footprint(),
        is_night(),
        dual(),
        mean(),
    ]
}

/// A unit light, and a point: uv axes of a plane with shear and tilt, and a second form.
fn points() -> Vec<Input> {
    let mut inputs = vec![Input::UnitVector];
    inputs.extend([real(0.1, 10.0), real(-3.0, 3.0), real(-3.0, 3.0), real(0.1, 10.0)]);
    inputs.extend([real(-5.0, 5.0), real(-5.0, 5.0), real(-5.0, 5.0)]);
    inputs
}

fn point(x: &[f64]) -> Point {
    Point {
        uv: [0.3, 0.6],
        normal: [0.0, 0.0, 1.0],
        along_u: [x[3], x[4], 0.5],
        along_v: [x[5], x[6], -0.25],
        second_form: [x[7], x[8], x[9]],
    }
}

const MAP: Map =
    Map { size: [64.0, 32.0], uv_scale: [2.0, -1.0], height_scale_m: 0.5, texels_per_height: 3.0 };

fn is_sheared(x: &[f64]) -> bool {
    let area = x[3] * x[6] - x[4] * x[5];
    area.abs() < 0.02 * x[3].hypot(x[4]) * x[5].hypot(x[6])
}

fn view() -> StressCase {
    case(
        "horizon_shadow_view",
        points(),
        "var p: HorizonShadowParameters;
         p.size = vec2f(64.0, 32.0); p.uv_scale = vec2f(2.0, -1.0); p.height_scale_m = 0.5;
         p.texels_per_height = 3.0; p.wrap = 3u;
         let surface = HorizonShadowSurface(vec2f(0.3, 0.6), vec2f(0.0), vec2f(0.0), vec3f(0.0, 0.0, 1.0),
            vec3f(x[3], x[4], 0.5), vec3f(x[5], x[6], -0.25), vec3f(x[7], x[8], x[9]));
         let v = horizon_shadow_view(p, surface, vec3f(x[0], x[1], x[2]));
         y[0] = v.direction.x; y[1] = v.direction.y; y[2] = v.sine; y[3] = v.cosine; y[4] = v.kappa;
         y[5] = v.texels_per_height; y[6] = v.turn.x; y[7] = v.turn.y;",
        &[
            "direction x",
            "direction y",
            "sine",
            "cosine",
            "curvature",
            "texels per height",
            "turn x",
            "turn y",
        ],
        Tolerance {
            absolute: 1e-4,
            relative: 1e-4,
            slack: None,
            reason: "axes within 1/50 of each other are left out: so much larger than f32's are the roundings",
        },
        |x| {
            let light = [x[0], x[1], x[2]];
            // Beside the zenith the azimuth is that of what rounding left.
            if is_sheared(x) || light[0].hypot(light[1]) < 1e-2 {
                return vec![f64::NAN; 8];
            }
            View::new(&MAP, &point(x), light).map_or(vec![f64::NAN; 8], |v| {
                let View { direction: [x, y], turn, sine, cosine, kappa, texels_per_height, .. } = v;
                vec![x, y, sine, cosine, kappa, texels_per_height, turn[0], turn[1]]
            })
        },
    )
}

/// The direction and lengths after the turn, for leans on both sides of their bound.
fn turned() -> StressCase {
    case(
        "horizon_shadow_turned",
        vec![real(-3.1, 3.1), real(-0.5, 0.5), real(-0.5, 0.5), real(-3.0, 3.0)],
        "var view: HorizonShadowView;
         view.direction = vec2f(cos(x[0]), sin(x[0])); view.turn = vec2f(x[1], x[2]);
         view.kappa = 0.25; view.texels_per_height = 2.0; view.steepening = 0.5;
         let v = horizon_shadow_turned(view, x[3]);
         y[0] = v.direction.x; y[1] = v.direction.y; y[2] = v.kappa; y[3] = v.texels_per_height; y[4] = v.steepening;",
        &["direction x", "direction y", "curvature", "texels per height", "steepening"],
        within(1e-5, 1e-5, "cosines of the adapter, over a direction no shorter than 1/4"),
        |x| {
            let straight = View {
                at: [0.0; 2],
                direction: [x[0].cos(), x[0].sin()],
                turn: [x[1], x[2]],
                sine: 0.0,
                cosine: 1.0,
                kappa: 0.25,
                texel_m: 1.0,
                texels_per_height: 2.0,
            };
            let v = straight.turned(x[3]);
            vec![v.direction[0], v.direction[1], v.kappa, v.texels_per_height, 0.25 * v.texels_per_height]
        },
    )
}

fn middle() -> StressCase {
    case(
        "horizon_shadow_middle",
        vec![real(-10.0, 10.0), real(-10.0, 10.0)],
        "var p: HorizonShadowParameters;
         p.least_height = x[0]; p.greatest_height = x[1];
         y[0] = horizon_shadow_middle(p);",
        &["height"],
        within(1e-6, 1e-6, "a sum"),
        |x| vec![0.5 * (x[0] + x[1])],
    )
}

fn map_uv() -> StressCase {
    case(
        "horizon_shadow_map_uv",
        vec![real(-100.0, 100.0), real(-3.0, 3.0)],
        "var p: HorizonShadowParameters;
         p.uv_scale = vec2f(2.0, -1.0); p.wrap = 1u;
         let uv = horizon_shadow_map_uv(p, vec2f(x[0], x[1]));
         y[0] = cos(6.283185307 * uv.x); y[1] = sin(6.283185307 * uv.x); y[2] = uv.y;",
        &["cosine", "sine", "v"],
        within(2e-4, 0.0, "200 turns keep 2^-17 of one"),
        |x| {
            let turn = std::f64::consts::TAU * 2.0 * x[0];
            vec![turn.cos(), turn.sin(), (-x[1]).clamp(0.0, 1.0)]
        },
    )
}

fn slices() -> StressCase {
    case(
        "horizon_shadow_slices",
        vec![real(-3.1, 3.1)],
        "var p: HorizonShadowParameters;
         p.azimuths = 32u; p.baked_azimuths = vec2u(0xffffffffu, 0u);
         let s = horizon_shadow_slices(p, vec2f(cos(x[0]), sin(x[0])));
         y[0] = (1.0 - s.weight) * cos(f32(s.first) * 0.19634954) + s.weight * cos(f32(s.second) * 0.19634954);
         y[1] = (1.0 - s.weight) * sin(f32(s.first) * 0.19634954) + s.weight * sin(f32(s.second) * 0.19634954);",
        &["blended cosine", "blended sine"],
        within(5e-5, 0.0, "the adapter's atan2, good to 4e-6, in azimuths of 0.2"),
        |x| {
            let s = Slices::new([x[0].cos(), x[0].sin()], 32);
            let angle = |azimuth: u32| std::f64::consts::TAU * f64::from(azimuth) / 32.0;
            let blend = |f: fn(f64) -> f64| {
                (1.0 - s.weight) * f(angle(s.azimuths[0])) + s.weight * f(angle(s.azimuths[1]))
            };
            vec![blend(f64::cos), blend(f64::sin)]
        },
    )
}

fn is_baked() -> StressCase {
    case(
        "horizon_shadow_is_baked",
        vec![Input::Integer { below: 64 }],
        "var p: HorizonShadowParameters;
         p.baked_azimuths = vec2u(0x80000005u, 0x40000002u);
         y[0] = select(0.0, 1.0, horizon_shadow_is_baked(p, u[0]));",
        &["baked"],
        within(0.0, 0.0, "bits"),
        |x| vec![f64::from(u8::from([0.0, 2.0, 31.0, 33.0, 62.0].contains(&x[0])))],
    )
}

fn node() -> StressCase {
    case(
        "horizon_shadow_node",
        vec![Input::Integer { below: 4 }, Input::Integer { below: 4 }],
        "var p: HorizonShadowParameters;
         p.least_curvature = -0.01; p.greatest_curvature = 0.02; p.candidates = u[1] + 1u;
         y[0] = horizon_shadow_node(p, min(u[0], u[1]));",
        &["curvature"],
        within(1e-8, 0.0, "a product and two sums"),
        |x| {
            let index = x[0].min(x[1]);
            vec![if x[1] == 0.0 { 0.005 } else { -0.01 + 0.03 * index / x[1] }]
        },
    )
}

fn node_position() -> StressCase {
    case(
        "horizon_shadow_node_position",
        vec![real(-0.1, 0.1), real(0.01, 10.0)],
        "var p: HorizonShadowParameters;
         p.least_curvature = -0.01; p.greatest_curvature = 0.02; p.candidates = 4u;
         y[0] = horizon_shadow_node_position(p, x[0], x[1]);",
        &["position"],
        within(1e-5, 1e-5, "a quotient of differences"),
        |x| vec![3.0 * ((x[0] + 0.01 * x[1]) / (0.03 * x[1])).clamp(0.0, 1.0)],
    )
}

fn footprint() -> StressCase {
    case(
        "horizon_shadow_footprint",
        vec![real(-10.0, 10.0), real(-10.0, 10.0), real(-10.0, 10.0), real(-10.0, 10.0)],
        "var p: HorizonShadowParameters;
         p.size = vec2f(64.0, 32.0); p.uv_scale = vec2f(2.0, -1.0);
         var surface: HorizonShadowSurface;
         surface.uv_dx = vec2f(x[0], x[1]); surface.uv_dy = vec2f(x[2], x[3]);
         y[0] = horizon_shadow_footprint(p, surface);",
        &["texels"],
        within(1e-12, 1e-6, "a square root"),
        |x| vec![(128.0 * x[0]).hypot(32.0 * x[1]).max((128.0 * x[2]).hypot(32.0 * x[3]))],
    )
}

fn is_night() -> StressCase {
    case(
        "horizon_shadow_is_night",
        vec![real(-0.1, 0.1), real(-1.0, 1.0)],
        "var p: HorizonShadowParameters;
         p.least_height = -1.0; p.greatest_height = 3.0;
         var view: HorizonShadowView;
         view.kappa = x[0]; view.texels_per_height = 2.0;
         y[0] = select(0.0, 1.0, horizon_shadow_is_night(p, view, x[1]));",
        &["night"],
        within(0.0, 0.0, "a comparison; what lies within 1e-5 of its edge is left out"),
        |x| {
            if x[0] < 0.0 {
                return vec![0.0];
            }
            let bent = 8.0 * x[0];
            let edge = -(bent * (2.0 + bent)).sqrt();
            let tangent = model::tangent_of(x[1]);
            let close = (tangent - edge).abs() < 1e-5 * (1.0 + edge.abs());
            vec![if close { f64::NAN } else { f64::from(u8::from(tangent < edge)) }]
        },
    )
}

/// The dual basis is what the uv axes are measured with.
fn dual() -> StressCase {
    case(
        "horizon_shadow_dual",
        points(),
        "var p: HorizonShadowParameters;
         p.uv_scale = vec2f(2.0, -1.0);
         let u_axis = vec3f(x[3], x[4], 0.5);
         let v_axis = vec3f(x[5], x[6], -0.25);
         let surface = HorizonShadowSurface(vec2f(0.0), vec2f(0.0), vec2f(0.0), vec3f(0.0, 0.0, 1.0), u_axis, v_axis,
            vec3f(0.0));
         let d = horizon_shadow_dual(p, surface, vec3f(0.0, 0.0, 1.0));
         y[0] = dot(d.u, u_axis) / 2.0; y[1] = dot(d.u, v_axis); y[2] = dot(d.v, u_axis); y[3] = -dot(d.v, v_axis);
         y[4] = d.u.z; y[5] = d.v.z;",
        &["u along u", "u along v", "v along u", "v along v", "u along n", "v along n"],
        within(1e-3, 0.0, "axes within 1/50 of each other are left out"),
        |x| if is_sheared(x) { vec![f64::NAN; 6] } else { vec![1.0, 0.0, 0.0, 1.0, 0.0, 0.0] },
    )
}

fn mean() -> StressCase {
    case(
        "horizon_shadow_mean_curvature_place",
        points(),
        "var p: HorizonShadowParameters;
         p.height_scale_m = 1.0; p.texels_per_height = 10.0; p.least_curvature = -0.5; p.greatest_curvature = 1.5;
         let surface = HorizonShadowSurface(vec2f(0.0), vec2f(0.0), vec2f(0.0), vec3f(0.0, 0.0, 1.0),
            vec3f(x[3], x[4], 0.0), vec3f(x[5], x[6], 0.0), vec3f(x[7], x[8], x[9]));
         y[0] = horizon_shadow_mean_curvature_place(p, surface, vec3f(0.0, 0.0, 1.0));",
        &["place"],
        within(1e-3, 1e-3, "axes within 1/50 of each other are left out"),
        |x| {
            let (e, f, g) = (x[3] * x[3] + x[4] * x[4], x[3] * x[5] + x[4] * x[6], x[5] * x[5] + x[6] * x[6]);
            let mean = 0.5 * (x[7] * g - 2.0 * x[8] * f + x[9] * e) / (e * g - f * f);
            vec![if is_sheared(x) { f64::NAN } else { f64::midpoint(0.1 * mean, 0.5).clamp(0.0, 1.0) }]
        },
    )
}
