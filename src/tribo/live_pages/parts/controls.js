// Sliders, choices and fields, which set values by their keys.

const STEPS = 200; // of a slider

// Text of a control's value.
const shownValue = (value) => (typeof value === "number" ? String(Number(value.toPrecision(5))).replace("-", "−") : value);

// Returns the function that shows the present values in all of them.
function makeControls({ part, source, state, change }) {
  const widgets = [];

  function addControl({ key, label, low, high }, into) {
    const choice = state.choices.get(key);
    const outer = document.createElement("label");
    outer.append(Object.assign(document.createElement("span"), { textContent: label, title: key }));
    if (choice) {
      const select = document.createElement("select");
      for (const word of Object.keys(choice.words)) select.add(new Option(word));
      select.dataset.key = key;
      select.addEventListener("change", () => change({ [key]: select.value }));
      widgets.push(() => { select.value = state.value(key); });
      outer.append(select);
    } else {
      const range = Object.assign(document.createElement("input"), { type: "range", min: low, max: high, step: (high - low) / STEPS });
      const field = Object.assign(document.createElement("input"), { type: "text", inputMode: "decimal" });
      field.setAttribute("aria-label", `${label}, as a number`);
      range.dataset.key = key;
      field.dataset.field = key;
      range.addEventListener("input", () => tryChange(key, snapped(Number(range.value), key), field));
      field.addEventListener("change", () => tryChange(key, Number(field.value.replace("−", "-")), field));
      widgets.push(() => {
        const value = state.value(key);
        if (document.activeElement !== range) range.value = value;
        range.setAttribute("aria-valuetext", shownValue(value));
        field.value = shownValue(value);
      });
      outer.append(range, field);
    }
    into.append(outer);
  }

  // The file's own value is among those of a slider.
  function snapped(value, key) {
    const own = source.keys.find((each) => each.key === key.replace("*.", `${source.surfaces[0].name}.`)).value;
    const control = source.controls.find((each) => each.key === key);
    const near = control ? (control.high - control.low) / STEPS : 0;
    return Math.abs(value - own) < 0.6 * near ? own : Number(value.toPrecision(6));
  }

  function tryChange(key, value, field) {
    try {
      change({ [key]: value });
      field.removeAttribute("aria-invalid");
    } catch (error) {
      field.setAttribute("aria-invalid", "true");
      part("status").textContent = error.message;
    }
  }

  for (const control of source.controls) addControl(control, part("sliders"));
  const shownKeys = new Set(source.controls.map(({ key }) => key));
  part("every").addEventListener("toggle", () => {
    if (part("all").childElementCount) return;
    const rest = [...source.choices, ...source.keys].filter(({ key }) => !shownKeys.has(key));
    for (const { key } of rest) addField(key);
    widgets.forEach((widget) => widget());
  });

  function addField(key) {
    if (state.choices.has(key)) {
      addControl({ key, label: key }, part("all"));
      return;
    }
    const outer = document.createElement("label");
    outer.append(Object.assign(document.createElement("span"), { textContent: key }));
    const field = Object.assign(document.createElement("input"), { type: "text", inputMode: "decimal" });
    field.dataset.field = key;
    field.addEventListener("change", () => tryChange(key, Number(field.value.replace("−", "-")), field));
    widgets.push(() => { field.value = shownValue(state.value(key)); });
    outer.append(field);
    part("all").append(outer);
  }

  return () => widgets.forEach((widget) => widget());
}
