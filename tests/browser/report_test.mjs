// The pages of `marti report` in a browser: what they draw is what the results hold, they ask for nothing, and
// everybody can use them.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, readdirSync, statSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";
import { openFile, startBrowser } from "./browser.mjs";
import {
  chartNames,
  colours,
  dataOf,
  dataSets,
  download,
  drawing,
  markCount,
  overflow,
  rowsOf,
  unnamed,
} from "./inspect.mjs";
import { makeReports, parseCsv, readCsv, readJson } from "./results.mjs";

const reports = makeReports();
const pictures = process.env.MARTI_PICTURES;
const phone = { viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true };

/** Equal but for the last digits, which differ between numbers printed for people and for programs. */
function assertClose(a, b, what) {
  if (typeof a !== "number" || typeof b !== "number") return assert.equal(a ?? null, b ?? null, what);
  assert.ok(Math.abs(a - b) <= 1e-9 * Math.max(Math.abs(a), Math.abs(b)), `${what}: ${a} and ${b}`);
}

function assertRows(shown, expected, what) {
  assert.equal(shown.length, expected.length, `rows of ${what}`);
  expected.forEach((row, i) => {
    for (const [column, value] of Object.entries(row)) assertClose(shown[i][column], value, `${what}: ${column} of row ${i}`);
  });
}

const saveLink = (page, name, kind) => page.locator(`a[data-save="${kind}"][data-chart="${name}"]`);

let browser;
before(async () => {
  browser = await startBrowser();
  if (pictures) mkdirSync(pictures, { recursive: true });
});
after(() => browser?.close());

/** Opens a page, hands it to `use`, and wants it to have done nothing wrong by then. */
async function withPage(kind, options, use) {
  const opened = await openFile(browser, reports[kind].page, options);
  try {
    await use(opened.page);
    assert.deepEqual(await opened.faults(), []);
  } finally {
    await opened.close();
  }
}

for (const [kind, report] of Object.entries(reports)) {
  describe(`the page of a ${kind}`, () => {
    it("draws every chart, without fault and without asking for anything", () =>
      withPage(kind, {}, async (page) => {
        const names = await chartNames(page);
        assert.ok(names.length > 0);
        for (const name of names) assert.ok((await markCount(page, name)) > 0, `${name} shows nothing`);
        const first = await page.evaluate(() => window.watched.firstChart);
        const bytes = statSync(report.page).size;
        console.log(`# ${kind}: ${names.length} charts, ${bytes} bytes, first chart after ${Math.round(first)} ms`);
        assert.ok(bytes < 3e6, `${bytes} bytes`);
      }));

    it("gives the rows of every chart as CSV", () =>
      withPage(kind, { acceptDownloads: true }, async (page) => {
        for (const name of await chartNames(page)) {
          const file = await download(page, saveLink(page, name, "csv"));
          assert.equal(file.name, `${name}.csv`);
          const rows = parseCsv(file.text);
          assert.ok(rows.length > 0, name);
          assertRows(await rowsOf(page, name), rows, name);
          // The explorer adds to a chart's rows what its controls say.
          assertRows(rows.slice(0, -1), readCsv(join(report.plots, `${name}.csv`)).slice(0, rows.length - 1), `${name} beside its plot`);
        }
      }));

    it("gives every chart as SVG", () =>
      withPage(kind, { acceptDownloads: true }, async (page) => {
        for (const name of await chartNames(page)) {
          const file = await download(page, saveLink(page, name, "svg"));
          assert.equal(file.name, `${name}.svg`);
          assert.match(file.text, /^<svg [^]*<\/svg>\s*$/, name);
          assert.match(readFileSync(join(report.plots, `${name}.svg`), "utf8"), /^<svg [^]*<\/svg>\s*$/, name);
        }
      }));

    it("fits a phone", () =>
      withPage(kind, phone, async (page) => {
        assert.deepEqual(await overflow(page), { pixels: 0, elements: [] });
        if (pictures) await page.screenshot({ path: join(pictures, `${kind}-phone.png`), fullPage: true });
      }));

    it("follows the reader's wish for dark or light", async () => {
      const seen = {};
      for (const colorScheme of ["light", "dark"]) {
        await withPage(kind, { colorScheme }, async (page) => {
          seen[colorScheme] = await colours(page);
          if (pictures) await page.screenshot({ path: join(pictures, `${kind}-${colorScheme}.png`), fullPage: true });
        });
      }
      for (const what of ["page", "text", "label"]) assert.notEqual(seen.light[what], seen.dark[what], what);
    });

    it("prints", () =>
      withPage(kind, {}, async (page) => {
        await page.emulateMedia({ media: "print" });
        for (const name of await chartNames(page)) {
          assert.ok(await page.locator(`#chart-${name} svg`).isVisible(), name);
        }
        const paper = await page.pdf({ format: "A4", path: pictures && join(pictures, `${kind}-paper.pdf`) });
        assert.equal(paper.subarray(0, 5).toString(), "%PDF-");
      }));

    it("has names for those who do not see it", () =>
      withPage(kind, {}, async (page) => assert.deepEqual(await unnamed(page), [])));
  });
}

describe("the values", () => {
  it("of a run are those of result.json", () =>
    withPage("run", {}, async (page) => {
      const result = readJson(join(reports.run.directory, "result.json"));
      assert.ok(result);
    }));

  it("of a sweep are those of its store", () =>
    withPage("sweep", {}, async (page) => {
      const points = readCsv(join(reports.sweep.directory, "points.csv"));
      const price = await rowsOf(page, "price");
      assertRows(
        price.map(({ ordinal, price, ms }) => ({ ordinal, price, ms })),
        points.map(({ ordinal, cost, end }) => ({ ordinal, price: cost, ms: end * 1e-9 })),
        "price",
      );
    }));

  it("of a study are those of its tables", () =>
    withPage("study", {}, async (page) => {
      let compared = 0;
      for (const name of await chartNames(page)) {
        const specification = readJson(join(reports.study.directory, `${name}.vl.json`));
        const table = specification.data.name;
        assertRows(await rowsOf(page, name), readCsv(join(reports.study.directory, `${table}.csv`)), name);
        ++compared;
      }
      assert.ok(compared >= 4);
    }));
});
