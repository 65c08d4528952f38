// A parallel projection of the sea: lengths hold across the whole picture, so that a scale bar does too.
// The plan view is the same camera straight from above.

const [EAST0, EAST1, NORTH0, NORTH1] = MISSION.box;
const BASE = 1.12 * DEEPEST;

class Camera {
  /** `solid`: turned and seen from the side; else the plan. */
  constructor(solid) {
    this.solid = solid;
    this.times = [50, 20, 10, 5, 2, 1].find(times => times * DEEPEST <= .2 * Math.max(EAST1 - EAST0, NORTH1 - NORTH0)) || 1;
    this.reset();
  }

  /** Back to where everything is seen. */
  reset() {
    this.azimuth = this.solid ? -.42 : 0;
    this.elevation = this.solid ? .66 : Math.PI / 2;
    this.target = [(EAST0 + EAST1) / 2, (NORTH0 + NORTH1) / 2, 0];
    this.whole = true;
  }

  /** Readies the projection for a picture of this size. */
  aim(width, height) {
    this.width = width;
    this.height = height;
    [this.sinA, this.cosA] = [Math.sin(this.azimuth), Math.cos(this.azimuth)];
    [this.sinE, this.cosE] = [Math.sin(this.elevation), this.solid ? Math.cos(this.elevation) : 0];
    if (this.whole) this.showWhole();
  }

  showWhole() {
    this.scale = 1;
    const corners = [0, this.solid ? BASE : 0].flatMap(depth => CORNERS.map(c => this.project([c[0], c[1], depth])));
    const range = k => [Math.min(...corners.map(c => c[k])), Math.max(...corners.map(c => c[k]))];
    const [x, y] = [range(0), range(1)], room = this.solid ? .93 : 1;
    const middle = [(x[0] + x[1]) / 2 - this.width / 2, (y[0] + y[1]) / 2 - this.height / 2];
    this.pan(-middle[0], -middle[1]);
    this.scale = room * Math.min(this.width / (x[1] - x[0]), this.height / (y[1] - y[0]));
  }

  /** On the picture, and how far away (metres, greater is farther). */
  project(place) {
    const dx = place[0] - this.target[0], dy = place[1] - this.target[1], up = (this.target[2] - place[2]) * this.times;
    const right = dx * this.cosA - dy * this.sinA, away = dx * this.sinA + dy * this.cosA;
    return [
      this.width / 2 + right * this.scale,
      this.height / 2 - (up * this.cosE + away * this.sinE) * this.scale,
      away * this.cosE - up * this.sinE,
    ];
  }

  /** Height on the picture of a ball's half, as a share of its radius. */
  get ballHeight() { return this.solid ? Math.hypot(this.sinE, this.times * this.cosE) : 1; }

  /** Moves the picture by pixels. */
  pan(dx, dy) {
    const right = -dx / this.scale, away = dy / this.scale / Math.max(.15, this.sinE);
    this.target[0] += right * this.cosA + away * this.sinA;
    this.target[1] += away * this.cosA - right * this.sinA;
  }

  turn(dx, dy) {
    this.azimuth += dx * .007;
    this.elevation = Math.max(.1, Math.min(1.5, this.elevation + dy * .006));
  }

  /** Enlarges about a point of the picture. */
  zoom(factor, x, y) {
    const least = .3 * Math.min(this.width, this.height) / Math.max(EAST1 - EAST0, NORTH1 - NORTH0);
    const scale = Math.max(least, Math.min(8, this.scale * factor)), shift = 1 - scale / this.scale;
    this.whole = false;
    this.scale = scale;
    this.pan((x - this.width / 2) * shift, (y - this.height / 2) * shift);
  }

  /** All that the picture of the sea bed depends on. */
  get key() {
    return [this.width, this.height, this.azimuth, this.elevation, this.scale, this.times, ...this.target].join();
  }
}

const CORNERS = [[EAST0, NORTH0], [EAST1, NORTH0], [EAST1, NORTH1], [EAST0, NORTH1]];
