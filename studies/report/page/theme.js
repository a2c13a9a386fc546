// Light or dark: as the system has it, until the reader chooses.
"use strict";
window.marti = { views: {}, specs: {}, ready: null };

marti.theme = (() => {
  const order = ["system", "light", "dark"];
  const button = document.getElementById("theme");
  const listeners = [];
  let chosen = "system";

  const isDark = () =>
    chosen === "dark" || (chosen === "system" && matchMedia("(prefers-color-scheme: dark)").matches);

  function show() {
    if (chosen === "system") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = chosen;
    button.textContent = `Colours: ${chosen}`;
    button.setAttribute("aria-label", `Colours: ${chosen}. Change`);
    for (const listener of listeners) listener();
  }

  button.addEventListener("click", () => {
    chosen = order[(order.indexOf(chosen) + 1) % order.length];
    show();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);

  /** What a chart is drawn with; SVG files are always light. */
  function config(dark) {
    const ink = dark ? "#d8d8d8" : "#333333";
    const line = dark ? "#4a4f57" : "#dddddd";
    return {
      background: "transparent",
      font: "system-ui, sans-serif",
      title: { color: ink, anchor: "start" },
      axis: { labelColor: ink, titleColor: ink, gridColor: line, domainColor: line, tickColor: line },
      legend: { labelColor: ink, titleColor: ink, labelLimit: 260 },
      header: { labelColor: ink, titleColor: ink },
      view: { stroke: line },
      // Okabe and Ito: told apart by everybody.
      range: { category: ["#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#999999", "#F0E442"] },
    };
  }
  return { isDark, config, changed: (listener) => listeners.push(listener) };
})();
