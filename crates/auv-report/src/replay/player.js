// Time, and the user's input.

const state = { time: 0, playing: false, solid: false, follow: false };
const HINTS = { plan: "drag to move, wheel to zoom", solid: "drag to turn, shift-drag to move, wheel to zoom" };
const camera = () => state.solid ? CAMERAS.solid : CAMERAS.plan;

function mapHeight() {
  const width = byId("map").clientWidth, shape = (NORTH1 - NORTH0) / (EAST1 - EAST0);
  return Math.round(Math.min(width * Math.min(Math.max(shape, .6), 1.1), Math.max(280, window.innerHeight - 285)));
}

/** Where the charts stand beside the map, they fill the height of the window. */
function chartHeight() {
  return window.innerWidth > 760 ? Math.round(Math.max(70, Math.min(150, (window.innerHeight - 555) / 3))) : 92;
}

function draw() {
  const moment = momentAt(state.time), height = mapHeight();
  if (state.follow && moment.here) camera().target = [...moment.here];
  drawMap(moment, camera(), height);
  drawCharts(moment);
  tell(moment);
  byId("scrub").value = state.time;
}

let waiting = false;
/** Draws once before the next frame, however often it is asked for. */
function redraw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; draw(); });
}

function go(time) {
  state.time = Math.max(0, Math.min(END, time));
  redraw();
}

function play(on) {
  state.playing = on;
  byId("play").textContent = on ? "Pause" : "Play";
  if (!on) return;
  if (state.time >= END) state.time = 0;
  let last = performance.now();
  const tick = now => {
    if (!state.playing) return;
    state.time = Math.min(END, state.time + Math.max(0, now - last) / 1000 * +byId("speed").value);
    last = now;
    draw();
    if (state.time >= END) play(false); else requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
}

function show(solid) {
  state.solid = solid;
  byId("plan").setAttribute("aria-pressed", !solid);
  byId("solid").setAttribute("aria-pressed", solid);
  byId("stretch").hidden = !solid;
  byId("hint").textContent = solid ? HINTS.solid : HINTS.plan;
  if (state.follow) follow(true); else redraw();
}

/** Keeps the vehicle in the middle; from the whole map it comes near. */
function follow(on) {
  state.follow = on;
  byId("follow").setAttribute("aria-pressed", on);
  if (on && camera().whole) {
    camera().whole = false;
    camera().scale = Math.max(camera().scale, Math.min(byId("map").clientWidth, mapHeight()) / (12 * Math.max(MISSION.sonar, 20)));
  }
  redraw();
}

function reset() {
  camera().reset();
  follow(false);
}

/** Drag, pinch, wheel and double click on the map. */
function handle(map) {
  const fingers = new Map(), place = event => [event.offsetX, event.offsetY];
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, Math.max(1, Math.hypot(a[0] - b[0], a[1] - b[1]))];
  };
  const move = (dx, dy) => { if (!state.follow) { camera().whole = false; camera().pan(dx, dy); } };
  map.onpointerdown = event => {
    map.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, place(event));
  };
  map.onpointermove = event => {
    if (!fingers.has(event.pointerId)) return;
    const old = fingers.get(event.pointerId), now = place(event);
    const before = fingers.size === 2 ? spread() : null;
    fingers.set(event.pointerId, now);
    const [dx, dy] = [now[0] - old[0], now[1] - old[1]];
    if (before) {
      const after = spread();
      camera().zoom(after[2] / before[2], after[0], after[1]);
      move(after[0] - before[0], after[1] - before[1]);
    } else if (fingers.size === 1) {
      if (state.solid && !event.shiftKey) camera().turn(dx, dy); else move(dx, dy);
    }
    redraw();
  };
  map.onpointerup = map.onpointercancel = event => fingers.delete(event.pointerId);
  map.addEventListener("wheel", event => {
    event.preventDefault();
    camera().zoom(Math.exp(-.0015 * event.deltaY), ...place(event));
    redraw();
  }, { passive: false });
  map.ondblclick = reset;
}

function key(event) {
  const element = event.target.tagName;
  if (event.key === " " && element !== "BUTTON" && element !== "SELECT") play(!state.playing);
  else if (element === "SELECT" || element === "INPUT") return;
  else if (event.key === "ArrowRight") go(state.time + 30);
  else if (event.key === "ArrowLeft") go(state.time - 30);
  else if (event.key === "3") show(!state.solid);
  else if (event.key === "f") follow(!state.follow);
  else if ("+=-".includes(event.key)) {
    camera().zoom(event.key === "-" ? .8 : 1.25, byId("map").clientWidth / 2, mapHeight() / 2);
    redraw();
  }
  else return;
  event.preventDefault();
}

function begin() {
  byId("title").textContent = document.title = MISSION.title;
  byId("subtitle").textContent = MISSION.subtitle.replace(/(\d+) s\b/g, (_, s) => clock(+s) + " h");
  byId("ground").hidden = !MISSION.floor;
  byId("unit").textContent = LONG ? "h" : "min";
  byId("notes").textContent = MISSION.notes + " Keys: space plays, arrows step 30 s, 3 turns to three dimensions and back, + and - zoom, f follows the vehicle.";
  byId("scrub").max = Math.ceil(END);
  // By default a mission plays in half a minute to two minutes.
  byId("speed").value = [960, 240, 60, 10].find(speed => END / speed >= 30) || 10;
  const times = byId("times");
  for (const factor of [1, 2, 5, 10, 20, 50]) times.add(new Option(factor + " x", factor, false, factor === CAMERAS.solid.times));
  times.onchange = () => { CAMERAS.solid.times = +times.value; redraw(); };
  fillLegend();
  listDecisions(go);
  handle(byId("map"));
  byId("plan").onclick = () => show(false);
  byId("solid").onclick = () => show(true);
  byId("follow").onclick = () => follow(!state.follow);
  byId("reset").onclick = reset;
  byId("play").onclick = () => play(!state.playing);
  byId("scrub").oninput = () => go(+byId("scrub").value);
  for (const id of ["legs", "depth", "budget", "clear"]) byId(id).onpointerdown = byId(id).onpointermove = event => { if (event.buttons) go(timeAt(event.offsetX, byId(id).clientWidth)); };
  document.onkeydown = key;
  window.onresize = redraw;
  const wanted = /t=([0-9.]+)/.exec(location.hash);
  if (wanted) state.time = Math.min(END, +wanted[1]);
  show(/view=3d/.test(location.hash));
}

begin();
