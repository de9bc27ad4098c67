//! The bake's uniform buffer, bit for bit as `bake.wgsl` declares it.

use bytemuck::{Pod, Zeroable};

use super::profile::Samples;
use crate::{Contents, Precision, TableDesc, Tables, Wrap, codes::SLOPE_SCALE, uniforms::contents_code};

/// `HorizonShadowBake` of `bake.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Step {
    pub(crate) size: [u32; 2],
    pub(crate) rows: [u32; 2],
    pub(crate) advance: [f32; 2],
    pub(crate) spacing: f32,
    pub(crate) radius: f32,
    pub(crate) first_sample: u32,
    pub(crate) last_sample: u32,
    pub(crate) curvatures: [f32; 2],
    pub(crate) kappas: [f32; 4],
    pub(crate) nodes: u32,
    pub(crate) contents: u32,
    pub(crate) wrap: u32,
    pub(crate) brute_force: u32,
    pub(crate) least_height: f32,
    pub(crate) greatest_height: f32,
    pub(crate) texels_per_height: f32,
    pub(crate) slope_scale: f32,
    pub(crate) pitch: u32,
    pub(crate) code_bits: u32,
    pub(crate) unit_codes: u32,
    pub(crate) unit_words: u32,
    pub(crate) node: u32,
    pub(crate) along_y: u32,
    pub(crate) backward: u32,
    pub(crate) drift: f32,
    pub(crate) line_first: i32,
    pub(crate) lines: u32,
    pub(crate) block: u32,
    pub(crate) reach: u32,
    pub(crate) first_invocation: u32,
    pub(crate) invocations: u32,
    pub(crate) azimuth: u32,
    pub(crate) azimuths: u32,
    pub(crate) level_size: [u32; 2],
    pub(crate) finer_level: u32,
    pub(crate) half_floats: u32,
    pub(crate) profile_row: u32,
    pub(crate) reserved: [u32; 3],
}

impl Step {
    /// What all steps of one azimuth share, for all rows.
    pub(crate) fn new(desc: &TableDesc, range: [f32; 2], azimuth: u32, samples: &Samples) -> Self {
        let nodes = desc.nodes();
        let mut kappas = [0.0; 4];
        kappas.iter_mut().zip(&nodes).for_each(|(kappa, node)| *kappa = *node);
        let units = Units::new(desc);
        Self {
            size: desc.size,
            rows: [0, desc.size[1]],
            advance: samples.advance,
            spacing: samples.step,
            radius: desc.radius_texels,
            first_sample: samples.first,
            last_sample: samples.last,
            curvatures: desc.curvature_per_texel,
            kappas,
            nodes: nodes.len() as u32,
            contents: contents_code(desc.contents),
            wrap: wrap_bits(desc.wrap),
            least_height: range[0],
            greatest_height: range[1],
            texels_per_height: desc.texels_per_height,
            slope_scale: SLOPE_SCALE,
            pitch: pitch_bytes(desc.size[0] * desc.texel_bytes()) / 4,
            code_bits: units.code_bits,
            unit_codes: units.codes,
            unit_words: units.words,
            azimuth,
            azimuths: desc.azimuths,
            profile_row: samples.profile_row,
            ..Self::default()
        }
    }
}

/// How the texels of a row are packed into words: what one invocation writes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Units {
    /// Bits of one code.
    pub(crate) code_bits: u32,
    /// Codes: those of one texel, or of so many texels as fill a word.
    pub(crate) codes: u32,
    /// Words.
    pub(crate) words: u32,
}

impl Units {
    pub(crate) fn new(desc: &TableDesc) -> Self {
        let code_bits = match desc.contents {
            Contents::Published(Tables::DistanceAndHeight) | Contents::Flat => 8,
            Contents::Published(Tables::BetaAndDistance)
            | Contents::Candidates { precision: Precision::Compact, .. } => 16,
            Contents::Candidates { precision: Precision::Full, .. } => 32,
        };
        let texel_bytes = desc.texel_bytes();
        let texels = (4 / texel_bytes).max(1);
        Self { code_bits, codes: texels * desc.candidates().max(1), words: texel_bytes.div_ceil(4) }
    }
}

/// Bytes of a row in a buffer that is copied to or from a texture.
pub(crate) fn pitch_bytes(row_bytes: u32) -> u32 {
    row_bytes.next_multiple_of(gpu_context::wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// Bit 0 where the map repeats along u, bit 1 along v.
fn wrap_bits(wrap: [Wrap; 2]) -> u32 {
    u32::from(wrap[0] == Wrap::Repeat) | u32::from(wrap[1] == Wrap::Repeat) << 1
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;

    macro_rules! offsets {
        ($($field:ident)*) => { vec![$((stringify!($field).to_owned(), offset_of!(Step, $field))),*] };
    }

    #[test]
    fn the_steps_match_the_shader() {
        let parsed = naga::front::wgsl::parse_str(&shaders::HORIZON_SHADOW_BAKE.source());
        let parsed = parsed.expect("the shader parses");
        let (_, ty) = parsed
            .types
            .iter()
            .find(|(_, ty)| ty.name.as_deref() == Some("HorizonShadowBake"))
            .expect("the struct exists");
        let naga::TypeInner::Struct { members, span } = &ty.inner else { panic!("not a struct") };
        assert_eq!(*span as usize, size_of::<Step>());
        let mut expected = offsets!(size rows advance spacing radius first_sample last_sample curvatures kappas
            nodes contents wrap brute_force least_height greatest_height texels_per_height slope_scale pitch
            code_bits unit_codes unit_words node along_y backward drift line_first lines block reach
            first_invocation invocations azimuth azimuths level_size finer_level half_floats profile_row);
        let reserved = offset_of!(Step, reserved);
        expected.extend((0..3).map(|i| (format!("reserved_{i}"), reserved + 4 * i)));
        let found: Vec<_> =
            members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize)).collect();
        assert_eq!(found, expected);
    }
}
