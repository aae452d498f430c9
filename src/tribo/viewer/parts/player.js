// The player: an element with the motion, the curves and the values of a run, and its controls.

const SECONDS = 12; // that a run takes at speed 1
const BODY = `
<header><h1 data-part="title"></h1><p data-part="summary"></p><p class="sentence" data-part="sentence"></p></header>
<div class="sliders" role="group" aria-label="Values of the scene" data-part="sliders" hidden></div>
<p class="error" role="alert" data-part="error" hidden></p>
<section class="motion" aria-label="Motion">
  <div class="scenes">
    <figure><canvas role="img" data-part="scene"></canvas><figcaption data-part="caption" hidden></figcaption></figure>
    <figure data-part="kept" hidden><canvas role="img" data-part="keptScene"></canvas><figcaption data-part="keptCaption"></figcaption></figure>
  </div>
  <div class="controls" role="group" aria-label="Playback">
    <button type="button" aria-pressed="false" data-part="play">Play</button>
    <input type="range" min="0" step="any" aria-label="Time" data-part="time">
    <output data-part="clock"></output>
    <label>Speed <select data-part="speed">
      <option value="0.25">¼ ×</option><option value="0.5">½ ×</option><option value="1" selected>1 ×</option>
      <option value="2">2 ×</option><option value="4">4 ×</option>
    </select></label>
    <label class="tick"><input type="checkbox" checked data-part="forces"> Forces</label>
    <label class="tick"><input type="checkbox" data-part="traces"> Traces</label>
    <label class="tick"><input type="checkbox" data-part="displacements"> Displacements</label>
    <button type="button" aria-pressed="false" data-part="keep">Keep beside</button>
  </div>
</section>
<section class="ledger" aria-label="Work and energy">
  <label class="tabs">Works and energies of <select data-part="group"></select></label>
  <canvas class="curves" role="img" data-part="curves"></canvas>
  <div class="table"><table>
    <thead><tr><th scope="col">Quantity</th><th scope="col">Meaning</th><th scope="col" data-part="when"></th><th scope="col" data-part="keptWhen" hidden></th></tr></thead>
    <tbody data-part="values"></tbody>
  </table></div>
</section>
<p class="hidden" aria-live="polite" data-part="spoken"></p>
<footer>
  <p>Space: play or pause. Left and right arrow: one sample back or on. Home, End: the start, the end; on a slider of a value its least and largest.
  Dashed curves are pseudoworks, which the motion of the centre of mass (red dot) determines.
  Values are those of the nearest recorded sample, in the units of the scene.</p>
  <ul data-part="notes"></ul>
</footer>`;

// Shows runs in an element.  `source` has `run` (the first), `sliders`, `ask` (see sources.js),
// `beside` (a run to show beside it, if any) and `isPage` (whether the element is a page of its own).
function mount(element, source) {
  element.classList.add("tribo");
  element.innerHTML = BODY;
  const part = (name) => element.querySelector(`[data-part=${name}]`);
  const values = Object.fromEntries(source.sliders.map(({ key, value }) => [key, value]));
  const first = { ...values };
  const force = { size: 0 }; // of the arrows in both drawings
  const drawScene = makeDrawing(part("scene"), force);
  const drawKept = makeDrawing(part("keptScene"), force);
  const curves = makeCurves(part("curves"));
  const drawn = new Map();
  let run = null;
  let answered = values; // the values of the run
  let kept = null; // a run shown beside, and its values
  let t = null;
  let pointed = null; // the time under the pointer
  let playing = false;
  let before = 0; // when the last picture was drawn
  let waiting = false;
  let groupName = null;
  let fill = null;
  let rows = null; // the names of the curves in the table

  const groupIn = (one) => one.groups.find(({ name }) => name === groupName) ?? { curves: [] };
  const named = (those) => Object.entries(those).map(([key, value]) => `${key} = ${shownValue(value)}`).join(", ");

  function show() {
    waiting = false;
    const shown = Object.fromEntries(["forces", "traces", "displacements"].map((name) => [name, part(name).checked]));
    const now = Math.min(t, run.last);
    drawScene(run, now, shown);
    if (kept) drawKept(kept.run, Math.min(t, kept.run.last), shown);
    const all = kept ? [run, kept.run] : [run];
    const columns = all.map((one) => ({
      run: one,
      t: Math.min(t, one.last),
      curves: groupIn(one).curves,
      sample: nearestTo(one.times, Math.min(pointed ?? t, one.last)),
    }));
    curves.draw(columns.map((one) => ({ ...one, curves: one.curves.filter(({ name }) => drawn.get(name)) })), pointed);
    fill(columns);
    const when = (column) => `t = ${shownNumber(column.run.times[column.sample])}`;
    part("when").textContent = when(columns[0]);
    part("keptWhen").textContent = kept ? `beside: ${when(columns[1])}` : "";
    part("clock").textContent = `t = ${shownNumber(now)}`;
    part("time").value = now;
    part("time").setAttribute("aria-valuetext", `t = ${shownNumber(now)}`);
    element.dispatchEvent(new CustomEvent("tribo-shown", { detail: answered }));
  }

  function update() {
    if (!waiting) {
      waiting = true;
      requestAnimationFrame(show);
    }
  }

  function point(time) {
    pointed = time;
    update();
  }

  function speak() {
    const sample = nearestTo(run.times, t);
    const said = groupIn(run).curves.filter(({ name }) => drawn.get(name))
      .map(({ meaning, values: each }) => `${meaning} ${shownNumber(each[sample])}`).join(", ");
    part("spoken").textContent = `t = ${shownNumber(run.times[sample])}; ${groupName}: ${said}`;
  }

  const end = () => Math.max(run.last, kept ? kept.run.last : run.last);

  function setTime(value) {
    t = Math.min(Math.max(value, run.first), end());
    update();
  }

  function step(now) {
    if (!playing || !element.isConnected) return;
    const speed = Number(part("speed").value);
    setTime(t + ((now - before) / 1000) * speed * ((end() - run.first) / SECONDS));
    before = now;
    if (t >= end()) setPlaying(false);
    else requestAnimationFrame(step);
  }

  function setPlaying(value) {
    playing = value;
    part("play").textContent = playing ? "Pause" : "Play";
    part("play").setAttribute("aria-pressed", String(playing));
    if (!playing) {
      speak();
      return;
    }
    if (t >= end()) t = run.first;
    requestAnimationFrame((now) => {
      before = now;
      step(now);
    });
  }

  function goTo(value) {
    setPlaying(false);
    setTime(value);
    speak();
  }

  function stepBy(samples) {
    const sample = nearestTo(run.times, t) + samples;
    goTo(run.times[Math.min(Math.max(sample, 0), run.times.length - 1)]);
  }

  function choose(name) {
    groupName = name;
    const { curves: own } = groupIn(run);
    for (const curve of own) if (!drawn.has(curve.name)) drawn.set(curve.name, curve.drawn);
    const wanted = own.map(({ name: each }) => each).join();
    if (wanted !== rows) fill = makeTable(part("values"), own, drawn, update);
    rows = wanted;
    update();
  }

  // Shows another run, at the same time and with the same curves.
  function setRun(data, those) {
    const former = run;
    run = readRun(data);
    answered = those;
    t = former === null ? run.first : Math.min(t, end());
    part("time").min = run.first;
    part("time").max = end();
    const isChanged = Object.keys(first).some((key) => those[key] !== first[key]);
    part("title").textContent = run.title + (isChanged ? ", with other values" : "");
    part("summary").textContent = `${run.status} at t = ${shownNumber(run.last)}, ${run.method}, ${run.accuracy}`;
    part("sentence").textContent = run.sentence;
    part("error").hidden = true;
    part("caption").textContent = source.name ?? named(those);
    part("forces").closest("label").hidden = run.forces.length === 0;
    const names = run.surfaces.map(({ name, count }) => `${name} (${count})`).join(" and ");
    part("scene").setAttribute("aria-label", `Asperites of ${names} in motion. ${run.sentence}`);
    part("curves").setAttribute("aria-label", `Works and energies over time; the table has the values`);
    part("notes").replaceChildren(...run.notes.map((note) => {
      const item = document.createElement("li");
      item.textContent = note;
      return item;
    }));
    part("notes").hidden = run.notes.length === 0;
    const groups = run.groups.map(({ name }) => name);
    if (former === null || groups.join() !== former.groups.map(({ name }) => name).join()) {
      part("group").replaceChildren(...groups.map((name) => new Option(name)));
      choose(groups[0]);
    } else {
      choose(groupName);
    }
  }

  function setKept(one) {
    kept = one;
    part("kept").hidden = kept === null;
    part("values").closest("section").classList.toggle("two", kept !== null);
    part("keptWhen").hidden = kept === null;
    part("caption").hidden = kept === null;
    part("keep").textContent = kept === null ? "Keep beside" : "Remove kept run";
    part("keep").setAttribute("aria-pressed", String(kept !== null));
    if (kept !== null) {
      part("keptCaption").textContent = kept.name;
      part("keptScene").setAttribute("aria-label", `The run beside: ${kept.name}`);
    }
    part("time").max = end();
    update();
  }

  const request = oneAtATime(source.ask, setRun, (error) => {
    part("error").textContent = error.message;
    part("error").hidden = false;
  });

  const keys = {
    " ": () => setPlaying(!playing),
    ArrowLeft: () => stepBy(-1),
    ArrowRight: () => stepBy(1),
    Home: () => goTo(run.first),
    End: () => goTo(end()),
  };
  (source.isPage ? document : element).addEventListener("keydown", (event) => {
    const isEnd = event.key === "Home" || event.key === "End"; // of the time, but for sliders of values
    const isValue = event.target.matches?.("input[data-key]");
    const plays = event.key === " " && isValue; // a slider has no use for the space bar
    const isControl = event.target.closest?.("button, select, input[type=checkbox], [data-key]");
    const isOwn = isControl && !plays && (!isEnd || isValue);
    if (isOwn || event.ctrlKey || event.altKey || event.metaKey || !(event.key in keys)) return;
    event.preventDefault();
    event.stopPropagation();
    keys[event.key]();
  });
  part("play").addEventListener("click", () => setPlaying(!playing));
  part("keep").addEventListener("click", () => setKept(kept === null ? { run, name: `kept: ${named(answered)}` } : null));
  part("time").addEventListener("input", (event) => {
    setPlaying(false);
    setTime(Number(event.target.value));
  });
  for (const name of ["forces", "traces", "displacements"]) part(name).addEventListener("change", update);
  part("group").addEventListener("change", (event) => choose(event.target.value));
  part("curves").addEventListener("pointermove", (event) => point(curves.timeAt(event.offsetX)));
  part("curves").addEventListener("pointerleave", () => point(null));
  part("curves").addEventListener("click", (event) => setTime(curves.timeAt(event.offsetX)));
  new ResizeObserver(() => {
    update();
    if (source.isPage) tellHeight();
  }).observe(element);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", update);

  part("sliders").hidden = source.sliders.length === 0;
  part("keep").hidden = source.sliders.length === 0;
  part("sliders").append(...source.sliders.map((slider) => makeSlider(slider, (key, value) => {
    values[key] = value;
    request({ ...values });
  })));
  setRun(source.run, { ...values });
  if (source.beside) setKept({ ...source.beside, run: readRun(source.beside.run) });
}

const render = ({ model, el }) => mount(el, modelRuns(model));
