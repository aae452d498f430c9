// Many starts in a worker: swings whose largest angle is given, with random phases.

const BATCH = 20;

function startWorker(source, numbers, amplitude, lengthen) {
  const code = `"use strict";\n${source.script}\n(${workerMain.toString()})();`;
  const worker = new Worker(URL.createObjectURL(new Blob([code], { type: "text/javascript" })));
  worker.postMessage({ source: { ...source, script: "" }, numbers: numbers.slice(), amplitude, lengthen, batch: BATCH });
  return worker;
}

function workerMain() {
  self.onmessage = async ({ data: { source, numbers, amplitude, lengthen, batch } }) => {
    const program = makeProgram(await startMachine(source), source, 2);
    const options = { level: 10 * source.level, amplitude };
    const row = (source.subject * source.names.asperite.length + source.names.asperite.indexOf("w1")) * 2;
    for (;;) {
      const found = [];
      while (found.length < batch) {
        const own = numbers.slice();
        options.phases = [2 * Math.PI * Math.random(), 2 * Math.PI * Math.random()];
        let result = program(own, options);
        if (lengthen && result.code === 0 && !result.passed && result.needed > own[source.duration]) {
          own[source.duration] = result.needed;
          result = program(own, options);
        }
        if (result.code === 0) found.push(result.series[row + 1]);
      }
      self.postMessage(found);
      await new Promise((resolve) => { setTimeout(resolve, 0); });
    }
  };
}
