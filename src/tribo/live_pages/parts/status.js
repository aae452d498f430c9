// The sentence at the top: what a run gives, or why its numbers are not those of an encounter.

function showStatus({ part, source, state, change, laws }, run) {
  const isChanged = Object.keys(state.changes()).length > 0 || laws.present !== laws.own;
  part("title").textContent = source.title + (isChanged ? ", with other values" : "");
  const { code, passed, needed, reached, samples } = run.result;
  const worst = Math.max(...source.surfaces.map((_, index) => errorsOf(source, run.result, index).w1));
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
    status.textContent = `Work of friction on ${source.surfaces[which].name} ${shownShort(w1[which], worst)}, pseudowork ${shownShort(ps[which], worst)}, each to ±${shownError(worst)}. Run to t = ${shownShort(run.last)}.`;
  }
}
