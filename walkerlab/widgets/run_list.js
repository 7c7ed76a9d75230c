// The list of kept runs: a row each, which stays the same element as long as its run is there.
const MARKS = { // as matplotlib calls them, within 4 of the middle
  o: "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z", s: "M-3.6 -3.6h7.2v7.2h-7.2z", "^": "M0 -4.4L4.2 3.4H-4.2z",
  D: "M0 -4.8L4.8 0L0 4.8L-4.8 0z", v: "M0 4.4L4.2 -3.4H-4.2z", P: "M-1.5 -4.5h3v3h3v3h-3v3h-3v-3h-3v-3h3z",
};

function sample({ colour, mark }) { // of its line on the curve
  const drawn = (name, attributes) => {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    return node;
  };
  const picture = drawn("svg", { viewBox: "-18 -7 36 14", width: 36, height: 14, class: "line", "aria-hidden": true });
  const stroke = drawn("path", { d: "M-17 0H17", stroke: colour, "stroke-width": 2 });
  picture.append(stroke, drawn("path", { d: MARKS[mark] ?? MARKS.o, fill: colour }));
  return picture;
}

function row(key, group, send) {
  let run = {};
  const see = make("input", { type: "radio", name: group, onchange: () => send({ select: key }) });
  const shown = make("input", { type: "checkbox", onchange: () => send({ of: key, shown: shown.checked }) });
  const name = make("input", { type: "text", className: "name", maxLength: 60, spellcheck: false, ariaLabel: "name of the run" });
  const differs = make("span", { className: "differs quiet" });
  const best = make("span", { className: "best" }), state = make("span", { className: "state quiet" });
  const drop = make("button", { type: "button", className: "drop", textContent: "✕" });
  const no = make("button", { type: "button", textContent: "keep" });
  const yes = make("button", { type: "button", textContent: "drop", onclick: () => send({ drop: key }) });
  const sure = make("span", { className: "sure", hidden: true, role: "group" }, "Off the list? Its file stays. ", yes, no);
  const node = make("li", {}, see, shown, name, differs, best, state, drop, sure);

  const ask = (asked) => {
    sure.hidden = !asked;
    (asked ? no : drop).focus();
  };
  drop.onclick = () => ask(true);
  no.onclick = () => ask(false);
  sure.onkeydown = ({ key: pressed }) => { if (pressed === "Escape") ask(false); };
  sure.addEventListener("focusout", ({ relatedTarget }) => {
    if (relatedTarget && !sure.contains(relatedTarget)) sure.hidden = true;
  });
  name.onchange = () => {
    name.value = name.value.trim() || run.name;
    if (name.value !== run.name) send({ of: key, name: name.value });
  };
  name.onkeydown = ({ key: pressed }) => {
    if (pressed === "Escape") name.value = run.name;
    if (pressed === "Enter" || pressed === "Escape") name.blur();
  };
  node.onclick = ({ target }) => { // beside its controls, the whole row selects
    if (!target.closest("input, button, .sure")) see.click();
  };

  const update = (told, selected) => {
    if (told.colour !== run.colour || told.mark !== run.mark) {
      node.querySelector(".line")?.remove();
      shown.after(sample(told));
    }
    if (told.name !== run.name && document.activeElement !== name) name.value = told.name;
    run = told;
    see.checked = selected;
    shown.checked = run.shown;
    node.classList.toggle("selected", selected);
    for (const [cell, words] of [[differs, run.differs], [best, run.best], [state, run.state]]) {
      cell.textContent = cell.title = words;
    }
    see.ariaLabel = see.title = `look at ${run.name}`;
    shown.ariaLabel = shown.title = `show ${run.name} on the curve`;
    drop.ariaLabel = drop.title = `drop ${run.name}`;
    sure.ariaLabel = `drop ${run.name}?`;
  };
  return { node, see, update };
}

function render({ model, el }) {
  const list = make("ul");
  const none = make("p", { className: "quiet", textContent: "No run is kept yet: start one, and it is listed here." });
  const heads = make("div", { className: "heads quiet", ariaHidden: true },
    ...["look at", "curve", "", "name", "what differs", "best", ""].map((textContent) => make("span", { textContent })));
  el.append(make("div", { className: "wl-part wl-shelf", role: "group", ariaLabel: "kept runs" }, heads, none, list));
  const rows = new Map();
  const group = `wl-shelf-${Math.random().toString(36).slice(2)}`; // of the radio buttons of this view

  function update() {
    const runs = model.get("runs");
    for (const [key, { node }] of rows) {
      if (runs.some((run) => run.key === key)) continue;
      const next = node.contains(document.activeElement) && (node.nextElementSibling ?? node.previousElementSibling);
      node.remove();
      rows.delete(key);
      if (next) next.querySelector(".drop").focus(); // the keyboard goes on from there
    }
    for (const run of runs) {
      if (!rows.has(run.key)) {
        rows.set(run.key, row(run.key, group, (message) => model.send(message)));
        list.append(rows.get(run.key).node);
      }
      rows.get(run.key).update(run, run.key === model.get("selected"));
    }
    none.hidden = runs.length > 0;
    heads.hidden = !runs.length;
  }

  const news = ["change:runs", "change:selected"];
  for (const one of news) model.on(one, update);
  const leave_keys = own_keys(list);
  update();
  return () => {
    for (const one of news) model.off(one, update);
    leave_keys();
  };
}
export default { render };
