// Begins when all other scripts are there.
"use strict";
marti.charts.redraw().then(() => {
  document.documentElement.dataset.drawn = "yes";
});
