// Many starts in a worker: swings at random phases, of one largest angle or of one temperature.

const BATCH = 20;

// `swings` has the `amplitude` or the `temperature`; each run gives the sum of `rows` at its end.
function startWorker(source, numbers, swings, rows, lengthen) {
  const code = `"use strict";\n${source.script}\n(${workerMain.toString()})();`;
  const worker = new Worker(URL.createObjectURL(new Blob([code], { type: "text/javascript" })));
  worker.postMessage({ source: { ...source, script: "", laws: null }, numbers: numbers.slice(), swings, rows, lengthen, batch: BATCH });
  return worker;
}

function workerMain() {
  self.onmessage = async ({ data: { source, numbers, swings, rows, lengthen, batch } }) => {
    const program = makeProgram(await startMachine(source), source, 2);
    const options = { level: 10 * source.level, ...swings };
    for (;;) {
      const found = [];
      while (found.length < batch) {
        const own = numbers.slice();
        options.phases = [2 * Math.PI * Math.random(), 2 * Math.PI * Math.random()];
        options.drawn = [Math.random(), Math.random()];
        let result = program(own, options);
        if (lengthen && result.code === 0 && result.needed > own[source.duration]) {
          own[source.duration] = result.needed;
          result = program(own, options);
        }
        if (result.code === 0) found.push(rows.reduce((sum, row) => sum + result.series[2 * row + 1], 0));
      }
      self.postMessage(found);
      await new Promise((resolve) => { setTimeout(resolve, 0); });
    }
  };
}
