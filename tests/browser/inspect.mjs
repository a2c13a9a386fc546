// The contents of an open page (browser.mjs): functions for tests, which run in the page itself.

/** Names of the charts, in the order of the page. */
export const chartNames = (page) =>
  page.$$eval("[id^='chart-']", (charts) => charts.map((chart) => chart.id.slice("chart-".length)));

/** The rows that a chart was given: those of the first of its data sets, without Vega's own fields. */
export const rowsOf = (page, name) =>
  page.evaluate((name) => {
    const sets = window.marti.views[name].getState({ data: () => true, signals: () => false }).data;
    const given = Object.keys(sets).find((set) => set !== "root" && Array.isArray(sets[set]));
    return window.marti.views[name].data(given).map((row) => ({ ...row }));
  }, name);

const dataMarks = (name) => `#chart-${name} svg .role-mark:not([aria-hidden='true']) > *`;

/** How many marks that show data a chart draws; axes and legends are none. */
export const markCount = (page, name) => page.locator(dataMarks(name)).count();

/** Where these marks are, and how large, in pixels. */
export const markBoxes = (page, name) =>
  page.$$eval(dataMarks(name), (marks) => marks.map((mark) => mark.getBBox()).map(({ width, height }) => ({ width, height })));

/** The drawing as it is: another one after something has moved. */
export const drawing = (page, name) => page.$eval(`#chart-${name} svg`, (svg) => svg.outerHTML);

/** Colours that readers see: of the page, of its text, and of a chart's labels. */
export const colours = (page) =>
  page.evaluate(() => {
    const style = getComputedStyle(document.body);
    const label = document.querySelector("[id^='chart-'] svg .role-axis-label text");
    return { page: style.backgroundColor, text: style.color, label: label && getComputedStyle(label).fill };
  });

/** By how many pixels the page is wider than what shows it, and the elements that stick out. */
export const overflow = (page) =>
  page.evaluate(() => {
    const width = document.documentElement.clientWidth;
    const scrolled = (element) =>
      element && (/auto|scroll|hidden/.test(getComputedStyle(element).overflowX) || scrolled(element.parentElement));
    const wide = [...document.body.querySelectorAll("*")]
      .filter((element) => element.checkVisibility() && element.getBoundingClientRect().right > width + 1)
      .filter((element) => !scrolled(element.parentElement))
      .map((element) => `${element.tagName} ${element.id || element.className?.baseVal || element.className}`);
    return { pixels: document.documentElement.scrollWidth - width, elements: wide.slice(0, 5) };
  });

/** What does not fit a page of A4 with the browser's margins, charts that are wider than their place, and controls, which
 *  paper has no use for. As in printing, charts are not drawn anew. */
export async function onPaper(page) {
  const session = await page.context().newCDPSession(page);
  const width = 718;
  await session.send("Emulation.setDeviceMetricsOverride", { width, height: 1000, deviceScaleFactor: 1, mobile: false });
  const beyond = await overflow(page);
  const shown = await page.evaluate(() => {
    const visible = (element) => element.checkVisibility() && element.getBoundingClientRect().width > 0;
    const controls = [...document.querySelectorAll("button, select, input, nav")].filter((element) => !element.closest("table") && visible(element));
    const charts = [...document.querySelectorAll("[id^='chart-'] > svg, [id^='chart-'] svg.marks")];
    const wider = charts.filter((svg) => svg.getBoundingClientRect().width > svg.closest("figure").clientWidth + 1);
    return { wider: wider.map((svg) => svg.parentElement.id), controls: controls.map((element) => element.id) };
  });
  await session.send("Emulation.clearDeviceMetricsOverride");
  return { ...beyond, ...shown };
}

/** What has no name for those who do not see it, and what else they would miss. */
export const unnamed = (page) =>
  page.evaluate(() => {
    const texts = (ids) => (ids ?? "").split(" ").map((id) => document.getElementById(id)?.textContent ?? "");
    const nameOf = (element) =>
      [
        element.getAttribute("aria-label"),
        ...texts(element.getAttribute("aria-labelledby")),
        ...[...(element.labels ?? [])].map((label) => label.textContent),
        element.getAttribute("alt"),
        /^(A|BUTTON|SUMMARY)$/.test(element.tagName) ? element.textContent : "",
      ].join("");
    const faults = [];
    for (const element of document.querySelectorAll("input, select, textarea, button, a[href], summary, img")) {
      if (nameOf(element).trim() === "") faults.push(element.outerHTML.slice(0, 120));
    }
    for (const svg of document.querySelectorAll("svg")) {
      const named = svg.closest("[aria-label], [aria-labelledby], [aria-hidden='true']");
      if (!named || (named.ariaHidden !== "true" && nameOf(named).trim() === "")) faults.push(svg.outerHTML.slice(0, 120));
    }
    const ids = [...document.querySelectorAll("[id]")].map((element) => element.id);
    faults.push(...ids.filter((id, i) => ids.indexOf(id) !== i).map((id) => `two elements are called ${id}`));
    if (!document.documentElement.lang) faults.push("the page names no language");
    if (!document.title) faults.push("the page has no title");
    if (document.querySelectorAll("h1").length !== 1) faults.push("the page wants one h1");
    return faults;
  });

const saved = new WeakMap(); // by page: when each file came

/** The text of the file that a click on the link gives. */
export async function download(page, link) {
  // Chromium lets a page save ten files in a second, and drops the next without a word.
  const times = saved.get(page) ?? [];
  saved.set(page, times);
  if (times.length >= 10) await page.waitForTimeout(Math.max(0, times.at(-10) + 1100 - performance.now()));
  const [file] = await Promise.all([page.waitForEvent("download"), link.click()]);
  times.push(performance.now());
  const chunks = [];
  for await (const chunk of await file.createReadStream()) chunks.push(chunk);
  return { name: file.suggestedFilename(), text: Buffer.concat(chunks).toString("utf8") };
}
