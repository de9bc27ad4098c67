//! The repository's own small scenes and images.

use std::path::{Path, PathBuf};

use scene::load::{environment, height_map, load_scene};
use scene::{Limits, builtin};

fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets").join(folder);
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(!paths.is_empty());
    for path in &paths {
        assert!(path.metadata().unwrap().len() < 200_000, "{} is too large", path.display());
    }
    paths
}

#[test]
fn every_scene_loads_without_a_warning_and_is_in_the_picture() {
    for path in files("scenes") {
        let scene = load_scene(&path, &Limits::default()).unwrap();
        assert_eq!(scene.warnings, [], "{}", path.display());
        assert!(scene.environment.is_some(), "{}", path.display());
        let camera = scene.camera.unwrap();
        let clip_from_world = camera.clip_from_world(16.0 / 9.0, camera.near_m());
        for instance in scene.instances.iter().filter(|instance| scene.meshes[instance.mesh].name != "plane")
        {
            for position in &scene.meshes[instance.mesh].positions {
                let clip = clip_from_world * instance.world_from_local * position.extend(1.0);
                let is_inside = clip.x.abs() < clip.w && clip.y.abs() < clip.w;
                assert!(is_inside, "{}: {}", path.display(), instance.name);
            }
        }
    }
}

#[test]
fn environments_hold_the_light_they_were_made_of() {
    let paths = files("environments");
    assert_eq!(paths.len(), 3);
    for path in paths {
        let (environment, warnings) = environment(&path, &Limits::default()).unwrap();
        assert_eq!(warnings, [], "{}", path.display());
        let made_of =
            environment.name.split('_').next().and_then(|name| builtin::environment_sized(name, 128));
        let Some(made_of) = made_of else { continue };
        let (mean, expected) = (environment.mean_radiance(), made_of.mean_radiance());
        assert!(((mean - expected) / expected).abs().max_element() < 0.01, "{mean} {expected}");
    }
}

/// The step over each border is no larger than the largest step inside.
#[test]
fn height_maps_repeat_without_a_seam() {
    let paths = files("height_maps");
    assert_eq!(paths.len(), 3);
    for path in paths {
        let (map, _) = height_map(&path, &Limits::default()).unwrap();
        let side = map.width as usize;
        assert_eq!((side, map.heights.len()), (128, 128 * 128));
        let at = |x: usize, y: usize| map.heights[(y % side) * side + x % side];
        let step = |x: usize, y: usize| (at(x + 1, y) - at(x, y)).abs().max((at(x, y + 1) - at(x, y)).abs());
        let inside = (0..side - 1).flat_map(|y| (0..side - 1).map(move |x| (x, y)));
        let largest = inside.map(|(x, y)| step(x, y)).fold(0.0, f32::max);
        let seam = (0..side).map(|i| step(i, side - 1).max(step(side - 1, i))).fold(0.0, f32::max);
        assert!(seam <= largest, "{}: {seam} {largest}", path.display());
    }
}
