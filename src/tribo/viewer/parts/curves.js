// Draws curves over time, and fills the table of their values.

const COLOURS = 8;
const DASHES = [[], [], [9, 6], [9, 6], [3, 4]]; // so that equal curves are both seen
const PAD = { left: 58, right: 12, top: 10, bottom: 26 };

// A number as the page shows it.
function shown(value) {
  if (!Number.isFinite(value)) return "–";
  return value === 0 ? "0" : value.toPrecision(6);
}

// Four to nine round numbers from low to high.
function ticks(low, high) {
  const step = 10 ** Math.floor(Math.log10((high - low) / 4));
  const size = [1, 2, 5, 10].find((factor) => (high - low) / (factor * step) <= 6) * step;
  const found = [];
  for (let k = Math.ceil(low / size); k * size <= high; k += 1) found.push(Number((k * size).toPrecision(12)));
  return found;
}

function range(curves) {
  let [low, high] = [0, 0];
  for (const { values } of curves) {
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low === high ? [-1, 1] : [low - 0.05 * (high - low), high + 0.05 * (high - low)];
}

function makeCurves(run, canvas) {
  const first = run.times[0];
  const last = run.times[run.times.length - 1];
  const span = last > first ? last - first : 1;

  function line(context, at, curve, end) {
    const many = Math.max(1, Math.floor(end / (2 * canvas.clientWidth)));
    context.beginPath();
    for (let k = 0; k <= end; k += many) context.lineTo(...at(run.times[k], curve.values[k]));
    context.lineTo(...at(run.times[end], curve.values[end]));
    context.stroke();
  }

  function axes(context, at, width, height, low, high) {
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = colour("faint");
    context.strokeStyle = colour("line");
    context.lineWidth = 1;
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const value of ticks(low, high)) {
      const y = at(first, value)[1];
      context.beginPath();
      context.moveTo(PAD.left, y);
      context.lineTo(width - PAD.right, y);
      context.stroke();
      context.fillText(String(value), PAD.left - 6, y);
    }
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const t of ticks(first, first + span)) {
      context.fillText(String(t), at(t, 0)[0], height - PAD.bottom + 6);
    }
  }

  // Curves of a group up to t, faint after it; a line at `pointed`, if that is a time.
  function draw(curves, t, pointed) {
    const { context, width, height } = prepared(canvas);
    const [low, high] = range(curves);
    const at = (time, value) => [
      PAD.left + ((time - first) / span) * (width - PAD.left - PAD.right),
      height - PAD.bottom - ((value - low) / (high - low)) * (height - PAD.top - PAD.bottom),
    ];
    axes(context, at, width, height, low, high);
    context.lineJoin = "round";
    for (const curve of curves) {
      context.strokeStyle = colour(`c${curve.colour}`);
      context.setLineDash(curve.dash);
      context.lineWidth = 1;
      context.globalAlpha = 0.35;
      line(context, at, curve, run.times.length - 1);
      context.globalAlpha = 1;
      context.lineWidth = 2.2;
      line(context, at, curve, indexAt(run.times, t));
    }
    context.setLineDash([]);
    for (const [time, name] of [[t, "ink"], [pointed, "accent"]]) {
      if (time === null) continue;
      const x = at(time, 0)[0];
      context.strokeStyle = colour(name);
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(x, PAD.top);
      context.lineTo(x, height - PAD.bottom);
      context.stroke();
    }
  }

  // The time at a place on the canvas.
  function timeAt(x) {
    const part = (x - PAD.left) / (canvas.clientWidth - PAD.left - PAD.right);
    return first + Math.min(Math.max(part, 0), 1) * span;
  }

  return { draw, timeAt };
}

// One row a curve: whether it is drawn, its name, its meaning, its value.
function makeTable(body, curves, onChange) {
  body.replaceChildren();
  const cells = curves.map((curve, index) => {
    curve.colour = index % COLOURS;
    curve.dash = DASHES[index % DASHES.length];
    curve.drawn ??= index < 4;
    const row = body.insertRow();
    const label = document.createElement("label");
    const tick = document.createElement("input");
    tick.type = "checkbox";
    tick.checked = curve.drawn;
    tick.setAttribute("aria-label", `draw ${curve.name}`);
    tick.addEventListener("change", () => {
      curve.drawn = tick.checked;
      onChange();
    });
    const swatch = document.createElement("span");
    swatch.className = "swatch";
    swatch.style.background = `var(--c${curve.colour})`;
    label.append(tick, swatch, curve.name);
    row.insertCell().append(label);
    row.insertCell().textContent = curve.meaning;
    const value = row.insertCell();
    value.dataset.quantity = curve.name;
    return value;
  });
  return (sample) => cells.forEach((cell, k) => { cell.textContent = shown(curves[k].values[sample]); });
}
