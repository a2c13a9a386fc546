// node render.mjs SPEC.vl.json OUT.svg: renders a Vega-Lite specification with its data inlined.
import { readFileSync, writeFileSync } from "node:fs";
import * as vega from "vega";
import * as vegaLite from "vega-lite";

const [source, target] = process.argv.slice(2);
const { spec } = vegaLite.compile(JSON.parse(readFileSync(source, "utf8")));
const view = new vega.View(vega.parse(spec), { renderer: "none" });
view.background("white");
writeFileSync(target, (await view.toSVG()) + "\n");
