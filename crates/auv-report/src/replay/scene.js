// The map, as plan and in three dimensions: one scene, seen by two cameras. Nearer things are drawn
// later; things behind the sea bed are drawn faintly.

const TERRAIN = MISSION.bed ? new Terrain(MISSION.bed) : null;
const CAMERAS = { plan: new Camera(false), solid: new Camera(true) };

class Scene {
  constructor(g, camera) {
    this.g = g;
    this.camera = camera;
    this.slack = 4 / camera.scale / Math.max(.15, camera.sinE) + 2;
    this.things = [];
  }

  hidden(p) {
    return this.camera.solid && TERRAIN && TERRAIN.hides(p, this.slack);
  }

  onPicture(p, room) {
    return p[0] > -room && p[1] > -room && p[0] < this.camera.width + room && p[1] < this.camera.height + room;
  }

  /** Something to be drawn in its turn by distance. */
  add(away, draw) {
    this.things.push([away, draw]);
  }

  /**
   * A line in space, in pieces short enough to be ordered by distance. `rim`: with a white edge.
   * `behind`: what lies about as far away is drawn over it; in the plan, everything.
   */
  line(places, colour, width, dash, { rim = false, behind = false } = {}) {
    const longest = 14, farther = !behind ? 0 : this.camera.solid ? 30 / this.camera.scale : 1e7;
    let piece = [], long = 0, offset = 0;
    const end = () => {
      const points = piece, start = offset;
      if (points.length > 1 && points.some(p => this.onPicture(p, 20))) {
        const middle = points[points.length >> 1], faint = this.hidden(middle) ? .22 : 1;
        this.add(middle[2] + farther, g => {
          g.lineDashOffset = start;
          if (rim && faint === 1) stroke(g, points, "#fff", width + 2.4, [], .8);
          g.lineCap = rim ? "round" : "butt";
          stroke(g, points, colour, width, dash, faint);
          g.lineCap = "butt";
          g.lineDashOffset = 0;
        });
      }
      offset += long;
      piece = piece.slice(-1);
      long = 0;
    };
    let before = null;
    for (const place of places) {
      const p = this.camera.project(place);
      if (before) {
        const whole = Math.hypot(p[0] - before[0], p[1] - before[1]), cuts = Math.min(300, Math.ceil(whole / longest));
        for (let k = 1; k <= cuts; k++) {
          piece.push(p.map((v, i) => before[i] + (v - before[i]) * k / cuts));
          long += whole / cuts;
          if (long >= longest) end();
        }
      } else piece.push(p);
      before = p;
    }
    end();
  }

  /** A ring at one depth. */
  ring(place, radius, colour, width, dash) {
    const p = this.camera.project(place), r = radius * this.camera.scale;
    this.add(p[2], g => {
      g.beginPath();
      g.ellipse(p[0], p[1], r, r * this.camera.sinE, 0, 0, 7);
      g.setLineDash(dash);
      paint(g, null, colour, width);
      g.setLineDash([]);
    });
  }

  /** Upper and lower end of a cylinder as drawn: not above the surface, not below the bed. */
  ends({ span, place }) {
    const bed = Math.max(1, bedAt(place[0], place[1]));
    const top = Math.max(0, Math.min(span[0], bed));
    return [top, Math.max(top, Math.min(span[1], bed))].map(depth => this.camera.project([place[0], place[1], depth]));
  }

  /** A ball or a cylinder in its right size; never smaller than can be seen. */
  body(obstacle, look) {
    const r = Math.max(1.6, obstacle.radius * this.camera.scale);
    if (obstacle.span) {
      const [top, bottom] = this.ends(obstacle);
      if (this.onPicture(top, r) || this.onPicture(bottom, r)) this.add(top[2], g => this.cylinder(g, top, bottom, r, look, this.hidden(top)));
    } else {
      const p = this.camera.project(obstacle.place), tall = r * this.camera.ballHeight;
      if (this.onPicture(p, tall)) this.add(p[2], g => this.ball(g, p, r, tall, look, this.hidden([p[0], p[1] - .8 * tall, p[2]])));
    }
  }

  ball(g, p, wide, tall, look, hidden) {
    g.beginPath();
    g.ellipse(p[0], p[1], wide, tall, 0, 0, 7);
    g.globalAlpha = hidden ? .25 : .85;
    g.save();
    g.translate(p[0], p[1]);
    g.scale(wide, tall);
    const light = g.createRadialGradient(-.35, -.45, .05, 0, 0, 1.05);
    light.addColorStop(0, "#fff");
    light.addColorStop(.45, look.colour);
    light.addColorStop(1, look.colour);
    g.fillStyle = light;
    g.fill();
    g.restore();
    g.setLineDash(look.dash);
    paint(g, null, "#333", .9);
    g.setLineDash([]);
    g.globalAlpha = 1;
  }

  cylinder(g, top, bottom, r, look, hidden) {
    const flat = r * this.camera.sinE;
    g.globalAlpha = hidden ? .25 : .85;
    if (this.camera.solid) {
      const light = g.createLinearGradient(top[0] - r, 0, top[0] + r, 0);
      light.addColorStop(0, look.colour);
      light.addColorStop(.35, "#f4f4f4");
      light.addColorStop(.6, look.colour);
      light.addColorStop(1, look.colour);
      g.beginPath();
      g.ellipse(bottom[0], bottom[1], r, flat, 0, 0, Math.PI);
      g.ellipse(top[0], top[1], r, flat, 0, Math.PI, 0, true);
      g.closePath();
      paint(g, light, "#333", .8);
    }
    g.beginPath();
    g.ellipse(top[0], top[1], r, flat, 0, 0, 7);
    paint(g, look.colour, "#333", .8);
    g.globalAlpha = 1;
  }

  /** The outline of what is predicted. */
  outline(region, dash, width) {
    const r = region.radius * this.camera.scale;
    if (r < 1) return;
    const [top, bottom] = region.span ? this.ends(region) : [this.camera.project(region.place), null];
    if (!this.onPicture(top, 3 * r)) return;
    this.add(top[2] - region.radius, g => {
      g.setLineDash(dash);
      const flat = r * this.camera.sinE;
      for (const p of bottom && this.camera.solid ? [top, bottom] : [top]) {
        g.beginPath();
        g.ellipse(p[0], p[1], r, bottom ? flat : r * this.camera.ballHeight, 0, 0, 7);
        paint(g, null, INK, width);
      }
      g.setLineDash([]);
      if (bottom && this.camera.solid) for (const side of [-r, r]) stroke(g, [[top[0] + side, top[1]], [bottom[0] + side, bottom[1]]], INK, width, dash);
    });
  }

  /** A dart of fixed size on the screen, pointing along the heading. */
  dart(g, place, heading, climb, size, fills, edge) {
    const { camera } = this, unit = size / camera.scale;
    const pitch = camera.solid ? Math.atan2(camera.times * climb[1], Math.max(climb[0], 1e-9)) : 0;
    const corner = (ahead, right) => camera.project([
      place[0] + unit * (ahead * Math.cos(pitch) * Math.sin(heading) + right * Math.cos(heading)),
      place[1] + unit * (ahead * Math.cos(pitch) * Math.cos(heading) - right * Math.sin(heading)),
      place[2] - unit * ahead * Math.sin(pitch) / camera.times,
    ]);
    const nose = corner(1.1, 0), tail = corner(-.35, 0);
    [-.6, .6].forEach((side, k) => {
      const wing = corner(-.75, side);
      g.beginPath();
      for (const p of [nose, wing, tail]) g.lineTo(p[0], p[1]);
      g.closePath();
      paint(g, fills[k], edge, 1.5);
    });
  }

  finish() {
    this.things.sort((a, b) => b[0] - a[0]);
    for (const [, draw] of this.things) draw(this.g);
  }
}

/** Surface, corners of the block and, without a sea bed, its floor. */
function frame(scene) {
  const { g, camera } = scene, surface = CORNERS.map(c => camera.project([c[0], c[1], 0]));
  const loop = points => [...points, points[0]];
  if (!camera.solid) return;
  if (!TERRAIN) {
    const floor = CORNERS.map(c => camera.project([c[0], c[1], BASE]));
    stroke(g, loop(floor), GREY, 1);
  }
  g.beginPath();
  surface.forEach(p => g.lineTo(p[0], p[1]));
  g.closePath();
  paint(g, "rgba(0,114,178,.05)", null);
  for (const [k, c] of CORNERS.entries()) {
    const points = Array.from({ length: 41 }, (_, i) => CORNERS[(k + 1) % 4].map((v, j) => c[j] + (v - c[j]) * i / 40));
    scene.line(points.map(p => [...p, 0]), "#2f6f9f", 1, []);
    scene.line([[...c, 0], [...c, TERRAIN ? Math.max(0, bedAt(...c)) : BASE]], "#2f6f9f", .8, [2, 3]);
  }
}

/** A fence's depths as words; nothing where it holds at all depths. */
function depthsOf({ span: [top, bottom] }) {
  if (bottom < 1e8) return `, ${Math.round(top)} to ${Math.round(bottom)} m deep`;
  return top > 0 ? `, from ${Math.round(top)} m down` : "";
}

/** Areas to keep out of and to stay in; those that do not hold now are faint and dashed. */
function fences(scene, moment) {
  const { g, camera } = scene;
  for (const { kind, span, holds, p } of FENCES) {
    const colour = kind === "keep out" ? ORANGE : GREEN, now = holds[0] <= moment.time && moment.time <= holds[1];
    const dash = now && kind === "keep out" ? [] : [6, 4], loop = [...p, p[0]];
    const depth = (place, k) => Math.min(span[k], Math.max(1, bedAt(...place)));
    const top = loop.map(place => camera.project([...place, camera.solid ? depth(place, 0) : 0]));
    if (kind === "keep out") {
      g.beginPath();
      top.forEach(c => g.lineTo(c[0], c[1]));
      g.closePath();
      g.globalAlpha = now ? .18 : .06;
      paint(g, colour, null);
      g.globalAlpha = 1;
    }
    stroke(g, top, colour, 1.4, dash, now ? 1 : .5);
    if (!camera.solid) continue;
    const sides = loop.map((place, k) => Array.from({ length: 41 }, (_, i) => {
      const next = loop[(k + 1) % loop.length];
      return place.map((v, j) => v + (next[j] - v) * i / 40);
    })).slice(0, -1).flat();
    scene.line(sides.map(place => [...place, depth(place, 1)]), colour, 1, dash.length ? dash : [2, 3]);
    for (const place of p) scene.line([[...place, depth(place, 0)], [...place, depth(place, 1)]], colour, .8, [2, 3]);
  }
}

/** Edges of the network, routes past and in force, tasks done. */
function network(scene, moment) {
  const nodes = MISSION.nodes, place = k => nodes[k] && nodes[k].slice(0, 3);
  const edges = MISSION.edges.flatMap(([a, b]) => [scene.camera.project(nodes[a]), scene.camera.project(nodes[b]), null]);
  const many = Math.min(.45, Math.max(.08, 50 / Math.max(1, MISSION.edges.length)));
  stroke(scene.g, edges, "#707070", .6, [], scene.camera.solid ? .5 * many : many);
  const along = (route, colour, width, dash) => scene.line(route.map(place).filter(p => p), colour, width, dash, { behind: true });
  const pairs = route => route.slice(1).map((to, k) => route[k] + "-" + to);
  const kept = new Set([...(moment.route ? pairs(moment.route.route) : []), ...moment.done.map(leg => leg.from + "-" + leg.to)]);
  const dropped = new Set(MISSION.routes.filter(r => r.at <= moment.time && r.adopted).flatMap(r => pairs(r.route)).filter(pair => !kept.has(pair)));
  for (const pair of dropped) along(pair.split("-"), "#777", 1.1, [2, 4]);
  if (moment.route) along(moment.route.route, INK, 1.6, [7, 5]);
  for (const leg of moment.done) along([leg.from, leg.to], GREEN, 5, []);
}

/** Waypoints, with a line down to the sea bed. */
function waypoints(scene, moment) {
  const ahead = new Set(moment.route ? moment.route.route : []);
  MISSION.nodes.forEach(([east, north, depth], k) => {
    const p = scene.camera.project([east, north, depth]), end = k === MISSION.start || k === MISSION.dest;
    if (!scene.onPicture(p, 200)) return;
    const foot = scene.camera.project([east, north, Math.max(depth, bedAt(east, north))]), faint = scene.hidden(p);
    scene.add(p[2], g => {
      g.globalAlpha = faint ? .4 : 1;
      if (scene.camera.solid) {
        stroke(g, [p, foot], "#555", .8, [1, 2], faint ? .3 : .8);
        stroke(g, [[foot[0] - 3, foot[1]], [foot[0] + 3, foot[1]]], "#555", 1, [], faint ? .3 : .8);
      }
      g.beginPath();
      if (end) g.rect(p[0] - 5.5, p[1] - 5.5, 11, 11);
      else g.arc(p[0], p[1], moment.visited.has(k) || ahead.has(k) ? 4 : 2.8, 0, 7);
      paint(g, end ? YELLOW : moment.visited.has(k) ? INK : "#fff", INK, end || ahead.has(k) ? 1.5 : .8);
      g.globalAlpha = 1;
    });
  });
}

function obstacles(scene, moment) {
  for (const obstacle of moment.obstacles) {
    scene.body(obstacle, KINDS[obstacle.kind]);
    if (obstacle.kind === "ship" && obstacle.heading !== null) {
      const p = scene.camera.project([...obstacle.place.slice(0, 2), 0]);
      scene.add(p[2] - obstacle.radius, g => scene.dart(g, [...obstacle.place.slice(0, 2), 0], obstacle.heading, [1, 0], 12, [INK, "#555"], "#fff"));
    }
  }
  for (const { now, soon } of moment.predicted) {
    scene.outline(now, [4, 3], 1);
    if (soon) {
      scene.outline(soon, [1, 3], .9);
      stroke(scene.g, [scene.camera.project(now.place), scene.camera.project(soon.place)], INK, .8, [1, 3]);
    }
  }
}

/** What was flown, the path in force, and the vehicle with its sonar range. */
function vehicle(scene, moment) {
  const ahead = moment.path ? moment.path.p : [];
  scene.line(ahead, ORANGE, 2, [5, 4]);
  scene.line(rowsBetween(TRACK, 0, moment.time).map(row => row.slice(1)), BLUE, 2.6, [], { rim: true });
  if (!moment.here) return;
  const { here, heading, climb } = moment, [east, north] = here;
  scene.ring(here, MISSION.sonar, BLUE, 1.2, [5, 4]);
  if (scene.camera.solid) scene.line([[east, north, 0], [east, north, Math.max(here[2], bedAt(east, north))]], BLUE, 1, [2, 2]);
  // The vehicle is always on top.
  scene.add(-Infinity, g => scene.dart(g, here, heading, climb, 15, [YELLOW, "#d6c71e"], INK));
}

/** Names, scale, north and current. */
function furniture(scene, moment) {
  const { g, camera } = scene, { width, height } = camera, taken = [[0, 0, 150, 40], [width - 40, 0, width, 56], [0, height - 46, 210, height]];
  const ahead = new Set(moment.route ? moment.route.route : []), main = k => moment.visited.has(k) || ahead.has(k) || k === MISSION.dest;
  const names = MISSION.nodes.map(([east, north, depth, text], k) => {
    const [x, y] = camera.project([east, north, depth]);
    return { text, x, y, k, colour: main(k) ? INK : "#6b6b6b" };
  }).sort((a, b) => main(b.k) - main(a.k) || a.k - b.k);
  if (moment.here) {
    const [x, y] = camera.project(moment.here);
    taken.push([x - 9, y - 9, x + 9, y + 9]);
    g.font = "bold " + FONT;
    labelAll(g, [{ text: "vehicle", x: x + 6, y, colour: INK }], taken, width, height);
    g.font = FONT;
  }
  labelAll(g, FENCES.map(fence => {
    const middle = [0, 1].map(axis => fence.p.reduce((sum, place) => sum + place[axis], 0) / fence.p.length);
    const [x, y] = camera.project([...middle, 0]);
    return { text: fence.name + depthsOf(fence), x, y, colour: fence.kind === "keep out" ? "#9a4300" : "#00664b" };
  }), taken, width, height);
  labelAll(g, names, taken, width, height);

  const metres = nice(110 / camera.scale / 2), long = metres * camera.scale, [x, y] = [12, height - 12];
  stroke(g, [[x, y - 5], [x, y], [x + long, y], [x + long, y - 5]], INK, 1.6);
  const stretched = camera.solid ? (camera.times === 1 ? ", heights to scale" : ", heights " + camera.times + " x") : "";
  label(g, (metres >= 1000 ? metres / 1000 + " km" : metres + " m") + stretched, x + 4, y - 8);

  arrow(g, width - 20, 24, camera, [0, 1], 12, INK);
  label(g, "N", width - 24, 50);
  if (MISSION.current) {
    const speed = Math.hypot(...MISSION.current);
    if (speed > 1e-6) arrow(g, 20, 20, camera, MISSION.current.map(v => v / speed), 11, BLUE);
    label(g, "current " + speed.toFixed(2) + " m/s", 40, 24);
  }
}

/** An arrow along a horizontal direction (east, north), as the camera sees it. */
function arrow(g, x, y, camera, [east, north], size, colour) {
  const right = east * camera.cosA - north * camera.sinA, up = (east * camera.sinA + north * camera.cosA) * camera.sinE;
  const [ux, uy] = [right * size, -up * size], tip = [x + ux, y + uy];
  stroke(g, [[x - ux, y - uy], tip], colour, 2);
  stroke(g, [[tip[0] - .5 * ux + .35 * uy, tip[1] - .5 * uy - .35 * ux], tip, [tip[0] - .5 * ux - .35 * uy, tip[1] - .5 * uy + .35 * ux]], colour, 2);
}

/** Draws the map of a moment. */
function drawMap(moment, camera, height) {
  const [g, width] = fitted("map", height);
  camera.aim(width, height);
  const scene = new Scene(g, camera);
  g.fillStyle = camera.solid ? "#fafafa" : "#eee";
  g.fillRect(0, 0, width, height);
  if (TERRAIN) g.drawImage(TERRAIN.draw(camera), 0, 0, width, height);
  frame(scene);
  fences(scene, moment);
  network(scene, moment);
  waypoints(scene, moment);
  obstacles(scene, moment);
  vehicle(scene, moment);
  scene.finish();
  furniture(scene, moment);
}
