//! Products and patterns against plain loops.

use super::problem::Brick;
use super::*;

#[test]
fn products_match_plain_loops_in_every_precision() {
    let problem = Brick::slipping(7).problem();
    let matrix = &problem.matrix;
    let n = matrix.unknowns();
    let x: Vec<f64> = (0..n).map(|i| (1.0 + i as f64).sin()).collect();
    let mut expected = vec![0.0; n];
    for i in 0..matrix.rows() {
        for at in matrix.pattern.row(i) {
            let j = matrix.pattern.column[at] as usize;
            for m in 0..9 {
                expected[3 * i + m / 3] += matrix.blocks[at][m] * x[3 * j + m % 3];
            }
        }
    }
    let near = |y: &[f64], tolerance: f64| y.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= tolerance);
    let mut y = vec![0.0; n];
    matrix.multiply(&x, &mut y);
    assert!(near(&y, 1e-14));
    let b: Vec<f64> = (0..n).map(|i| i as f64).collect();
    matrix.residual(&x, &b, &mut y);
    assert!(y.iter().zip(&b).zip(&expected).all(|((r, b), e)| (r - (b - e)).abs() < 1e-11));

    let single =
        BlockMatrix { pattern: matrix.pattern.clone(), blocks: matrix.blocks.iter().map(|b| b.map(|a| a as f32)).collect() };
    let x32: Vec<f32> = x.iter().map(|&x| x as f32).collect();
    let mut y32 = vec![0.0f32; n];
    single.multiply(&x32, &mut y32);
    assert!(near(&y32.iter().map(|&y| f64::from(y)).collect::<Vec<_>>(), 1e-5));
    single.multiply(&x32, &mut y);
    assert!(near(&y, 1e-6));
    single.multiply(&x, &mut y);
    assert!(near(&y, 1e-6));
    single.multiply_in_single(&x32, &mut Vec::new(), &mut y32);
    assert!(near(&y32.iter().map(|&y| f64::from(y)).collect::<Vec<_>>(), 1e-5));
}

#[test]
fn a_product_of_few_is_that_of_all() {
    let matrix = Brick::slipping(7).problem().matrix;
    let (mut x, b): (Vec<f64>, Vec<f64>) = (0..matrix.unknowns()).map(|i| (0.0, i as f64)).unzip();
    for few in [&[][..], &[0], &[40, 41, 300], &[matrix.unknowns() - 1]] {
        few.iter().for_each(|&i| x[i] = 1.0 + i as f64);
        let (mut all, mut sparse) = (b.clone(), b.clone());
        matrix.residual(&x, &b, &mut all);
        matrix.subtract_product_of_few(&x, &mut sparse);
        assert_eq!(all, sparse);
    }
    assert!(x.iter().filter(|x| **x != 0.0).count() == 5);
}

#[test]
fn identity_rows_and_blocks() {
    let problem = Brick::elastic(3).problem();
    let mut matrix = problem.matrix;
    matrix.set_identity_row(20, 1);
    let x: Vec<f64> = (0..matrix.unknowns()).map(|i| i as f64).collect();
    let mut y = vec![0.0; x.len()];
    matrix.multiply(&x, &mut y);
    assert_eq!(y[61], 61.0);
    assert_eq!(matrix.block(20, 20).unwrap()[3..6], [0.0, 1.0, 0.0]);
    assert!(matrix.block(0, 63).is_none());
}

#[test]
fn one_cycle_is_zero_at_fixed_unknowns_and_reduces_the_error() {
    let problem = Brick { grading: 1.0, ..Brick::elastic(12) }.problem();
    let n = problem.rhs.len();
    let mut hierarchy = Hierarchy::new(&problem.matrix.pattern, &problem.prolongations).unwrap();
    hierarchy.update(&problem.matrix, &problem.fixed).unwrap();
    let mut solver = LinearSolver::new(SolverKind::Direct, &problem.matrix.pattern, &[]).unwrap();
    solver.update(&problem.matrix, &problem.fixed).unwrap();
    let mut v: Vec<f64> = (0..n).map(|i| ((i as f64) * 0.618_033_988_749_894_9).fract() - 0.5).collect();
    v.iter_mut().zip(&problem.fixed).filter(|(_, fixed)| **fixed).for_each(|(v, _)| *v = 0.0);
    let (mut z, mut x) = (vec![0.0f32; n], vec![0.0; n]);
    hierarchy.v_cycle(&v, &mut z);
    solver.solve(&v, 1e-10, &mut x).unwrap();
    assert!(z.iter().zip(&problem.fixed).all(|(z, fixed)| !fixed || *z == 0.0));
    let norm = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
    let error = norm(&mut x.iter().zip(&z).map(|(x, z)| x - f64::from(*z)));
    let size = norm(&mut x.iter().copied());
    assert!(error < 0.3 * size, "{error} of {size}");
}
