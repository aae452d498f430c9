// Graphs of the panels: bars, curves and maps of end values, histograms; and numbers as text.

const POINTS = 61; // of the end value against a control
const CELLS = 19; // of a map against two controls, on each side
const SLICE = 6; // milliseconds of runs between two pictures
const BINS = 30;
const MOST_STARTS = 2000;

// Bars of signed numbers from a common zero, each with its number.
function drawBars(canvas, rows, size) {
  const { context, width } = prepared(canvas);
  const paint = (name) => colour(canvas, name);
  const [left, right] = [132, 76];
  const middle = left + 0.5 * (width - left - right);
  const unit = (0.5 * (width - left - right)) / (size || 1);
  context.font = "13px system-ui, sans-serif";
  context.textBaseline = "middle";
  rows.forEach(({ label, value, paint: own, line }, k) => {
    const y = 13 + 21 * k;
    if (line) {
      context.strokeStyle = paint("faint");
      context.lineWidth = 1;
      drawLine(context, 0, y - 11, width, y - 11);
    }
    context.fillStyle = paint("ink");
    context.textAlign = "left";
    context.fillText(label, 0, y);
    context.textAlign = "right";
    context.fillText(shownShort(value, 2e-6 * size), width, y);
    context.fillStyle = paint(own);
    const end = Math.max(Math.min(value * unit, middle - left), left - middle);
    context.fillRect(Math.min(middle, middle + end), y - 7, Math.max(Math.abs(end), 1), 14);
  });
  context.strokeStyle = paint("faint");
  drawLine(context, middle, 2, middle, 21 * rows.length);
}

// A number in four digits; one of at most `least` is zero, but for rounding.
const shownShort = (value, least = 0) => (Math.abs(value) <= least ? "0" : Number(value.toPrecision(4)).toString().replace("-", "−"));

// A bound on an error; it is unknown where a coarser run stopped early.
function shownError(value) {
  if (!Number.isFinite(value)) return "unknown";
  return value === 0 ? "0" : value.toExponential(0).replaceAll("-", "−");
}

// A number that stays while values change little: 1, 2 or 5 times a power of ten, at least `value`.
function roundUp(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [1, 2, 5, 10].find((each) => each * power >= value * 0.999999);
}

// A graph of points (x, y), joined where the run showed the encounter; others are open circles.
function drawPoints(canvas, points, present, title) {
  const { context, width, height } = prepared(canvas);
  const paint = (name) => colour(canvas, name);
  const known = points.filter(({ y }) => Number.isFinite(y));
  if (known.length < 2) return null;
  const pad = { left: 52, right: 10, top: 10, bottom: 34 };
  const [low, high] = [known[0].x, known[known.length - 1].x];
  let [bottom, top] = known.reduce(([a, b], { y }) => [Math.min(a, y), Math.max(b, y)], [0, 0]);
  if (bottom === top) [bottom, top] = [-1, 1];
  const spread = 0.06 * (top - bottom);
  [bottom, top] = [bottom - spread, top + spread];
  const at = (x, y) => [
    pad.left + ((x - low) / (high - low)) * (width - pad.left - pad.right),
    height - pad.bottom - ((y - bottom) / (top - bottom)) * (height - pad.top - pad.bottom),
  ];
  context.font = "12px system-ui, sans-serif";
  context.textBaseline = "middle";
  context.lineWidth = 1;
  for (const value of ticks(bottom, top)) {
    const [, y] = at(low, value);
    context.strokeStyle = paint(value === 0 ? "faint" : "line");
    drawLine(context, pad.left, y, width - pad.right, y);
    context.fillStyle = paint("faint");
    context.textAlign = "right";
    context.fillText(String(value).replace("-", "−"), pad.left - 5, y);
  }
  context.textAlign = "center";
  for (const value of ticks(low, high)) context.fillText(String(value).replace("-", "−"), at(value, 0)[0], height - pad.bottom + 10);
  context.fillStyle = paint("ink");
  context.fillText(title, pad.left + 0.5 * (width - pad.left - pad.right), height - 8);
  context.strokeStyle = paint("w1");
  context.fillStyle = paint("w1");
  context.lineWidth = 2;
  context.beginPath();
  known.forEach(({ x, y }, k) => (k ? context.lineTo(...at(x, y)) : context.moveTo(...at(x, y))));
  context.stroke();
  for (const { x, y, shown } of known) {
    context.beginPath();
    context.arc(...at(x, y), 2.5, 0, 2 * Math.PI);
    context.fillStyle = paint(shown ? "w1" : "panel");
    context.fill();
    if (!shown) context.stroke();
  }
  if (present !== null && present >= low && present <= high) {
    context.strokeStyle = paint("ink");
    context.lineWidth = 1;
    drawLine(context, at(present, 0)[0], pad.top, at(present, 0)[0], height - pad.bottom);
  }
  return (px) => low + (Math.min(Math.max(px - pad.left, 0), width - pad.left - pad.right) / (width - pad.left - pad.right)) * (high - low);
}

// The values of one control, or of two, at which the end value is computed.
function gridOf(controls) {
  const count = controls.length > 1 ? CELLS : POINTS;
  const [first, second] = controls.map(({ low, high }) => Array.from({ length: count }, (_, k) => low + (k / (count - 1)) * (high - low)));
  return second ? second.flatMap((y) => first.map((x) => [x, y])) : first.map((x) => [x]);
}

// A map of values over two controls: blue below zero, orange above it.  Cells of runs that did not
// show the encounter are smaller.  Returns the function from a place to values of both controls.
function drawMap(canvas, points, x, y) {
  const { context, width, height } = prepared(canvas);
  const paint = (name) => colour(canvas, name);
  const pad = { left: 52, right: 10, top: 24, bottom: 34 };
  const [cellX, cellY] = [(width - pad.left - pad.right) / CELLS, (height - pad.top - pad.bottom) / CELLS];
  const column = (value) => ((value - x.low) / (x.high - x.low)) * (CELLS - 1);
  const row = (value) => CELLS - 1 - ((value - y.low) / (y.high - y.low)) * (CELLS - 1);
  const known = points.filter(({ value }) => Number.isFinite(value));
  const size = Math.max(0, ...known.map(({ value }) => Math.abs(value))) || 1;
  for (const point of known) {
    context.globalAlpha = Math.abs(point.value) / size;
    context.fillStyle = paint(point.value < 0 ? "w1" : "w2");
    const rest = point.shown ? 0 : 0.25; // of the cell, free on each side
    const [left, top] = [pad.left + (column(point.x) + rest) * cellX, pad.top + (row(point.y) + rest) * cellY];
    context.fillRect(left, top, (1 - 2 * rest) * cellX + 0.5, (1 - 2 * rest) * cellY + 0.5);
  }
  context.globalAlpha = 1;
  context.lineWidth = 2;
  context.strokeStyle = paint("ink");
  context.strokeRect(pad.left + column(x.present) * cellX, pad.top + row(y.present) * cellY, cellX, cellY);
  context.font = "12px system-ui, sans-serif";
  context.fillStyle = paint("ink");
  context.textBaseline = "middle";
  context.textAlign = "left";
  context.fillText(`${y.label} ↑`, 4, 10);
  context.textAlign = "right";
  const ends = [Math.min(0, ...known.map(({ value }) => value)), Math.max(0, ...known.map(({ value }) => value))];
  context.fillText(`${shownShort(ends[0])} (blue) to ${shownShort(ends[1])} (orange)`, width - 2, 10);
  for (const value of [y.low, y.high]) context.fillText(shownShort(value), pad.left - 5, pad.top + (row(value) + 0.5) * cellY);
  context.textAlign = "center";
  context.fillText(x.label, pad.left + 0.5 * (width - pad.left - pad.right), height - 8);
  for (const value of [x.low, x.high]) context.fillText(shownShort(value), pad.left + (column(value) + 0.5) * cellX, height - pad.bottom + 10);
  const within = (place) => Math.min(Math.max(place, 0), 1);
  return (px, py) => ({
    [x.key]: x.low + within(((px - pad.left) / cellX - 0.5) / (CELLS - 1)) * (x.high - x.low),
    [y.key]: y.high - within(((py - pad.top) / cellY - 0.5) / (CELLS - 1)) * (y.high - y.low),
  });
}

// Runs at many values, some milliseconds at a time; a new request replaces the last one.
function makeScan(draw) {
  let task = 0;
  return function scan(values, runAt) {
    task += 1;
    const mine = task;
    const points = [];
    function go() {
      if (mine !== task) return;
      const until = performance.now() + SLICE;
      while (points.length < values.length && performance.now() < until) points.push(runAt(values[points.length]));
      if (points.length < values.length) {
        window.setTimeout(go, 0);
        return;
      }
      draw(points);
    }
    window.setTimeout(go, 30);
  };
}

// The mean of values and its standard error.
function meanOf(values) {
  const value = values.reduce((a, b) => a + b, 0) / (values.length || 1);
  const spread = values.reduce((a, b) => a + (b - value) ** 2, 0) / Math.max(1, values.length - 1);
  return { value, error: Math.sqrt(spread / (values.length || 1)) };
}

// A mean with as many digits as its error has.
function shownWithError({ value, error }) {
  const digits = error > 0 ? Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(error)))) : 3;
  return `${value.toFixed(digits)} ± ${error.toFixed(digits)}`.replace("-", "−");
}

// A histogram over many starts.
function drawHistogram(canvas, values, mirrored, title) {
  const { context, width, height } = prepared(canvas);
  if (!values.length) return;
  const paint = (name) => colour(canvas, name);
  const reach = Math.max(...values.map(Math.abs)) || 1;
  const edge = roundUp(reach);
  const counts = new Array(BINS).fill(0);
  const index = (value) => Math.min(BINS - 1, Math.max(0, Math.floor(((value + edge) / (2 * edge)) * BINS)));
  for (const value of values) counts[index(value)] += 1;
  const most = Math.max(...counts);
  const bar = width / BINS;
  const base = height - 34;
  context.fillStyle = paint("w1");
  counts.forEach((count, k) => context.fillRect(k * bar + 1, base - (count / most) * (base - 6), bar - 2, (count / most) * (base - 6)));
  if (mirrored) {
    context.strokeStyle = paint("w2");
    context.lineWidth = 2;
    context.beginPath();
    counts.forEach((_, k) => {
      const y = base - (counts[BINS - 1 - k] / most) * (base - 6);
      context.lineTo(k * bar, y);
      context.lineTo((k + 1) * bar, y);
    });
    context.stroke();
  }
  context.font = "12px system-ui, sans-serif";
  context.fillStyle = paint("ink");
  context.textBaseline = "middle";
  context.textAlign = "left";
  context.fillText(shownShort(-edge), 2, base + 10);
  context.textAlign = "center";
  context.fillText("0", 0.5 * width, base + 10);
  context.fillText(title, 0.5 * width, height - 8);
  context.textAlign = "right";
  context.fillText(shownShort(edge), width - 2, base + 10);
  context.strokeStyle = paint("faint");
  context.lineWidth = 1;
  drawLine(context, 0.5 * width, 4, 0.5 * width, base);
}
