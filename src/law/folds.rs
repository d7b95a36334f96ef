//! Which material is left out in which fold: a seeded shuffle that is the same everywhere.

/// The fold of each of `materials`, `folds` of them of equal size to within one.
pub fn assign(materials: usize, folds: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..materials).collect();
    let mut state = seed;
    for i in (1..materials).rev() {
        order.swap(i, (splitmix(&mut state) % (i as u64 + 1)) as usize);
    }
    let mut fold_of = vec![0; materials];
    for (place, material) in order.into_iter().enumerate() {
        fold_of[material] = place % folds.max(1);
    }
    fold_of
}

/// SplitMix64 (Steele, Lea & Flood 2014): a generator of one number of state that never changes
/// under a library's hands.
pub(super) fn splitmix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folds_are_even_and_repeatable() {
        for (materials, folds) in [(2, 2), (7, 5), (16, 5), (100, 5)] {
            let fold_of = assign(materials, folds, 2014);
            assert_eq!(fold_of, assign(materials, folds, 2014));
            let sizes: Vec<usize> = (0..folds).map(|fold| fold_of.iter().filter(|&&f| f == fold).count()).collect();
            assert!(sizes.iter().all(|&size| size >= materials / folds && size <= materials.div_ceil(folds)), "{sizes:?}");
        }
        assert_ne!(assign(100, 5, 1), assign(100, 5, 2));
    }

    #[test]
    fn the_generator_is_the_published_one() {
        let mut state = 1_234_567;
        assert_eq!(splitmix(&mut state), 6_457_827_717_110_365_317);
        assert_eq!(splitmix(&mut state), 3_203_168_211_198_807_973);
    }
}
