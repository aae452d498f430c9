// A run: its samples, and the places between two of them.

const PLACES = ["x_bar", "y_bar", "phi", "x_bob", "y_bob"];

// An array as Python packs it.
function unpacked(packed) {
  if ("same" in packed) return new Float64Array(packed.size).fill(packed.same ?? NaN);
  const bytes = Uint8Array.from(atob(packed.f4 ?? packed.f8), (letter) => letter.charCodeAt(0));
  return "f4" in packed ? new Float32Array(bytes.buffer) : new Float64Array(bytes.buffer);
}

function readRun(data) {
  const times = unpacked(data.times);
  const frameTimes = Float64Array.from(unpacked(data.frames), (sample) => times[sample]);
  const surfaces = data.surfaces.map((surface) => {
    const dots = surface.dots === null ? null : unpacked(surface.dots);
    return {
      ...surface,
      barLength: unpacked(surface.barLength),
      depth: unpacked(surface.depth),
      centre: unpacked(surface.centre),
      bonds: unpacked(surface.bonds),
      places: PLACES.map((name) => unpacked(surface.places[name])),
      now: PLACES.map(() => new Float64Array(surface.count)),
      dots,
      dotsNow: new Float64Array(dots === null ? 0 : dots.length / frameTimes.length),
    };
  });
  const forces = Object.entries(data.forces).map(([name, both]) => ({ name, xy: both.map(unpacked) }));
  return {
    ...data,
    times,
    frameTimes,
    surfaces,
    forces,
    first: times[0],
    last: times[times.length - 1],
    count: surfaces.reduce((sum, surface) => sum + surface.count, 0),
    groups: data.groups.map(({ name, curves }) => ({
      name,
      curves: curves.map((curve, index) => ({
        ...curve,
        symbol: symbol(curve.name),
        colour: colourName(curve.name, index),
        dash: isPseudowork(curve.name) ? [7, 5] : [],
        values: unpacked(curve.values),
      })),
    })),
  };
}

// The last index whose time is not after t.
function indexAt(times, t) {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle - 1;
  }
  return low;
}

// The index whose time is nearest to t.
function nearestTo(times, t) {
  const before = indexAt(times, t);
  const after = Math.min(before + 1, times.length - 1);
  return t - times[before] <= times[after] - t ? before : after;
}

// Frame and fraction of the way to the next one.
function frameAt(run, t) {
  const frame = indexAt(run.frameTimes, t);
  const next = Math.min(frame + 1, run.frameTimes.length - 1);
  const step = run.frameTimes[next] - run.frameTimes[frame];
  const part = step > 0 ? Math.min(Math.max((t - run.frameTimes[frame]) / step, 0), 1) : 0;
  return { frame, next, part };
}

// Values between two frames, on straight lines.
function between(values, { frame, next, part }, into) {
  const size = into.length;
  const [a, b] = [frame * size, next * size];
  for (let k = 0; k < size; k += 1) into[k] = values[a + k] + part * (values[b + k] - values[a + k]);
}

// Sets the places of all asperites at a time.
function move(run, t) {
  const place = frameAt(run, t);
  for (const surface of run.surfaces) {
    surface.places.forEach((values, k) => between(values, place, surface.now[k]));
    if (surface.dots !== null) between(surface.dots, place, surface.dotsNow);
  }
  return place;
}

// The points of an asperite at a time that `values` are of: [x, y] of bar, centre of mass and bob.
function pointsOf(surface, values, index, asperite) {
  const [xBar, yBar, , xBob, yBob] = values.map((each) => each[index]);
  const part = surface.centre[asperite];
  return [
    ["bar", xBar, yBar],
    ["cm", xBar + part * (xBob - xBar), yBar + part * (yBob - yBar)],
    ["bob", xBob, yBob],
  ];
}
