// How charts look, in a page and in files: colours for what the specifications leave open.
"use strict";
globalThis.martiChartStyle = (ink, line) => ({
  background: "transparent",
  font: "system-ui, sans-serif",
  title: { color: ink, anchor: "start" },
  axis: { labelColor: ink, titleColor: ink, gridColor: line, domainColor: line, tickColor: line },
  legend: { labelColor: ink, titleColor: ink, labelLimit: 260 },
  header: { labelColor: ink, titleColor: ink },
  view: { stroke: line },
  mark: { color: "#0072B2" },
  text: { color: ink },
  // Okabe and Ito: told apart by everybody.
  range: { category: ["#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#999999", "#F0E442"] },
});
