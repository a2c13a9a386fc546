// How charts look, in a page and in files: colours for what the specifications leave open.
"use strict";
globalThis.martiChartStyle = (ink, line) => ({
  background: "transparent",
  font: "system-ui, sans-serif",
  title: { color: ink, subtitleColor: ink, subtitleFontSize: 10, anchor: "start" },
  axis: { labelColor: ink, titleColor: ink, gridColor: line, domainColor: line, tickColor: line },
  legend: { labelColor: ink, titleColor: ink, labelLimit: 260, symbolOpacity: 1 },
  header: { labelColor: ink, titleColor: ink },
  view: { stroke: line },
  mark: { color: "#0072B2", tooltip: true },
  text: { color: ink },
  // Okabe and Ito: told apart by everybody.
  range: { category: ["#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#999999", "#F0E442"] },
});

/** A title with what the chart is about in lines below it: which machine, and what it renders. */
globalThis.martiTitle = (text, about) => {
  const lines = [""];
  for (const word of about.split(" ")) {
    if (`${lines.at(-1)} ${word}`.length > 84) lines.push(word);
    else lines.push(`${lines.pop()} ${word}`.trim());
  }
  return about ? { text, subtitle: lines } : text;
};
