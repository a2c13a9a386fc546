// The pages of `marti report` in a browser: they draw what the results hold, request nothing, and are
// accessible.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, readdirSync, statSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";
import { openFile, resize, screen, startBrowser } from "./browser.mjs";
import {
  chartNames,
  colours,
  download,
  drawing,
  markBoxes,
  markCount,
  onPaper,
  overflow,
  rowsOf,
  unnamed,
} from "./inspect.mjs";
import { makeReports, parseCsv, readCsv, readJson } from "./results.mjs";

const reports = await makeReports();
const pictures = process.env.MARTI_PICTURES;
const phone = { width: 360, height: 740, mobile: true };

/** Equal, numbers up to a relative `error`; an empty text is nothing. */
function assertClose(a, b, what, error) {
  if (typeof a !== "number" || typeof b !== "number") return assert.equal(String(a ?? ""), String(b ?? ""), what);
  assert.ok(Math.abs(a - b) <= error * Math.max(Math.abs(a), Math.abs(b)), `${what}: ${a} and ${b}`);
}

/** All that `expected` says must be shown. */
function assertRows(shown, expected, what, error = 1e-9) {
  assert.equal(shown.length, expected.length, `rows of ${what}`);
  expected.forEach((row, i) => {
    for (const [column, value] of Object.entries(row)) {
      assertClose(shown[i][column], value, `${what}: ${column} of row ${i}`, error);
    }
  });
}

const saveLink = (page, name, kind) => page.locator(`a[data-save="${kind}"][data-chart="${name}"]`);

let browser;
const opened = {};
before(async () => {
  browser = await startBrowser();
  if (pictures) mkdirSync(pictures, { recursive: true });
  const open = async ([kind, { page }]) => (opened[kind] = await openFile(browser, page, { colorScheme: "dark" }));
  await Promise.all(Object.entries(reports).map(open));
});
after(() => browser?.close());

/** Hands a page to `use`, and wants it to have done nothing wrong by then. Opening takes longest, so all tests share
 *  a page of each kind; each leaves it as wide and as dark as it was. */
async function withPage(kind, use) {
  await use(opened[kind].page);
  assert.deepEqual(await opened[kind].faults(), []);
}

for (const [kind, report] of Object.entries(reports)) {
  describe(`the page of a ${kind}`, () => {
    it("draws every chart, without fault and without asking for anything", () =>
      withPage(kind, async (page) => {
        const names = await chartNames(page);
        assert.ok(names.length > 0);
        for (const name of names) assert.ok((await markCount(page, name)) > 0, `${name} shows nothing`);
        const first = await page.evaluate(() => window.watched.firstChart);
        const bytes = statSync(report.page).size;
        console.log(`# ${kind}: ${names.length} charts, ${bytes} bytes, first chart after ${Math.round(first)} ms`);
        assert.ok(bytes < 3e6, `${bytes} bytes`);
      }));

    it("gives the rows of every chart as CSV", () =>
      withPage(kind, async (page) => {
        for (const name of await chartNames(page)) {
          const file = await download(page, saveLink(page, name, "csv"));
          assert.equal(file.name, `${name}.csv`);
          const rows = parseCsv(file.text);
          assert.ok(rows.length > 0, name);
          const shown = (await rowsOf(page, name)).filter(({ kind }) => kind !== "cursor");  // the slider's place
          assertRows(shown, rows, name);
          // The rows come from one script; two programs print their numbers.
          const beside = readCsv(join(report.plots, `${name}.csv`));
          assertRows(rows.filter((row) => row.kind !== "cursor"), beside.filter((row) => row.kind !== "cursor"), `${name} beside its plot`, 1e-4);
        }
      }));

    it("gives every chart as SVG", () =>
      withPage(kind, async (page) => {
        for (const name of await chartNames(page)) {
          const file = await download(page, saveLink(page, name, "svg"));
          assert.equal(file.name, `${name}.svg`);
          assert.match(file.text, /^<svg [^]*<\/svg>\s*$/, name);
          assert.match(readFileSync(join(report.plots, `${name}.svg`), "utf8"), /^<svg [^]*<\/svg>\s*$/, name);
        }
      }));

    it("follows the reader's wish for dark or light", () =>
      withPage(kind, async (page) => {
        const seen = { atFirst: await colours(page) };
        for (const colorScheme of ["light", "dark"]) {
          await page.emulateMedia({ colorScheme });
          seen[colorScheme] = await colours(page);
          if (pictures) await page.screenshot({ path: join(pictures, `${kind}-${colorScheme}.png`), fullPage: true });
        }
        assert.deepEqual(seen.atFirst, seen.dark);
        for (const what of ["page", "text", "label"]) assert.notEqual(seen.light[what], seen.dark[what], what);
      }));

    it("fits a phone", () =>
      withPage(kind, async (page) => {
        await resize(page, phone);
        assert.deepEqual(await overflow(page), { pixels: 0, elements: [] });
        if (pictures) await page.screenshot({ path: join(pictures, `${kind}-phone.png`), fullPage: true });
        await resize(page, screen);
      }));

    it("prints, dark on white whatever the screen is", () =>
      withPage(kind, async (page) => {
        await page.emulateMedia({ media: "print" });
        const printed = await colours(page);
        assert.deepEqual([printed.page, printed.text, printed.label], ["rgb(255, 255, 255)", "rgb(0, 0, 0)", "rgb(0, 0, 0)"]);
        for (const name of await chartNames(page)) {
          assert.ok(await page.locator(`#chart-${name} svg`).isVisible(), name);
        }
        assert.deepEqual(await onPaper(page), { pixels: 0, elements: [], wider: [], controls: [] });
        const paper = await page.pdf({ format: "A4", path: pictures && join(pictures, `${kind}-paper.pdf`) });
        assert.equal(paper.subarray(0, 5).toString(), "%PDF-");
        await page.emulateMedia({ media: null });
      }));

    it("has names for those who do not see it", () =>
      withPage(kind, async (page) => assert.deepEqual(await unnamed(page), [])));
  });
}

describe("the values", () => {
  it("of a run are those of result.json, and the bars are as long as they say", () =>
    withPage("run", async (page) => {
      const { figures, structure } = readJson(join(reports.run.directory, "result.json"));
      const { machine } = figures;
      const times = Object.keys(machine).filter((name) => name.startsWith("time_") && name !== "time_without_work");
      const all = times.reduce((sum, name) => sum + machine[name], 0);
      const cycles = await rowsOf(page, "run_cycles");
      const shown = cycles.filter(({ ps }) => ps > 0);
      assert.equal(shown.length, times.filter((name) => machine[name] > 0).length);
      for (const { activity, ps, share } of cycles) {
        assertClose(ps, machine[`time_${activity}`], activity, 0);
        assertClose(share, ps / all, activity, 1e-9);
      }
      const bars = await markBoxes(page, "run_cycles");
      const longest = shown.reduce((a, b) => (a.share > b.share ? a : b));
      const scale = bars[cycles.indexOf(longest)].width / longest.share;
      cycles.forEach(({ activity, share }, i) => {
        assert.ok(Math.abs(bars[i].width - share * scale) < 1, `the bar of ${activity}: ${bars[i].width}`);
      });
      for (const { record, hits, misses } of await rowsOf(page, "run_references")) {
        assert.deepEqual([hits, misses], [machine[`${record}_hits`], machine[`${record}_misses`]]);
      }
      const levels = structure.levels.map(({ branches, leaves, empty_leaves, entries }) => {
        return { branches, leaves, empty_leaves, entries };
      });
      assertRows(await rowsOf(page, "run_tree"), levels, "run_tree");
    }));

  it("of a sweep are those of its store", () =>
    withPage("sweep", async (page) => {
      const expected = points.map(({ ordinal, cost, end }) => ({ ordinal, price: cost, ms: end * 1e-9 }));
      assertRows(await rowsOf(page, "price"), expected, "price", 1e-5);
      assertLine(await rowsOf(page, "speed_up"), await machineOf(page));
    }));

  it("of a study are those of its tables", () =>
    withPage("study", async (page) => {
      const names = await chartNames(page);
      assert.ok(names.length >= 1);
      for (const name of names) {
        const specification = readJson(join(reports.study.directory, `${name}.vl.json`));
        const table = specification.data.name;
        assertRows(await rowsOf(page, name), readCsv(join(reports.study.directory, `${table}.csv`)), name);
      }
    }));
});

const points = readCsv(join(reports.sweep.directory, "points.csv"));

/** The machine that the explorer's controls say, but for its number of nodes. */
const machineOf = (page) =>
  page.evaluate(() => {
    const [size, unit] = document.querySelector('[data-axis="cache.size"]').ariaValueText.split(" ");
    const choice = document.querySelector('select[data-axis="point"]');
    return { cache_size: size * { B: 1, KiB: 1024, MiB: 1048576 }[unit], point: choice.selectedOptions[0].text };
  });

/** The exact points that the explorer shows are those of the store with this machine. */
function assertLine(rows, machine) {
  const expected = points.filter((row) => row["cache.size"] === machine.cache_size && row.point === machine.point);
  const exact = rows.filter(({ kind }) => kind === "exact").sort((a, b) => a.x - b.x);
  expected.sort((a, b) => a["machine.nodes"] - b["machine.nodes"]);
  const shown = expected.map((row) => ({ x: row["machine.nodes"], ms: row.end * 1e-9, speed_up: row.speed_up }));
  assertRows(exact, shown, JSON.stringify(machine), 1e-5);
}

describe("the explorer", () => {
  /** Presses keys on an axis's slider and waits until the charts follow it; one of them must be another one then. */
  async function press(page, axis, keys, chart = "speed_up") {
    const before = await drawing(page, chart);
    await page.locator(`input[type="range"][data-axis="${axis}"]`).focus();
    for (const key of keys) await page.keyboard.press(key);
    await page.waitForFunction(() => !window.marti.explorer.busy());
    assert.notEqual(await drawing(page, chart), before, `${chart} does not follow ${axis}`);
  }
  const reading = (page) => page.textContent("#reading");

  it("shows another line of the store when a slider is moved by keyboard", () =>
    withPage("sweep", async (page) => {
      const before = await machineOf(page);
      for (const keys of [["Home"], ["ArrowRight"], ["ArrowRight", "ArrowRight"], ["ArrowLeft"]]) {
        await press(page, "cache.size", keys);
        assertLine(await rowsOf(page, "speed_up"), await machineOf(page));
        const [, ordinal, ms] = (await reading(page)).match(/point (\d+): ([\d.e+]+) ms a frame/);
        assertClose(Number(ms), points.find((row) => row.ordinal === Number(ordinal)).end * 1e-9, "the reading", 1e-3);
      }
      assert.notDeepEqual(before, await machineOf(page));
    }));

  it("goes along another axis", () =>
    withPage("sweep", async (page) => {
      await page.locator("#along").selectOption({ label: "cache.size" });
      await page.waitForFunction(() => document.getElementById("title-speed_up").textContent.includes("cache.size"));
      await press(page, "machine.nodes", ["Home"]);
      const exact = (await rowsOf(page, "speed_up")).filter(({ kind }) => kind === "exact");
      assert.ok(exact.length > 1);
      for (const { x, speed_up } of exact) {
        assert.ok(
          points.some((row) => row["cache.size"] === x && Math.abs(row.speed_up / speed_up - 1) < 1e-5),
          `cache.size ${x}, speed-up ${speed_up}`,
        );
      }
    }));

  it("can be reached and worked without a mouse", () =>
    withPage("sweep", async (page) => {
      await page.locator(".skip").focus();
      const reached = new Set();
      for (let i = 0; i < 40; ++i) {
        await page.keyboard.press("Tab");
        reached.add(await page.evaluate(() => document.activeElement.dataset.axis ?? document.activeElement.id));
      }
      for (const control of ["theme", "point", "machine.nodes", "cache.size", "along"]) {
        assert.ok(reached.has(control), `${control} is not among ${[...reached]}`);
      }
    }));
});
