//! The energy of a cloth as plain loops over arrays, beside the families of elements that every method gets; and one
//! triangle with its Hessian, beside the element.
//!
//! `cargo run --release -p cloth-core --example first_program`

use cloth_core::element::{Convexity, Energy};
use cloth_core::energy::StvkTriangle;
use cloth_core::topology::{EdgeTable, HingeTable};
use cloth_core::{Cloth, Diagonals, Membrane, TriMesh, Vec3, grid};

const STIFFNESS: f64 = 1e4; // N/m
const RIGIDITY: f64 = 1e-3; // N·m
const MODULUS: f64 = 1e3; // N/m
const POISSON: f64 = 0.3;

/// Energy (J) of springs on all edges and quadratic hinges across the inner ones, with its gradient (N).
fn energy(mesh: &TriMesh, edges: &EdgeTable, hinges: &HingeTable, x: &[Vec3]) -> (f64, Vec<Vec3>) {
    let rest = mesh.positions();
    let (mut energy, mut gradient) = (0.0, vec![Vec3::zeros(); x.len()]);
    // Springs: ½ k (‖x₀ − x₁‖ − L)².
    for ends in edges.ends() {
        let [a, b] = ends.map(|vertex| vertex as usize);
        let d = x[a] - x[b];
        let value = d.norm() - (rest[a] - rest[b]).norm();
        energy += 0.5 * STIFFNESS * value * value;
        gradient[a] += d / d.norm() * (STIFFNESS * value);
        gradient[b] -= d / d.norm() * (STIFFNESS * value);
    }
    // Hinges: ½ K ‖Σ qᵢ xᵢ‖², with q from the cotangents at rest: zero for any flat shape, so it measures the bend.
    for hinge in hinges.hinges() {
        let corners = hinge.map(|vertex| vertex as usize); // the shared edge, then the two wings
        let [p, q, left, right] = corners.map(|corner| rest[corner]);
        let cot = |at: Vec3, to: Vec3, other: Vec3| {
            (to - at).dot(&(other - at)) / (to - at).cross(&(other - at)).norm()
        };
        let (at_p, at_q) = (
            [cot(p, q, left), cot(p, q, right)],
            [cot(q, p, left), cot(q, p, right)],
        );
        let coefficients = [
            at_q[0] + at_q[1],
            at_p[0] + at_p[1],
            -(at_p[0] + at_q[0]),
            -(at_p[1] + at_q[1]),
        ];
        let area = |wing: Vec3| 0.5 * (q - p).cross(&(wing - p)).norm();
        // 3 k/(A₀ + A₁), with k = D/3: the rigidity D of a sheet of equilateral triangles.
        let stiffness = RIGIDITY / (area(left) + area(right));
        let sum: Vec3 = (0..4).map(|i| x[corners[i]] * coefficients[i]).sum();
        energy += 0.5 * stiffness * sum.norm_squared();
        for i in 0..4 {
            gradient[corners[i]] += sum * (stiffness * coefficients[i]);
        }
    }
    (energy, gradient)
}

/// Energy (J) of a St. Venant–Kirchhoff triangle at `x` (m), and its first and second derivative along `p` (m):
/// `∂E·p` and `pᵀHp` (J). All are polynomials: `E = ½ Σ k C²`, so `∂E·p = Σ k C C′` and `pᵀHp = Σ k (C′² + C C″)`.
fn triangle(rest: &[Vec3; 3], x: &[Vec3; 3], p: &[Vec3; 3]) -> [f64; 3] {
    // The rest shape in its plane: the corners (0, 0), (a, 0) and (c, d).
    let [u, v] = [rest[1] - rest[0], rest[2] - rest[0]];
    let a = u.norm();
    let (c, d) = (u.dot(&v) / a, u.cross(&v).norm() / a);
    let area = 0.5 * a * d;
    // The columns of F = [x₁ − x₀, x₂ − x₀] [[a, c], [0, d]]⁻¹, linear in x: along p they change by those of p.
    let columns = |y: &[Vec3; 3]| {
        let f = (y[1] - y[0]) / a;
        [f, (y[2] - y[0] - f * c) / d]
    };
    let ([f, g], [f1, g1]) = (columns(x), columns(p));
    let root = 2.0_f64.sqrt();
    // C, C′, C″ and k of each row: the Green strain in the eigenbasis of the plane-stress matrix.
    let rows = [
        (
            (f.dot(&f) + g.dot(&g) - 2.0) / (2.0 * root),
            (f.dot(&f1) + g.dot(&g1)) / root,
            (f1.dot(&f1) + g1.dot(&g1)) / root,
            area * MODULUS / (1.0 - POISSON),
        ),
        (
            (f.dot(&f) - g.dot(&g)) / (2.0 * root),
            (f.dot(&f1) - g.dot(&g1)) / root,
            (f1.dot(&f1) - g1.dot(&g1)) / root,
            area * MODULUS / (1.0 + POISSON),
        ),
        (
            f.dot(&g) / root,
            (f.dot(&g1) + f1.dot(&g)) / root,
            root * f1.dot(&g1),
            area * MODULUS / (1.0 + POISSON),
        ),
    ];
    let sum = |term: fn(f64, f64, f64) -> f64| {
        rows.iter()
            .map(|(c, c1, c2, k)| k * term(*c, *c1, *c2))
            .sum()
    };
    [
        sum(|c, _, _| 0.5 * c * c),
        sum(|c, c1, _| c * c1),
        sum(|c, c1, c2| c1 * c1 + c * c2),
    ]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = grid(17, 17, 1.0, 1.0, Diagonals::Alternating)?; // 1 m × 1 m
    let cloth = Cloth {
        areal_density: 0.2, // kg/m²
        membrane: Membrane::SpringStiffness(STIFFNESS),
        bending_rigidity: RIGIDITY,
    };
    let energies = cloth.on(&mesh)?.energies()?;
    let edges = EdgeTable::build(&mesh)?;
    let hinges = HingeTable::build(&mesh, &edges);
    let waved = |p: &Vec3| Vec3::new(p.x, 1.01 * p.y, 0.05 * (7.0 * p.x + 3.0 * p.y).sin());
    let x: Vec<Vec3> = mesh.positions().iter().map(waved).collect();

    let (naive, slope) = energy(&mesh, &edges, &hinges, &x);
    let mut gradient = vec![Vec3::zeros(); x.len()];
    let real = energies.add_gradient(&x, &mut gradient);
    let pairs = slope.iter().zip(&gradient);
    let apart = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    let largest = gradient.iter().map(Vec3::norm).fold(0.0, f64::max);
    println!(
        "{naive:.6} J and {real:.6} J; the gradients differ by {apart:.1e} N of {largest:.1} N"
    );
    assert!((naive / real - 1.0).abs() < 1e-13 && apart < 1e-12 * largest);

    let [rest, now] = [mesh.positions(), &x[..]].map(|y| [y[0], y[1], y[17]]);
    let p = [[0.01, 0.0, 0.02], [-0.02, 0.01, 0.0], [0.0, 0.03, -0.01]].map(Vec3::from);
    let naive = triangle(&rest, &now, &p);
    let element = StvkTriangle::new([0, 1, 17], &rest, MODULUS, POISSON);
    let along = |forces: [Vec3; 3]| forces.iter().zip(&p).map(|(f, p)| f.dot(p)).sum::<f64>();
    let real = [
        element.value(&now),
        along(element.gradient(&now)),
        along(element.hessian_product(&now, &p, Convexity::Exact)),
    ];
    println!("a triangle: E, ∂E·p and pᵀHp are {naive:.6?} J and {real:.6?} J");
    for (naive, real) in naive.iter().zip(real) {
        assert!((naive / real - 1.0).abs() < 1e-12, "{naive} {real}");
    }
    Ok(())
}

#[test]
fn the_naive_formulas_and_the_elements_agree() {
    main().unwrap();
}
