//! Where a chart's parts stand.

/// Where the parts of a chart stand, in pixels, and the ranges of its axes.
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) x: (f64, f64),
    pub(super) y: (f64, f64),
    pub(super) reversed: bool,
}

impl Frame {
    pub(super) fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let across = (x - self.x.0) / (self.x.1 - self.x.0);
        let up = (y - self.y.0) / (self.y.1 - self.y.0);
        let down = if self.reversed { up } else { 1.0 - up };
        (
            self.left + across * self.width,
            self.top + down * self.height,
        )
    }

    /// Whether a place lies in the frame or on its edge.
    pub(super) fn holds(&self, at: (f64, f64)) -> bool {
        let (x, y) = self.at(at);
        (-0.5..=self.width + 0.5).contains(&(x - self.left))
            && (-0.5..=self.height + 0.5).contains(&(y - self.top))
    }

    pub(super) fn scale(&self) -> f64 {
        self.width / (self.x.1 - self.x.0)
    }
}
