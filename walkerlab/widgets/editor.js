// Sliders for the genes of a robot, its genome as text, and the result of its walk. Sliders and text are synchronised.
// Behind the text area is a transparent copy of its text, in which the error is marked.
const PAUSE = 150; // ms without a key press until the text is sent
const SLIDER_INTERVAL = 60; // ms between two positions of a slider that are sent
const MAX_WAIT = 600; // maximum time in ms that a position waits for Python's answer to the previous one
const WALK_PAUSE = 250; // ms from the last change of a gene to the walk
const DEGREES = 180 / Math.PI;
const SLIDER_STEP = 0.001; // resolution of genomes

let n_views = 0;

const short = (value) => String(Number(value.toFixed(3)));

function withUnit(gene, value) {
  if (gene.kind === "count") return gene.high === 1 ? (value ? "yes" : "no") : short(value);
  return `${short(value)} ${gene.unit}`.trim();
}

function describe(gene) { // label, meaning and range
  const range = gene.kind === "count" && gene.high === 1 ? "" : `, ${short(gene.low)} to ${withUnit(gene, gene.high)}`;
  return `${gene.label}: ${gene.meaning}${range}`;
}

// A row with the controls of one gene. `change(value, isFinal)` is called when the user moves them.
function geneRow(gene, id, change, help) {
  const isSwitch = gene.kind === "count" && gene.high === 1;
  const label = make("label", { htmlFor: id, textContent: gene.label });
  const unit = make("span", { className: "unit quiet" });
  const was = make("span", { className: "was" });
  const row = make("div", { className: isSwitch ? "row switch" : "row", title: describe(gene) }, label);
  let isHeld = false; // while the user drags, the slider does not follow Python
  let slider, number;
  let current = 0;
  if (isSwitch) {
    slider = make("input", { type: "checkbox", id, onchange: () => change(Number(slider.checked), true) });
    row.append(slider, unit, was);
  } else {
    const step = gene.kind === "count" ? 1 : SLIDER_STEP;
    const limits = { min: gene.low, max: gene.high, step };
    slider = make("input", { type: "range", id, ...limits,
      oninput: () => { isHeld = true; number.value = slider.value; showUnit(Number(slider.value)); change(Number(slider.value), false); },
      onchange: () => { isHeld = false; change(Number(slider.value), true); } });
    const enter = () => { if (number.value !== "") change(Number(number.value), true); };
    number = make("input", { type: "number", step, ariaLabel: `${gene.label}, exact value`, onchange: enter,
      onblur: () => { if (number.value === "") number.value = short(current); }, // not a number, or nothing
      onkeydown: ({ key }) => { if (key === "Enter") enter(); } });
    row.append(slider, number, unit, was);
  }
  row.addEventListener("pointerenter", () => help(gene));
  row.addEventListener("focusin", () => help(gene));

  function showUnit(value, isBeyond = false) { // with the angle in degrees
    unit.textContent = gene.unit === "rad" && !isBeyond ? `rad (${Math.round(value * DEGREES)}°)` : gene.unit;
  }

  function show(value, repaired, original, isUsed, isValid) {
    row.classList.toggle("unused", !isUsed);
    row.title = isUsed ? describe(gene) : `${describe(gene)}. This gene has no effect on this robot.`;
    const isChanged = isValid && original !== undefined && Math.abs(value - original) > SLIDER_STEP / 2;
    const isBeyond = isValid && isUsed && Math.abs(value - repaired) > SLIDER_STEP / 2;
    row.classList.toggle("changed", isChanged);
    row.classList.toggle("beyond", isBeyond);
    const shown = (number) => (isSwitch ? withUnit(gene, number) : short(number));
    was.textContent = isBeyond ? `used: ${shown(repaired)}` : isChanged ? `was ${shown(original)}` : "";
    slider.disabled = !isValid;
    if (number) number.disabled = !isValid;
    current = value;
    if (isHeld) return;
    if (isSwitch) slider.checked = value > 0.5;
    else {
      slider.value = value;
      if (document.activeElement !== number || Number(number.value) !== value) number.value = short(value);
      slider.ariaValueText = withUnit(gene, value);
    }
    showUnit(value, isBeyond);
  }
  return { row, show };
}

function render({ model, el }) {
  const id = `wl-editor-${n_views++}`;
  const area = make("textarea", { id, spellcheck: false, autocapitalize: "off", autocomplete: "off", rows: 9,
    attributes: { "aria-describedby": `${id}-fault` } });
  const behind = make("div", { className: "behind", ariaHidden: "true" });
  const label = make("label", { htmlFor: id, textContent: "Genome" });
  const inherited = make("span", { className: "quiet" });
  const fault = make("span", { id: `${id}-fault` });
  const scrollToError = () => {
    const marked = behind.querySelector("mark");
    if (marked) area.scrollTop = marked.offsetTop - area.clientHeight / 2;
  };
  const show = make("button", { type: "button", textContent: "Show the error", onclick: () => {
    area.focus();
    area.setSelectionRange(...model.get("fault_range"));
    scrollToError();
  } });
  const notes = make("ul", { className: "notes" });
  const messages = make("div", { className: "messages", attributes: { role: "status" } },
    make("p", { className: "fault" }, fault, show), notes);
  const picture = make("div", { className: "picture" });
  const result = make("div", { className: "result", attributes: { role: "status" } });
  const press = (name, textContent, title, className = "") =>
    make("button", { type: "button", className, textContent, title, onclick: () => { flushText(); model.send({ press: name }); } });
  const walk = press("walk", "Play its walk", "play the walk in 3D, beside the unedited robot and the champion", "main");
  const live = press("live", "Walk live", "simulate the robot in the browser; the sliders change it while it walks");
  const insert = press("insert", "Insert into the next generation", "");
  const resume = press("continue", "Continue with this robot", "continue the selected run; this robot replaces a child in its next generation");
  const restore = make("button", { type: "button", onclick: () => model.send({ press: "restore" }) });
  const undo = press("undo", "Undo all changes", "");
  const hint = make("p", { className: "quiet hint" });
  const report = make("p", { className: "hint", attributes: { role: "status" } });
  const tabs = make("div", { className: "groups", role: "group", ariaLabel: "groups of genes" });
  const sections = make("div", { className: "sections" });
  const helpLine = make("p", { className: "quiet help" });
  el.classList.add("wl-component", "wl-editor");
  el.append(make("div", { className: "layout" },
    make("div", { className: "genes" }, tabs, helpLine, sections),
    make("div", { className: "robot" }, picture, result, make("div", { className: "buttons" }, walk, live, undo, restore, insert, resume), report, hint),
    make("div", { className: "genome" }, label, inherited, make("div", { className: "sheet" }, behind, area), messages)));

  // --------------------------------------------------------------------------------------------------------- sliders
  let rows = [];
  let group = "";
  let pending = null; // message with a slider's position that has not been sent
  let sliderTimer = 0;
  let isWaiting = false; // whether Python has not yet answered the last position
  let walkTimer = 0;

  let helped = null; // the gene that is described beside the sliders

  function help(gene = helped) {
    helped = gene;
    helpLine.textContent = gene ? model.get("reasons")[gene.name] ?? `${describe(gene)}.` : "Point at a gene to see what it means.";
  }

  function requestWalk() {
    clearTimeout(walkTimer);
    walkTimer = setTimeout(() => {
      if (model.get("fault")) return;
      result.classList.add("busy");
      model.send({ press: "try" });
    }, WALK_PAUSE);
  }

  function flushGene() {
    clearTimeout(sliderTimer);
    sliderTimer = 0;
    if (!pending) return;
    model.send(pending);
    pending = null;
    isWaiting = true;
    setTimeout(() => { isWaiting = false; if (pending) flushGene(); }, MAX_WAIT);
  }

  function change(index, value, isFinal) {
    pending = { gene: index, value };
    result.classList.add("outdated");
    clearTimeout(walkTimer);
    if (isFinal) { flushGene(); requestWalk(); }
    else if (!isWaiting) sliderTimer ||= setTimeout(flushGene, SLIDER_INTERVAL);
  }

  function buildRows() {
    const genes = model.get("genes");
    const groups = [...new Set(genes.map((gene) => gene.group))];
    if (!groups.includes(group)) group = groups[1] ?? groups[0] ?? "";
    tabs.replaceChildren(...groups.map((name) => make("button", { type: "button", textContent: name, onclick: () => {
      group = name;
      help(null);
      showGroup();
    } })));
    rows = genes.map((gene, index) => geneRow(gene, `${id}-${index}`, (value, isFinal) => change(index, value, isFinal), help));
    showGroup();
  }

  function showGroup() {
    const genes = model.get("genes");
    for (const tab of tabs.children) tab.ariaPressed = tab.textContent === group;
    const members = genes.flatMap((gene, index) => gene.group === group ? [{ ...gene, index }] : []);
    sections.replaceChildren(...[...new Set(members.map((gene) => gene.section))].map((section) =>
      make("fieldset", {}, make("legend", { attributes: { "data-section": section } }),
        ...members.filter((gene) => gene.section === section).map((gene) => rows[gene.index].row))));
    update();
  }

  // Returns the numbers of the segments that copy the legs and the step of a segment.
  function findCopies(number) {
    const [names, values, used] = [model.get("genes").map(({ name }) => name), model.get("repaired"), model.get("used")];
    const value = (name) => values[names.indexOf(name)];
    const copies = [];
    if (!used[names.indexOf(`seg${number}.leg_length`)]) return copies;
    for (let other = number + 1; other <= value("segments"); other++) {
      if (value(`seg${other}.legs`) < 0.5) continue;
      if (value(`seg${other}.repeat`) < 0.5) break;
      copies.push(other);
    }
    return copies;
  }

  function updateLegends() {
    const copies = group.startsWith("segment ") ? findCopies(Number(group.slice("segment ".length))) : [];
    const note = copies.length ? `, copied by segment${copies.length > 1 ? "s" : ""} ${copies.join(", ")}` : "";
    for (const legend of sections.querySelectorAll("legend")) {
      const { section } = legend.dataset;
      legend.textContent = section === "body" ? section : section + note;
    }
  }

  function updateGenes() {
    const [genes, ...lists] = ["genes", "values", "repaired", "original", "used"].map((name) => model.get(name));
    if (lists[0].length !== genes.length) return;
    const used = lists.at(-1);
    updateLegends();
    rows.forEach(({ show }, index) => show(...lists.map((list) => list[index]), !model.get("fault")));
    for (const tab of tabs.children) {
      const isUsed = genes.some((gene, index) => gene.group === tab.textContent && used[index]);
      tab.classList.toggle("unused", !isUsed);
      tab.title = isUsed ? "" : "This robot does not have this segment, so the genes of the segment have no effect.";
    }
    const unused = [...tabs.children].filter((tab) => tab.classList.contains("unused")).map((tab) => tab.textContent);
    inherited.textContent = unused.length ? `${unused.join(" and ")}: no effect on this robot, but inherited` : "";
  }

  // ------------------------------------------------------------------------------------------------------------ text
  let timer = 0;

  function send() {
    clearTimeout(timer);
    timer = 0;
    model.set("text", area.value);
    model.save_changes();
    requestWalk();
  }

  function flushText() { // so that a button acts on the current text
    if (timer) { send(); clearTimeout(walkTimer); }
  }

  function mark() {
    const [start, end] = timer ? [] : model.get("fault_range"); // unknown until the text is sent
    const text = area.value;
    const word = make("mark", { textContent: text.slice(start, end) || " " });
    behind.replaceChildren(...(start === undefined ? [text] : [text.slice(0, start), word, text.slice(end)]), "\n");
    behind.scrollTop = area.scrollTop;
  }

  function write() {
    if (timer || area.value === model.get("text")) return;
    const { scrollTop } = area;
    area.value = model.get("text");
    area.scrollTop = scrollTop;
    mark();
  }

  // --------------------------------------------------------------------------------------------------------- results
  function showResult() {
    const { distance, change: gain, before, verdict, counts, is_better, others = [] } = model.get("result");
    result.classList.remove("busy", "outdated");
    result.classList.toggle("rejected", counts === false);
    if (!distance) { result.replaceChildren(make("p", { className: "quiet", textContent: model.get("result").fault ?? "Move a slider: when you release it, the distance that the robot walks appears here." })); return; }
    const sign = make("span", { className: is_better ? "gain better" : "gain", textContent: gain });
    result.replaceChildren(
      make("p", {}, make("b", { textContent: distance }), " forward ", sign, make("span", { className: "before", textContent: before })),
      ...others.map((textContent) => make("p", { textContent })),
      make("p", { className: counts ? "quiet" : "fault", textContent: verdict }));
  }

  function update() {
    const wrong = Boolean(model.get("fault"));
    const buttons = model.get("buttons");
    const canInsert = model.get("can_insert");
    fault.textContent = wrong ? `⚠ ${model.get("fault")}` : "";
    show.hidden = !model.get("fault_range").length;
    area.setAttribute("aria-invalid", wrong);
    notes.replaceChildren(...model.get("notes").map((textContent) => make("li", { textContent })));
    walk.hidden = !buttons.includes("walk");
    live.hidden = !buttons.includes("live");
    insert.hidden = !buttons.includes("insert");
    resume.hidden = canInsert || !buttons.includes("continue");
    walk.disabled = live.disabled = wrong;
    resume.disabled = wrong || !model.get("can_continue");
    insert.disabled = wrong || !canInsert;
    insert.title = hint.textContent = insert.hidden || canInsert ? "" : model.get("insert_hint");
    report.textContent = model.get("report");
    restore.hidden = !model.get("replaced");
    restore.textContent = `Back to edited ${model.get("replaced")}`;
    picture.classList.toggle("outdated", wrong);
    if (wrong) { result.classList.remove("busy"); result.classList.add("outdated"); }
    mark();
    help();
    if (wrong && document.activeElement !== area) scrollToError();
    updateGenes();
    undo.disabled = !wrong && !sections.querySelector(".changed") && !rows.some(({ row }) => row.classList.contains("changed"));
  }

  function handleAnswer() {
    isWaiting = false;
    updateGenes();
    if (pending && !sliderTimer) flushGene();
  }

  const draw = () => picture.replaceChildren(parseSvg(model.get("picture")));

  area.oninput = () => {
    clearTimeout(timer);
    timer = setTimeout(send, PAUSE);
    result.classList.add("outdated");
    mark();
  };
  area.onscroll = () => { behind.scrollTop = area.scrollTop; };
  model.on("change:text", write);
  for (const name of ["fault", "fault_range", "notes", "can_insert", "can_continue", "replaced", "insert_hint", "report", "buttons", "original", "used", "values", "repaired", "reasons"]) model.on(`change:${name}`, update);
  model.on("change:values", handleAnswer);
  model.on("change:genes", buildRows);
  model.on("change:result", showResult);
  model.on("msg:custom", ({ walked }) => { if (walked) showResult(); });
  model.on("change:picture", draw);
  write();
  buildRows();
  showResult();
  if (model.get("picture")) draw();
  const releaseKeys = captureKeys(el);
  return () => {
    releaseKeys();
    if (timer) send();
    for (const one of [walkTimer, sliderTimer]) clearTimeout(one);
  };
}
export default { render };
