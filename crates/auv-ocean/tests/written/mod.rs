//! NetCDF files (classic) that tests write themselves.
#![allow(dead_code, reason = "not every test uses everything")]

/// A value of an attribute.
#[derive(Clone, Debug)]
pub(crate) enum Attribute {
    Text(String),
    Numbers(Vec<f64>),
}

/// How values are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stored {
    Short,
    Float,
    Double,
}

#[derive(Clone, Debug)]
pub(crate) struct Variable {
    pub(crate) name: String,
    pub(crate) dimensions: Vec<String>,
    pub(crate) attributes: Vec<(String, Attribute)>,
    pub(crate) stored: Stored,
    pub(crate) values: Vec<f64>,
}

impl Variable {
    pub(crate) fn new(name: &str, dimensions: &[&str], values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            dimensions: dimensions.iter().map(|d| (*d).into()).collect(),
            attributes: Vec::new(),
            stored: Stored::Double,
            values,
        }
    }

    pub(crate) fn with(mut self, name: &str, text: &str) -> Self {
        self.set(name, text);
        self
    }

    pub(crate) fn with_numbers(mut self, name: &str, numbers: &[f64]) -> Self {
        self.attributes
            .push((name.into(), Attribute::Numbers(numbers.to_vec())));
        self
    }

    pub(crate) fn stored(mut self, stored: Stored) -> Self {
        self.stored = stored;
        self
    }

    pub(crate) fn set(&mut self, name: &str, text: &str) {
        self.attributes.retain(|a| a.0 != name);
        self.attributes
            .push((name.into(), Attribute::Text(text.into())));
    }

    pub(crate) fn drop_attribute(&mut self, name: &str) {
        self.attributes.retain(|a| a.0 != name);
    }
}

/// A file: dimensions and variables.
#[derive(Clone, Debug, Default)]
pub(crate) struct File {
    pub(crate) dimensions: Vec<(String, usize)>,
    pub(crate) variables: Vec<Variable>,
}

impl File {
    pub(crate) fn new(dimensions: &[(&str, usize)]) -> Self {
        Self {
            dimensions: dimensions
                .iter()
                .map(|(n, size)| ((*n).into(), *size))
                .collect(),
            variables: Vec::new(),
        }
    }

    pub(crate) fn with(mut self, variable: Variable) -> Self {
        self.variables.push(variable);
        self
    }

    pub(crate) fn var(&mut self, name: &str) -> &mut Variable {
        self.variables
            .iter_mut()
            .find(|v| v.name == name)
            .expect("a variable of that name")
    }

    pub(crate) fn size(&self, dimension: &str) -> usize {
        self.dimensions
            .iter()
            .find(|d| d.0 == dimension)
            .expect("a dimension of that name")
            .1
    }

    /// Stores a variable with its dimensions in another order.
    pub(crate) fn permute(&mut self, name: &str, order: &[usize]) {
        let sizes: Vec<usize> = self
            .var(name)
            .dimensions
            .clone()
            .iter()
            .map(|d| self.size(d))
            .collect();
        let variable = self.var(name);
        let mut turned = Vec::with_capacity(variable.values.len());
        let counts: Vec<usize> = order.iter().map(|&k| sizes[k]).collect();
        for i in 0..variable.values.len() {
            let (mut rest, mut index) = (i, vec![0; sizes.len()]);
            for k in (0..order.len()).rev() {
                index[order[k]] = rest % counts[k];
                rest /= counts[k];
            }
            let flat = index
                .iter()
                .zip(&sizes)
                .fold(0, |flat, (i, n)| flat * n + i);
            turned.push(variable.values[flat]);
        }
        variable.values = turned;
        variable.dimensions = order
            .iter()
            .map(|&k| variable.dimensions[k].clone())
            .collect();
    }

    /// Reverses everything along a dimension.
    pub(crate) fn flip(&mut self, dimension: &str) {
        let sizes = self.dimensions.clone();
        for variable in &mut self.variables {
            let Some(at) = variable.dimensions.iter().position(|d| d == dimension) else {
                continue;
            };
            let size = |name: &String| sizes.iter().find(|d| d.0 == *name).expect("a size").1;
            let n = size(&variable.dimensions[at]);
            let inner: usize = variable.dimensions[at + 1..].iter().map(size).product();
            let blocks: Vec<&[f64]> = variable.values.chunks_exact(n * inner).collect();
            variable.values = blocks
                .into_iter()
                .flat_map(|block| {
                    block
                        .chunks_exact(inner)
                        .rev()
                        .flatten()
                        .copied()
                        .collect::<Vec<_>>()
                })
                .collect();
        }
    }

    pub(crate) fn rename_dimension(&mut self, from: &str, to: &str) {
        for dimension in &mut self.dimensions {
            if dimension.0 == from {
                dimension.0 = to.into();
            }
        }
        for dimension in self.variables.iter_mut().flat_map(|v| &mut v.dimensions) {
            if dimension == from {
                *dimension = to.into();
            }
        }
    }

    pub(crate) fn rename(&mut self, from: &str, to: &str) {
        self.var(from).name = to.into();
    }

    pub(crate) fn take_out(&mut self, name: &str) {
        self.variables.retain(|v| v.name != name);
    }

    /// The bytes of the file.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let header = self.header(&vec![0; self.variables.len()]).len();
        let mut begins = Vec::new();
        let (mut data, mut at) = (Vec::new(), header);
        for variable in &self.variables {
            begins.push(at);
            let start = data.len();
            for &value in &variable.values {
                match variable.stored {
                    Stored::Short => data.extend((value as i16).to_be_bytes()),
                    Stored::Float => data.extend((value as f32).to_be_bytes()),
                    Stored::Double => data.extend(value.to_be_bytes()),
                }
            }
            pad(&mut data);
            at += data.len() - start;
        }
        let mut bytes = self.header(&begins);
        bytes.extend(data);
        bytes
    }

    fn header(&self, begins: &[usize]) -> Vec<u8> {
        let mut out = b"CDF\x01".to_vec();
        number(&mut out, 0);
        list(&mut out, 10, self.dimensions.len());
        for (name, size) in &self.dimensions {
            text(&mut out, name);
            number(&mut out, *size);
        }
        list(&mut out, 12, 0);
        list(&mut out, 11, self.variables.len());
        for (variable, begin) in self.variables.iter().zip(begins) {
            text(&mut out, &variable.name);
            number(&mut out, variable.dimensions.len());
            for dimension in &variable.dimensions {
                let id = self.dimensions.iter().position(|d| d.0 == *dimension);
                number(&mut out, id.expect("a dimension"));
            }
            list(&mut out, 12, variable.attributes.len());
            for (name, value) in &variable.attributes {
                text(&mut out, name);
                match value {
                    Attribute::Text(value) => {
                        number(&mut out, 2);
                        text(&mut out, value);
                    }
                    Attribute::Numbers(values) => {
                        number(&mut out, 6);
                        number(&mut out, values.len());
                        values.iter().for_each(|x| out.extend(x.to_be_bytes()));
                    }
                }
            }
            let (kind, width) = match variable.stored {
                Stored::Short => (3, 2),
                Stored::Float => (5, 4),
                Stored::Double => (6, 8),
            };
            number(&mut out, kind);
            number(&mut out, (variable.values.len() * width).div_ceil(4) * 4);
            number(&mut out, *begin);
        }
        out
    }
}

fn number(out: &mut Vec<u8>, value: usize) {
    out.extend((value as u32).to_be_bytes());
}

fn text(out: &mut Vec<u8>, text: &str) {
    number(out, text.len());
    out.extend(text.as_bytes());
    pad(out);
}

fn list(out: &mut Vec<u8>, tag: usize, count: usize) {
    number(out, if count == 0 { 0 } else { tag });
    number(out, count);
}

fn pad(out: &mut Vec<u8>) {
    while !out.len().is_multiple_of(4) {
        out.push(0);
    }
}

/// A sound chart: a shoal in a bay, land in one corner, missing cells in another.
pub(crate) fn chart() -> File {
    let (rows, columns) = (17, 13);
    let latitude = (0..rows).map(|r| 58.0 + 0.004 * f64::from(r)).collect();
    let longitude = (0..columns).map(|c| 10.9 + 0.006 * f64::from(c)).collect();
    let mut depths = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            depths.push(match (row, column) {
                (0..=2, 0..=3) => -12.5,
                (15.., 11..) => f64::NAN,
                (8, 5) => 2.25,
                _ => 40.0 + 1.5 * f64::from(row) + 0.75 * f64::from(column * column),
            });
        }
    }
    File::new(&[("lat", rows as usize), ("lon", columns as usize)])
        .with(
            Variable::new("lat", &["lat"], latitude)
                .with("units", "degrees_north")
                .with("standard_name", "latitude"),
        )
        .with(
            Variable::new("lon", &["lon"], longitude)
                .with("units", "degrees_east")
                .with("standard_name", "longitude"),
        )
        .with(
            Variable::new("deptho", &["lat", "lon"], depths)
                .with("units", "m")
                .with("standard_name", "sea_floor_depth_below_geoid")
                .with("positive", "down"),
        )
}

/// A sound current on depth levels. Values are exact in 32 bits.
pub(crate) fn currents() -> File {
    let (times, levels, rows, columns) = (5, 4, 7, 6);
    let (mut u, mut v) = (Vec::new(), Vec::new());
    for i in 0..times * levels * rows * columns {
        let (column, row) = (i % columns, i / columns % rows);
        let (level, time) = (i / columns / rows % levels, i / columns / rows / levels);
        let land = row == 0 && column < 2 || (level == levels - 1 && row < 2);
        let value = |k: i32| if land { f64::NAN } else { f64::from(k) / 64.0 };
        u.push(value(row + 2 * column - 3 * level + time));
        v.push(value(20 - 3 * row + column + level - 2 * time));
    }
    let axis =
        |n: i32, start: f64, step: f64| (0..n).map(|i| start + step * f64::from(i)).collect();
    let sizes = [
        ("time", times),
        ("depth", levels),
        ("latitude", rows),
        ("longitude", columns),
    ];
    let all = ["time", "depth", "latitude", "longitude"];
    let component = |name, standard: &str, values| {
        Variable::new(name, &all, values)
            .with("units", "m s-1")
            .with("standard_name", standard)
    };
    File::new(&sizes.map(|(name, n)| (name, n as usize)))
        .with(
            Variable::new("time", &["time"], axis(times, 6.0, 1.0))
                .with("units", "hours since 2024-05-01 00:00:00")
                .with("calendar", "gregorian"),
        )
        .with(
            Variable::new("depth", &["depth"], axis(levels, 0.5, 10.0))
                .with("units", "m")
                .with("positive", "down"),
        )
        .with(
            Variable::new("latitude", &["latitude"], axis(rows, 57.9, 0.03))
                .with("units", "degrees_north"),
        )
        .with(
            Variable::new("longitude", &["longitude"], axis(columns, 10.8, 0.05))
                .with("units", "degrees_east"),
        )
        .with(component("uo", "eastward_sea_water_velocity", u))
        .with(component("vo", "northward_sea_water_velocity", v))
}
