//! Everything that puts shadows into the visibility buffer.

use crate::{
    Error, Frame, Settings, View,
    horizon::{self, HORIZON_SHADOW_OFF, Horizons, NO_HEIGHT_MAPS},
    shadow_map::{self, SHADOW_MAP_OFF, ShadowMap},
    surface::SurfaceBuffer,
    visibility::Visibility,
};
use gpu_context::{Gpu, Skip, Work};

/// The passes, each made on first use and given up when a frame does without it.
#[derive(Default)]
pub(crate) struct Shadows {
    pub(crate) horizons: Option<Horizons>,
    shadow_map: Option<ShadowMap>,
    pub(crate) visibility: Visibility,
}

impl Shadows {
    /// Records the passes of a frame: what horizon-shadow did, and what the shadow map. `unlit` is
    /// why no light counts, if none does.
    pub(crate) fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &Settings,
        (frame, view): (&Frame<'_>, &View),
        surface: &mut SurfaceBuffer,
        unlit: Option<Skip>,
    ) -> Result<[Work; 2], Error> {
        let Frame { scene, timer, .. } = *frame;
        self.visibility.begin();
        let mut scope = timer.scope("horizon-shadow", encoder);
        let has_sky = settings.diffuse_envmap.is_some() && scene.environment().is_some();
        let horizon_shadow = match (&settings.horizon_shadow, unlit) {
            (None, _) => Work::skipped(HORIZON_SHADOW_OFF),
            _ if scene.reliefs.is_empty() => Work::skipped(NO_HEIGHT_MAPS),
            (Some(settings), Some(reason)) if !(settings.ambient && has_sky) => Work::skipped(reason),
            (Some(settings), _) => {
                let technique = self.horizons.get_or_insert_with(Horizons::new);
                let request = horizon::Request { settings, view, is_lit: unlit.is_none() };
                technique.draw(gpu, &mut scope, scene, &request, surface, &mut self.visibility)?
            }
        };
        drop(scope);
        if horizon_shadow.passes == 0 {
            self.horizons = None;
        }
        if self.horizons.is_none() || !settings.horizon_shadow.is_some_and(|settings| settings.ambient) {
            surface.diffuse_normal = None;
        }
        // Where the horizon map is drawn, it knows the bumps near by.
        let known = settings.horizon_shadow.filter(|_| self.visibility.target().is_some());
        let own_radius_texels = known.as_ref().map_or(0.0, horizon::radius_texels);

        let mut scope = timer.scope("shadow-map", encoder);
        let shadow_map = match (settings.shadow_map, unlit) {
            (None, _) => Work::skipped(SHADOW_MAP_OFF),
            (_, Some(reason)) => Work::skipped(reason),
            (Some(settings), None) => {
                let mut pass = match self.shadow_map.take() {
                    Some(pass) => pass,
                    None => ShadowMap::new(gpu)?,
                };
                let request = shadow_map::Request { settings, view, own_radius_texels };
                let work = pass.draw(gpu, &mut scope, scene, &request, surface, &mut self.visibility)?;
                self.shadow_map = Some(pass);
                work
            }
        };
        drop(scope);
        if shadow_map.passes == 0 {
            self.shadow_map = None;
        }
        self.visibility.end();
        Ok([horizon_shadow, shadow_map])
    }
}
