//! Films of one picture become one.

use super::{Film, SampleRanges, sample_ranges::display};
use scene::Error;

/// Films of one picture that are added to each other one by one, by names that messages call them.
#[derive(Clone, Debug)]
pub struct Merge {
    film: Film,
    parts: Vec<(String, SampleRanges)>,
}

impl Merge {
    /// Begins with one film, which the others are compared with.
    pub fn new(name: impl Into<String>, film: Film) -> Self {
        let parts = vec![(name.into(), film.samples.clone())];
        Self { film, parts }
    }

    /// Adds the samples of another film. An error, which names both films and leaves everything as
    /// it was, where they differ in size or in what was rendered, where both hold the same samples,
    /// or where the samples become too many.
    pub fn add(&mut self, name: impl Into<String>, film: &Film) -> Result<(), Error> {
        let name = name.into();
        self.check_identity(&name, film)?;
        for (part, samples) in &self.parts {
            if let Some(both) = samples.overlap(&film.samples) {
                let found = format!("{}, which {part} has too", display(&both));
                return Err(Error::new(name, "samples", found, "each sample in one film"));
            }
        }
        let mut samples = self.film.samples.clone();
        for range in film.samples.ranges() {
            samples.insert(range.clone()).map_err(|refusal| refusal.of(&name))?;
        }
        // Of names for one scene the one of the earliest samples stays, whatever the order.
        let start = |samples: &SampleRanges| samples.ranges().first().map(|range| range.start);
        if start(&samples) != start(&self.film.samples) {
            self.film.identity.scene.clone_from(&film.identity.scene);
        }
        for (sums, other) in self.film.pixels.iter_mut().zip(&film.pixels) {
            sums.merge(other);
        }
        self.film.samples = samples;
        self.parts.push((name, film.samples.clone()));
        Ok(())
    }

    /// The film of all samples.
    pub fn finish(self) -> Film {
        self.film
    }

    /// Refuses a film of another size, or of anything else that decides the picture.
    fn check_identity(&self, name: &str, film: &Film) -> Result<(), Error> {
        let first = self.parts.first().map_or("", |(name, _)| name);
        let size = |film: &Film| format!("{} x {} pixels", film.size[0], film.size[1]);
        let (other, own) = (&film.identity, &self.film.identity);
        for (place, found, expected) in [
            ("size", size(film), size(&self.film)),
            ("version", other.version.clone(), own.version.clone()),
            ("seed", other.seed.to_string(), own.seed.to_string()),
            ("settings", other.settings.clone(), own.settings.clone()),
            ("fingerprint", other.fingerprint_text(), own.fingerprint_text()),
        ] {
            if found != expected {
                return Err(Error::new(name, place, found, format!("{expected} as in {first}")));
            }
        }
        Ok(())
    }
}
