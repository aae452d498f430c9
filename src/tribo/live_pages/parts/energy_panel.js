// The panel "Energy": energies that add up to the work put in, and powers at a time.

// Changes of all energies since the start, which add up to the work that was put in.
function energyRows(run, k) {
  const change = (name) => run.tables.reduce((sum, table) => sum + table[name][k] - table[name][0], 0);
  const system = tableOf(run.source, run.result, run.tables.length);
  const potential = (name) => (name in system ? system[name][k] - system[name][0] : 0);
  const all = (...names) => names.reduce((sum, name) => sum + (name in run.tables[0] ? change(name) : 0), 0);
  const rows = [
    { label: "translation", value: change("k_trans"), paint: "wT" },
    { label: "rotation", value: all("k_swing", "k_bar"), paint: "wL" },
    { label: "springs", value: all("e_torsion", "e_springs"), paint: "rod" },
    { label: "contact", value: potential("contact_energy") + potential("field_energy"), paint: "w1" },
  ];
  if (run.source.surfaces.some(({ hasBath }) => hasBath)) rows.push({ label: "baths", value: change("energy_bath"), paint: "heat" });
  rows.push({ label: "sum", value: rows.reduce((sum, { value }) => sum + value, 0), paint: "ink", line: true });
  rows.push({ label: "work put in", value: system.applied_work[k], paint: "w2" });
  return rows;
}

// Powers of a force at its point, and at the velocity of the centre of mass.
function powerRows(run, surface, k) {
  const table = run.tables[surface];
  return [
    { label: "friction, at the bob", value: table.p1[k], paint: "w1" },
    { label: "… at centre of mass", value: table.p1_cm[k], paint: "cm" },
    { label: "drive, at the bar", value: table.p2[k], paint: "w2", line: true },
    { label: "… at centre of mass", value: table.p2_cm[k], paint: "cm" },
  ].filter(({ value }) => Number.isFinite(value));
}

function largestOf(run, rowsAt) {
  let size = 0;
  const last = run.times.length - 1;
  for (let k = 0; k <= last; k += Math.max(1, Math.floor(last / 100))) {
    for (const { value } of rowsAt(k)) size = Math.max(size, Math.abs(value));
  }
  return size;
}

// `run` and `time` are functions that return the present ones.
function makeEnergyPanel({ part, source, isOpen, showAll, run, time }) {
  const scale = { energy: 0, power: 0 };
  source.surfaces.forEach(({ name }, index) => part("powerSurface").add(new Option(name, index)));
  part("powerSurface").value = source.subject;
  part("energy").classList.toggle("baths", source.surfaces.some(({ hasBath }) => hasBath));
  part("powerSurface").addEventListener("change", showAll);
  return function show(isNew) {
    if (!isOpen("energyPanel")) return;
    const surface = Number(part("powerSurface").value);
    if (isNew || !scale.energy) {
      scale.energy = roundUp(largestOf(run(), (k) => energyRows(run(), k)));
      scale.power = roundUp(largestOf(run(), (k) => powerRows(run(), surface, k)));
    }
    const k = nearestTo(run().times, time());
    drawBars(part("energy"), energyRows(run(), k), scale.energy);
    drawBars(part("power"), powerRows(run(), surface, k), scale.power);
  };
}
