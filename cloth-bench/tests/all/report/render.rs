//! Pictures of surfaces.

use cloth_bench::report::render::camera::Camera;
use cloth_bench::report::render::{Projection, RenderError, Surface, View, render};
use cloth_core::math::Vec3;

/// A sphere of the given radius (m) around `centre`, as a grid of longitudes and latitudes.
fn sphere(radius: f64, centre: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (around, along) = (128, 64);
    let mut positions = Vec::new();
    for j in 0..=along {
        for i in 0..around {
            let polar = std::f64::consts::PI * f64::from(j) / f64::from(along);
            let azimuth = std::f64::consts::TAU * f64::from(i) / f64::from(around);
            let (s, c) = polar.sin_cos();
            positions.push(centre + radius * Vec3::new(s * azimuth.cos(), s * azimuth.sin(), c));
        }
    }
    let at = |i: u32, j: u32| j * around + i % around;
    let mut triangles = Vec::new();
    for j in 0..along {
        for i in 0..around {
            triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    (positions, triangles)
}

fn view() -> View {
    View {
        width: 200,
        height: 160,
        direction: Vec3::y(),
        projection: Projection::Orthographic,
        background: None,
        light: Vec3::new(0.0, 1.0, 1.0),
        ..View::default()
    }
}

fn decode(file: &[u8]) -> (usize, Vec<[u8; 4]>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file))
        .read_info()
        .unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let (pixels, rest) = bytes.as_chunks::<4>();
    assert!(rest.is_empty());
    (info.width as usize, pixels.to_vec())
}

fn covered(pixels: &[[u8; 4]]) -> f64 {
    pixels.iter().map(|p| f64::from(p[3]) / 255.0).sum()
}

#[test]
fn a_sphere_covers_a_disk() {
    let (positions, triangles) = sphere(2.0, Vec3::new(5.0, -3.0, 1.0));
    let (_, pixels) = decode(&render(&[Surface::cloth(&positions, &triangles)], &view()).unwrap());
    let radius = 0.88 * 80.0;
    let expected = std::f64::consts::PI * radius * radius;
    let area = covered(&pixels);
    assert!(
        (area / expected - 1.0).abs() < 0.01,
        "{area} instead of {expected}"
    );
}

#[test]
fn perspective_frames_everything_and_makes_near_things_larger() {
    let (positions, triangles) = sphere(1.0, Vec3::zeros());
    let perspective = View {
        projection: Projection::Perspective { angle: 0.9 },
        ..view()
    };
    let (width, pixels) =
        decode(&render(&[Surface::cloth(&positions, &triangles)], &perspective).unwrap());
    let border = |i: usize| {
        i.is_multiple_of(width) || i % width == width - 1 || i < width || i >= pixels.len() - width
    };
    assert!(
        pixels
            .iter()
            .enumerate()
            .all(|(i, p)| !border(i) || p[3] == 0)
    );
    assert!(covered(&pixels) > 0.8 * std::f64::consts::PI * (0.88_f64 * 80.0).powi(2));
    let camera = Camera::framing(&[Surface::cloth(&positions, &triangles)], &perspective).unwrap();
    let height = |y: f64| {
        let ends = [0.5, -0.5].map(|z| camera.project(&Vec3::new(0.0, y, z)).unwrap()[1]);
        ends[1] - ends[0]
    };
    assert!(height(-0.5) > 1.1 * height(0.5));
}

#[test]
fn light_from_above_shades_left_and_right_alike() {
    let (positions, triangles) = sphere(1.0, Vec3::zeros());
    let (width, pixels) =
        decode(&render(&[Surface::cloth(&positions, &triangles)], &view()).unwrap());
    let rows: Vec<_> = pixels.chunks(width).collect();
    for row in &rows {
        for x in 0..width / 2 {
            let (left, right) = (row[x], row[width - 1 - x]);
            let inside = left[3] == 255 && right[3] == 255;
            assert!(
                !inside || (0..3).all(|i| left[i].abs_diff(right[i]) <= 2),
                "{left:?} {right:?}"
            );
        }
    }
    let brightness = |y: usize| rows[y][width / 2][1];
    assert!(brightness(40) > brightness(120) + 30);
}

#[test]
fn the_nearer_surface_hides_the_farther_and_each_side_has_its_colour() {
    let square = |y: f64| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, z)| Vec3::new(x, y, z))
    };
    let (near, far) = (square(-1.0), square(1.0));
    let triangles = [[0, 1, 2], [0, 2, 3]];
    let red = Surface {
        positions: &near,
        triangles: &triangles,
        front: [200, 0, 0],
        back: [0, 200, 0],
        has_edges: false,
    };
    let blue = Surface {
        positions: &far,
        front: [0, 0, 200],
        ..red
    };
    let middle = |surfaces: &[Surface<'_>], direction: Vec3| {
        let (width, pixels) = decode(
            &render(
                surfaces,
                &View {
                    direction,
                    ..view()
                },
            )
            .unwrap(),
        );
        pixels[80 * width + 95]
    };
    for order in [[red, blue], [blue, red]] {
        let seen = middle(&order, Vec3::y());
        assert!(seen[0] > 100 && seen[1] == 0 && seen[2] == 0, "{seen:?}");
    }
    let from_behind = middle(&[red], -Vec3::y());
    assert!(
        from_behind[1] > 100 && from_behind[0] == 0,
        "{from_behind:?}"
    );
}

#[test]
fn one_box_is_one_scale() {
    let spheres = [0.5, 1.0].map(|radius| sphere(radius, Vec3::zeros()));
    let view = View {
        bounds: Some([-1.0, 1.0].map(Vec3::repeat)),
        ..view()
    };
    let [small, large] = spheres.map(|(positions, triangles)| {
        let surface = Surface::cloth(&positions, &triangles);
        covered(&decode(&render(&[surface], &view).unwrap()).1)
    });
    assert!((large / small - 4.0).abs() < 0.06, "{small} {large}");
}

#[test]
fn wires_darken_edges_only() {
    let positions = [(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let surface = [Surface::cloth(&positions, &[[0, 1, 2]])];
    let pixels = |wire| decode(&render(&surface, &View { wire, ..view() }).unwrap()).1;
    let (plain, wired) = (pixels(0.0), pixels(1.0));
    let changed = plain.iter().zip(&wired).filter(|(a, b)| a != b).count() as f64;
    assert!(
        changed > 100.0 && changed < 0.15 * covered(&plain),
        "{changed}"
    );
}

#[test]
fn bad_input_is_an_error() {
    let positions = [Vec3::zeros(), Vec3::x(), Vec3::new(0.0, f64::NAN, 0.0)];
    let triangles = [[0, 1, 2]];
    let fails = |surfaces: &[Surface<'_>], view: &View| render(surfaces, view).unwrap_err();
    assert_eq!(
        fails(&[Surface::cloth(&positions, &triangles)], &view()),
        RenderError::NotFinite { vertex: 2 }
    );
    assert_eq!(fails(&[], &view()), RenderError::Empty);
    assert_eq!(
        fails(&[Surface::cloth(&positions, &[])], &view()),
        RenderError::Empty
    );
    let missing = RenderError::NoSuchVertex {
        triangle: 0,
        vertex: 2,
        vertex_count: 2,
    };
    assert_eq!(
        fails(&[Surface::cloth(&positions[..2], &triangles)], &view()),
        missing
    );
    let good = [Vec3::zeros(), Vec3::x(), Vec3::z()];
    let surface = [Surface::cloth(&good, &triangles)];
    for wrong in [
        View { width: 0, ..view() },
        View {
            direction: Vec3::z(),
            ..view()
        },
        View {
            projection: Projection::Perspective { angle: 4.0 },
            ..view()
        },
    ] {
        assert!(matches!(fails(&surface, &wrong), RenderError::View(_)));
    }
}

#[test]
fn degenerate_meshes_are_pictures() {
    for positions in [
        [Vec3::zeros(); 3],
        [Vec3::repeat(1e200), Vec3::x(), Vec3::z()],
        [Vec3::x(), Vec3::x() * 2.0, Vec3::x() * 3.0],
    ] {
        for projection in [
            Projection::Orthographic,
            Projection::Perspective { angle: 0.5 },
        ] {
            let _ = render(
                &[Surface::cloth(&positions, &[[0, 1, 2]])],
                &View {
                    projection,
                    ..view()
                },
            );
        }
    }
    let point = [Vec3::zeros(); 3];
    assert!(render(&[Surface::cloth(&point, &[[0, 1, 2]])], &view()).is_ok());
}
