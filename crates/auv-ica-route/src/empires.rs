//! Empires: formation, exchange, total cost, competition, elimination and union.

use crate::settings::IcaSettings;
use auv_route_encoding::{RouletteWheel, ScoredRoute};
use auv_types::ChaCha8Rng;

/// Width of the range of priorities.
pub(crate) const SPAN: f64 = 200.0;

/// A country: a priority vector and the route that it decodes to.
#[derive(Clone, Debug)]
pub(crate) struct Country {
    pub(crate) priorities: Vec<f64>,
    pub(crate) route: ScoredRoute,
}

/// An imperialist and its colonies, as indices of countries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Empire {
    pub(crate) imperialist: usize,
    pub(crate) colonies: Vec<usize>,
}

/// Step 1: the best countries become imperialists; each other country becomes a colony of one of them,
/// chosen by roulette on power.
pub(crate) fn form_empires(
    settings: &IcaSettings,
    countries: &[Country],
    random: &mut ChaCha8Rng,
) -> Vec<Empire> {
    let ranking = settings.ranking;
    let mut ranked: Vec<usize> = (0..countries.len()).collect();
    ranked.sort_by(|&a, &b| {
        let order = ranking.order(&countries[a].route, &countries[b].route);
        order.then(a.cmp(&b))
    });
    let (imperialists, others) = ranked.split_at(settings.imperialists.min(countries.len()));
    let mut empires: Vec<_> = imperialists
        .iter()
        .map(|&imperialist| Empire {
            imperialist,
            colonies: Vec::new(),
        })
        .collect();
    let costs = imperialists
        .iter()
        .map(|&country| ranking.penalised(&countries[country].route));
    let wheel = RouletteWheel::new(costs, settings.selection_pressure);
    for &country in others {
        empires[wheel.spin(random)].colonies.push(country);
    }
    empires
}

/// Step 4: a colony that is better than its imperialist exchanges roles with it.
pub(crate) fn exchange(settings: &IcaSettings, countries: &[Country], empires: &mut [Empire]) {
    for empire in empires {
        for colony in &mut empire.colonies {
            let routes = [*colony, empire.imperialist].map(|i| &countries[i].route);
            if settings.ranking.order(routes[0], routes[1]).is_lt() {
                std::mem::swap(colony, &mut empire.imperialist);
            }
        }
    }
}

/// Step 5: the imperialist's cost plus `zeta` times the mean cost of its colonies.
pub(crate) fn total_cost(settings: &IcaSettings, countries: &[Country], empire: &Empire) -> f64 {
    let cost = |country: usize| settings.ranking.penalised(&countries[country].route);
    let colonies = empire.colonies.len();
    let mean = if colonies == 0 {
        0.0
    } else {
        empire.colonies.iter().map(|&i| cost(i)).sum::<f64>() / colonies as f64
    };
    cost(empire.imperialist) + settings.colony_share * mean
}

/// Steps 6 and 7: the weakest empire loses its weakest colony to another empire, chosen by roulette on
/// power. An empire without colonies is eliminated: its imperialist becomes a colony of another.
pub(crate) fn compete(
    settings: &IcaSettings,
    countries: &[Country],
    empires: &mut Vec<Empire>,
    random: &mut ChaCha8Rng,
) {
    if empires.len() < 2 {
        return;
    }
    let costs: Vec<f64> = empires
        .iter()
        .map(|empire| total_cost(settings, countries, empire))
        .collect();
    let weakest = (0..empires.len())
        .max_by(|&a, &b| costs[a].total_cmp(&costs[b]).then(b.cmp(&a)))
        .unwrap_or(0);
    let others: Vec<usize> = (0..empires.len()).filter(|&i| i != weakest).collect();
    let wheel = RouletteWheel::new(
        others.iter().map(|&i| costs[i]),
        settings.selection_pressure,
    );
    let order = |a: usize, b: usize| {
        let routes = [a, b].map(|i| &countries[i].route);
        settings.ranking.order(routes[0], routes[1]).then(a.cmp(&b))
    };
    let colonies = &empires[weakest].colonies;
    if let Some(place) = (0..colonies.len()).max_by(|&a, &b| order(colonies[a], colonies[b])) {
        let colony = empires[weakest].colonies.swap_remove(place);
        empires[others[wheel.spin(random)]].colonies.push(colony);
    }
    if empires[weakest].colonies.is_empty() {
        let eliminated = empires[weakest].imperialist;
        empires[others[wheel.spin(random)]]
            .colonies
            .push(eliminated);
        empires.remove(weakest);
    }
}

/// Unites empires whose imperialists are closer than a share of the diagonal of the space of priority
/// vectors. The better imperialist stays one.
pub(crate) fn unite(
    settings: &IcaSettings,
    closer_than: f64,
    countries: &[Country],
    empires: &mut Vec<Empire>,
) {
    let near = |a: &Empire, b: &Empire| {
        let (a, b) = (&countries[a.imperialist], &countries[b.imperialist]);
        let squares = a.priorities.iter().zip(&b.priorities);
        let mean = squares.map(|(x, y)| (x - y) * (x - y)).sum::<f64>() / a.priorities.len() as f64;
        mean.sqrt() < closer_than * SPAN
    };
    let mut first = 0;
    while first < empires.len() {
        let neighbour =
            (first + 1..empires.len()).find(|&other| near(&empires[first], &empires[other]));
        let Some(other) = neighbour else {
            first += 1;
            continue;
        };
        let mut united = empires.remove(other);
        let empire = &mut empires[first];
        let routes = [united.imperialist, empire.imperialist].map(|i| &countries[i].route);
        if settings.ranking.order(routes[0], routes[1]).is_lt() {
            std::mem::swap(&mut united.imperialist, &mut empire.imperialist);
        }
        empire.colonies.push(united.imperialist);
        empire.colonies.append(&mut united.colonies);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_planning::Score;
    use auv_types::Seed;

    /// Countries with one coordinate each, equal to the cost.
    fn countries(costs: &[f64]) -> Vec<Country> {
        costs
            .iter()
            .map(|&cost| Country {
                priorities: vec![cost],
                route: ScoredRoute {
                    nodes: Vec::new(),
                    score: Score::feasible(cost),
                },
            })
            .collect()
    }

    fn empire(imperialist: usize, colonies: &[usize]) -> Empire {
        Empire {
            imperialist,
            colonies: colonies.to_vec(),
        }
    }

    fn settings(imperialists: usize) -> IcaSettings {
        IcaSettings {
            imperialists,
            ..IcaSettings::paper()
        }
    }

    #[test]
    fn the_best_are_imperialists_and_all_others_colonies() {
        let countries = countries(&[5.0, 1.0, 4.0, 2.0, 3.0, 6.0]);
        let empires = form_empires(&settings(2), &countries, &mut Seed(1).stream(0));
        assert_eq!((empires[0].imperialist, empires[1].imperialist), (1, 3));
        let colonies: usize = empires.iter().map(|empire| empire.colonies.len()).sum();
        assert_eq!(colonies, 4);
    }

    #[test]
    fn a_better_colony_becomes_the_imperialist() {
        let countries = countries(&[3.0, 2.0, 1.0]);
        let mut empires = [empire(0, &[1, 2])];
        exchange(&settings(1), &countries, &mut empires);
        assert_eq!(empires[0].imperialist, 2);
    }

    #[test]
    fn total_cost_adds_a_share_of_the_colonies_mean() {
        let countries = countries(&[1.0, 3.0, 5.0]);
        let total = total_cost(&settings(1), &countries, &empire(0, &[1, 2]));
        assert!((total - 1.4).abs() < 1e-12);
    }

    #[test]
    fn the_weakest_empire_loses_its_weakest_colony_and_is_eliminated_without_any() {
        let countries = countries(&[1.0, 2.0, 5.0, 6.0, 7.0]);
        let mut empires = vec![empire(0, &[1]), empire(2, &[3, 4])];
        let random = &mut Seed(1).stream(0);
        compete(&settings(2), &countries, &mut empires, random);
        assert_eq!(empires, [empire(0, &[1, 4]), empire(2, &[3])]);
        compete(&settings(2), &countries, &mut empires, random);
        assert_eq!(empires, [empire(0, &[1, 4, 3, 2])]);
        compete(&settings(2), &countries, &mut empires, random);
        assert_eq!(empires.len(), 1);
    }

    #[test]
    fn near_empires_unite_under_the_better_imperialist() {
        let countries = countries(&[3.0, 2.0, 90.0]);
        let mut empires = vec![empire(0, &[]), empire(1, &[]), empire(2, &[])];
        unite(&settings(3), 0.02, &countries, &mut empires);
        assert_eq!(empires, [empire(1, &[0]), empire(2, &[])]);
    }
}
