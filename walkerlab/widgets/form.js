// The form: tabs with a row for each setting. Python validates the values of the controls, and returns the error
// messages and the settings that are unused. component.js and controls.js precede this file.
const PAUSE = 100; // ms between two values that are sent while a slider moves
const MAX_ROWS_WITHOUT_TABS = 8;

function render({ model, el }) {
  const rows = new Map(); // by "terrain.step_height"
  let selectedTab = ""; // its domain
  let changedLast = ""; // the setting that the user changed last
  let otherFaults = []; // messages about settings that are not shown
  let timer = 0;
  let sent = 0; // time of the last message, ms

  function send() {
    timer = 0;
    sent = Date.now();
    model.save_changes();
  }

  function change(setting, value) {
    const [domain, field] = setting.split(".");
    const values = model.get("values");
    changedLast = setting;
    model.set("values", { ...values, [domain]: { ...values[domain], [field]: value } });
    timer ||= setTimeout(send, Math.max(0, sent + PAUSE - Date.now()));
  }

  // ------------------------------------------------------------------------- the help line
  const help = make("div", { className: "help" });

  function showHelp(setting) {
    const row = rows.get(setting);
    if (otherFaults.length) help.replaceChildren(make("span", { className: "fault" }, otherFaults.join(" ")));
    else if (!row) help.replaceChildren(model.get("tabs").find(({ domain }) => domain === selectedTab)?.about ?? "");
    else help.replaceChildren(make("b", {}, row.control.label), `: ${row.description}`);
  }

  function addHelp(panel) {
    const settingOf = ({ target }) => target.closest?.(".row")?.dataset.setting;
    panel.addEventListener("pointerover", (event) => showHelp(settingOf(event)));
    panel.addEventListener("focusin", (event) => showHelp(settingOf(event)));
    panel.addEventListener("pointerleave", () => showHelp(settingOf({ target: el.getRootNode().activeElement ?? el })));
  }

  // ------------------------------------------------------------------------- rows
  function makeRow(domain, control) {
    const setting = `${domain}.${control.name}`;
    const { elements, show } = KINDS[control.kind](control, (value) => change(setting, value));
    const [nameId, descriptionId, faultId] = [newId(), newId(), newId()];
    const limits = control.low === undefined ? "" : `; ${format(control.low)} to ${format(control.high)} ${control.unit}`;
    const description = `${control.term ? `${control.term} ` : ""}${control.about[0].toUpperCase()}${control.about.slice(1)}${limits.trimEnd()}. Default: ${control.default_text}.${control.fixed ? ` It is ${control.fixed}.` : ""}`;
    const unusedReason = make("small", { className: "unused-reason" });
    const reset = make("button", { type: "button", className: "reset", title: `reset to ${control.default_text}`,
      ariaLabel: `${control.label}: reset to ${control.default_text}`, onclick: () => change(setting, control.default) }, "↺");
    const fault = make("p", { className: "fault screen-reader-only", id: faultId, role: "status" });
    const kind = [control.kind, ...(control.hidden_if_unused ? ["optional"] : []), ...(control.fixed ? ["fixed"] : [])].join(" ");
    const fixedReason = make("small", { className: "fixed-reason" }, control.fixed);
    const element = make("div", { className: `row ${kind}`, role: "group",
      attributes: { "aria-labelledby": nameId, "aria-describedby": descriptionId, "data-setting": setting } },
      make("span", { className: "name", title: description }, make("span", { id: nameId }, control.label), fixedReason, unusedReason), ...elements, reset,
      fault, make("span", { className: "screen-reader-only", id: descriptionId }, description));
    const unit = element.querySelector(".unit");
    if (unit) unit.title = control.unit_term;
    rows.set(setting, { element, control, show, description, unusedReason, reset, fault });
    return element;
  }

  function showValues() {
    const values = model.get("values");
    for (const [setting, { control, show, reset, element }] of rows) {
      const [domain, field] = setting.split(".");
      const value = values[domain]?.[field] ?? control.default;
      const changed = JSON.stringify(value) !== JSON.stringify(control.default);
      show(value);
      element.classList.toggle("changed", changed);
      reset.style.visibility = changed && !control.fixed ? "visible" : "hidden";
      if (control.fixed) for (const input of element.querySelectorAll("input, select, button")) input.disabled = true;
    }
  }

  function showUnused() {
    const unused = model.get("unused");
    for (const [setting, { unusedReason, element }] of rows) {
      unusedReason.textContent = unused[setting] ?? "";
      element.classList.toggle("unused", setting in unused);
    }
  }

  const makeRows = ({ domain, controls }) => controls.map((control) => makeRow(domain, control));

  // A message names one or several settings. It is visible at one of them: at the setting that was changed last, if it
  // is named, or else at the next one below, so that the rows above do not move. The others are only marked.
  function showFaults() {
    const faults = model.get("faults");
    const order = [...rows.keys()];
    const visible = new Set(); // settings that show their messages
    const hadOtherFaults = otherFaults.length > 0;
    let appeared; // the first message that becomes visible
    otherFaults = [];
    for (const sentence of new Set(Object.values(faults).flatMap((sentences) => sentences.split("\n")))) {
      const named = order.filter((setting) => faults[setting]?.split("\n").includes(sentence));
      const below = named.find((setting) => order.indexOf(setting) > order.indexOf(changedLast));
      if (named.length) visible.add(named.includes(changedLast) ? changedLast : below ?? named.at(-1));
      else otherFaults.push(sentence);
    }
    if (hadOtherFaults || otherFaults.length) showHelp(changedLast);
    for (const [setting, { element, fault }] of rows) {
      const wrong = setting in faults;
      if (fault.textContent !== (faults[setting] ?? "")) fault.textContent = faults[setting] ?? "";
      const wasHidden = fault.classList.contains("screen-reader-only");
      fault.classList.toggle("screen-reader-only", !visible.has(setting));
      if (wasHidden && visible.has(setting)) appeared ??= fault;
      element.classList.toggle("wrong", wrong);
      for (const input of element.querySelectorAll("input, select")) {
        input.setAttribute("aria-invalid", wrong);
        if (wrong) input.setAttribute("aria-describedby", fault.id);
        else input.removeAttribute("aria-describedby");
      }
    }
    for (const { domain, tab, mark } of tabs) {
      const n = Object.keys(faults).filter((setting) => setting.startsWith(`${domain}.`)).length;
      tab.classList.toggle("wrong", n > 0);
      mark.textContent = n ? `: ${n} invalid` : "";
    }
    appeared?.scrollIntoView({ block: "nearest" }); // after the tabs, which become higher with a warning sign
  }

  // ------------------------------------------------------------------------- tabs
  let tabs = []; // {domain, tab, panel, mark}

  function selectTab(domain, focus) {
    selectedTab = domain;
    for (const { domain: other, tab, panel } of tabs) {
      tab.setAttribute("aria-selected", other === domain);
      tab.tabIndex = other === domain ? 0 : -1;
      panel.hidden = other !== domain;
      if (other === domain && focus) tab.focus();
    }
    showHelp();
  }

  function pressKey(event) { // arrow keys select the next or the previous tab
    const here = tabs.findIndex(({ domain }) => domain === selectedTab);
    const next = { ArrowRight: here + 1, ArrowLeft: here - 1 + tabs.length, Home: 0, End: tabs.length - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    selectTab(tabs[next % tabs.length].domain, true);
  }

  function makeTab({ domain, title, controls }) {
    const [tabId, panelId] = [newId(), newId()];
    const mark = make("span", { className: "screen-reader-only" });
    const tab = make("button", { type: "button", role: "tab", id: tabId,
      attributes: { "aria-controls": panelId }, onclick: () => selectTab(domain), onkeydown: pressKey }, title, mark);
    const panel = make("div", { className: "panel", role: "tabpanel", id: panelId,
      attributes: { "aria-labelledby": tabId } }, ...makeRows({ domain, controls }));
    return { domain, tab, panel, mark };
  }

  function makePresets() {
    const presets = model.get("presets");
    const menuId = newId();
    const about = make("span", { className: "quiet" });
    const box = make("select", { id: menuId, onchange: () => { model.set("preset", box.value); model.save_changes(); } },
      make("option", { value: "", disabled: true }, "custom"), ...presets.map(({ name }) => make("option", {}, name)));
    model.off("change:preset");
    const show = () => {
      box.value = model.get("preset");
      about.textContent = presets.find(({ name }) => name === box.value)?.about ?? "with the settings below";
    };
    model.on("change:preset", show);
    show();
    return make("div", { className: "presets" }, make("label", { htmlFor: menuId }, "world"), box, about);
  }

  function build() {
    const domains = model.get("tabs");
    if (!domains.length) return; // on a slow computer, the form is shown before its tabs have arrived
    const tabbed = domains.length > 1 && domains.flatMap(({ controls }) => controls).length > MAX_ROWS_WITHOUT_TABS;
    rows.clear();
    tabs = [];
    const panels = make("div", { className: "panels" });
    const strip = make("div", { className: "tabs", role: "tablist", ariaLabel: "settings" });
    for (const domain of domains) {
      if (tabbed) {
        tabs.push(makeTab(domain));
        strip.append(tabs.at(-1).tab);
        panels.append(tabs.at(-1).panel);
      } else {
        panels.append(make("div", { className: "panel" }, ...makeRows(domain)));
      }
    }
    addHelp(panels);
    el.classList.toggle("tabbed", tabbed);
    const worlds = model.get("presets").length ? [makePresets()] : [];
    el.replaceChildren(...worlds, ...(tabbed ? [strip] : []), panels, help);
    selectTab(domains.some(({ domain }) => domain === selectedTab) ? selectedTab : domains[0].domain);
    for (const show of [showValues, showUnused, showFaults]) show();
  }

  el.classList.add("wl-component", "wl-form");
  const releaseKeys = captureKeys(el);
  const listeners = { tabs: build, values: showValues, unused: showUnused, faults: showFaults };
  for (const [trait, show] of Object.entries(listeners)) model.on(`change:${trait}`, show);
  build();
  return () => {
    clearTimeout(timer);
    if (timer) send();
    releaseKeys();
    for (const [trait, show] of Object.entries(listeners)) model.off(`change:${trait}`, show);
    model.off("change:preset");
  };
}
export default { render };
