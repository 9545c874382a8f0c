//! Non-negative numbers that carry their own exponent.
//!
//! Forward-backward needs ratios only, so it is commonly scaled once per position; but then a hypothesis that falls
//! 10³⁰⁸ behind is lost even if a later part of the sentence would vindicate it, which long sentences under a grammar
//! of lasting modes do bring about. With an exponent for each number nothing is lost.

/// 2²⁵⁶ and its inverse: mantissas stay between them.
const HIGH: f64 = f64::from_bits((1023 + 256) << 52);
const LOW: f64 = f64::from_bits((1023 - 256) << 52);
/// The unit of the exponent: 2⁵¹².
const UNIT: f64 = HIGH * HIGH;

/// mantissa · 2^(512 · exponent); zero has mantissa 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wide {
    mantissa: f64,
    exponent: i64,
}

impl Wide {
    pub(super) const ZERO: Wide = Wide { mantissa: 0.0, exponent: i64::MIN };

    /// `value`, which is finite and not negative.
    pub(super) fn new(value: f64) -> Self {
        if value > 0.0 { Wide { mantissa: value, exponent: 0 }.settled() } else { Wide::ZERO }
    }

    pub(super) fn is_zero(self) -> bool {
        self.mantissa == 0.0
    }

    /// Brings a positive mantissa back between its limits; one unit is enough for any product of two settled ones.
    #[inline]
    fn settled(self) -> Self {
        if self.mantissa < LOW {
            // Twice, because a subnormal float may lie two units down.
            let next = Wide { mantissa: self.mantissa * UNIT, exponent: self.exponent - 1 };
            if next.mantissa < LOW {
                Wide { mantissa: next.mantissa * UNIT, exponent: next.exponent - 1 }
            } else {
                next
            }
        } else if self.mantissa > HIGH {
            Wide { mantissa: self.mantissa / UNIT, exponent: self.exponent + 1 }
        } else {
            self
        }
    }

    #[inline]
    pub(super) fn times(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Wide::ZERO;
        }
        Wide { mantissa: self.mantissa * other.mantissa, exponent: self.exponent + other.exponent }.settled()
    }

    #[inline]
    pub(super) fn plus(self, other: Self) -> Self {
        let (large, small) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        if small.is_zero() {
            return if large.is_zero() { Wide::ZERO } else { large };
        }
        if large.is_zero() {
            return small;
        }
        match large.exponent - small.exponent {
            0 => Wide { mantissa: large.mantissa + small.mantissa, ..large }.settled(),
            1 => Wide { mantissa: large.mantissa + small.mantissa / UNIT, ..large }.settled(),
            // At least 2⁵¹² times as small: below the last bit.
            _ => large,
        }
    }

    /// self / other, where other is positive and not much smaller: a share of a sum.
    pub(super) fn over(self, other: Self) -> f64 {
        if self.is_zero() {
            return 0.0;
        }
        match other.exponent - self.exponent {
            0 => self.mantissa / other.mantissa,
            1 => self.mantissa / other.mantissa / UNIT,
            -1 => self.mantissa / other.mantissa * UNIT,
            _ => 0.0,
        }
    }

    /// The natural logarithm; minus infinity for zero.
    pub(super) fn ln(self) -> f64 {
        if self.is_zero() {
            return f64::NEG_INFINITY;
        }
        self.mantissa.ln() + self.exponent as f64 * 512.0 * std::f64::consts::LN_2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// On numbers whose results fit a float, wide arithmetic is float arithmetic.
        #[test]
        fn agrees_with_floats(x in 1e-60f64..1e60, y in 1e-60f64..1e60) {
            let (a, b) = (Wide::new(x), Wide::new(y));
            prop_assert_eq!(a.times(b).over(Wide::new(1.0)), x * y);
            prop_assert!((a.plus(b).over(Wide::new(1.0)) / (x + y) - 1.0).abs() < 1e-15);
            prop_assert_eq!(a.over(a.plus(Wide::ZERO)), 1.0);
            prop_assert!((a.ln() - x.ln()).abs() < 1e-12);
        }

        /// Products go far beyond a float's range and come back.
        #[test]
        fn goes_and_returns(digits in 0.5f64..300.0, n in 1usize..50) {
            let x = 10f64.powf(-digits);
            let (down, up) = (Wide::new(x), Wide::new(1.0 / x));
            let far = (0..n).fold(Wide::new(1.0), |product, _| product.times(down));
            prop_assert!((far.ln() / (n as f64 * x.ln()) - 1.0).abs() < 1e-12);
            let back = (0..n).fold(far, |product, _| product.times(up));
            prop_assert!((back.over(Wide::new(1.0)) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn extremes() {
        let tiny = Wide::new(f64::from_bits(1));
        assert!(!tiny.times(tiny).is_zero());
        assert_eq!(Wide::new(0.0).plus(tiny).over(tiny), 1.0);
        assert_eq!(tiny.plus(Wide::new(1.0)).over(Wide::new(1.0)), 1.0);
        assert!(Wide::ZERO.plus(Wide::ZERO).is_zero());
        assert!(Wide::ZERO.times(tiny).is_zero());
        assert_eq!(Wide::ZERO.ln(), f64::NEG_INFINITY);
    }
}
