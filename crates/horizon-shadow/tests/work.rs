//! What is baked when, what is skipped, and what is an error.

mod stage;

use horizon_shadow::{
    BAKE_CANCELLED, CONSTANT_HEIGHT, Frame, Method, NO_AZIMUTH_NEEDED, NO_HEIGHT_MAP, NO_TABLES_NEEDED,
    ONE_CURVATURE, Precision, Progress, Search, Settings, TABLES_STAND, Tables, Work, Wrap,
};
use stage::known::bumps;
use stage::{Map, Mesh, Picture, Stage, from_above, scaled, towards};

const SHEEN: Settings = Settings { azimuths: 12, prefilter: false, ..Settings::SHEEN };

fn stage() -> Stage {
    let mut stage = Stage::new();
    stage.set_map(&Map::new([64, 48], bumps));
    stage
}

/// Prepares for the plane with a frame that is changed first.
fn prepare(stage: &mut Stage, settings: &Settings, change: impl FnOnce(&mut Frame<'_>)) -> Work {
    let mut plane = Mesh::plane();
    plane.curvature_per_m = [0.0, 0.5];
    let work = stage.prepare_with(settings, &plane, &scaled(1.0), change).expect("prepare");
    assert_eq!(stage.gpu.take_errors(), []);
    work
}

fn draw(stage: &mut Stage) -> Picture {
    let lights = [towards([0.8, 0.4, 0.3]), towards([0.9, 0.4, -0.3])];
    stage.draw(&Mesh::plane(), &scaled(1.0), &from_above(1.0), &lights)
}

#[test]
fn without_a_height_map_nothing_is_made() {
    let mut stage = Stage::new();
    assert_eq!(prepare(&mut stage, &SHEEN, |_| {}), Work::skipped(NO_HEIGHT_MAP));
    assert_eq!(stage.surface.memory_bytes(), 0);
    assert!(stage.surface.bind_group().is_none());
    assert!(draw(&mut stage).iter().all(Option::is_none), "nothing is drawn");

    stage.set_map(&Map::new([64, 48], bumps));
    assert!(prepare(&mut stage, &SHEEN, |_| {}).passes > 0);
    assert!(stage.surface.memory_bytes() > 0 && stage.surface.bind_group().is_some());
    assert!(draw(&mut stage).iter().all(Option::is_some));
    // What a map took is given back with it.
    stage.remove_map();
    assert_eq!(prepare(&mut stage, &SHEEN, |_| {}), Work::skipped(NO_HEIGHT_MAP));
    assert_eq!((stage.surface.memory_bytes(), stage.surface.progress()), (0, Progress::default()));
    assert!(draw(&mut stage).iter().all(Option::is_none), "nothing is drawn");
}

#[test]
fn tables_stand_while_nothing_that_decides_them_changes() {
    let mut stage = stage();
    assert!(prepare(&mut stage, &SHEEN, |_| {}).passes > 0);
    assert_eq!(stage.surface.progress(), Progress { done: 12, total: 12 });
    let stands = Work::skipped(TABLES_STAND);
    assert_eq!(prepare(&mut stage, &SHEEN, |_| {}), stands);
    let certified = Settings { method: Method::Certified, march_steps: 7, ..SHEEN };
    assert_eq!(prepare(&mut stage, &certified, |_| {}), stands, "both methods read the same tables");
    let turned = |frame: &mut Frame<'_>| frame.height_map.as_mut().unwrap().uv_scale = [-1.0, 2.0];
    assert_eq!(prepare(&mut stage, &SHEEN, turned), stands, "uv_scale is the look-up's alone");

    let changed = [
        Settings { azimuths: 13, ..SHEEN },
        Settings { candidates: 3, ..SHEEN },
        Settings { precision: Precision::Full, ..SHEEN },
        Settings { search: Search::BruteForce, ..SHEEN },
        Settings { radius_texels: 20.0, ..SHEEN },
        Settings { prefilter: true, ..SHEEN },
        Settings { ambient: true, ..SHEEN },
        Settings { method: Method::Paper, ..SHEEN },
        Settings { method: Method::Paper, tables: Tables::DistanceAndHeight, ..SHEEN },
        Settings { method: Method::Flat, ..SHEEN },
    ];
    for settings in changed {
        assert!(prepare(&mut stage, &settings, |_| {}).passes > 0, "{settings:?}");
        assert_eq!(prepare(&mut stage, &settings, |_| {}), stands, "{settings:?}");
    }
    let frames: [fn(&mut Frame<'_>); 6] = [
        |frame| frame.surface.texel_m *= 2.0,
        |frame| frame.surface.curvature_per_m[1] = 0.7,
        |frame| frame.height_map.as_mut().unwrap().height_scale_m = 0.5,
        |frame| frame.height_map.as_mut().unwrap().range = [0.0, 0.2],
        |frame| frame.height_map.as_mut().unwrap().wrap = [Wrap::Repeat, Wrap::Clamp],
        |frame| frame.height_map.as_mut().unwrap().revision += 10,
    ];
    for (index, change) in frames.into_iter().enumerate() {
        prepare(&mut stage, &SHEEN, |_| {});
        assert!(prepare(&mut stage, &SHEEN, change).passes > 0, "change {index}");
        assert_eq!(prepare(&mut stage, &SHEEN, change), stands, "change {index}");
    }
}

#[test]
fn memory_is_what_the_tables_take() {
    let mut stage = stage();
    let texels = 64 * 48;
    // Least and greatest horizon of 8 x 6 tiles.
    let tiles = 12 * 8 * 6 * 2;
    for (settings, bytes) in [
        (SHEEN, 12 * texels * 4 + tiles),
        (Settings { candidates: 1, ..SHEEN }, 12 * texels * 2 + tiles),
        (Settings { candidates: 4, ..SHEEN }, 12 * texels * 8 + tiles),
        (Settings { precision: Precision::Full, ..SHEEN }, 12 * texels * 8 + tiles),
        (Settings { method: Method::Paper, ..SHEEN }, 12 * texels * 2),
        (Settings { method: Method::Exact, tables: Tables::DistanceAndHeight, ..SHEEN }, 12 * texels),
        (Settings { method: Method::Flat, ..SHEEN }, 12 * texels),
        (Settings { method: Method::Marched, ..SHEEN }, 0),
        (Settings { method: Method::None, ..SHEEN }, 0),
    ] {
        prepare(&mut stage, &settings, |_| {});
        assert_eq!(stage.surface.memory_bytes(), bytes, "{settings:?}");
    }
}

#[test]
fn methods_without_tables_bake_none() {
    let mut stage = stage();
    prepare(&mut stage, &SHEEN, |_| {});
    for method in [Method::None, Method::Marched] {
        let settings = Settings { method, ..SHEEN };
        assert_eq!(prepare(&mut stage, &settings, |_| {}), Work::skipped(NO_TABLES_NEEDED));
        assert_eq!(stage.surface.memory_bytes(), 0);
        assert!(draw(&mut stage).iter().all(Option::is_some));
    }
}

#[test]
fn constant_heights_bake_nothing() {
    let mut stage = Stage::new();
    stage.set_map(&Map::new([16, 16], |_, _| 3.5));
    for method in [Method::Flat, Method::Paper, Method::Exact, Method::Sheen, Method::Certified] {
        let settings = Settings { method, ..SHEEN };
        assert_eq!(prepare(&mut stage, &settings, |_| {}), Work::skipped(CONSTANT_HEIGHT));
        assert_eq!(stage.surface.memory_bytes(), 0);
        let lights = [towards([1.0, 0.01, 0.0]), towards([1.0, -0.01, 0.0])];
        let picture = stage.draw(&Mesh::plane(), &scaled(1.0), &from_above(1.0), &lights);
        assert!(picture.iter().all(|pixel| *pixel == Some([1.0, 0.0, 1.0, 1.0])), "{method:?}");
    }
    // Bumps that are scaled away are none either.
    stage.set_map(&Map { height_scale_m: 0.0, ..Map::new([16, 16], bumps) });
    assert_eq!(prepare(&mut stage, &SHEEN, |_| {}), Work::skipped(CONSTANT_HEIGHT));
}

#[test]
fn only_needed_azimuths_are_baked_and_those_that_stand_are_kept() {
    let mut stage = stage();
    let needs = |azimuths| move |frame: &mut Frame<'_>| frame.needed_azimuths = azimuths;
    assert_eq!(prepare(&mut stage, &SHEEN, needs(0)), Work::skipped(NO_AZIMUTH_NEEDED));
    assert_eq!(stage.surface.memory_bytes(), 0);
    // Azimuths that do not exist are none.
    assert_eq!(prepare(&mut stage, &SHEEN, needs(1 << 12)), Work::skipped(NO_AZIMUTH_NEEDED));

    let two = prepare(&mut stage, &SHEEN, needs(0b11));
    assert!(two.passes > 0);
    assert_eq!(stage.surface.progress(), Progress { done: 2, total: 2 });
    assert_eq!(prepare(&mut stage, &SHEEN, needs(0b10)), Work::skipped(TABLES_STAND));
    let one_more = prepare(&mut stage, &SHEEN, needs(0b110));
    assert!(one_more.passes > 0 && one_more.passes <= two.passes, "{one_more:?}, {two:?}");
    assert_eq!(stage.surface.progress(), Progress { done: 3, total: 3 });
    prepare(&mut stage, &SHEEN, needs(u64::MAX));
    assert_eq!(stage.surface.progress(), Progress { done: 12, total: 12 });
    // None needed any more: what stands is kept for the next light.
    assert_eq!(prepare(&mut stage, &SHEEN, needs(0)), Work::skipped(NO_AZIMUTH_NEEDED));
    assert_eq!(prepare(&mut stage, &SHEEN, needs(u64::MAX)), Work::skipped(TABLES_STAND));

    // Grown step by step, the tables are those of one bake.
    let grown = draw(&mut stage);
    let mut whole = self::stage();
    prepare(&mut whole, &SHEEN, |_| {});
    assert!(draw(&mut whole) == grown);
}

#[test]
fn a_bake_is_spread_over_calls() {
    let mut whole = stage();
    prepare(&mut whole, &SHEEN, |_| {});
    let whole = draw(&mut whole);
    let mut stage = stage();
    let settings = Settings { azimuths_per_prepare: 5, ..SHEEN };
    for done in [5, 10, 12] {
        let work = prepare(&mut stage, &settings, |_| {});
        assert!(work.passes > 0 && work.skipped.is_none(), "{work:?}");
        assert_eq!(stage.surface.progress(), Progress { done, total: 12 });
        let picture = draw(&mut stage);
        assert!(picture.iter().all(Option::is_some), "what is baked so far can be drawn");
        assert_eq!(picture == whole, done == 12, "after {done}");
    }
    assert_eq!(prepare(&mut stage, &settings, |_| {}), Work::skipped(TABLES_STAND));
}

#[test]
fn a_cancelled_bake_stays_as_it_is_until_something_changes() {
    let mut stage = stage();
    stage.surface.cancel();
    let settings = Settings { azimuths_per_prepare: 5, ..SHEEN };
    prepare(&mut stage, &settings, |_| {});
    stage.surface.cancel();
    assert_eq!(prepare(&mut stage, &settings, |_| {}), Work::skipped(BAKE_CANCELLED));
    assert_eq!(stage.surface.progress(), Progress { done: 5, total: 12 });
    assert!(draw(&mut stage).iter().all(Option::is_some));
    let other = |frame: &mut Frame<'_>| frame.height_map.as_mut().unwrap().revision += 1;
    for done in [5, 10, 12] {
        assert!(prepare(&mut stage, &settings, other).passes > 0);
        assert_eq!(stage.surface.progress(), Progress { done, total: 12 });
    }
    // There is nothing left to cancel.
    stage.surface.cancel();
    assert_eq!(prepare(&mut stage, &settings, other), Work::skipped(TABLES_STAND));
}

#[test]
fn one_curvature_needs_one_candidate() {
    let mut stage = stage();
    let same = |frame: &mut Frame<'_>| frame.surface.curvature_per_m = [0.5; 2];
    let work = prepare(&mut stage, &SHEEN, same);
    assert!(work.passes > 0 && work.skipped == Some(ONE_CURVATURE), "{work:?}");
    assert_eq!(stage.surface.memory_bytes(), 12 * (64 * 48 * 2 + 8 * 6 * 2));
    assert_eq!(prepare(&mut stage, &SHEEN, same), Work::skipped(TABLES_STAND));
}

#[test]
fn changed_rows_alone_are_baked_again() {
    let edited = |i: u32, j: u32| if (20..24).contains(&j) { bumps(i, j) + 0.02 } else { bumps(i, j) };
    let flat_elsewhere = |i: u32, j: u32| if (20..24).contains(&j) { edited(i, j) } else { 0.0 };
    let range = [0.0, 0.15];
    let draw_with = |stage: &mut Stage| {
        let lights = [towards([0.1, 0.4, 0.8])];
        stage.draw(&Mesh::plane(), &scaled(1.0), &from_above(1.0), &lights)
    };
    let settings = Settings { radius_texels: 6.0, ..SHEEN };
    let wide = |height: &dyn Fn(u32, u32) -> f32| Map { range, ..Map::new([64, 64], height) };

    let mut fresh = Stage::new();
    fresh.set_map(&wide(&edited));
    prepare(&mut fresh, &settings, |_| {});
    let expected = draw_with(&mut fresh);

    let mut stage = Stage::new();
    stage.set_map(&wide(&bumps));
    prepare(&mut stage, &settings, |_| {});
    let before = draw_with(&mut stage);
    assert!(before != expected, "the edit shows");
    let rows = |frame: &mut Frame<'_>| frame.height_map.as_mut().unwrap().changed_rows = Some(20..24);
    stage.set_map(&wide(&edited));
    assert!(prepare(&mut stage, &settings, rows).passes > 0);
    assert_eq!(stage.surface.progress(), Progress { done: 12, total: 12 });
    assert!(draw_with(&mut stage) == expected, "the same as a fresh bake");
    assert_eq!(prepare(&mut stage, &settings, rows), Work::skipped(TABLES_STAND));

    // Rows that have changed without the host's saying so keep their old tables: had everything been
    // baked again, these would be those of a plane.
    stage.set_map(&wide(&flat_elsewhere));
    prepare(&mut stage, &settings, rows);
    let mut plane = Stage::new();
    plane.set_map(&wide(&flat_elsewhere));
    prepare(&mut plane, &settings, |_| {});
    let kept = dark_rows(&draw_with(&mut stage), 40..60);
    let of_plane = draw_with(&mut plane);
    let gone = dark_rows(&of_plane, 40..60);
    assert!(kept > 50 && gone == 0, "{kept} pixels are dark far from the edit, {gone} of a fresh bake");

    // A revision that was passed over leaves unknown what changed in it.
    stage.set_map(&wide(&edited));
    stage.set_map(&wide(&flat_elsewhere));
    prepare(&mut stage, &settings, rows);
    assert!(draw_with(&mut stage) == of_plane);
}

fn dark_rows(picture: &Picture, rows: std::ops::Range<usize>) -> usize {
    let side = stage::SIDE as usize;
    picture[rows.start * side..rows.end * side].iter().flatten().filter(|pixel| pixel[0] < 0.5).count()
}

#[test]
fn a_surface_that_the_pass_was_not_prepared_for_is_not_drawn() {
    let mut stage = stage();
    prepare(&mut stage, &SHEEN, |_| {});
    assert!(draw(&mut stage).iter().all(Option::is_some));
    prepare(&mut stage, &Settings { method: Method::Paper, ..SHEEN }, |_| {});
    let unprepared = stage.draw_with_the_pass_as_it_is(&Mesh::plane(), &scaled(1.0));
    assert!(unprepared.iter().all(Option::is_none));
    assert!(draw(&mut stage).iter().all(Option::is_some));
}

#[test]
fn surfaces_that_share_pipelines_have_tables_of_their_own() {
    let mut stage = stage();
    prepare(&mut stage, &SHEEN, |_| {});
    let alone = draw(&mut stage);
    let mut other = stage.surface.for_another_surface(&stage.gpu).unwrap();
    std::mem::swap(&mut stage.surface, &mut other);
    assert_eq!(stage.surface.memory_bytes(), 0);
    assert!(prepare(&mut stage, &SHEEN, |_| {}).passes > 0);
    assert!(draw(&mut stage) == alone);
    // What one of them gives back, the other keeps.
    stage.remove_map();
    prepare(&mut stage, &SHEEN, |_| {});
    assert_eq!(stage.surface.memory_bytes(), 0);
    std::mem::swap(&mut stage.surface, &mut other);
    assert!(stage.surface.memory_bytes() > 0);
    assert!(draw(&mut stage) == alone);
}
