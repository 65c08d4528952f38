//! Random sea beds: walls, inlets, shoals, islands, banks.

use crate::dice::Dice;
use auv_ocean::{AnalyticBed, BedFeature, DepthSigma, Effect, Footprint, Undulation};
use auv_types::libm;

/// The kind of a coast.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Landscape {
    /// Deep water with a steep shore on one or two sides.
    Wall,
    /// Land with a narrow, bent channel.
    Inlet,
    /// Water with shoals.
    Shoals,
    /// Water with islands and a few shoals.
    Islands,
    /// A shelf with an edge, and ridges across.
    Bank,
}

impl Landscape {
    /// All kinds.
    pub const ALL: [Self; 5] = [
        Self::Wall,
        Self::Inlet,
        Self::Shoals,
        Self::Islands,
        Self::Bank,
    ];

    /// Its name in files and tables.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Wall => "wall",
            Self::Inlet => "inlet",
            Self::Shoals => "shoals",
            Self::Islands => "islands",
            Self::Bank => "bank",
        }
    }

    /// A bed of this kind around the origin, in a square of half side `half_m`.
    pub(crate) fn bed(self, half_m: f64, dice: &mut Dice) -> AnalyticBed {
        let mut bed = match self {
            Self::Wall => wall(half_m, dice),
            Self::Inlet => inlet(half_m, dice),
            Self::Shoals => shoals(half_m, dice),
            Self::Islands => islands(half_m, dice),
            Self::Bank => bank(half_m, dice),
        };
        if dice.chance(0.35) {
            let [n, e] = dice.direction();
            let length_m = dice.between(150.0, 400.0);
            bed.undulations.push(Undulation {
                amplitude_m: dice.hundredth(0.2, 0.8),
                wavelength: [(n * length_m).round(), (e * length_m).round()],
            });
        }
        if dice.chance(0.5) {
            bed.sigma = DepthSigma {
                least_m: dice.hundredth(0.3, 2.0),
                relative: dice.hundredth(0.01, 0.06),
            };
        }
        bed
    }
}

/// The width of a skirt over which a rise has its steepest slope at `degrees`. The skirt is a smooth step,
/// at its middle 1.5 times as steep as on average.
fn skirt_m(rise_m: f64, degrees: f64) -> f64 {
    let slope = libm::tan(degrees * std::f64::consts::PI / 180.0);
    (1.5 * rise_m.abs() / slope).ceil().max(5.0)
}

/// A shore across the given direction at `distance_m` from the origin.
fn shore(
    name: &str,
    [n, e]: [f64; 2],
    distance_m: f64,
    base_m: f64,
    dice: &mut Dice,
) -> BedFeature {
    let depth_m = dice.whole(-20.0, 3.0);
    let at = |distance_m: f64| [(n * distance_m).round(), (e * distance_m).round()];
    let shape = Footprint::Beyond {
        through: at(distance_m),
        towards: at(distance_m + 100.0),
    };
    let degrees = dice.slope_deg(18.0);
    BedFeature::new(name, shape, depth_m, skirt_m(base_m - depth_m, degrees))
}

fn wall(half_m: f64, dice: &mut Dice) -> AnalyticBed {
    let base_m = dice.whole(45.0, 130.0);
    let ahead = dice.direction();
    let mut bed = AnalyticBed::new(base_m);
    let distance_m = dice.between(0.3, 0.9) * half_m;
    bed = bed.with(shore("wall", ahead, distance_m, base_m, dice));
    if dice.chance(0.4) {
        let [n, e] = ahead;
        let side = dice.between(-0.6, 0.6);
        let across = [-n + side * e, -e - side * n];
        let length = libm::sqrt(across[0] * across[0] + across[1] * across[1]);
        let across = across.map(|x| x / length);
        let distance_m = dice.between(0.5, 1.0) * half_m;
        bed = bed.with(shore("far wall", across, distance_m, base_m, dice).effect(Effect::Raise));
    }
    for k in 0..dice.count(0, 2) {
        bed = bed.with(shoal(&format!("shoal {k}"), half_m, base_m, dice));
    }
    bed
}

fn inlet(half_m: f64, dice: &mut Dice) -> AnalyticBed {
    let depth_m = dice.whole(30.0, 70.0);
    let land_m = dice.whole(-15.0, 2.0);
    let [n, e] = dice.direction();
    let bends = dice.count(3, 5);
    let points = (0..bends).map(|k| {
        let along = (2.0 * k as f64 / (bends - 1) as f64 - 1.0) * 0.95 * half_m;
        let aside = dice.between(-0.3, 0.3) * half_m;
        [
            (n * along - e * aside).round(),
            (e * along + n * aside).round(),
        ]
    });
    let points: Vec<[f64; 2]> = points.collect();
    let end = points[bends - 1];
    let degrees = dice.slope_deg(18.0);
    let skirt = skirt_m(depth_m - land_m, degrees);
    let shape = Footprint::Line {
        points,
        half_width_m: dice.whole(80.0, 200.0),
    };
    let channel = BedFeature::new("channel", shape, depth_m, skirt);
    let mut bed = AnalyticBed::new(land_m).with(channel);
    if dice.chance(0.6) {
        let deep_m = depth_m + dice.whole(0.0, 30.0);
        let basin = Footprint::Disc {
            centre: end,
            radius_m: dice.whole(150.0, 400.0),
        };
        let skirt = skirt_m(deep_m - land_m, dice.slope_deg(18.0));
        bed = bed.with(BedFeature::new("basin", basin, deep_m, skirt).effect(Effect::Dig));
    }
    for k in 0..dice.count(0, 2) {
        bed = bed.with(shoal(&format!("rock {k}"), 0.7 * half_m, depth_m, dice));
    }
    bed
}

/// A shoal or a pinnacle somewhere.
fn shoal(name: &str, half_m: f64, base_m: f64, dice: &mut Dice) -> BedFeature {
    let depth_m = dice.whole(2.0, 0.5 * base_m);
    let centre = dice.place(0.9 * half_m);
    let radius_m = dice.whole(5.0, 80.0);
    let degrees = dice.slope_deg(12.0);
    let shape = Footprint::Disc { centre, radius_m };
    BedFeature::new(name, shape, depth_m, skirt_m(base_m - depth_m, degrees)).effect(Effect::Raise)
}

fn shoals(half_m: f64, dice: &mut Dice) -> AnalyticBed {
    let base_m = dice.whole(30.0, 85.0);
    let mut bed = AnalyticBed::new(base_m);
    for k in 0..dice.count(3, 6) {
        bed = bed.with(shoal(&format!("shoal {k}"), half_m, base_m, dice));
    }
    bed
}

fn islands(half_m: f64, dice: &mut Dice) -> AnalyticBed {
    let base_m = dice.whole(35.0, 100.0);
    let mut bed = AnalyticBed::new(base_m);
    for k in 0..dice.count(1, 3) {
        let depth_m = dice.whole(-25.0, -2.0);
        let centre = dice.place(0.7 * half_m);
        let reach_m = dice.between(50.0, 220.0);
        let corners = dice.count(4, 7);
        let outline = (0..corners).map(|i| {
            let angle = std::f64::consts::TAU * i as f64 / corners as f64;
            let radius_m = reach_m * dice.between(0.4, 1.0);
            [
                (centre[0] + radius_m * libm::cos(angle)).round(),
                (centre[1] + radius_m * libm::sin(angle)).round(),
            ]
        });
        let outline = outline.collect();
        let skirt = skirt_m(base_m - depth_m, dice.slope_deg(15.0));
        let shape = Footprint::Area { outline };
        let island = BedFeature::new(format!("island {k}"), shape, depth_m, skirt);
        bed = bed.with(island.effect(Effect::Raise));
    }
    for k in 0..dice.count(0, 2) {
        bed = bed.with(shoal(&format!("shoal {k}"), half_m, base_m, dice));
    }
    bed
}

fn bank(half_m: f64, dice: &mut Dice) -> AnalyticBed {
    let base_m = dice.whole(45.0, 120.0);
    let shelf_m = dice.whole(15.0, 0.5 * base_m);
    let [n, e] = dice.direction();
    let edge_m = dice.between(-0.5, 0.5) * half_m;
    let at = |distance_m: f64| [(n * distance_m).round(), (e * distance_m).round()];
    let shape = Footprint::Beyond {
        through: at(edge_m),
        towards: at(edge_m + 100.0),
    };
    let skirt = skirt_m(base_m - shelf_m, dice.slope_deg(20.0));
    let mut bed = AnalyticBed::new(base_m).with(BedFeature::new("shelf", shape, shelf_m, skirt));
    for k in 0..dice.count(1, 3) {
        let depth_m = dice.whole(8.0, 30.0);
        let [from, to] = [dice.place(half_m), dice.place(half_m)];
        let shape = Footprint::Line {
            points: vec![from, to],
            half_width_m: dice.whole(5.0, 60.0),
        };
        let skirt = skirt_m(base_m - depth_m, dice.slope_deg(15.0));
        let ridge = BedFeature::new(format!("ridge {k}"), shape, depth_m, skirt);
        bed = bed.with(ridge.effect(Effect::Raise));
    }
    bed
}
