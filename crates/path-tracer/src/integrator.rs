//! Path tracing: the radiance along one camera ray.
//!
//! At each surface the light of every lamp (of a random eight where there are more), of one point of
//! the emitting triangles and of one direction of the environment is added, each with a shadow ray;
//! then the path goes on in a direction drawn from the reflectance. What both ways can find is
//! weighted by the power heuristic (Veach 1997).

use glam::DVec3;

use crate::{
    Lobe, Settings,
    bsdf::Sampled,
    geometry::{Hit, Ray},
    lamps::Lamp,
    random::Random,
    surface::{Horizon, Surface},
    world::World,
};

/// Lamps that are looked at from one surface.
const LAMPS: usize = 8;

/// Reflections after which a path may end by chance.
const ROULETTE_AFTER: u32 = 3;

/// The least chance to go on: it bounds how much a survivor counts.
const LEAST_SURVIVAL: f64 = 0.05;

/// What a path carries from surface to surface.
struct Path {
    radiance: DVec3,
    throughput: DVec3,
    /// Density of the last direction; `None` where no other way could have found it.
    pdf: Option<f64>,
}

/// The paths of one picture.
pub(crate) struct Integrator<'a> {
    world: &'a World,
    lobe: Lobe,
    max_bounces: u32,
    occlusion: bool,
}

impl<'a> Integrator<'a> {
    pub(crate) fn new(world: &'a World, settings: &Settings) -> Self {
        let Settings { lobe, max_bounces, occlusion, .. } = *settings;
        Self { world, lobe, max_bounces, occlusion }
    }

    /// The radiance that arrives at `origin` from `direction`, one random estimate.
    pub(crate) fn radiance(&self, origin: DVec3, direction: DVec3, random: &mut Random) -> [f64; 3] {
        let mut path = Path { radiance: DVec3::ZERO, throughput: DVec3::ONE, pdf: None };
        let mut ray = ray(origin, direction, f64::INFINITY, random);
        for bounce in 0..=self.max_bounces {
            let Some(hit) = self.world.geometry.closest_hit(&ray, self.world) else {
                path.radiance += path.throughput * self.distant(ray.direction, path.pdf, bounce == 0);
                break;
            };
            let Some(surface) = self.world.surface(&ray, &hit, self.lobe) else { break };
            path.radiance += path.throughput * self.emitted(&surface, &ray, &hit, path.pdf);
            if bounce == self.max_bounces {
                break;
            }
            if !self.occlusion {
                path.radiance += self.far_field(&surface, random);
                break;
            }
            let Some(next) = self.reflect(&surface, &mut path, bounce, random) else { break };
            ray = next;
        }
        path.radiance.to_array()
    }

    /// Adds the direct light of a surface to a path and draws the ray on which it goes on.
    fn reflect(&self, surface: &Surface, path: &mut Path, bounce: u32, random: &mut Random) -> Option<Ray> {
        let direct = if surface.bsdf.is_delta_only() {
            DVec3::ZERO
        } else {
            self.lamps(surface, random) + self.environment(surface, random) + self.emitters(surface, random)
        };
        path.radiance += path.throughput * direct;
        let Sampled { incoming, weight, pdf, is_delta } =
            surface.sample(Horizon::Geometry, random.triple())?;
        path.throughput *= DVec3::from_array(weight);
        path.pdf = (!is_delta).then_some(pdf);
        if bounce >= ROULETTE_AFTER {
            let survival = path.throughput.max_element().clamp(LEAST_SURVIVAL, 1.0);
            if random.one() >= survival {
                return None;
            }
            path.throughput /= survival;
        }
        (path.throughput.max_element() > 0.0).then(|| self.leaving(surface, incoming, f64::INFINITY, random))
    }

    /// A ray that leaves a surface.
    fn leaving(&self, surface: &Surface, direction: DVec3, length: f64, random: &mut Random) -> Ray {
        let Surface { triangle, position, normal_geometric, .. } = *surface;
        ray(self.world.geometry.origin_above(triangle, position, normal_geometric), direction, length, random)
    }

    /// Light from infinity that a path finds by its own direction.
    fn distant(&self, direction: DVec3, pdf: Option<f64>, is_camera_ray: bool) -> DVec3 {
        let weight = |other: f64| pdf.map_or(1.0, |pdf| power_heuristic(pdf, other));
        let environment = self.world.environment.as_ref().map_or(DVec3::ZERO, |environment| {
            DVec3::from_array(environment.radiance(direction)) * weight(environment.pdf(direction))
        });
        if is_camera_ray {
            return environment;
        }
        let discs = self.world.lamps.iter().filter_map(Lamp::disc).filter(|disc| disc.contains(direction));
        let share = self.share_of_lamps();
        let discs: DVec3 =
            discs.map(|disc| DVec3::from_array(disc.radiance) * weight(share * disc.pdf())).sum();
        environment + discs
    }

    /// Light of an emitting surface that a path finds by its own direction.
    fn emitted(&self, surface: &Surface, ray: &Ray, hit: &Hit, pdf: Option<f64>) -> DVec3 {
        let emitted = DVec3::from_array(surface.emitted);
        if emitted == DVec3::ZERO {
            return emitted;
        }
        let weight = pdf
            .map_or(1.0, |pdf| power_heuristic(pdf, self.world.emitters.pdf(self.world, ray.direction, hit)));
        emitted * weight
    }

    /// How many looks at one lamp are expected from one surface.
    fn share_of_lamps(&self) -> f64 {
        (LAMPS as f64 / self.world.lamps.len() as f64).min(1.0)
    }

    /// Direct light of the lamps.
    fn lamps(&self, surface: &Surface, random: &mut Random) -> DVec3 {
        let lamps = &self.world.lamps;
        if lamps.len() <= LAMPS {
            return lamps.iter().map(|lamp| self.lamp(surface, lamp, random)).sum();
        }
        let chosen = (0..LAMPS).filter_map(|_| lamps.get((random.one() * lamps.len() as f64) as usize));
        let chosen: Vec<&Lamp> = chosen.collect();
        let sum: DVec3 = chosen.into_iter().map(|lamp| self.lamp(surface, lamp, random)).sum();
        sum / self.share_of_lamps()
    }

    fn lamp(&self, surface: &Surface, lamp: &Lamp, random: &mut Random) -> DVec3 {
        let u = if lamp.disc().is_some() { random.pair() } else { [0.0; 2] };
        let Some(arriving) = lamp.sample(surface.position, u) else { return DVec3::ZERO };
        let evaluated = surface.evaluate(self.horizon(), arriving.direction);
        let value = DVec3::from_array(evaluated.value) * DVec3::from_array(arriving.light);
        let value = match arriving.pdf {
            Some(pdf) => value * (power_heuristic(self.share_of_lamps() * pdf, evaluated.pdf) / pdf),
            None => value,
        };
        self.unoccluded(surface, value, arriving.direction, arriving.distance, random)
    }

    /// Direct light of the environment.
    fn environment(&self, surface: &Surface, random: &mut Random) -> DVec3 {
        let Some(environment) = &self.world.environment else { return DVec3::ZERO };
        let Some((direction, pdf)) = environment.sample(random.pair()) else { return DVec3::ZERO };
        let evaluated = surface.evaluate(self.horizon(), direction);
        let weight = power_heuristic(pdf, evaluated.pdf) / pdf;
        let radiance = DVec3::from_array(environment.radiance(direction));
        let value = DVec3::from_array(evaluated.value) * radiance * weight;
        self.unoccluded(surface, value, direction, f64::INFINITY, random)
    }

    /// Direct light of emitting triangles.
    fn emitters(&self, surface: &Surface, random: &mut Random) -> DVec3 {
        if self.world.emitters.is_empty() {
            return DVec3::ZERO;
        }
        let sample = self.world.emitters.sample(self.world, surface.position, random.triple());
        let Some(sample) = sample else { return DVec3::ZERO };
        let evaluated = surface.evaluate(self.horizon(), sample.direction);
        let reflected = DVec3::from_array(evaluated.value);
        if reflected == DVec3::ZERO {
            return reflected;
        }
        let towards = Ray { origin: surface.position, direction: sample.direction, length: 0.0, key: 0 };
        let emitted = self.world.emitted_at(&towards, &sample.hit, self.lobe).unwrap_or_default();
        let weight = power_heuristic(sample.pdf, evaluated.pdf) / sample.pdf;
        let value = reflected * DVec3::from_array(emitted) * weight;
        // The ray ends before the triangle itself.
        self.unoccluded(surface, value, sample.direction, sample.hit.distance * (1.0 - 1e-9), random)
    }

    /// The value, or nothing where something stands between the surface and the light.
    fn unoccluded(
        &self,
        surface: &Surface,
        value: DVec3,
        direction: DVec3,
        length: f64,
        random: &mut Random,
    ) -> DVec3 {
        if value == DVec3::ZERO {
            return value;
        }
        let is_occluded = self.occlusion && {
            let ray = self.leaving(surface, direction, length, random);
            self.world.geometry.is_occluded(&ray, self.world)
        };
        if is_occluded { DVec3::ZERO } else { value }
    }

    fn horizon(&self) -> Horizon {
        if self.occlusion { Horizon::Geometry } else { Horizon::Shading }
    }

    /// What a surface reflects of the environment and the lamps, as if nothing else were there.
    fn far_field(&self, surface: &Surface, random: &mut Random) -> DVec3 {
        let direct = if surface.bsdf.is_delta_only() {
            DVec3::ZERO
        } else {
            self.lamps(surface, random) + self.environment(surface, random)
        };
        let reflected = surface.sample(Horizon::Shading, random.triple()).map_or(DVec3::ZERO, |sampled| {
            let pdf = (!sampled.is_delta).then_some(sampled.pdf);
            DVec3::from_array(sampled.weight) * self.distant(sampled.incoming, pdf, false)
        });
        direct + reflected
    }
}

fn ray(origin: DVec3, direction: DVec3, length: f64, random: &mut Random) -> Ray {
    let [key, _] = random.bits();
    Ray { origin, direction, length, key }
}

/// The weight of a way that finds a direction with the first density, beside another way with the
/// second.
fn power_heuristic(pdf: f64, other: f64) -> f64 {
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
}
