// Curves over time, the time line of legs, and each decision with its reason. What does not change with
// time is drawn once and kept.

const LEFT = 40, RIGHT = 8, FOOT = 15;
const kept = new Map();
const timeAt = (x, width) => Math.max(0, Math.min(END, (x - LEFT) / (width - LEFT - RIGHT) * END));

/** Draws a chart: its standing part by `paper(g, X, width)` only when its size changed, then the time cursor. */
function chart(id, height, time, paper) {
  const [g, width] = fitted(id, height), X = t => LEFT + t / END * (width - LEFT - RIGHT), canvas = byId(id), key = canvas.width + "x" + canvas.height;
  if (!kept.has(id) || kept.get(id).key !== key) {
    paper(g, X, width);
    timeAxis(g, X, width, height);
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.width, canvas.height];
    copy.getContext("2d").drawImage(canvas, 0, 0);
    kept.set(id, { key, copy });
  } else g.drawImage(kept.get(id).copy, 0, 0, width, height);
  stroke(g, [[X(time), 2], [X(time), height - FOOT]], "#b00020", 1.4);
  return [g, X];
}

/** Long missions are told in hours, short ones in minutes. */
const LONG = END > 7200;

function timeAxis(g, X, width, height) {
  const least = END / Math.max(2, Math.floor((width - LEFT) / 75));
  const step = [60, 120, 300, 600, 900, 1800, 3600, 7200, 14400].find(step => step >= least) || 3600 * nice(least / 3600);
  const text = t => LONG ? Math.floor(t / 3600) + ":" + String(Math.round(t / 60) % 60).padStart(2, "0") + " h" : (t / 60).toFixed(0) + " min";
  g.fillStyle = "#444";
  g.textAlign = "center";
  for (let t = 0; t <= END; t += step) g.fillText(text(t), Math.min(Math.max(X(t), LEFT + 10), width - 24), height - 3);
  g.textAlign = "left";
}

/** A vertical axis from `low` (below) to `high` (above) with grid lines; gives the place of a value. */
function axis(g, width, height, low, high) {
  const Y = v => height - FOOT - (Math.max(Math.min(low, high), Math.min(Math.max(low, high), v)) - low) / (high - low) * (height - FOOT - 6);
  const [from, to] = [Math.min(low, high), Math.max(low, high)], step = nice((to - from) / 4);
  g.textAlign = "right";
  for (let v = Math.ceil(from / step) * step; v <= to + 1e-9; v += step) {
    stroke(g, [[LEFT, Y(v)], [width - RIGHT, Y(v)]], "#e6e6e6", 1);
    g.fillStyle = "#444";
    g.fillText(String(+v.toFixed(6)), LEFT - 5, Y(v) + 4);
  }
  g.textAlign = "left";
  return Y;
}

function drawCharts(moment) {
  const { time, here } = moment, deep = 1.06 * Math.max(10, ...TRACK.map(row => row[3]), ...(MISSION.floor || []).map(row => row[1]));
  const height = chartHeight();
  let [g, X] = chart("depth", height, time, (g, X, width) => {
    const Y = axis(g, width, height, deep, 0);
    if (MISSION.floor) {
      g.beginPath();
      for (const row of MISSION.floor) g.lineTo(X(row[0]), Y(row[1]));
      g.lineTo(X(END), Y(deep));
      g.lineTo(X(0), Y(deep));
      g.closePath();
      paint(g, "#cfc3a5", null);
    }
    stroke(g, TRACK.map(row => [X(row[0]), Y(row[3])]), BLUE, 1.8);
  });
  if (here) {
    g.beginPath();
    g.arc(X(time), 6 + here[2] / deep * (height - FOOT - 6), 4, 0, 7);
    paint(g, YELLOW, INK, 1.4);
  }
  chart("budget", height, time, (g, X, width) => {
    const unit = s => s / (LONG ? 3600 : 60), left = s => MISSION.budget - s, Y = axis(g, width, height, Math.min(0, unit(left(END))), unit(MISSION.budget));
    stroke(g, [[X(0), Y(unit(MISSION.reserve))], [X(END), Y(unit(MISSION.reserve))]], "#666", 1.2, [2, 3]);
    stroke(g, [[X(0), Y(unit(left(0)))], [X(END), Y(unit(left(END)))]], BLUE, 1.8);
    stroke(g, MISSION.routes.flatMap(route => {
      const until = Math.min(END, route.until);
      return [[X(route.at), Y(unit(route.time))], [X(until), Y(unit(route.time - (until - route.at)))], null];
    }), ORANGE, 1.8, [5, 4]);
  });
  chart("clear", height, time, (g, X, width) => {
    const Y = axis(g, width, height, -20, 500);
    stroke(g, [[X(0), Y(0)], [X(END), Y(0)]], "#b00020", 1);
    stroke(g, MISSION.clear.map(row => [X(row[0]), Y(row[1])]), GREEN, 1.6);
  });
  chart("legs", 62, time, (g, X) => MISSION.legs.forEach((leg, k) => legBox(g, X, leg, k)) || timeMarks(g, X));
}

function legBox(g, X, leg, k) {
  g.fillStyle = leg.done ? (k % 2 ? "#004c78" : BLUE) : GREY;
  const long = X(leg.end) - X(leg.at);
  g.fillRect(X(leg.at), 19, Math.max(1, long - 1), 14);
  if (long > g.measureText(leg.name).width + 4) {
    g.fillStyle = "#fff";
    g.textAlign = "center";
    g.fillText(leg.name, (X(leg.at) + X(leg.end)) / 2, 30);
    g.textAlign = "left";
  }
}

function timeMarks(g, X) {
  for (const path of MISSION.follows) stroke(g, [[X(path.at), 35], [X(path.at), 42]], "#444", 1);
  for (const route of MISSION.routes) {
    g.beginPath();
    for (const [dx, y] of [[0, 17], [-5, 7], [5, 7]]) g.lineTo(X(route.at) + dx, y);
    g.closePath();
    paint(g, route.adopted ? ORANGE : "#fff", ORANGE, 1.2);
  }
}

// ---------------------------------------------------------------- words

const REASONS = {
  "start": "The mission starts",
  "waypoint": "At the waypoint, on time",
  "leg late": "The leg took longer than expected",
  "leg dropped": "The leg was given up on the way",
  "projected late": "The leg was seen to end late",
  "sonar lost": "The sonar was lost",
};
const clock = s => Math.floor(s / 3600) + ":" + String(Math.floor(s / 60) % 60).padStart(2, "0") + ":" + String(Math.floor(s % 60)).padStart(2, "0");
const spell = s => {
  const minutes = Math.round(s / 60);
  return minutes >= 120 ? Math.floor(minutes / 60) + " h " + minutes % 60 + " min" : s >= 120 ? minutes + " min" : s.toFixed(0) + " s";
};

/** Which waypoints a new route takes in and which it gives up, in words. */
function changes(route) {
  const before = MISSION.routes[MISSION.routes.indexOf(route) - 1] || { route: [] }, passed = momentAt(route.at).visited;
  const names = (some, others) => some.filter(k => MISSION.nodes[k] && !others.includes(k) && !passed.has(k)).map(k => MISSION.nodes[k][3]).join(", ");
  const gained = names(route.route, before.route), lost = names(before.route, route.route);
  return [gained && "takes in " + gained, lost && "gives up " + lost].filter(part => part).join(", ") || "the same waypoints";
}

/** One decision as a sentence. */
function sentence(route) {
  const why = REASONS[route.reason] || route.reason, many = route.route.length - 1;
  if (route.reason === "start") return `${why}: a first route of ${many} legs, ${spell(route.time)}.`;
  if (!route.adopted) return `${why}; nothing better: the route stays.`;
  return `${why}: new route of ${many} leg${many > 1 ? "s" : ""}, ${spell(route.time)}: ${changes(route)}.`;
}

function listDecisions(jump) {
  MISSION.routes.forEach(route => {
    const item = document.createElement("li"), when = document.createElement("b");
    when.textContent = clock(route.at) + " ";
    item.append(when, sentence(route));
    if (!route.adopted) item.className = "kept";
    item.tabIndex = 0;
    item.onclick = () => jump(route.at);
    item.onkeydown = event => { if (event.key === "Enter") jump(route.at); };
    byId("decisions").append(item);
  });
}

let marked = null;

/** Tells what happens at a moment and marks the decision in force. */
function tell({ time, here, leg, route }) {
  const paths = leg ? MISSION.follows.filter(f => f.at >= leg.at - 1 && f.at < leg.end && f.at <= time).length : 0;
  const over = time >= END - 1e-6;
  const parts = [over ? "The mission is over." : leg ? `Leg ${leg.name}, ${MISSION.legs.indexOf(leg) + 1} of ${MISSION.legs.length}: under way for ${spell(time - leg.at)} of ${spell(leg.expected)} expected.` : ""];
  if (leg && !over) {
    if (paths > 1) parts.push(`Path planned ${paths} times on this leg, as the sonar saw more and the sea changed.`);
    if (!leg.done) parts.push("This leg will be given up.");
  }
  if (route) parts.push(`Route in force since ${clock(route.at)}: ${route.names}.`);
  const tasks = MISSION.tasks.filter(task => task[0] <= time + 1e-6);
  parts.push(`Tasks done: ${tasks.length}, weight ${tasks.reduce((sum, task) => sum + task[1], 0).toFixed(1)}.`);
  byId("now").textContent = parts.filter(part => part).join(" ");
  const clear = rowAt(MISSION.clear, time);
  const utc = MISSION.launch === null ? "" : ", " + new Date(1000 * (MISSION.launch + time)).toISOString().slice(0, 19).replace("T", " ") + " UTC";
  byId("clock").textContent = clock(time) + " h" + utc + (here ? ", " + here[2].toFixed(0) + " m deep" : "") + (clear ? ", clear by " + (clear[1] < 500 ? clear[1].toFixed(0) : "500+") + " m" : "");
  if (route === marked) return;
  marked = route;
  const list = byId("decisions");
  [...list.children].forEach((item, k) => {
    item.classList.toggle("current", MISSION.routes[k] === route);
    item.classList.toggle("later", MISSION.routes[k].at > time);
    if (MISSION.routes[k] === route) list.scrollTop = item.offsetTop - 48;
  });
}

/** What each stroke and colour means. */
function fillLegend() {
  const icon = inner => `<svg width="24" height="14">${inner}</svg>`;
  const stripe = (colour, width, dash) => icon(`<path d="M1 7H23" stroke="${colour}" stroke-width="${width}" stroke-dasharray="${dash || ""}"/>`);
  const dot = (fill, edge, dash) => icon(`<circle cx="12" cy="7" r="5.5" fill="${fill}" stroke="${edge}" stroke-dasharray="${dash || ""}"/>`);
  const dart = fill => icon(`<path d="M21 7L4 1L8 7L4 13Z" fill="${fill}" stroke="${INK}"/>`);
  const used = new Set(MISSION.obstacles.map(obstacle => obstacle.kind));
  const rows = [
    [dart(YELLOW), "vehicle"],
    [stripe(BLUE, 3), "flown"],
    [stripe(ORANGE, 2, "5 4"), "path planned now"],
    [stripe(INK, 2, "6 4"), "route planned now"],
    [stripe("#777", 1.5, "2 4"), "planned once, dropped"],
    [stripe(GREEN, 5), "leg done"],
    [icon(`<rect x="7" y="2" width="10" height="10" fill="${YELLOW}" stroke="${INK}"/>`), "start, destination"],
    [dot(INK, INK), "waypoint visited"],
    [dot("#fff", INK), "waypoint"],
    ...Object.keys(KINDS).filter(kind => used.has(kind)).map(kind => [kind === "ship" ? dart(INK) : dot(KINDS[kind].colour, "#333", KINDS[kind].dash.join(" ")), KINDS[kind].name]),
    ...(MISSION.predicted.length ? [[dot("none", INK, "4 3"), "predicted, with clearance"], [dot("none", INK, "1 3"), "predicted in 5 min"]] : []),
    [dot("none", BLUE, "4 3"), `sonar range ${MISSION.sonar} m`],
    ...["keep out", "keep in"].filter(kind => FENCES.some(fence => fence.kind === kind)).map(kind => [icon(kind === "keep out" ? `<rect x="2" y="2" width="20" height="10" fill="${ORANGE}" fill-opacity=".18" stroke="${ORANGE}"/>` : `<rect x="2" y="2" width="20" height="10" fill="none" stroke="${GREEN}" stroke-width="1.4" stroke-dasharray="4 3"/>`), kind + (FENCES.some(fence => fence.kind === kind && (fence.holds[0] > -1e8 || fence.holds[1] < 1e8)) ? " (faint: not now)" : "")]),
    ...(TERRAIN && TERRAIN.depths.some(depth => depth <= SHORE) ? [[icon(`<rect x="2" y="2" width="20" height="10" fill="rgb(${bedColour(0)})"/>`), "land"]] : []),
    ...(TERRAIN ? [[icon(`<rect x="1" y="2" width="11" height="10" fill="rgb(${bedColour(1)})"/><rect x="12" y="2" width="11" height="10" fill="rgb(${bedColour(DEEPEST)})"/>`), `sea bed, a shade every ${SHADE_STEP} m to ${DEEPEST.toFixed(0)} m`]] : []),
  ];
  if (MISSION.obstacles.length) rows.push(["", "Obstacles have their true size; in 3-D balls are stretched as the heights are."]);
  byId("legend").innerHTML = rows.map(([sign, words]) => `<span>${sign}${words}</span>`).join("");
}
