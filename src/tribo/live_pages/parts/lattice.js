// Rows and grids: the image of a time loop's memory, and the calls of a run.  All physics is in the
// module.

const MORE = 2; // steps of the coarser run, in units of those of the run that is shown
const HALVINGS = 5; // of the step of the file, at most, where errors are larger than wanted

// Puts the image into the memory: its words where they will stand, with addresses and units.
async function placeImage(machine, source) {
  const { image } = source;
  const base = roomFor(machine, image.size);
  const words = new DataView(await inflated(image.words));
  for (const place of image.addresses) words.setUint32(8 * place, words.getUint32(8 * place, true) + base, true);
  for (const [place, number] of image.units) words.setUint32(8 * place, machine.exports.unit(number), true);
  machine.image = { base, words: new Uint8Array(words.buffer), results: roomFor(machine, 64) };
}

// The program of full or of short runs, with the interface of `makeProgram`.
function makeLatticeProgram(machine, source, name) {
  const { base, words, results } = machine.image;
  const own = floatsOf(source.numbers);
  const places = source.results[name];
  const argumentsOf = {
    number: (value) => value, integer: BigInt, place: (value) => base + value, null: () => 0,
  };
  const calls = Object.fromEntries(Object.entries(source.calls[name]).map(([key, list]) => [key, list.map(([kind, value]) => argumentsOf[kind](value))]));
  const step = source.calls[name].steps.findIndex(([kind]) => kind === "number");
  const floats = (key) => new Float64Array(machine.memory.buffer, base + places[key][0], places[key][1]);
  const copy = (from, to) => new Uint8Array(machine.memory.buffer).copyWithin(base + places[to][0], base + places[from][0], base + places[from][0] + 8 * places[from][1]);

  function call(key, list) {
    machine.exports[key](results, results + 32, ...list);
    return new DataView(machine.memory.buffer).getInt32(results, true);
  }

  // The image with other numbers.
  function place(numbers) {
    new Uint8Array(machine.memory.buffer).set(words, base);
    const memory = new Float64Array(machine.memory.buffer, base);
    source.words.forEach((groups, key) => {
      const change = numbers[key] - own[key];
      if (change === 0) return;
      for (const [factor, own_] of groups) for (const place of own_) memory[place] += factor * change;
    });
    call("setup", calls.setup);
  }

  // Steps end at samples: of the coarser run, at least one lies between two, and of others two.
  function longestStep(numbers) {
    place(numbers);
    const shortest = floats("times").reduce((least, t, k, times) => (k ? Math.min(least, t - times[k - 1]) : least), Infinity);
    return Math.min(source.step, shortest / MORE);
  }

  // One run with steps of a length, and its quantities.
  function once(numbers, length) {
    place(numbers);
    const list = calls.steps.slice();
    list[step] = length;
    const code = call("steps", list);
    call("quantities", calls.quantities);
    return code;
  }

  return function run(numbers, { estimate = false } = {}) {
    const isTooLong = () => source.tooLong.includes(code);
    let length = longestStep(numbers);
    let code = once(numbers, estimate ? MORE * length : length);
    for (let n = 0, missed = estimate || isTooLong(); missed && n <= HALVINGS; n += 1) {
      copy("series", "other");
      copy("reached", "others");
      if (n > 0 || !estimate) length /= MORE;
      code = once(numbers, length);
      missed = (estimate && call("errors", calls.errors) !== 0) || isTooLong();
    }
    const reached = Number(new BigInt64Array(machine.memory.buffer, base + places.reached[0], 1)[0]);
    return {
      code,
      samples: places.times[1],
      reached,
      passed: true,
      needed: 0,
      t: floats("times").slice(0, reached),
      series: floats("series").slice(),
      drawn: estimate ? floats("drawn").slice() : null,
      errors: estimate ? floats("errors").slice() : null,
    };
  };
}
