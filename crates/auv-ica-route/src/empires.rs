//! Who rules whom: dealing, exchange, total costs, competition, elimination and uniting.

use crate::IcaSettings;
use auv_route_encoding::{RouletteWheel, ScoredRoute};
use auv_types::ChaCha8Rng;

/// A country: a priority vector with the route it decodes to.
#[derive(Clone, Debug)]
pub(crate) struct Country {
    pub(crate) priorities: Vec<f64>,
    pub(crate) route: ScoredRoute,
}

/// An imperialist and its colonies, by index of country.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Empire {
    pub(crate) imperialist: usize,
    pub(crate) colonies: Vec<usize>,
}

/// Step 1: the best countries become imperialists, the others are dealt to them by roulette on
/// their power.
pub(crate) fn found(
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
    let (rulers, others) = ranked.split_at(settings.imperialists.min(countries.len()));
    let mut empires: Vec<_> = rulers
        .iter()
        .map(|&imperialist| Empire {
            imperialist,
            colonies: Vec::new(),
        })
        .collect();
    let costs = rulers
        .iter()
        .map(|&ruler| ranking.penalised(&countries[ruler].route));
    let wheel = RouletteWheel::new(costs, settings.selection_pressure);
    for &country in others {
        empires[wheel.spin(random)].colonies.push(country);
    }
    empires
}

/// Step 4: a colony better than its imperialist changes places with it.
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

/// Step 5: the imperialist's cost and `zeta` times the mean of its colonies'.
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

/// Steps 6 and 7: the weakest empire loses its weakest colony to another by roulette on power; one
/// without colonies falls to another itself.
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
        let fallen = empires[weakest].imperialist;
        empires[others[wheel.spin(random)]].colonies.push(fallen);
        empires.remove(weakest);
    }
}

/// Unites empires whose imperialists are closer than a share of the diagonal of the space; the
/// better imperialist rules.
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
        mean.sqrt() < closer_than * crate::SPAN
    };
    let mut first = 0;
    while first < empires.len() {
        let found =
            (first + 1..empires.len()).find(|&other| near(&empires[first], &empires[other]));
        let Some(other) = found else {
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

    /// Countries on a line, cost and coordinate alike.
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
    fn the_best_rule_and_all_others_are_dealt() {
        let countries = countries(&[5.0, 1.0, 4.0, 2.0, 3.0, 6.0]);
        let empires = found(&settings(2), &countries, &mut Seed(1).stream(0));
        assert_eq!((empires[0].imperialist, empires[1].imperialist), (1, 3));
        let dealt: usize = empires.iter().map(|empire| empire.colonies.len()).sum();
        assert_eq!(dealt, 4);
    }

    #[test]
    fn a_better_colony_takes_over() {
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
    fn the_weakest_empire_loses_its_weakest_colony_and_falls_without_any() {
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
