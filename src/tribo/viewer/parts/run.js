// The run that the page holds: its samples, and the places between two of them.

const PLACES = 5; // x_bar, y_bar, phi, x_bob, y_bob of an asperite

function bytes(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
}

const doubles = (text) => new Float64Array(bytes(text));
const singles = (text) => new Float32Array(bytes(text));

function readRun(data) {
  const times = doubles(data.times);
  const surfaces = data.surfaces.map((surface) => ({
    ...surface,
    barLength: singles(surface.bar_length),
    depth: singles(surface.depth),
    places: singles(surface.places),
    now: new Float32Array(PLACES * surface.count),
    dots: surface.dots === null ? null : singles(surface.dots),
  }));
  for (const surface of surfaces) {
    const size = surface.dots === null ? 0 : surface.dots.length / data.frames.length;
    surface.dotsNow = new Float32Array(size);
  }
  return {
    ...data,
    times,
    frameTimes: Float64Array.from(data.frames, (sample) => times[sample]),
    surfaces,
    count: surfaces.reduce((sum, surface) => sum + surface.count, 0),
    forces: data.forces === null ? null : singles(data.forces),
    groups: data.groups.map((group) => ({
      name: group.name,
      curves: group.curves.map((curve) => ({ ...curve, values: doubles(curve.values) })),
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

// Frame and fraction of the way to the next one.
function frameAt(run, t) {
  const frame = indexAt(run.frameTimes, t);
  const next = Math.min(frame + 1, run.frameTimes.length - 1);
  const step = run.frameTimes[next] - run.frameTimes[frame];
  return { frame, next, part: step > 0 ? (t - run.frameTimes[frame]) / step : 0 };
}

// Values between two frames, on straight lines.
function between(values, size, { frame, next, part }, into) {
  const a = frame * size;
  const b = next * size;
  for (let k = 0; k < size; k += 1) into[k] = values[a + k] + part * (values[b + k] - values[a + k]);
}
