//! Pictures as files.

use crate::{Arguments, Failure, Opt, write_file};
use std::path::Path;

/// Writes pictures: SVG, and PNG beside it where asked for.
#[derive(Clone, Debug)]
pub struct Pictures {
    /// Fonts for PNG; `None`: none asked for.
    fonts: Option<Vec<Vec<u8>>>,
}

impl Pictures {
    /// The option that asks for PNG.
    pub const PNG: Opt = Opt::flag(
        "png",
        "write a PNG twice the size beside each SVG (needs a build with --features png)",
    );

    /// What [`Self::PNG`] asks for.
    ///
    /// # Errors
    /// PNG asked of a build without it, or on a machine without fonts.
    pub fn asked(arguments: &Arguments) -> Result<Self, Failure> {
        let fonts = arguments.flag(Self::PNG.name).then(fonts).transpose()?;
        Ok(Self { fonts })
    }

    /// Writes a file, making the folders above it; of an SVG also the PNG, where asked for.
    ///
    /// # Errors
    /// A place that cannot be written to; a text that no font can write.
    pub fn write(&self, path: &Path, text: &str) -> Result<(), Failure> {
        write_file(path, text.as_bytes())?;
        let picture = path.extension().is_some_and(|extension| extension == "svg");
        match self.fonts.as_deref().filter(|_| picture) {
            Some(fonts) => write_png(&path.with_extension("png"), text, fonts),
            None => Ok(()),
        }
    }
}

#[cfg(not(feature = "png"))]
fn fonts() -> Result<Vec<Vec<u8>>, Failure> {
    let remedy = "this build draws no PNG: give cargo `--features png` before the `--`";
    Err(Failure::option(Pictures::PNG.name, remedy))
}

#[cfg(not(feature = "png"))]
fn write_png(_: &Path, _: &str, _: &[Vec<u8>]) -> Result<(), Failure> {
    Ok(())
}

/// The regular and the bold face of a sans-serif family of the system, those that pictures name first.
#[cfg(feature = "png")]
fn fonts() -> Result<Vec<Vec<u8>>, Failure> {
    use fontdb::{Database, Family, Query, Weight};
    let mut faces = Database::new();
    faces.load_system_fonts();
    let families = [
        Family::Name("Helvetica"),
        Family::Name("Arial"),
        Family::Name("Liberation Sans"),
        Family::Name("Nimbus Sans"),
        Family::Name("DejaVu Sans"),
        Family::Name("Noto Sans"),
        Family::SansSerif,
    ];
    let found = [Weight::NORMAL, Weight::BOLD].map(|weight| {
        let families = &families;
        faces.query(&Query {
            families,
            weight,
            ..Query::default()
        })
    });
    let any = faces
        .faces()
        .find(|face| !face.monospaced)
        .map(|face| face.id);
    let fonts: Vec<_> = found
        .into_iter()
        .filter_map(|id| faces.with_face_data(id.or(any)?, |bytes, _| bytes.to_vec()))
        .collect();
    if fonts.is_empty() {
        return Err(Failure::option(
            Pictures::PNG.name,
            "this machine has no font to write texts with: install one, by preference Liberation Sans",
        ));
    }
    Ok(fonts)
}

#[cfg(feature = "png")]
fn write_png(path: &Path, svg: &str, fonts: &[Vec<u8>]) -> Result<(), Failure> {
    let png = auv_report::svg_png(svg, fonts, 2.0)
        .map_err(|error| Failure::file(&path.display().to_string(), error))?;
    write_file(path, &png)
}

#[cfg(all(test, feature = "png"))]
#[allow(clippy::print_stdout, reason = "a skipped test should say so")]
mod tests {
    use super::*;
    use auv_report::{Axis, Chart, Figure, Mark, Style};

    #[test]
    fn a_picture_has_its_texts_and_lines_in_twice_the_size() {
        let Ok(fonts) = fonts() else {
            println!("skipped: this machine has no font");
            return;
        };
        let drawn = |title: &str, line: &[(f64, f64)]| {
            let mut chart = Chart::new("", Axis::new("x (m)"), Axis::new("y (m)"), 100.0);
            chart.x = chart.x.range(0.0, 1.0);
            chart.y = chart.y.range(0.0, 1.0);
            chart.add(Mark::line(line.to_vec(), Style::line("#000", 2.0), ""));
            let mut figure = Figure::new(title, "");
            figure.charts.push(chart);
            auv_report::svg_png(&figure.to_svg(), &fonts, 2.0).unwrap()
        };
        let png = drawn("title", &[(0.0, 0.0), (1.0, 1.0)]);
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        assert_eq!(png[16..20], 1600_u32.to_be_bytes());
        assert_eq!(png, drawn("title", &[(0.0, 0.0), (1.0, 1.0)]));
        assert_ne!(png, drawn("", &[(0.0, 0.0), (1.0, 1.0)]));
        assert_ne!(png, drawn("title", &[]));
    }
}

#[cfg(all(test, not(feature = "png")))]
mod tests {
    use super::*;

    #[test]
    fn a_build_without_png_says_how_to_get_one() {
        let refusal = fonts().unwrap_err();
        assert!(refusal.to_string().contains("--features png"), "{refusal}");
        assert_eq!(refusal.exit_code(), 2);
    }
}
