// The panel "Files": series, picture and scene to download, and lines of Python.

// `run` is a function that returns the present run.
function makeFilesPanel({ part, source, state, isOpen, run }) {
  function show(isNew) {
    if (!isNew || !isOpen("filesPanel")) return;
    const lines = Object.entries(state.changes()).map(([key, value]) => `    "${key}": ${JSON.stringify(value)},\n`).join("");
    part("python").textContent = `import tribo\nfrom tribo.model.parameters import with_values\n\nscene = tribo.load_scene("scene.toml")  # the file of this page\nscene = with_values(scene, {\n${lines}})\nresult = tribo.simulate(scene, method="${source.method}")\nprint(result["${source.surfaces[source.subject].name}"].w1[-1, 0])\n`;
    part("link").href = window.location.href;
  }

  function download(name, type, content) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
    link.download = name;
    link.click();
    window.setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  part("csv").addEventListener("click", () => {
    const columns = [["t", run().times]];
    run().groups.forEach(({ name }, index) => Object.entries(tableOf(source, run().result, index)).forEach(([quantity, values]) => {
      columns.push([index < source.surfaces.length ? `${name}.${quantity}` : quantity, values]);
    }));
    const rows = Array.from(run().times, (_, k) => columns.map(([, values]) => values[k]).join(","));
    download("run.csv", "text/csv", `${[columns.map(([name]) => name).join(","), ...rows].join("\n")}\n`);
  });
  part("png").addEventListener("click", () => {
    const both = [part("scene"), part("curves")];
    const picture = document.createElement("canvas");
    picture.width = Math.max(...both.map((each) => each.width));
    picture.height = both.reduce((sum, each) => sum + each.height, 0);
    const context = picture.getContext("2d");
    context.fillStyle = colour(part("scene"), "back");
    context.fillRect(0, 0, picture.width, picture.height);
    context.drawImage(both[0], 0, 0);
    context.drawImage(both[1], 0, both[0].height);
    picture.toBlob((blob) => download("run.png", "image/png", blob));
  });
  part("toml").addEventListener("click", () => {
    const sets = Object.entries(state.changes()).map(([key, value]) => ` --set ${key}=${value}`).join("");
    download("scene.toml", "text/plain", `${sets ? `# The page showed: tribo run scene.toml${sets}\n\n` : ""}${source.toml}`);
  });
  return show;
}
