// The panel "Numbers": quantities now and at the end, with bounds on their errors.

const LISTED = ["w1", "w1_ps", "w2", "w2_ps", "wL", "wR", "w", "w_ps", "delta_k_trans", "delta_e_int", "heat_bath", "theta", "omega", "x_cm", "x_bob", "x_bar", "vx_cm", "f1_x", "f1_y"];

// `run`, `time` and `group` are functions that return the present run, time and surface.
function makeNumbersPanel({ part, source, isOpen, run, time, group }) {
  return function show() {
    if (!isOpen("numbersPanel")) return;
    const index = Math.max(0, source.surfaces.findIndex(({ name }) => name === group()));
    const { tables, times, result } = run();
    const table = tables[index];
    const errors = errorsOf(source, result, index);
    const [now, last] = [nearestTo(times, time()), times.length - 1];
    part("now").textContent = `t = ${shownShort(times[now])}`;
    const rows = LISTED.filter((name) => name in table && isKnown(source.surfaces[index], name)).map((name) => [name, table[name][now], table[name][last], errors[name]]);
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
  };
}
