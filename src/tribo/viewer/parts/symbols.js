// The symbol, colour and line of each quantity.

// Those of quantities whose names say less.
const WORDS = {
  total_energy_change: "energy change", pull_force: "drive’s force", time_without_contact: "without contact",
  heat_bath: "heat of bath",
};
// One colour a quantity, in all groups; a pseudowork has that of its work.
const COLOURS = {
  w1: "w1", w2: "w2", w: "ink", wL: "wL", wR: "wR", w_int: "wint", w_field: "wfield", w_T: "wT",
  heat: "heat", heat_bath: "heat", W: "ink", delta_E_int: "heat", delta_K: "wT",
  contact_energy: "w1", applied_work: "w2", total_energy_change: "ink", friction_force: "w1",
};
const OTHERS = ["wL", "wR", "wint", "wfield", "wT"];

const isPseudowork = (name) => name.endsWith("_ps");

function colourName(name, index) {
  return COLOURS[name.replace(/_ps$/, "")] ?? OTHERS[index % OTHERS.length];
}

// The parts of a symbol: text before, italic letter, subscript; or words.
function symbol(name) {
  if (name in WORDS) return { before: WORDS[name], letter: "", below: "" };
  const found = /^(delta_)?([A-Za-z])(?=_|[\dLR]|$)_?(\w*)$/.exec(name);
  if (!found) return { before: name.replaceAll("_", " "), letter: "", below: "" };
  const below = found[3].replace(/_?ps$/, (end) => (end.length < found[3].length ? ",ps" : "ps"));
  return { before: found[1] ? "Δ" : "", letter: found[2], below: below.replace(/^_/, "").replaceAll("_", ",") };
}

// The symbol as elements of a page.
function typeset(name) {
  const { before, letter, below } = symbol(name);
  const whole = document.createElement("span");
  whole.className = letter ? "symbol" : "";
  whole.append(before);
  for (const [tag, text] of [["i", letter], ["sub", below]]) {
    if (!text) continue;
    const part = document.createElement(tag);
    part.textContent = text;
    whole.append(part);
  }
  return whole;
}

// The symbol on a canvas, its left end at x, centred on y.
function drawSymbol(context, { before, letter, below }, x, y) {
  context.textAlign = "left";
  context.textBaseline = "middle";
  const fonts = letter
    ? ["15px serif", "italic 15px serif", "11px serif"]
    : ["12px system-ui, sans-serif", "", ""];
  [before, letter, below].forEach((text, k) => {
    if (!text) return;
    context.font = fonts[k];
    context.fillText(text, x, y + (k === 2 ? 4 : 0));
    x += context.measureText(text).width;
  });
}
