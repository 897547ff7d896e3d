//! Pictures for the examples: SVG files that explain themselves.
//!
//! Every picture has a title in words, a sentence that says what to see, axes with units, and a
//! legend. Colours are Okabe and Ito's, which colour-blind eyes can tell apart; lines differ in
//! their dashes too. Text stays text in SVG, so no font files are needed. Lengths are in pixels of
//! a picture 1600 wide: the library rounds to whole pixels, and at this size that does not show.

pub(crate) mod chart;
pub(crate) mod fleet;
pub(crate) mod flight;
pub(crate) mod growth;
pub(crate) mod heat;
pub(crate) mod history;
pub(crate) mod minima;
pub(crate) mod missile;
pub(crate) mod paper;
pub(crate) mod phases;
pub(crate) mod radar;
pub(crate) mod track;

use std::error::Error;
use std::fs;
use std::path::Path;

use plotters::coord::Shift;
pub(crate) use plotters::prelude::RGBColor;
use plotters::prelude::*;

/// What drawing may end in: a file that cannot be written.
pub(crate) type Drawn<T = ()> = Result<T, Box<dyn Error>>;

/// A rectangle of a picture to draw in.
pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

pub(crate) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const VERMILION: RGBColor = RGBColor(213, 94, 0);
pub(crate) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(crate) const PURPLE: RGBColor = RGBColor(170, 68, 153);
pub(crate) const INK: RGBColor = RGBColor(30, 30, 30);
pub(crate) const GREY: RGBColor = RGBColor(110, 110, 110);

/// Starts a picture: white, with its title and the sentence beneath it.
/// Gives the area that is left.
pub(crate) fn picture<'a>(path: &'a Path, height: u32, title: &str, sentence: &str) -> Drawn<Area<'a>> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let root = SVGBackend::new(path, (1600, height)).into_drawing_area();
    root.fill(&WHITE)?;
    root.draw(&Text::new(title.to_owned(), (40, 30), text(46).style(FontStyle::Bold).color(&INK)))?;
    root.draw(&Text::new(sentence.to_owned(), (40, 88), text(30).color(&GREY)))?;
    Ok(root.split_vertically(132).1)
}

/// The one typeface of all pictures, `size` high.
pub(crate) fn text(size: u32) -> FontDesc<'static> {
    ("sans-serif", size).into_font()
}
