// Light or dark: as the system has it, until the reader chooses.
"use strict";
window.marti = { views: {}, ready: null };

marti.theme = (() => {
  const order = ["system", "light", "dark"];
  const button = document.getElementById("theme");
  let chosen = "system";

  button.addEventListener("click", () => {
    chosen = order[(order.indexOf(chosen) + 1) % order.length];
    if (chosen === "system") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = chosen;
    button.textContent = `Colours: ${chosen}`;
    button.setAttribute("aria-label", `Colours: ${chosen}. Change`);
  });

  return {
    // The page's own colours, so that charts follow when those change, on paper too.
    inPage: martiChartStyle("var(--ink)", "var(--line)"),
    // A file of its own has no page around it.
    inFile: { ...martiChartStyle("#333333", "#dddddd"), background: "white" },
  };
})();
