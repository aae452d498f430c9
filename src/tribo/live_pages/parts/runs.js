// Results of the module as the drawing and the curves take them.

const PSEUDO_FIRST = ["w1", "w1_ps", "w2", "w2_ps"];

// The rows of a result: quantities of each surface, and of the system.
function tableOf(source, result, index) {
  const { asperite, system } = source.names;
  const names = index < 2 ? asperite : system;
  const first = index < 2 ? index * asperite.length : 2 * asperite.length;
  const found = {};
  names.forEach((name, k) => {
    const row = (first + k) * result.samples;
    found[name] = result.series.subarray(row, row + result.reached);
  });
  return found;
}

function errorsOf(source, result, index) {
  const { asperite, system } = source.names;
  const names = index < 2 ? asperite : system;
  const first = index < 2 ? index * asperite.length : 2 * asperite.length;
  return Object.fromEntries(names.map((name, k) => [name, result.errors ? result.errors[first + k] : NaN]));
}

// A quantity of both asperites at each sample in turn.
function interleaved(tables, name) {
  const both = new Float64Array(2 * tables[0][name].length);
  tables.forEach((table, index) => table[name].forEach((value, k) => { both[2 * k + index] = value; }));
  return both;
}

// A run for the drawing and the curves of the viewer.
function runOf(source, state, result) {
  const tables = [0, 1].map((index) => tableOf(source, result, index));
  const surfaces = source.surfaces.map(({ name, facing }, index) => {
    const table = tables[index];
    const [m1, m2] = ["m1", "m2"].map((each) => state.value(`${name}.asperite.${each}`));
    return {
      name,
      facing,
      count: 1,
      barLength: [state.value(`${name}.asperite.bar_length`)],
      depth: [state.value(`${name}.depth`) ?? 0],
      centre: [m1 / (m1 + m2)],
      twisted: state.value(`${name}.asperite.kappa`) > 0,
      bonds: [],
      places: PLACES.map((each) => table[each]),
      now: PLACES.map(() => new Float64Array(1)),
      dots: null,
      dotsNow: new Float64Array(0),
    };
  });
  const forces = ["f1", "f2"].map((name) => ({
    name,
    xy: ["x", "y"].map((axis) => interleaved(tables, `${name}_${axis}`)),
  }));
  const velocities = ["bar", "cm", "bob"].map((point) => ({ xy: ["x", "y"].map((axis) => interleaved(tables, `v${axis}_${point}`)) }));
  const groups = [...source.surfaces.map(({ name }) => name), "system"].map((name, index) => ({
    name,
    curves: Object.entries(tableOf(source, result, index))
      .filter(([quantity]) => source.kinds[quantity])
      .map(([quantity, values], k) => ({
        name: quantity,
        meaning: source.meanings[quantity],
        kind: source.kinds[quantity],
        drawn: PSEUDO_FIRST.includes(quantity) || index === 2,
        symbol: symbol(quantity),
        colour: colourName(quantity, k),
        dash: isPseudowork(quantity) ? [7, 5] : [],
        values,
      })),
  }));
  const times = result.t;
  return { times, frameTimes: times, surfaces, forces, velocities, groups, count: 2, first: times[0], last: times[times.length - 1], tables, result };
}
