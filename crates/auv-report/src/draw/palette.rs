//! Colours that people with any colour vision can distinguish (Okabe and Ito 2008).

/// A colour as SVG writes it.
pub type Colour = &'static str;

/// A dark grey for lines and texts.
pub const BLACK: Colour = "#1a1a1a";
/// Grey.
pub const GREY: Colour = "#6b6b6b";
/// Orange.
pub const ORANGE: Colour = "#E69F00";
/// Sky blue.
pub const SKY: Colour = "#56B4E9";
/// Bluish green.
pub const GREEN: Colour = "#009E73";
/// Blue.
pub const BLUE: Colour = "#0072B2";
/// Vermillion.
pub const VERMILLION: Colour = "#D55E00";
/// Reddish purple.
pub const PURPLE: Colour = "#CC79A7";

/// Colours of series, in order of contrast on white.
pub const SERIES: [Colour; 7] = [BLUE, VERMILLION, GREEN, ORANGE, PURPLE, SKY, BLACK];
