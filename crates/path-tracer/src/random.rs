//! Counter-based random numbers: Philox 4x32 with 10 rounds (Salmon, Moraes, Dror and Shaw,
//! "Parallel Random Numbers: As Easy as 1, 2, 3", 2011).
//!
//! A number is a pure function of (pixel, sample, dimension, seed). Whichever thread renders a
//! sample, and in whichever order, it meets the same numbers.

/// The numbers of one sample of one pixel, dimension by dimension.
#[derive(Clone, Debug)]
pub(crate) struct Random {
    pixel: u32,
    sample: u32,
    dimension: u32,
    key: [u32; 2],
}

impl Random {
    /// The first dimension of a sample.
    pub(crate) fn new(pixel: u32, sample: u32, seed: u64) -> Self {
        Self { pixel, sample, dimension: 0, key: [seed as u32, (seed >> 32) as u32] }
    }

    /// Two independent words of 64 bits.
    pub(crate) fn bits(&mut self) -> [u64; 2] {
        let [a, b, c, d] = philox([self.pixel, self.sample, self.dimension, 0], self.key);
        self.dimension = self.dimension.wrapping_add(1);
        [join(a, b), join(c, d)]
    }

    /// Two independent uniform numbers, 0 included and 1 not.
    pub(crate) fn pair(&mut self) -> [f64; 2] {
        self.bits().map(unit)
    }

    /// Three independent uniform numbers, 0 included and 1 not.
    pub(crate) fn triple(&mut self) -> [f64; 3] {
        let ([a, b], [c, _]) = (self.pair(), self.pair());
        [a, b, c]
    }

    /// One uniform number, 0 included and 1 not.
    pub(crate) fn one(&mut self) -> f64 {
        let [value, _] = self.pair();
        value
    }
}

/// A uniform number, 0 included and 1 not, that depends on nothing but its arguments. It decides
/// whether a ray meets a partly opaque triangle, in whichever order the triangles are found.
pub(crate) fn of_pair(key: u64, index: u32) -> f64 {
    let [a, b, _, _] = philox([index, 0, 0, 1], [key as u32, (key >> 32) as u32]);
    unit(join(a, b))
}

fn join(low: u32, high: u32) -> u64 {
    u64::from(low) | u64::from(high) << 32
}

/// The upper 53 bits as a multiple of 2^-53.
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
}

fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    const MULTIPLIERS: [u64; 2] = [0xd251_1f53, 0xcd9e_8d57];
    const WEYL: [u32; 2] = [0x9e37_79b9, 0xbb67_ae85];
    for _ in 0..10 {
        let first = MULTIPLIERS[0] * u64::from(counter[0]);
        let second = MULTIPLIERS[1] * u64::from(counter[2]);
        counter = [
            (second >> 32) as u32 ^ counter[1] ^ key[0],
            second as u32,
            (first >> 32) as u32 ^ counter[3] ^ key[1],
            first as u32,
        ];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "these numbers are exact")]
mod tests {
    use super::*;

    /// The known answers that come with Random123.
    #[test]
    fn words_are_those_of_the_published_generator() {
        assert_eq!(philox([0; 4], [0; 2]), [0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8]);
        assert_eq!(philox([u32::MAX; 4], [u32::MAX; 2]), [0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd]);
        let counter = [0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344];
        let expected = [0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1];
        assert_eq!(philox(counter, [0xa4093822, 0x299f31d0]), expected);
    }

    #[test]
    fn numbers_depend_on_their_indices_alone_and_lie_in_the_unit_interval() {
        let numbers = |pixel, sample, seed| {
            let mut random = Random::new(pixel, sample, seed);
            [random.pair(), random.pair()]
        };
        assert_eq!(numbers(3, 5, 7), numbers(3, 5, 7));
        let all =
            [numbers(3, 5, 7), numbers(4, 5, 7), numbers(3, 6, 7), numbers(3, 5, 8), numbers(3, 5, 7 << 32)];
        for (index, one) in all.iter().enumerate() {
            assert!(one.as_flattened().iter().all(|value| (0.0..1.0).contains(value)));
            assert!(all.iter().skip(index + 1).all(|other| one != other));
            assert_ne!(one[0], one[1]);
        }
        assert_eq!(unit(u64::MAX), 1.0 - 2.0_f64.powi(-53));
    }

    /// Mean 1/2 and variance 1/12 of each coordinate, and no correlation between neighbours in
    /// pixel, sample and dimension: each estimate within five of its standard deviations.
    #[test]
    fn moments_are_those_of_independent_uniform_numbers() {
        const COUNT: u32 = 1 << 16;
        let n = f64::from(COUNT);
        let variable = |step: fn(u32) -> Random| (0..COUNT).map(move |index| step(index).pair());
        for step in [
            (|index| Random::new(index, 0, 1)) as fn(u32) -> Random,
            |index| Random::new(0, index, 1),
            |index| Random { dimension: index, ..Random::new(9, 9, 1) },
        ] {
            let mean = variable(step).map(|[x, _]| x).sum::<f64>() / n;
            assert!((mean - 0.5).abs() < 5.0 * (1.0 / 12.0 / n).sqrt(), "{mean}");
            let square = variable(step).map(|[x, _]| x * x).sum::<f64>() / n;
            assert!((square - 1.0 / 3.0).abs() < 5.0 * (4.0 / 45.0 / n).sqrt(), "{square}");
            let within = variable(step).map(|[x, y]| (x - 0.5) * (y - 0.5)).sum::<f64>() / n;
            let next = variable(step).skip(1).zip(variable(step));
            let between = next.map(|([x, _], [y, _])| (x - 0.5) * (y - 0.5)).sum::<f64>() / n;
            let bound = 5.0 / 12.0 / n.sqrt();
            assert!(within.abs() < bound && between.abs() < bound, "{within} {between}");
        }
    }
}
