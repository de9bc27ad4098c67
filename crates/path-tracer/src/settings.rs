//! What a person tunes.

/// What the specular part of a material is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Lobe {
    /// glTF's microfacets: GGX with height-correlated Smith shadowing and Schlick's Fresnel term.
    #[default]
    Ggx,
    /// The normalised Blinn lobe of the glare technique.
    Blinn,
    /// The cone of Phong weights of the glossy-planes technique.
    PhongCone,
    /// The lobe of the diffuse-envmap technique.
    DiffusedEnvironment,
}
