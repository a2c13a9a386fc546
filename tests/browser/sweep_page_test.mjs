// The page of a sweep: the table of its points, the choice of one of them everywhere on the page, bars for names, colours,
// the budget, and the address that says it all. The points have names that would be markup or script if they were not
// escaped.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";
import { openFile, startBrowser } from "./browser.mjs";
import { chartNames, download, markBoxes, rowsOf } from "./inspect.mjs";
import { makeSweep, parseCsv, readCsv } from "./results.mjs";

const names = ["<script>alert(1)</script>", "it's <b>bold</b> & </td>", "'] + alert(2) + ['"];
const config = `
[scene]
source = "tetra:3"
[image]
width = 24
height = 16
${names.map((name, i) => `[sweep.points."${name}"]\ncache.size = "${4 << i} KiB"\n`).join("")}
[sweep.axes]
machine.nodes = [1, 4, 9]
cache.ways = [1, 2]
[prices]
node = 1.0
cache_kib = 0.1
`;

const report = await makeSweep("sweep-of-names", config, "--budget", "12");
const points = readCsv(join(report.directory, "points.csv"));

let browser, shared, plain;
before(async () => {
  browser = await startBrowser();
  shared = await openFile(browser, report.page);
  plain = await shown(shared.page);
});
after(() => browser?.close());

/** Hands a page to `use`, and wants it to have done nothing wrong by then. Opening takes longest, so tests share this
 *  page; each leaves its order, filter and budget as they were, and any point chosen. After one that fails it is opened
 *  anew. */
async function withPage(use) {
  try {
    await use(shared.page);
    assert.deepEqual(await shared.faults(), []);
  } catch (fault) {
    await shared.close();
    shared = await openFile(browser, report.page);
    throw fault;
  }
}

/** The same with these values of selections, which are as before afterwards. */
const withSelected = (values, use) =>
  withPage(async (page) => {
    const before = {};
    for (const [id, value] of Object.entries(values)) {
      before[id] = await page.inputValue(id);
      await page.selectOption(id, { label: value });
    }
    await drawn(page);
    await use(page);
    for (const [id, value] of Object.entries(before)) await page.selectOption(id, value);
    await drawn(page);
  });

/** The same with a page of its own, opened at an address. */
async function withOwnPage(use, { fragment = "", file = report.page } = {}) {
  const opened = await openFile(browser, file, {}, fragment);
  try {
    await use(opened.page);
    assert.deepEqual(await opened.faults(), []);
  } finally {
    await opened.close();
  }
}

const drawn = (page) => page.waitForFunction(() => !window.marti.explorer.busy());
const settled = async (page) => {
  await drawn(page);
  await page.waitForTimeout(250); // the address follows when the reader has paused
};
const address = (page) => Object.fromEntries(new URLSearchParams(new URL(page.url()).hash.slice(1)));
const column = (page, name) =>
  page.$$eval(
    "#points-table tbody tr",
    (rows, name) => {
      const at = [...document.querySelectorAll("#points-table th")].findIndex((cell) => cell.dataset.column === name);
      return rows.map((row) => row.cells[at].textContent);
    },
    name,
  );
const current = (page) => page.$$eval("#points-table tr[aria-current]", (rows) => rows.map((row) => Number(row.dataset.point)));
const summary = (page) => page.textContent("#chosen summary");
const ordinals = (rows) => rows.map(({ ordinal }) => ordinal);
const heading = (page, name) => page.locator(`#points-table th[data-column="${name}"]`);

/** What the page shows of the reader's choices, but for the drawings. */
const shown = async (page) => ({
  ordinals: await column(page, "ordinal"),
  current: await current(page),
  summary: await summary(page),
  titles: await page.$$eval("figure h3", (titles) => titles.map((title) => title.textContent)),
  reading: await page.textContent("#reading"),
  filter: await page.inputValue("#filter"),
  along: await page.inputValue("#along"),
  colour: await page.inputValue("#colour"),
  budget: await page.inputValue("#budget"),
  rows: await rowsOf(page, "frame_time").then((rows) => rows.map(({ kind, value, colour, ms }) => ({ kind, value, colour, ms }))),
});

describe("the table of points", () => {
  it("has every point with its axes and figures, units in the headings", () =>
    withPage(async (page) => {
      assert.deepEqual((await column(page, "ordinal")).map(Number), ordinals(points));
      assert.deepEqual(await column(page, "point"), points.map(({ point }) => point));
      const times = await column(page, "end");
      points.forEach(({ end }, i) => assert.ok(Math.abs(Number(times[i]) / (end * 1e-9) - 1) < 1e-5, times[i]));
      const headings = await page.$$eval("#points-table th", (cells) => cells.map((cell) => cell.textContent));
      for (const title of ["frame time, ms", "efficiency, %", "hit ratio, %", "price"]) assert.ok(headings.includes(title), `${headings}`);
    }));

  it("is sorted by a click on a heading, and the other way round by another", () =>
    withPage(async (page) => {
      const byTime = [...points].sort((a, b) => a.end - b.end || a.ordinal - b.ordinal);
      await heading(page, "end").getByRole("button").click();
      assert.deepEqual((await column(page, "ordinal")).map(Number), ordinals(byTime));
      assert.equal(await heading(page, "end").getAttribute("aria-sort"), "ascending");
      await heading(page, "end").getByRole("button").click();
      const falling = [...points].sort((a, b) => b.end - a.end || a.ordinal - b.ordinal);
      assert.deepEqual((await column(page, "ordinal")).map(Number), ordinals(falling));
      await settled(page);
      assert.equal(address(page).sort, "-end");
      await heading(page, "ordinal").getByRole("button").click();
      assert.deepEqual((await column(page, "ordinal")).map(Number), ordinals(points));
    }));

  it("shows what the filter lets through, and so do its CSV and the price chart", () =>
    withPage(async (page) => {
      const cases = [
        ["machine.nodes >= 4, cache.ways = 2", (row) => row["machine.nodes"] >= 4 && row["cache.ways"] === 2],
        ["BOLD, efficiency < 50 %", (row) => row.point.includes("bold") && row.efficiency < 0.5],
        ["point = <script>alert(1)</script>", (row) => row.point === names[0]],
        ['"BOLD" , "efficiency" , point = "<script>alert(1)</script>"', () => false],
        ['point="<script>alert(1)</script>", machine.nodes>1', (row) => row.point === names[0] && row["machine.nodes"] > 1],
        ["no such text", () => false],
        ["frame time < 1e6 ms, machine.nodes > 1", (row) => row["machine.nodes"] > 1],
      ];
      for (const [text, lets] of cases) {
        const expected = ordinals(points.filter(lets));
        await page.fill("#filter", text);
        assert.deepEqual((await column(page, "ordinal")).map(Number), expected, text);
        await drawn(page);
        const bright = (await rowsOf(page, "price")).filter(({ filtered }) => !filtered);
        assert.deepEqual(ordinals(bright), expected, text);
      }
      await page.fill("#filter", cases[0][0]);
      const csv = parseCsv((await download(page, page.locator("#save-points"))).text);
      assert.deepEqual(ordinals(csv), ordinals(points.filter(cases[0][1])));
      for (const [text, fault] of [["colour = red", "there is no column colour"], ["machine.nodes > few", "few is no value of machine.nodes"], ['point = "a, b', "a quotation mark is not closed"]]) {
        await page.fill("#filter", text);
        assert.ok((await page.textContent("#filter-fault")).startsWith(fault), await page.textContent("#filter-fault"));
        assert.equal((await column(page, "ordinal")).length, points.length);
      }
      await page.fill("#filter", "");
      assert.deepEqual((await column(page, "ordinal")).map(Number), ordinals(points));
    }));
});

describe("the chosen point", () => {
  it("is that of the row, everywhere on the page, with its exact figures", () =>
    withPage(async (page) => {
      for (const wanted of [points[3], points[10]]) {
        await page.locator(`#points-table tr[data-point="${wanted.ordinal}"] td`).nth(2).click();
        await drawn(page);
        assert.deepEqual(await current(page), [wanted.ordinal]);
        assert.ok((await summary(page)).includes(`point = ${wanted.point}, machine.nodes = ${wanted["machine.nodes"]}`));
        assert.match(await page.textContent("#reading"), new RegExp(`point ${wanted.ordinal}: `));
        const figures = await page.$$eval("#chosen dl div", (pairs) => pairs.map((pair) => pair.textContent));
        assert.ok(figures.includes(`frame time${wanted.end / 1e9} ms`), `${figures}`);
        assert.ok(figures.includes(`speed-up${wanted.speed_up}`), `${figures}`);
        const marks = await page.evaluate(() => window.marti.views.price.data("marks").map((row) => ({ ...row })));
        assert.deepEqual(ordinals(marks.filter(({ chosen }) => chosen)), [wanted.ordinal]);
        for (const name of ["frame_time", "efficiency", "cycles"]) {
          assert.deepEqual(ordinals((await rowsOf(page, name)).filter(({ chosen }) => chosen)), [wanted.ordinal], name);
        }
      }
    }));

  it("is that of a mark of the price chart", () =>
    withPage(async (page) => {
      const fastest = points.reduce((a, b) => (b.end < a.end ? b : a));
      assert.notDeepEqual(await current(page), [fastest.ordinal]);
      const { x, y } = await page.evaluate((wanted) => {
        const marks = [...document.querySelectorAll("#chart-price svg .mark-symbol.role-mark path")];
        const mark = marks.find(({ __data__ }) => __data__.datum.ordinal === wanted);
        mark.scrollIntoView({ block: "center" });
        const { left, top, width, height } = mark.getBoundingClientRect();
        return { x: left + width / 2, y: top + height / 2 };
      }, fastest.ordinal);
      await page.mouse.click(x, y);
      await drawn(page);
      assert.deepEqual(await current(page), [fastest.ordinal]);
      assert.ok((await summary(page)).startsWith(`Point ${fastest.ordinal}, fastest`), await summary(page));
    }));

  it("is reached by keyboard", () =>
    withPage(async (page) => {
      assert.notDeepEqual(await current(page), [5]);
      await page.locator('#points-table tr[data-point="5"] button').focus();
      await page.keyboard.press("Enter");
      await drawn(page);
      assert.deepEqual(await current(page), [5]);
    }));
});

describe("the charts", () => {
  it("have bars for names, as long as they say, in the colours of another axis", () =>
    withSelected(
      { "#along": "point", "#colour": "machine.nodes" },
      async (page) => {
        const rows = (await rowsOf(page, "frame_time")).filter(({ kind }) => kind === "exact" || kind === "other");
        assert.equal(rows.length, names.length * 3);
        const colours = new Set(rows.map(({ colour }) => colour));
        assert.deepEqual(colours, new Set(["1", "4", "9"]));
        const bars = await markBoxes(page, "frame_time");
        assert.equal(bars.length, rows.length);
        const heights = bars.map(({ height }) => height).sort((a, b) => a - b);
        const times = rows.map(({ ms }) => ms).sort((a, b) => a - b);
        times.forEach((ms, i) => assert.ok(Math.abs(heights[i] / heights.at(-1) - ms / times.at(-1)) < 0.02, `${ms} is ${heights[i]}`));
        for (const name of ["efficiency", "utilisation", "hit_ratio_point"]) {
          if (!(await chartNames(page)).includes(name)) continue;
          assert.ok((await page.locator(`#chart-${name} svg .mark-rect path`).count()) >= names.length, `${name} has bars`);
          assert.equal(await page.locator(`#chart-${name} svg .mark-line`).count(), 0, `${name} joins names`);
        }
      },
    ));

  it("mark the fastest, the knee and the best within the budget", () =>
    withPage(async (page) => {
      const roles = async () => {
        const rows = await page.evaluate(() => window.marti.views.price.data("marks").map((row) => ({ ...row })));
        return Object.fromEntries(rows.filter(({ role }) => role).flatMap(({ role, ordinal }) => role.split(", ").map((each) => [each, ordinal])));
      };
      const best = (budget) =>
        points.filter(({ cost }) => cost <= budget).reduce((a, b) => (b.end < a.end || (b.end === a.end && b.cost < a.cost) ? b : a)).ordinal;
      const first = await roles();
      assert.equal(first["best within 12"], best(12), "that of --budget");
      assert.equal(first.fastest, best(Infinity));
      assert.ok("knee" in first);
      for (const budget of [6, 20, 12]) {
        await page.fill("#budget", String(budget));
        await drawn(page);
        assert.equal((await roles())[`best within ${budget}`], best(budget));
      }
    }));

  it("show any figure along any axis", () =>
    withSelected({ "#figure": "node misses", "#along": "machine.nodes" }, async (page) => {
      const figures = await page.$$eval("#figure option", (options) => options.map(({ value }) => value));
      assert.ok(figures.length > 50, "all figures that tell machines apart");
      assert.equal(await page.textContent("#title-figure"), "Node misses over machine.nodes");
      const rows = await rowsOf(page, "figure");
      assert.ok(rows.length > 1);
      const columns = await page.evaluate(() => window.marti.charts.data.explorer);
      for (const { ordinal, amount } of rows) {
        assert.equal(amount, columns.columns.node_misses[columns.ordinal.indexOf(ordinal)]);
      }
    }));

  it("say the figures of what is pointed at", () =>
    withPage(async (page) => {
      for (const name of await chartNames(page)) {
        const symbols = page.locator(`#chart-${name} svg .mark-symbol.role-mark path`);
        const mark = (await symbols.count()) > 0 ? symbols.first() : page.locator(`#chart-${name} svg .mark-rect.role-mark path`).first();
        await mark.evaluate((element) => element.scrollIntoView({ block: "center" }));
        await mark.hover({ force: true });
        await page.waitForSelector("#tooltip:not([hidden])");
        assert.match(await page.textContent("#tooltip"), /\d/, name);
        await page.mouse.move(1, 1);
        await page.waitForSelector("#tooltip[hidden]", { state: "attached" });
      }
    }));
});

describe("the address", () => {
  it("brings back what was chosen", () =>
    withOwnPage(async (page) => {
      await page.selectOption("#along", { label: "point" });
      await page.selectOption("#colour", { label: "cache.ways" });
      await page.fill("#budget", "20");
      await page.fill("#filter", "machine.nodes > 1");
      await heading(page, "speed_up").getByRole("button").click();
      await page.locator('#points-table tr[data-point="8"]').click();
      await settled(page);
      const before = await shown(page);
      const fragment = new URL(page.url()).hash;
      assert.ok(fragment.length < 200, fragment);
      // A link to a part of the page leads there and keeps what was chosen.
      await page.getByRole("navigation").getByRole("link", { name: "All points" }).click();
      assert.equal(await page.evaluate(() => document.activeElement.id), "points");
      assert.equal(new URL(page.url()).hash, fragment);
      await page.goto("about:blank");
      await page.goBack();
      await page.waitForFunction(() => document.documentElement.dataset.drawn);
      assert.deepEqual(await shown(page), before, "a reload");
    }));

  it("that says nonsense changes nothing", () =>
    withOwnPage(
      async (page) => {
        const expected = { ...plain, filter: "<img src=x onerror=alert(1)>" };
        const actual = await shown(page);
        assert.deepEqual([actual.ordinals, actual.current], [[], []], "nothing has that text");
        assert.deepEqual({ ...actual, ordinals: expected.ordinals, current: expected.current }, expected);
      },
      { fragment: "#along=nobody&colour=__proto__&figure=constructor&point=1e99&axis.point=x&budget=-1&sort=-none&filter=<img src=x onerror=alert(1)>" },
    ));
});

describe("names", () => {
  it("with quotes and markup stay texts", async () => {
    // A configuration has no quotation marks and backslashes in names; a store that somebody has changed may.
    const page = readFileSync(report.page, "utf8");
    const [, begin, text, end] = /^([^]*id="data">)(.*?)(<\/script>[^]*)$/s.exec(page);
    const data = JSON.parse(text);
    data.explorer.axes.find(({ name }) => name === "point").texts = ['"\\"</script><img src=x>', "\\' + alert(3) + '", 'small, "cheap" <= {{x}}\u2028`${1}`'];
    const file = join(report.directory, "changed.html");
    writeFileSync(file, begin + JSON.stringify(data).replaceAll("<", "\\u003c") + end);
    const use = async (page) => {
      assert.ok((await column(page, "point")).includes('"\\"</script><img src=x>'));
      const all = await column(page, "point");
      for (const filter of ['point = "small, ""cheap"" <= {{x}} `${1}`"', '"small, ""cheap"" <="']) {
        await page.fill("#filter", filter);
        const shown = await column(page, "point");
        assert.deepEqual(shown, all.filter((text) => text.startsWith("small, ")), await page.textContent("#filter-fault"));
        assert.ok(shown.length > 0);
      }
      await page.fill("#filter", "");
      assert.equal(await page.locator("main img, main b").count(), 0);
      const labels = await page.$$eval("#chart-frame_time svg .role-axis-label text", (all) => all.map((each) => each.textContent));
      assert.ok(labels.some((label) => label.includes("alert(3)")), `${labels}`);
    };
    await withOwnPage(use, { file, fragment: "#along=point" });
    await withOwnPage((page) => assert.match(page.url(), /colour=point/), { file, fragment: "#along=machine.nodes&colour=point" });
  });
});
