// Laws of force that a page offers beside that of its file: each has a module of its own.  The
// page starts again when another one is chosen.

// `window.tribo` is the interface of the page with the present law.
async function startPages(element, source) {
  const own = source.laws?.own;
  const sourceOf = (name) => (name === own ? source : { ...source.laws.sources[name], script: source.script });
  let stop = new AbortController();

  async function start(name, values) {
    stop.abort();
    stop = new AbortController();
    const { signal } = stop;
    const laws = { sources: {}, ...source.laws, present: name, choose };
    const page = await startPage(element, sourceOf(name), { values, signal, laws });
    if (!signal.aborted) window.tribo = page;
  }

  // Values of keys that the other law has not are left.
  async function choose(name, values = {}) {
    if (!source.laws) throw new Error("interaction is no value that this page can change");
    const names = [own, ...Object.keys(source.laws.sources)];
    if (!names.includes(name)) throw new Error(`interaction must be one of ${names.join(", ")}, got ${name}`);
    const { keys, choices } = sourceOf(name);
    const known = new Set([...keys, ...choices].map(({ key }) => key));
    await start(name, Object.fromEntries(Object.entries(values).filter(([key]) => known.has(key))));
  }

  const wanted = lawInAddress() ?? own;
  if (wanted === own) {
    await start(own, null);
    return;
  }
  try {
    await choose(wanted, valuesInAddress());
  } catch (error) {
    await start(own, null);
    element.querySelector("[data-part=status]").textContent = `${error.message} (in the address)`;
  }
}

// The choice among laws, before the sliders.
function addLaws({ part, state }, laws) {
  const outer = document.createElement("label");
  const select = document.createElement("select");
  for (const name of [laws.own, ...Object.keys(laws.sources)]) select.add(new Option(name));
  select.value = laws.present;
  select.dataset.part = "law";
  select.addEventListener("change", async () => {
    // Numbers of a law have other meanings in another one.
    const values = Object.entries(state.changes()).filter(([key]) => !key.startsWith("interaction."));
    const page = part("sliders").closest(".tribo");
    await laws.choose(select.value, Object.fromEntries(values));
    page.querySelector("[data-part=law]").focus();
  });
  outer.append(Object.assign(document.createElement("span"), { textContent: laws.label }), select);
  part("sliders").prepend(outer);
}
