// The buttons of a run, its progress, and messages about it.
const PLAY = "M5 2l12 8-12 8z";
const BUTTONS = [
  // name, label, path of the icon, tooltip, states in which it is enabled
  ["start", "Start", PLAY, "evolve with the settings below", ["ready", "stopped", "finished", "failed"]],
  ["pause", "Pause", "M4 3h4v14H4z M12 3h4v14h-4z", "pause after the walks that have started", ["running"]],
  ["continue", "Continue", PLAY, "continue the paused run", ["paused"]],
  ["step", "One generation", "M4 3l8 7-8 7z M13 3h3v14h-3z", "evolve one more generation, or the first one of a new run, then pause", ["ready", "paused", "stopped", "finished", "failed"]],
  ["stop", "Stop", "M4 4h12v12H4z", "end the run; completed generations are saved", ["running", "paused"]],
];
const DISCONNECTED = "Python was restarted, so this panel is no longer connected. Run its cell again, after the cells before it; completed generations are saved.";
const STARTING = ["start", "step"]; // buttons that start a run, unless one is paused

function icon(pathData) { // an SVG, because not every computer has characters for these
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"), path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  for (const [name, value] of Object.entries({ viewBox: "0 0 20 20", width: 12, height: 12, fill: "currentColor", "aria-hidden": true })) svg.setAttribute(name, value);
  path.setAttribute("d", pathData);
  svg.append(path);
  return svg;
}

// Conditions under which a run ends early: name, label, tooltip, smallest value.
const CONDITIONS = [
  ["minutes", "after this many minutes", "no generation begins after this time", 0],
  ["target", "at this fitness", "the run ends when a robot reaches this fitness", null],
  ["patience", "after this many generations without a fitter robot", "the run ends if the fitness does not improve in this many generations", 1],
];

function conditions(model) {
  const fields = CONDITIONS.map(([name, label, title, min]) => {
    const field = make("input", { type: "number", step: "any", title, ariaLabel: `end early ${label}`,
      value: model.get("end_early")[name] ?? "", oninput: () => {
        const { [name]: _, ...others } = model.get("end_early");
        model.set("end_early", field.value === "" ? others : { ...others, [name]: field.valueAsNumber });
        model.save_changes();
      } });
    if (min !== null) field.min = min;
    return make("label", {}, `${label} `, field);
  });
  return make("details", { className: "conditions" }, make("summary", { textContent: "end early …" }), ...fields);
}

function render({ model, el }) {
  el.classList.add("wl-component", "wl-transport");
  const row = make("div", { className: "row" });
  const bar = make("progress", { max: 1, ariaLabel: "completed share of the run" });
  const [status, forecast] = ["words", "words"].map((className) => make("p", { className, attributes: { role: "status" } }));
  const buttons = BUTTONS.map(([name, label, pathData, title, states]) => {
    const button = make("button", { type: "button", title, onclick: () => model.send({ press: name }) }, icon(pathData), label);
    button.dataset.press = name;
    return { button, name, states };
  });
  row.append(...buttons.map(({ button }) => button), conditions(model));
  el.append(row, make("div", { className: "status" }, bar, status, forecast));

  let isDisconnected = false; // whether the kernel was restarted, so that no button has an effect

  function update() {
    const [state, fault] = [isDisconnected ? "disconnected" : model.get("state"), model.get("fault")];
    const focused = document.activeElement;
    for (const { button, name, states } of buttons) {
      button.disabled = !states.includes(state) || (fault !== "" && STARTING.includes(name) && state !== "paused");
      button.hidden = (name === "pause" || name === "continue") && name !== (state === "paused" ? "continue" : "pause");
      button.classList.toggle("main", !button.disabled && name === { running: "pause", paused: "continue" }[state] || (!button.disabled && name === "start"));
    }
    const other = { pause: "continue", continue: "pause", start: "pause" }[focused?.dataset?.press];
    if (other && row.contains(focused) && (focused.hidden || focused.disabled)) { // moves the focus to the button that replaces the focused one
      buttons.find(({ name, button }) => name === other && !button.hidden && !button.disabled)?.button.focus();
    }
    if (state === "running" && !model.get("share")) bar.removeAttribute("value"); // running, with nothing completed yet
    else bar.value = model.get("share");
    const next = state === "running" || state === "paused" ? model.get("note") : fault || model.get("forecast");
    status.textContent = isDisconnected ? DISCONNECTED : model.get("words");
    status.classList.toggle("fault", isDisconnected);
    forecast.textContent = isDisconnected ? "" : next;
    forecast.classList.toggle("fault", next !== "" && next === fault);
  }
  for (const name of ["state", "share", "words", "forecast", "note", "fault"]) model.on(`change:${name}`, update);
  model.on("comm_live_update", () => setTimeout(() => { // by then, the boxes of disconnected widgets are marked
    isDisconnected = Boolean(el.closest(".jupyter-widgets-disconnected"));
    update();
  }));
  update();
  const releaseKeys = captureKeys(el);
  const endScroll = startInView(el);
  return () => {
    releaseKeys();
    endScroll();
  };
}
export default { render };
