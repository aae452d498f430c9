// The controls of the values that can be changed.

const STEPS = 200; // of a slider from end to end

const shownValue = (value) => (typeof value === "number" ? String(Number(value.toPrecision(5))) : value);

// A list of numbers is a slider over the list, one of words a choice, and a range a slider.
function makeSlider(slider, onChange) {
  const { key, values, low, high, value } = slider;
  const label = document.createElement("label");
  const name = document.createElement("span");
  name.textContent = key;
  label.append(name);
  if (values && values.some((each) => typeof each !== "number")) {
    const select = document.createElement("select");
    for (const each of values) select.add(new Option(each));
    select.selectedIndex = values.indexOf(value);
    select.dataset.key = key;
    select.addEventListener("change", () => onChange(key, values[select.selectedIndex]));
    label.append(select);
    return label;
  }
  const range = document.createElement("input");
  range.type = "range";
  [range.min, range.max] = values ? [0, values.length - 1] : [low, high];
  range.step = values ? 1 : (high - low) / STEPS;
  range.value = values ? values.indexOf(value) : value;
  range.dataset.key = key;
  const output = document.createElement("output");
  const show = (now) => {
    output.textContent = shownValue(now);
    range.setAttribute("aria-valuetext", shownValue(now));
  };
  show(value);
  range.addEventListener("input", () => {
    const number = Number(range.value);
    const now = values ? values[number] : Math.min(Math.max(Number(number.toPrecision(6)), low), high);
    show(now);
    onChange(key, now);
  });
  label.append(range, output);
  return label;
}
