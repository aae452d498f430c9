// The choice of curves: of a surface or of the system, and which quantities.

const OFFERED = { surface: ["w1", "w1_ps", "w2", "w2_ps", "wL", "wR", "w", "delta_k_trans", "delta_e_int", "heat_bath"], system: ["contact_energy", "total_energy_change", "applied_work"] };

// Heat is that of a bath, which not every surface has.
const isKnown = (surface, name) => name !== "heat_bath" || Boolean(surface?.hasBath);

function makeCurveChoices({ part, source, update }) {
  const drawn = new Set(["w1", "w1_ps", "w2", "w2_ps", "total_energy_change", "applied_work"]);
  let group = source.surfaces[0].name;
  for (const { name } of source.surfaces) part("group").add(new Option(name));
  part("group").add(new Option("system"));

  function offer() {
    const surface = source.surfaces.find(({ name }) => name === group);
    const offered = OFFERED[surface ? "surface" : "system"].filter((name) => isKnown(surface, name));
    part("drawn").replaceChildren(...offered.map((name) => {
      const label = document.createElement("label");
      const tick = Object.assign(document.createElement("input"), { type: "checkbox", checked: drawn.has(name) });
      label.title = source.meanings[name];
      label.append(tick, typeset(name));
      label.style.setProperty("--own", `var(--${colourName(name, 0)})`);
      tick.setAttribute("aria-label", `draw ${source.meanings[name]}`);
      tick.addEventListener("change", () => {
        if (tick.checked) drawn.add(name);
        else drawn.delete(name);
        update();
      });
      return label;
    }));
  }

  part("group").addEventListener("change", () => {
    group = part("group").value;
    offer();
    update();
  });
  part("group").value = group = source.surfaces[source.subject].name;
  offer();
  return { drawn, group: () => group };
}
