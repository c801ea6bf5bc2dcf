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
    pub fn new() -> Result<Self, BenchError> {
        Err(BenchError::Usage(
            "this program was built without plots as PNG; build it with `--features plots-as-png`"
                .into(),
        ))
    }

    /// Never called: there is no rasteriser.
    pub fn png(&self, _: &str) -> Result<Vec<u8>, BenchError> {
        Ok(Vec::new())
    }
}

#[cfg(feature = "plots-as-png")]
impl Rasterizer {
    /// Pixels for one of the SVG's.
    const SCALE: f32 = 2.0;

    /// With the fonts of the system.
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
