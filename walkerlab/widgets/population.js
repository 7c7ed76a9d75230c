// The robots of a generation: a grid of pictures, or a table. Arrows move, Enter or Space selects, as does a click.
const AHEAD = 40; // pixels above and below what is seen, for which pictures are asked for as well

const sign = (row) => make("span", { className: "sign", textContent: row.sign });

function tile(row) {
  const foot = make("span", { className: "foot" }, sign(row), make("span", { textContent: row.worth }));
  const looks = { className: `tile ${row.kind}`, title: row.says, role: "option", ariaLabel: row.says };
  return make("div", looks, make("div", { className: "picture" }), foot);
}

function line(row) {
  const [number, ...others] = row.cells.map((textContent) => make("td", { textContent }));
  number.prepend(sign(row));
  return make("tr", { className: row.kind, title: row.says }, number, ...others);
}

function table(columns, lines, sorted, sort) {
  const heads = columns.map(({ key, title, unit, sorts }) => {
    const press = make("button", { type: "button", name: key, textContent: title, onclick: () => sort(key) });
    const ariaSort = key === sorted ? sorts : null;
    return make("th", { scope: "col", ariaSort }, press, make("span", { className: "quiet", textContent: unit }));
  });
  return make("table", { role: "grid", ariaLabel: "robots" },
    make("thead", {}, make("tr", {}, ...heads)), make("tbody", {}, ...lines));
}

function render({ model, el }) {
  const set = (name, value) => {
    model.set(name, value);
    model.save_changes();
  };
  const title = make("h4"), warning = make("span", { className: "fault" }), some = make("span", { className: "quiet" });
  const sort = make("select", { onchange: () => set("sort", sort.value) },
    ...model.get("sorts").map(({ key, words }) => make("option", { value: key, textContent: words })));
  const views = ["pictures", "table"].map((textContent, as_table) =>
    make("button", { type: "button", textContent, onclick: () => set("as_table", Boolean(as_table)) }));
  const field = make("div", { className: "field" });
  el.append(make("div", { className: "wl-part wl-population" },
    make("div", { className: "told" }, title, warning, some),
    make("div", { className: "choices" }, make("label", {}, "sort ", sort),
      make("span", { className: "views", role: "group", ariaLabel: "show them as" }, ...views)),
    field));
  let robots = []; // what can be selected, in order
  let at = 0; // the place among them that the Tab key comes to
  let seen = false, pressed = false, waiting = false;
  const number = (one) => Number(one.dataset.robot);
  const leave_keys = own_keys(field);

  function go(place) {
    at = Math.max(0, Math.min(place, robots.length - 1));
    robots.forEach((one, i) => { one.tabIndex = i === at ? 0 : -1; });
  }

  function list() {
    waiting = pressed; // nothing moves away under a finger
    if (pressed) return;
    const { rows = [], columns, drawn, some_drawn, some_listed, ...told } = model.get("roster");
    const as_table = model.get("as_table"), { scrollTop, scrollLeft } = field;
    const { dataset: { robot } = {}, name } = field.contains(document.activeElement) ? document.activeElement : {};
    title.textContent = told.title ?? "No generation yet";
    warning.textContent = warning.title = told.warning ?? "";
    some.textContent = (as_table ? some_listed : some_drawn) ?? "";
    sort.value = model.get("sort");
    views.forEach((view, i) => { view.ariaPressed = Boolean(i) === as_table; });
    robots = as_table ? rows.map(line) : rows.slice(0, drawn).map(tile);
    robots.forEach((one, i) => { one.dataset.robot = rows[i].individual; });
    const none = "The robots of each generation are shown here when they have walked.";
    field.replaceChildren(
      !robots.length ? make("p", { className: "quiet", textContent: none })
      : as_table ? table(columns, robots, model.get("sort"), (key) => set("sort", key))
      : make("div", { className: "grid", role: "listbox", ariaLabel: "robots" }, ...robots));
    field.scrollTo(scrollLeft, scrollTop);
    const same = robots.findIndex((one) => number(one) === Number(robot ?? model.get("selected")));
    go(same < 0 ? at : same);
    const held = robot ? robots[at] : name && field.querySelector(`[name="${name}"]`);
    held?.focus({ preventScroll: true });
    mark();
    fill();
    look();
  }

  function mark() {
    for (const one of robots) one.ariaSelected = number(one) === model.get("selected");
  }

  function fill() {
    const pictures = model.get("pictures");
    for (const one of robots) {
      const frame = one.querySelector(".picture:empty"), svg = frame && pictures[one.dataset.robot];
      if (svg) frame.append(document.importNode(new DOMParser().parseFromString(svg, "image/svg+xml").documentElement, true));
    }
  }

  function look() { // say which pictures are in sight
    const inside = robots.flatMap((one, i) => {
      const top = one.offsetTop - field.scrollTop;
      return top > -AHEAD - one.offsetHeight && top < field.clientHeight + AHEAD ? [i] : [];
    });
    const sight = seen && inside.length && !model.get("as_table") ? [inside[0], inside.at(-1) + 1] : [0, 0];
    if (String(sight) !== String(model.get("sight"))) set("sight", sight);
  }

  field.onkeydown = (event) => {
    if (!robots.includes(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    const below = robots.findIndex((one) => one.offsetTop > robots[0].offsetTop);
    const row = below < 0 ? robots.length : below;
    const page = row * Math.max(1, Math.floor(field.clientHeight / event.target.offsetHeight));
    const steps = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: row, ArrowUp: -row };
    const jumps = { Home: 0, End: robots.length - 1, PageDown: at + page, PageUp: at - page };
    if (event.key in steps) go(at + steps[event.key] in robots ? at + steps[event.key] : at);
    else if (event.key in jumps) go(jumps[event.key]);
    else if (event.key === "Enter" || event.key === " ") set("selected", number(event.target));
    else return;
    event.preventDefault();
    robots[at].focus();
  };
  field.onclick = ({ target }) => {
    const one = target.closest("[data-robot]");
    if (one) set("selected", number(one));
  };
  field.addEventListener("focusin", ({ target }) => { if (robots.includes(target)) go(robots.indexOf(target)); });
  field.onpointerdown = ({ target }) => { pressed = Boolean(target.closest("[data-robot]")); };
  const released = () => setTimeout(() => { // after the click that belongs to it
    pressed = false;
    if (waiting) list();
  });
  for (const end of ["pointerup", "pointercancel"]) window.addEventListener(end, released);
  field.onscroll = look;
  const watch = new IntersectionObserver((news) => { seen = news.at(-1).isIntersecting; look(); });
  const measure = new ResizeObserver(look);
  watch.observe(field);
  measure.observe(field);

  const heard = { "change:roster": list, "change:as_table": list, "change:selected": mark, "change:pictures": fill };
  for (const [news, answer] of Object.entries(heard)) model.on(news, answer);
  list();
  return () => {
    for (const [news, answer] of Object.entries(heard)) model.off(news, answer);
    for (const end of ["pointerup", "pointercancel"]) window.removeEventListener(end, released);
    leave_keys();
    watch.disconnect();
    measure.disconnect();
  };
}
export default { render };
