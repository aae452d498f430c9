// The page: drawing, curves, controls and panels of a scene that the page itself simulates.

const SECONDS = 10; // that a run takes at speed 1
const STEPS = 200; // of a slider
const BODY = `
<header><h1 data-part="title"></h1><p class="status" role="status" data-part="status"></p></header>
<div class="introduction" data-part="introduction" hidden></div>
<section class="motion" aria-label="Motion">
  <div class="scenes">
    <figure><canvas role="img" aria-label="The asperites" data-part="scene"></canvas></figure>
    <figure data-part="keptFigure" hidden><canvas role="img" aria-label="The kept state" data-part="keptScene"></canvas><figcaption data-part="keptName"></figcaption></figure>
  </div>
  <div class="playback" role="group" aria-label="Playback">
    <button type="button" aria-pressed="false" data-part="play">Play</button>
    <input type="range" min="0" step="any" aria-label="Time" data-part="time">
    <output data-part="clock"></output>
    <label><input type="checkbox" checked data-part="forces"> Forces</label>
    <label><input type="checkbox" data-part="velocities"> Velocities</label>
    <label><input type="checkbox" data-part="traces"> Traces</label>
    <button type="button" data-part="mark" title="Displacements are measured from the present time">Mark</button>
    <button type="button" aria-pressed="false" data-part="keep">Keep beside</button>
  </div>
  <p class="marked" data-part="marked" hidden></p>
</section>
<section class="graph" aria-label="Curves">
  <canvas role="img" aria-label="Works over time" class="curves" data-part="curves"></canvas>
  <div class="choices"><label>Of <select data-part="group"></select></label><span data-part="drawn"></span></div>
</section>
<section class="values" aria-label="Values of the scene">
  <div data-part="sliders"></div>
  <div class="buttons"><button type="button" data-part="reset">Reset</button></div>
  <details data-part="every"><summary>All values</summary><div data-part="all"></div></details>
</section>
<section class="panel" aria-label="Results">
  <div class="tabs" role="tablist" data-part="tabs"></div>
  <div role="tabpanel" tabindex="0" data-part="endPanel" data-tab="End value">
    <label>End of <select data-part="endQuantity"></select></label> <label>against <select data-part="endKey"></select></label> <label>and <select data-part="endSecond"><option value="">no other</option></select></label>
    <canvas class="end" role="img" aria-label="End value against a control" data-part="end"></canvas>
    <label><input type="checkbox" checked data-part="lengthen"> each run until the bobs have passed</label>
  </div>
  <div role="tabpanel" tabindex="0" data-part="energyPanel" data-tab="Energy" hidden>
    <p>Change since the start, both surfaces. The energies add up to the work put in.</p>
    <canvas class="bars" role="img" aria-label="Energies" data-part="energy"></canvas>
    <p>Power on <select aria-label="Surface" data-part="powerSurface"></select> now: at the point where the force acts, and at the velocity of the centre of mass.</p>
    <canvas class="powers" role="img" aria-label="Powers" data-part="power"></canvas>
  </div>
  <div role="tabpanel" tabindex="0" data-part="numbersPanel" data-tab="Numbers" hidden>
    <label class="observer">Observer’s velocity <input type="range" min="-1" max="1" step="0.01" value="0" data-part="observer"> <output data-part="observerShown">0</output></label>
    <div class="scroll"><table><thead><tr><th scope="col">Quantity</th><th scope="col" data-part="now"></th><th scope="col">at the end</th><th scope="col">error up to</th></tr></thead><tbody data-part="table"></tbody></table></div>
  </div>
  <div role="tabpanel" tabindex="0" data-part="startsPanel" data-tab="Many starts" hidden>
    <label>Starts <select data-part="startsKind"><option value="temperature">in thermal equilibrium</option><option value="amplitude">with swings of equal energy</option></select></label>
    <label><span data-part="startsLabel"></span> <input type="range" min="0.02" max="2" step="0.02" value="1" data-part="amplitude"> <output data-part="amplitudeShown">1</output></label>
    <label>Histogram of <select data-part="startsQuantity"><option value="delta_e_int">energy gained by both swings</option></select></label>
    <p data-part="startsSentence"></p>
    <canvas class="starts" role="img" aria-label="Histogram of works" data-part="starts"></canvas>
    <button type="button" data-part="more">Start</button> <label><input type="checkbox" data-part="mirrored"> reflected at zero</label>
  </div>
  <div role="tabpanel" tabindex="0" data-part="filesPanel" data-tab="Files" hidden>
    <p class="buttons"><button type="button" data-part="csv">CSV</button> <button type="button" data-part="png">PNG</button> <button type="button" data-part="toml">Scene (TOML)</button></p>
    <p>The same numbers in Python:</p><pre tabindex="0" data-part="python"></pre>
    <p>The address of this page holds the values: <a data-part="link">this state</a></p>
  </div>
</section>
<footer><p>Space: play or pause. Arrow keys: one sample back or on. Before the start, drag a bob to swing it or a bar to move it. Dashed curves are pseudoworks. Units are those of the scene.</p><div data-part="questions" hidden></div></footer>`;

// Text of a control's value.
const shownValue = (value) => (typeof value === "number" ? String(Number(value.toPrecision(5))).replace("-", "−") : value);

// A few forms of Markdown: paragraphs, lists, emphasis, in elements of the page.
function addMarkdown(element, text) {
  for (const block of text.split(/\n\s*\n/)) {
    const lines = block.trim().split("\n");
    const isList = lines.every((line) => /^(-|\d+\.)\s/.test(line));
    const outer = document.createElement(isList ? (/^\d/.test(lines[0]) ? "ol" : "ul") : "p");
    for (const line of isList ? lines : [lines.join(" ")]) {
      const inner = isList ? outer.appendChild(document.createElement("li")) : outer;
      line.replace(isList ? /^(-|\d+\.)\s+/ : /^$/, "").split(/(\*\*.+?\*\*|\*.+?\*)/).forEach((piece) => {
        const found = /^(\*\*?)(.+)\1$/.exec(piece);
        if (!found) inner.append(piece);
        else inner.appendChild(document.createElement(found[1] === "**" ? "strong" : "em")).textContent = found[2];
      });
    }
    element.append(outer);
  }
}

async function startPage(element, source) {
  element.classList.add("tribo", "live");
  element.innerHTML = BODY;
  const part = (name) => element.querySelector(`[data-part=${name}]`);
  part("title").textContent = source.title;
  for (const name of ["introduction", "questions"]) {
    if (!source[name]) continue;
    addMarkdown(part(name), source[name]);
    part(name).hidden = false;
  }
  let machine;
  try {
    machine = await startMachine(source);
  } catch (error) {
    element.classList.add("stopped");
    part("status").textContent = `This page cannot simulate here, and shows works of the run of its file. ${error.message}`;
    part("scene").outerHTML = source.picture;
    return null;
  }
  const program = makeProgram(machine, source, source.samples);
  const short = makeProgram(machine, source, 2);
  const state = makeState(source);
  const force = { size: 0 }; // of all arrows in the page
  const speed = { size: 0 };
  const drawScene = makeDrawing(part("scene"), force, speed);
  const drawKept = makeDrawing(part("keptScene"), force, speed);
  const curves = makeCurves(part("curves"));
  const drawn = new Set(["w1", "w1_ps", "w2", "w2_ps", "total_energy_change", "applied_work"]);
  const widgets = [];
  let run = null;
  let kept = null;
  let t = 0;
  let playing = false;
  let before = 0;
  let waiting = false;
  let marked = null;
  let group = source.surfaces[0].name;
  let observer = 0;
  let view = null;

  const withObserver = (numbers) => {
    numbers[source.observer] = observer;
    return numbers;
  };

  function simulate(numbers) {
    const result = program(withObserver(numbers.slice()), { estimate: true });
    return { ...runOf(source, state, result), source };
  }

  function setStatus() {
    const isChanged = Object.keys(state.changes()).length > 0;
    part("title").textContent = source.title + (isChanged ? ", with other values" : "");
    const { code, passed, needed, reached, samples } = run.result;
    const worst = Math.max(run.result.errors[source.names.asperite.indexOf("w1")], run.result.errors[source.names.asperite.length + source.names.asperite.indexOf("w1")]);
    const status = part("status");
    status.classList.toggle("bad", code !== 0 || !passed);
    if (code !== 0) {
      status.textContent = `The run stops at t = ${shownShort(run.last)}: ${source.statuses[code] ?? "it takes too many steps"}.`;
    } else if (!passed && reached === samples) {
      status.textContent = `The run ends at t = ${shownShort(run.last)}, before the bobs have passed each other: its works are not those of the encounter. `;
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = `Set duration to ${shownShort(roundUp(needed))}`;
      button.addEventListener("click", () => change({ duration: roundUp(needed) }));
      if (needed > 0 && needed > state.value("duration") * 1.001) status.append(button);
    } else {
      const w1 = run.tables.map((table) => table.w1[table.w1.length - 1]);
      const ps = run.tables.map((table) => table.w1_ps[table.w1_ps.length - 1]);
      const which = source.subject;
      status.textContent = `Work of friction on ${source.surfaces[which].name} ${shownShort(w1[which])}, pseudowork ${shownShort(ps[which])}, each to ±${shownError(worst)}. Run to t = ${shownShort(run.last)}.`;
    }
  }

  function resimulate() {
    run = simulate(state.numbers);
    t = Math.min(t, run.last);
    part("time").max = Math.max(run.last, kept ? kept.last : 0);
    setStatus();
    writeAddress(state);
    for (const widget of widgets) widget();
    for (const show of panels) show(true);
    update();
  }

  function change(values) {
    state.set(values);
    resimulate();
  }

  // ---- drawing

  function show() {
    waiting = false;
    const shown = { forces: part("forces").checked, velocities: part("velocities").checked, traces: part("traces").checked, displacements: false };
    view = drawScene(run, Math.min(t, run.last), shown);
    if (kept) drawKept(kept, Math.min(t, kept.last), shown);
    const index = run.groups.findIndex(({ name }) => name === group);
    const columns = (kept ? [run, kept] : [run]).map((each) => ({
      run: each,
      t: Math.min(t, each.last),
      curves: each.groups[index].curves.filter(({ name }) => drawn.has(name)),
    }));
    curves.draw(columns, null);
    part("clock").textContent = `t = ${shownShort(t)}`;
    part("time").value = t;
    part("time").setAttribute("aria-valuetext", `t = ${shownShort(t)}`);
    showMarked();
    for (const panel of panels) panel(false);
  }

  function update() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(show);
  }

  function showMarked() {
    part("marked").hidden = marked === null;
    if (marked === null) return;
    const [from, to] = [nearestTo(run.times, Math.min(marked, run.last)), nearestTo(run.times, t)];
    const said = source.surfaces.map(({ name }, index) => {
      const table = run.tables[index];
      const moved = (x) => shownShort(table[x][to] - table[x][from]);
      return `${name}: bar ${moved("x_bar")}, centre of mass ${moved("x_cm")}, bob ${moved("x_bob")}`;
    });
    part("marked").textContent = `Displacement along x since t = ${shownShort(run.times[from])}: ${said.join("; ")}.`;
  }

  // ---- time

  function setTime(value) {
    t = Math.min(Math.max(value, 0), Number(part("time").max));
    update();
  }

  function step(now) {
    if (!playing) return;
    setTime(t + ((now - before) / 1000) * (Number(part("time").max) / SECONDS));
    before = now;
    if (t >= Number(part("time").max)) setPlaying(false);
    else requestAnimationFrame(step);
  }

  function setPlaying(value) {
    playing = value;
    part("play").textContent = playing ? "Pause" : "Play";
    part("play").setAttribute("aria-pressed", String(playing));
    if (!playing) return;
    if (t >= Number(part("time").max)) t = 0;
    requestAnimationFrame((now) => {
      before = now;
      step(now);
    });
  }

  // ---- controls

  function addControl({ key, label, low, high }, into) {
    const choice = state.choices.get(key);
    const outer = document.createElement("label");
    outer.append(Object.assign(document.createElement("span"), { textContent: label, title: key }));
    if (choice) {
      const select = document.createElement("select");
      for (const word of Object.keys(choice.words)) select.add(new Option(word));
      select.dataset.key = key;
      select.addEventListener("change", () => change({ [key]: select.value }));
      widgets.push(() => { select.value = state.value(key); });
      outer.append(select);
    } else {
      const range = Object.assign(document.createElement("input"), { type: "range", min: low, max: high, step: (high - low) / STEPS });
      const field = Object.assign(document.createElement("input"), { type: "text", inputMode: "decimal" });
      field.setAttribute("aria-label", `${label}, as a number`);
      range.dataset.key = key;
      field.dataset.field = key;
      range.addEventListener("input", () => tryChange(key, snapped(Number(range.value), key), field));
      field.addEventListener("change", () => tryChange(key, Number(field.value.replace("−", "-")), field));
      widgets.push(() => {
        const value = state.value(key);
        if (document.activeElement !== range) range.value = value;
        range.setAttribute("aria-valuetext", shownValue(value));
        field.value = shownValue(value);
      });
      outer.append(range, field);
    }
    into.append(outer);
  }

  // The file's own value is among those of a slider.
  function snapped(value, key) {
    const own = source.keys.find((each) => each.key === key.replace("*.", `${source.surfaces[0].name}.`)).value;
    const control = source.controls.find((each) => each.key === key);
    const near = control ? (control.high - control.low) / STEPS : 0;
    return Math.abs(value - own) < 0.6 * near ? own : Number(value.toPrecision(6));
  }

  function tryChange(key, value, field) {
    try {
      change({ [key]: value });
      field.removeAttribute("aria-invalid");
    } catch (error) {
      field.setAttribute("aria-invalid", "true");
      part("status").textContent = error.message;
    }
  }

  for (const control of source.controls) addControl(control, part("sliders"));
  const shownKeys = new Set(source.controls.map(({ key }) => key));
  part("every").addEventListener("toggle", () => {
    if (part("all").childElementCount) return;
    const rest = [...source.choices, ...source.keys].filter(({ key }) => !shownKeys.has(key));
    for (const { key } of rest) addField(key);
    for (const widget of widgets) widget();
  });

  function addField(key) {
    const outer = document.createElement("label");
    outer.append(Object.assign(document.createElement("span"), { textContent: key }));
    if (state.choices.has(key)) {
      addControl({ key, label: key }, part("all"));
      return;
    }
    const field = Object.assign(document.createElement("input"), { type: "text", inputMode: "decimal" });
    field.dataset.field = key;
    field.addEventListener("change", () => tryChange(key, Number(field.value.replace("−", "-")), field));
    widgets.push(() => { field.value = shownValue(state.value(key)); });
    outer.append(field);
    part("all").append(outer);
  }

  // ---- panels: functions that show themselves; true after a new run

  const isOpen = (name) => !part(name).hidden;
  const panels = [];

  const tabs = [...element.querySelectorAll("[role=tabpanel]")];
  tabs.forEach((panel, k) => {
    const tab = Object.assign(document.createElement("button"), { type: "button", textContent: panel.dataset.tab });
    tab.setAttribute("role", "tab");
    tab.id = `tab${k}`;
    panel.setAttribute("aria-labelledby", tab.id);
    tab.addEventListener("click", () => openTab(k));
    tab.addEventListener("keydown", (event) => {
      const move = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!move) return;
      event.preventDefault();
      event.stopPropagation();
      openTab((k + move + tabs.length) % tabs.length, true);
    });
    part("tabs").append(tab);
  });

  function openTab(index, focus) {
    tabs.forEach((panel, k) => {
      panel.hidden = k !== index;
      const tab = part("tabs").children[k];
      tab.setAttribute("aria-selected", String(k === index));
      tab.tabIndex = k === index ? 0 : -1;
      if (focus && k === index) tab.focus();
    });
    if (run) {
      for (const panel of panels) panel(true);
      update();
    }
  }

  const showAll = () => panels.forEach((panel) => panel(true));
  const own = { part, source, state, isOpen, change, showAll, short, observed: withObserver, run: () => run };
  for (const make of [makeEndPanel, makeStartsPanel, makeFilesPanel]) panels.push(make(own));

  // Energies and powers.
  const scale = { energy: 0, power: 0 };
  source.surfaces.forEach(({ name }, index) => part("powerSurface").add(new Option(name, index)));
  part("powerSurface").value = source.subject;
  part("powerSurface").addEventListener("change", showAll);
  panels.push((isNew) => {
    if (!isOpen("energyPanel")) return;
    const surface = Number(part("powerSurface").value);
    if (isNew || !scale.energy) {
      scale.energy = roundUp(largestOf(run, (k) => energyRows(run, k)));
      scale.power = roundUp(largestOf(run, (k) => powerRows(run, surface, k)));
    }
    const k = nearestTo(run.times, t);
    drawBars(part("energy"), energyRows(run, k), scale.energy);
    drawBars(part("power"), powerRows(run, surface, k), scale.power);
  });

  // Numbers with their errors.
  const listed = ["w1", "w1_ps", "w2", "w2_ps", "wL", "wR", "w", "w_ps", "delta_k_trans", "delta_e_int", "theta", "omega", "x_cm", "x_bob", "x_bar", "vx_cm", "f1_x", "f1_y"];
  panels.push(() => {
    if (!isOpen("numbersPanel")) return;
    const index = Math.min(1, Math.max(0, source.surfaces.findIndex(({ name }) => name === group)));
    const table = run.tables[index];
    const errors = errorsOf(source, run.result, index);
    const [now, last] = [nearestTo(run.times, t), run.times.length - 1];
    part("now").textContent = `t = ${shownShort(run.times[now])}`;
    const rows = listed.map((name) => [name, table[name][now], table[name][last], errors[name]]);
    rows.splice(2, 0, ["w1 − w1_ps", table.w1[now] - table.w1_ps[now], table.w1[last] - table.w1_ps[last], errors.w1 + errors.w1_ps]);
    const body = part("table");
    body.replaceChildren(...rows.map(([name, ...values]) => {
      const row = document.createElement("tr");
      const head = document.createElement("th");
      head.scope = "row";
      head.title = source.meanings[name] ?? "work less pseudowork: the same for every observer";
      if (name in table) head.append(typeset(name));
      else head.append(typeset("w1"), " − ", typeset("w1_ps"));
      row.append(head, ...values.map((value, k) => Object.assign(document.createElement("td"), { textContent: k === 2 ? shownError(value) : shownNumber(value) })));
      return row;
    }));
  });
  part("observer").addEventListener("input", () => {
    observer = Number(part("observer").value);
    part("observerShown").textContent = shownShort(observer);
    resimulate();
  });

  // ---- the rest of the page

  for (const { name } of source.surfaces) part("group").add(new Option(name));
  part("group").add(new Option("system"));
  const offered = { surface: ["w1", "w1_ps", "w2", "w2_ps", "wL", "wR", "w", "delta_k_trans", "delta_e_int"], system: ["contact_energy", "total_energy_change", "applied_work"] };

  function offer() {
    part("drawn").replaceChildren(...offered[group === "system" ? "system" : "surface"].map((name) => {
      const label = document.createElement("label");
      const tick = Object.assign(document.createElement("input"), { type: "checkbox", checked: drawn.has(name) });
      label.title = source.meanings[name];
      label.append(tick, typeset(name));
      label.style.setProperty("--own", `var(--${colourName(name, 0)})`);
      tick.setAttribute("aria-label", `draw ${source.meanings[name]}`);
      tick.addEventListener("change", () => {
        if (tick.checked) drawn.add(name);
        else drawn.delete(name);
        update();
      });
      return label;
    }));
  }

  part("group").addEventListener("change", () => {
    group = part("group").value;
    offer();
    update();
  });
  part("group").value = group = source.surfaces[source.subject].name;
  offer();
  part("play").addEventListener("click", () => setPlaying(!playing));
  part("time").addEventListener("input", () => {
    setPlaying(false);
    setTime(Number(part("time").value));
  });
  for (const name of ["forces", "velocities", "traces"]) part(name).addEventListener("change", update);
  part("mark").addEventListener("click", () => {
    marked = marked === null ? t : null;
    part("mark").textContent = marked === null ? "Mark" : "Unmark";
    update();
  });
  part("keep").addEventListener("click", () => {
    kept = kept === null ? run : null;
    part("keep").textContent = kept === null ? "Keep beside" : "Remove kept";
    part("keep").setAttribute("aria-pressed", String(kept !== null));
    part("keptFigure").hidden = kept === null;
    const changed = Object.entries(state.changes()).map(([key, value]) => `${key} = ${shownValue(value)}`).join(", ");
    part("keptName").textContent = `kept: ${changed || "the values of the file"}`;
    part("time").max = Math.max(run.last, kept ? kept.last : 0);
    update();
  });
  part("reset").addEventListener("click", () => {
    state.reset();
    observer = 0;
    part("observer").value = 0;
    part("observerShown").textContent = "0";
    resimulate();
  });

  // Dragging: time on the curves; before the start a bob swings and a bar moves.
  part("curves").addEventListener("pointerdown", (event) => {
    part("curves").setPointerCapture(event.pointerId);
    setPlaying(false);
    setTime(curves.timeAt(event.offsetX));
  });
  part("curves").addEventListener("pointermove", (event) => {
    if (part("curves").hasPointerCapture(event.pointerId)) setTime(curves.timeAt(event.offsetX));
  });
  let dragged = null;
  const canvas = part("scene");
  canvas.addEventListener("pointerdown", (event) => {
    if (t > 0 || !view) return;
    const near = [];
    run.surfaces.forEach((surface) => {
      const points = { bob: [3, 4], bar: [0, 1] };
      for (const [point, [a, b]] of Object.entries(points)) {
        const [x, y] = view(surface.now[a][0], surface.now[b][0], surface.depth[0]);
        near.push({ surface, point, distance: Math.hypot(x - event.offsetX, y - event.offsetY) });
      }
    });
    near.sort((a, b) => a.distance - b.distance);
    if (near[0].distance > 30) return;
    const { name } = near[0].surface;
    dragged = { ...near[0], from: [event.offsetX, event.offsetY], begin: { x: state.value(`${name}.bob.0`), y: state.value(`${name}.bob.1`), scale: view.scale } };
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!dragged) return;
    const { surface, point, from, begin } = dragged;
    const [dx, dy] = [(event.offsetX - from[0]) / begin.scale, (from[1] - event.offsetY) / begin.scale];
    if (point === "bar") {
      change({ [`${surface.name}.bob.0`]: Number((begin.x + dx).toFixed(3)), [`${surface.name}.bob.1`]: Number((begin.y + dy).toFixed(3)) });
      return;
    }
    // The direction of the pointer from the bar is that of the rod.
    const [x, y] = view(surface.now[0][0], surface.now[1][0], surface.depth[0]);
    const up = surface.facing === "down" ? 1 : -1;
    const angle = Math.atan2(up * (event.offsetX - x), up * (event.offsetY - y));
    change({ [`${surface.name}.swing`]: Number(angle.toFixed(3)) });
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { dragged = null; });

  document.addEventListener("keydown", (event) => {
    const own = event.target.closest?.("button, select, input, [role=tab], summary, a, pre");
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const sample = nearestTo(run.times, t);
    const actions = {
      " ": () => setPlaying(!playing),
      ArrowLeft: () => setTime(run.times[Math.max(sample - 1, 0)]),
      ArrowRight: () => setTime(run.times[Math.min(sample + 1, run.times.length - 1)]),
      Home: () => setTime(0),
      End: () => setTime(run.last),
    };
    if (!(event.key in actions)) return;
    const isSlider = event.target.matches?.("input[type=range]");
    if (own && !(event.key === " " && isSlider)) return; // the space bar plays from a slider too
    event.preventDefault();
    actions[event.key]();
  });
  window.addEventListener("hashchange", () => {
    state.reset();
    try {
      change(readAddress(state));
    } catch (error) {
      part("status").textContent = error.message;
    }
  });
  new ResizeObserver(() => {
    update();
    tellHeight();
  }).observe(element);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", update);

  openTab(Math.max(0, tabs.findIndex((panel) => panel.dataset.tab === source.panel)));
  let wrong = null;
  try {
    state.set(readAddress(state));
  } catch (error) {
    wrong = error;
  }
  resimulate();
  if (wrong !== null) part("status").textContent = `${wrong.message} (in the address)`;

  const tablesOf = (result) => Object.fromEntries([...source.surfaces.map(({ name }) => name), "system"].map((name, index) => [name, tableOf(source, result, index)]));
  return {
    // Values by their keys, as those of --set.
    get values() { return state.all(); },
    set(values) { change(values); },
    // A run with other values; the page stays as it is.
    run(values = {}) {
      const result = program(withObserver(state.numbersWith(values)), { estimate: true });
      const series = tablesOf(result);
      const each = (read) => Object.fromEntries(Object.entries(series).map(([name, table]) => [name, read(table, name)]));
      return {
        status: result.code === 0 ? "completed" : (source.names.statuses[result.code] ?? "NoProgress"),
        showsEncounter: result.passed,
        t: result.t,
        end: each((table) => Object.fromEntries(Object.entries(table).map(([name, values_]) => [name, values_[values_.length - 1]]))),
        errors: Object.fromEntries(Object.keys(series).map((name, index) => [name, errorsOf(source, result, index)])),
        series: each((table) => Object.fromEntries(Object.entries(table).map(([name, values_]) => [name, values_.slice()]))),
      };
    },
  };
}
