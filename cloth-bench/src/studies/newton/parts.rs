//! The parts of an iteration, each timed alone, beside the library and the memory.

use super::{System, seconds, tried};
use crate::studies::prelude::*;
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::linear::{
    BlockCholesky, Cholesky, ConjugateGradients, FillOrdering, LinearSolver, Preconditioner,
    StoppingCriteria, upper_half,
};
use std::hint::black_box;

/// Times of all sizes.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Parts {
    iterations: Vec<Iteration>,
    eliminations: Vec<Elimination>,
    products: Vec<Product>,
}

#[derive(Default, Serialize, Deserialize)]
struct Iteration {
    vertices_a_side: u32,
    #[serde(rename = "assemble (ms)")]
    assemble: Real,
    #[serde(rename = "factorise (ms)")]
    factorise: Real,
    #[serde(rename = "solve (ms)")]
    solve: Real,
    #[serde(rename = "line search (ms)")]
    line_search: Real,
    #[serde(rename = "sum (ms)")]
    sum: Real,
    #[serde(rename = "assemble / sum")]
    assemble_over_sum: Real,
    #[serde(rename = "library (ms)")]
    library: Real,
    #[serde(rename = "sum / library")]
    sum_over_library: Real,
}

/// What one ordering costs.
#[derive(Default, Serialize, Deserialize)]
struct Elimination {
    vertices_a_side: u32,
    elements: String,
    ordering: String,
    #[serde(rename = "analyse (ms)")]
    analyse: Real,
    #[serde(rename = "factorise (ms)")]
    factorise: Real,
    numbers_in_the_factor: usize,
    /// Whether the solver chooses it.
    chosen: bool,
}

#[derive(Default, Serialize, Deserialize)]
struct Product {
    vertices_a_side: u32,
    blocks_stored: usize,
    #[serde(rename = "product (ms)")]
    product: Real,
    #[serde(rename = "product (ns per block)")]
    of_a_block: Real,
    #[serde(rename = "limit (ms)")]
    limit: Real,
    #[serde(rename = "product / limit")]
    product_over_limit: Real,
    #[serde(rename = "iteration of conjugate gradients (ms)")]
    iteration: Real,
    #[serde(rename = "iteration / product")]
    iteration_over_product: Real,
}

impl Parts {
    /// Those of one size.
    pub(super) fn of(side: u32, system: &mut System) -> Result<Self, BenchError> {
        let mut cholesky = BlockCholesky::analyze(system.matrix.pattern(), &system.is_free)?;
        let assemble = seconds(|| system.assemble());
        let matrix = &system.matrix;
        let factorise = tried(|| cholesky.factorize(matrix))?;
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
        let library = library(matrix, &system.is_free)?;
        let sum = assemble + factorise + solve + line_search;
        let iteration = Iteration {
            vertices_a_side: side,
            assemble: 1e3 * assemble,
            factorise: 1e3 * factorise,
            solve: 1e3 * solve,
            line_search: 1e3 * line_search,
            sum: 1e3 * sum,
            assemble_over_sum: assemble / sum,
            library: 1e3 * library,
            sum_over_library: sum / library,
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
        let curve = |label: &str, part: fn(&Iteration) -> Real| {
            let times = self.iterations.iter();
            let points = times.map(|i| (Real::from(i.vertices_a_side), part(i)));
            Series::new(label, points.collect())
        };
        let (sides, times) = (Axis::log("vertices a side"), Axis::log("time (ms)"));
        let plot = Plot::new("Parts of a Newton iteration", sides, times).with([
            curve("factorise", |i| i.factorise),
            curve("solve", |i| i.solve),
            curve("assemble", |i| i.assemble),
            curve("line search", |i| i.line_search),
        ]);
        findings.plot("newton-parts", &plot);
        findings.table(
            "newton-parts",
            "Parts of a Newton iteration",
            &self.iterations,
        );
        findings.table(
            "newton-orderings",
            "Orderings of the factorisation",
            &self.eliminations,
        );
        findings.table(
            "newton-products",
            "Products with the matrix",
            &self.products,
        );
        let (Some(first), Some(last)) = (self.iterations.first(), self.iterations.last()) else {
            return String::new();
        };
        let vertices = Real::from(last.vertices_a_side) / Real::from(first.vertices_a_side);
        let growth = (last.sum / first.sum).log2() / (2.0 * vertices.log2());
        format!(
            "At {0} × {0} vertices assembly is {1:.0} % of a Newton iteration and the iteration takes {2:.2} times what the library needs to refactor and solve; \
             from {3} to {0} a side its time grows with the number of vertices to the power of {growth:.2}.",
            last.vertices_a_side,
            100.0 * last.assemble_over_sum,
            last.sum_over_library,
            first.vertices_a_side,
        )
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
            let factorise = tried(|| cholesky.factorize(matrix))?;
            all.push(Elimination {
                vertices_a_side: side,
                elements: elements.to_owned(),
                ordering: named(ordering).to_owned(),
                analyse: 1e3 * seconds(|| drop(black_box(analyse()))),
                factorise: 1e3 * factorise,
                numbers_in_the_factor: cholesky.factor_len(),
                chosen: ordering == chosen,
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
    tried(|| {
        cholesky.factorize()?;
        right_hand_side.fill(1.0);
        cholesky.solve_in_place(&mut right_hand_side);
        Ok::<_, BenchError>(())
    })
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
    let many = tried(|| solver.solve(matrix, &system.gradient, &mut out))?;
    let blocks = matrix.pattern().block_count();
    // A block of 9 numbers and its column; x read, y read and written.
    let bytes = 76 * blocks + 72 * system.is_free.len();
    let (limit, iteration) = (triad(bytes), many / Real::from(ITERATIONS));
    Ok(Product {
        vertices_a_side: side,
        blocks_stored: blocks,
        product: 1e3 * time,
        of_a_block: 1e9 * time / blocks as Real,
        limit: 1e3 * limit,
        product_over_limit: time / limit,
        iteration: 1e3 * iteration,
        iteration_over_product: iteration / time,
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
