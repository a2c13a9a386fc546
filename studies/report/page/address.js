// What the reader has chosen, behind the "#" of the page's address as name=value&name=value, so that a link and a
// reload show the same. Anybody may have written it: who reads it checks each value.
"use strict";

marti.address = (() => {
  let timer = 0;

  /** An object of texts by name; null when the address says nothing, or names a part of the page only. */
  function read() {
    const text = location.hash.slice(1);
    return text.includes("=") ? Object.fromEntries(new URLSearchParams(text)) : null;
  }

  const plain = () => location.href.split("#")[0];

  /** Entries without a value are left out. Browsers refuse addresses that change with every pixel of a slider. */
  function write(state) {
    clearTimeout(timer);
    timer = setTimeout(() => {
      const given = Object.entries(state).filter(([, value]) => value !== null && value !== undefined && value !== "");
      const text = new URLSearchParams(given).toString();
      if (text || location.hash.includes("=")) history.replaceState(null, "", text ? `${plain()}#${text}` : plain());
    }, 150);
  }

  // A link to a part of the page leads there without taking the choices out of the address.
  document.addEventListener("click", (event) => {
    const link = event.target.closest?.('a[href^="#"]');
    const part = link && document.getElementById(link.hash.slice(1));
    if (!part || event.defaultPrevented || link.dataset.save || !read()) return;
    event.preventDefault();
    part.tabIndex = -1;
    part.focus({ preventScroll: true });
    part.scrollIntoView();
  });

  return { read, write };
})();
