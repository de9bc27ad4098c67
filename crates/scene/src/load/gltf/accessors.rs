//! Reads accessors after checking that every byte they claim exists.

use ::gltf::json;
use json::accessor::{ComponentType, Type};
use json::validation::Checked;

use super::{Document, buffers};
use crate::Error;

/// An accessor whose kind is known; its data is checked when it is read.
pub(super) struct Accessor<'a> {
    document: &'a Document<'a>,
    json: &'a json::Accessor,
    place: String,
    component: ComponentType,
    dimension: Type,
    /// Number of elements, as claimed.
    pub(super) count: u64,
}

impl<'a> Accessor<'a> {
    /// The accessor that an index at `place` names.
    pub(super) fn open(
        document: &'a Document<'a>,
        index: json::Index<json::Accessor>,
        place: &str,
    ) -> Result<Self, Error> {
        let json = document.get(&document.root.accessors, index, place)?;
        let place = format!("accessors[{}]", index.value());
        let Checked::Valid(component) = json.component_type else {
            return Err(document.error(
                place + ".componentType",
                "an unknown number",
                "5120 to 5123, 5125 or 5126",
            ));
        };
        let Checked::Valid(dimension) = json.type_ else {
            return Err(document.error(
                place + ".type",
                "an unknown name",
                "SCALAR, VEC2, VEC3, VEC4 or a matrix",
            ));
        };
        Ok(Self { document, json, place, component: component.0, dimension, count: json.count.0 })
    }

    /// Vectors of N numbers; normalized integers become -1..1 or 0..1.
    pub(super) fn vectors<const N: usize>(&self) -> Result<Vec<[f32; N]>, Error> {
        let matches = matches!((self.dimension, N), (Type::Vec2, 2) | (Type::Vec3, 3) | (Type::Vec4, 4));
        if !matches {
            return Err(self.error("type", format!("{:?}", self.dimension), format!("VEC{N}")));
        }
        if self.component == ComponentType::U32 {
            return Err(self.error(
                "componentType",
                "5125 (32-bit integers)",
                "floats, or integers of 8 or 16 bits",
            ));
        }
        let size = component_bytes(self.component);
        self.elements(N * size, |bytes| {
            let mut vector = [0.0; N];
            for (number, bytes) in vector.iter_mut().zip(bytes.chunks_exact(size)) {
                *number = decode_float(bytes, self.component, self.json.normalized);
            }
            vector
        })
    }

    /// Vertex indices.
    pub(super) fn indices(&self) -> Result<Vec<u32>, Error> {
        if self.dimension != Type::Scalar {
            return Err(self.error("type", format!("{:?}", self.dimension), "SCALAR"));
        }
        let size = match self.component {
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32 => component_bytes(self.component),
            other => return Err(self.error("componentType", format!("{other:?}"), "unsigned integers")),
        };
        self.elements(size, decode_unsigned)
    }

    /// Elements from the accessor's view (zeros without one), with sparse replacements.
    /// The caller has compared `count` with the limits.
    fn elements<T: Copy>(&self, size: usize, decode: impl Fn(&[u8]) -> T) -> Result<Vec<T>, Error> {
        let count = usize::try_from(self.count).unwrap_or(usize::MAX);
        let mut elements = match self.json.buffer_view {
            Some(view) => {
                let offset = self.json.byte_offset.unwrap_or_default().0;
                self.slices(view, offset, count, size)?.map(&decode).collect()
            }
            None => vec![decode(&[0; 16]); count],
        };
        if let Some(sparse) = &self.json.sparse {
            self.replace(&mut elements, sparse, size, decode)?;
        }
        Ok(elements)
    }

    fn replace<T: Copy>(
        &self,
        elements: &mut [T],
        sparse: &json::accessor::sparse::Sparse,
        size: usize,
        decode: impl Fn(&[u8]) -> T,
    ) -> Result<(), Error> {
        let Checked::Valid(index_type) = sparse.indices.component_type else {
            return Err(self.error(
                "sparse.indices.componentType",
                "an unknown number",
                "5121, 5123 or 5125",
            ));
        };
        let count = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
        let indices = &sparse.indices;
        let indices =
            self.slices(indices.buffer_view, indices.byte_offset.0, count, component_bytes(index_type.0))?;
        let values = self.slices(sparse.values.buffer_view, sparse.values.byte_offset.0, count, size)?;
        let length = elements.len();
        for (index, value) in indices.map(decode_unsigned).zip(values) {
            let element = elements.get_mut(index as usize).ok_or_else(|| {
                self.error("sparse.indices", format!("index {index}"), format!("an index below {length}"))
            })?;
            *element = decode(value);
        }
        Ok(())
    }

    /// `count` slices of `size` bytes, at the view's stride.
    fn slices(
        &self,
        view: json::Index<json::buffer::View>,
        offset: u64,
        count: usize,
        size: usize,
    ) -> Result<impl Iterator<Item = &[u8]>, Error> {
        let (bytes, stride) = buffers::view(self.document, view, &format!("{}.bufferView", self.place))?;
        let stride = stride.unwrap_or(size);
        if stride < size {
            let found = format!("byteStride {stride}");
            return Err(self.error("bufferView", found, format!("at least {size}, the size of an element")));
        }
        let needed = match count {
            0 => Some(0),
            _ => stride.checked_mul(count - 1).and_then(|bytes| bytes.checked_add(size)),
        };
        let range = usize::try_from(offset).ok().and_then(|start| Some(start..start.checked_add(needed?)?));
        let claimed = range.and_then(|range| bytes.get(range)).ok_or_else(|| {
            let found = format!("{count} elements of {size} bytes, {stride} apart, from byte {offset}");
            self.error("count", found, format!("elements within the view's {} bytes", bytes.len()))
        })?;
        Ok(claimed.chunks(stride.max(1)).filter_map(move |chunk| chunk.get(..size)))
    }

    fn error(&self, field: &str, found: impl Into<String>, expected: impl Into<String>) -> Error {
        self.document.error(format!("{}.{field}", self.place), found, expected)
    }
}

fn component_bytes(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

fn decode_unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().take(4).fold(0, |number, &byte| number << 8 | u32::from(byte))
}

fn decode_float(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let bits = decode_unsigned(bytes);
    let (number, largest) = match component {
        ComponentType::F32 | ComponentType::U32 => return f32::from_bits(bits),
        ComponentType::U8 | ComponentType::U16 => {
            (bits as f32, if bytes.len() == 1 { 255.0 } else { 65535.0 })
        }
        ComponentType::I8 => (bits as u8 as i8 as f32, 127.0),
        ComponentType::I16 => (bits as u16 as i16 as f32, 32767.0),
    };
    if normalized { (number / largest).max(-1.0) } else { number }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "the ends are exact")]
mod tests {
    use super::{ComponentType, decode_float};

    #[test]
    fn normalized_integers_reach_their_ends() {
        assert_eq!(decode_float(&[255], ComponentType::U8, true), 1.0);
        assert_eq!(decode_float(&[0xff, 0xff], ComponentType::U16, true), 1.0);
        assert_eq!(decode_float(&[0x80], ComponentType::I8, true), -1.0);
        assert_eq!(decode_float(&[0x01, 0x80], ComponentType::I16, true), -1.0);
        assert_eq!(decode_float(&[0xfe], ComponentType::I8, false), -2.0);
        assert_eq!(decode_float(&1.5_f32.to_le_bytes(), ComponentType::F32, false), 1.5);
    }
}
