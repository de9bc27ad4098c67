//! Baking part of the tables: changed rows, needed azimuths, a few at a time, and none any more.

mod bake_support;

use std::{
    ops::ControlFlow,
    sync::atomic::{AtomicU32, Ordering},
};

use bake_support::{Field, bake, gpu, layer, record, texture_layer};
use horizon_shadow::{Baker, Error, Heights, Parts, Progress, Search, Wrap, cpu, wgpu};

#[test]
fn changed_rows_are_baked_again_and_no_others() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    for (wrap, search) in
        [(Wrap::Repeat, Search::Sweep), (Wrap::Clamp, Search::Sweep), (Wrap::Repeat, Search::BruteForce)]
    {
        let before = Field { wrap: [Wrap::Repeat, wrap], ..Field::rough([64, 120], 5) };
        let mut desc = before.desc(2, [0.0, 0.02], 16.0);
        desc.radius_texels = 24.0;
        for rows in [40..44, 0..3, 110..120] {
            let mut after = before.clone();
            for y in rows.clone() {
                (0..64).for_each(|x| after.values[(y * 64 + x) as usize] = ((x ^ y) % 7) as f32 / 6.0);
            }
            let parts = Parts { prefilter: true, ambient: true };
            let views = [before.view(&gpu), after.view(&gpu)];
            let [old, new] = views.each_ref().map(|view| Heights { view, range: before.range });
            let mut edited = baker.start(&gpu, &desc, &old, parts, u64::MAX).expect("a bake");
            record(&gpu, &baker, &mut edited, search);
            let whole = edited.texels_worked();
            assert_eq!(whole, 64 * 120 * 16);
            edited.rows_changed(&new, rows.clone()).expect("the same size");
            assert!(edited.progress().done < edited.progress().total);
            record(&gpu, &baker, &mut edited, search);
            let again = edited.texels_worked() - whole;
            // Along u only the rows themselves and their neighbours depend on them.
            assert!(again < whole / 3, "{rows:?}: {again} of {whole} texels");
            let mut fresh = baker.start(&gpu, &desc, &new, parts, u64::MAX).expect("a bake");
            record(&gpu, &baker, &mut fresh, search);
            let [edited, fresh] = [edited.tables(), fresh.tables()];
            let same = |a: &wgpu::TextureView, b: &wgpu::TextureView, what: &str| {
                let layers = a.texture().depth_or_array_layers();
                for (level, layer) in
                    (0..a.texture().mip_level_count()).flat_map(|l| (0..layers).map(move |i| (l, i)))
                {
                    let [a, b] = [a, b].map(|view| texture_layer(&gpu, view.texture(), level, layer));
                    assert!(a == b, "{what} {rows:?} {wrap:?} level {level} layer {layer}");
                }
            };
            same(&edited.candidates, &fresh.candidates, "candidates");
            same(&edited.extents, &fresh.extents, "extents");
            same(&edited.moments, &fresh.moments, "moments");
            same(&edited.ambient, &fresh.ambient, "ambient");
        }
    }
}

#[test]
fn only_needed_azimuths_are_baked_a_few_at_a_time() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    let field = Field::rough([32, 32], 2);
    let desc = field.desc(2, [0.0, 0.02], 8.0);
    let view = field.view(&gpu);
    let heights = Heights { view: &view, range: field.range };
    let mut some = baker.start(&gpu, &desc, &heights, Parts::default(), 0b1001_0010).expect("a bake");
    assert_eq!((some.baked_azimuths(), some.progress()), (0, Progress { done: 0, total: 3 }));
    let mut step = |at_most| {
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let work = baker.record(&gpu, &mut encoder, &mut some, Search::Sweep, at_most).expect("recorded");
        gpu.queue().submit([encoder.finish()]);
        (work.passes > 0, some.baked_azimuths())
    };
    assert_eq!(step(2), (true, 0b1_0010));
    assert_eq!(step(2), (true, 0b1001_0010));
    assert_eq!(step(2), (false, 0b1001_0010));
    some.want(0b11);
    assert_eq!(some.progress(), Progress { done: 3, total: 4 });
    record(&gpu, &baker, &mut some, Search::Sweep);
    assert_eq!(some.baked_azimuths(), 0b1001_0011);
    let whole = bake(&gpu, &baker, &field, &desc, Search::Sweep, u64::MAX);
    assert_eq!(whole.baked_azimuths(), 0xffff);
    for azimuth in 0..16 {
        let [some, whole] = [&some, &whole].map(|bake| layer(&gpu, bake, azimuth));
        assert_eq!(some == whole, 0b1001_0011 >> azimuth & 1 == 1, "azimuth {azimuth}");
    }
}

#[test]
fn a_cancelled_bake_says_so() {
    let gpu = gpu();
    let baker = Baker::new(&gpu).expect("pipelines");
    let field = Field::rough([32, 32], 2);
    let view = field.view(&gpu);
    let heights = Heights { view: &view, range: field.range };
    let desc = field.desc(2, [0.0, 0.02], 8.0);
    let mut bake = baker.start(&gpu, &desc, &heights, Parts::default(), u64::MAX).expect("a bake");
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    baker.record(&gpu, &mut encoder, &mut bake, Search::Sweep, 5).expect("recorded");
    bake.cancel();
    assert!(bake.is_cancelled());
    let next = baker.record(&gpu, &mut encoder, &mut bake, Search::Sweep, 5);
    assert_eq!(next, Err(Error::Cancelled { done: 5, total: 16 }));
    gpu.queue().submit([encoder.finish()]);
    gpu.wait().expect("the device is well");
    assert_eq!(bake.baked_azimuths(), 0b11111);
}

#[test]
fn the_cpu_bake_reports_and_stops() {
    let field = Field::rough([32, 32], 2);
    let desc = field.desc(2, [0.0, 0.02], 8.0);
    let greatest = AtomicU32::new(0);
    let watch = |progress: Progress| {
        greatest.fetch_max(progress.done, Ordering::Relaxed);
        assert_eq!(progress.total, 3);
        ControlFlow::Continue(())
    };
    let tables = cpu::bake(&field.on_cpu(), &desc, 0b10101, &watch).expect("a bake");
    assert_eq!(greatest.into_inner(), 3);
    let filled: Vec<_> = tables.azimuths.iter().map(|table| !table.is_empty()).collect();
    assert_eq!(filled[..6], [true, false, true, false, true, false]);
    let stop = |progress: Progress| {
        if progress.done == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let stopped = cpu::bake(&field.on_cpu(), &desc, u64::MAX, &stop);
    assert_eq!(stopped.unwrap_err(), Error::Cancelled { done: 2, total: 16 });
}
