//! Path-traced truths between runs.

use glam::{Mat4, Vec3};
use path_tracer::{Film, Settings};
use scene::{Camera, Material, Scene, builtin, shapes};
use std::{fs, path::PathBuf, sync::Arc, sync::atomic::AtomicBool};
use validation::{Context, Scope, path_traced, scene_of};

/// A folder of truths, removed with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("sheen-truths-{name}-{}", std::process::id()));
        fs::remove_dir_all(&folder).ok();
        Self(folder)
    }

    fn context(&self, fresh: bool) -> Context {
        Context::new(Scope { fresh, ..Scope::default() }, self.0.clone()).unwrap()
    }

    /// The one film that is kept.
    fn film(&self) -> Film {
        let files: Vec<PathBuf> = fs::read_dir(&self.0).unwrap().map(|entry| entry.unwrap().path()).collect();
        assert_eq!(files.len(), 1, "{files:?}");
        Film::from_exr(&fs::read(&files[0]).unwrap(), "kept").unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).ok();
    }
}

fn sphere() -> Scene {
    let environment = builtin::environment_sized("sky", 64).unwrap();
    scene_of(shapes::sphere(16), Material::default(), Mat4::IDENTITY, environment)
}

fn camera() -> Camera {
    Camera { eye: Vec3::new(0.0, 0.5, 3.0), target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.8 }
}

#[test]
fn samples_that_were_kept_are_added_to() {
    let folder = Folder::new("added");
    let mut context = folder.context(false);
    let mut truth =
        |samples| path_traced(&mut context, &sphere(), &camera(), &Settings::new([12, 10], samples)).unwrap();
    let few = truth(8);
    let film = folder.film();
    assert_eq!(film.samples_per_pixel(), 8);
    let many = truth(32);
    assert!(many.how.contains("32 samples a pixel"), "{}", many.how);
    // Fewer than are kept: all of them are taken.
    let again = truth(16);
    assert_eq!((&again.image, &again.variance_of_mean), (&many.image, &many.variance_of_mean));
    let at_once = Folder::new("at-once");
    let whole =
        path_traced(&mut at_once.context(false), &sphere(), &camera(), &Settings::new([12, 10], 32)).unwrap();
    assert_eq!((whole.image, whole.variance_of_mean), (many.image, many.variance_of_mean));
    assert_ne!(few.image, again.image);
}

#[test]
fn a_file_that_is_no_such_film_is_replaced() {
    let folder = Folder::new("replaced");
    let settings = Settings::new([12, 10], 4);
    let truth = |fresh| path_traced(&mut folder.context(fresh), &sphere(), &camera(), &settings).unwrap();
    let first = truth(false);
    let path = fs::read_dir(&folder.0).unwrap().next().unwrap().unwrap().path();
    fs::write(&path, "no picture").unwrap();
    assert_eq!(truth(false).image, first.image);
    assert_eq!(folder.film().samples_per_pixel(), 4);
    assert_eq!(truth(true).image, first.image);
}

#[test]
fn a_run_that_is_stopped_fails_and_keeps_what_it_has() {
    let folder = Folder::new("stopped");
    let stop = Arc::new(AtomicBool::new(true));
    let mut context = folder.context(false).with_progress(stop, |_| {});
    let settings = Settings::new([64, 64], 4096);
    let error = path_traced(&mut context, &sphere(), &camera(), &settings).unwrap_err();
    assert_eq!(error.to_string(), "stopped");
    // Nothing, or whole samples of every pixel.
    if folder.0.exists() {
        assert!((1..4096).contains(&folder.film().samples_per_pixel()));
    }
}
