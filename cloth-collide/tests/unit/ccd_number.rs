use super::*;
use cloth_core::random::SplitMix64;

/// A whole number of up to 60 bits, which no `f64` holds, and the same as a pair.
fn draw(random: &mut SplitMix64) -> (i128, Double) {
    let bits = i128::from(random.next_bits() >> (5 + random.next_bits() % 40)) - (1 << 30);
    let high = bits as Real;
    let low = (bits - high as i128) as Real;
    (bits, Double::new(high, low))
}

fn assert_near(found: Double, exact: i128) {
    let error = (exact - found.high as i128) - found.low as i128;
    let allowed = exact.unsigned_abs() >> 102; // 16 u²
    assert!(
        error.unsigned_abs() <= allowed + 1,
        "{found:?} is not {exact}"
    );
    assert!(found.low.abs() <= Real::EPSILON * found.high.abs());
}

#[test]
fn pairs_add_and_multiply_to_twice_the_digits() {
    let mut random = SplitMix64::new(3);
    for _ in 0..100_000 {
        let ((a, x), (b, y)) = (draw(&mut random), draw(&mut random));
        assert_near(x + y, a + b);
        assert_near(x - y, a - b);
        assert_near(x * y, a * b);
    }
}

#[test]
fn powers_bring_numbers_to_order_one() {
    for x in [1.0, 1.999, 1e300, 3e-308, 7.0] {
        assert!((1.0..2.0).contains(&(x * power_for(x))), "{x:e}");
    }
    assert!(Real::from_bits(1) * power_for(Real::from_bits(1)) >= Real::EPSILON);
    assert!((0.0 * power_for(0.0)) == 0.0);
}
