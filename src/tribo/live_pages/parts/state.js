// The values of the page: the numbers of the module, and the keys that set them.

const LAW = "interaction"; // the key of the law of force

// `numbers` is the state; a key's value follows from the first number that it sets.
function makeState(source) {
  const initial = floatsOf(source.numbers);
  const numbers = initial.slice();
  const keys = new Map(source.keys.map((each) => [each.key, each]));
  const choices = new Map(source.choices.map((each) => [each.key, each]));
  const names = source.surfaces.map(({ name }) => name);

  // A key of each surface in place of one of all, as "*.asperite.m1".
  const each = (key) => (key.startsWith("*.") ? names.map((name) => name + key.slice(1)) : [key]);

  function setIn(target, key, value) {
    for (const own of each(key.replace(".initial.", "."))) {
      const choice = choices.get(own);
      if (choice) {
        if (!(value in choice.words)) throw new Error(`${own} must be one of ${Object.keys(choice.words).join(", ")}, got ${value}`);
        for (const [place, number] of choice.words[value]) target[place] = number;
        continue;
      }
      const found = keys.get(own);
      if (!found) throw new Error(`${own} is no value that this page can change; tribo play changes all values`);
      const number = Number(value);
      if (!Number.isFinite(number)) throw new Error(`${own} must be a number, got ${value}`);
      if (found.least !== null && (number < found.least || (number === found.least && found.open))) {
        throw new Error(`${own} must be ${found.open ? "positive" : "at least 0"}, got ${number}`);
      }
      for (const [place, factor, constant] of found.parts) target[place] = factor * number + constant;
    }
  }

  function valueIn(target, key) {
    const [own] = each(key);
    const choice = choices.get(own);
    if (choice) {
      return Object.keys(choice.words).find((word) => choice.words[word].every(([place, number]) => target[place] === number));
    }
    const found = keys.get(own);
    const [place, factor, constant] = found.parts[0];
    return target[place] === initial[place] ? found.value : (target[place] - constant) / factor;
  }

  // What differs from the file, each number by the first key that sets it.
  function changes() {
    const found = {};
    const done = new Set();
    for (const key of choices.keys()) {
      if (valueIn(numbers, key) !== valueIn(initial, key)) found[key] = valueIn(numbers, key);
    }
    for (const { key, parts } of source.keys) {
      const [place] = parts[0];
      if (numbers[place] !== initial[place] && !done.has(place)) found[key] = valueIn(numbers, key);
      done.add(place);
    }
    return found;
  }

  // The numbers with other values; the state stays.
  function numbersWith(values) {
    const target = numbers.slice();
    for (const [key, value] of Object.entries(values)) setIn(target, key, value);
    return target;
  }

  function set(values) {
    numbers.set(numbersWith(values));
  }

  const all = () => Object.fromEntries([...choices.keys(), ...keys.keys()].map((key) => [key, valueIn(numbers, key)]));
  return {
    numbers, keys, choices, numbersWith, set, changes, all, names,
    value: (key) => valueIn(numbers, key),
    reset: () => numbers.set(initial),
  };
}

// Values in the address, as #upper.velocity=0.3&upper.drive=free, and the law of force among them.
function partsOfAddress() {
  const parts = window.location.hash.slice(1).split("&").map((part) => part.split("=").map(decodeURIComponent));
  return parts.filter(([, value]) => value !== undefined);
}

const lawInAddress = () => partsOfAddress().find(([key]) => key === LAW)?.[1];
const valuesInAddress = () => Object.fromEntries(partsOfAddress().filter(([key]) => key !== LAW));

function readAddress(state) {
  const found = Object.entries(valuesInAddress());
  return Object.fromEntries(found.map(([key, value]) => [key, state.choices.has(key) ? value : Number(value)]));
}

function writeAddress(state, laws) {
  const law = laws.present !== laws.own ? [[LAW, laws.present]] : [];
  const parts = [...law, ...Object.entries(state.changes())].map(([key, value]) => `${key}=${encodeURIComponent(value)}`);
  const { pathname, search } = window.location;
  try {
    window.history.replaceState(null, "", parts.length ? `#${parts.join("&")}` : pathname + search);
  } catch { /* in some frames the address cannot change */ }
}
