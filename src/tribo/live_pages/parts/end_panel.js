// The panel "End value": a quantity at the end of runs against one control, or a map against two.

// `page` has the parts, the source, the state, and functions: whether a panel `isOpen`, `change` of
// values, `showAll` panels, a `short` program, and numbers as they are `observed`.
function makeEndPanel({ part, source, state, isOpen, change, showAll, short, observed }) {
  let pointAt = null; // the values of keys below a point
  const controlOf = (key) => source.controls.find((each) => each.key === key);
  const chosen = () => [part("endKey").value, part("endSecond").value].filter((key, k, keys) => key && keys.indexOf(key) === k);
  const scan = makeScan((points) => {
    const keys = chosen();
    const axes = keys.map((key) => ({ ...controlOf(key), present: state.value(key) }));
    const [x, y] = axes;
    part("end").setAttribute("aria-busy", "false");
    if (y) {
      pointAt = drawMap(part("end"), points, x, y);
    } else {
      const at = drawPoints(part("end"), points, x.present, x.label);
      pointAt = at && ((px) => ({ [x.key]: at(px) }));
    }
  });
  source.surfaces.forEach((surface) => ["w1", "w1_ps", "w2", "w2_ps", "delta_e_int", "delta_k_trans", "heat_bath"].filter((name) => isKnown(surface, name)).forEach((quantity) => {
    part("endQuantity").add(new Option(`${quantity} of ${surface.name}`, `${surface.name}.${quantity}`));
  }));
  for (const { key, label } of source.controls) if (!state.choices.has(key)) ["endKey", "endSecond"].forEach((name) => part(name).add(new Option(label, key)));
  part("endQuantity").value = `${source.surfaces[source.subject].name}.w1`;
  part("endKey").value = source.controls.find(({ key }) => key.endsWith(".velocity"))?.key ?? part("endKey").options[0]?.value;

  // The result of a short run; with `lengthen` it lasts until the bobs are as far apart as they began:
  // just past one another they still do work.
  function endOf(numbers) {
    let found = short(observed(numbers), { level: 10 * source.level });
    if (part("lengthen").checked && found.code === 0 && found.needed > numbers[source.duration]) {
      numbers[source.duration] = found.needed;
      found = short(numbers, { level: 10 * source.level });
    }
    return found;
  }

  const valueAtEnd = (result, surface, quantity) => {
    const values = tableOf(source, result, source.surfaces.findIndex(({ name }) => name === surface))[quantity];
    return result.code === 0 && result.reached === 2 ? values[1] : NaN;
  };

  function show(isNew) {
    if (!isNew || !isOpen("endPanel") || !part("endKey").value) return;
    const keys = chosen();
    const [surface, quantity] = part("endQuantity").value.split(".");
    pointAt = null; // until the runs are made
    part("end").setAttribute("aria-busy", "true");
    scan(gridOf(keys.map(controlOf)), (values) => {
      const [x, y] = values;
      try {
        const result = endOf(state.numbersWith(Object.fromEntries(keys.map((key, k) => [key, values[k]]))));
        const value = valueAtEnd(result, surface, quantity);
        return y === undefined ? { x, y: value, shown: result.passed } : { x, y, value, shown: result.passed };
      } catch {
        return y === undefined ? { x, y: NaN, shown: false } : { x, y, value: NaN, shown: false };
      }
    });
  }
  for (const name of ["endQuantity", "endKey", "endSecond", "lengthen"]) part(name).addEventListener("change", showAll);
  part("end").addEventListener("click", (event) => {
    if (!pointAt) return;
    const values = Object.entries(pointAt(event.offsetX, event.offsetY));
    change(Object.fromEntries(values.map(([key, value]) => [key, Number(value.toPrecision(3))])));
  });
  return show;
}
