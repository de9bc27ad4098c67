//! A point of a surface as a path meets it, and how it reflects in the world.
//!
//! Interpolated and mapped normals tilt the reflectance against the geometry, so that a part of it
//! would go below the real surface. That part is reflected up again, as if by a mirror in the plane
//! of the triangle: the density of an upward direction is that of the tilted lobe there plus that
//! of its mirror image below. So no light is lost, at the terminator or elsewhere, and white
//! surfaces stay white. It is the tangent facet of Schüssler, Heitz, Hanika and Dachsbacher
//! ("Microfacet-based Normal Mapping for Robust Monte Carlo Path Tracing", 2017) without its masking
//! terms, which keeps evaluation and density exact. As there, where all of a lobe lies above the
//! surface, nothing changes.

use glam::DVec3;

use crate::{
    bsdf::{Bsdf, Evaluated, Sampled},
    frame::Frame,
};

/// A point of a surface, seen from one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    pub(crate) triangle: u32,
    /// In the tracer's space.
    pub(crate) position: DVec3,
    /// Of the triangle, on the side of the viewer.
    pub(crate) normal_geometric: DVec3,
    /// Its z is the shading normal.
    pub(crate) frame: Frame,
    /// Towards the viewer, in the frame.
    pub(crate) outgoing: DVec3,
    pub(crate) bsdf: Bsdf,
    /// Radiance towards the viewer.
    pub(crate) emitted: [f64; 3],
}

/// Above which surface light is reflected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Horizon {
    /// The triangle's; what would go below is reflected up.
    Geometry,
    /// The shading normal's, whatever the triangle.
    Shading,
}

impl Surface {
    /// Draws an incoming direction in world space.
    pub(crate) fn sample(&self, horizon: Horizon, u: [f64; 3]) -> Option<Sampled> {
        let sampled = self.bsdf.sample(self.outgoing, u)?;
        let mut incoming = self.frame.world_from_local(sampled.incoming).normalize();
        if horizon == Horizon::Shading {
            return Some(Sampled { incoming, ..sampled });
        }
        if incoming.dot(self.normal_geometric) < 0.0 {
            incoming = self.mirrored(incoming);
        }
        if incoming.dot(self.normal_geometric) <= 0.0 {
            return None;
        }
        if sampled.is_delta {
            return Some(Sampled { incoming, ..sampled });
        }
        let Evaluated { value, pdf } = self.evaluate(horizon, incoming);
        (pdf > 0.0).then(|| Sampled {
            incoming,
            weight: value.map(|value| value / pdf),
            pdf,
            is_delta: false,
        })
    }

    /// Reflectance times cosine, and density, for an incoming direction in world space.
    pub(crate) fn evaluate(&self, horizon: Horizon, incoming: DVec3) -> Evaluated {
        if horizon == Horizon::Geometry && incoming.dot(self.normal_geometric) <= 0.0 {
            return Evaluated::default();
        }
        let local = |direction| self.frame.local_from_world(direction);
        let direct = self.bsdf.evaluate(self.outgoing, local(incoming));
        let image = local(self.mirrored(incoming));
        if horizon == Horizon::Shading || image.z <= 0.0 {
            return direct;
        }
        let folded = self.bsdf.evaluate(self.outgoing, image);
        Evaluated {
            value: std::array::from_fn(|channel| direct.value[channel] + folded.value[channel]),
            pdf: direct.pdf + folded.pdf,
        }
    }

    fn mirrored(&self, direction: DVec3) -> DVec3 {
        direction - self.normal_geometric * (2.0 * direction.dot(self.normal_geometric))
    }
}
