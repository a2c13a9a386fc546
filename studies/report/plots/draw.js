// Draws charts in node, after the scripts of vega_bundle.h, without a page: reads marti.report, {charts: [{name, spec,
// live}], about, explorer}, and writes to standard output a JSON array of {svg, rows}, with rows where `live` says how to make them.
// Text is measured by estimate, so that the same charts give the same bytes wherever they are drawn.
"use strict";

/** A chart holds its data: nothing is fetched, and no link leads out of a drawing. Vega goes on without what it
 *  is refused, so that the refusals are kept too. */
function refusing(errors) {
  const refuse = async (uri) => {
    errors.push(`it refers to ${uri}, but must hold all that it shows`);
    throw new Error("refused");
  };
  return { load: refuse, sanitize: refuse, http: refuse, file: refuse };
}

/** On paper there is nothing whose width could be taken. */
function sized(spec) {
  return {
    ...spec,
    ...(spec.width === "container" && { width: 520 }),
    ...(spec.height === "container" && { height: 320 }),
  };
}

/** A logger for Vega that keeps errors, which it would print and go on. */
function keeping(errors) {
  const logger = { level: () => logger, warn: () => logger, info: () => logger, debug: () => logger };
  logger.error = (...parts) => {
    errors.push(parts.map((part) => part?.message ?? String(part)).join(" "));
    return logger;
  };
  return logger;
}

const style = { ...martiChartStyle("#333333", "#dddddd"), background: "white", font: "sans-serif" };

async function draw(spec) {
  const errors = [];
  const logger = keeping(errors);
  const loader = refusing(errors);
  const compiled = vegaLite.compile(sized(spec), { config: style, logger }).spec;
  const runtime = vega.parse(compiled, null, { ast: true });
  const view = new vega.View(runtime, { renderer: "none", expr: vega.expressionInterpreter, loader, logger });
  const svg = await view.toSVG();
  view.finalize();
  if (errors.length > 0) throw new Error(errors.join("; "));
  return `${svg}\n`;
}

(async () => {
  const { charts, about, explorer } = marti.report;
  const view = explorer && marti.rows.firstView(explorer);
  const drawings = [];
  for (const { name, spec, live } of charts) {
    const whole = live ? marti.specs.filled(explorer, spec, live, view, about) : { ...spec, title: martiTitle(spec.title, about) };
    try {
      drawings.push({ svg: await draw(whole), rows: live && whole.data.values });
    } catch (error) {
      throw new Error(`chart ${name} cannot be drawn: ${error.message}`);
    }
  }
  process.stdout.write(JSON.stringify(drawings));
})().catch((error) => {
  process.stderr.write(`${error.message}\n`);
  process.exitCode = 1;
});
