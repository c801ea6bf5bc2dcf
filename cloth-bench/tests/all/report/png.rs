//! Plots as PNG.

use cloth_bench::report::plot::{Axis, Plot, Series};
use cloth_bench::report::png::Rasterizer;

/// Pixels of a plot as bytes of red, green and blue, and the width.
fn pixels(plot: &Plot) -> (Vec<[u8; 3]>, usize) {
    let png = Rasterizer::new().unwrap().png(&plot.draw().svg).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(png))
        .read_info()
        .unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let channels = info.color_type.samples();
    let pixels = bytes[..info.buffer_size()].chunks(channels);
    (
        pixels.map(|p| [p[0], p[1], p[2]]).collect(),
        info.width as usize,
    )
}

fn plot(title: &str, series: Vec<Series>) -> Plot {
    Plot {
        title: title.into(),
        x: Axis::linear("x (m)"),
        y: Axis::linear("y (m)"),
        series,
        note: String::new(),
    }
}

#[test]
fn curves_and_words_are_on_the_picture() {
    let curve = || {
        vec![Series::new(
            "curve",
            (0..50).map(|i| (f64::from(i), f64::from(i))).collect(),
        )]
    };
    let titled = plot("A title", curve());
    let (with, width) = pixels(&titled);
    let (other, _) = pixels(&plot("Another one", curve()));
    let half = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\"",
        width / 2
    );
    assert!(titled.draw().svg.starts_with(&half), "{width} pixels");
    let coloured = |p: &&[u8; 3]| p.iter().max().unwrap() - p.iter().min().unwrap() > 60;
    assert!(with.iter().filter(coloured).count() > 1000, "the curve");
    // Only the words differ, and only where the title is.
    let differ = with.iter().zip(&other).filter(|(a, b)| a != b).count();
    assert!(differ > 200, "the title: {differ} pixels");
    assert_eq!(with[0], [255; 3], "on white");
}

#[test]
fn what_is_not_svg_is_refused() {
    assert!(Rasterizer::new().unwrap().png("<p>").is_err());
}
