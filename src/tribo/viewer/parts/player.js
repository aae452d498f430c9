// The page: time, controls and what follows from them.

const SECONDS = 12; // that a run takes at speed 1

function startPage() {
  const element = (name) => document.getElementById(name);
  const run = readRun(JSON.parse(element("data").textContent));
  const [first, last] = [run.times[0], run.times[run.times.length - 1]];
  const drawScene = makeDrawing(run, element("scene"));
  const curves = makeCurves(run, element("curves"));
  let t = first;
  let pointed = null; // the time under the pointer
  let playing = false;
  let before = 0; // when the last picture was drawn
  let waiting = false;
  let group = run.groups[0];
  let fill = null;

  function show() {
    waiting = false;
    drawScene(t, element("arrows").checked);
    curves.draw(group.curves.filter((curve) => curve.drawn), t, pointed);
    const sample = indexAt(run.times, pointed ?? t);
    fill(sample);
    element("when").textContent = `t = ${shown(run.times[sample])}`;
    element("clock").textContent = `t = ${shown(t)}`;
    element("time").value = t;
    element("time").setAttribute("aria-valuetext", `t = ${shown(t)}`);
  }

  function update() {
    if (!waiting) {
      waiting = true;
      requestAnimationFrame(show);
    }
  }

  function speak() {
    const values = group.curves.filter((curve) => curve.drawn);
    const sample = indexAt(run.times, t);
    const said = values.map((curve) => `${curve.name} ${shown(curve.values[sample])}`).join(", ");
    element("spoken").textContent = `t = ${shown(run.times[sample])}; ${group.name}: ${said}`;
  }

  function setTime(value) {
    t = Math.min(Math.max(value, first), last);
    update();
  }

  function step(now) {
    if (!playing) return;
    const speed = Number(element("speed").value);
    setTime(t + ((now - before) / 1000) * speed * ((last - first) / SECONDS));
    before = now;
    if (t >= last) setPlaying(false);
    else requestAnimationFrame(step);
  }

  function setPlaying(value) {
    playing = value;
    element("play").textContent = playing ? "Pause" : "Play";
    element("play").setAttribute("aria-pressed", String(playing));
    if (!playing) {
      speak();
      return;
    }
    if (t >= last) t = first;
    requestAnimationFrame((now) => {
      before = now;
      step(now);
    });
  }

  function stepBy(samples) {
    setPlaying(false);
    const sample = indexAt(run.times, t) + samples;
    setTime(run.times[Math.min(Math.max(sample, 0), run.times.length - 1)]);
    speak();
  }

  function choose(index) {
    group = run.groups[index];
    fill = makeTable(element("values"), group.curves, update);
    update();
  }

  const keys = {
    " ": () => setPlaying(!playing),
    ArrowLeft: () => stepBy(-1),
    ArrowRight: () => stepBy(1),
    Home: () => setTime(first),
    End: () => setTime(last),
  };
  document.addEventListener("keydown", (event) => {
    const own = event.target.closest("button, select, input[type=checkbox]");
    if (own || event.ctrlKey || event.altKey || event.metaKey || !(event.key in keys)) return;
    event.preventDefault();
    keys[event.key]();
  });
  element("play").addEventListener("click", () => setPlaying(!playing));
  element("time").addEventListener("input", (event) => {
    setPlaying(false);
    setTime(Number(event.target.value));
  });
  element("arrows").addEventListener("change", update);
  element("group").addEventListener("change", (event) => choose(event.target.selectedIndex));
  element("curves").addEventListener("pointermove", (event) => {
    pointed = curves.timeAt(event.offsetX);
    update();
  });
  element("curves").addEventListener("pointerleave", () => {
    pointed = null;
    update();
  });
  element("curves").addEventListener("click", (event) => setTime(curves.timeAt(event.offsetX)));
  window.addEventListener("resize", update);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", update);

  element("time").min = first;
  element("time").max = last;
  element("summary").textContent = `${run.status} at t = ${shown(last)}, ${run.method}, ${run.accuracy}`;
  element("scene").setAttribute(
    "aria-label",
    `Asperites of ${run.surfaces.map((s) => `${s.name} (${s.count})`).join(" and ")} in motion`,
  );
  element("arrows").closest("label").hidden = run.forces === null;
  for (const { name } of run.groups) element("group").add(new Option(name));
  for (const note of run.notes) {
    const item = document.createElement("li");
    item.textContent = note;
    element("notes").append(item);
  }
  choose(0);
}

startPage();
