// The panel "Many starts": swings with random phases, at a temperature or of equal energy.

const RARE = 0.05; // the part of a sum from which a single run decides it

function makeStartsPanel({ part, source, state, isOpen, signal }) {
  let starts = null;
  const gains = [];
  for (const { name } of source.surfaces) part("startsQuantity").add(new Option(`work of friction on ${name}`, name));

  function showStarts() {
    const kind = part("startsKind").value;
    const size = Number(part("amplitude").value);
    part("startsLabel").textContent = kind === "temperature" ? "Temperature" : "Largest swing";
    part("amplitudeShown").textContent = part("amplitude").value;
    const what = part("startsQuantity").selectedOptions[0].textContent;
    const mean = meanOf(gains);
    let said = `Of ${gains.length} runs, ${Math.round((100 * gains.filter((w) => w < 0).length) / gains.length)} % are below zero; mean ${shownWithError(mean)}.`;
    if (kind === "temperature" && part("startsQuantity").value === "delta_e_int") {
      const terms = gains.map((w) => Math.exp(-w / size));
      said += ` The mean of exp(−gain / temperature) is ${shownWithError(meanOf(terms))}.`;
      const isRare = Math.max(...terms) > RARE * terms.reduce((a, b) => a + b, 0);
      if (isRare) said += " A few rare runs decide this mean, so that its error is not known; a higher temperature has more of them.";
    }
    part("startsSentence").textContent = gains.length ? said : "Each start gives another value.";
    drawHistogram(part("starts"), gains, part("mirrored").checked, what);
  }

  function stopStarts() {
    starts?.terminate();
    starts = null;
    part("more").textContent = "Start";
  }

  signal.addEventListener("abort", stopStarts);

  function clearStarts() {
    stopStarts();
    gains.length = 0;
  }

  part("more").addEventListener("click", () => {
    if (starts !== null) {
      stopStarts();
      return;
    }
    if (gains.length >= MOST_STARTS) clearStarts();
    const { asperite } = source.names;
    const chosenName = part("startsQuantity").value;
    const index = source.surfaces.findIndex(({ name }) => name === chosenName);
    const rows = index < 0 ? [0, 1].map((k) => k * asperite.length + asperite.indexOf("delta_e_int")) : [index * asperite.length + asperite.indexOf("w1")];
    const swings = { [part("startsKind").value]: Number(part("amplitude").value) };
    starts = startWorker(source, state.numbers, swings, rows, part("lengthen").checked);
    part("more").textContent = "Stop";
    starts.onmessage = ({ data }) => {
      gains.push(...data);
      showStarts();
      if (gains.length >= MOST_STARTS) stopStarts();
    };
    starts.onerror = () => stopStarts();
  });
  for (const name of ["amplitude", "startsKind", "startsQuantity"]) {
    part(name).addEventListener("input", () => {
      clearStarts();
      showStarts();
    });
  }
  part("mirrored").addEventListener("change", showStarts);
  return function show(isNew) {
    if (isNew) clearStarts();
    if (isOpen("startsPanel")) showStarts();
  };
}
