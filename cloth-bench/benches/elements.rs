//! Every element by every view that it has, on shaken sheets of three sizes: energy, gradient, Hessian into its slots
//! and its product without a matrix; one sweep of constraint projections; one local step of projective dynamics.
//!
//! The throughput that criterion prints is elements per second, so its inverse is the time of one.

use cloth_core::cloth::{Cloth, Elements, Membrane, MembraneElements};
use cloth_core::element::{Constraint, Convexity, Energy, Projective};
use cloth_core::energy::{
    ArapTriangle, AreaTriangle, Attachment, CubicShell, CurvatureHinge, CurvedHinge, DihedralHinge,
    MidpointHinge, Spring, StrainLimitSpring, StrainLimitTriangle, StvkTriangle, VolumeTetrahedron,
};
use cloth_core::math::{Mat3, Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::family::Energies;
use cloth_core::particles::Particles;
use cloth_core::topology::{EdgeTable, HingeTable};
use cloth_pd::LocalStep;
use criterion::{Criterion, Throughput};
use rayon::ThreadPoolBuilder;
use support::limit;
use support::sheet::{Compliant, coloured, shaken, sweep_bytes};

const SIDES: [usize; 3] = [32, 128, 256];
/// N/m.
const STIFFNESS: Real = 1e4;
/// N·m.
const RIGIDITY: Real = 1e-5;

/// A sheet with everything that elements are made from.
struct Sheet {
    mesh: TriMesh,
    edges: EdgeTable,
    hinges: HingeTable,
    /// Positions (m), not at rest.
    x: Vec<Vec3>,
}

impl Sheet {
    fn new(side: usize) -> Self {
        let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating).expect("a sheet");
        let edges = EdgeTable::build(&mesh).expect("edges");
        Self {
            hinges: HingeTable::build(&mesh, &edges),
            x: shaken(mesh.positions()),
            mesh,
            edges,
        }
    }

    fn springs(&self) -> Vec<Spring> {
        Spring::along(self.mesh.positions(), self.edges.ends(), STIFFNESS)
    }

    fn limited_springs(&self) -> Vec<StrainLimitSpring> {
        let (rest, ends) = (self.mesh.positions(), self.edges.ends());
        StrainLimitSpring::along(rest, ends, [0.95, 1.05], STIFFNESS)
    }

    fn stvk(&self) -> Vec<StvkTriangle> {
        StvkTriangle::on(&self.mesh, STIFFNESS, 0.3)
    }

    fn arap(&self) -> Vec<ArapTriangle> {
        ArapTriangle::on(&self.mesh, STIFFNESS)
    }

    fn areas(&self) -> Vec<AreaTriangle> {
        AreaTriangle::on(&self.mesh, STIFFNESS)
    }

    fn limited_triangles(&self) -> Vec<StrainLimitTriangle> {
        StrainLimitTriangle::on(&self.mesh, [0.95, 1.05], STIFFNESS)
    }

    fn quadratic_hinges(&self) -> Vec<CurvatureHinge> {
        CurvatureHinge::across(&self.mesh, &self.hinges, RIGIDITY)
    }

    fn curved_hinges(&self) -> Vec<CurvedHinge> {
        CurvedHinge::across(&self.mesh, &self.hinges, RIGIDITY)
    }

    fn dihedral_hinges(&self) -> Vec<DihedralHinge> {
        DihedralHinge::across(&self.mesh, &self.hinges, RIGIDITY)
    }

    fn cubic_shells(&self) -> Vec<CubicShell> {
        CubicShell::across(&self.mesh, &self.hinges, RIGIDITY)
    }

    /// The four vertices of every hinge, lifted alternately so that they span a volume.
    fn tetrahedra(&self) -> Vec<VolumeTetrahedron> {
        let lifted = |i: usize, x: &Vec3| x + Vec3::z() * (0.01 * (i % 3) as Real);
        let rest = self.mesh.positions().iter().enumerate();
        let rest: Vec<Vec3> = rest.map(|(i, x)| lifted(i, x)).collect();
        let hinges = self.hinges.hinges().iter();
        hinges
            .map(|&v| VolumeTetrahedron::new(v, &gather(&rest, v), STIFFNESS))
            .collect()
    }

    /// Bending between the middles of the edges, and where these are (m).
    fn midpoint_hinges(&self) -> (Vec<MidpointHinge>, Vec<Vec3>) {
        let cloth = Cloth {
            areal_density: 0.2,
            membrane: Membrane::SpringStiffness(STIFFNESS),
            bending_rigidity: RIGIDITY,
        };
        let cut = cloth.on_midpoints(MembraneElements::Springs, &self.mesh);
        let cut = cut.expect("a cloth on midpoints");
        let hinges = cut
            .model
            .others
            .into_iter()
            .find_map(|family| match family {
                Elements::Midpoint(hinges) => Some(hinges),
                _ => None,
            });
        (hinges.expect("hinges"), cut.midpoints.between(&self.x))
    }

    fn attachments(&self) -> Vec<Attachment> {
        let attach = |(vertex, &target): (usize, &Vec3)| Attachment {
            vertex: vertex as u32,
            target,
            stiffness: STIFFNESS,
        };
        self.mesh
            .positions()
            .iter()
            .enumerate()
            .map(attach)
            .collect()
    }
}

/// Bytes of one number of three coordinates per vertex.
fn vectors(x: &[Vec3]) -> usize {
    size_of_val(x)
}

fn energy<const N: usize, E: Energy<N>>(
    criterion: &mut Criterion,
    name: &str,
    (side, x): (usize, &[Vec3]),
    elements: Vec<E>,
) {
    let count = elements.len();
    let bytes = size_of_val(&elements[..]) + vectors(x);
    let energies = Energies::new(x.len()).with(elements);
    let energies = energies.expect("elements of the sheet");
    let mut group = criterion.benchmark_group(format!("energy of {name}, {side} a side"));
    group.throughput(Throughput::Elements(count as u64));
    limit::bench(&mut group, "value", bytes, || energies.value(x));
    let mut out = vec![Vec3::zeros(); x.len()];
    let with_sum = bytes + 2 * vectors(x);
    limit::bench(&mut group, "gradient", with_sum, || {
        energies.add_gradient(x, &mut out);
    });
    let with_both = with_sum + vectors(x);
    limit::bench(&mut group, "Hessian times vector", with_both, || {
        energies.add_hessian_product(x, x, Convexity::Clamp, &mut out);
    });
    let assembly = energies.assembly();
    let mut matrix = BlockMatrix::zeros(assembly.pattern().clone());
    let slots = count * N * N * size_of::<u32>();
    let blocks = 2 * size_of::<Mat3>() * matrix.pattern().block_count();
    limit::bench(
        &mut group,
        "Hessian into slots",
        bytes + slots + blocks,
        || {
            energies.add_hessian(&assembly, x, 1.0, Convexity::Clamp, &mut matrix);
        },
    );
}

fn energies(criterion: &mut Criterion) {
    for side in SIDES {
        let sheet = &Sheet::new(side);
        let at = (side, &sheet.x[..]);
        energy(criterion, "springs", at, sheet.springs());
        let limited = sheet.limited_springs();
        energy(criterion, "springs with slack", at, limited);
        energy(criterion, "StVK triangles", at, sheet.stvk());
        energy(criterion, "ARAP triangles", at, sheet.arap());
        energy(criterion, "area triangles", at, sheet.areas());
        let limited = sheet.limited_triangles();
        energy(criterion, "triangles with slack", at, limited);
        let hinges = sheet.quadratic_hinges();
        energy(criterion, "quadratic hinges", at, hinges);
        energy(criterion, "curved hinges", at, sheet.curved_hinges());
        energy(criterion, "dihedral hinges", at, sheet.dihedral_hinges());
        energy(criterion, "cubic shells", at, sheet.cubic_shells());
        energy(criterion, "tetrahedra", at, sheet.tetrahedra());
        energy(criterion, "attachments", at, sheet.attachments());
        let (hinges, middles) = sheet.midpoint_hinges();
        energy(criterion, "midpoint hinges", (side, &middles), hinges);
    }
}

/// One coloured sweep on one thread.
fn constraint<const N: usize, E: Constraint<N>>(
    criterion: &mut Criterion,
    name: &str,
    (side, start): (usize, &[Vec3]),
    elements: &[E],
) {
    let count = start.len();
    let w = vec![5.0 * count as Real; count];
    let mut x = start.to_vec();
    let bytes = sweep_bytes(elements, &w);
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    let mut families = coloured(count, elements);
    families.prepare(&Compliant, &w, &x);
    let mut group = criterion.benchmark_group(format!("sweep over {name}, {side} a side"));
    group.throughput(Throughput::Elements(elements.len() as u64));
    limit::bench_in(&pool, &mut group, "coloured", bytes, || {
        families.sweep(&Compliant, &w, &mut x);
    });
}

fn constraints(criterion: &mut Criterion) {
    for side in SIDES {
        let sheet = &Sheet::new(side);
        let at = (side, &sheet.x[..]);
        constraint(criterion, "springs", at, &sheet.springs());
        let limited = sheet.limited_springs();
        constraint(criterion, "springs with slack", at, &limited);
        constraint(criterion, "StVK triangles", at, &sheet.stvk());
        constraint(criterion, "ARAP triangles", at, &sheet.arap());
        constraint(criterion, "area triangles", at, &sheet.areas());
        let limited = sheet.limited_triangles();
        constraint(criterion, "triangles with slack", at, &limited);
        let hinges = sheet.quadratic_hinges();
        constraint(criterion, "quadratic hinges", at, &hinges);
        let hinges = sheet.curved_hinges();
        constraint(criterion, "curved hinges", at, &hinges);
        let hinges = sheet.dihedral_hinges();
        constraint(criterion, "dihedral hinges", at, &hinges);
        constraint(criterion, "tetrahedra", at, &sheet.tetrahedra());
        constraint(criterion, "attachments", at, &sheet.attachments());
        let (hinges, middles) = sheet.midpoint_hinges();
        constraint(criterion, "midpoint hinges", (side, &middles), &hinges);
    }
}

fn projection<const N: usize, const K: usize, E: Projective<N, K>>(
    criterion: &mut Criterion,
    name: &str,
    (side, x): (usize, &[Vec3]),
    elements: Vec<E>,
) {
    let particles = Particles::new(vec![1.0; x.len()]).expect("masses");
    let bytes = size_of_val(&elements[..]) + 3 * vectors(x);
    let mut group = criterion.benchmark_group(format!("local step of {name}, {side} a side"));
    group.throughput(Throughput::Elements(elements.len() as u64));
    let mut out = vec![Vec3::zeros(); x.len()];
    let mut local = LocalStep::new(&particles, elements).expect("elements of the sheet");
    limit::bench(&mut group, "project and sum", bytes, || {
        local.add_gradient(x, &mut out)
    });
}

fn projections(criterion: &mut Criterion) {
    for side in SIDES {
        let sheet = &Sheet::new(side);
        let at = (side, &sheet.x[..]);
        projection(criterion, "springs", at, sheet.springs());
        let limited = sheet.limited_springs();
        projection(criterion, "springs with slack", at, limited);
        projection(criterion, "ARAP triangles", at, sheet.arap());
        let limited = sheet.limited_triangles();
        projection(criterion, "triangles with slack", at, limited);
        let hinges = sheet.curved_hinges();
        projection(criterion, "curved hinges", at, hinges);
        let (hinges, middles) = sheet.midpoint_hinges();
        projection(criterion, "midpoint hinges", (side, &middles), hinges);
    }
}

fn main() {
    limit::main(&[energies, constraints, projections]);
}
