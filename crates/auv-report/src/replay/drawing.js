// Colours (Okabe and Ito, distinguishable with any colour vision) and strokes on a 2-D canvas.

const INK = "#1a1a1a", BLUE = "#0072B2", ORANGE = "#D55E00", GREEN = "#009E73", YELLOW = "#F0E442", GREY = "#8a8a8a";
const KINDS = {
  charted: { colour: "#6b6b6b", name: "charted obstacle", dash: [] },
  uncertain: { colour: "#E69F00", name: "obstacle of uncertain size", dash: [5, 3] },
  moving: { colour: "#56B4E9", name: "moving obstacle", dash: [] },
  drifting: { colour: "#CC79A7", name: "drifting, growing obstacle", dash: [2, 3] },
  ship: { colour: "#1a1a1a", name: "ship", dash: [] },
};
const FONT = "11px Helvetica,Arial,sans-serif";

/** A canvas made as sharp as the screen; its context, width and height in CSS pixels. */
function fitted(id, height) {
  const canvas = byId(id), ratio = window.devicePixelRatio || 1, width = canvas.clientWidth;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) {
    canvas.style.height = height + "px";
    canvas.width = w;
    canvas.height = h;
  }
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, width, height);
  g.font = FONT;
  g.lineJoin = "round";
  return [g, width, height];
}

/** A line through points; null lifts the pen. */
function stroke(g, points, colour, width, dash, opacity) {
  g.globalAlpha = opacity === undefined ? 1 : opacity;
  g.strokeStyle = colour;
  g.lineWidth = width;
  g.setLineDash(dash || []);
  g.beginPath();
  let down = false;
  for (const p of points) {
    if (p) { if (down) g.lineTo(p[0], p[1]); else g.moveTo(p[0], p[1]); }
    down = !!p;
  }
  g.stroke();
  g.setLineDash([]);
  g.globalAlpha = 1;
}

/** The outline just begun on `g`, filled and stroked. */
function paint(g, fill, edge, width) {
  if (fill) { g.fillStyle = fill; g.fill(); }
  if (edge) { g.strokeStyle = edge; g.lineWidth = width || 1.2; g.stroke(); }
}

/** Text with a white rim. */
function label(g, text, x, y, colour) {
  g.lineWidth = 3;
  g.strokeStyle = "rgba(255,255,255,.85)";
  g.strokeText(text, x, y);
  g.fillStyle = colour || INK;
  g.fillText(text, x, y);
}

/** Names where nothing stands yet, the first ones first; who finds no room is left out. */
function labelAll(g, names, taken, width, height) {
  for (const { text, x, y, colour } of names) {
    const long = g.measureText(text).width;
    for (const [a, b] of [[x + 9, y + 4], [x - 9 - long, y + 4], [x - long / 2, y - 10], [x - long / 2, y + 18]]) {
      const box = [a - 1, b - 10, a + long + 1, b + 3];
      const out = box[0] < 2 || box[2] > width - 2 || box[1] < 2 || box[3] > height - 2;
      if (out || taken.some(u => box[0] < u[2] && u[0] < box[2] && box[1] < u[3] && u[1] < box[3])) continue;
      taken.push(box);
      label(g, text, a, b, colour);
      break;
    }
  }
}

/** The next of 1, 2, 5, 10, 20, ... */
function nice(value) {
  const power = Math.pow(10, Math.floor(Math.log10(value)));
  return [1, 2, 5, 10].map(f => f * power).find(v => v >= value * (1 - 1e-9));
}

/** Depth between two shades of the sea bed, metres. */
const SHADE_STEP = nice(DEEPEST / 7);

/** Shallower than this is land, metres: charts write land as depth 0. */
const SHORE = .1;

/** Red, green and blue of the sea bed at a depth: a shade for each step, sand on land. */
function bedColour(depth) {
  if (depth <= SHORE) return [214, 200, 164];
  const share = Math.min(1, (Math.floor(depth / SHADE_STEP) + .5) * SHADE_STEP / DEEPEST);
  return [240 - 112 * share, 247 - 74 * share, 252 - 40 * share];
}
