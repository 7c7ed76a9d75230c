// The sliders and menus of a playground. `change` is called with what changed: "world", "gait", "strength", "body" or "all".
// Controls whose value differs from the original are marked; "Undo all" restores all originals.
const DEGREES = 180 / Math.PI;
const GAIT_FEATURES = ["hip_amplitude", "hip_phase", "hip_offset", "knee_amplitude", "knee_phase", "knee_offset", "stride"];
const FEATURE_LABELS = { legs: "has legs", repeat: "copies legs in front" }; // others: the name of the gene, as in the editor
const featureLabel = (name) => FEATURE_LABELS[name] ?? name.replace("_", " ");

function make(name, properties = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key in node && key !== "list") node[key] = value; else node.setAttribute(key, value);
  }
  node.append(...children);
  return node;
}

// A slider with its label and value; `set` shows another value, and marks the slider if the value is not the original.
function makeSlider({ label, about, low, high, step, unit, factor = 1, digits, onInput }) {
  const text = (value) => `${(value * factor).toFixed(digits).replace(/^-(0\.?0*)$/, "$1")}${unit ? (unit === "°" ? "" : " ") + unit : ""}`;
  const input = make("input", { type: "range", min: low * factor, max: high * factor, step: step * factor, ariaLabel: about ? `${label}: ${about}` : label });
  const output = make("output"), was = make("small", { className: "was" });
  const row = make("label", { className: "slider", title: about ?? label }, make("span", { textContent: label }), input,
    make("div", { className: "value" }, output, was));
  const show = (value, original) => {
    input.value = value * factor;
    output.textContent = input.ariaValueText = text(value);
    const isChanged = text(value) !== text(original);
    row.classList.toggle("changed", isChanged);
    was.textContent = isChanged ? `was ${text(original).split(" ")[0]}` : "";
  };
  input.oninput = () => {
    output.textContent = input.ariaValueText = text(Number(input.value) / factor);
    onInput(Number(input.value) / factor);
  };
  return { row, input, set: show };
}

class Controls {
  constructor(page, state, change) { // state: { world, genomes, selected }
    Object.assign(this, { page, state, change });
    this.root = document.querySelector(".controls");
    this.error = this.root.querySelector(".error");
    this.undoButton = document.querySelector(".transport .undo");
    this.undoButton.onclick = () => this.undo();
    this.addWorld(this.root.querySelector(".world"));
    if (matchMedia("(max-width: 760px)").matches) this.root.querySelector(".world").open = false; // so that the gait is in view
    this.selectRobot();
    this.addText();
    this.showGenes();
  }

  get values() { return this.state.genomes[this.state.selected]; }

  get original() { return this.page.robots[this.state.selected].genome; }

  undo() { // restores the genomes and the world with which the page was opened
    this.state.genomes = this.page.robots.map(({ genome }) => genome);
    this.state.world = this.page.world;
    this.showMessage("");
    this.showWorld();
    this.showGenes();
    this.change("all");
  }

  showUndo() {
    const { page, state } = this;
    const isChanged = (values, number) => values.some((value, index) => value !== page.robots[number].genome[index]);
    this.undoButton.disabled = !state.genomes.some(isChanged) && JSON.stringify(state.world) === JSON.stringify(page.world);
  }

  // ----------------------------------------------------------------------------------------------------------- world

  addWorld(parent) {
    const { page, state } = this;
    const setWorld = (changes) => {
      state.world = { ...state.world, ...changes };
      this.showWorld();
      this.change("world", changes);
    };
    const planets = Object.keys(page.planets);
    this.planet = make("select", { ariaLabel: "Planet, which sets the gravity" }, ...[...planets, "other"].map((name) =>
      make("option", { value: name, textContent: name, disabled: name === "other" })));
    this.planet.onchange = () => setWorld({ gravity: page.planets[this.planet.value] });
    const strength = () => Math.hypot(...state.world.gravity);
    this.gravity = makeSlider({ label: "gravity", about: "acceleration of gravity", low: 0, high: 30, step: 0.01, unit: "m/s²", digits: 2,
      onInput: (value) => setWorld({ gravity: strength() ? state.world.gravity.map((part) => part * value / strength()) : [0, 0, -value] }) });
    this.texture = make("select", { ariaLabel: "Material of the ground, which sets the friction" }, ...Object.entries(page.textures).map(
      ([name, { sliding }]) => make("option", { value: name, textContent: `${name}, µ ${sliding}` })));
    this.texture.onchange = () => setWorld({ texture: this.texture.value });
    this.wind = makeSlider({ label: "wind", about: "wind from behind; negative is a headwind", low: -20, high: 20, step: 0.1, unit: "m/s", digits: 1,
      onInput: (value) => setWorld({ wind: [value, ...state.world.wind.slice(1)] }) });
    this.slope = makeSlider({ label: "slope", about: "slope of the ground; positive is uphill", low: -30 / DEGREES, high: 30 / DEGREES,
      step: 0.5 / DEGREES, factor: DEGREES, unit: "°", digits: 1, onInput: (value) => setWorld({ slope: value }) });
    const row = (text, menu) => make("label", { className: "slider" }, make("span", { textContent: text }), menu);
    parent.append(row("planet", this.planet), this.gravity.row, row("ground", this.texture), this.wind.row);
    if (page.has_slope) parent.append(this.slope.row);
    this.showWorld();
  }

  showWorld() {
    const { gravity, texture, wind, slope } = this.state.world;
    const isEqual = (a, b) => a.every((value, axis) => Math.abs(value - b[axis]) < 1e-9);
    this.planet.value = Object.entries(this.page.planets).find(([, value]) => isEqual(value, gravity))?.[0] ?? "other";
    const original = this.page.world;
    this.gravity.set(Math.hypot(...gravity), Math.hypot(...original.gravity));
    this.texture.value = texture;
    this.wind.set(wind[0], original.wind[0]);
    this.slope.set(slope, original.slope);
    this.planet.parentElement.classList.toggle("changed", !isEqual(gravity, original.gravity));
    this.texture.parentElement.classList.toggle("changed", texture !== original.texture);
    this.showChanges();
  }

  showChanges() { // the changed settings, as arguments of Settings.with_
    const { world } = this.state;
    const original = this.page.world;
    const differs = (name) => JSON.stringify(world[name]) !== JSON.stringify(original[name]);
    const vector = (values) => `(${values.map((value) => +value.toFixed(6)).join(", ")})`;
    const changes = [];
    if (differs("gravity")) changes.push(`gravity=${this.planet.value === "other" ? vector(world.gravity) : `"${this.planet.value}"`}`);
    if (differs("texture")) changes.push(`texture="${world.texture}"`);
    if (differs("wind")) changes.push(`wind=${vector(world.wind)}`);
    if (differs("slope")) changes.push(world.slope ? `structure="incline", incline=${+(world.slope * DEGREES).toFixed(6)}` : 'structure="flat"');
    const code = this.root.querySelector(".changes code");
    code.textContent = changes.length ? `settings.with_(${changes.join(", ")})` : "";
    code.parentElement.hidden = !changes.length;
    this.showUndo();
  }

  // ----------------------------------------------------------------------------------------------------------- genes

  selectRobot() {
    const { page, state } = this;
    const label = this.root.querySelector(".selected"), menu = label.querySelector("select");
    label.hidden = page.robots.length === 1;
    menu.append(...page.robots.map((robot, number) => make("option", { value: number, textContent: robot.label })));
    menu.onchange = () => {
      state.selected = Number(menu.value);
      this.showGenes();
      this.change("selected");
    };
  }

  // Shows the sliders of the selected robot: those of genes that have an effect.
  showGenes() {
    const robot = expressRobot(this.page, this.values);
    const shape = robot.segments.map(({ legs }) => legs?.source ?? -1).join();
    if (shape !== this.shownShape) this.addGenes(robot);
    this.shownShape = shape;
    for (const show of this.shown) show();
    this.showText();
    this.showUndo();
  }

  addGenes(robot) {
    this.shown = [];
    const gait = this.root.querySelector(".gait"), body = this.root.querySelector(".body");
    for (const parent of [gait, body]) parent.replaceChildren(parent.querySelector("summary"));
    gait.append(this.geneSlider("frequency"), this.geneSlider("lag"), this.geneSlider("duty"));
    const strength = this.strengthSlider(robot);
    gait.append(strength);
    body.append(this.geneSlider("segments"));
    robot.segments.forEach(({ legs }, number) => {
      const isSource = legs?.source === number;
      if (isSource) {
        const copies = robot.segments.flatMap((other, index) => (other.legs?.source === number && index !== number ? [index + 1] : []));
        const title = `Legs of segment ${number + 1}${copies.length ? `, copied by segment${copies.length > 1 ? "s" : ""} ${copies.join(", ")}` : ""}`;
        gait.append(make("fieldset", {}, make("legend", { textContent: title }), ...GAIT_FEATURES.map((name) => this.geneSlider(name, number))));
      }
      const hasFront = robot.segments.slice(0, number).some((other) => other.legs);
      body.append(make("fieldset", {}, make("legend", { textContent: `Segment ${number + 1}` }), this.geneSlider("length", number),
        this.geneSlider("mass", number), this.geneBox("legs", number), ...(legs && hasFront ? [this.geneBox("repeat", number)] : []),
        ...(isSource ? [this.geneSlider("leg_length", number), this.geneSlider("leg_force", number)] : [])));
    });
  }

  geneSlider(name, segment = 0) {
    const { low, high, unit, kind, about } = this.page.genes[name];
    const index = geneIndex(this.page, name, segment);
    const isAngle = unit === "rad";
    const slider = makeSlider({ label: featureLabel(name), about, low, high, step: kind === "count" ? 1 : 0.001,
      factor: isAngle ? DEGREES : 1, unit: isAngle ? "°" : name === "segments" ? "" : unit, digits: isAngle || kind === "count" ? 0 : unit === "N·m" ? 1 : 2,
      onInput: (value) => this.setGene(index, name, value) });
    if (isAngle) slider.input.step = 0.5;
    slider.input.dataset.gene = index;
    this.shown.push(() => slider.set(this.values[index], this.original[index]));
    return slider.row;
  }

  geneBox(name, segment) {
    const index = geneIndex(this.page, name, segment);
    const box = make("input", { type: "checkbox", ariaLabel: `Segment ${segment + 1}: ${this.page.genes[name].about}` });
    box.dataset.gene = index;
    box.onchange = () => this.setGene(index, name, box.checked ? 1 : 0);
    const row = make("label", { className: "slider", title: this.page.genes[name].about }, make("span", { textContent: featureLabel(name) }), box);
    this.shown.push(() => {
      box.checked = this.values[index] > 0;
      row.classList.toggle("changed", box.checked !== this.original[index] > 0);
    });
    return row;
  }

  strengthSlider(robot) { // multiplies the torque of all legs
    const { low, high } = this.page.genes.leg_force;
    const forces = (values) => expressRobot(this.page, values).segments.flatMap(({ legs }) => (legs ? [[legs.source, legs.force]] : []));
    const strongest = (values) => Math.max(...forces(values).map(([, force]) => force));
    const slider = makeSlider({ label: "leg force", about: "greatest torque of the strongest leg; the torque of the other legs changes in proportion", low, high,
      step: 0.001, unit: "N·m", digits: 1, onInput: (value) => {
        const ratio = value / strongest(this.values);
        const values = [...this.values];
        for (const [source, force] of forces(this.values)) {
          values[geneIndex(this.page, "leg_force", source)] = Math.round(1000 * Math.min(Math.max(force * ratio, low), high)) / 1000;
        }
        this.setValues(values, "strength");
      } });
    this.shown.push(() => slider.set(strongest(this.values), strongest(this.original)));
    return robot.segments.some(({ legs }) => legs) ? slider.row : "";
  }

  setGene(index, name, wanted) {
    const { page } = this;
    const isDiscrete = page.genes[name].kind === "count";
    const { low, high, kind } = page.genes[name];
    let value = Math.min(Math.max(Math.round(wanted * 1000) / 1000, low), high);
    if (kind === "cyclic") value %= high;
    const fault = this.findFault(this.values.with(index, value));
    if (fault && isDiscrete) { this.showRejection(fault); return; }
    if (fault) value = nearestAllowed(page, this.values, index, value);
    const isGait = GAIT_FEATURES.includes(name) || ["frequency", "lag", "duty"].includes(name);
    this.setValues(this.values.with(index, value), isGait ? "gait" : name === "leg_force" ? "strength" : "body");
    if (fault) this.showRejection(fault);
  }

  findFault(values) { // returns why the page cannot show a genome, or ""
    const limit = violatedLimit(this.page, values);
    if (limit) return `The settings require ${limit}.`;
    return this.page.models[bodyPlan(expressRobot(this.page, values))] ? ""
      : "This page has no model of a robot with these legs, because there are too many combinations. Create a playground with such a robot.";
  }

  showRejection(fault) {
    for (const show of this.shown) show();
    this.showMessage(fault);
  }

  setValues(values, what) {
    this.state.genomes[this.state.selected] = values;
    this.showMessage("");
    this.showGenes();
    this.change(what);
  }

  showMessage(text) { this.change("message", text); }

  // ------------------------------------------------------------------------------------------------------------ text

  addText() {
    this.area = this.root.querySelector("textarea");
    const button = (name, act) => { this.root.querySelector(`.${name}`).onclick = act; };
    button("copy", () => this.copy());
    button("use", () => this.use(this.area.value));
  }

  showText() {
    this.area.value = formatGenome(this.page, this.values);
    this.error.textContent = "";
  }

  async copy() {
    this.area.select();
    try {
      await navigator.clipboard.writeText(this.area.value);
    } catch {
      document.execCommand("copy"); // if the page has no secure context, as in some notebooks
    }
    this.showMessage("The genome was copied to the clipboard.");
  }

  use(text) { // uses the text of a genome, or shows why the text is not valid
    try {
      const values = fitSegments(this.page, parseGenome(this.page, text));
      const fault = this.findFault(values);
      if (fault) throw new GenomeError(fault);
      this.setValues(values, "body");
    } catch (error) {
      if (!(error instanceof GenomeError)) throw error;
      this.error.textContent = error.message;
    }
  }
}
