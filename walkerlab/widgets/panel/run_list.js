// The list of runs. The row of a run is the same element until the run is removed.
const MARKS = { // paths by matplotlib's names, within 4 px of the centre
  o: "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z", s: "M-3.6 -3.6h7.2v7.2h-7.2z", "^": "M0 -4.4L4.2 3.4H-4.2z",
  D: "M0 -4.8L4.8 0L0 4.8L-4.8 0z", v: "M0 4.4L4.2 -3.4H-4.2z", P: "M-1.5 -4.5h3v3h3v3h-3v3h-3v-3h-3v-3h3z",
};

function sample({ colour, mark }) { // draws a sample of the run's line on the curve
  const draw = (name, attributes) => {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    return node;
  };
  const picture = draw("svg", { viewBox: "-18 -7 36 14", width: 36, height: 14, class: "line", "aria-hidden": true });
  const stroke = draw("path", { d: "M-17 0H17", stroke: colour, "stroke-width": 2 });
  picture.append(stroke, draw("path", { d: MARKS[mark] ?? MARKS.o, fill: colour }));
  return picture;
}

function row(key, group, send) {
  let run = {};
  const view = make("input", { type: "radio", name: group, onchange: () => send({ select: key }) });
  const shown = make("input", { type: "checkbox", onchange: () => send({ of: key, shown: shown.checked }) });
  const name = make("input", { type: "text", className: "name", maxLength: 60, spellcheck: false, ariaLabel: "name of the run" });
  const differs = make("span", { className: "differs quiet" });
  const best = make("span", { className: "best" }), state = make("span", { className: "state quiet" });
  const remove = make("button", { type: "button", className: "remove", textContent: "✕" });
  const cancel = make("button", { type: "button", textContent: "Cancel" });
  const confirm = make("button", { type: "button", textContent: "Remove", onclick: () => send({ remove: key }) });
  const confirmation = make("span", { className: "confirmation", hidden: true, role: "group" },
    "Remove from list? The file is kept. ", confirm, cancel);
  const node = make("li", {}, view, shown, name, differs, best, state, remove, confirmation);

  const ask = (asked) => {
    confirmation.hidden = !asked;
    (asked ? cancel : remove).focus();
  };
  remove.onclick = () => ask(true);
  cancel.onclick = () => ask(false);
  confirmation.onkeydown = ({ key: pressed }) => { if (pressed === "Escape") ask(false); };
  confirmation.addEventListener("focusout", ({ relatedTarget }) => {
    if (relatedTarget && !confirmation.contains(relatedTarget)) confirmation.hidden = true;
  });
  name.onchange = () => {
    name.value = name.value.trim() || run.name;
    if (name.value !== run.name) send({ of: key, name: name.value });
  };
  name.onkeydown = ({ key: pressed }) => {
    if (pressed === "Escape") name.value = run.name;
    if (pressed === "Enter" || pressed === "Escape") name.blur();
  };
  node.onclick = ({ target }) => { // a click beside the controls of the row selects the run
    if (!target.closest("input, button, .confirmation")) view.click();
  };

  const update = (changed, selected) => {
    if (changed.colour !== run.colour || changed.mark !== run.mark) {
      node.querySelector(".line")?.remove();
      shown.after(sample(changed));
    }
    if (changed.name !== run.name && document.activeElement !== name) name.value = changed.name;
    run = changed;
    view.checked = selected;
    shown.checked = run.shown;
    node.classList.toggle("selected", selected);
    for (const [cell, words] of [[differs, run.differs], [best, run.best], [state, run.state]]) {
      cell.textContent = cell.title = words;
    }
    view.ariaLabel = view.title = `view ${run.name}`;
    shown.ariaLabel = shown.title = `show ${run.name} on the curve`;
    remove.ariaLabel = remove.title = `remove ${run.name} from the list`;
    confirmation.ariaLabel = `remove ${run.name}?`;
  };
  return { node, update };
}

function render({ model, el }) {
  const list = make("ul");
  const none = make("p", { className: "quiet", textContent: "No runs yet. Each run that you start or load is listed here." });
  const heads = make("div", { className: "heads quiet", ariaHidden: true },
    ...["view", "curve", "", "name", "differences", "best", ""].map((textContent) => make("span", { textContent })));
  el.append(make("div", { className: "wl-component wl-run-list", role: "group", ariaLabel: "runs" }, heads, none, list));
  const rows = new Map();
  const group = `wl-run-list-${Math.random().toString(36).slice(2)}`; // name of the radio buttons of this view

  function update() {
    const runs = model.get("runs");
    for (const [key, { node }] of rows) {
      if (runs.some((run) => run.key === key)) continue;
      const next = node.contains(document.activeElement) && (node.nextElementSibling ?? node.previousElementSibling);
      node.remove();
      rows.delete(key);
      if (next) next.querySelector(".remove").focus(); // the focus was in the removed row
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

  const events = ["change:runs", "change:selected"];
  for (const event of events) model.on(event, update);
  const releaseKeys = captureKeys(list);
  update();
  return () => {
    for (const event of events) model.off(event, update);
    releaseKeys();
  };
}
export default { render };
