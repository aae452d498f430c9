// Dragging: time on the curves; before the start a bob swings and a bar moves.

function dragTime(canvas, curves, stop, setTime) {
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    stop();
    setTime(curves.timeAt(event.offsetX));
  });
  canvas.addEventListener("pointermove", (event) => {
    if (canvas.hasPointerCapture(event.pointerId)) setTime(curves.timeAt(event.offsetX));
  });
}

// `run`, `time` and `seen` are functions that return the present run and time, and the view: from a
// place of the scene to one of the canvas.
function dragBodies(canvas, { state, change, run, time, seen }) {
  let dragged = null;
  canvas.addEventListener("pointerdown", (event) => {
    const view = seen();
    if (time() > 0 || !view) return;
    const near = [];
    run().surfaces.forEach((surface) => {
      const points = { bob: [3, 4], bar: [0, 1] };
      for (const [point, [a, b]] of Object.entries(points)) {
        const [x, y] = view(surface.now[a][0], surface.now[b][0], surface.depth[0]);
        near.push({ surface, point, distance: Math.hypot(x - event.offsetX, y - event.offsetY) });
      }
    });
    near.sort((a, b) => a.distance - b.distance);
    const { name } = near[0].surface;
    const key = near[0].point === "bar" ? `${name}.bob.0` : `${name}.swing`;
    if (near[0].distance > 30 || !state.keys.has(key)) return;
    dragged = { ...near[0], from: [event.offsetX, event.offsetY], begin: { x: state.value(`${name}.bob.0`), y: state.value(`${name}.bob.1`), scale: view.scale } };
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!dragged) return;
    const { surface, point, from, begin } = dragged;
    const [dx, dy] = [(event.offsetX - from[0]) / begin.scale, (from[1] - event.offsetY) / begin.scale];
    if (point === "bar") {
      change({ [`${surface.name}.bob.0`]: Number((begin.x + dx).toFixed(3)), [`${surface.name}.bob.1`]: Number((begin.y + dy).toFixed(3)) });
      return;
    }
    // The direction of the pointer from the bar is that of the rod.
    const [x, y] = seen()(surface.now[0][0], surface.now[1][0], surface.depth[0]);
    const up = surface.facing === "down" ? 1 : -1;
    const angle = Math.atan2(up * (event.offsetX - x), up * (event.offsetY - y));
    change({ [`${surface.name}.swing`]: Number(angle.toFixed(3)) });
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { dragged = null; });
}
