// The page: drawing, curves, controls and panels of a scene that the page itself simulates.

const SECONDS = 10; // that a run takes at speed 1

// Starts with `values`, or those of the address, and ends with the `signal`; `laws` are those that a
// reader can choose, with the `present` one.
async function startPage(element, source, { values, signal, laws }) {
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
    if (source.kind === "lattice") await placeImage(machine, source);
  } catch (error) {
    element.classList.add("stopped");
    part("status").textContent = `This page cannot simulate here, and shows works of the run of its file. ${error.message}`;
    part("scene").outerHTML = source.picture;
    return null;
  }
  if (signal.aborted) return null;
  const isLattice = source.kind === "lattice";
  const program = isLattice ? makeLatticeProgram(machine, source, "full") : makeProgram(machine, source, source.samples);
  const short = isLattice ? makeLatticeProgram(machine, source, "short") : makeProgram(machine, source, 2);
  const state = makeState(source);
  const force = { size: 0 }; // of all arrows in the page
  const speed = { size: 0 };
  const drawScene = makeDrawing(part("scene"), force, speed);
  const drawKept = makeDrawing(part("keptScene"), force, speed);
  const curves = makeCurves(part("curves"));
  let run = null;
  let kept = null;
  let t = 0;
  let playing = false;
  let before = 0;
  let waiting = false;
  let marked = null;
  let observer = 0;
  let view = null;

  const withObserver = (numbers) => {
    numbers[source.observer] = observer;
    return numbers;
  };

  const simulated = (numbers) => program(withObserver(numbers.slice()), { estimate: true });

  function resimulate() {
    run = { ...runOf(source, state, simulated(state.numbers)), source };
    t = Math.min(t, run.last);
    part("time").max = Math.max(run.last, kept ? kept.last : 0);
    showStatus({ part, source, state, change, laws }, run);
    writeAddress(state, laws);
    showControls();
    showAll();
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
    const index = run.groups.findIndex(({ name }) => name === curveChoices.group());
    const columns = (kept ? [run, kept] : [run]).map((each) => ({
      run: each,
      t: Math.min(t, each.last),
      curves: each.groups[index].curves.filter(({ name }) => curveChoices.drawn.has(name)),
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

  // Of the first bob of a surface.
  function movedBob(index, from, to) {
    const { places, count } = run.surfaces[index];
    const x = places[PLACES.indexOf("x_bob")];
    return x[to * count] - x[from * count];
  }

  function showMarked() {
    part("marked").hidden = marked === null;
    if (marked === null) return;
    const [from, to] = [nearestTo(run.times, Math.min(marked, run.last)), nearestTo(run.times, t)];
    const said = source.surfaces.map(({ name }, index) => {
      const table = run.tables[index];
      const moved = (x) => shownShort(table[x][to] - table[x][from], 1e-12 * Math.abs(table[x][to]));
      if (!("x_bar" in table)) return `${name}: first bob ${shownShort(movedBob(index, from, to))}`;
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

  // ---- controls and panels, which are functions that show themselves; true after a new run

  const showControls = makeControls({ part, source, state, change });
  if (Object.keys(laws.sources).length > 0) addLaws({ part, state }, laws);
  if (isLattice) {
    part("startsPanel").remove(); // swings at random are those of a pair
    part("lengthen").closest("label").hidden = true; // so is the time at which bobs have passed
  }
  const isOpen = (name) => part(name) !== null && !part(name).hidden;
  const panels = [];
  const showAll = () => panels.forEach((panel) => panel(true));
  const openTab = makeTabs(element, part, () => {
    if (!run) return;
    showAll();
    update();
  });
  const curveChoices = makeCurveChoices({ part, source, update });
  const present = { run: () => run, time: () => t, group: curveChoices.group, seen: () => view };
  const own = { part, source, state, isOpen, change, showAll, short, signal, observed: withObserver, ...present };
  for (const make of [makeEndPanel, ...(isLattice ? [] : [makeStartsPanel]), makeFilesPanel, makeEnergyPanel, makeNumbersPanel]) panels.push(make(own));
  part("observer").addEventListener("input", () => {
    observer = Number(part("observer").value);
    part("observerShown").textContent = shownShort(observer);
    resimulate();
  });

  // ---- the rest of the page

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
    if (laws.present !== laws.own) {
      laws.choose(laws.own);
      return;
    }
    state.reset();
    observer = 0;
    part("observer").value = 0;
    part("observerShown").textContent = "0";
    resimulate();
  });

  dragTime(part("curves"), curves, () => setPlaying(false), setTime);
  dragBodies(part("scene"), own);

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
  }, { signal });
  window.addEventListener("hashchange", async () => {
    const law = lawInAddress() ?? laws.own;
    try {
      if (law !== laws.present) {
        await laws.choose(law, valuesInAddress());
        return;
      }
      state.reset();
      change(readAddress(state));
    } catch (error) {
      part("status").textContent = error.message;
    }
  }, { signal });
  const resized = new ResizeObserver(() => {
    update();
    tellHeight();
  });
  resized.observe(element);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", update, { signal });
  signal.addEventListener("abort", () => {
    playing = false;
    resized.disconnect();
  });

  openTab(source.panel);
  let wrong = null;
  try {
    state.set(values ?? readAddress(state));
  } catch (error) {
    wrong = error;
  }
  resimulate();
  if (wrong !== null) part("status").textContent = `${wrong.message} (in the address)`;

  return makeInterface({ source, state, change, simulated, laws });
}
