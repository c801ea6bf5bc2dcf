//! Plots as PNG, for slides and papers that take no SVG.
//!
//! The drawing is the same SVG, rasterised by resvg. That brings some forty crates in, so it is a feature of this
//! crate, `plots-as-png`, and not there unless asked for.

use crate::error::BenchError;

/// Rasterises plots.
#[derive(Debug)]
pub struct Rasterizer {
    #[cfg(feature = "plots-as-png")]
    options: resvg::usvg::Options<'static>,
}

#[cfg(not(feature = "plots-as-png"))]
impl Rasterizer {
    /// Says that the program was built without it.
    ///
    /// # Errors
    /// [`BenchError::Usage`], always.
    pub fn new() -> Result<Self, BenchError> {
        Err(BenchError::Usage(
            "this program was built without plots as PNG; build it with `--features plots-as-png`"
                .into(),
        ))
    }

    /// Never called: there is no rasteriser.
    ///
    /// # Errors
    /// None.
    pub fn png(&self, _: &str) -> Result<Vec<u8>, BenchError> {
        Ok(Vec::new())
    }
}

#[cfg(feature = "plots-as-png")]
impl Rasterizer {
    /// Pixels for one of the SVG's.
    const SCALE: f32 = 2.0;

    /// With the fonts of the system.
    ///
    /// # Errors
    /// [`BenchError::Usage`] if the system has no font.
    pub fn new() -> Result<Self, BenchError> {
        let mut options = resvg::usvg::Options::default();
        let fonts = options.fontdb_mut();
        fonts.load_system_fonts();
        // What `sans-serif` means is not said in the fonts: the first that is meant to be read on a screen, or any
        // upright one.
        let families = [
            "DejaVu Sans",
            "Liberation Sans",
            "Noto Sans",
            "Arial",
            "Helvetica",
        ];
        let has = |family: &str| {
            let mut names = fonts.faces().flat_map(|face| &face.families);
            names.any(|(name, _)| name == family)
        };
        let family = families.into_iter().find(|family| has(family));
        let any = || {
            let first = fonts.faces().find_map(|face| face.families.first());
            first.map(|(name, _)| name.clone())
        };
        let Some(family) = family.map(str::to_owned).or_else(any) else {
            return Err(BenchError::Usage(
                "plots as PNG need a font for their words, and this system has none; install one (such as DejaVu or Liberation) or take the SVG".into(),
            ));
        };
        fonts.set_sans_serif_family(family);
        Ok(Self { options })
    }

    /// The drawing as a PNG file, on white, two pixels for one.
    ///
    /// # Errors
    /// [`BenchError::Failed`] if the drawing is not SVG or too large.
    pub fn png(&self, svg: &str) -> Result<Vec<u8>, BenchError> {
        use resvg::tiny_skia::{Color, Pixmap, Transform};
        let tree = resvg::usvg::Tree::from_str(svg, &self.options)?;
        let size = tree.size().to_int_size().scale_by(Self::SCALE);
        let canvas = size.and_then(|size| Pixmap::new(size.width(), size.height()));
        let mut canvas =
            canvas.ok_or_else(|| BenchError::Failed("a plot has no size as PNG".into()))?;
        canvas.fill(Color::WHITE);
        let scale = Transform::from_scale(Self::SCALE, Self::SCALE);
        resvg::render(&tree, scale, &mut canvas.as_mut());
        canvas.encode_png().map_err(BenchError::failed)
    }
}

#[cfg(all(test, feature = "plots-as-png"))]
mod tests {
    use super::*;
    use crate::report::plot::{Axis, Plot, Series};

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
        let (with, width) = pixels(&plot("A title", curve()));
        let (other, _) = pixels(&plot("Another one", curve()));
        assert!(width > 1000);
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
}
