//! The parts of an iteration, each timed alone, beside the library and the memory.

use super::{System, seconds};
use crate::studies::prelude::*;
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::linear::{
    BlockCholesky, Cholesky, ConjugateGradients, FillOrdering, LinearSolver, Preconditioner,
    StoppingCriteria, upper_half,
};
use std::hint::black_box;

/// Times of all sizes (s).
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Parts {
    iterations: Vec<Iteration>,
    eliminations: Vec<Elimination>,
    products: Vec<Product>,
}

#[derive(Serialize, Deserialize)]
struct Iteration {
    side: u32,
    assemble: Real,
    factorise: Real,
    solve: Real,
    line_search: Real,
    library: Real,
}

impl Iteration {
    fn sum(&self) -> Real {
        self.assemble + self.factorise + self.solve + self.line_search
    }
}

/// What one ordering costs.
#[derive(Serialize, Deserialize)]
struct Elimination {
    side: u32,
    elements: String,
    ordering: String,
    /// Whether the solver chooses it.
    chosen: bool,
    analyse: Real,
    factorise: Real,
    numbers: usize,
}

#[derive(Serialize, Deserialize)]
struct Product {
    side: u32,
    blocks: usize,
    product: Real,
    limit: Real,
    conjugate_gradients: Real,
}

impl Parts {
    /// Those of one size.
    pub(super) fn of(side: u32, system: &mut System) -> Result<Self, BenchError> {
        let mut cholesky = BlockCholesky::analyze(system.matrix.pattern(), &system.is_free)?;
        let assemble = seconds(|| system.assemble());
        let matrix = &system.matrix;
        let mut outcome = Ok(());
        let factorise = seconds(|| outcome = cholesky.factorize(matrix));
        outcome?;
        let mut direction = vec![Vec3::zeros(); system.is_free.len()];
        let solve = seconds(|| cholesky.solve(&system.gradient, &mut direction));
        let mut there = direction.clone();
        let mut gradient = direction.clone();
        let potential = system.potential();
        let line_search = seconds(|| {
            let from = system.state.positions.iter().zip(&direction);
            for (to, (x, p)) in there.iter_mut().zip(from) {
                *to = x - p;
            }
            black_box(potential.value(&there));
            potential.gradient_into(&there, &mut gradient);
        });
        drop(cholesky);
        let iteration = Iteration {
            side,
            assemble,
            factorise,
            solve,
            line_search,
            library: library(matrix, &system.is_free)?,
        };
        Ok(Self {
            iterations: vec![iteration],
            products: vec![product(side, system)?],
            eliminations: eliminations(side, system)?,
        })
    }

    /// Adds those of another size.
    pub(super) fn append(&mut self, other: Self) {
        self.iterations.extend(other.iterations);
        self.products.extend(other.products);
        self.eliminations.extend(other.eliminations);
    }

    pub(super) fn report(&self, findings: &mut Findings) -> String {
        self.iteration_table(findings);
        self.ordering_table(findings);
        self.product_table(findings);
        let (Some(first), Some(last)) = (self.iterations.first(), self.iterations.last()) else {
            return String::new();
        };
        let vertices = Real::from(last.side) / Real::from(first.side);
        let growth = (last.sum() / first.sum()).log2() / (2.0 * vertices.log2());
        format!(
            "At {0} × {0} vertices assembly is {1:.0} % of a Newton iteration and the iteration takes {2:.2} times what the library needs to refactor and solve; \
             from {3} to {0} a side its time grows with the number of vertices to the power of {4:.2}.",
            last.side,
            100.0 * last.assemble / last.sum(),
            last.sum() / last.library,
            first.side,
            growth
        )
    }

    fn iteration_table(&self, findings: &mut Findings) {
        let mut table = Table::new(&[
            "vertices a side",
            "assemble (ms)",
            "factorise (ms)",
            "solve (ms)",
            "line search (ms)",
            "sum (ms)",
            "assemble / sum",
            "library (ms)",
            "sum / library",
        ]);
        for i in &self.iterations {
            table.push([
                Cell::from(i.side as usize),
                Cell::from(1e3 * i.assemble),
                Cell::from(1e3 * i.factorise),
                Cell::from(1e3 * i.solve),
                Cell::from(1e3 * i.line_search),
                Cell::from(1e3 * i.sum()),
                Cell::from(i.assemble / i.sum()),
                Cell::from(1e3 * i.library),
                Cell::from(i.sum() / i.library),
            ]);
        }
        let curve = |part: fn(&Iteration) -> Real| -> Vec<(Real, Real)> {
            let times = self.iterations.iter();
            times.map(|i| (Real::from(i.side), 1e3 * part(i))).collect()
        };
        findings.plot(
            "newton-parts",
            &Plot {
                title: "Parts of a Newton iteration".into(),
                x: Axis::log("vertices a side"),
                y: Axis::log("time (ms)"),
                series: vec![
                    Series::new("factorise", curve(|i| i.factorise)),
                    Series::new("solve", curve(|i| i.solve)),
                    Series::new("assemble", curve(|i| i.assemble)),
                    Series::new("line search", curve(|i| i.line_search)),
                ],
                note: String::new(),
            },
        );
        findings.table("newton-parts", "Parts of a Newton iteration", table);
    }

    fn ordering_table(&self, findings: &mut Findings) {
        let mut table = Table::new(&[
            "vertices a side",
            "elements",
            "ordering",
            "analyse (ms)",
            "factorise (ms)",
            "numbers in the factor",
            "chosen",
        ]);
        for one in &self.eliminations {
            table.push([
                Cell::from(one.side as usize),
                Cell::from(one.elements.as_str()),
                Cell::from(one.ordering.as_str()),
                Cell::from(1e3 * one.analyse),
                Cell::from(1e3 * one.factorise),
                Cell::from(one.numbers),
                Cell::from(if one.chosen { "yes" } else { "no" }),
            ]);
        }
        findings.table("newton-orderings", "Orderings of the factorisation", table);
    }

    fn product_table(&self, findings: &mut Findings) {
        let mut table = Table::new(&[
            "vertices a side",
            "blocks stored",
            "product (ms)",
            "product (ns per block)",
            "limit (ms)",
            "product / limit",
            "iteration of conjugate gradients (ms)",
            "iteration / product",
        ]);
        for p in &self.products {
            table.push([
                Cell::from(p.side as usize),
                Cell::from(p.blocks),
                Cell::from(1e3 * p.product),
                Cell::from(1e9 * p.product / p.blocks as Real),
                Cell::from(1e3 * p.limit),
                Cell::from(p.product / p.limit),
                Cell::from(1e3 * p.conjugate_gradients),
                Cell::from(p.conjugate_gradients / p.product),
            ]);
        }
        findings.table("newton-products", "Products with the matrix", table);
    }
}

fn named(ordering: FillOrdering) -> &'static str {
    match ordering {
        FillOrdering::MinimumDegree => "minimum degree",
        FillOrdering::NestedDissection => "nested dissection",
    }
}

/// Both orderings, with bending and without.
fn eliminations(side: u32, system: &System) -> Result<Vec<Elimination>, BenchError> {
    let springs = system.scene.model.springs.clone();
    let energies = cloth_core::method::family::Energies::new(system.is_free.len()).with(springs)?;
    let mut without = BlockMatrix::zeros(energies.assembly().pattern().clone());
    without.add_diagonal(system.is_free.iter().map(|_| 1.0));
    let mut all = Vec::new();
    for (elements, matrix) in [("springs", &without), ("springs, bending", &system.matrix)] {
        let chosen = BlockCholesky::analyze(matrix.pattern(), &system.is_free)?.ordering();
        for ordering in [FillOrdering::MinimumDegree, FillOrdering::NestedDissection] {
            let analyse =
                || BlockCholesky::analyze_with(matrix.pattern(), &system.is_free, ordering);
            let mut cholesky = analyse()?;
            let mut outcome = Ok(());
            let factorise = seconds(|| outcome = cholesky.factorize(matrix));
            outcome?;
            all.push(Elimination {
                side,
                elements: elements.to_owned(),
                ordering: named(ordering).to_owned(),
                chosen: ordering == chosen,
                factorise,
                numbers: cholesky.factor_len(),
                analyse: seconds(|| drop(black_box(analyse()))),
            });
        }
    }
    Ok(all)
}

/// Refactoring and solving with the library alone (s): a scalar matrix whose numbers are in place.
fn library(matrix: &BlockMatrix, is_free: &[bool]) -> Result<Real, BenchError> {
    let (pattern, values) = upper_half(matrix, is_free)?;
    let mut right_hand_side = vec![1.0; pattern.dimension()];
    let mut cholesky = Cholesky::analyze(pattern)?;
    cholesky.values_mut().copy_from_slice(&values);
    let mut outcome = Ok(());
    let time = seconds(|| {
        outcome = cholesky.factorize();
        if outcome.is_ok() {
            right_hand_side.fill(1.0);
            cholesky.solve_in_place(&mut right_hand_side);
        }
    });
    outcome?;
    Ok(time)
}

fn product(side: u32, system: &System) -> Result<Product, BenchError> {
    const ITERATIONS: u32 = 20;
    let matrix = &system.matrix;
    let mut out = system.gradient.clone();
    let time = seconds(|| matrix.multiply(black_box(&system.gradient), &mut out));
    let budget = StoppingCriteria {
        tolerance: 0.0,
        max_iterations: ITERATIONS,
    };
    let preconditioner = Preconditioner::BlockJacobi;
    let mut solver = ConjugateGradients::new(&system.is_free, preconditioner, budget)?;
    solver.prepare(matrix)?;
    let mut outcome = Ok(());
    let many = seconds(|| {
        let solved = solver.solve(matrix, &system.gradient, &mut out);
        outcome = solved.map(|_| ());
    });
    outcome?;
    let blocks = matrix.pattern().block_count();
    // A block of 9 numbers and its column; x read, y read and written.
    let bytes = 76 * blocks + 72 * system.is_free.len();
    Ok(Product {
        side,
        blocks,
        product: time,
        limit: triad(bytes),
        conjugate_gradients: many / Real::from(ITERATIONS),
    })
}

/// Time (s) of `a = b + 3c` over three arrays that together have `bytes`.
fn triad(bytes: usize) -> Real {
    let count = bytes / 24;
    let (b, c) = (vec![1.0; count], vec![2.0; count]);
    let mut a: Vec<Real> = vec![0.0; count];
    seconds(|| {
        for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
            *a = b + 3.0 * c;
        }
        black_box(&mut a);
    })
}
