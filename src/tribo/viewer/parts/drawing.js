// Draws the asperites of a frame on a canvas.

const MOST_DETAILED = 3000; // more asperites are drawn as points
const OBLIQUE = [0.35, 0.2]; // of the depth, to the right and upward
const ARROW = 1.2; // length of the longest arrow, in rods
const HEIGHTS = [160, 460]; // of the canvas, least and most

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
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

// What all frames cover: left, right, bottom, top.
function extent(run) {
  const box = [Infinity, -Infinity, Infinity, -Infinity];
  for (const { places, count, depth, barLength, dots, dotsNow } of run.surfaces) {
    for (let k = 0; k < places.length; k += PLACES) {
      const asperite = (k / PLACES) % count;
      const dx = OBLIQUE[0] * depth[asperite];
      const dy = OBLIQUE[1] * depth[asperite];
      const half = 0.5 * barLength[asperite];
      box[0] = Math.min(box[0], places[k] + dx - half, places[k + 3] + dx);
      box[1] = Math.max(box[1], places[k] + dx + half, places[k + 3] + dx);
      box[2] = Math.min(box[2], places[k + 1] + dy, places[k + 4] + dy);
      box[3] = Math.max(box[3], places[k + 1] + dy, places[k + 4] + dy);
    }
    for (let k = 0; dots !== null && k < dots.length; k += 2) {
      const asperite = Math.floor(((k % dotsNow.length) / dotsNow.length) * count);
      const x = dots[k] + OBLIQUE[0] * depth[asperite];
      const y = dots[k + 1] + OBLIQUE[1] * depth[asperite];
      box[0] = Math.min(box[0], x);
      box[1] = Math.max(box[1], x);
      box[2] = Math.min(box[2], y);
      box[3] = Math.max(box[3], y);
    }
  }
  return box;
}

function rodLength(run) {
  const { places } = run.surfaces[0];
  return Math.hypot(places[3] - places[0], places[4] - places[1]) || 1;
}

function makeDrawing(run, canvas) {
  const [left, right, bottom, top] = extent(run);
  const rod = rodLength(run);
  const force = new Float32Array(2 * run.count);
  let strongest = 0;
  for (let k = 0; run.forces !== null && k < run.forces.length; k += 2) {
    strongest = Math.max(strongest, Math.hypot(run.forces[k], run.forces[k + 1]));
  }

  function bars(context, view, surface) {
    context.beginPath();
    for (let i = 0; i < surface.count; i += 1) {
      const k = PLACES * i;
      const [x, y] = view(surface.now[k], surface.now[k + 1], surface.depth[i]);
      const half = 0.5 * surface.barLength[i] * view.scale;
      const cos = half * Math.cos(surface.now[k + 2]);
      const sin = half * Math.sin(surface.now[k + 2]);
      context.moveTo(x - cos, y + sin);
      context.lineTo(x + cos, y - sin);
    }
    context.lineWidth = Math.max(2, 0.12 * rod * view.scale);
    context.strokeStyle = colour(surface.facing);
    context.stroke();
  }

  function rods(context, view, surface) {
    context.beginPath();
    for (let i = 0; i < surface.count; i += 1) {
      const k = PLACES * i;
      context.moveTo(...view(surface.now[k], surface.now[k + 1], surface.depth[i]));
      context.lineTo(...view(surface.now[k + 3], surface.now[k + 4], surface.depth[i]));
    }
    context.lineWidth = Math.max(1, 0.04 * rod * view.scale);
    context.strokeStyle = colour("rod");
    context.stroke();
  }

  function bobs(context, view, surface) {
    const radius = Math.max(2, 0.09 * rod * view.scale);
    context.beginPath();
    for (let i = 0; i < surface.count; i += 1) {
      const [x, y] = view(surface.now[PLACES * i + 3], surface.now[PLACES * i + 4], surface.depth[i]);
      context.moveTo(x + radius, y);
      context.arc(x, y, radius, 0, 2 * Math.PI);
    }
    context.fillStyle = colour("bob");
    context.fill();
    context.lineWidth = 1;
    context.strokeStyle = colour("ink");
    context.stroke();
  }

  // Bath oscillators, behind the bars.
  function bath(context, view, surface) {
    const radius = Math.max(1.5, 0.03 * rod * view.scale);
    const each = surface.dotsNow.length / surface.count;
    context.beginPath();
    for (let k = 0; k < surface.dotsNow.length; k += 2) {
      const depth = surface.depth[Math.floor(k / each)];
      const [x, y] = view(surface.dotsNow[k], surface.dotsNow[k + 1], depth);
      context.moveTo(x + radius, y);
      context.arc(x, y, radius, 0, 2 * Math.PI);
    }
    context.fillStyle = colour("c3");
    context.fill();
  }

  function points(context, view, surface) {
    context.fillStyle = colour(surface.facing);
    const size = Math.max(1.5, 0.12 * rod * view.scale);
    for (let i = 0; i < surface.count; i += 1) {
      const [x, y] = view(surface.now[PLACES * i + 3], surface.now[PLACES * i + 4], surface.depth[i]);
      context.fillRect(x - 0.5 * size, y - 0.5 * size, size, size);
    }
  }

  function arrows(context, view, place) {
    between(run.forces, 2 * run.count, place, force);
    context.strokeStyle = context.fillStyle = colour("force");
    context.lineWidth = 2;
    let k = 0;
    for (const surface of run.surfaces) {
      for (let i = 0; i < surface.count; i += 1, k += 2) {
        const length = (ARROW * rod * view.scale) / strongest;
        const [dx, dy] = [force[k] * length, -force[k + 1] * length];
        const size = Math.hypot(dx, dy);
        if (size < 3) continue;
        const [x, y] = view(surface.now[PLACES * i + 3], surface.now[PLACES * i + 4], surface.depth[i]);
        const [ux, uy] = [dx / size, dy / size];
        const head = Math.min(8, size);
        context.beginPath();
        context.moveTo(x, y);
        context.lineTo(x + dx - head * ux, y + dy - head * uy);
        context.stroke();
        context.beginPath();
        context.moveTo(x + dx, y + dy);
        context.lineTo(x + dx - head * ux + 0.5 * head * uy, y + dy - head * uy - 0.5 * head * ux);
        context.lineTo(x + dx - head * ux - 0.5 * head * uy, y + dy - head * uy + 0.5 * head * ux);
        context.fill();
      }
    }
  }

  return function draw(t, withArrows) {
    const margin = 0.35 * rod;
    const [spanX, spanY] = [right - left + 2 * margin, top - bottom + 3 * margin];
    const fitting = (canvas.clientWidth * spanY) / spanX;
    canvas.style.height = `${Math.min(Math.max(fitting, HEIGHTS[0]), HEIGHTS[1])}px`;
    const { context, width, height } = prepared(canvas);
    const scale = Math.min(width / spanX, height / spanY);
    const view = (x, y, z) => [
      0.5 * width + (x + OBLIQUE[0] * z - 0.5 * (left + right)) * scale,
      0.5 * height - (y + OBLIQUE[1] * z - 0.5 * (bottom + top)) * scale,
    ];
    view.scale = scale;
    const place = frameAt(run, t);
    const layers = run.count > MOST_DETAILED ? [points] : [bars, rods, bobs];
    for (const surface of run.surfaces) {
      between(surface.places, surface.now.length, place, surface.now);
      for (const layer of layers) layer(context, view, surface);
      if (surface.dots === null) continue;
      between(surface.dots, surface.dotsNow.length, place, surface.dotsNow);
      bath(context, view, surface);
    }
    if (withArrows && run.forces !== null && strongest > 0) arrows(context, view, place);
  };
}
