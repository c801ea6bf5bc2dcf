//! The Hessian with contacts in it, multiplied out by its definition.

use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::contact::{ContactError, ContactPotential, ContactRow, ContactStep, GlobalRows};
use cloth_core::energy::Spring;
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::method::block_matrix::PatternBuilder;
use cloth_core::method::contact_hessian::ContactHessian;

/// A vertex on a floor, a pair, one without known errors of linearisation, a term on all vertices, and by how much (m
/// per m²) the first pair comes nearer where its first vertex moves; if that is 0, no errors are known.
#[derive(Debug)]
struct Contacts([ContactRow; 3], Real);

impl ContactPotential for Contacts {
    fn begin(&mut self, _: &ContactStep<'_>, _: &mut [Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn limit(&mut self, _: &[Vec3], _: &[Vec3]) -> Result<Real, ContactError> {
        Ok(1.0)
    }

    fn limit_each(
        &mut self,
        _: &[Vec3],
        _: &mut [Vec3],
        _: &mut [Real],
    ) -> Result<(), ContactError> {
        Ok(())
    }

    fn add_gradient(&self, _: &[Vec3], _: &mut [Vec3]) -> Real {
        0.0
    }

    fn linearize(&self, _: &[Vec3], out: &mut Vec<ContactRow>) {
        out.extend(self.0);
    }

    fn linearization_errors(&self, x: &[Vec3], to: &[Vec3], out: &mut Vec<Real>) {
        let vertex = self.0[1].vertices[0] as usize;
        if self.1 == 0.0 {
            return;
        }
        out.extend([-1.0, -self.1 * (to[vertex] - x[vertex]).norm_squared()]);
    }

    fn linearize_globally(&self, x: &[Vec3], out: &mut GlobalRows) {
        let row = out.push(3.0);
        row.vertices.extend(0..x.len() as u32);
        row.gradient.extend(x.iter().map(|x| x * 0.1 + Vec3::z()));
    }

    fn end(&mut self, _: &[Vec3], _: &mut [Vec3]) {}
}

/// `H p = −g` with all terms, multiplied out by their definition: the residual is what was asked for, however stiff a
/// contact is beside the cloth.
#[test]
fn the_direction_solves_the_hessian_with_contacts() {
    for stiffness in [1e3, 1e5, 1e9, 1e13] {
        solves_with_a_contact_of(stiffness);
    }
}

fn solves_with_a_contact_of(stiffest: Real) {
    let mesh = grid(17, 17, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e3),
        bending_rigidity: 0.0,
    };
    let springs: Vec<Spring> = cloth.on(&mesh).unwrap().springs;
    let x = mesh.positions();
    let stiffness = |s: &Spring| {
        let n = (x[s.vertices[0] as usize] - x[s.vertices[1] as usize]).normalize();
        n * n.transpose() * s.stiffness
    };
    let own = Mat3::from_diagonal_element(2.0);
    let rows = [
        ContactRow {
            vertices: [40, 0, 0, 0],
            weights: [1.0, 0.0, 0.0, 0.0],
            normal: Vec3::z(),
            stiffness: 1e4,
        },
        ContactRow {
            vertices: [250, 60, 61, 77],
            weights: [1.0, -0.2, -0.3, -0.5],
            normal: Vec3::new(0.6, 0.0, 0.8),
            stiffness: stiffest,
        },
        ContactRow {
            vertices: [250, 200, 201, 200],
            weights: [1.0, -0.6, -0.4, 0.0],
            normal: Vec3::new(0.0, 1.0, 0.0),
            stiffness: stiffest,
        },
    ];
    let contacts = Contacts(rows, 7.0);
    let mut pattern = PatternBuilder::new(x.len());
    pattern.add(&springs);
    let pattern = pattern.build();
    let is_free: Vec<bool> = (0..x.len()).map(|v| v != 0).collect();
    let mut hessian = ContactHessian::new(&pattern, is_free);
    let blocks = hessian.matrix_mut().blocks_mut();
    for spring in &springs {
        let [a, b] = spring.vertices;
        let k = stiffness(spring);
        blocks[pattern.slot(a, b).unwrap() as usize] -= k;
        for v in [a, b] {
            blocks[pattern.row(v as usize).end - 1] += k;
        }
    }
    for v in 0..x.len() {
        blocks[pattern.row(v).end - 1] += own;
    }
    hessian.refresh(Some(&contacts), x, x);
    assert!(hessian.has_contacts() && hessian.has_global_terms());
    let mut gradient: Vec<Vec3> = (0..x.len())
        .map(|v| Vec3::from_fn(|axis, _| ((3 * v + axis) as Real * 1.7).sin()))
        .collect();
    gradient[0] = Vec3::zeros();
    let mut p = vec![Vec3::zeros(); x.len()];
    let (_, iterations) = hessian.solve((1e-10, 200), &gradient, &mut p);
    assert!(iterations < 25, "{stiffest:e}: {iterations}");
    assert_eq!(p[0], Vec3::zeros());

    let mut residual = gradient.clone();
    for (r, p) in residual.iter_mut().zip(&p) {
        *r += own * p;
    }
    for spring in &springs {
        let [a, b] = spring.vertices.map(|v| v as usize);
        let force = stiffness(spring) * (p[a] - p[b]);
        residual[a] += force;
        residual[b] -= force;
    }
    for row in &contacts.0 {
        row.add_product(&p, &mut residual);
    }
    let along = |x: &Vec3| x * 0.1 + Vec3::z();
    let moved: Real = x.iter().zip(&p).skip(1).map(|(x, p)| along(x).dot(p)).sum();
    for (r, x) in residual.iter_mut().zip(x) {
        *r += along(x) * (3.0 * moved);
    }
    residual[0] = Vec3::zeros();
    let left = residual.iter().map(Vec3::norm).fold(0.0, Real::max);
    println!("{stiffest:e} N/m: {iterations} iterations, {left:e} N");
    // What rounds is the force of the contact, k J·p.
    let rounding = 1e-16 * stiffest;
    assert!(left < 1e-7 + rounding, "{stiffest:e}: {left:e} N");

    // Half of the direction is to be followed, and the pair is to end as far apart as its linearised motion says.
    let before = p.clone();
    let is_stiff = stiffest > 6e4;
    assert!(!hessian.correct(&Contacts(rows, 0.0), x, 0.5, &mut p));
    assert_eq!(hessian.correct(&contacts, x, 0.5, &mut p), is_stiff);
    assert_eq!(p != before, is_stiff);
    if is_stiff {
        let row = contacts.0[1];
        let ends = row.vertices.into_iter().zip(row.weights);
        let opened = ends.map(|(v, w)| row.normal.dot(&(p[v as usize] - before[v as usize])) * w);
        let opened = 0.5 * opened.sum::<Real>();
        let expected = 7.0 * (before[250] * 0.5).norm_squared();
        let error = (opened / expected - 1.0).abs();
        assert!(
            error < 1e-9,
            "{stiffest:e}: {opened:e} m for {expected:e} m"
        );
        assert_eq!(p[0], Vec3::zeros());
    }
}
