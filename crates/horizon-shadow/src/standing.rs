//! Which tables stand, and what must be baked for a frame.

use gpu_context::{Gpu, Skip, Work, wgpu};

use crate::{
    BAKE_CANCELLED, Bake, Baker, CONSTANT_HEIGHT, Contents, Error, HeightMap, Heights, Method,
    NO_AZIMUTH_NEEDED, NO_TABLES_NEEDED, ONE_CURVATURE, Parts, Settings, Surface, TABLES_STAND, TableDesc,
};

/// Bumps lower than so many texels cast no shadow that could be seen.
const LEAST_RELIEF_TEXELS: f32 = 1e-6;

/// The tables of the current height map, as far as they are baked.
#[derive(Debug)]
pub(crate) struct Standing {
    pub(crate) bake: Bake,
    pub(crate) parts: Parts,
    key: Key,
    texture: wgpu::Texture,
    revision: u64,
}

/// What decides the tables besides the heights: another one needs other tables.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    desc: TableDesc,
    range: [f32; 2],
    parts: Parts,
    search: crate::Search,
}

/// What a frame needs tables of.
pub(crate) struct Wanted<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) map: &'a HeightMap<'a>,
    pub(crate) desc: TableDesc,
    /// Bit i where azimuth i is needed.
    pub(crate) azimuths: u64,
}

/// The tables that the settings' method reads; for methods without tables what decides them is
/// said all the same, because the shaders take the map's size and more from it.
pub(crate) fn table_desc(settings: &Settings, map: &HeightMap<'_>, surface: &Surface) -> TableDesc {
    let contents = match settings.method {
        Method::Flat => Contents::Flat,
        Method::Paper | Method::Exact => Contents::Published(settings.tables),
        Method::None | Method::Sheen | Method::Certified | Method::Marched => {
            Contents::Candidates { count: settings.candidates, precision: settings.precision }
        }
    };
    TableDesc {
        size: map.size(),
        azimuths: settings.azimuths,
        contents,
        wrap: map.wrap,
        curvature_per_texel: surface.curvature_per_m.map(|per_m| per_m * surface.texel_m),
        texels_per_height: map.height_scale_m / surface.texel_m,
        radius_texels: settings.radius_texels,
    }
}

/// Why a map needs no tables, `None` where it does.
pub(crate) fn needs_none(settings: &Settings, map: &HeightMap<'_>, desc: &TableDesc) -> Option<Skip> {
    let relief_texels = (map.range[1] - map.range[0]) * desc.texels_per_height;
    if relief_texels < LEAST_RELIEF_TEXELS {
        return Some(CONSTANT_HEIGHT);
    }
    matches!(settings.method, Method::None | Method::Marched).then_some(NO_TABLES_NEEDED)
}

impl Standing {
    /// Brings the tables up to date with a frame that needs some, as far as one call may.
    ///
    /// `standing` stays empty where nothing was ever needed, or where making the tables failed.
    pub(crate) fn update(
        standing: &mut Option<Self>,
        baker: &Baker,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        wanted: &Wanted<'_>,
    ) -> Result<Work, Error> {
        let Wanted { settings, map, desc, azimuths } = *wanted;
        let parts = match desc.contents {
            Contents::Candidates { .. } => Parts { prefilter: settings.prefilter, ambient: settings.ambient },
            Contents::Published(_) | Contents::Flat => Parts::default(),
        };
        let key = Key { desc, range: map.range, parts, search: settings.search };
        let azimuths = azimuths & (u64::MAX >> (64 - desc.azimuths));
        let kept = standing.take().filter(|old| old.key == key);
        let kept = kept.map(|old| old.with_heights(map)).transpose()?.flatten();
        if azimuths == 0 && !parts.ambient {
            *standing = kept;
            return Ok(Work::skipped(NO_AZIMUTH_NEEDED));
        }
        let now = match kept {
            Some(kept) => kept,
            None => Self {
                bake: baker.start(gpu, &desc, &heights(map), parts, azimuths)?,
                parts,
                key,
                texture: map.view.texture().clone(),
                revision: map.revision,
            },
        };
        let now = standing.insert(now);
        now.bake.want(azimuths);
        now.record(baker, gpu, encoder, settings)
    }

    /// The tables with other heights in them; `None` where they must be baked from the start.
    fn with_heights(mut self, map: &HeightMap<'_>) -> Result<Option<Self>, Error> {
        if self.revision == map.revision {
            return Ok((self.texture == *map.view.texture()).then_some(self));
        }
        let Some(rows) = &map.changed_rows else { return Ok(None) };
        // Rows that changed in revisions between are not known.
        if self.revision.wrapping_add(1) != map.revision || self.bake.is_cancelled() {
            return Ok(None);
        }
        let rows = rows.start..rows.end.min(self.key.desc.size[1]);
        if !rows.is_empty() {
            self.bake.rows_changed(&heights(map), rows)?;
        }
        self.texture = map.view.texture().clone();
        self.revision = map.revision;
        Ok(Some(self))
    }

    fn record(
        &mut self,
        baker: &Baker,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &Settings,
    ) -> Result<Work, Error> {
        let progress = self.bake.progress();
        if progress.done >= progress.total {
            return Ok(Work::skipped(TABLES_STAND));
        }
        if self.bake.is_cancelled() {
            return Ok(Work::skipped(BAKE_CANCELLED));
        }
        let at_most = settings.azimuths_per_prepare.max(1);
        let mut work = baker.record(gpu, encoder, &mut self.bake, settings.search, at_most)?;
        if let Contents::Candidates { count, .. } = self.key.desc.contents
            && self.key.desc.candidates() < count
        {
            work.skipped = work.skipped.or(Some(ONE_CURVATURE));
        }
        Ok(work)
    }
}

fn heights<'a>(map: &HeightMap<'a>) -> Heights<'a> {
    Heights { view: map.view, range: map.range }
}
