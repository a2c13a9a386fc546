// How the page writes numbers.
"use strict";

/** A figure with so many significant digits and its unit; a share in percent. */
marti.number = (value, { unit, percent } = {}, digits = 4) => {
  const text = String(Number((percent ? value * 100 : value).toPrecision(digits)));
  const shown = percent ? "%" : unit;
  return !shown || shown === "1" ? text : `${text} ${shown}`;
};
