//! Height fields over 0..1 x 0..1.

/// A height field. Whether it repeats is decided where it is used.
#[derive(Clone, Debug)]
pub struct HeightMap {
    /// The file's name, or a generator's.
    pub name: String,
    /// Texels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// `width * height` heights from the top row; finite. Integer files map to 0..1.
    pub heights: Vec<f32>,
}
