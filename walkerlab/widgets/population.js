// The robots of a generation: a grid of pictures, or a table. Arrow keys move the focus; Enter, Space or a click selects.
const PRELOAD_MARGIN = 40; // px above and below the visible area where pictures are also requested

const sign = (row) => make("span", { className: "sign", textContent: row.sign });

function tile(row) {
  const caption = make("span", { className: "caption" }, sign(row), row.rank && `${row.rank} `, make("span", { textContent: row.label }));
  const traits = { className: `tile ${row.kind}`, title: row.description, role: "option", ariaLabel: row.description };
  return make("div", traits, make("div", { className: "picture" }), caption);
}

function tableRow(row) {
  const [number, ...others] = row.cells.map((textContent) => make("td", { textContent }));
  number.prepend(sign(row));
  return make("tr", { className: row.kind, title: row.description }, number, ...others);
}

function table(columns, rows, sortedBy, sort) {
  const headings = columns.map(({ key, title, about, unit, direction }) => {
    const button = make("button", { type: "button", name: key, textContent: title, title: about, onclick: () => sort(key) });
    const ariaSort = key === sortedBy ? direction : null;
    return make("th", { scope: "col", ariaSort }, button, make("span", { className: "quiet", textContent: unit }));
  });
  return make("table", { role: "grid", ariaLabel: "robots" },
    make("thead", {}, make("tr", {}, ...headings)), make("tbody", {}, ...rows));
}

function render({ model, el }) {
  const set = (name, value) => {
    model.set(name, value);
    model.save_changes();
  };
  const title = make("h4");
  const warning = make("span", { className: "fault" });
  const note = make("span", { className: "quiet" });
  const sort = make("select", { onchange: () => set("sort", sort.value) },
    ...model.get("sort_options").map(({ key, order }) => make("option", { value: key, textContent: order })));
  const viewButtons = ["pictures", "table"].map((textContent, as_table) =>
    make("button", { type: "button", textContent, onclick: () => set("as_table", Boolean(as_table)) }));
  const field = make("div", { className: "field" });
  el.append(make("div", { className: "wl-component wl-population" },
    make("div", { className: "summary" }, title, warning, note),
    make("div", { className: "options" }, make("label", {}, "sort ", sort),
      make("span", { className: "views", role: "group", ariaLabel: "show robots as" }, ...viewButtons)),
    field));
  let robots = []; // elements of the robots, in order
  let current = 0; // index of the robot that the Tab key reaches
  let inView = false; // whether the widget is visible
  let pressed = false; // whether a pointer is down on a robot
  let isOutdated = false; // whether the list must be updated when the pointer is released
  const number = (robot) => Number(robot.dataset.robot);
  const releaseKeys = captureKeys(field);

  function moveTo(index) {
    current = Math.max(0, Math.min(index, robots.length - 1));
    robots.forEach((robot, i) => { robot.tabIndex = i === current ? 0 : -1; });
  }

  function list() {
    isOutdated = pressed; // elements do not move under a pressed pointer
    if (pressed) return;
    const { rows = [], columns, n_drawn, drawn_note, listed_note, ...generation } = model.get("generation");
    const asTable = model.get("as_table");
    const { scrollTop, scrollLeft } = field;
    const { dataset: { robot: focused } = {}, name } = field.contains(document.activeElement) ? document.activeElement : {};
    title.textContent = generation.title ?? "No generation yet";
    warning.textContent = generation.warning ?? "";
    warning.title = generation.warning_about ?? "";
    note.textContent = [rows.length && model.get("hint"), asTable ? listed_note : drawn_note].filter(Boolean).join("; ");
    sort.value = model.get("sort");
    viewButtons.forEach((button, i) => { button.ariaPressed = Boolean(i) === asTable; });
    robots = asTable ? rows.map(tableRow) : rows.slice(0, n_drawn).map(tile);
    robots.forEach((robot, i) => { robot.dataset.robot = rows[i].individual; });
    const empty = "The robots of each generation appear here when they have walked.";
    field.replaceChildren(
      !robots.length ? make("p", { className: "quiet", textContent: empty })
      : asTable ? table(columns, robots, model.get("sort"), (key) => set("sort", key))
      : make("div", { className: "grid", role: "listbox", ariaLabel: "robots" }, ...robots));
    field.scrollTo(scrollLeft, scrollTop);
    const same = robots.findIndex((robot) => number(robot) === Number(focused ?? model.get("selected")));
    moveTo(same < 0 ? current : same);
    const toFocus = focused ? robots[current] : name && field.querySelector(`[name="${name}"]`);
    toFocus?.focus({ preventScroll: true });
    markSelected();
    addPictures();
    requestPictures();
  }

  function markSelected() {
    for (const robot of robots) robot.ariaSelected = number(robot) === model.get("selected");
  }

  function addPictures() {
    const pictures = model.get("pictures");
    for (const robot of robots) {
      const frame = robot.querySelector(".picture:empty");
      const svg = frame && pictures[robot.dataset.robot];
      if (svg) frame.append(parseSvg(svg));
    }
  }

  function requestPictures() { // reports the range of robots whose pictures are visible
    const inside = robots.flatMap((robot, i) => {
      const top = robot.offsetTop - field.scrollTop;
      return top > -PRELOAD_MARGIN - robot.offsetHeight && top < field.clientHeight + PRELOAD_MARGIN ? [i] : [];
    });
    const visible = inView && inside.length && !model.get("as_table") ? [inside[0], inside.at(-1) + 1] : [0, 0];
    if (String(visible) !== String(model.get("visible"))) set("visible", visible);
  }

  field.onkeydown = (event) => {
    if (!robots.includes(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    const nextRow = robots.findIndex((robot) => robot.offsetTop > robots[0].offsetTop);
    const perRow = nextRow < 0 ? robots.length : nextRow;
    const page = perRow * Math.max(1, Math.floor(field.clientHeight / event.target.offsetHeight));
    const steps = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: perRow, ArrowUp: -perRow };
    const jumps = { Home: 0, End: robots.length - 1, PageDown: current + page, PageUp: current - page };
    if (event.key in steps) moveTo(current + steps[event.key] in robots ? current + steps[event.key] : current);
    else if (event.key in jumps) moveTo(jumps[event.key]);
    else if (event.key === "Enter" || event.key === " ") set("selected", number(event.target));
    else return;
    event.preventDefault();
    robots[current].focus();
  };
  field.onclick = ({ target }) => {
    const robot = target.closest("[data-robot]");
    if (robot) set("selected", number(robot));
  };
  field.addEventListener("focusin", ({ target }) => { if (robots.includes(target)) moveTo(robots.indexOf(target)); });
  field.onpointerdown = ({ target }) => { pressed = Boolean(target.closest("[data-robot]")); };
  const released = () => setTimeout(() => { // after the click event
    pressed = false;
    if (isOutdated) list();
  });
  for (const end of ["pointerup", "pointercancel"]) window.addEventListener(end, released);
  field.onscroll = requestPictures;
  const viewObserver = new IntersectionObserver((changes) => {
    inView = changes.at(-1).isIntersecting;
    requestPictures();
  });
  const sizeObserver = new ResizeObserver(requestPictures);
  viewObserver.observe(field);
  sizeObserver.observe(field);

  const listeners = { generation: list, as_table: list, selected: markSelected, pictures: addPictures };
  for (const [trait, update] of Object.entries(listeners)) model.on(`change:${trait}`, update);
  list();
  return () => {
    for (const [trait, update] of Object.entries(listeners)) model.off(`change:${trait}`, update);
    for (const end of ["pointerup", "pointercancel"]) window.removeEventListener(end, released);
    releaseKeys();
    viewObserver.disconnect();
    sizeObserver.disconnect();
  };
}
export default { render };
