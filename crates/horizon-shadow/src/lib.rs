//! horizon-shadow: shadows of bumps on curved surfaces, from horizon and distance maps.
//!
//! After Onoue, Max and Nishita, *Bumpmap Shadows on Curved Surfaces*. For every texel of a height
//! map and a number of azimuths tables hold the point Q that makes the horizon: how steeply it rises
//! and how far away it is. A point is in shadow where the light stands lower than the horizon in the
//! light's azimuth, L.N < tan(beta') |V|. On a curved surface a far point sinks below the tangent
//! plane; beta' follows from the stored pair and the curvature kappa of the surface along the azimuth
//! (eq. 1, from a second fundamental form per vertex: see [`frames`]).
//!
//! - [`Method::Paper`]: eqs. 2 to 4 on interpolated tables, with the sign of eq. 3 turned (the smooth
//!   horizon lies below the tangent plane) and the height of the point itself in eq. 4.
//! - [`Method::Sheen`]: the exact curved horizon in place of eqs. 2 and 3. Which point makes the
//!   horizon changes with kappa, so that up to four are stored, each the winner for one curvature, and
//!   the highest counts. They begin one texel away; the nearest texels are traced, since interpolation
//!   between texels would lose most there. Horizons are evaluated at the four texels around a point
//!   and the two azimuths around the light, and their sines blended, never the pairs. Where the
//!   curvature differs from direction to direction, normals ahead lean sideways, and the azimuth is
//!   turned by that geodesic torsion times the height. Concave surfaces and points beyond the
//!   terminator, whose bumps still catch the light, need nothing more.
//! - [`Method::Certified`]: the same, and where bounds on the horizon do not decide, the relief is
//!   marched.
//! - [`Method::Flat`] (Forsyth's horizon map), [`Method::Exact`] (the exact form on the paper's
//!   tables) and [`Method::Marched`] are there to compare with.
//!
//! Lights of finite size cast soft shadows ([`Method::Sheen`] blends by the part of the disc above the
//! horizon); bumps smaller than a pixel take the mean visibility ([`Settings::prefilter`]); ambient
//! occlusion and a bent normal come from the same horizons ([`Settings::ambient`]).
//!
//! What is approximated: horizons between texels and between azimuths, which lose bumps thinner than
//! the angle between two; curvature, which is taken as constant within the radius of the search; the
//! range of curvatures of one table, so that a surface part curved more than the rest is better served
//! by a table of its own. Not seen at all: what lies beyond the radius or on another surface (the
//! host's shadow map), the shadow that a concave surface without bumps casts on itself, and where the
//! surface has no metric (|Pu x Pv| = 0, as at the pole of a sphere): lit there is what faces the
//! light.
//!
//! Cost: eight texel reads of tables and four to eight of heights for each light; two more, and often
//! no others, where tiles of 8 x 8 texels decide first ([`Settings::tiles`]). Memory a texel and azimuth: 4 bytes for two
//! candidates ([`Precision::Compact`]), 2 for one, 8 for more; 2 or 1 for the paper's tables; see
//! [`TableDesc::memory_bytes`]. The bake needs compute shaders, and time in proportion to texels and
//! azimuths ([`Search::Sweep`]).
//!
//! ```no_run
//! # use horizon_shadow::*;
//! # fn f(gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, view: &wgpu::TextureView,
//! #     world: View, desc: &Desc<'_>) -> Result<(), Error> {
//! let mut shadows = HorizonShadow::new(gpu)?;
//! let work = shadows.prepare(gpu, encoder, &Settings::SHEEN, &Frame {
//!     height_map: Some(HeightMap {
//!         view,
//!         revision: 1,
//!         changed_rows: None,
//!         range: [0.0, 1.0],
//!         height_scale_m: 0.02,
//!         uv_scale: [4.0, 4.0],
//!         wrap: [Wrap::Repeat; 2],
//!     }),
//!     // `frames::surface` finds these for a mesh.
//!     surface: Surface { texel_m: 0.01, curvature_per_m: [0.0, 0.5] },
//!     needed_azimuths: u64::MAX,
//! })?;
//! // Either the ready pass, inside a render pass whose target is `desc`'s ...
//! let mut visibility = VisibilityPass::new(gpu, desc)?;
//! let sun = Light::Directional { direction_world: [0.0, 1.0, 1.0], angular_diameter_rad: 0.0093 };
//! visibility.prepare(gpu, &world, &[sun], [&shadows])?;
//! // if visibility.set(&mut pass, &shadows) { pass.draw(...); }
//! // ... or the host's own shader, after this text and with `shadows.bind_group()`:
//! let wgsl = HorizonShadow::library();
//! # Ok(()) }
//! ```
//!
//! A host that shades materials itself puts [`HorizonShadow::library`] before its own shader,
//! declares the eight bindings of [`HorizonShadow::bind_group_layout`] and calls
//! `horizon_shadow_visibility`; `examples/minimal.rs` does.

mod bake;
mod bindings;
pub mod codes;
mod error;
mod frame;
pub mod frames;
pub mod model;
mod settings;
mod standing;
mod tables;
mod uniforms;
mod visibility;

pub use bake::{Bake, BakedTables, Baker, Heights, Parts, cpu};
pub use error::Error;
pub use frame::{Frame, HeightMap, Surface};
pub use frames::VertexFrame;
pub use gpu_context::{Gpu, Skip, Work, wgpu};
pub use settings::{Method, Search, Settings, Tables};
pub use tables::{Contents, MOMENT_TEXELS, Precision, TILE_TEXELS, TableDesc, Wrap};
pub use visibility::{Desc, Light, MAX_LIGHTS, View, VisibilityPass};

use std::sync::{Arc, Mutex, PoisonError, Weak};

use bindings::{Empty, bind_group, sampler, technique_layout, uniform_buffer};
use standing::{Standing, Wanted, needs_none, table_desc};
use uniforms::{Parameters, Relief, Variant};

/// The surface has no height map: nothing is made and nothing costs.
pub const NO_HEIGHT_MAP: Skip = Skip::new("the surface has no height map");
/// The tables stand from an earlier frame.
pub const TABLES_STAND: Skip = Skip::new("the tables stand");
/// All heights are the same, so that no bump casts a shadow: lit is what faces the light.
pub const CONSTANT_HEIGHT: Skip = Skip::new("all heights are the same: no bump casts a shadow");
/// The method reads no tables.
pub const NO_TABLES_NEEDED: Skip = Skip::new("the method reads no tables");
/// No azimuth is needed: no light reaches the surface.
pub const NO_AZIMUTH_NEEDED: Skip = Skip::new("no azimuth is needed");
/// One candidate was baked although the settings allow more.
pub const ONE_CURVATURE: Skip = Skip::new("the curvature is the same everywhere: one candidate is exact");
/// The bake was cancelled, and nothing has changed since.
pub const BAKE_CANCELLED: Skip = Skip::new("the bake was cancelled");

/// How far a bake has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Azimuths that are finished.
    pub done: u32,
    /// Azimuths that were asked for.
    pub total: u32,
}

/// The technique for one surface: a height map on a mesh, or on several that are curved alike.
///
/// A host with several surfaces makes the first with [`new`](Self::new) and the others with
/// [`for_another_surface`](Self::for_another_surface).
#[derive(Debug)]
pub struct HorizonShadow {
    layout: wgpu::BindGroupLayout,
    parameters: wgpu::Buffer,
    /// The pipelines of the bake while they are needed, and where surfaces that share them find them.
    baker: Option<Arc<Baker>>,
    shared_baker: Arc<Mutex<Weak<Baker>>>,
    empty: Option<Empty>,
    sampler: Option<([Wrap; 2], wgpu::Sampler)>,
    standing: Option<Standing>,
    /// Of the last `prepare`.
    group: Option<(wgpu::BindGroup, Variant)>,
}

impl HorizonShadow {
    /// Makes the small fixed resources; pipelines and textures follow on first use.
    pub fn new(gpu: &Gpu) -> Result<Self, Error> {
        Self::sharing(gpu, Arc::default())
    }

    /// The technique for another surface on the same device, which shares the pipelines of the bake
    /// with this one.
    pub fn for_another_surface(&self, gpu: &Gpu) -> Result<Self, Error> {
        Self::sharing(gpu, Arc::clone(&self.shared_baker))
    }

    fn sharing(gpu: &Gpu, shared_baker: Arc<Mutex<Weak<Baker>>>) -> Result<Self, Error> {
        Ok(Self {
            shared_baker,
            layout: gpu.checked("horizon-shadow", technique_layout)?,
            parameters: uniform_buffer(gpu, "horizon-shadow parameters", size_of::<Parameters>())?,
            baker: None,
            empty: None,
            sampler: None,
            standing: None,
            group: None,
        })
    }

    /// Brings the tables that the settings' method reads up to date and records what that takes,
    /// at most [`Settings::azimuths_per_prepare`] azimuths; then makes the bind group. Azimuths that
    /// are not baked yet cast no shadow beyond the nearest texels. The uniforms are written through
    /// the queue: prepare once per submission.
    ///
    /// `Work::passes` counts compute passes; `Work::skipped` says why none ran, or
    /// [`ONE_CURVATURE`]. What is no longer needed is released.
    ///
    /// [`Error::HeightMap`] for a view that cannot be read as a map, [`Error::Value`] for a number
    /// out of range, [`Error::Gpu`] where the device does not allow the tables' size or has no
    /// memory for them. There is no bind group after an error.
    pub fn prepare(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &Settings,
        frame: &Frame<'_>,
    ) -> Result<Work, Error> {
        self.group = None;
        let Some(map) = &frame.height_map else {
            self.release();
            self.empty = None;
            self.sampler = None;
            return Ok(Work::skipped(NO_HEIGHT_MAP));
        };
        map.check(gpu)?;
        frame.surface.check()?;
        let desc = table_desc(settings, map, &frame.surface);
        desc.check()?;
        let work = if let Some(skip) = needs_none(settings, map, &desc) {
            self.release();
            Work::skipped(skip)
        } else {
            let baker = self.baker(gpu)?;
            let wanted = Wanted { settings, map, desc, azimuths: frame.needed_azimuths };
            let work = Standing::update(&mut self.standing, &baker, gpu, encoder, &wanted)?;
            self.baker = Some(baker);
            work
        };
        self.bind(gpu, settings, map, &desc)?;
        Ok(work)
    }

    /// The WGSL functions for a host's own shader, dependencies included.
    pub fn library() -> String {
        shaders::HORIZON_SHADOW_LIBRARY.source()
    }

    /// The layout of [`Self::bind_group`], visible to vertex, fragment and compute shaders:
    /// 0 `var<uniform>: HorizonShadowParameters`, 1 `texture_2d<f32>` heights, 2
    /// `texture_2d_array<f32>` published tables, 3 `texture_2d_array<u32>` candidates, 4
    /// `texture_2d_array<f32>` extents, 5 `texture_2d_array<f32>` moments, 6
    /// `texture_2d_array<f32>` ambient, 7 `sampler`.
    pub fn bind_group_layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// The bindings of the last `prepare`; `None` where it had no height map.
    pub fn bind_group(&self) -> Option<&wgpu::BindGroup> {
        self.group.as_ref().map(|(group, _)| group)
    }

    /// What pipelines may fix about the last `prepare`; `None` where it had no height map.
    pub(crate) fn variant(&self) -> Option<Variant> {
        self.group.as_ref().map(|(_, variant)| *variant)
    }

    /// Bytes of GPU memory that the tables take.
    pub fn memory_bytes(&self) -> u64 {
        self.standing.as_ref().map_or(0, |standing| standing.bake.tables().memory_bytes())
    }

    /// How far the bake has come; 0 of 0 where there are no tables.
    pub fn progress(&self) -> Progress {
        self.standing.as_ref().map(|standing| standing.bake.progress()).unwrap_or_default()
    }

    /// Stops a bake that is spread over several calls of [`prepare`](Self::prepare): the azimuths
    /// that are finished stay, and no more are baked until what decides the tables changes.
    pub fn cancel(&mut self) {
        let progress = self.progress();
        if let Some(standing) = self.standing.as_mut().filter(|_| progress.done < progress.total) {
            standing.bake.cancel();
        }
    }

    /// The pipelines of the bake: its own, another surface's, or new ones.
    fn baker(&self, gpu: &Gpu) -> Result<Arc<Baker>, Error> {
        if let Some(baker) = &self.baker {
            return Ok(Arc::clone(baker));
        }
        let mut shared = self.shared_baker.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(baker) = shared.upgrade() {
            return Ok(baker);
        }
        let baker = Arc::new(Baker::new(gpu)?);
        *shared = Arc::downgrade(&baker);
        Ok(baker)
    }

    /// Gives back everything that only baking and its tables take.
    fn release(&mut self) {
        self.baker = None;
        self.standing = None;
    }

    fn bind(
        &mut self,
        gpu: &Gpu,
        settings: &Settings,
        map: &HeightMap<'_>,
        desc: &TableDesc,
    ) -> Result<(), Error> {
        let standing = self.standing.as_ref();
        let parts = standing.map(|standing| standing.parts).unwrap_or_default();
        let relief = Relief {
            range: map.range,
            height_scale_m: map.height_scale_m,
            uv_scale: map.uv_scale,
            slope_scale: codes::SLOPE_SCALE,
            baked_azimuths: standing.map_or(0, |standing| standing.bake.baked_azimuths()),
            has_moments: parts.prefilter,
            has_ambient: parts.ambient && standing.is_some_and(|standing| is_complete(&standing.bake)),
            has_extents: settings.tiles && standing.is_some() && desc.candidates() > 0,
        };
        // Fewer candidates may have been baked than the settings allow.
        let parameters =
            Parameters { candidates: desc.candidates(), ..Parameters::new(settings, desc, &relief) };
        gpu.queue().write_buffer(&self.parameters, 0, bytemuck::bytes_of(&parameters));
        let empty = match self.empty.take() {
            Some(empty) => empty,
            None => Empty::new(gpu)?,
        };
        let sampler = match self.sampler.take().filter(|(wrap, _)| *wrap == map.wrap) {
            Some((_, sampler)) => sampler,
            None => gpu.checked("horizon-shadow's sampler", |device| sampler(device, map.wrap))?,
        };
        let tables = standing.map(|standing| standing.bake.tables());
        let [published, candidates, extents, moments, ambient] = match tables {
            Some(t) => [&t.published, &t.candidates, &t.extents, &t.moments, &t.ambient],
            None => [&empty.floats, &empty.candidates, &empty.floats, &empty.floats, &empty.floats],
        }
        .map(wgpu::BindingResource::TextureView);
        let group = gpu.checked("horizon-shadow's bind group", |device| {
            let resources = [
                self.parameters.as_entire_binding(),
                wgpu::BindingResource::TextureView(map.view),
                published,
                candidates,
                extents,
                moments,
                ambient,
                wgpu::BindingResource::Sampler(&sampler),
            ];
            bind_group(device, "horizon-shadow", &self.layout, resources)
        })?;
        self.empty = Some(empty);
        self.sampler = Some((map.wrap, sampler));
        self.group = Some((group, Variant::from(&parameters)));
        Ok(())
    }
}

fn is_complete(bake: &Bake) -> bool {
    let progress = bake.progress();
    progress.done == progress.total
}
