//! Decodes the images that materials use.

use rayon::prelude::*;

use super::{Document, buffers, uri};
use crate::load::texture_budget::TextureBudget;
use crate::{ColorSpace, Error, Texture};

/// One texture for each (image, colour space), decoded in parallel.
pub(super) fn decode(document: &Document, uses: &[(usize, ColorSpace)]) -> Result<Vec<Texture>, Error> {
    let budget = TextureBudget::new(document.limits);
    uses.par_iter().map(|&(image, color_space)| decode_one(document, image, color_space, &budget)).collect()
}

fn decode_one(
    document: &Document,
    index: usize,
    color_space: ColorSpace,
    budget: &TextureBudget,
) -> Result<Texture, Error> {
    let place = format!("images[{index}]");
    let image = document.get(&document.root.images, ::gltf::json::Index::new(index as u32), &place)?;
    let read;
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => {
            read = uri::read(document, uri, &format!("{place}.uri"))?;
            &read[..]
        }
        (None, Some(view)) => buffers::view(document, view, &format!("{place}.bufferView"))?.0,
        (None, None) => return Err(document.error(place, "neither uri nor bufferView", "one of them")),
    };
    let uri = image.uri.as_ref().filter(|uri| !uri.starts_with("data:"));
    let name = image.name.as_ref().or(uri).map_or_else(|| format!("image {index}"), Clone::clone);
    budget.decode(&name, bytes, color_space).map_err(|error| {
        document.error(format!("{place} ({name:?}), {}", error.place), error.found, error.expected)
    })
}
