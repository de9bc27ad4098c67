//! What a person tunes about the frame.

/// Settings of one frame. Changing them rebuilds no pipeline, except that each tone curve's is
/// compiled when it is first used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Exposure in stops: radiance is multiplied by 2^`exposure_ev` before the tone curve. 0 shows
    /// a white diffuse surface under unit radiance as white; -20 is black, +20 white. Only tone
    /// mapping uses it.
    pub exposure_ev: f32,
    /// The curve from scene-referred to display-referred colour. Only tone mapping uses it.
    pub tone_curve: ToneCurve,
    /// How the environment lights surfaces; `None` leaves the technique out.
    pub diffuse_envmap: Option<diffuse_envmap::Settings>,
    /// Whether the environment is drawn where no surface is (black otherwise).
    pub background: bool,
    /// Whether the scene's lights are evaluated.
    pub direct_light: bool,
    /// How the bumps of height maps shadow each other; `None` leaves the technique out. Normals
    /// are bump-mapped either way.
    pub horizon_shadow: Option<horizon_shadow::Settings>,
    /// Shadows that surfaces cast on each other; `None` lets lights through everything but the
    /// bumps of height maps.
    pub shadow_map: Option<ShadowMapSettings>,
}

impl Settings {
    /// Everything that the scene has.
    pub const FULL: Self = Self {
        exposure_ev: 0.0,
        tone_curve: ToneCurve::PbrNeutral,
        diffuse_envmap: Some(diffuse_envmap::Settings::SHEEN),
        background: true,
        direct_light: true,
        horizon_shadow: Some(horizon_shadow::Settings::SHEEN),
        shadow_map: Some(ShadowMapSettings::FINE),
    };
}

impl Default for Settings {
    fn default() -> Self {
        Self::FULL
    }
}

/// Settings of the shadow map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShadowMapSettings {
    /// Texels a side for each light, 16..=4096, brought into that range and to what the device
    /// allows. The whole scene is spread over them: few make the edges of shadows coarse, many
    /// take six bytes each for each light.
    pub size: u32,
}

impl ShadowMapSettings {
    /// 2048 texels a side.
    pub const FINE: Self = Self { size: 2048 };
    /// 512 texels a side.
    pub const COARSE: Self = Self { size: 512 };
}

impl Default for ShadowMapSettings {
    fn default() -> Self {
        Self::FINE
    }
}

/// A curve from scene-referred linear colour to display-referred linear colour in 0..1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ToneCurve {
    /// No curve: what is above 1 clips, channel by channel. For comparing numbers.
    Linear,
    /// Khronos PBR Neutral: colours below about 0.8 stay as they are, brighter ones lose
    /// saturation gradually. For judging materials.
    #[default]
    PbrNeutral,
    /// Stephen Hill's fit of the ACES transforms: contrast and warm highlights as in film.
    AcesFitted,
}

impl ToneCurve {
    /// All curves.
    pub const ALL: [Self; 3] = [Self::Linear, Self::PbrNeutral, Self::AcesFitted];

    /// The curve's name in scene files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::PbrNeutral => "pbr-neutral",
            Self::AcesFitted => "aces",
        }
    }
}
