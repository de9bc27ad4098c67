//! What a film shows.

use super::fingerprint::SceneHash;
use crate::settings::Settings;
use scene::{Camera, Scene};

/// What was rendered. Films of equal identity (their scene's name aside) and size show the same
/// picture and may be merged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// What the scene is called; for people.
    pub scene: String,
    /// [`fingerprint`](super::fingerprint()) of everything that decides the picture.
    pub fingerprint: u128,
    /// Version of the path tracer: another may give other samples.
    pub version: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// The remaining settings as one line of text; for people.
    pub settings: String,
}

impl Identity {
    /// The identity of a picture that this version of the path tracer makes.
    pub fn new(scene: &Scene, camera: &Camera, settings: &Settings) -> Self {
        Self::of_hash(&scene.name, SceneHash::new(scene), camera, settings)
    }

    /// The same, for a scene that is hashed already.
    pub(crate) fn of_hash(name: &str, hash: SceneHash, camera: &Camera, settings: &Settings) -> Self {
        Self {
            scene: one_line(name),
            fingerprint: hash.fingerprint(camera, settings),
            version: env!("CARGO_PKG_VERSION").into(),
            seed: settings.seed,
            settings: describe(settings),
        }
    }

    /// The fingerprint as 32 hexadecimal digits.
    pub fn fingerprint_text(&self) -> String {
        format!("{:032x}", self.fingerprint)
    }
}

/// Settings for people, without size, samples and seed, which stand elsewhere.
fn describe(settings: &Settings) -> String {
    let Settings { size: _, samples: _, seed: _, max_bounces, lobe, occlusion, pixel_filter } = settings;
    one_line(&format!(
        "max bounces {max_bounces}, lobe {lobe:?}, occlusion {occlusion}, pixel filter {pixel_filter:?}"
    ))
}

/// The text without line breaks and other control characters, since it becomes a line of a file.
fn one_line(text: &str) -> String {
    text.chars().map(|character| if character.is_control() { ' ' } else { character }).collect()
}
