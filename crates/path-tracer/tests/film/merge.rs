//! Any partition in any order gives the same bits, and what does not belong together is refused.

use crate::common::{SIZE, film, identity};
use path_tracer::{Film, Identity, Merge};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_partition_in_any_order_is_the_whole(
        cuts in proptest::collection::btree_set(1_u32..24, 0..8),
        order in proptest::collection::vec(any::<u32>(), 10),
    ) {
        let ends: Vec<u32> = [0].into_iter().chain(cuts).chain([24]).collect();
        let mut parts: Vec<Film> = ends.windows(2).map(|ends| film(ends[0]..ends[1])).collect();
        parts.sort_by_key(|part| order[part.samples().ranges()[0].start as usize % order.len()]);
        prop_assert_eq!(Film::merge(parts).unwrap(), film(0..24));
    }
}

#[test]
fn merged_films_give_the_same_file() {
    let merged = Film::merge(vec![film(16..20), film(0..3), film(3..16)]).unwrap();
    assert_eq!(merged.to_exr().unwrap(), film(0..20).to_exr().unwrap());
}

/// The message of a merge with a film of some other identity or size.
fn refusal(size: [u32; 2], change: impl FnOnce(&mut Identity)) -> String {
    let mut other = identity();
    change(&mut other);
    let mut other = Film::new(size, other).unwrap();
    other.finish_samples(4..8).unwrap();
    let mut merge = Merge::new("a.exr", film(0..4));
    let error = merge.add("b.exr", &other).unwrap_err().to_string();
    assert_eq!(merge.finish(), film(0..4), "as before");
    error
}

#[test]
fn other_pictures_are_refused() {
    let narrow = refusal([7, 18], |_| {});
    assert_eq!(narrow, "b.exr: size: found 7 x 18 pixels, expected 7 x 19 pixels as in a.exr");
    let other = refusal(SIZE, |identity| identity.fingerprint = 1);
    let expected = "b.exr: fingerprint: found 00000000000000000000000000000001, \
         expected 0123456789abcdef00000000000000ff as in a.exr";
    assert_eq!(other, expected);
    for (part, change) in [
        ("version: found 9.9", (|identity| identity.version = "9.9".into()) as fn(&mut Identity)),
        ("seed: found 3", |identity| identity.seed = 3),
        ("settings: found none", |identity| identity.settings = "none".into()),
    ] {
        let error = refusal(SIZE, change);
        assert!(error.contains(part) && error.starts_with("b.exr") && error.contains("a.exr"), "{error}");
    }
}

#[test]
fn overlaps_name_both_films() {
    let mut merge = Merge::new("a.exr", film(0..4));
    merge.add("b.exr", &film(8..16)).unwrap();
    let error = merge.add("c.exr", &film(6..10)).unwrap_err().to_string();
    assert_eq!(error, "c.exr: samples: found 8..10, which b.exr has too, expected each sample in one film");
    let error = merge.add("a.exr", &film(0..4)).unwrap_err().to_string();
    assert!(error.contains("a.exr: samples: found 0..4, which a.exr has too"), "{error}");
    assert_eq!(merge.finish().samples().to_string(), "0..4, 8..16");
    assert!(Film::merge(Vec::new()).is_err());
}

#[test]
fn the_scene_may_have_another_name() {
    let renamed = |samples| {
        let mut identity = identity();
        identity.scene = "moved.toml".into();
        let mut renamed = Film::new(SIZE, identity).unwrap();
        renamed.finish_samples(samples).unwrap();
        renamed
    };
    for films in [vec![film(0..1), renamed(1..2)], vec![renamed(1..2), film(0..1)]] {
        assert_eq!(Film::merge(films).unwrap().identity(), &identity());
    }
}
