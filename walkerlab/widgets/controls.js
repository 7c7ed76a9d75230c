// The kinds of controls. Each is made from what controls.py says of a setting and from a function to tell its value;
// it gives the elements of its row, and a function to show a value. component.js stands before this, form.js behind it.

const fresh = () => `wl-${Math.random().toString(36).slice(2)}`;
const focused = (element) => element.getRootNode().activeElement === element;
const list = (value) => (Array.isArray(value) ? value : [value]);
const spoken = (name) => (name.startsWith("ƒ") ? name : name.replaceAll("_", " ")); // a function keeps its own
const brief = (number) => String(Number(Number(number).toPrecision(6)));

/** A slider of one thumb or of two, and beside it what it says, as a number that can be typed. */
function dial({ stops, unit, low, high }, names, tell) {
  const nearest = (value) =>
    stops.reduce((best, stop, place) => (Math.abs(stop - value) < Math.abs(stops[best] - value) ? place : best), 0);
  const measured = !unit ? "exactly" : unit.startsWith("per") ? unit : `in ${unit}`;
  const many = names.length > 1;
  let now = names.map(() => low);
  let both; // the number of both thumbs, if they were taken where they meet: the way they go says which was meant
  const saying = (numbers) => {
    now = numbers;
    tell(many ? now : now[0]);
  };
  const say = (which, value) => saying(now.map((old, place) => (place === which ? value : old)));
  const slide = (which, place) => {
    const stop = stops[Math.min(Math.max(place, 0), stops.length - 1)];
    say(which, many ? (which ? Math.max(stop, now[0]) : Math.min(stop, now[1])) : stop); // thumbs do not pass
  };
  const thumbs = names.map((name, which) =>
    make("input", {
      type: "range", min: 0, max: stops.length - 1, step: 1, ariaLabel: name,
      oninput: ({ target }) => {
        const stop = stops[target.value];
        if (both === undefined) slide(which, Number(target.value));
        else saying([Math.min(stop, both), Math.max(stop, both)]);
      },
      onpointerdown: () => { both = many && now[0] === now[1] ? now[0] : undefined; },
      onpointerup: () => { both = undefined; },
    }));
  const numbers = names.map((name, which) =>
    make("input", {
      type: "number", min: low, max: high, step: "any", ariaLabel: `${name}, ${measured}`,
      oninput: ({ target }) => target.value && say(which, target.valueAsNumber),
      onchange: () => show(many ? now : now[0], true),
      onkeydown: (event) => {
        const step = { ArrowUp: 1, ArrowDown: -1 }[event.key];
        if (!step) return;
        event.preventDefault();
        slide(which, nearest(now[which]) + step);
        event.target.value = brief(now[which]);
      },
    }));
  const rail = make("span", { className: many ? "rail two" : "rail" }, ...thumbs);
  rail.addEventListener("pointerdown", (event) => { // beside two thumbs: the nearer one comes
    if (event.target !== rail) return;
    const { left, width } = rail.getBoundingClientRect();
    const place = Math.round(((event.clientX - left) / width) * (stops.length - 1));
    const [least, most] = now.map(nearest);
    const which = Math.abs(place - least) < Math.abs(place - most) || place < least ? 0 : 1;
    slide(which, place);
    thumbs[which].focus();
    event.preventDefault();
  });
  function show(value, even) {
    now = list(value);
    const places = now.map(nearest);
    thumbs.forEach((thumb, which) => {
      thumb.value = places[which];
      thumb.setAttribute("aria-valuetext", `${brief(now[which])} ${unit}`.trim());
    });
    numbers.forEach((number, which) => { if (even || !focused(number)) number.value = brief(now[which]); });
    const ends = many ? places : [nearest(Math.max(low, 0)), places[0]];
    rail.style.setProperty("--from", Math.min(...ends) / (stops.length - 1));
    rail.style.setProperty("--to", Math.max(...ends) / (stops.length - 1));
  }
  const measure = make("span", { className: "unit" }, unit);
  return { elements: many ? [numbers[0], rail, numbers[1], measure] : [rail, numbers[0], measure], show };
}

const slider = (control, tell) => dial(control, [control.label], tell);
const range = (control, tell) => dial(control, [`least ${control.label}`, `greatest ${control.label}`], tell);

/** Three sliders, and buttons for the vectors that have a name. */
function vector(control, tell) {
  let now = [];
  const dials = control.parts.map((part, which) => {
    const say = (value) => tell(now.map((old, place) => (place === which ? value : old)));
    return dial(control, [`${control.label} ${part}`], say);
  });
  const names = control.presets.map(({ name, value }) => make("button", { type: "button", className: "chip",
    ariaLabel: `${control.label}: ${name}`, onclick: () => tell(value) }, name));
  const lines = dials.map((one, which) => make("div", { className: "line" },
    make("span", { className: "part quiet" }, control.parts[which]), ...one.elements));
  const above = names.length ? [make("div", { className: "chips" }, ...names)] : [];
  return {
    elements: [make("div", { className: "wide" }, ...above, ...lines)],
    show(value) {
      now = list(value);
      dials.forEach((one, which) => one.show(now[which]));
      names.forEach((button, which) =>
        button.setAttribute("aria-pressed", JSON.stringify(control.presets[which].value) === JSON.stringify(now)));
    },
  };
}

/** A whole number of no meaning of its own: typed, or drawn by chance. */
function number({ label, low, high }, tell) {
  const box = make("input", {
    type: "number", min: low, max: high, step: 1, ariaLabel: label,
    oninput: () => box.value && tell(box.valueAsNumber),
  });
  const another = make("button", { type: "button", ariaLabel: `another ${label}`,
    onclick: () => tell(Math.floor(Math.random() * 10000)) }, "another");
  return {
    elements: [make("span", { className: "wide inline" }, box, another)],
    show: (value) => { if (!focused(box)) box.value = value; },
  };
}

/** The sentence on what is chosen; there is room for the longest, so that nothing moves. */
function meaning(options) {
  const sentences = options.map(({ about }) => make("span", {}, about));
  return {
    element: make("div", { className: "meaning quiet" }, ...sentences),
    show: (value) => sentences.forEach((one, place) => one.classList.toggle("chosen", options[place].name === value)),
  };
}

function menu({ options }, name, tell) {
  const box = make("select", { ariaLabel: name, onchange: () => tell(box.value) },
    ...options.map((option) => make("option", { value: option.name }, spoken(option.name))));
  return { box, show: (value) => { box.value = value; } };
}

/** One of some options: a button each if they are few, or else a list. */
function choice(control, tell) {
  const group = fresh();
  const about = meaning(control.options);
  if (!control.few) {
    const { box, show } = menu(control, control.label, tell);
    return {
      elements: [make("div", { className: "wide" }, box, about.element)],
      show: (value) => { show(value); about.show(value); },
    };
  }
  const radios = control.options.map(({ name }) =>
    make("input", { type: "radio", name: group, value: name, ariaLabel: spoken(name), onchange: () => tell(name) }));
  const chips = radios.map((radio) => make("label", { className: "chip" }, radio, radio.ariaLabel));
  return {
    elements: [make("div", { className: "wide" }, make("div", { className: "chips" }, ...chips), about.element)],
    show(value) {
      radios.forEach((radio) => { radio.checked = radio.value === value; });
      about.show(value);
    },
  };
}

/** Some options, one applied after the other. */
function turns(control, tell) {
  const lines = [];
  const box = make("div", { className: "wide" });
  const add = make("button", { type: "button", className: "small", ariaLabel: `${control.label}: then another`,
    onclick: () => { say([...now, now.at(-1)]); lines.at(-1).select.box.focus(); } }, "+ then another");
  let now = [];
  const say = (several) => tell(several.length === 1 ? several[0] : several);
  function line(place) {
    const select = menu(control, place ? `${control.label}, step ${place + 1}` : control.label,
      (value) => say(now.map((old, other) => (other === place ? value : old))));
    const drop = make("button", { type: "button", className: "small",
      ariaLabel: `${control.label}: leave out step ${place + 1}`,
      onclick: () => say(now.filter((_, other) => other !== place)) }, "✕");
    const about = meaning(control.options);
    return { select, drop, about, element: make("div", { className: "turn" }, select.box, drop, about.element) };
  }
  return {
    elements: [box],
    show(value) {
      now = list(value);
      while (lines.length > now.length) lines.pop().element.remove();
      while (lines.length < now.length) {
        lines.push(line(lines.length));
        box.append(lines.at(-1).element);
      }
      lines.at(-1).drop.after(add);
      lines.forEach(({ select, drop, about }, place) => {
        select.show(now[place]);
        about.show(now[place]);
        drop.hidden = now.length === 1;
      });
    },
  };
}

/** Any of some options, or none. */
function flags({ options }, tell) {
  const boxes = options.map(({ name }) =>
    make("input", { type: "checkbox", value: name, ariaLabel: spoken(name), onchange: say }));
  function say() {
    const on = boxes.filter((box) => box.checked).map((box) => box.value);
    tell(on.length ? on : "none");
  }
  const lines = boxes.map((box, place) => make("label", { className: "flag" }, box,
    make("span", {}, `${box.ariaLabel} `, make("span", { className: "quiet" }, options[place].about))));
  return {
    elements: [make("div", { className: "wide" }, ...lines)],
    show: (value) => boxes.forEach((box) => { box.checked = list(value).includes(box.value); }),
  };
}

const KINDS = { slider, range, vector, number, choice, turns, flags };
