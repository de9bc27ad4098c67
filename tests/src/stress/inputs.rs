//! What is put into a function: extremes in every combination that is worth it, and random values.

use crate::{compare::Random, technique::Input};
use std::ops::Range;

/// The most combinations of extremes.
const MOST_COMBINATIONS: usize = 1 << 15;

/// The bits of one argument: one word, or three of a vector.
type Words = Vec<u32>;

/// All inputs of a function.
pub(super) struct Inputs {
    kinds: Vec<Input>,
    extremes: Vec<Words>,
    samples: usize,
}

/// Some of the inputs.
pub(super) struct Batch {
    /// Words of one input.
    pub(super) width: usize,
    /// All words, one input after the other.
    pub(super) words: Words,
    /// Which words are integers.
    pub(super) is_integer: Vec<bool>,
}

impl Inputs {
    pub(super) fn new(kinds: &[Input], samples: usize) -> Self {
        Self { kinds: kinds.to_vec(), extremes: combinations(kinds), samples }
    }

    pub(super) fn len(&self) -> usize {
        self.extremes.len() + self.samples
    }

    /// How many of them are made of extremes and special values; they come first.
    pub(super) fn extremes(&self) -> usize {
        self.extremes.len()
    }

    /// The inputs of a range. Random ones depend on their index alone.
    pub(super) fn batch(&self, range: Range<usize>) -> Batch {
        let mut words = Words::new();
        for index in range {
            if let Some(extreme) = self.extremes.get(index) {
                words.extend(extreme);
                continue;
            }
            let mut random = Random((index as u64) << 20);
            for kind in &self.kinds {
                random_of(*kind, &mut random, &mut words);
            }
        }
        let is_integer = self
            .kinds
            .iter()
            .flat_map(|kind| vec![matches!(kind, Input::Integer { .. }); kind.width()])
            .collect();
        Batch { width: self.kinds.iter().map(|kind| kind.width()).sum(), words, is_integer }
    }
}

impl Batch {
    /// Each input as a model takes it.
    pub(super) fn values(&self, index: usize) -> Vec<f64> {
        let words = self.words.iter().skip(index * self.width).zip(&self.is_integer);
        words
            .map(
                |(&word, &is_integer)| {
                    if is_integer { f64::from(word) } else { f64::from(f32::from_bits(word)) }
                },
            )
            .collect()
    }
}

/// Every combination of extremes where they are few; else each extreme of each argument at least
/// once among random choices of the others' extremes.
fn combinations(kinds: &[Input]) -> Vec<Words> {
    let extremes: Vec<Vec<Words>> = kinds.iter().map(|kind| extremes_of(*kind)).collect();
    let all = extremes.iter().try_fold(1_usize, |all, one| all.checked_mul(one.len()));
    let mut chosen = Vec::new();
    if let Some(all) = all.filter(|&all| all <= MOST_COMBINATIONS) {
        for index in 0..all {
            let mut rest = index;
            chosen.push(joined(&extremes, |count| {
                let digit = rest % count;
                rest /= count;
                digit
            }));
        }
        return chosen;
    }
    let longest = extremes.iter().map(Vec::len).max().unwrap_or(0);
    let mut random = Random(1);
    for index in 0..MOST_COMBINATIONS.max(longest) {
        // An odd stride per argument walks through all of its extremes; the rest is chance.
        let walking = index % (2 * kinds.len().max(1));
        let mut argument = 0;
        chosen.push(joined(&extremes, |count| {
            let walks = argument == walking;
            argument += 1;
            if walks { (index / (2 * kinds.len())) % count } else { (random.bits() % count as u64) as usize }
        }));
    }
    chosen
}

/// One input from one extreme of each argument.
fn joined(extremes: &[Vec<Words>], mut choose: impl FnMut(usize) -> usize) -> Words {
    extremes.iter().flat_map(|all| all[choose(all.len())].iter().copied()).collect()
}

fn extremes_of(kind: Input) -> Vec<Words> {
    match kind {
        Input::Real { least, greatest } => single(&reals(least, greatest)),
        Input::Any { least, greatest } => {
            let mut values = reals(least, greatest);
            for beyond in [f32::INFINITY, f32::MAX, 1e20, 2.0 * greatest.abs(), 2.0 * least.abs()] {
                values.extend([beyond, -beyond]);
            }
            values.push(f32::NAN);
            single(&values)
        }
        Input::UnitVector => unit_vectors(),
        Input::Vector { greatest } => {
            let sizes =
                [0.0, -0.0, f32::MIN_POSITIVE, 1e-20, 1e-10, 1e-3, 1.0, greatest, -1e-10, -1.0, -greatest];
            let sizes: Vec<f32> = sizes.into_iter().filter(|size| size.abs() <= greatest).collect();
            let mut vectors = Vec::new();
            for &x in &sizes {
                for &y in &sizes {
                    vectors.extend(sizes.iter().map(|&z| [x, y, z].map(f32::to_bits).to_vec()));
                }
            }
            vectors
        }
        Input::Integer { below } => {
            let last = below.saturating_sub(1);
            let powers = (0..32).flat_map(|bit| [1_u32 << bit, (1_u32 << bit) - 1]);
            let mut values: Vec<u32> = powers.filter(|&value| value <= last).collect();
            values.push(last);
            values.sort_unstable();
            values.dedup();
            values.into_iter().map(|value| vec![value]).collect()
        }
    }
}

fn single(values: &[f32]) -> Vec<Words> {
    values.iter().map(|value| vec![value.to_bits()]).collect()
}

/// The ends, steps towards them and towards 0 in decades, and special values inside a range. The
/// smallest is a normal number: adapters may flush smaller ones.
fn reals(least: f32, greatest: f32) -> Vec<f32> {
    let mut values = vec![0.0, -0.0, f32::MIN_POSITIVE, -f32::MIN_POSITIVE, 1.0, -1.0, 0.5, least, greatest];
    for near in [1.0_f32, -1.0, least, greatest] {
        values.extend([near.next_up(), near.next_down()]);
    }
    for exponent in -37..=38 {
        let size = 10_f64.powi(exponent) as f32;
        values.extend([size, -size]);
    }
    for exponent in 1..=7 {
        let step = (f64::from(greatest) - f64::from(least)) * 10_f64.powi(-exponent);
        values.push((f64::from(least) + step) as f32);
        values.push((f64::from(greatest) - step) as f32);
    }
    values.retain(|value| (least..=greatest).contains(value) && (*value == 0.0 || value.is_normal()));
    values.sort_by(f32::total_cmp);
    values.dedup_by_key(|value| value.to_bits());
    values
}

/// Axes with either sign of zero, directions beside them at many distances, and diagonals.
fn unit_vectors() -> Vec<Words> {
    let mut vectors = Vec::new();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            for zeros in [[0.0, 0.0], [-0.0, -0.0], [0.0, -0.0]] {
                vectors.push(placed(axis, sign, zeros));
            }
            for exponent in 1..=20 {
                let aside = 10_f64.powf(-0.5 * f64::from(exponent));
                for zeros in [[aside, 0.0], [0.0, -aside], [-aside, aside]] {
                    vectors.push(placed(axis, sign, zeros));
                }
            }
        }
    }
    for octant in 0..8 {
        vectors.push([0, 1, 2].map(|axis| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 }));
    }
    vectors.into_iter().map(|vector| words_of(unit(vector))).collect()
}

/// A vector with one large component.
fn placed(axis: usize, large: f64, [a, b]: [f64; 2]) -> [f64; 3] {
    let mut vector = [0.0; 3];
    vector[axis] = large;
    vector[(axis + 1) % 3] = a;
    vector[(axis + 2) % 3] = b;
    vector
}

fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = vector.iter().map(|value| value * value).sum::<f64>().sqrt();
    vector.map(|value| value / length)
}

fn words_of(vector: [f64; 3]) -> Words {
    vector.iter().map(|&value| (value as f32).to_bits()).collect()
}

fn random_of(kind: Input, random: &mut Random, words: &mut Words) {
    match kind {
        Input::Real { least, greatest } | Input::Any { least, greatest } => {
            words.push(random_real(f64::from(least), f64::from(greatest), random).to_bits());
        }
        Input::UnitVector => {
            let z = 2.0 * random.uniform() - 1.0;
            let (sine, cosine) = (std::f64::consts::TAU * random.uniform()).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            words.extend(words_of([radius * cosine, radius * sine, z]));
        }
        Input::Vector { greatest } => {
            let greatest = f64::from(greatest);
            words.extend((0..3).map(|_| log_uniform(greatest, true, true, random).to_bits()));
        }
        Input::Integer { below } => words.push((random.bits() % u64::from(below.max(1))) as u32),
    }
}

/// Half of them uniform, half log-uniform over twelve decades below the larger end.
fn random_real(least: f64, greatest: f64, random: &mut Random) -> f32 {
    if random.bits() & 1 == 0
        && (least <= 0.0 || greatest >= 1e3 * least)
        && (greatest >= 0.0 || least <= 1e3 * greatest)
    {
        let size = least.abs().max(greatest.abs());
        for _ in 0..8 {
            let value = log_uniform(size, greatest > 0.0, least < 0.0, random);
            if (least..=greatest).contains(&f64::from(value)) {
                return value;
            }
        }
    }
    ((least + (greatest - least) * random.uniform()) as f32).clamp(least as f32, greatest as f32)
}

fn log_uniform(size: f64, positive: bool, negative: bool, random: &mut Random) -> f32 {
    let value = (size * 10_f64.powf(-12.0 * random.uniform())) as f32;
    let is_negative = negative && (!positive || random.bits() & 1 == 0);
    if is_negative { -value } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(kinds: &[Input], samples: usize) -> (Inputs, Vec<Vec<f64>>) {
        let inputs = Inputs::new(kinds, samples);
        let batch = inputs.batch(0..inputs.len());
        let values = (0..inputs.len()).map(|index| batch.values(index)[..batch.width].to_vec()).collect();
        (inputs, values)
    }

    #[test]
    fn ranges_are_kept_and_their_ends_are_met() {
        for (least, greatest) in
            [(-1.0, 1.0), (0.0, 1.0), (1e-3, 5.0), (0.25, 0.75), (-10.0, -2.0), (0.0, 1e9)]
        {
            let (inputs, values) = all(&[Input::Real { least, greatest }], 4000);
            let [least, greatest] = [least, greatest].map(f64::from);
            assert!(values.iter().all(|v| (least..=greatest).contains(&v[0])), "{least}..{greatest}");
            assert!(values.contains(&vec![least]) && values.contains(&vec![greatest]));
            assert!(inputs.extremes() > 10);
            let mean = values[inputs.extremes()..].iter().map(|v| v[0]).sum::<f64>() / 4000.0;
            assert!(mean > least + 0.02 * (greatest - least) && mean < greatest, "{mean}");
        }
    }

    #[test]
    fn special_values_are_put_in() {
        let (_, values) = all(&[Input::Any { least: 0.0, greatest: 1.0 }], 0);
        let has = |wanted: f64| values.iter().any(|v| v[0].to_bits() == wanted.to_bits());
        for wanted in [0.0, -0.0, 1.0, f64::INFINITY, f64::NEG_INFINITY, f64::from(f32::MAX)] {
            assert!(has(wanted), "{wanted}");
        }
        assert!(values.iter().any(|v| v[0].is_nan()));
        assert!(has(f64::from(1.0_f32.next_down())) && has(f64::from(f32::MIN_POSITIVE)));
    }

    #[test]
    fn unit_vectors_have_unit_length() {
        let (_, values) = all(&[Input::UnitVector], 1000);
        for v in &values {
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!((length - 1.0).abs() < 2e-7, "{v:?}");
        }
        assert!(values.contains(&vec![0.0, 0.0, -1.0]));
    }

    #[test]
    fn many_arguments_meet_each_of_their_extremes() {
        let kinds = [Input::UnitVector, Input::UnitVector, Input::Real { least: 0.0, greatest: 1.0 }];
        let (inputs, values) = all(&kinds, 10);
        assert!(inputs.extremes() >= MOST_COMBINATIONS);
        for extreme in reals(0.0, 1.0) {
            assert!(values.iter().any(|v| v[6].to_bits() == f64::from(extreme).to_bits()), "{extreme}");
        }
        for extreme in unit_vectors() {
            let wanted: Vec<f64> = extreme.iter().map(|&word| f64::from(f32::from_bits(word))).collect();
            let meets = |v: &Vec<f64>| v[3..6].iter().zip(&wanted).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(values.iter().any(meets), "{wanted:?}");
        }
    }

    #[test]
    fn integers_keep_below_their_bound_and_batches_agree() {
        let kinds = [Input::Integer { below: 6 }, Input::Real { least: 0.0, greatest: 1.0 }];
        let (inputs, values) = all(&kinds, 500);
        assert!(values.iter().all(|v| v[0] < 6.0 && v[0].fract() == 0.0));
        assert!(values.iter().all(|v| v[0] < 6.0 && v[0].fract().abs() < f64::EPSILON));
        let part = inputs.batch(100..300);
        assert_eq!(part.values(7)[..2], values[107][..]);
    }
}
