//! Which material is left out in which fold: a seeded shuffle that is the same everywhere.

use crate::random::Seeded;

/// The fold of each of `materials`, `folds` of them of equal size to within one.
pub fn assign(materials: usize, folds: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..materials).collect();
    let mut random = Seeded::new(seed);
    for i in (1..materials).rev() {
        order.swap(i, (random.bits() % (i as u64 + 1)) as usize);
    }
    let mut fold_of = vec![0; materials];
    for (place, material) in order.into_iter().enumerate() {
        fold_of[material] = place % folds.max(1);
    }
    fold_of
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
}
