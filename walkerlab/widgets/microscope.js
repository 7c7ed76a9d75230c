// The microscope: controls for the parents and the operator, the bodies, and the coloured text of the child's genome.
const MODES = { cross: "Cross two robots", mutate: "Mutate a robot", explain: "How a robot was made" };

let n_views = 0;

function render({ model, el }) {
  const id = `wl-microscope-${n_views++}`;

  function field(name, label, control, kinds) { // a labelled control that is visible in some modes
    control.id = `${id}-${name}`;
    const shell = make("span", { className: "field" }, make("label", { htmlFor: control.id, textContent: label }), control);
    shell.update = () => { shell.hidden = !kinds.includes(model.get("mode")) || control.unavailable; };
    control.onchange = () => {
      const value = control.type === "number" ? Number(control.value) : control.dataset.number ? Number(control.value) : control.value;
      model.set(name, value);
      model.save_changes();
    };
    return shell;
  }

  const number = (attributes) => make("input", { type: "number", attributes });
  const mode = make("select");
  const generation = number({ min: 0, step: 1 });
  const first = make("select", { attributes: { "data-number": 1 } });
  const second = make("select", { attributes: { "data-number": 1 } });
  const crossover = make("select");
  const mutation = make("select");
  const rate = number({ min: 0, max: 1, step: 0.01 });
  const robot = number({ min: 0, step: 1 });
  const fields = [
    field("mode", "Show", mode, ["cross", "mutate", "explain"]),
    field("generation", "Generation", generation, ["cross", "mutate"]),
    field("first", "First parent", first, ["cross", "mutate"]),
    field("second", "Second parent", second, ["cross"]),
    field("crossover", "Crossover", crossover, ["cross"]),
    field("mutation", "Mutation", mutation, ["mutate"]),
    field("rate", "Mutation rate", rate, ["mutate"]),
    field("robot", "Number of the robot", robot, ["explain"]),
  ];
  const again = make("button", { type: "button", className: "main", textContent: "Again",
    title: "apply the operator again, with different random numbers", onclick: () => model.send("again") });
  const figures = make("div", { className: "figures" });
  const sentence = make("p", { attributes: { role: "status" } });
  const genome = make("div", { className: "genome" });
  const key = make("p", { className: "quiet key", textContent:
    "Colour and letter: parent of the gene. =: equal in all parents. Frame: the gene was changed by the amount shown, in its unit; " +
    "dashed frame: repair changed the gene to keep the robot within its limits. Faint: the gene has no effect on this robot." });
  el.classList.add("wl-component", "wl-microscope");
  el.append(make("div", { className: "controls" }, ...fields, again), figures, sentence, genome, key);

  function fill(select, options, value) {
    select.replaceChildren(...options.map(({ value: v, label }) => make("option", { value: v, textContent: label })));
    select.value = value;
  }

  function fillMenus() {
    const { robots = [], n_generations = 0, crossovers = [], mutations = [] } = model.get("choices");
    const named = (names) => names.map((name) => ({ value: name, label: name }));
    const modes = Object.entries(MODES).filter(([name]) => n_generations || name !== "explain");
    fill(mode, modes.map(([value, label]) => ({ value, label })), model.get("mode"));
    fill(first, robots, model.get("first"));
    fill(second, robots, model.get("second"));
    fill(crossover, named(crossovers), model.get("crossover"));
    fill(mutation, named(mutations), model.get("mutation"));
    generation.unavailable = !n_generations;
    generation.max = n_generations - 1;
    showSelection();
  }

  function showSelection() {
    for (const [control, name] of [[mode, "mode"], [generation, "generation"], [first, "first"], [second, "second"],
      [crossover, "crossover"], [mutation, "mutation"], [rate, "rate"], [robot, "robot"]]) {
      if (document.activeElement !== control || control.tagName === "SELECT") control.value = model.get(name);
    }
    first.previousSibling.textContent = model.get("mode") === "mutate" ? "Robot" : "First parent";
    again.hidden = model.get("mode") === "explain";
    for (const one of fields) one.update();
  }

  function word({ text, gene, title, sign, change, colour, faint, repair }) {
    if (!gene) return make("span", { className: "word", textContent: `${text} ` });
    const shell = make("span", { className: "word gene", title });
    if (colour) shell.style.setProperty("--origin", colour);
    shell.classList.toggle("faint", faint);
    shell.classList.toggle("changed", Boolean(change));
    shell.classList.toggle("repaired", repair);
    if (sign && sign !== "=") shell.append(make("sup", { textContent: sign }));
    shell.append(text);
    if (change) shell.append(make("b", { textContent: ` ${change}` }));
    return shell;
  }

  function draw() {
    const shown = model.get("shown");
    const fault = model.get("fault");
    sentence.classList.toggle("fault", Boolean(fault));
    sentence.textContent = fault ? `⚠ ${fault}` : shown.sentence || "";
    const all = (shown.figures || []).map(({ picture, letter, name, colour }) => {
      const title = make("figcaption", {}, letter ? make("b", { textContent: `${letter} ` }) : "", name);
      if (colour) title.style.setProperty("--origin", colour);
      return make("figure", { className: colour ? "parent" : "child" }, title, parseSvg(picture));
    });
    if (all.length) all.splice(-1, 0, make("div", { className: "arrow" }, make("span", { textContent: shown.operators }), "→"));
    figures.replaceChildren(...all);
    genome.replaceChildren(...(shown.lines || []).map((line) => make("div", { className: "line" }, ...line.map(word))));
    key.hidden = !shown.lines;
  }

  model.on("change:choices", fillMenus);
  for (const name of ["mode", "generation", "first", "second", "crossover", "mutation", "rate", "robot"]) model.on(`change:${name}`, showSelection);
  for (const name of ["shown", "fault"]) model.on(`change:${name}`, draw);
  fillMenus();
  draw();
  return captureKeys(el);
}
export default { render };
