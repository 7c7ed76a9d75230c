// The buttons of a run, its progress, and what is said of it.
const PLAY = "M5 2l12 8-12 8z";
const BUTTONS = [
  // name, words, sign as a path, what it does, in which states it can be pressed
  ["start", "Start", PLAY, "evolve with the settings below", ["ready", "stopped", "finished", "failed"]],
  ["pause", "Pause", "M4 3h4v14H4z M12 3h4v14h-4z", "let no other robot begin to walk", ["running"]],
  ["go_on", "Go on", PLAY, "go on where it paused", ["paused"]],
  ["step", "One generation", "M4 3l8 7-8 7z M13 3h3v14h-3z", "evolve one generation more, or the first one of a new run, then pause", ["ready", "paused", "stopped", "finished", "failed"]],
  ["stop", "Stop", "M4 4h12v12H4z", "end the run here; all generations that are done are kept", ["running", "paused"]],
];
const NEW = ["start", "step"]; // which begin a run, unless one is paused

function icon(sign) { // not every computer has letters for these
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"), path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  for (const [name, value] of Object.entries({ viewBox: "0 0 20 20", width: 12, height: 12, fill: "currentColor", "aria-hidden": true })) svg.setAttribute(name, value);
  path.setAttribute("d", sign);
  svg.append(path);
  return svg;
}

function render({ model, el }) {
  el.classList.add("wl-part", "wl-transport");
  const row = make("div", { className: "row" });
  const bar = make("progress", { max: 1, ariaLabel: "how much of the run is done" });
  const [words, ahead] = ["words", "words"].map((className) => make("p", { className, attributes: { role: "status" } }));
  const buttons = BUTTONS.map(([name, text, sign, title, states]) => {
    const button = make("button", { type: "button", title, onclick: () => model.send({ press: name }) }, icon(sign), text);
    button.dataset.press = name;
    return { button, name, states };
  });
  row.append(...buttons.map(({ button }) => button));
  el.append(row, make("div", { className: "told" }, bar, words, ahead));

  function update() {
    const [state, fault] = [model.get("state"), model.get("fault")];
    const focused = document.activeElement;
    for (const { button, name, states } of buttons) {
      button.disabled = !states.includes(state) || (fault !== "" && NEW.includes(name) && state !== "paused");
      button.hidden = (name === "pause" || name === "go_on") && name !== (state === "paused" ? "go_on" : "pause");
      button.classList.toggle("main", !button.disabled && name === { running: "pause", paused: "go_on" }[state] || (!button.disabled && name === "start"));
    }
    const other = { pause: "go_on", go_on: "pause", start: "pause" }[focused?.dataset?.press];
    if (other && row.contains(focused) && (focused.hidden || focused.disabled)) { // the keyboard stays where it was
      buttons.find(({ name, button }) => name === other && !button.hidden && !button.disabled)?.button.focus();
    }
    if (state === "running" && !model.get("share")) bar.removeAttribute("value"); // something happens, and nothing is done yet
    else bar.value = model.get("share");
    const next = state === "running" || state === "paused" ? "" : fault || model.get("forecast");
    words.textContent = model.get("words");
    ahead.textContent = next;
    ahead.classList.toggle("fault", next !== "" && next === fault);
  }
  for (const name of ["state", "share", "words", "forecast", "fault"]) model.on(`change:${name}`, update);
  update();
  return own_keys(el);
}
export default { render };
