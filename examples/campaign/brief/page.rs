//! The page of a brief: plain HTML with its pictures in it.

use super::answer::{Brief, Share};
use super::flights::Variation;
use auv_report::{Axis, Chart, Figure, Mark, PointShape, Style, palette};
use std::fmt::Write;

/// Bars of the histogram.
const BARS: usize = 20;

const HEAD: &str = r#"<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body { font: 16px/1.45 sans-serif; color: #111; background: #fff; max-width: 52em; margin: 1.5em auto; padding: 0 1em; overflow-wrap: anywhere }
h1 { font-size: 1.5em; margin: 0 0 .2em } h2 { font-size: 1.1em; margin: 1.6em 0 .4em }
table { border-collapse: collapse; width: 100% } th, td { text-align: left; vertical-align: top; padding: .25em .8em .25em 0; border-bottom: 1px solid #ddd }
td.n, th.n { text-align: right; white-space: nowrap }
.bar { background: #0072b2; height: .7em; min-width: 1px } .bars { width: 35%; min-width: 5em }
svg { max-width: 100%; height: auto } code { font-size: .9em } .big { font-size: 1.25em; margin: 0 }
@media print { body { margin: 0; max-width: none; font-size: 12px } section { break-inside: avoid } }
</style>
"#;

/// The page.
pub(super) fn html(brief: &Brief) -> String {
    let name = escaped(&brief.name);
    let mut page = format!("{HEAD}<title>{name}: brief</title></head><body>\n");
    let _ = write!(
        page,
        "<h1>{name}</h1>\n<p class=\"big\">Home in time: {}</p>\n<p>{} missions flown as planned. Intervals are of 95 % (Clopper and Pearson).</p>\n",
        brief.home.words(),
        brief.missions
    );
    numbers(&mut page, brief);
    section(
        &mut page,
        "Time left of the budget at the end",
        &histogram(brief),
    );
    tasks(&mut page, brief);
    changes(&mut page, brief);
    section(&mut page, "Launch", &launches(brief));
    worst(&mut page, brief);
    page.push_str("</body></html>\n");
    page
}

fn section(page: &mut String, title: &str, body: &str) {
    let _ = write!(page, "<section><h2>{title}</h2>\n{body}</section>\n");
}

fn numbers(page: &mut String, brief: &Brief) {
    let metres = |x: f64| {
        if x.is_finite() {
            format!("{x:.1} m")
        } else {
            "none met".into()
        }
    };
    let seconds = |share| {
        brief
            .margin_s(share)
            .map_or("none".into(), |s| format!("{s:.0} s"))
    };
    let margins = [
        ("least", 0.0),
        ("5 %", 0.05),
        ("median", 0.5),
        ("95 %", 0.95),
    ];
    let margins = margins.map(|(what, share)| format!("{what} {}", seconds(share)));
    let rows = [
        ("Reserve touched", brief.reserve_touched.words()),
        ("Time left at the end", margins.join(", ")),
        ("Least true clearance", metres(brief.clearance_m)),
        ("Least altitude", metres(brief.altitude_m)),
    ];
    page.push_str("<table>\n");
    for (what, told) in rows {
        let _ = writeln!(page, "<tr><th>{what}</th><td>{told}</td></tr>");
    }
    page.push_str("</table>\n");
}

fn histogram(brief: &Brief) -> String {
    let (Some(least_s), Some(most_s)) = (brief.margin_s(0.0), brief.margin_s(1.0)) else {
        return "<p>Every mission was given up.</p>".into();
    };
    let low_s = least_s.min(0.0);
    let width_s = ((most_s.max(brief.reserve_s) - low_s) / BARS as f64).max(1.0);
    let mut counts = [0_usize; BARS];
    for margin_s in &brief.margins_s {
        let bar = ((margin_s - low_s) / width_s) as usize;
        counts[bar.min(BARS - 1)] += 1;
    }
    let tallest = counts.iter().copied().max().unwrap_or(1) as f64;
    let x =
        Axis::new("left of the budget at the end (s)").range(low_s, low_s + width_s * BARS as f64);
    let mut chart = Chart::new(
        "",
        x,
        Axis::new("missions").range(0.0, 1.1 * tallest),
        190.0,
    );
    for (i, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        chart.add(Mark::Bar {
            at: low_s + (i as f64 + 0.5) * width_s,
            half_width: 0.46 * width_s,
            value: count as f64,
            style: Style::fill(palette::BLUE, 0.85),
            legend: String::new(),
        });
    }
    for (at_s, colour, legend) in [
        (brief.reserve_s, palette::ORANGE, "reserve begins"),
        (0.0, palette::VERMILLION, "budget ends"),
    ] {
        let line = vec![(at_s, 0.0), (at_s, 1.1 * tallest)];
        chart.add(Mark::line(line, Style::line(colour, 2.0), legend));
    }
    picture(chart)
}

fn launches(brief: &Brief) -> String {
    let minutes = |later_s: f64| later_s / 60.0;
    let x = Axis::new("launch, later than planned (min)").range(-65.0, 65.0);
    let mut chart = Chart::new(
        "",
        x,
        Axis::new("home in time (%)").range(0.0, 105.0),
        190.0,
    );
    let points = brief
        .launches
        .iter()
        .map(|(later_s, home)| (minutes(*later_s), 100.0 * home.p));
    for (later_s, home) in &brief.launches {
        let at = minutes(*later_s);
        let line = vec![(at, 100.0 * home.low), (at, 100.0 * home.high)];
        chart.add(Mark::line(
            line,
            Style::line(palette::BLUE, 1.4).faint(0.5),
            "",
        ));
    }
    chart.add(Mark::Points {
        points: points.collect(),
        shape: PointShape::Disc,
        size: 4.0,
        style: Style::fill(palette::BLUE, 1.0),
        legend: "share, with its 95 % interval".into(),
    });
    picture(chart)
}

fn picture(chart: Chart) -> String {
    let mut figure = Figure::new("", "");
    figure.charts.push(chart);
    figure.to_svg()
}

fn tasks(page: &mut String, brief: &Brief) {
    if brief.tasks.is_empty() {
        return;
    }
    let mut body = String::from("<table>\n");
    for (name, p) in &brief.tasks {
        let percent = 100.0 * p;
        let _ = writeln!(
            body,
            "<tr><td>{}</td><td class=\"n\">{percent:.0} %</td><td class=\"bars\"><div class=\"bar\" style=\"width:{percent:.1}%\"></div></td></tr>",
            escaped(name)
        );
    }
    body.push_str("</table>\n");
    section(page, "How often each task is done", &body);
}

fn changes(page: &mut String, brief: &Brief) {
    let mut body = String::from(
        "<table>\n<tr><th></th><th>home in time</th><th>tasks mostly done as planned and rarely then</th></tr>\n",
    );
    let mut row = |variation: Variation, home: Share, lost: &str| {
        let words = variation.words();
        let home = home.words();
        let _ = writeln!(
            body,
            "<tr><td>{words}</td><td>{home}</td><td>{}</td></tr>",
            escaped(lost)
        );
    };
    row(Variation::AsPlanned, brief.home, "");
    for change in &brief.what_if {
        row(change.variation, change.home, &change.lost_words());
    }
    body.push_str("</table>\n");
    section(page, "What if", &body);
}

fn worst(page: &mut String, brief: &Brief) {
    let mut body = String::new();
    for bad in &brief.worst {
        let _ = writeln!(
            body,
            "<p>Seed {}, {}: {}.<br><code>{}</code></p>",
            bad.seed,
            bad.outcome,
            escaped(&bad.why),
            escaped(&bad.command)
        );
    }
    section(page, "The worst missions", &body);
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
