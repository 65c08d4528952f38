//! Table 2 as printed in the paper.

use auv_report::Table;

fn table(headings: &str, rows: &[&str]) -> Table {
    let mut table = Table::new(headings.split('|'));
    for row in rows {
        table.row(row.split('|'));
    }
    table
}

pub(crate) fn routes() -> Table {
    table(
        "call|start|dest|tasks|weight|cost|CPU|T_available|T_route|valid|route",
        &[
            "1|1|50|8|22|0.048|17.3|10800|10262|Yes|1-39-7-16-48-33-40-38-50",
            "2|7|50|10|34|0.030|23.9|7710.8|7805|Yes|7-41-14-12-36-48-22-15-47-40-50",
            "3|12|50|7|38|0.024|21.9|5375.3|5211|Yes|12-4-39-44-30-28-11-50",
            "4|4|50|5|44|0.040|19.8|4234.7|3998|Yes|4-41-12-44-11-50",
            "5|41|50|5|36|0.029|18.4|3474.7|3468|Yes|41-46-3-44-17-50",
            "6|3|50|4|38|0.078|20.7|2117.3|2008|Yes|3-29-30-42-50",
            "7|30|50|2|35|0.477|21.8|1054.5|1051|Yes|30-42-50",
        ],
    )
}

/// Part B of Table 2 as printed.
const LEGS: [&str; 13] = [
    "1|1|1-39|0.000000|0.2260|47.3|2333.1|2535.3|8466.7|0|1",
    "1|2|39-7|0.000043|0.7010|39.8|755.8|666.6|7710.8|1|0",
    "2|1|7-41|0.000000|0.1460|42.4|501.4|508.3|7209.4|0|1",
    "2|2|41-14|0.000000|0.3170|40.0|1078|1179|6131.4|0|1",
    "2|3|14-12|0.000000|0.2260|42.3|756.1|686.6|5375.3|1|0",
    "3|1|12-4|0.000000|0.2790|40.9|1140.6|528.3|4234.7|1|0",
    "4|1|4-41|0.000000|0.2020|37.4|760.02|696.8|3474.7|1|0",
    "5|1|41-46|0.000000|0.2017|40.6|674.5|820.6|2800.2|0|1",
    "5|2|46-3|0.000000|0.2037|44.1|682.8|647.8|2117.3|1|0",
    "6|1|3-29|0.000000|0.1600|39.8|567.2|857.6|1550.1|0|1",
    "6|2|29-30|0.000000|0.1460|43.4|495.5|334.8|1054.5|1|0",
    "7|1|30-42|0.000000|0.1420|39.7|479.04|482.1|575.4|0|0",
    "7|2|42-50|0.000000|0.1370|40.1|563.7|569.3|11.7|0|0",
];

/// Flight time and expected time of the legs of Table 2, seconds.
pub(crate) fn leg_times_s() -> impl Iterator<Item = (f64, f64)> {
    let cell = |text: Option<&str>| text.and_then(|text| text.parse().ok()).unwrap_or(f64::NAN);
    LEGS.iter().map(move |row| {
        let mut cells = row.split('|').skip(6);
        (cell(cells.next()), cell(cells.next()))
    })
}

pub(crate) fn legs() -> Table {
    table(
        "route|call|edge|violation|cost|CPU|T_path-flight|T_expected|T_available|replan|LPP",
        &LEGS,
    )
}
