// The form: tabs of rows, a row to each setting. What a control says goes to Python, which knows what can be, and
// answers with what is wrong, and with what does not matter now. component.js and controls.js stand before this.
const PAUSE = 100; // ms between two values that are sent while a slider is moved
const ROOMY = 8; // rows that need no tabs

function render({ model, el }) {
  const rows = new Map(); // by "terrain.step_height"
  let chosen = ""; // the tab
  let touched = ""; // the row that was moved last
  let stray = []; // sentences on what is not shown
  let timer = 0;
  let sent = 0; // ms

  function send() {
    timer = 0;
    sent = Date.now();
    model.save_changes();
  }

  function tell(place, value) {
    const [domain, field] = place.split(".");
    const values = model.get("values");
    touched = place;
    model.set("values", { ...values, [domain]: { ...values[domain], [field]: value } });
    timer ||= setTimeout(send, Math.max(0, sent + PAUSE - Date.now()));
  }

  // ------------------------------------------------------------------------- the line that explains
  const told = make("div", { className: "told" });

  function explain(place) {
    const row = rows.get(place);
    if (stray.length) told.replaceChildren(make("span", { className: "fault" }, stray.join(" ")));
    else if (!row) told.replaceChildren(model.get("tabs").find(({ domain }) => domain === chosen)?.about ?? "");
    else told.replaceChildren(make("b", {}, row.control.label), `: ${row.meaning}`);
  }

  function listen(panel) {
    const placed = ({ target }) => target.closest?.(".row")?.dataset.setting;
    panel.addEventListener("pointerover", (event) => explain(placed(event)));
    panel.addEventListener("focusin", (event) => explain(placed(event)));
    panel.addEventListener("pointerleave", () => explain(placed({ target: el.getRootNode().activeElement ?? el })));
  }

  // ------------------------------------------------------------------------- a row
  function makeRow(domain, control) {
    const place = `${domain}.${control.name}`;
    const { elements, show } = KINDS[control.kind](control, (value) => tell(place, value));
    const [name, about, fault] = [fresh(), fresh(), fresh()];
    const bounds = control.low === undefined ? "" : `; ${brief(control.low)} to ${brief(control.high)} ${control.unit}`;
    const meaning = `${control.about}${bounds.trimEnd()}. By default ${control.usual}.`;
    const why = make("small", { className: "why" });
    const again = make("button", { type: "button", className: "again", title: `back to ${control.usual}`,
      ariaLabel: `${control.label}: back to ${control.usual}`, onclick: () => tell(place, control.default) }, "↺");
    const complaint = make("p", { className: "fault unseen", id: fault, role: "status" });
    const element = make("div", { className: `row ${control.kind}`, role: "group",
      attributes: { "aria-labelledby": name, "aria-describedby": about, "data-setting": place } },
      make("span", { className: "name" }, make("span", { id: name }, control.label), why), ...elements, again, complaint,
      make("span", { className: "unseen", id: about }, meaning));
    rows.set(place, { element, control, show, meaning, why, again, complaint, fault });
    return element;
  }

  function showValues() {
    const values = model.get("values");
    for (const [place, { control, show, again, element }] of rows) {
      const [domain, field] = place.split(".");
      const value = values[domain]?.[field] ?? control.default;
      const changed = JSON.stringify(value) !== JSON.stringify(control.default);
      show(value);
      element.classList.toggle("changed", changed);
      again.style.visibility = changed ? "visible" : "hidden";
    }
  }

  function showIdle() {
    const idle = model.get("idle");
    for (const [place, { why, element }] of rows) {
      why.textContent = idle[place] ?? "";
      element.classList.toggle("idle", place in idle);
    }
  }

  // Rows of which only some matter at a time stand in a place of their own, which is as high whichever do.
  function makeRows({ domain, controls }) {
    const lines = controls.map((control) => makeRow(domain, control));
    const some = lines.filter((_, n) => controls[n].alternative);
    if (some.length < 3) return lines;
    const place = make("div", { className: "alternatives" });
    const all = lines.map((line) => (line === some[0] ? place : line)).filter((line) => !some.includes(line));
    place.append(...some);
    return all;
  }

  // A sentence names all that it is about, and is read at one of them: at the control that was moved, if it is named,
  // or else at the next below it, so that nothing above moves. The others are marked, and carry it unseen.
  function showFaults() {
    const faults = model.get("faults");
    const order = [...rows.keys()];
    const loud = new Set();
    const [before, now] = [stray, []];
    for (const sentence of new Set(Object.values(faults).flatMap((told) => told.split("\n")))) {
      const named = order.filter((place) => faults[place]?.split("\n").includes(sentence));
      const below = named.find((place) => order.indexOf(place) > order.indexOf(touched));
      if (named.length) loud.add(named.includes(touched) ? touched : below ?? named.at(-1));
      else now.push(sentence);
    }
    stray = now;
    if (before.length || now.length) explain(touched);
    for (const [place, { element, complaint, fault }] of rows) {
      const wrong = place in faults;
      if (complaint.textContent !== (faults[place] ?? "")) complaint.textContent = faults[place] ?? "";
      const silent = complaint.classList.contains("unseen");
      complaint.classList.toggle("unseen", !loud.has(place));
      if (silent && loud.has(place)) complaint.scrollIntoView({ block: "nearest" });
      element.classList.toggle("wrong", wrong);
      for (const input of element.querySelectorAll("input, select")) {
        input.setAttribute("aria-invalid", wrong);
        if (wrong) input.setAttribute("aria-describedby", fault);
        else input.removeAttribute("aria-describedby");
      }
    }
    for (const { domain, tab, mark } of tabs) {
      const n = Object.keys(faults).filter((place) => place.startsWith(`${domain}.`)).length;
      tab.classList.toggle("wrong", n > 0);
      mark.textContent = n ? `: ${n} to be mended` : "";
    }
  }

  // ------------------------------------------------------------------------- tabs, and the whole
  let tabs = []; // {domain, tab, panel, mark}

  function choose(domain, focus) {
    if (chosen !== domain) el.querySelector(".panels").scrollTop = 0;
    chosen = domain;
    for (const { domain: other, tab, panel } of tabs) {
      tab.setAttribute("aria-selected", other === domain);
      tab.tabIndex = other === domain ? 0 : -1;
      panel.hidden = other !== domain;
      if (other === domain && focus) tab.focus();
    }
    explain();
  }

  function turn(event) { // arrow keys go from tab to tab
    const here = tabs.findIndex(({ domain }) => domain === chosen);
    const next = { ArrowRight: here + 1, ArrowLeft: here - 1 + tabs.length, Home: 0, End: tabs.length - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    choose(tabs[next % tabs.length].domain, true);
  }

  function makeTab({ domain, title, controls }) {
    const [name, place] = [fresh(), fresh()];
    const mark = make("span", { className: "unseen" });
    const tab = make("button", { type: "button", role: "tab", id: name,
      attributes: { "aria-controls": place }, onclick: () => choose(domain), onkeydown: turn }, title, mark);
    const panel = make("div", { className: "panel", role: "tabpanel", id: place,
      attributes: { "aria-labelledby": name } }, ...makeRows({ domain, controls }));
    return { domain, tab, panel, mark };
  }

  function makePresets() {
    const presets = model.get("presets");
    const [name, about] = [fresh(), make("span", { className: "quiet" })];
    const box = make("select", { id: name, onchange: () => { model.set("preset", box.value); model.save_changes(); } },
      make("option", { value: "", disabled: true }, "my own"), ...presets.map((one) => make("option", {}, one.name)));
    model.off("change:preset");
    const show = () => {
      box.value = model.get("preset");
      about.textContent = presets.find((one) => one.name === box.value)?.about ?? "as it is set below";
    };
    model.on("change:preset", show);
    show();
    return make("div", { className: "presets" }, make("label", { htmlFor: name }, "world"), box, about);
  }

  function build() {
    const domains = model.get("tabs");
    const tabbed = domains.length > 1 && domains.flatMap(({ controls }) => controls).length > ROOMY;
    rows.clear();
    tabs = [];
    const panels = make("div", { className: "panels" });
    const strip = make("div", { className: "tabs", role: "tablist", ariaLabel: "settings" });
    for (const one of domains) {
      if (tabbed) {
        tabs.push(makeTab(one));
        strip.append(tabs.at(-1).tab);
        panels.append(tabs.at(-1).panel);
      } else {
        panels.append(make("div", { className: "panel" }, ...makeRows(one)));
      }
    }
    listen(panels);
    el.classList.toggle("tabbed", tabbed);
    const worlds = model.get("presets").length ? [makePresets()] : [];
    el.replaceChildren(...worlds, ...(tabbed ? [strip] : []), panels, told);
    choose(domains.some(({ domain }) => domain === chosen) ? chosen : domains[0].domain);
    for (const show of [showValues, showIdle, showFaults]) show();
  }

  el.classList.add("wl-part", "wl-form");
  const free = own_keys(el);
  const heard = { tabs: build, values: showValues, idle: showIdle, faults: showFaults };
  for (const [trait, show] of Object.entries(heard)) model.on(`change:${trait}`, show);
  build();
  return () => {
    clearTimeout(timer);
    if (timer) send();
    free();
    for (const [trait, show] of Object.entries(heard)) model.off(`change:${trait}`, show);
    model.off("change:preset");
  };
}
export default { render };
