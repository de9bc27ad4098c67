//! Orthonormal frames: from world space to a local space whose z is a given direction, and back.

use glam::DVec3;

/// Three orthonormal, right-handed axes; `z` is the direction that the frame was made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    pub(crate) x: DVec3,
    pub(crate) y: DVec3,
    pub(crate) z: DVec3,
}

impl Frame {
    /// A frame about a unit direction, continuous but on the equator of z (Duff et al. 2017,
    /// "Building an Orthonormal Basis, Revisited").
    pub(crate) fn new(z: DVec3) -> Self {
        let sign = 1.0_f64.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Self {
            x: DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: DVec3::new(b, sign + z.y * z.y * a, -z.y),
            z,
        }
    }

    /// The components of a world vector along the frame's axes.
    pub(crate) fn local_from_world(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    /// The world vector with these components along the frame's axes.
    pub(crate) fn world_from_local(&self, v: DVec3) -> DVec3 {
        v.x * self.x + v.y * self.y + v.z * self.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_and_right_handed_everywhere() {
        let mut directions = vec![DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
        directions.push(DVec3::new(1e-9, -1e-9, -1.0).normalize());
        directions.push(DVec3::new(1.0, 0.0, -1e-300).normalize());
        for step in 0..1000 {
            let (height, turn) = (f64::from(step) / 499.5 - 1.0, f64::from(step) * 2.399963);
            let radius = (1.0 - height * height).max(0.0).sqrt();
            directions.push(DVec3::new(radius * turn.cos(), radius * turn.sin(), height).normalize());
        }
        for z in directions {
            let frame = Frame::new(z);
            assert!((frame.x.cross(frame.y) - frame.z).length() < 1e-14, "{z}");
            assert!(frame.x.dot(frame.y).abs() < 1e-14 && (frame.x.length() - 1.0).abs() < 1e-14, "{z}");
            let v = DVec3::new(0.3, -2.0, 0.7);
            assert!((frame.world_from_local(frame.local_from_world(v)) - v).length() < 1e-13, "{z}");
            assert!((frame.local_from_world(z) - DVec3::Z).length() < 1e-14, "{z}");
        }
    }
}
