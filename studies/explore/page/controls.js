// A control for each setting, by section.
"use strict";

explore.controls = (() => {
  const byKey = new Map();
  const { is_number, number_of, text_of, text_of_value } = explore.values;

  const element = (name, properties = {}, ...children) => {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
  };

  /** The text of twice or half the number; the same when it is no number. */
  function scaled(key, text, factor) {
    const number = number_of(key, text) * factor;
    if (Number.isNaN(number)) return text;
    if (key.type === "size") return text_of(key, Math.max(1, number));
    if (key.type === "integer") return text_of(key, factor < 1 ? Math.floor(number) : Math.max(1, number));
    return text_of(key, key.type === "duration" ? Math.round(number) : number);
  }

  function input_of(key, change) {
    if (key.list || !["choice", "boolean"].includes(key.type)) {
      const input = element("input", { type: "text", spellcheck: false, autocomplete: "off" });
      let waiting = 0;
      input.addEventListener("input", () => {
        clearTimeout(waiting);
        waiting = setTimeout(change, 200);
      });
      input.addEventListener("change", () => {
        clearTimeout(waiting);
        change();
      });
      return input;
    }
    const input =
      key.type === "boolean"
        ? element("input", { type: "checkbox" })
        : element("select", {}, ...key.choices.map((choice) => element("option", { value: choice, textContent: choice })));
    input.addEventListener("change", change);
    return input;
  }

  function make(key) {
    const own = text_of_value(key, key.value);
    const control = { key, own };
    const read = () => (control.input.type === "checkbox" ? String(control.input.checked) : control.input.value.trim());
    const move = (value) => explore.state.set({ [key.name]: value === own ? null : value });
    const slider = is_number(key) ? explore.sliders.make(key, move) : null;
    control.input = input_of(key, () => move(read()));
    control.input.id = `control-${key.name}`;
    control.show = (value) => {
      if (control.input.type === "checkbox") control.input.checked = value === "true";
      else if (control.input.value.trim() !== value) control.input.value = value;
      slider?.show(value);
    };
    control.error = element("p", { className: "error", hidden: true });
    control.error.setAttribute("role", "alert");
    const step = (text, name, factor) => {
      const button = element("button", { type: "button", textContent: text, title: `${name} ${key.name}` });
      button.setAttribute("aria-label", `${name} ${key.name}`);
      button.addEventListener("click", () => move(scaled(key, read(), factor)));
      return button;
    };
    const steps = is_number(key) ? [step("÷2", "halve", 0.5), step("×2", "double", 2)] : [];
    const range = [key.unit, key.range].filter(Boolean).join("; ");
    control.box = element(
      "div",
      { className: "control" },
      element("label", { htmlFor: control.input.id, textContent: key.name.slice(key.section.length + 1) }),
      control.input,
      ...steps,
      ...(slider ? [slider.input] : []),
      control.error,
      element("p", { className: "note", textContent: key.meaning + (range ? ` (${range})` : "") }),
    );
    byKey.set(key.name, control);
    return control;
  }

  function section(name, meaning, controls) {
    const details = element(
      "details",
      { id: `section-${name}` },
      element("summary", { textContent: name }),
      element("p", { className: "note", textContent: meaning ?? "" }),
      ...controls.map(({ box }) => box),
    );
    details.open = ["machine", "cache", "interconnect"].includes(name);
    return details;
  }

  /** Shows the settings with all words of `text` in their names, meanings or choices; all if there is no word. */
  function search(text) {
    const words = text.toLowerCase().split(/\s+/).filter(Boolean);
    let found = 0;
    for (const { key, box } of byKey.values()) {
      const said = [key.name, key.meaning, ...(key.choices ?? [])].join(" ").toLowerCase();
      box.hidden = !words.every((word) => said.includes(word));
      found += box.hidden ? 0 : 1;
    }
    for (const details of document.querySelectorAll("#settings details")) {
      details.hidden = !details.querySelector(".control:not([hidden])");
      if (words.length) {
        details.dataset.before ??= String(details.open);  // how it was before the search
        details.open = true;
      } else if ("before" in details.dataset) {
        details.open = details.dataset.before === "true";
        delete details.dataset.before;
      }
    }
    document.getElementById("found").textContent = words.length ? `${found} of ${byKey.size} settings` : "";
  }

  return {
    element,
    scaled,
    of: (name) => byKey.get(name),
    make(keys) {
      const sections = Map.groupBy
        ? Map.groupBy(keys.controls, (key) => key.section)
        : keys.controls.reduce((map, key) => map.set(key.section, [...(map.get(key.section) ?? []), key]), new Map());
      for (const [name, of_section] of sections) {
        document.getElementById("settings").append(section(name, keys.sections[name], of_section.map(make)));
      }
      const box = document.getElementById("search");
      box.addEventListener("input", () => search(box.value));
    },
    show({ settings }) {
      for (const control of byKey.values()) {
        const set = settings[control.key.name];
        control.show(set ?? control.own);
        control.box.classList.toggle("set", set !== undefined);
        if (set !== undefined) control.box.closest("details").open = true;
      }
    },
    /** Says which settings the machine has no use for, and what is wrong with one. */
    judge(answer) {
      for (const control of byKey.values()) {
        const wrong = "error" in answer && answer.key === control.key.name;
        control.error.hidden = !wrong;
        control.error.textContent = wrong ? answer.error : "";
        if (wrong) control.box.closest("details").open = true;
        if (!("error" in answer)) {
          const idle = !(control.key.name in answer.keys);
          control.box.classList.toggle("idle", idle);
          control.box.title = idle ? "has no effect on this machine" : "";
        }
      }
    },
  };
})();
