//! The f64 model against closed forms and against circles drawn out.

#![allow(missing_docs, reason = "tests")]
#![allow(clippy::float_cmp, reason = "exact answers are promised")]

use horizon_shadow::{
    Wrap,
    model::{self, Candidate, CandidateTables, Map, NO_HORIZON, Point, Ray, Relief, View},
};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

fn degrees(tangent: f64) -> f64 {
    tangent.atan().to_degrees()
}

#[test]
fn the_worked_example() {
    // tan(beta) = 1 at 12 texels, kappa = 0.015: 45 degrees when flat.
    let exact = model::exact(0.015, 12.0, 12.0, 0.0);
    let published = model::paper(0.015, 12.0, 1.0, 0.0);
    assert!((degrees(exact) - 37.30).abs() < 0.005, "{}", degrees(exact));
    assert!((degrees(published) - 42.30).abs() < 0.005, "{}", degrees(published));
    // The far tie of a level relief of height 4: the answer is 0, and that of a far point -19.4.
    assert_eq!(model::exact_slope(0.015, 0.0, 0.0, 4.0), 0.0);
}

#[test]
fn level_ground_has_no_horizon_above_it_at_all() {
    let relief = Relief::new([8, 8], &[4.0; 64], [0.0, 4.0], [Wrap::Repeat; 2]);
    for i in 0..64 {
        let angle = f64::from(i) * 0.1;
        let ray = Ray {
            relief: &relief,
            at: [3.3, 2.7],
            direction: [angle.cos(), angle.sin()],
            kappa: 0.015,
            texels_per_height: 1.0,
            radius_texels: 64.0,
        };
        assert!(ray.march_exact(3).abs() < 1e-15 && ray.near().abs() < 1e-15);
    }
}

#[test]
fn the_dip_keeps_its_digits() {
    // sqrt(2x) (1 + x/4) to second order, for x so small that 1 + x has lost it.
    for x in [1e-6_f64, 1e-8, 5e-8, 1e-12] {
        let series = -(2.0 * x).sqrt() * (1.0 + 0.25 * x);
        assert!((model::floor(1e-3, x * 1e3) / series - 1.0).abs() < 1e-12);
    }
    assert_eq!(model::floor(0.0, 3.0), NO_HORIZON);
    assert_eq!(model::floor(-0.1, 3.0), NO_HORIZON);
    assert_eq!(model::floor(0.1, 0.0), 0.0);
}

/// tan(beta') from coordinates: P and Q above a circle of radius 1 / kappa around the origin.
fn by_circle(kappa: f64, distance: f64, rise: f64, height: f64) -> f64 {
    let radius = 1.0 / kappa;
    let gamma = kappa * distance;
    let q = radius + height + rise;
    // P lies on the y axis; the base's outside is y > radius for both signs of the radius.
    let (x, y) = (q * gamma.sin(), q * gamma.cos() - (radius + height));
    y / x
}

#[test]
fn polynomials_of_small_angles_meet_the_functions() {
    for i in 0..=1000 {
        let angle = FRAC_PI_2 * f64::from(i) / 1000.0;
        let expected = if i == 0 { 0.5 } else { (1.0 - angle.cos()) / (angle * angle) };
        assert!((model::versine(angle) - expected).abs() < 1e-9, "{angle}");
        assert!((model::sinc(angle) * angle - angle.sin()).abs() < 1e-12);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn exact_is_what_a_circle_shows(
        kappa in prop_oneof![-0.05..-1e-4_f64, 1e-4..0.05_f64], part in 0.001..0.999_f64, rise in -8.0..8.0_f64,
        height in 0.0..8.0_f64,
    ) {
        let distance = part * FRAC_PI_2 / f64::abs(kappa);
        prop_assume!(1.0 + kappa * (height + rise) > 1e-3);
        let found = model::exact(kappa, distance, rise, height);
        let expected = by_circle(kappa, distance, rise, height).clamp(NO_HORIZON, -NO_HORIZON);
        prop_assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{found} {expected}");
    }

    #[test]
    fn exact_is_continuous_where_curvature_vanishes(
        kappa in -1e-9..1e-9_f64, distance in 0.5..1000.0_f64, rise in -8.0..8.0_f64, height in 0.0..8.0_f64,
    ) {
        let flat = rise / distance;
        prop_assert!((model::exact(kappa, distance, rise, height) - flat).abs() < 1e-6 * (1.0 + flat.abs()));
    }

    #[test]
    fn nothing_is_seen_beyond_a_quarter_turn_or_the_centre(
        kappa in -2.0..2.0_f64, distance in 0.1..1e4_f64, rise in -100.0..100.0_f64, height in 0.0..100.0_f64,
    ) {
        let found = model::exact(kappa, distance, rise, height);
        prop_assert!(found.is_finite() && found.abs() <= -NO_HORIZON);
        if (kappa * distance).abs() >= FRAC_PI_2 || 1.0 + kappa * (height + rise) <= 0.0 {
            prop_assert_eq!(found, NO_HORIZON);
        }
    }

    /// A candidate's line is a lower bound and the chord an upper one, where the nodes' winners are
    /// the true ones.
    #[test]
    fn the_envelope_lies_between_candidates_and_chord(
        slopes in prop::collection::vec(-0.3..0.6_f64, 12), place in 0.0..1.0_f64, height in 0.0..3.0_f64,
    ) {
        let points: Vec<Candidate> = slopes
            .iter()
            .enumerate()
            .map(|(i, &slope)| Candidate { slope, distance: 1.0 + 2.0 * i as f64 })
            .collect();
        let nodes = [0.0, 0.005, 0.01];
        let tangent = |kappa: f64, c: &Candidate| model::exact_slope(kappa, c.distance, c.slope, height);
        let winners: Vec<Candidate> = nodes
            .iter()
            .map(|&kappa| {
                *points.iter().max_by(|a, b| tangent(kappa, a).total_cmp(&tangent(kappa, b))).unwrap()
            })
            .collect();
        let tables = CandidateTables { azimuths: 4, nodes: &nodes, steepening: 1.0, candidates: &|_, _| vec![] };
        let kappa = 0.01 * place;
        let truth = points.iter().map(|c| tangent(kappa, c)).fold(model::floor(kappa, height), f64::max);
        let envelope = tables.envelope(kappa, height, &winners);
        let chord = tables.chord(kappa, height, &winners).max(model::floor(kappa, height));
        prop_assert!(envelope <= truth + 1e-12);
        // To first order: what is left is the curvature of the lines themselves.
        prop_assert!(chord >= truth - 2e-3, "{chord} {truth}");
        // At a node both are the truth.
        for &node in &nodes {
            let truth = points.iter().map(|c| tangent(node, c)).fold(f64::MIN, f64::max);
            prop_assert!((tables.chord(node, height, &winners) - truth).abs() < 1e-12);
            let with_floor = truth.max(model::floor(node, height));
            prop_assert!((tables.envelope(node, height, &winners) - with_floor).abs() < 1e-12);
        }
    }

    #[test]
    fn a_disc_is_cut_by_its_segment(horizon in -1.5..1.5_f64, light in -1.5..1.5_f64, radius in 1e-3..0.5_f64) {
        let found = model::fraction(horizon, light, radius);
        // Count points of the disc that stand above the line.
        let x = ((light - horizon).sin() / radius.sin()).clamp(-1.0, 1.0);
        let steps = 2000;
        let strip = |i: i32| {
            let y = -1.0 + (f64::from(i) + 0.5) * 2.0 / f64::from(steps);
            if y > -x { (1.0 - y * y).sqrt() } else { 0.0 }
        };
        let counted = (0..steps).map(strip).sum::<f64>() * 4.0 / f64::from(steps) / PI;
        let expected = if (light - horizon).abs() < FRAC_PI_2 { counted } else if light > horizon { 1.0 } else { 0.0 };
        prop_assert!((found - expected).abs() < 2e-3, "{found} {expected}");
    }

    /// The light's azimuth does not depend on how the surface is parametrised: texels walked along
    /// the direction lead, in the world, along the light.
    #[test]
    fn directions_lead_along_the_light(
        u in prop::array::uniform2(-3.0..3.0_f64), v in prop::array::uniform2(-3.0..3.0_f64),
        scale in prop::array::uniform2(prop_oneof![-4.0..-0.1, 0.1..4.0_f64]), azimuth in -PI..PI,
        form in prop::array::uniform3(-0.1..0.1_f64), elevation in -1.4..1.4_f64,
    ) {
        prop_assume!((u[0] * v[1] - u[1] * v[0]).abs() > 0.05);
        let map = Map { size: [100.0, 37.0], uv_scale: scale, height_scale_m: 0.5, texels_per_height: 2.0 };
        let point = Point {
            uv: [0.3, 0.6],
            normal: [0.0, 0.0, 2.0],
            along_u: [u[0], u[1], 0.7],
            along_v: [v[0], v[1], -0.2],
            second_form: form,
        };
        let (sine, cosine) = elevation.sin_cos();
        let light = [cosine * azimuth.cos(), cosine * azimuth.sin(), sine];
        let view = View::new(&map, &point, light).unwrap();
        // World displacement of one texel along the direction.
        let uv = [0, 1].map(|i| view.direction[i] / map.size[i] / scale[i]);
        let step = [0, 1].map(|i| u[i] * uv[0] + v[i] * uv[1]);
        let length = step[0].hypot(step[1]);
        prop_assert!((view.texel_m / length - 1.0).abs() < 1e-9);
        prop_assert!((step[0] - length * azimuth.cos()).abs() < 1e-9 * length);
        prop_assert!((step[1] - length * azimuth.sin()).abs() < 1e-9 * length);
        // II along that texel, per squared length, times the texel.
        let bending = form[0] * uv[0] * uv[0] + 2.0 * form[1] * uv[0] * uv[1] + form[2] * uv[1] * uv[1];
        prop_assert!((view.kappa - bending / length).abs() < 1e-9 * (1.0 + view.kappa.abs()));
        prop_assert!((view.texels_per_height - 0.5 / length).abs() < 1e-9 * view.texels_per_height);
        prop_assert!((view.sine - sine).abs() < 1e-12 && (view.cosine - cosine).abs() < 1e-12);
    }
}

#[test]
fn a_sphere_has_the_curvature_of_its_radius() {
    // Longitude and latitude of a sphere of radius 50 m, from the equator to beside the pole.
    let radius = 50.0_f64;
    for latitude in [0.0_f64, 0.7, 1.5, 1.569] {
        let (s, c) = latitude.sin_cos();
        let point = Point {
            uv: [0.0; 2],
            normal: [c, s, 0.0],
            along_u: [0.0, 0.0, radius * c],
            along_v: [-radius * s, radius * c, 0.0],
            second_form: [radius * c * c, 0.0, radius],
        };
        let map = Map { size: [64.0; 2], uv_scale: [1.0; 2], height_scale_m: 1.0, texels_per_height: 1.0 };
        for azimuth in [0.0, 0.3, 1.2, PI] {
            let light = [-s * f64::sin(azimuth), c * f64::sin(azimuth), f64::cos(azimuth)];
            let view = View::new(&map, &point, light).unwrap();
            assert!((view.kappa / view.texel_m * radius - 1.0).abs() < 1e-6, "{latitude} {azimuth}");
        }
    }
}

#[test]
fn a_collapsed_parametrisation_has_no_view() {
    let map = Map { size: [8.0; 2], uv_scale: [1.0; 2], height_scale_m: 1.0, texels_per_height: 1.0 };
    let point =
        |along_u, along_v, normal| Point { uv: [0.0; 2], normal, along_u, along_v, second_form: [0.0; 3] };
    let up = [0.0, 0.0, 1.0];
    let light = [0.6, 0.0, 0.8];
    assert!(View::new(&map, &point([0.0; 3], [0.0, 1.0, 0.0], up), light).is_none());
    assert!(View::new(&map, &point([1.0, 1.0, 0.0], [2.0, 2.0, 0.0], up), light).is_none());
    assert!(View::new(&map, &point([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]), light).is_none());
    assert!(View::new(&map, &point([f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0], up), light).is_none());
}

/// A relief of one wall, 1 high, of one texel's width at x = 8.
fn wall() -> Relief {
    let heights: Vec<f32> = (0..16 * 16).map(|i| if i % 16 == 8 { 1.0 } else { 0.0 }).collect();
    Relief::new([16, 16], &heights, [0.0, 1.0], [Wrap::Clamp; 2])
}

#[test]
fn a_wall_is_seen_where_it_stands() {
    let relief = wall();
    let ray = |x: f64, direction: [f64; 2], kappa: f64| Ray {
        relief: &relief,
        at: [x, 8.3],
        direction,
        kappa,
        texels_per_height: 2.0,
        radius_texels: 12.0,
    };
    // From 3 texels away its top stands 2 higher.
    assert!((ray(5.0, [1.0, 0.0], 0.0).march_exact(1) - 2.0 / 3.0).abs() < 1e-12);
    assert!((ray(5.0, [1.0, 0.0], 0.02).march_exact(1) - model::exact(0.02, 3.0, 2.0, 0.0)).abs() < 1e-12);
    assert!(
        (ray(11.0, [-1.0, 0.0], -0.02).march_exact(1) - model::exact(-0.02, 3.0, 2.0, 0.0)).abs() < 1e-12
    );
    // Obliquely it is farther away.
    assert!((ray(5.0, [0.8, 0.6], 0.0).march_exact(1) - 2.0 / 3.0 * 0.8).abs() < 1e-12);
    // On its slope the slope itself is the horizon, however near; beside it the near field sees it.
    assert!((ray(7.5, [1.0, 0.0], 0.0).near() - 2.0).abs() < 1e-12);
    assert!((ray(6.75, [1.0, 0.0], 0.0).near() - 2.0 / 1.25).abs() < 1e-12);
    // Coarse steps overlook it.
    assert_eq!(ray(5.0, [1.0, 0.0], 0.0).march(2), 0.0);
    assert!((ray(5.0, [1.0, 0.0], 0.0).march(1200) - 2.0 / 3.0).abs() < 1e-9);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// The near field is that of finely sampled ground, as far as it reaches.
    #[test]
    fn the_near_field_is_the_ground(
        seed in prop::array::uniform32(0.0..1.0_f32), at in prop::array::uniform2(0.0..5.0_f64), azimuth in -PI..PI,
        kappa in -0.02..0.02_f64,
    ) {
        let heights: Vec<f32> = (0..36).map(|i| seed[i % 32]).collect();
        let relief = Relief::new([6, 6], &heights, [0.0, 1.0], [Wrap::Repeat; 2]);
        let ray = Ray {
            relief: &relief, at, direction: [azimuth.cos(), azimuth.sin()], kappa, texels_per_height: 1.0,
            radius_texels: 1.0,
        };
        let fine = (1..=4000).map(|i| ray.tangent(f64::from(i) / 4000.0)).fold(ray.own_tangent(), f64::max);
        // Every sample is a point of the ground; the steepest place moves a little with the curvature.
        prop_assert!(ray.near() > fine - 4e-3, "{} {fine}", ray.near());
        let reach = Ray { radius_texels: 3.0, ..ray };
        prop_assert!(ray.near() <= reach.march_exact(64).max(fine) + 1e-3);
    }
}

#[test]
fn normal_shares_are_those_of_tables() {
    for (x, share) in [(0.0, 0.5), (1.0, 0.841_344_746), (-2.0, 0.022_750_132), (3.5, 0.999_767_371)] {
        assert!((model::normal_share(x) - share).abs() < 1e-8);
    }
}

#[test]
fn heights_that_are_not_numbers_count_as_the_least() {
    let values = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 9.0, -9.0, 0.5];
    let relief = Relief::new([3, 2], &values, [-1.0, 1.0], [Wrap::Clamp; 2]);
    let found: Vec<f64> = (0..6).map(|i| relief.texel([i % 3, i / 3])).collect();
    assert_eq!(found, [0.0, 0.0, 0.0, 2.0, 0.0, 1.5]);
    // Missing ones too, and a map without texels has one.
    assert_eq!(Relief::new([0, 0], &[], [0.0, 1.0], [Wrap::Repeat; 2]).height([1e6, -3.5]), 0.0);
}

#[test]
fn bumps_turn_the_normal_against_their_slope() {
    let map = Map { size: [10.0; 2], uv_scale: [2.0, -1.0], height_scale_m: 1.0, texels_per_height: 1.0 };
    let point = Point {
        uv: [0.0; 2],
        normal: [0.0, 0.0, 1.0],
        along_u: [4.0, 0.0, 0.0],
        along_v: [1.0, 3.0, 0.0],
        second_form: [0.0; 3],
    };
    // Height 0.3 x - 0.2 y in metres: per unit of the map's uv it changes by its gradient along Pu, Pv.
    let (u, v) = ([4.0 / 2.0, 0.0], [-1.0, -3.0]);
    let slopes = [u, v].map(|along: [f64; 2]| 0.3 * along[0] - 0.2 * along[1]);
    let normal = point.bump_normal(&map, slopes);
    let size = (0.09_f64 + 0.04 + 1.0).sqrt();
    for (found, expected) in normal.iter().zip([-0.3 / size, 0.2 / size, 1.0 / size]) {
        assert!((found - expected).abs() < 1e-12);
    }
}

/// A cylinder's place, of which one texel is a metre: x around it, y along its axis, and so high.
fn on_cylinder(radius: f64, x: f64, y: f64, height: f64) -> [f64; 3] {
    let (sine, cosine) = (x / radius).sin_cos();
    [(radius + height) * sine, y, (radius + height) * cosine]
}

/// The light that stands right above the point of a cylinder's relief at x, y, seen from above its
/// origin, both so high; and the tangent of its elevation.
fn towards(radius: f64, to: [f64; 2], heights: [f64; 2]) -> ([f64; 3], f64) {
    let [x, y, z] = on_cylinder(radius, to[0], to[1], heights[1]);
    let up = z - (radius + heights[0]);
    let length = x.hypot(y).hypot(up);
    ([x / length, y / length, up / length], up / x.hypot(y))
}

fn cylinder_point(radius: f64, map: &Map, at: [f64; 2]) -> Point {
    let [u, v] = [0, 1].map(|i| map.size[i] * map.uv_scale[i]);
    Point {
        uv: [(at[0] + 0.5) / u, (at[1] + 0.5) / v],
        normal: [0.0, 0.0, 1.0],
        along_u: [u, 0.0, 0.0],
        along_v: [0.0, v, 0.0],
        second_form: [u * u / radius, 0.0, 0.0],
    }
}

#[test]
fn what_stands_high_on_a_cylinder_is_seen_sideways() {
    // The map lies on a cylinder without distortion, so that azimuths on it are those of the ground.
    for (radius, uv_scale) in
        [(200.0, [1.0, 1.0]), (-200.0, [1.0, 1.0]), (200.0, [-1.0, 1.0]), (200.0, [2.0, -3.0])]
    {
        let map = Map { size: [32.0; 2], uv_scale, height_scale_m: 10.0, texels_per_height: 10.0 };
        let point = cylinder_point(radius, &map, [3.0, 5.0]);
        for angle in [0.25 * PI, 0.6, 2.0, -0.8, -2.5] {
            let (to, heights) = ([12.0 * f64::cos(angle), 12.0 * f64::sin(angle)], [4.0, 9.0]);
            let (light, _) = towards(radius, to, heights);
            let view = View::new(&map, &point, light).unwrap();
            let apart = |view: &View| (view.direction[0] * to[1] - view.direction[1] * to[0]) / 12.0;
            // The post's height, in the map's units.
            let (straight, turned) = (apart(&view), apart(&view.turned(0.9)));
            assert!(straight.abs() > 0.015, "{radius} {angle}: {straight}");
            assert!(turned.abs() < 0.08 * straight.abs(), "{radius} {angle}: {turned} of {straight}");
        }
        // Along the axis and around it nothing turns.
        for light in [[0.8, 0.0, 0.6], [0.0, -0.8, 0.6]] {
            let view = View::new(&map, &point, light).unwrap();
            assert_eq!(view.turned(0.9), view);
        }
    }
}

#[test]
fn spheres_and_planes_do_not_turn_azimuths() {
    let map = Map { size: [64.0, 32.0], uv_scale: [1.0; 2], height_scale_m: 1.0, texels_per_height: 1.0 };
    for curvature in [0.0, 0.02] {
        let (u, v) = ([3.0, 1.0, 0.0], [-0.5, 2.0, 0.0]);
        let point = Point {
            uv: [0.5; 2],
            normal: [0.0, 0.0, 1.0],
            along_u: u,
            along_v: v,
            second_form: [10.0, 0.5, 4.25].map(|dot: f64| curvature * dot),
        };
        for angle in [0.0, 0.7, 2.5, -1.0] {
            let view = View::new(&map, &point, [0.8 * f64::cos(angle), 0.8 * f64::sin(angle), 0.6]).unwrap();
            assert!(view.turn[0].hypot(view.turn[1]) < 1e-15, "{:?}", view.turn);
        }
    }
}

#[test]
fn a_post_on_a_cylinder_shadows_where_it_stands() {
    // Ground 14 high, and a post of one texel that rises 2 above it, at 45 degrees to the axis.
    let heights: Vec<f32> = (0..32 * 32).map(|i| if i == 16 * 32 + 16 { 1.0 } else { 0.875 }).collect();
    let relief = Relief::new([32; 2], &heights, [0.5, 1.0], [Wrap::Clamp; 2]);
    let map = Map { size: [32.0; 2], uv_scale: [1.0; 2], height_scale_m: 16.0, texels_per_height: 16.0 };
    let radius = 80.0;
    let (light, tangent) = towards(radius, [9.0, 9.0], [14.0, 16.0]);
    let view = View::new(&map, &cylinder_point(radius, &map, [7.0, 7.0]), light).unwrap();
    // The light just touches the post's top; without it the ground is the horizon at 0.
    let found = Ray::turned(&relief, &view, 24.0).march_exact(15);
    let straight = Ray::new(&relief, &view, 24.0).march_exact(15);
    println!("{tangent:.4}: turned {found:.4}, straight {straight:.4}");
    assert!((found - tangent).abs() < 0.01, "{found} {tangent}");
    assert!(straight.abs() < 1e-9, "{straight}");
}
