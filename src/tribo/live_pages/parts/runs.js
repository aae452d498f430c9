// Results of the module as the drawing and the curves take them.

const PSEUDO_FIRST = ["w1", "w1_ps", "w2", "w2_ps"];

// Names of the quantities of a surface or, behind these, of the system, and the first one's row.
function rowsOf(source, index) {
  const { asperite, system } = source.names;
  const count = source.surfaces.length;
  return { names: index < count ? asperite : system, first: Math.min(index, count) * asperite.length };
}

// The rows of a result: quantities of each surface, and of the system.
function tableOf(source, result, index) {
  const { names, first } = rowsOf(source, index);
  const found = {};
  names.forEach((name, k) => {
    const row = (first + k) * result.samples;
    found[name] = result.series.subarray(row, row + result.reached);
  });
  return found;
}

function errorsOf(source, result, index) {
  const { names, first } = rowsOf(source, index);
  return Object.fromEntries(names.map((name, k) => [name, result.errors ? result.errors[first + k] : NaN]));
}

// What is drawn of all asperites, by its name: sample after sample, asperite after asperite.
function drawnOf(source, result, tables) {
  const count = source.surfaces.reduce((sum, surface) => sum + surface.count, 0);
  if (source.kind === "lattice") {
    const size = result.samples * count;
    return (name) => {
      const first = source.names.drawn.indexOf(name) * size;
      return result.drawn.subarray(first, first + result.reached * count);
    };
  }
  return (name) => {
    const both = new Float64Array(2 * tables[0][name].length);
    tables.forEach((table, index) => table[name].forEach((value, k) => { both[2 * k + index] = value; }));
    return both;
  };
}

// The columns of `own` asperites from the `first` on, of `count`.
function columnsOf(values, count, first, own) {
  const found = new Float64Array((values.length / count) * own);
  for (let k = 0; k < found.length; k += 1) found[k] = values[Math.floor(k / own) * count + first + (k % own)];
  return found;
}

// A run for the drawing and the curves of the viewer.
function runOf(source, state, result) {
  const tables = source.surfaces.map((_, index) => tableOf(source, result, index));
  const drawn = drawnOf(source, result, tables);
  const total = source.surfaces.reduce((sum, { count }) => sum + count, 0);
  let before = 0;
  const surfaces = source.surfaces.map((surface) => {
    const { name, facing, count, bonds } = surface;
    const value = (key) => (state.keys.has(`${name}.${key}`) ? state.value(`${name}.${key}`) : null);
    const [m1, m2, barLength, kappa] = ["m1", "m2", "bar_length", "kappa"].map((each) => value(`asperite.${each}`));
    const depth = value("depth") ?? 0;
    const first = before;
    before += count;
    return {
      name,
      facing,
      count,
      barLength: barLength === null ? surface.barLength : new Array(count).fill(barLength),
      depth: count === 1 ? [depth] : surface.depth,
      centre: m1 === null || m2 === null ? surface.centre : new Array(count).fill(m1 / (m1 + m2)),
      twisted: kappa === null ? surface.twisted : kappa > 0,
      bonds,
      places: PLACES.map((each) => columnsOf(drawn(each), total, first, count)),
      now: PLACES.map(() => new Float64Array(count)),
      dots: null,
      dotsNow: new Float64Array(0),
    };
  });
  // Forces are NaN where they are not known.
  const forces = ["f1", "f2"].map((name) => ({
    name,
    xy: ["x", "y"].map((axis) => drawn(`${name}_${axis}`)),
  })).filter(({ xy }) => xy.every((values) => values.every(Number.isFinite)));
  const velocities = ["bar", "cm", "bob"].map((point) => ({ xy: ["x", "y"].map((axis) => drawn(`v${axis}_${point}`)) }));
  const groups = [...source.surfaces.map(({ name }) => name), "system"].map((name, index) => ({
    name,
    curves: Object.entries(tableOf(source, result, index))
      .filter(([quantity]) => source.kinds[quantity])
      .map(([quantity, values], k) => ({
        name: quantity,
        meaning: source.meanings[quantity],
        kind: source.kinds[quantity],
        drawn: PSEUDO_FIRST.includes(quantity) || index === source.surfaces.length,
        symbol: symbol(quantity),
        colour: colourName(quantity, k),
        dash: isPseudowork(quantity) ? [7, 5] : [],
        values,
      })),
  }));
  const times = result.t;
  return { times, frameTimes: times, surfaces, forces, velocities, groups, count: total, first: times[0], last: times[times.length - 1], tables, result };
}
