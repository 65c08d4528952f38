//! Units of measurement as files write them.

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// In metres.
    Length,
    /// In metres per second.
    Speed,
    /// In degrees.
    Angle,
}

/// The factor from a unit to the unit of its quantity; `None` for a unit that is not known or measures
/// something else. Case, plural and the ways to write a quotient do not matter; a number before the unit
/// is a factor (`0.01 m s-1`).
pub(crate) fn factor(text: &str, quantity: Quantity) -> Option<f64> {
    let text = text.trim().to_ascii_lowercase();
    let (number, text) = match text.split_once(' ') {
        Some((number, rest)) if number.parse::<f64>().is_ok() => {
            (number.parse().ok()?, rest.trim().to_owned())
        }
        _ => (1.0, text),
    };
    let factor = match quantity {
        Quantity::Length => length(&text),
        Quantity::Speed => speed(&text),
        Quantity::Angle => angle(&text),
    }?;
    let factor: f64 = number * factor;
    (factor.is_finite() && factor > 0.0).then_some(factor)
}

fn length(text: &str) -> Option<f64> {
    Some(match text.trim_end_matches('.') {
        "m" | "metre" | "metres" | "meter" | "meters" => 1.0,
        "km" | "kilometre" | "kilometres" | "kilometer" | "kilometers" => 1_000.0,
        "dm" | "decimetre" | "decimetres" | "decimeter" | "decimeters" => 0.1,
        "cm" | "centimetre" | "centimetres" | "centimeter" | "centimeters" => 0.01,
        "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => 0.001,
        "ft" | "foot" | "feet" | "international_foot" | "international_feet" => 0.3048,
        "us_survey_foot" | "us_survey_feet" | "survey_foot" | "survey_feet" | "us-ft" | "ftus" => {
            1_200.0 / 3_937.0
        }
        "fathom" | "fathoms" | "fm" | "fms" | "ftm" => 1.8288,
        "yard" | "yards" | "yd" => 0.9144,
        "nautical_mile" | "nautical_miles" | "nmi" => 1_852.0,
        _ => return None,
    })
}

fn time(text: &str) -> Option<f64> {
    Some(match text {
        "s" | "sec" | "secs" | "second" | "seconds" => 1.0,
        "min" | "mins" | "minute" | "minutes" => 60.0,
        "h" | "hr" | "hrs" | "hour" | "hours" => 3_600.0,
        "d" | "day" | "days" => 86_400.0,
        _ => return None,
    })
}

fn speed(text: &str) -> Option<f64> {
    match text {
        "kn" | "kt" | "kts" | "knot" | "knots" | "knot_international" | "international_knot" => {
            return Some(1_852.0 / 3_600.0);
        }
        "mps" => return Some(1.0),
        "cmps" => return Some(0.01),
        _ => {}
    }
    // `m/s`, `m per s`, `m s-1`, `m.s^-1`, `m s**-1`, `ms-1`.
    let spaced = text
        .replace(" per ", "/")
        .replace("**", "")
        .replace('^', "");
    if let Some((above, below)) = spaced.split_once('/') {
        return Some(length(above.trim())? / time(below.trim())?);
    }
    let product = spaced
        .strip_suffix("-1")
        .or_else(|| spaced.strip_suffix("(-1)"))?
        .trim_end();
    match product.rsplit_once([' ', '.', '*', '_']) {
        Some((above, below)) => Some(length(above.trim())? / time(below.trim())?),
        None => Some(length(product.strip_suffix('s')?)?),
    }
}

fn angle(text: &str) -> Option<f64> {
    Some(match text {
        "degree" | "degrees" | "deg" | "degs" | "°" => 1.0,
        "radian" | "radians" | "rad" | "rads" => 180.0 / std::f64::consts::PI,
        _ if is_north(text) || is_east(text) => 1.0,
        _ => return None,
    })
}

/// Whether a factor changes nothing.
pub(crate) fn is_one(factor: f64) -> bool {
    factor.total_cmp(&1.0).is_eq()
}

/// Whether a unit is degrees north, in any spelling of the CF conventions.
pub(crate) fn is_north(text: &str) -> bool {
    let text = text.trim().to_ascii_lowercase();
    [
        "degrees_north",
        "degree_north",
        "degree_n",
        "degrees_n",
        "degreen",
        "degreesn",
        "°n",
        "° n",
    ]
    .contains(&text.as_str())
}

/// Whether a unit is degrees east.
pub(crate) fn is_east(text: &str) -> bool {
    let text = text.trim().to_ascii_lowercase();
    [
        "degrees_east",
        "degree_east",
        "degree_e",
        "degrees_e",
        "degreee",
        "degreese",
        "°e",
        "° e",
    ]
    .contains(&text.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_in_use_are_known() {
        for (text, quantity, expected) in [
            ("m", Quantity::Length, 1.0),
            ("Meters", Quantity::Length, 1.0),
            ("feet", Quantity::Length, 0.3048),
            ("US_survey_foot", Quantity::Length, 0.304_800_609_601_219_2),
            ("fathoms", Quantity::Length, 1.8288),
            ("10 m", Quantity::Length, 10.0),
            ("meter second-1", Quantity::Speed, 1.0),
            ("m s-1", Quantity::Speed, 1.0),
            ("m/s", Quantity::Speed, 1.0),
            ("m.s-1", Quantity::Speed, 1.0),
            ("m s^-1", Quantity::Speed, 1.0),
            ("m s**-1", Quantity::Speed, 1.0),
            ("ms-1", Quantity::Speed, 1.0),
            ("metres per second", Quantity::Speed, 1.0),
            ("centimeter second-1", Quantity::Speed, 0.01),
            ("cm/s", Quantity::Speed, 0.01),
            ("0.01 m s-1", Quantity::Speed, 0.01),
            ("mm/s", Quantity::Speed, 0.001),
            ("km/h", Quantity::Speed, 1.0 / 3.6),
            ("knots", Quantity::Speed, 1_852.0 / 3_600.0),
            ("degree", Quantity::Angle, 1.0),
            ("radians", Quantity::Angle, 57.295_779_513_082_32),
        ] {
            let found = factor(text, quantity).unwrap();
            assert!((found / expected - 1.0).abs() < 1e-12, "{text} {found}");
        }
        for (text, quantity) in [
            ("parsec", Quantity::Length),
            ("m", Quantity::Speed),
            ("m s-1", Quantity::Length),
            ("dbar", Quantity::Length),
            ("m2 s-1", Quantity::Speed),
            ("s-1", Quantity::Speed),
            ("", Quantity::Length),
            ("gon", Quantity::Angle),
            ("-1 m", Quantity::Length),
        ] {
            assert_eq!(factor(text, quantity), None, "{text}");
        }
    }
}
