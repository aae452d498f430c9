// Draws the asperites of a run at a time on a canvas.

const MOST_DETAILED = 3000; // more asperites are drawn as points
const MOST_SPRINGS = 60; // torsion springs of more asperites hide one another
const MOST_TRACES = 24;
const MOST_NAMED = 4; // asperites whose forces have a letter
const OBLIQUE = [0.35, 0.2]; // of the depth, to the right and upward
const ARROW = 1.2; // length of the arrow of a large force, in rods
const LEAST_ARROW = 34; // and in pixels, where asperites are small
const LEAST_NAMED = 30; // length of a displacement with a name, in pixels
const FASTEST = 1; // length of the arrow of a large velocity, in rods
const LARGE = 0.97; // the part of all forces that are not larger
const ROOM = 0.55; // a picture stays as it is for runs that fill at least this part of it
const HEIGHTS = [190, 460]; // of the canvas, least and most
const NARROW = [450, 140]; // the width of a narrow canvas, and its least height
const OF_WINDOW = 0.55; // the largest part of the window's height that a canvas takes
const WINDINGS = 4; // of each half of a torsion spring

function colour(canvas, name) {
  return getComputedStyle(canvas).getPropertyValue(`--${name}`).trim();
}

// A canvas in the pixels of the screen; returns its context in CSS pixels, and its size.
function prepared(canvas) {
  const scale = window.devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
  }
  const context = canvas.getContext("2d");
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

function strokePath(context, style, width) {
  context.strokeStyle = style;
  context.lineWidth = width;
  context.stroke();
}

function fillPath(context, style) {
  context.fillStyle = style;
  context.fill();
}

function drawLine(context, x0, y0, x1, y1) {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
}

// A page that embeds this one in a frame may fit the frame to it.
function tellHeight() {
  if (window.parent !== window) window.parent.postMessage({ triboHeight: document.documentElement.scrollHeight }, "*");
}

// What all frames cover: left, right, bottom, top.
function extent(run) {
  const box = [Infinity, -Infinity, Infinity, -Infinity];
  const cover = (x, y, half) => {
    box[0] = Math.min(box[0], x - half);
    box[1] = Math.max(box[1], x + half);
    box[2] = Math.min(box[2], y);
    box[3] = Math.max(box[3], y);
  };
  for (const { places, count, depth, barLength, dots, dotsNow } of run.surfaces) {
    const [xBar, yBar, , xBob, yBob] = places;
    for (let k = 0; k < xBar.length; k += 1) {
      const [dx, dy] = OBLIQUE.map((part) => part * depth[k % count]);
      cover(xBar[k] + dx, yBar[k] + dy, 0.5 * barLength[k % count]);
      cover(xBob[k] + dx, yBob[k] + dy, 0);
    }
    for (let k = 0; dots !== null && k < dots.length; k += 2) {
      const z = depth[Math.floor(((k % dotsNow.length) / dotsNow.length) * count)];
      cover(dots[k] + OBLIQUE[0] * z, dots[k + 1] + OBLIQUE[1] * z, 0);
    }
  }
  return box;
}

function rodLength(run) {
  const [xBar, yBar, , xBob, yBob] = run.surfaces[0].places;
  return Math.hypot(xBob[0] - xBar[0], yBob[0] - yBar[0]) || 1;
}

// A large size among arrows: all arrows of one kind are in its units, so that rows show theirs.
function largeOf(arrows) {
  const sizes = [];
  for (const { xy: [x, y] } of arrows) {
    for (let k = 0; k < x.length; k += 1) sizes.push(Math.hypot(x[k], y[k]));
  }
  const sorted = Float64Array.from(sizes.filter((size) => size > 0)).sort();
  return sorted.length ? sorted[Math.floor(LARGE * (sorted.length - 1))] : 0;
}

function arrow(context, x, y, dx, dy) {
  const size = Math.hypot(dx, dy);
  if (size < 2) return;
  const [ux, uy] = [dx / size, dy / size];
  const head = Math.min(9, size);
  drawLine(context, x, y, x + dx - head * ux, y + dy - head * uy);
  context.beginPath();
  context.moveTo(x + dx, y + dy);
  context.lineTo(x + dx - head * ux + 0.45 * head * uy, y + dy - head * uy - 0.45 * head * ux);
  context.lineTo(x + dx - head * ux - 0.45 * head * uy, y + dy - head * uy + 0.45 * head * ux);
  context.fill();
}

// A round number near a size: 1, 2 or 5 times a power of ten.
function roundNear(size) {
  const power = 10 ** Math.floor(Math.log10(size));
  return [1, 2, 5, 10].reduce((a, b) => (Math.abs(Math.log(b * power / size)) < Math.abs(Math.log(a / size)) ? b * power : a), power);
}

// A drawing on a canvas: a function of a run, a time, and what is shown, which returns the function
// from places to pixels.  `force` has the size of a force whose arrow is ARROW rods long, and
// `speed` that of a velocity whose arrow is FASTEST rods long: all drawings of a page share them, so
// that their arrows can be compared; they are those of the first run with forces or velocities.  The
// picture's frame stays while runs fit in it and fill most of it.
function makeDrawing(canvas, force = { size: 0 }, speed = { size: 0 }) {
  let box = null;
  let known = null;
  let rod = 1;

  function learn(run) {
    known = run;
    rod = rodLength(run);
    for (const [scale, arrows] of [[force, run.forces], [speed, run.velocities ?? []]]) {
      const large = scale.size ? 0 : largeOf(arrows);
      if (large > 0) scale.size = roundNear(large);
    }
    const wanted = extent(run);
    const fits = box && wanted.every((edge, k) => (k % 2 ? edge <= box[k] : edge >= box[k]));
    const width = ([left, right]) => right - left;
    if (!fits || width(wanted) < ROOM * width(box)) box = wanted;
  }

  const layers = {
    bonds({ context, view, surface, paint }) {
      const [x, y] = surface.now;
      context.beginPath();
      for (let k = 0; k < surface.bonds.length; k += 2) {
        const [i, j] = [surface.bonds[k], surface.bonds[k + 1]];
        const [x0, y0] = view(x[i], y[i], surface.depth[i]);
        const [x1, y1] = view(x[j], y[j], surface.depth[j]);
        const away = (surface.facing === "down" ? -1 : 1) * 0.12 * rod * view.scale;
        const [dx, dy] = [(x1 - x0) / 16, (y1 - y0) / 16];
        context.moveTo(x0, y0);
        for (let n = 2; n < 15; n += 1) {
          context.lineTo(x0 + n * dx, y0 + n * dy + (n % 2 ? away : 0.2 * away));
        }
        context.lineTo(x1, y1);
      }
      strokePath(context, paint("faint"), 1.2);
    },
    bars({ context, view, surface, paint }) {
      const [x, y, phi] = surface.now;
      context.beginPath();
      for (let i = 0; i < surface.count; i += 1) {
        const [px, py] = view(x[i], y[i], surface.depth[i]);
        const half = 0.5 * surface.barLength[i] * view.scale;
        const [cos, sin] = [half * Math.cos(phi[i]), half * Math.sin(phi[i])];
        context.moveTo(px - cos, py + sin);
        context.lineTo(px + cos, py - sin);
      }
      strokePath(context, paint(surface.facing), Math.max(2, 0.12 * rod * view.scale));
    },
    // Torsion springs, from one half of the bar to the rod and on to the other half.
    twists({ context, view, surface, paint }, run) {
      if (!surface.twisted || run.count > MOST_SPRINGS) return;
      const [x, y, phi, xBob, yBob] = surface.now;
      const up = surface.facing === "down" ? 1 : -1;
      context.beginPath();
      for (let i = 0; i < surface.count; i += 1) {
        const length = Math.hypot(xBob[i] - x[i], yBob[i] - y[i]);
        const rest = phi[i] - 0.5 * Math.PI * up;
        const swing = Math.atan2(yBob[i] - y[i], xBob[i] - x[i]) - rest;
        const along = rest + Math.atan2(Math.sin(swing), Math.cos(swing));
        for (const side of [-1, 1]) {
          const start = rest + side * 1.35;
          for (let n = 0; n <= 12 * WINDINGS; n += 1) {
            const turn = (2 * Math.PI * n) / 12;
            const angle = start + (along - start) * (n / (12 * WINDINGS));
            const radius = length * (0.2 + 0.035 * Math.sin(turn));
            const at = view(x[i] + radius * Math.cos(angle), y[i] + radius * Math.sin(angle), surface.depth[i]);
            if (n) context.lineTo(...at);
            else context.moveTo(...at);
          }
        }
      }
      strokePath(context, paint("ink"), 1);
    },
    rods({ context, view, surface, paint }) {
      const [x, y, , xBob, yBob] = surface.now;
      context.beginPath();
      for (let i = 0; i < surface.count; i += 1) {
        context.moveTo(...view(x[i], y[i], surface.depth[i]));
        context.lineTo(...view(xBob[i], yBob[i], surface.depth[i]));
      }
      strokePath(context, paint("rod"), Math.max(1, 0.04 * rod * view.scale));
    },
    bobs({ context, view, surface, paint }) {
      discs(context, view, surface, 2, Math.max(2, 0.09 * rod * view.scale));
      fillPath(context, paint("bob"));
      strokePath(context, paint("ink"), 1);
    },
    centres({ context, view, surface, paint }) {
      discs(context, view, surface, 1, Math.max(1.5, 0.045 * rod * view.scale));
      fillPath(context, paint("cm"));
    },
    // Bath oscillators, behind the bars.
    bath({ context, view, surface, paint }) {
      const radius = Math.max(1.5, 0.03 * rod * view.scale);
      const each = surface.dotsNow.length / surface.count;
      context.beginPath();
      for (let k = 0; k < surface.dotsNow.length; k += 2) {
        const depth = surface.depth[Math.floor(k / each)];
        const [x, y] = view(surface.dotsNow[k], surface.dotsNow[k + 1], depth);
        context.moveTo(x + radius, y);
        context.arc(x, y, radius, 0, 2 * Math.PI);
      }
      fillPath(context, paint("wR"));
    },
    points({ context, view, surface, paint }) {
      const [, , , xBob, yBob] = surface.now;
      context.fillStyle = paint(surface.facing);
      const size = Math.max(1.5, 0.12 * rod * view.scale);
      for (let i = 0; i < surface.count; i += 1) {
        const [x, y] = view(xBob[i], yBob[i], surface.depth[i]);
        context.fillRect(x - 0.5 * size, y - 0.5 * size, size, size);
      }
    },
    // The name of the surface, on the far side of its bars.
    name({ context, view, surface, paint, width }) {
      const middle = Math.floor((surface.count - 1) / 2);
      const [x, y] = view(surface.now[0][middle], surface.now[1][middle], surface.depth[middle]);
      const away = (surface.facing === "down" ? -1 : 1) * (8 + 0.06 * rod * view.scale);
      context.font = "13px system-ui, sans-serif";
      const half = 0.5 * context.measureText(surface.name).width + 4;
      context.textAlign = "center";
      context.textBaseline = away < 0 ? "bottom" : "top";
      context.fillStyle = paint("ink");
      context.fillText(surface.name, Math.min(Math.max(x, half), width - half), y + away);
    },
    // The paths of bar, centre of mass and bob up to now.
    traces({ context, view, surface, paint }, run, place) {
      if (run.count > MOST_TRACES) return;
      context.lineWidth = 1.2;
      context.globalAlpha = 0.7;
      [[0, surface.facing], [1, "cm"], [2, "rod"]].forEach(([point, name]) => {
        context.strokeStyle = paint(name);
        context.beginPath();
        for (let i = 0; i < surface.count; i += 1) {
          for (let frame = 0; frame <= place.frame; frame += 1) {
            const [, x, y] = pointsOf(surface, surface.places, frame * surface.count + i, i)[point];
            if (frame) context.lineTo(...view(x, y, surface.depth[i]));
            else context.moveTo(...view(x, y, surface.depth[i]));
          }
          const [, x, y] = pointsOf(surface, surface.now, i, i)[point];
          context.lineTo(...view(x, y, surface.depth[i]));
        }
        context.stroke();
      });
      context.globalAlpha = 1;
    },
    // How far the points of the first asperite have moved along x, each at its own height.
    displacements({ context, view, surface, paint }) {
      const begins = pointsOf(surface, surface.places, 0, 0);
      const ends = pointsOf(surface, surface.now, 0, 0);
      context.lineWidth = 1.5;
      ends.forEach(([name, x, y], k) => {
        const [x0, y0] = view(begins[k][1], y, surface.depth[0]);
        const [x1] = view(x, y, surface.depth[0]);
        if (Math.abs(x1 - x0) < 2) return;
        context.strokeStyle = context.fillStyle = paint(name === "cm" ? "cm" : "ink");
        drawLine(context, x0, y0 - 5, x0, y0 + 5);
        arrow(context, x0, y0, x1 - x0, 0);
        const letter = surface.facing === "down" ? "x" : "X";
        if (Math.abs(x1 - x0) < LEAST_NAMED) return;
        drawSymbol(context, { before: "Δ", letter, below: name }, x0 + (0.15 + 0.2 * k) * (x1 - x0) - 14, y0 - 11);
      });
    },
  };

  function discs(context, view, surface, point, radius) {
    context.beginPath();
    for (let i = 0; i < surface.count; i += 1) {
      const [, px, py] = pointsOf(surface, surface.now, i, i)[point];
      const [x, y] = view(px, py, surface.depth[i]);
      context.moveTo(x + radius, y);
      context.arc(x, y, radius, 0, 2 * Math.PI);
    }
  }

  // Contact forces at bobs and drives at bars.
  function forces({ context, view, paint }, run, place) {
    const [fx, fy] = [new Float64Array(run.count), new Float64Array(run.count)];
    const unit = Math.max(ARROW * rod * view.scale, LEAST_ARROW);
    for (const { name, xy } of run.forces) {
      between(xy[0], place, fx);
      between(xy[1], place, fy);
      context.strokeStyle = context.fillStyle = paint(name === "f1" ? "w1" : "w2");
      context.lineWidth = 2;
      const [atX, atY] = name === "f1" ? [3, 4] : [0, 1];
      let k = 0;
      for (const surface of run.surfaces) {
        for (let i = 0; i < surface.count; i += 1, k += 1) {
          const size = Math.hypot(fx[k], fy[k]);
          if (!(size > 0)) continue;
          const length = (unit * size) / force.size;
          const [x, y] = view(surface.now[atX][i], surface.now[atY][i], surface.depth[i]);
          const [dx, dy] = [(fx[k] / size) * length, (-fy[k] / size) * length];
          arrow(context, x, y, dx, dy);
          if (run.count > MOST_NAMED || length < 14) continue;
          const letter = surface.facing === "down" ? "f" : "F";
          // Beside a bar, not on it.
          const away = name === "f2" ? (surface.facing === "down" ? -1 : 1) * (12 + 0.06 * rod * view.scale) : 0;
          drawSymbol(context, { before: "", letter, below: name.slice(1) }, x + dx + (dx < 0 ? -18 : 5), y + dy + away);
        }
      }
    }
  }

  // Velocities of bar, centre of mass and bob of each asperite.
  function velocities({ context, view, paint }, run, place) {
    const unit = (FASTEST * rod * view.scale) / speed.size;
    const [vx, vy] = [new Float64Array(run.count), new Float64Array(run.count)];
    context.lineWidth = 2;
    run.velocities.forEach(({ xy }, point) => {
      between(xy[0], place, vx);
      between(xy[1], place, vy);
      context.strokeStyle = context.fillStyle = paint(point === 1 ? "cm" : "wR");
      let k = 0;
      for (const surface of run.surfaces) {
        for (let i = 0; i < surface.count; i += 1, k += 1) {
          const [, x, y] = pointsOf(surface, surface.now, i, i)[point];
          arrow(context, ...view(x, y, surface.depth[i]), vx[k] * unit, -vy[k] * unit);
        }
      }
    });
  }

  // The bar of the scale of arrows, in the lower left corner; `row` counts such bars from below.
  function scaleBar({ context, view, paint, height }, length, text, row) {
    context.strokeStyle = context.fillStyle = paint("faint");
    context.lineWidth = 1.5;
    const y = height - 10 - 26 * row;
    drawLine(context, 8, y, 8 + length, y);
    drawLine(context, 8, y - 4, 8, y + 4);
    drawLine(context, 8 + length, y - 4, 8 + length, y + 4);
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "left";
    context.textBaseline = "bottom";
    context.fillText(text, 8, y - 5);
  }

  return function draw(run, t, shown) {
    if (run !== known) learn(run);
    const [left, right, bottom, top] = box;
    const margin = 0.35 * rod;
    const [spanX, spanY] = [right - left + 2 * margin, top - bottom + 2 * margin];
    const names = 44; // pixels above and below for names of surfaces
    const fitting = (canvas.clientWidth * spanY) / spanX + names;
    const least = canvas.clientWidth < NARROW[0] ? NARROW[1] : HEIGHTS[0];
    canvas.style.height = `${Math.min(Math.max(fitting, least), HEIGHTS[1], Math.max(NARROW[1], OF_WINDOW * window.innerHeight))}px`;
    const { context, width, height } = prepared(canvas);
    const scale = Math.min(width / spanX, (height - names) / spanY);
    const view = (x, y, z) => [
      0.5 * width + (x + OBLIQUE[0] * z - 0.5 * (left + right)) * scale,
      0.5 * height - (y + OBLIQUE[1] * z - 0.5 * (bottom + top)) * scale,
    ];
    view.scale = scale;
    const paint = (name) => colour(canvas, name);
    const place = move(run, t);
    const detailed = ["traces", "bonds", "bars", "twists", "rods", "bobs", "centres", "name", "displacements"];
    const usual = (run.count > MOST_DETAILED ? ["points"] : detailed).filter((name) => shown[name] ?? true);
    for (const surface of run.surfaces) {
      const each = { context, view, surface, paint, width };
      for (const name of surface.dots === null ? usual : ["bath", ...usual]) layers[name](each, run, place);
    }
    let bars = 0;
    const on = { context, view, paint, height };
    if (shown.forces && force.size > 0 && run.forces.length) {
      forces(on, run, place);
      const length = Math.max(ARROW * rod * view.scale, LEAST_ARROW);
      scaleBar(on, length, `force ${Number(force.size.toPrecision(1))}`, bars);
      bars += 1;
    }
    if (shown.velocities && speed.size > 0) {
      velocities(on, run, place);
      scaleBar(on, FASTEST * rod * view.scale, `velocity ${Number(speed.size.toPrecision(1))}`, bars);
    }
    return view;
  };
}
