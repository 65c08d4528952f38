//! Pictures as PNG.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{FontResolver, Group, Node, Options, Tree};

/// Most pixels of a picture: 100 million, 400 MB while it is drawn.
const MOST_PIXELS: f64 = 1e8;

/// Why a picture was not drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// None of the bytes given is a font, so texts cannot be drawn.
    #[error("no font was given that can be read: give the bytes of a TrueType or OpenType font")]
    NoFont,
    /// No font given has a character of a text.
    #[error("no font given has a sign for `{0}`: give one that has")]
    NoGlyph(String),
    /// The text is not SVG.
    #[error("not an SVG: {0}")]
    Svg(String),
    /// The picture has no size, or too large a one.
    #[error("{width} by {height} pixels at scale {scale}: give a scale that makes 1 to 1e8 pixels")]
    Size {
        /// Width of the SVG, pixels.
        width: f64,
        /// Height of the SVG, pixels.
        height: f64,
        /// The scale asked for.
        scale: f64,
    },
    /// The PNG could not be written.
    #[error("PNG could not be written: {0}")]
    Png(String),
}

/// A picture of this crate as PNG, `scale` pixels for each of the SVG's.
///
/// Texts are written in `fonts` (the bytes of font files; bold texts in a bold face where there is
/// one), whatever family the SVG names. No file is opened. Pictures are laid out for DejaVu Sans and
/// narrower fonts (Helvetica, Arial, Liberation Sans). Equal input gives equal bytes.
///
/// # Errors
/// No usable font, a character that no font has, a text that is not SVG, a picture too large.
pub fn svg_png(svg: &str, fonts: &[Vec<u8>], scale: f64) -> Result<Vec<u8>, PngError> {
    let mut options = Options {
        font_resolver: FontResolver {
            select_font: Box::new(|font, faces| {
                let far = |weight: u16| weight.abs_diff(font.weight());
                let nearest = faces.faces().min_by_key(|face| far(face.weight.0));
                nearest.map(|face| face.id)
            }),
            ..FontResolver::default()
        },
        ..Options::default()
    };
    for font in fonts {
        options.fontdb_mut().load_font_data(font.clone());
    }
    if options.fontdb_mut().is_empty() {
        return Err(PngError::NoFont);
    }
    let tree = Tree::from_str(svg, &options).map_err(|error| PngError::Svg(error.to_string()))?;
    if let Some(text) = unwritten(tree.root()) {
        return Err(PngError::NoGlyph(text));
    }
    let (width, height) = (
        f64::from(tree.size().width()),
        f64::from(tree.size().height()),
    );
    let size = PngError::Size {
        width,
        height,
        scale,
    };
    let pixels = [width, height].map(|length| (length * scale).ceil());
    // In this form the condition also refuses a scale of NaN.
    if !(pixels.iter().all(|&length| length >= 1.0) && pixels[0] * pixels[1] <= MOST_PIXELS) {
        return Err(size);
    }
    let mut pixmap = Pixmap::new(pixels[0] as u32, pixels[1] as u32).ok_or(size)?;
    let transform = Transform::from_scale(scale as f32, scale as f32);
    resvg::render(&tree, transform, &mut pixmap.as_mut());
    pixmap
        .encode_png()
        .map_err(|error| PngError::Png(error.to_string()))
}

/// The first text that no font could write.
fn unwritten(group: &Group) -> Option<String> {
    group.children().iter().find_map(|node| match node {
        Node::Group(group) => unwritten(group),
        Node::Text(text) => {
            let spans = text.layouted().iter();
            let mut glyphs = spans.flat_map(|span| &span.positioned_glyphs);
            let missing = glyphs.find(|glyph| glyph.id.0 == 0);
            missing.map(|glyph| glyph.text.clone())
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Figure;

    #[test]
    fn without_a_font_there_is_no_picture() {
        let svg = Figure::new("title", "").to_svg();
        assert_eq!(svg_png(&svg, &[], 1.0), Err(PngError::NoFont));
        assert_eq!(
            svg_png(&svg, &[b"no font".to_vec()], 1.0),
            Err(PngError::NoFont)
        );
    }
}
