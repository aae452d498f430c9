// The choice of curves: of a surface or of the system, and which quantities.

const OFFERED = { surface: ["w1", "w1_ps", "w2", "w2_ps", "wL", "wR", "w", "delta_k_trans", "delta_e_int"], system: ["contact_energy", "total_energy_change", "applied_work"] };

function makeCurveChoices({ part, source, update }) {
  const drawn = new Set(["w1", "w1_ps", "w2", "w2_ps", "total_energy_change", "applied_work"]);
  let group = source.surfaces[0].name;
  for (const { name } of source.surfaces) part("group").add(new Option(name));
  part("group").add(new Option("system"));

  function offer() {
    part("drawn").replaceChildren(...OFFERED[group === "system" ? "system" : "surface"].map((name) => {
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
