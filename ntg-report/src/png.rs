//! SVG as pixels, by resvg.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

/// Renders an SVG picture as PNG, `scale` pixels for one unit, with the fonts of the system.
///
/// # Errors
/// In words: a system without fonts, or a picture too large.
pub fn png(svg: &str, scale: f32) -> Result<Vec<u8>, String> {
    let mut options = Options::default();
    options.fontdb_mut().load_system_fonts();
    let Some(sans) = a_sans_serif(&options) else {
        return Err("this system has no fonts, so a PNG would have no words: install one (Debian: fonts-dejavu-core) \
                    or write SVG"
            .to_owned());
    };
    options.fontdb_mut().set_sans_serif_family(sans);
    let tree = Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    let size = tree.size().to_int_size().scale_by(scale).ok_or("the picture has no size")?;
    let mut pixels = Pixmap::new(size.width(), size.height()).ok_or("the picture is too large")?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| error.to_string())
}

/// The best known sans-serif face that the system has, or any face.
fn a_sans_serif(options: &Options<'_>) -> Option<String> {
    let known = ["DejaVu Sans", "Liberation Sans", "Noto Sans", "Arial", "Helvetica"];
    let families = || options.fontdb.faces().filter_map(|face| face.families.first().map(|(name, _)| name.clone()));
    known.iter().find_map(|wanted| families().find(|name| name == wanted)).or_else(|| families().next())
}
