// The tabs of the panels, of which one is open.

// `opened` is called when another is open; returns the function that opens one by its name.
function makeTabs(element, part, opened) {
  const tabs = [...element.querySelectorAll("[role=tabpanel]")];
  tabs.forEach((panel, k) => {
    const tab = Object.assign(document.createElement("button"), { type: "button", textContent: panel.dataset.tab });
    tab.setAttribute("role", "tab");
    tab.id = `tab${k}`;
    panel.setAttribute("aria-labelledby", tab.id);
    tab.addEventListener("click", () => openTab(k));
    tab.addEventListener("keydown", (event) => {
      const move = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!move) return;
      event.preventDefault();
      event.stopPropagation();
      openTab((k + move + tabs.length) % tabs.length, true);
    });
    part("tabs").append(tab);
  });

  function openTab(index, focus) {
    tabs.forEach((panel, k) => {
      panel.hidden = k !== index;
      const tab = part("tabs").children[k];
      tab.setAttribute("aria-selected", String(k === index));
      tab.tabIndex = k === index ? 0 : -1;
      if (focus && k === index) tab.focus();
    });
    opened();
  }

  return (name) => openTab(Math.max(0, tabs.findIndex((panel) => panel.dataset.tab === name)));
}
