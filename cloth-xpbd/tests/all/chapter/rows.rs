//! Elements with several rows are solved as one small system.

use crate::chapter::iterations;
use cloth_core::element::{Constraint, Element, Row};
use cloth_core::energy::{Spring, StvkTriangle};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::XpbdSolver;
use nalgebra::{DMatrix, DVector};

/// Three linear rows on two vertices, whose gradients are far from being at right angles.
#[derive(Clone, Copy, Debug)]
struct Slanted {
    stiffness: [Real; 3],
    /// Repeats the first row as the third.
    twice: bool,
}

impl Slanted {
    fn gradients(&self) -> [[Vec3; 2]; 3] {
        let (a, b) = (Vec3::new(1.0, 0.2, 0.1), Vec3::new(0.9, 0.3, -0.1));
        let c = if self.twice {
            a
        } else {
            Vec3::new(0.8, 0.1, 0.4)
        };
        [[a, -a], [b, -a], [c, -a]]
    }
}

impl Element<2> for Slanted {
    fn vertices(&self) -> [u32; 2] {
        [0, 1]
    }
}

impl Constraint<2> for Slanted {
    type Rows = [Row<2>; 3];

    fn rows(&self, x: &[Vec3; 2]) -> [Row<2>; 3] {
        let gradients = self.gradients();
        std::array::from_fn(|r| Row {
            value: gradients[r][0].dot(&x[0]) + gradients[r][1].dot(&x[1]) - 0.3,
            gradient: gradients[r],
            stiffness: self.stiffness[r],
        })
    }
}

const MASSES: [Real; 2] = [0.2, 0.5];

/// x after one step of `h` (s) without forces.
fn step(element: Slanted, h: Real, n: u32) -> (Vec<Vec3>, Real) {
    let particles = Particles::new(MASSES.to_vec()).unwrap();
    let builder = XpbdSolver::builder(&particles).energy(vec![element]);
    let mut solver = builder.config(iterations(n)).build().unwrap();
    let mut state = State::at_rest(vec![Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 0.5, 0.2)]);
    solver.step(&mut state, StepInput::new(h)).unwrap();
    let residual = solver.compliance_residual(&state.positions);
    (state.positions, residual)
}

/// The same from `(M/h² + Σ k ∂C ∂Cᵀ) Δx = −Σ k C ∂C`, or with multipliers where k is infinite, by a dense
/// solve.
fn dense(element: Slanted, h: Real) -> DVector<Real> {
    let x = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 0.5, 0.2)];
    let rows = element.rows(&x);
    let mut matrix = DMatrix::zeros(9, 9);
    let mut right = DVector::zeros(9);
    for i in 0..6 {
        matrix[(i, i)] = MASSES[i / 3];
    }
    for (r, row) in rows.iter().enumerate() {
        for i in 0..6 {
            matrix[(6 + r, i)] = row.gradient[i / 3][i % 3];
            matrix[(i, 6 + r)] = -row.gradient[i / 3][i % 3];
        }
        matrix[(6 + r, 6 + r)] = 1.0 / (row.stiffness * h * h);
        right[6 + r] = -row.value;
    }
    let change = matrix.lu().solve(&right).unwrap();
    DVector::from_fn(6, |i, _| x[i / 3][i % 3] + change[i])
}

#[test]
fn one_visit_solves_the_rows_of_an_element_together() {
    let h = 0.05;
    for stiffness in [
        [10.0, 500.0, 3.0],
        [1e4, Real::INFINITY, 2.0],
        [Real::INFINITY; 3],
    ] {
        let element = Slanted {
            stiffness,
            twice: false,
        };
        let (positions, residual) = step(element, h, 1);
        let expected = dense(element, h);
        let error = (0..6).map(|i| (positions[i / 3][i % 3] - expected[i]).abs());
        let error = error.fold(0.0, Real::max);
        assert!(error < 1e-12, "{stiffness:?}: {error:e} m");
        assert!(residual < 1e-12, "{stiffness:?}: {residual:e}");
    }
}

#[test]
fn a_row_that_repeats_another_is_left_out_where_both_are_hard() {
    let element = Slanted {
        stiffness: [Real::INFINITY; 3],
        twice: true,
    };
    let (positions, residual) = step(element, 0.05, 1);
    assert!(residual < 1e-13, "{residual:e} {positions:?}");
}

#[test]
fn a_row_without_stiffness_does_not_disturb_the_others() {
    let element = Slanted {
        stiffness: [0.0, 40.0, 70.0],
        twice: false,
    };
    let (positions, _) = step(element, 0.05, 1);
    let without = DVector::from_column_slice(&[0.0; 6])
        + dense(
            Slanted {
                stiffness: [1e-280, 40.0, 70.0],
                twice: false,
            },
            0.05,
        );
    for i in 0..6 {
        assert!((positions[i / 3][i % 3] - without[i]).abs() < 1e-12);
    }
}

#[test]
fn a_triangle_alone_keeps_its_momentum_and_its_rows_vanish() {
    let rest = [Vec3::zeros(), Vec3::x(), Vec3::new(0.3, 0.8, 0.0)];
    let particles = Particles::new(vec![0.1, 0.2, 0.4]).unwrap();
    let triangle = StvkTriangle::new([0, 1, 2], &rest, 50.0, 0.3);
    let builder = XpbdSolver::builder(&particles).energy(vec![triangle]);
    let mut solver = builder.config(iterations(6)).build().unwrap();
    let mut state = State::at_rest(
        rest.map(|x| Vec3::new(1.2 * x.x + 0.2 * x.y, x.y, 0.1 * x.x))
            .to_vec(),
    );
    solver.step(&mut state, StepInput::new(0.01)).unwrap();
    let residual = solver.compliance_residual(&state.positions);
    assert!(residual < 1e-13, "{residual:e}");
    let momentum = cloth_core::measure::linear_momentum(&particles, &state.velocities);
    assert!(momentum.norm() < 1e-14);
}

#[test]
fn the_family_added_last_is_met_best() {
    let particles = Particles::new(vec![0.1; 3]).unwrap();
    let link = |vertices| {
        vec![Spring {
            vertices,
            rest_length: 1.0,
            stiffness: Real::INFINITY,
        }]
    };
    let positions = [Vec3::zeros(), Vec3::x() * 1.2, Vec3::x() * 2.4];
    let ends = [[0, 1], [1, 2]];
    for order in [[0, 1], [1, 0]] {
        let builder = XpbdSolver::builder(&particles).energy(link(ends[order[0]]));
        let builder = builder.energy(link(ends[order[1]]));
        let mut solver = builder.config(iterations(1)).build().unwrap();
        let mut state = State::at_rest(positions.to_vec());
        solver.step(&mut state, StepInput::new(0.01)).unwrap();
        let stretch = order.map(|family| {
            let [a, b] = ends[family].map(|v: u32| state.positions[v as usize]);
            (a - b).norm() - 1.0
        });
        // The second takes half of its 0.3 m from the vertex that they share.
        assert!((stretch[0] - 0.15).abs() < 1e-15, "{stretch:?}");
        assert!(stretch[1].abs() < 1e-15, "{stretch:?}");
    }
}
