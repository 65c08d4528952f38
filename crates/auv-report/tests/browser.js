// Hands on the replay page: opens, scrubs, plays, pauses, turns it to three dimensions, and leaves in
// the document what it saw.
(async () => {
  const frame = () => new Promise(done => setTimeout(done, 50));
  const pictures = new Set(), seen = {};
  const look = name => {
    pictures.add(byId("map").toDataURL());
    seen[name] = { time: state.time, clock: byId("clock").value, label: byId("play").textContent };
  };
  await frame();
  look("opened");
  byId("scrub").value = Math.round(END / 2);
  byId("scrub").dispatchEvent(new Event("input"));
  await frame();
  look("scrubbed");
  byId("play").click();
  for (let k = 0; k < 10; k++) await frame();
  look("playing");
  byId("play").click();
  await frame();
  look("paused");
  await frame();
  look("still");
  byId("solid").click();
  await frame();
  look("solid");
  document.documentElement.dataset.seen = JSON.stringify({ ...seen, end: END, pictures: pictures.size });
})();
