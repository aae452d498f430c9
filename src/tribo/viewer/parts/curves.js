// Draws curves over time, and fills the table of their values.

const PAD = { left: 66, right: 74, top: 12, bottom: 42 };
const LABEL_GAP = 17; // between symbols at the ends of curves, in pixels
const ROOMY = 0.4; // a scale stays for curves that fill at least this part of it

// A number as the page shows it.
function shownNumber(value) {
  if (!Number.isFinite(value)) return "–";
  const isTiny = value !== 0 && Math.abs(value) < 1e-4;
  return value === 0 ? "0" : (isTiny ? value.toExponential(5) : value.toPrecision(6)).replaceAll("-", "−");
}

// Four to nine round numbers from low to high.
function ticks(low, high) {
  const step = 10 ** Math.floor(Math.log10((high - low) / 4));
  const size = [1, 2, 5, 10].find((factor) => (high - low) / (factor * step) <= 6) * step;
  const found = [];
  for (let k = Math.ceil(low / size); k * size <= high; k += 1) found.push(Number((k * size).toPrecision(12)));
  return found;
}

function rangeOf(curves) {
  let [low, high] = [0, 0];
  for (const { values } of curves) {
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low === high ? [-1, 1] : [low - 0.05 * (high - low), high + 0.05 * (high - low)];
}

// Heights for labels: in the order of `wanted`, at least LABEL_GAP apart.
function apart(wanted, top, bottom) {
  const order = wanted.map((y, k) => [y, k]).sort((a, b) => a[0] - b[0]);
  const places = order.map(([y]) => y);
  for (let k = 1; k < places.length; k += 1) places[k] = Math.max(places[k], places[k - 1] + LABEL_GAP);
  let ceiling = bottom;
  for (let k = places.length - 1; k >= 0; k -= 1) {
    places[k] = Math.max(Math.min(places[k], ceiling), top);
    ceiling = places[k] - LABEL_GAP;
  }
  const found = [];
  order.forEach(([, k], rank) => { found[k] = places[rank]; });
  return found;
}

// A graph on a canvas.  It draws the curves of one run or two: [{ run, curves, t }], the first in
// full, and a line at `pointed`, if that is a time.
function makeCurves(canvas) {
  let scale = null;
  let [first, span] = [0, 1];

  function rescale(curves) {
    const wanted = rangeOf(curves);
    const fits = scale && wanted[0] >= scale[0] && wanted[1] <= scale[1];
    if (!fits || wanted[1] - wanted[0] < ROOMY * (scale[1] - scale[0])) scale = wanted;
    return scale;
  }

  function line(context, at, times, values, end) {
    const many = Math.max(1, Math.floor(end / (2 * canvas.clientWidth)));
    context.beginPath();
    for (let k = 0; k <= end; k += many) context.lineTo(...at(times[k], values[k]));
    context.lineTo(...at(times[end], values[end]));
    context.stroke();
  }

  function axes(context, at, width, height, low, high, paint, title) {
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = paint("faint");
    context.lineWidth = 1;
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const value of ticks(low, high)) {
      const y = at(first, value)[1];
      context.strokeStyle = paint(value === 0 ? "faint" : "line");
      drawLine(context, PAD.left, y, width - PAD.right, y);
      context.fillText(String(value).replace("-", "−"), PAD.left - 6, y);
    }
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const t of ticks(first, first + span)) {
      context.fillText(String(t), at(t, 0)[0], height - PAD.bottom + 6);
    }
    context.fillStyle = paint("ink");
    context.font = "13px system-ui, sans-serif";
    context.fillText("time", PAD.left + 0.5 * (width - PAD.left - PAD.right), height - 17);
    context.save();
    context.translate(4, PAD.top + 0.5 * (height - PAD.top - PAD.bottom));
    context.rotate(-0.5 * Math.PI);
    context.fillText(title, 0, 0);
    context.restore();
  }

  function draw(runs, pointed) {
    const { context, width, height } = prepared(canvas);
    const paint = (name) => colour(canvas, name);
    first = Math.min(...runs.map(({ run }) => run.first));
    span = Math.max(...runs.map(({ run }) => run.last)) - first || 1;
    const [low, high] = rescale(runs.flatMap(({ curves }) => curves));
    const at = (time, value) => [
      PAD.left + ((time - first) / span) * (width - PAD.left - PAD.right),
      height - PAD.bottom - ((value - low) / (high - low)) * (height - PAD.top - PAD.bottom),
    ];
    const kinds = new Set(runs[0].curves.map(({ kind }) => (kind === "energy" ? "work or energy" : kind)));
    axes(context, at, width, height, low, high, paint, [...kinds].join(", "));
    context.lineJoin = "round";
    [...runs].reverse().forEach(({ run, curves, t }, rank) => {
      const kept = rank < runs.length - 1;
      for (const curve of curves) {
        context.strokeStyle = paint(curve.colour);
        context.setLineDash(curve.dash);
        context.lineWidth = 1;
        context.globalAlpha = kept ? 0.6 : 0.4;
        line(context, at, run.times, curve.values, run.times.length - 1);
        context.globalAlpha = 1;
        if (kept) continue;
        context.lineWidth = curve.name === "W" ? 2.8 : 2;
        line(context, at, run.times, curve.values, indexAt(run.times, t));
      }
    });
    context.setLineDash([]);
    const { run, curves, t } = runs[0];
    const ends = curves.map((curve) => at(run.last, curve.values[curve.values.length - 1])[1]);
    apart(ends, PAD.top, height - PAD.bottom).forEach((y, k) => {
      context.strokeStyle = context.fillStyle = paint(curves[k].colour);
      context.lineWidth = 1;
      drawLine(context, width - PAD.right + 1, ends[k], width - PAD.right + 12, y);
      if (curves[k].symbol.letter || curves[k].symbol.before.length < 8) drawSymbol(context, curves[k].symbol, width - PAD.right + 15, y);
    });
    for (const [time, name] of [[t, "ink"], [pointed, "accent"]]) {
      if (time === null) continue;
      const x = at(Math.min(Math.max(time, first), first + span), 0)[0];
      context.strokeStyle = paint(name);
      drawLine(context, x, PAD.top, x, height - PAD.bottom);
    }
  }

  // The time at a place on the canvas.
  function timeAt(x) {
    const part = (x - PAD.left) / (canvas.clientWidth - PAD.left - PAD.right);
    return first + Math.min(Math.max(part, 0), 1) * span;
  }

  return { draw, timeAt };
}

// One row a curve: whether it is drawn, its symbol, its meaning, its values.  Returns a function that
// sets the values from curves of the same names.
function makeTable(body, curves, drawn, onChange) {
  body.replaceChildren();
  const rows = curves.map(({ name, meaning, colour: own }) => {
    const row = body.insertRow();
    const label = document.createElement("label");
    const tick = document.createElement("input");
    tick.type = "checkbox";
    tick.checked = drawn.get(name);
    tick.addEventListener("change", () => {
      drawn.set(name, tick.checked);
      onChange();
    });
    const swatch = document.createElement("span");
    swatch.className = "swatch";
    swatch.style.borderTop = `3px ${isPseudowork(name) ? "dashed" : "solid"} var(--${own})`;
    label.append(tick, swatch, typeset(name));
    tick.setAttribute("aria-label", `draw ${meaning}`);
    row.insertCell().append(label);
    row.insertCell().textContent = meaning;
    return [name, [row.insertCell(), row.insertCell()]];
  });
  return (columns) => {
    for (const [name, cells] of rows) {
      cells.forEach((cell, k) => {
        const curve = columns[k]?.curves.find((each) => each.name === name);
        cell.dataset.quantity = name;
        cell.dataset.column = k ? "kept" : "shown";
        cell.hidden = k > 0 && !columns[k];
        cell.textContent = curve ? shownNumber(curve.values[columns[k].sample]) : "";
      });
    }
  };
}
