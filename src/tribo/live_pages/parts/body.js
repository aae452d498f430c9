// The elements of a page, and its words in Markdown.

const BODY = `
<header><h1 data-part="title"></h1><p class="status" role="status" data-part="status"></p></header>
<div class="introduction" data-part="introduction" hidden></div>
<section class="motion" aria-label="Motion">
  <div class="scenes">
    <figure><canvas role="img" aria-label="The asperites" data-part="scene"></canvas></figure>
    <figure data-part="keptFigure" hidden><canvas role="img" aria-label="The kept state" data-part="keptScene"></canvas><figcaption data-part="keptName"></figcaption></figure>
  </div>
  <div class="playback" role="group" aria-label="Playback">
    <button type="button" aria-pressed="false" data-part="play">Play</button>
    <input type="range" min="0" step="any" aria-label="Time" data-part="time">
    <output data-part="clock"></output>
    <label><input type="checkbox" checked data-part="forces"> Forces</label>
    <label><input type="checkbox" data-part="velocities"> Velocities</label>
    <label><input type="checkbox" data-part="traces"> Traces</label>
    <button type="button" data-part="mark" title="Displacements are measured from the present time">Mark</button>
    <button type="button" aria-pressed="false" data-part="keep">Keep beside</button>
  </div>
  <p class="marked" data-part="marked" hidden></p>
</section>
<section class="graph" aria-label="Curves">
  <canvas role="img" aria-label="Works over time" class="curves" data-part="curves"></canvas>
  <div class="choices"><label>Of <select data-part="group"></select></label><span data-part="drawn"></span></div>
</section>
<section class="values" aria-label="Values of the scene">
  <div data-part="sliders"></div>
  <div class="buttons"><button type="button" data-part="reset">Reset</button></div>
  <details data-part="every"><summary>All values</summary><div data-part="all"></div></details>
</section>
<section class="panel" aria-label="Results">
  <div class="tabs" role="tablist" data-part="tabs"></div>
  <div role="tabpanel" tabindex="0" data-part="endPanel" data-tab="End value">
    <label>End of <select data-part="endQuantity"></select></label> <label>against <select data-part="endKey"></select></label> <label>and <select data-part="endSecond"><option value="">no other</option></select></label>
    <canvas class="end" role="img" aria-label="End value against a control" data-part="end"></canvas>
    <label><input type="checkbox" checked data-part="lengthen"> each run until the bobs have passed</label>
  </div>
  <div role="tabpanel" tabindex="0" data-part="energyPanel" data-tab="Energy" hidden>
    <p>Change since the start, both surfaces. The energies add up to the work put in.</p>
    <canvas class="bars" role="img" aria-label="Energies" data-part="energy"></canvas>
    <p>Power on <select aria-label="Surface" data-part="powerSurface"></select> now: at the point where the force acts, and at the velocity of the centre of mass.</p>
    <canvas class="powers" role="img" aria-label="Powers" data-part="power"></canvas>
  </div>
  <div role="tabpanel" tabindex="0" data-part="numbersPanel" data-tab="Numbers" hidden>
    <label class="observer">Observer’s velocity <input type="range" min="-1" max="1" step="0.01" value="0" data-part="observer"> <output data-part="observerShown">0</output></label>
    <div class="scroll" tabindex="0" role="region" aria-label="Quantities"><table><thead><tr><th scope="col">Quantity</th><th scope="col" data-part="now"></th><th scope="col">at the end</th><th scope="col">error up to</th></tr></thead><tbody data-part="table"></tbody></table></div>
  </div>
  <div role="tabpanel" tabindex="0" data-part="startsPanel" data-tab="Many starts" hidden>
    <label>Starts <select data-part="startsKind"><option value="temperature">in thermal equilibrium</option><option value="amplitude">with swings of equal energy</option></select></label>
    <label><span data-part="startsLabel"></span> <input type="range" min="0.02" max="2" step="0.02" value="1" data-part="amplitude"> <output data-part="amplitudeShown">1</output></label>
    <label>Histogram of <select data-part="startsQuantity"><option value="delta_e_int">energy gained by both swings</option></select></label>
    <p data-part="startsSentence"></p>
    <canvas class="starts" role="img" aria-label="Histogram of works" data-part="starts"></canvas>
    <button type="button" data-part="more">Start</button> <label><input type="checkbox" data-part="mirrored"> reflected at zero</label>
  </div>
  <div role="tabpanel" tabindex="0" data-part="filesPanel" data-tab="Files" hidden>
    <p class="buttons"><button type="button" data-part="csv">CSV</button> <button type="button" data-part="png">PNG</button> <button type="button" data-part="toml">Scene (TOML)</button></p>
    <p>The same numbers in Python:</p><pre tabindex="0" data-part="python"></pre>
    <p>The address of this page holds the values: <a data-part="link">this state</a></p>
  </div>
</section>
<footer><p>Space: play or pause. Arrow keys: one sample back or on. Before the start, drag a bob to swing it or a bar to move it. Dashed curves are pseudoworks. Units are those of the scene.</p><div data-part="questions" hidden></div></footer>`;

// A few forms of Markdown: paragraphs, lists, emphasis, in elements of the page.
function addMarkdown(element, text) {
  for (const block of text.split(/\n\s*\n/)) {
    const lines = block.trim().split("\n");
    const isList = lines.every((line) => /^(-|\d+\.)\s/.test(line));
    const outer = document.createElement(isList ? (/^\d/.test(lines[0]) ? "ol" : "ul") : "p");
    for (const line of isList ? lines : [lines.join(" ")]) {
      const inner = isList ? outer.appendChild(document.createElement("li")) : outer;
      line.replace(isList ? /^(-|\d+\.)\s+/ : /^$/, "").split(/(\*\*.+?\*\*|\*.+?\*)/).forEach((piece) => {
        const found = /^(\*\*?)(.+)\1$/.exec(piece);
        if (!found) inner.append(piece);
        else inner.appendChild(document.createElement(found[1] === "**" ? "strong" : "em")).textContent = found[2];
      });
    }
    element.append(outer);
  }
}
