//! Truths that are kept between runs, keyed by everything that decides them.
//!
//! A file holds a line of JSON (the key itself, sizes, and a checksum of what follows) and then the
//! values as little-endian floats. A file that does not fit its key or its checksum is made anew.

mod path_traced;

pub use path_traced::path_traced;

use crate::{
    Context,
    program::make_folder,
    technique::{Failure, Truth, TruthImage},
};
use image_error::Image;
use serde::{Deserialize, Serialize};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Changes whenever the layout of the files does.
const FORMAT: u32 = 1;

#[derive(Debug, Serialize, Deserialize, PartialEq)]
struct Head {
    format: u32,
    key: String,
    how: String,
    width: usize,
    height: usize,
    has_variance: bool,
    has_mask: bool,
    checksum: String,
}

/// The truth, from the folder of truths if it is there, and kept there if it has a key.
pub(crate) fn get(context: &mut Context, truth: &Truth) -> Result<TruthImage, Failure> {
    let Some(key) = &truth.key else { return checked((truth.make)(context)?) };
    let path = path_of(context, key);
    if !context.scope().fresh
        && let Some(kept) = fs::read(&path).ok().and_then(|bytes| decode(&bytes, key))
    {
        return Ok(kept);
    }
    let made = checked((truth.make)(context)?)?;
    keep(&path, &encode(&made, key)?)?;
    Ok(made)
}

fn path_of(context: &Context, key: &str) -> PathBuf {
    context.references().join(format!("{}.truth", fingerprint(key.as_bytes())))
}

/// Writes a file into the folder of truths.
fn keep(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    path.parent().map_or(Ok(()), make_folder)?;
    Ok(scene::output::write_whole(path, bytes)?)
}

/// 32 hexadecimal digits that tell contents apart (FNV-1a of 128 bits).
pub(crate) fn fingerprint(bytes: &[u8]) -> String {
    let mut hash: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    for &byte in bytes {
        hash = (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
    }
    format!("{hash:032x}")
}

/// A truth whose parts fit each other.
fn checked(truth: TruthImage) -> Result<TruthImage, Failure> {
    let pixels = truth.image.pixels().len();
    for (what, found) in [
        ("variances", truth.variance_of_mean.as_ref().map(Vec::len)),
        ("values of the mask", truth.mask.as_ref().map(Vec::len)),
    ] {
        if found.is_some_and(|found| found != pixels) {
            return Err(format!("a truth of {pixels} pixels has {} {what}", found.unwrap_or(0)).into());
        }
    }
    if truth.mask.as_ref().is_some_and(|mask| !mask.contains(&true)) {
        return Err("the mask of a truth takes no pixel at all".into());
    }
    Ok(truth)
}

fn encode(truth: &TruthImage, key: &str) -> Result<Vec<u8>, Failure> {
    let mut values: Vec<u8> = bytes_of(truth.image.pixels()).collect();
    values.extend(truth.variance_of_mean.iter().flat_map(|variance| bytes_of(variance)));
    values.extend(truth.mask.iter().flatten().map(|&counts| u8::from(counts)));
    let head = Head {
        format: FORMAT,
        key: key.to_owned(),
        how: truth.how.clone(),
        width: truth.image.width(),
        height: truth.image.height(),
        has_variance: truth.variance_of_mean.is_some(),
        has_mask: truth.mask.is_some(),
        checksum: fingerprint(&values),
    };
    let mut file = serde_json::to_vec(&head)?;
    file.push(b'\n');
    file.extend(values);
    Ok(file)
}

/// The truth of a file; `None` where it was made from something else, or was cut or changed.
fn decode(file: &[u8], key: &str) -> Option<TruthImage> {
    let end = file.iter().position(|&byte| byte == b'\n')?;
    let head: Head = serde_json::from_slice(&file[..end]).ok()?;
    let values = &file[end + 1..];
    if head.format != FORMAT || head.key != key || head.checksum != fingerprint(values) {
        return None;
    }
    let pixels = head.width.checked_mul(head.height)?;
    let image_bytes = pixels.checked_mul(12)?;
    let (image, rest) = values.split_at_checked(image_bytes)?;
    let (variance, mask) = rest.split_at_checked(if head.has_variance { image_bytes } else { 0 })?;
    if mask.len() != if head.has_mask { pixels } else { 0 } {
        return None;
    }
    Some(TruthImage {
        image: Image::new(head.width, head.height, pixels_of(image)).ok()?,
        variance_of_mean: head.has_variance.then(|| pixels_of(variance)),
        mask: head.has_mask.then(|| mask.iter().map(|&byte| byte != 0).collect()),
        how: head.how,
    })
}

fn bytes_of(pixels: &[[f32; 3]]) -> impl Iterator<Item = u8> {
    pixels.iter().flatten().flat_map(|value| value.to_le_bytes())
}

fn pixels_of(bytes: &[u8]) -> Vec<[f32; 3]> {
    let (words, _) = bytes.as_chunks::<4>();
    let (pixels, _) = words.as_chunks::<3>();
    pixels.iter().map(|pixel| pixel.map(f32::from_le_bytes)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth() -> TruthImage {
        TruthImage {
            image: Image::new(2, 1, vec![[1.0, 2.0, 3.0], [4.0, -5.0, f32::INFINITY]]).unwrap(),
            variance_of_mean: Some(vec![[0.5; 3], [0.25; 3]]),
            mask: Some(vec![true, false]),
            how: "by hand".into(),
        }
    }

    #[test]
    fn a_truth_comes_back_as_it_was_kept() {
        for (variance, mask) in [(true, true), (true, false), (false, true), (false, false)] {
            let mut truth = truth();
            truth.variance_of_mean = truth.variance_of_mean.filter(|_| variance);
            truth.mask = truth.mask.filter(|_| mask);
            let back = decode(&encode(&truth, "key").unwrap(), "key").unwrap();
            assert_eq!((back.image, back.how), (truth.image, truth.how));
            assert_eq!((back.variance_of_mean, back.mask), (truth.variance_of_mean, truth.mask));
        }
    }

    #[test]
    fn a_file_that_was_cut_or_changed_is_not_taken() {
        let file = encode(&truth(), "key").unwrap();
        assert!(decode(&file, "another key").is_none());
        for length in 0..file.len() {
            assert!(decode(&file[..length], "key").is_none(), "{length}");
        }
        let mut changed = file.clone();
        let last = changed.len() - 20;
        changed[last] ^= 1;
        assert!(decode(&changed, "key").is_none());
    }

    #[test]
    fn parts_that_do_not_fit_are_refused() {
        assert!(checked(truth()).is_ok());
        assert!(checked(TruthImage { mask: Some(vec![true]), ..truth() }).is_err());
        assert!(checked(TruthImage { mask: Some(vec![false, false]), ..truth() }).is_err());
        assert!(checked(TruthImage { variance_of_mean: Some(Vec::new()), ..truth() }).is_err());
    }

    #[test]
    fn the_fingerprint_is_the_published_function() {
        assert_eq!(fingerprint(b""), "6c62272e07bb014262b821756295c58d");
        assert_eq!(fingerprint(b"a"), "d228cb696f1a8caf78912b704e4a8964");
    }
}
