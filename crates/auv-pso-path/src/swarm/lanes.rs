//! Eight numbers side by side, in the widest registers that the processor has.
//!
//! The workspace is built for any processor of its kind. The swarm's inner loops are also compiled
//! for AVX2; [`dispatch`] chooses. Every operation is rounded by itself and nothing is fused or
//! reordered, so both give equal bits.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};
use wide::f32x8;

/// Lanes of a vector.
pub(crate) const LANES: usize = 8;

/// Eight numbers of single precision. A comparison gives a mask: all bits of a lane set, or none.
///
/// Functions that use it must be `#[inline(always)]`: only inside [`dispatch`] may the compiler use
/// the wider instructions.
pub(crate) trait Lanes:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
{
    /// Proof that the processor has the instructions.
    type Proof: Copy;

    fn splat(proof: Self::Proof, value: f32) -> Self;
    fn load(proof: Self::Proof, from: &f32x8) -> Self;
    fn store(self) -> f32x8;
    fn sqrt(self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn lt(self, other: Self) -> Self;
    fn le(self, other: Self) -> Self;
    fn gt(self, other: Self) -> Self;
    fn ge(self, other: Self) -> Self;
    /// Lanes of `set` where the mask is set, else of `unset`.
    fn select(self, set: Self, unset: Self) -> Self;
    /// Whether a mask is set in any lane.
    fn any(self) -> bool;
}

/// Work on vectors of any width.
pub(crate) trait Kernel {
    type Output;
    fn run<V: Lanes>(self, proof: V::Proof) -> Self::Output;
}

/// Runs a kernel with the widest vectors that the processor has.
pub(crate) fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(proof) = pulp::x86::V3::try_new() {
        return proof.vectorize(avx::Wide { proof, kernel });
    }
    kernel.run::<f32x8>(())
}

/// What the build's own target has: pairs of SSE2 or NEON registers, or scalars.
impl Lanes for f32x8 {
    type Proof = ();

    #[inline(always)]
    fn splat((): (), value: f32) -> Self {
        Self::splat(value)
    }
    #[inline(always)]
    fn load((): (), from: &f32x8) -> Self {
        *from
    }
    #[inline(always)]
    fn store(self) -> f32x8 {
        self
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.fast_min(other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.fast_max(other)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self {
        self.simd_lt(other)
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self {
        self.simd_le(other)
    }
    #[inline(always)]
    fn gt(self, other: Self) -> Self {
        self.simd_gt(other)
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Self {
        self.simd_ge(other)
    }
    #[inline(always)]
    fn select(self, set: Self, unset: Self) -> Self {
        self.bitselect(set, unset)
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.any()
    }
}

#[cfg(target_arch = "x86_64")]
mod avx {
    use super::{Kernel, Lanes};
    use pulp::{NullaryFnOnce, cast, x86::V3};
    use std::arch::x86_64::{__m256, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ};
    use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};
    use wide::f32x8;

    /// One register of AVX.
    #[derive(Clone, Copy)]
    pub(super) struct Avx {
        proof: V3,
        lanes: __m256,
    }

    /// A kernel to run with AVX. A closure might not be inlined.
    pub(super) struct Wide<K> {
        pub(super) proof: V3,
        pub(super) kernel: K,
    }

    impl<K: Kernel> NullaryFnOnce for Wide<K> {
        type Output = K::Output;
        #[inline(always)]
        fn call(self) -> K::Output {
            self.kernel.run::<Avx>(self.proof)
        }
    }

    macro_rules! binary {
        ($($trait:ident $method:ident $instruction:ident)*) => {$(
            impl $trait for Avx {
                type Output = Self;
                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    self.with(self.proof.avx.$instruction(self.lanes, other.lanes))
                }
            }
        )*};
    }
    binary! {
        Add add _mm256_add_ps
        Sub sub _mm256_sub_ps
        Mul mul _mm256_mul_ps
        Div div _mm256_div_ps
        BitAnd bitand _mm256_and_ps
        BitOr bitor _mm256_or_ps
    }

    impl Neg for Avx {
        type Output = Self;
        #[inline(always)]
        fn neg(self) -> Self {
            let sign = Self::splat(self.proof, -0.0);
            self.with(self.proof.avx._mm256_xor_ps(self.lanes, sign.lanes))
        }
    }

    impl Avx {
        #[inline(always)]
        fn with(self, lanes: __m256) -> Self {
            Self { lanes, ..self }
        }
    }

    impl Lanes for Avx {
        type Proof = V3;

        #[inline(always)]
        fn splat(proof: V3, value: f32) -> Self {
            let lanes = proof.avx._mm256_set1_ps(value);
            Self { proof, lanes }
        }
        #[inline(always)]
        fn load(proof: V3, from: &f32x8) -> Self {
            let lanes = cast(*from);
            Self { proof, lanes }
        }
        #[inline(always)]
        fn store(self) -> f32x8 {
            cast(self.lanes)
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            self.with(self.proof.avx._mm256_sqrt_ps(self.lanes))
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            self.with(self.proof.avx._mm256_min_ps(self.lanes, other.lanes))
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            self.with(self.proof.avx._mm256_max_ps(self.lanes, other.lanes))
        }
        #[inline(always)]
        fn lt(self, other: Self) -> Self {
            let avx = self.proof.avx;
            self.with(avx._mm256_cmp_ps::<_CMP_LT_OQ>(self.lanes, other.lanes))
        }
        #[inline(always)]
        fn le(self, other: Self) -> Self {
            let avx = self.proof.avx;
            self.with(avx._mm256_cmp_ps::<_CMP_LE_OQ>(self.lanes, other.lanes))
        }
        #[inline(always)]
        fn gt(self, other: Self) -> Self {
            let avx = self.proof.avx;
            self.with(avx._mm256_cmp_ps::<_CMP_GT_OQ>(self.lanes, other.lanes))
        }
        #[inline(always)]
        fn ge(self, other: Self) -> Self {
            let avx = self.proof.avx;
            self.with(avx._mm256_cmp_ps::<_CMP_GE_OQ>(self.lanes, other.lanes))
        }
        #[inline(always)]
        fn select(self, set: Self, unset: Self) -> Self {
            let avx = self.proof.avx;
            self.with(avx._mm256_blendv_ps(unset.lanes, set.lanes, self.lanes))
        }
        #[inline(always)]
        fn any(self) -> bool {
            self.proof.avx._mm256_movemask_ps(self.lanes) != 0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation once, on the given vectors.
    struct Every([f32x8; 3]);

    impl Kernel for Every {
        type Output = Vec<[u32; LANES]>;

        #[inline(always)]
        fn run<V: Lanes>(self, proof: V::Proof) -> Self::Output {
            let [a, b, c] = self.0.map(|lanes| V::load(proof, &lanes));
            let any = |mask: V| V::splat(proof, f32::from(u8::from(mask.any())));
            let results = [
                V::splat(proof, 1.5),
                a + b,
                a - b,
                a * b,
                a / b,
                -a,
                (a * a).sqrt(),
                a.min(b),
                a.max(b),
                a.lt(b),
                a.le(b),
                a.gt(b),
                a.ge(b),
                a.lt(b) & a.ge(c),
                a.lt(b) | a.ge(c),
                a.lt(b).select(a, c),
                any(a.lt(b)),
                any(a.lt(a)),
            ];
            results
                .map(|lanes| lanes.store().to_array().map(f32::to_bits))
                .to_vec()
        }
    }

    fn vectors() -> [f32x8; 3] {
        [
            f32x8::new([1.0, -2.0, 0.0, -0.0, 1e30, 3.5, 1e-30, -7.25]),
            f32x8::new([2.0, -2.0, 4.0, 0.5, 1e-30, -3.5, 1e30, 0.3]),
            f32x8::new([0.5, -3.0, 0.0, 1.0, 1e30, 9.0, -1.0, -8.0]),
        ]
    }

    #[test]
    fn the_widest_registers_give_the_bits_of_the_plain_ones() {
        assert_eq!(
            dispatch(Every(vectors())),
            Every(vectors()).run::<f32x8>(())
        );
    }

    #[test]
    fn every_lane_is_the_scalar_operation() {
        let found = dispatch(Every(vectors()));
        let [a, b, c] = vectors().map(|lanes| lanes.to_array());
        let mask = |holds: bool| if holds { u32::MAX } else { 0 };
        for lane in 0..LANES {
            let (a, b, c) = (a[lane], b[lane], c[lane]);
            let expected = [
                1.5_f32.to_bits(),
                (a + b).to_bits(),
                (a - b).to_bits(),
                (a * b).to_bits(),
                (a / b).to_bits(),
                (-a).to_bits(),
                (a * a).sqrt().to_bits(),
                (if a < b { a } else { b }).to_bits(),
                (if a > b { a } else { b }).to_bits(),
                mask(a < b),
                mask(a <= b),
                mask(a > b),
                mask(a >= b),
                mask(a < b && a >= c),
                mask(a < b || a >= c),
                (if a < b { a } else { c }).to_bits(),
                1.0_f32.to_bits(),
                0.0_f32.to_bits(),
            ];
            for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
                assert_eq!(found[lane], expected, "operation {k}, lane {lane}");
            }
        }
    }
}
