"use strict";
// The mission as recorded, and its state at a time. Rows start with their time in seconds; positions
// are east, north, depth in metres.

const byId = id => document.getElementById(id);
const MISSION = JSON.parse(byId("data").textContent);
const TRACK = MISSION.track;
const FENCES = MISSION.fences || [];
const END = TRACK.length ? TRACK[TRACK.length - 1][0] : 1;
const DEEPEST = Math.max(10, ...TRACK.map(row => row[3]), ...MISSION.nodes.map(node => node[2]), MISSION.bed ? MISSION.bed.max : 0);

/** How many rows have begun by a time. */
function begun(rows, time) {
  let low = 0, high = rows.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (rows[middle][0] <= time) low = middle + 1; else high = middle;
  }
  return low;
}

/** A row of a series at a time, linear between the rows around it. */
function rowAt(rows, time) {
  const next = begun(rows, time);
  if (!rows.length) return null;
  if (next === 0) return rows[0];
  if (next === rows.length) return rows[next - 1];
  const a = rows[next - 1], b = rows[next], share = (time - a[0]) / (b[0] - a[0]);
  return a.map((value, k) => value + (b[k] - value) * share);
}

/** The rows from a time to another, both ends included. */
function rowsBetween(rows, from, to) {
  if (to <= from || !rows.length) return [];
  return [rowAt(rows, from), ...rows.slice(begun(rows, from), begun(rows, to)), rowAt(rows, to)];
}

/** The last of the things with a time `at` that has begun, or null. */
function latest(things, time) {
  let last = null;
  for (const thing of things) if (thing.at <= time + 1e-6) last = thing;
  return last;
}

/** Depth of the sea bed at a place; without a sea bed, just below all that is shown. */
function bedAt(east, north) {
  const bed = MISSION.bed;
  if (!bed) return 1.1 * DEEPEST;
  const [east0, east1, north0, north1] = MISSION.box, last = bed.n - 1;
  const x = Math.max(0, Math.min(last - 1e-6, (east - east0) / (east1 - east0) * last));
  const y = Math.max(0, Math.min(last - 1e-6, (north - north0) / (north1 - north0) * last));
  const i = Math.floor(x), j = Math.floor(y), k = j * bed.n + i, v = bed.v;
  const near = v[k] + (v[k + 1] - v[k]) * (x - i), far = v[k + bed.n] + (v[k + bed.n + 1] - v[k + bed.n]) * (x - i);
  return near + (far - near) * (y - j);
}

/** From one place to another: compass heading and how far, metres. */
function course(a, b) {
  return [Math.atan2(b[1] - a[1], b[2] - a[2]), Math.hypot(b[1] - a[1], b[2] - a[2])];
}

/** Everything the pictures show of a moment. */
function momentAt(time) {
  const here = rowAt(TRACK, time), route = latest(MISSION.routes, time), leg = latest(MISSION.legs, time);
  const before = rowAt(TRACK, Math.max(0, time - 5)), later = rowAt(TRACK, Math.min(END, time + 5));
  const done = MISSION.legs.filter(each => each.done && each.end <= time);
  return {
    time, route, leg, done,
    here: here && here.slice(1),
    heading: here ? course(before, later)[0] : 0,
    climb: here ? [course(before, later)[1], before[3] - later[3]] : [1, 0],
    path: latest(MISSION.follows, time),
    visited: new Set([MISSION.start, ...done.map(each => each.to)]),
    obstacles: MISSION.obstacles.flatMap(each => {
      const rows = each.p;
      if (!rows.length || time < rows[0][0] - 1 || time > rows[rows.length - 1][0] + 60) return [];
      const [, east, north, depth, radius] = rowAt(rows, time);
      const [heading, way] = course(rowAt(rows, time - 20), rowAt(rows, time + 20));
      return [{ kind: each.kind, span: each.span, place: [east, north, depth], radius, heading: way > 1 ? heading : null }];
    }),
    predicted: MISSION.predicted.flatMap(each => {
      const stretch = each.p.find(rows => rows[0][0] <= time && time <= rows[rows.length - 1][0] + 25);
      if (!stretch) return [];
      const row = rowAt(stretch, time), region = from => ({ span: each.span, place: row.slice(from, from + 3), radius: row[from + 3] });
      const [now, soon] = [region(1), region(5)];
      const moves = course([0, ...now.place], [0, ...soon.place])[1] > 5 || Math.abs(soon.radius - now.radius) > 3;
      return [{ now, soon: moves ? soon : null }];
    }),
  };
}
