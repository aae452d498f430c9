// The module of the page: its memory, and calls of its program.  All physics is in the module.

const STACK = 262144; // the stack ends here and grows down; arrays begin here
const MATH = {
  sin: Math.sin, cos: Math.cos, tan: Math.tan, exp: Math.exp, log: Math.log, pow: Math.pow, hypot: Math.hypot,
  sqrt: Math.sqrt, expm1: Math.expm1, log1p: Math.log1p, tanh: Math.tanh, sinh: Math.sinh, cosh: Math.cosh,
  atan: Math.atan, atan2: Math.atan2, asin: Math.asin, acos: Math.acos, cbrt: Math.cbrt,
};

const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
const floatsOf = (text) => new Float64Array(bytesOf(text).buffer);

// The bytes of a text that zlib has compressed.
async function inflated(text) {
  const stream = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

// Compiles the module; rejects where a site's policy forbids it.
async function startMachine(source) {
  const memory = new WebAssembly.Memory({ initial: 16 });
  const env = {
    ...MATH,
    __linear_memory: memory,
    __stack_pointer: new WebAssembly.Global({ value: "i32", mutable: true }, STACK),
    __indirect_function_table: new WebAssembly.Table({ initial: 64, element: "anyfunc" }),
  };
  const content = source.kind === "lattice" ? await inflated(source.module) : bytesOf(source.module);
  const { instance } = await WebAssembly.instantiate(content, { env });
  return { memory, exports: instance.exports, top: STACK };
}

function roomFor(machine, bytes) {
  const place = machine.top;
  machine.top += Math.ceil(bytes / 64) * 64;
  const missing = machine.top - machine.memory.buffer.byteLength;
  if (missing > 0) machine.memory.grow(Math.ceil(missing / 65536));
  return place;
}

// An array as numba's functions take it: no owner, sizes, the address, shape and strides.
function arrayArguments(place, shape, item) {
  const strides = [];
  let size = item;
  for (let k = shape.length - 1; k >= 0; k -= 1) {
    strides[k] = size;
    size *= shape[k];
  }
  return [0, 0, BigInt(size / item), BigInt(item), place, ...shape.map(BigInt), ...strides.map(BigInt)];
}

// The program for so many samples: a function of all numbers, of options by their names, and of
// whether errors are estimated.
function makeProgram(machine, source, samples) {
  const places = {};
  const shapes = {};
  const arrays = [];
  for (const { name, shape, item } of source.arrays) {
    const known = shape.map((size) => ({ [-1]: samples, [-2]: samples + 1 })[size] ?? size);
    places[name] = roomFor(machine, item * known.reduce((a, b) => a * b, 1));
    shapes[name] = known;
    arrays.push(...arrayArguments(places[name], known, item));
  }
  const potential = source.potential.map((each) => {
    if (typeof each === "number") return [each]; // its place among the numbers
    const values = floatsOf(each.values);
    const place = roomFor(machine, values.byteLength);
    new Float64Array(machine.memory.buffer).set(values, place / 8);
    return arrayArguments(place, [values.length], 8);
  });
  const results = [roomFor(machine, 16), roomFor(machine, 16)];
  const floats = (name) => {
    const size = shapes[name].reduce((a, b) => a * b, 1);
    return new Float64Array(machine.memory.buffer, places[name], size);
  };
  floats("memory").set(floatsOf(source.memory));
  const { inputs, places: at } = source;
  return function run(numbers, options) {
    floats("numbers").set(numbers.subarray(0, inputs));
    const own = floats("options").fill(0);
    own[at.LEVEL] = options.level ?? source.level;
    own[at.NEAR] = source.near;
    own[at.MOST_STEPS] = source.most;
    own[at.AMPLITUDE] = options.amplitude ?? 0; // of swings at random phases, for many starts
    own[at.TEMPERATURE] = options.temperature ?? 0;
    [own[at.PHASE1], own[at.PHASE2]] = options.phases ?? [0, 0];
    [own[at.DRAWN1], own[at.DRAWN2]] = options.drawn ?? [0, 0];
    own[at.ROUGH] = source.rough ? 1 : 0; // a derivative of the force jumps
    own[at.ESTIMATE] = options.estimate ? 1 : 0;
    const flat = potential.flatMap((each, k) => (typeof source.potential[k] === "number" ? [numbers[each[0]]] : each));
    machine.exports.run(...results, ...flat, ...arrays);
    const code = new DataView(machine.memory.buffer).getInt32(results[0], true);
    return {
      code,
      samples,
      reached: own[at.REACHED],
      evaluations: own[at.EVALUATIONS],
      passed: own[at.PASSED] === 1,
      needed: own[at.NEEDED],
      t: floats("times").slice(0, own[at.REACHED]),
      series: floats("series").slice(),
      errors: options.estimate ? floats("errors").slice() : null,
    };
  };
}
