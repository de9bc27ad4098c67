//! What the user named: a scene, an environment, or both.

use crate::{cli::SceneArguments, commands::Failure};
use scene::{Camera, Environment, Error, Limits, Scene, Warning, builtin, load};
use std::fmt;
use std::path::{Path, PathBuf};

/// The name of the built-in scene.
pub(crate) const BUILT_IN_SCENE: &str = "showroom";

/// The environment of scenes that bring no light at all.
pub(crate) const DEFAULT_ENVIRONMENT: &str = "studio";

/// Where an environment comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum EnvironmentSource {
    /// Made by name.
    BuiltIn(&'static str),
    /// Read.
    File(PathBuf),
    /// Darkness.
    None,
}

/// A scene file and an environment, as far as the user named them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Inputs {
    /// The built-in scene where none is named.
    pub(crate) scene: Option<PathBuf>,
    /// The scene's own where none is named.
    pub(crate) environment: Option<EnvironmentSource>,
}

impl Inputs {
    /// Tells files apart by their extension: one scene at most, and one environment at most. A file
    /// of any other kind counts as a scene, so that loading it says what it should have been.
    pub(crate) fn of_files(files: &[PathBuf]) -> Result<Self, String> {
        let mut inputs = Self::default();
        for file in files {
            let taken = if load::is_environment(file) {
                inputs.environment.replace(EnvironmentSource::File(file.clone())).is_some()
            } else {
                inputs.scene.replace(file.clone()).is_some()
            };
            if taken {
                return Err(format!(
                    "{}: found a second file of its kind, expected one scene and one environment at most; a .toml scene file places several models",
                    file.display()
                ));
            }
        }
        Ok(inputs)
    }

    /// Loads what was named, and nothing else.
    pub(crate) fn load_named(&self) -> Result<Scene, Error> {
        let mut scene = match &self.scene {
            None => builtin::scene(),
            Some(path) if path == Path::new(BUILT_IN_SCENE) && !path.exists() => builtin::scene(),
            Some(path) => load::load_scene(path, &Limits::default())?,
        };
        if let Some(source) = &self.environment {
            let (environment, warnings) = source.load()?;
            scene.environment = environment;
            scene.warnings.extend(warnings);
        }
        Ok(scene)
    }

    /// Loads what was named. A scene that would be black because nothing lights it gets a built-in
    /// environment, with a warning.
    pub(crate) fn load_lit(&self) -> Result<Scene, Error> {
        let mut scene = self.load_named()?;
        if self.environment.is_none() && is_unlit(&scene) {
            scene.environment = builtin::environment(DEFAULT_ENVIRONMENT);
            let message =
                format!("there is none; the built-in environment \"{DEFAULT_ENVIRONMENT}\" lights it");
            scene.warnings.push(Warning { file: scene.name.clone(), place: "light".into(), message });
        }
        Ok(scene)
    }
}

impl fmt::Display for Inputs {
    /// What is named, to follow "loading".
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.scene, &self.environment) {
            (Some(scene), _) => write!(formatter, "{}", scene.display()),
            (None, Some(EnvironmentSource::File(file))) => write!(formatter, "{}", file.display()),
            (None, Some(EnvironmentSource::BuiltIn(name))) => write!(formatter, "the environment \"{name}\""),
            (None, Some(EnvironmentSource::None)) => formatter.write_str("no environment"),
            (None, None) => formatter.write_str("the built-in scene"),
        }
    }
}

impl SceneArguments {
    /// Loads what the arguments name; as [`Inputs::load_lit`].
    pub(crate) fn load(&self) -> Result<Scene, Failure> {
        let mut inputs = Inputs::of_files(&self.files).map_err(Failure::Usage)?;
        if let Some(source) = &self.environment
            && inputs.environment.replace(source.clone()).is_some()
        {
            return Err(Failure::Usage(
                "found two environments: a file beside the scene, and --environment".into(),
            ));
        }
        let mut scene = inputs.load_lit()?;
        if let (Some(environment), Some(degrees)) = (&mut scene.environment, self.rotation) {
            environment.rotation_rad = degrees.to_radians();
        }
        Ok(scene)
    }

    /// The scene's camera or one that sees everything, moved where the arguments say so.
    pub(crate) fn camera(&self, scene: &Scene) -> Camera {
        let camera = camera(scene, self.size);
        Camera { eye: self.eye.unwrap_or(camera.eye), target: self.target.unwrap_or(camera.target), ..camera }
    }
}

/// The scene's camera or one that sees everything.
pub(crate) fn camera(scene: &Scene, [width, height]: [u32; 2]) -> Camera {
    scene.camera.unwrap_or_else(|| scene.framing_camera(width as f32 / height as f32))
}

/// Whether neither lights nor an environment light the scene.
pub(crate) fn is_unlit(scene: &Scene) -> bool {
    scene.environment.is_none() && scene.lights.is_empty()
}

impl EnvironmentSource {
    /// A built-in name, "none", or else a file.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        if text == "none" {
            return Ok(Self::None);
        }
        if let Some(name) = builtin::ENVIRONMENT_NAMES.into_iter().find(|name| *name == text) {
            return Ok(Self::BuiltIn(name));
        }
        if load::is_environment(Path::new(text)) {
            return Ok(Self::File(text.into()));
        }
        let names = [&builtin::ENVIRONMENT_NAMES[..], &["none"]].concat();
        Err(format!("expected {}; or an .hdr or .exr file", scene::suggestion(text, &names)))
    }

    /// The environment, and what was noticed in its file.
    pub(crate) fn load(&self) -> Result<(Option<Environment>, Vec<Warning>), Error> {
        match self {
            Self::None => Ok((None, Vec::new())),
            Self::BuiltIn(name) => Ok((builtin::environment(name), Vec::new())),
            Self::File(path) => {
                let (environment, warnings) = load::environment(path, &Limits::default())?;
                Ok((Some(environment), warnings))
            }
        }
    }
}
