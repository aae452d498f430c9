// `window.tribo`: the kernel of the page for scripts.

// `simulated` returns the result of numbers.
function makeInterface({ source, state, change, simulated, laws }) {
  const tablesOf = (result) => Object.fromEntries([...source.surfaces.map(({ name }) => name), "system"].map((name, index) => [name, tableOf(source, result, index)]));
  return {
    // Values by their keys, as those of --set.
    get values() { return state.all(); },
    set(values) { change(values); },
    // The law of force by its name; the page starts again with it.
    get law() { return laws.present; },
    async choose(name) { await laws.choose(name); },
    // A run with other values; the page stays as it is.
    run(values = {}) {
      const result = simulated(state.numbersWith(values));
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
