// The sentence at the top: what a run gives, or why its numbers are not those of an encounter.

// Where most bars of a surface have passed all bobs of another one that it faces, with the time;
// tribo.simulate stops there.
function passage(source, run) {
  for (const [mine, theirs] of source.facing ?? []) {
    const { count, facing, places, name } = run.surfaces[mine];
    const other = run.surfaces[theirs];
    const down = facing === "down" ? 1 : -1;
    const bars = places[PLACES.indexOf("y_bar")];
    const bobs = other.places[PLACES.indexOf("y_bob")];
    const beyond = (sample, bar) => {
      const heights = bobs.subarray(sample * other.count, (sample + 1) * other.count);
      return down * bars[sample * count + bar] < Math.min(...heights.map((y) => down * y));
    };
    const own = [...Array(count).keys()].filter((bar) => !beyond(0, bar));
    for (let sample = 1; sample < run.times.length; sample += 1) {
      if (own.filter((bar) => beyond(sample, bar)).length > source.mostPassed * count) {
        return { name, other: other.name, t: run.times[sample] };
      }
    }
  }
  return null;
}

function showStatus({ part, source, state, change, laws }, run) {
  const isChanged = Object.keys(state.changes()).length > 0 || laws.present !== laws.own;
  part("title").textContent = source.title + (isChanged ? ", with other values" : "");
  const { code, passed, needed, reached, samples } = run.result;
  const worst = Math.max(...source.surfaces.map((_, index) => errorsOf(source, run.result, index).w1));
  const status = part("status");
  const through = passage(source, run);
  status.classList.toggle("bad", code !== 0 || !passed || through !== null);
  if (code !== 0) {
    status.textContent = `The run stops at t = ${shownShort(run.last)}: ${source.statuses[code] ?? "it takes too many steps"}.`;
  } else if (through !== null) {
    status.textContent = `By t = ${shownShort(through.t)} most bars of ${through.name} have passed through ${through.other}: the rest of the run is no contact of the two.`;
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
    status.textContent = `Work of friction on ${source.surfaces[which].name} ${shownShort(w1[which], worst)}, pseudowork ${shownShort(ps[which], worst)}, each to ±${shownError(worst)}. Run to t = ${shownShort(run.last)}.`;
  }
}
