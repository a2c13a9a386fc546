// Chromium, and a page that records what the loaded file does: every error that it reports, and
// every request that it makes. No request but that for the file itself is let through.
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

// The packages are in the build directory, not above this file.
const require = createRequire(join(process.env.MARTI_NODE_MODULES, "playwright-core", "package.json"));
const { chromium } = require("playwright-core");

export function startBrowser() {
  return chromium.launch({
    executablePath: process.env.MARTI_CHROMIUM,
    // Chromium has no sandbox for root, as whom containers run.
    args: process.getuid() === 0 ? ["--no-sandbox"] : [],
  });
}

/** What happens before any script of the file: counts of faults, and when the first chart is there. */
function watch() {
  window.watched = { violations: [], firstChart: null };
  document.addEventListener("securitypolicyviolation", (event) => {
    window.watched.violations.push(`${event.violatedDirective} at ${event.sourceFile}:${event.lineNumber}`);
  });
  new MutationObserver((_, observer) => {
    if (document.querySelector("[id^='chart-'] svg g.mark-group")) {
      window.watched.firstChart = performance.now();
      observer.disconnect();
    }
  }).observe(document, { childList: true, subtree: true });
}

function allDrawn() {
  const charts = [...document.querySelectorAll("[id^='chart-']")];
  const drawn = (chart) => window.marti?.views?.[chart.id.slice("chart-".length)] && chart.querySelector("svg");
  return document.readyState === "complete" && charts.length > 0 && charts.every(drawn);
}

/** Sizes in pixels; on mobile the page itself says how wide it wants to be. */
export const screen = { width: 1280, height: 900, mobile: false };

/** Gives the page another width, and waits until it has drawn all charts anew. */
export async function resize(page, size) {
  const session = await page.context().newCDPSession(page);
  await page.evaluate(() => {
    window.watched.before = { ...window.marti.views };
  });
  await session.send("Emulation.setDeviceMetricsOverride", { ...size, deviceScaleFactor: 1 });
  await page.waitForFunction(() => {
    const { marti, watched } = window;
    return Object.keys(watched.before).every((name) => marti.views[name] !== watched.before[name]);
  });
  await page.evaluate(async () => {
    for (const view of Object.values(window.marti.views)) await view.runAsync();
  });
}

/** The file in a page of its own, with all charts drawn. `options` are those of a Playwright context, `fragment` is the
 *  end of the address: "#name=value". */
export async function openFile(browser, file, options = {}, fragment = "") {
  const url = pathToFileURL(file).href;
  const context = await browser.newContext({ viewport: screen, ...options });
  const page = await context.newPage();
  const faults = [];
  await page.route("**/*", (route) => {
    const asked = route.request().url();
    if (asked.split("#")[0] === url) return route.continue();
    faults.push(`request of ${asked}`);
    return route.abort();
  });
  page.on("request", (request) => {
    if (!/^(data|blob):/.test(request.url()) && request.url().split("#")[0] !== url) faults.push(`request of ${request.url()}`);
  });
  page.on("websocket", (socket) => faults.push(`connection to ${socket.url()}`));
  page.on("pageerror", (error) => faults.push(`error: ${error.stack}`));
  page.on("console", (message) => {
    if (["error", "warning", "assert"].includes(message.type())) faults.push(`console: ${message.text()}`);
  });
  await page.addInitScript(watch);
  await page.goto(url + fragment);
  await page.waitForFunction(allDrawn, null, { timeout: 60000 });
  return {
    page,
    close: () => context.close(),
    /** Everything wrong so far. */
    faults: async () => [...faults, ...(await page.evaluate(() => window.watched.violations))],
  };
}
