// A gene as text. Behind it lies the same text unseen, in which the place of a fault is marked.
const PAUSE = 150; // ms without a key, after which what is written is read

let made = 0;

function render({ model, el }) {
  const id = `wl-editor-${made++}`;
  const area = make("textarea", { id, spellcheck: false, autocapitalize: "off", autocomplete: "off", rows: 11,
    attributes: { "aria-describedby": `${id}-fault` } });
  const behind = make("div", { className: "behind", ariaHidden: "true" });
  const label = make("label", { htmlFor: id, textContent: "Gene" });
  const fault = make("span", { id: `${id}-fault` });
  const show = make("button", { type: "button", textContent: "Show the place", onclick: () => {
    area.focus();
    area.setSelectionRange(...model.get("place"));
    area.scrollTop = behind.querySelector("mark").offsetTop - area.clientHeight / 2;
  } });
  const notes = make("ul", { className: "notes" });
  const said = make("div", { className: "said", attributes: { role: "status" } },
    make("p", { className: "fault" }, fault, show), notes);
  const picture = make("div", { className: "picture" });
  const walk = make("button", { type: "button", className: "main", textContent: "Let it walk", onclick: () => press("walk") });
  const insert = make("button", { type: "button", textContent: "Put it into the next generation", onclick: () => press("insert") });
  el.classList.add("wl-part", "wl-editor");
  el.append(
    make("div", { className: "gene" }, label, make("div", { className: "sheet" }, behind, area), said),
    make("div", { className: "robot" }, picture, make("div", { className: "buttons" }, walk, insert)));

  let timer = 0;

  function send() {
    clearTimeout(timer);
    timer = 0;
    model.set("text", area.value);
    model.save_changes();
  }

  function press(button) {
    if (timer) send(); // what was typed last counts
    model.send({ press: button });
  }

  function mark() {
    const [start, end] = timer ? [] : model.get("place"); // what is being typed is not read yet
    const text = area.value;
    const spot = make("mark", { textContent: text.slice(start, end) || " " });
    behind.replaceChildren(...(start === undefined ? [text] : [text.slice(0, start), spot, text.slice(end)]), "\n");
    behind.scrollTop = area.scrollTop;
  }

  function write() {
    if (timer || area.value === model.get("text")) return;
    area.value = model.get("text");
    mark();
  }

  function tell() {
    const wrong = Boolean(model.get("fault"));
    fault.textContent = wrong ? `⚠ ${model.get("fault")}` : "";
    show.hidden = !model.get("place").length;
    area.setAttribute("aria-invalid", wrong);
    notes.replaceChildren(...model.get("notes").map((textContent) => make("li", { textContent })));
    walk.hidden = !model.get("heard").includes("walk");
    insert.hidden = !model.get("heard").includes("insert");
    walk.disabled = wrong;
    insert.disabled = wrong || !model.get("can_insert");
    picture.classList.toggle("old", wrong);
    mark();
  }

  const draw = () => picture.replaceChildren(drawn(model.get("picture")));

  area.oninput = () => {
    clearTimeout(timer);
    timer = setTimeout(send, PAUSE);
    mark();
  };
  area.onscroll = () => { behind.scrollTop = area.scrollTop; };
  model.on("change:text", write);
  for (const name of ["fault", "place", "notes", "can_insert", "heard"]) model.on(`change:${name}`, tell);
  model.on("change:picture", draw);
  write();
  tell();
  if (model.get("picture")) draw();
  const leave_keys = own_keys(el);
  return () => { leave_keys(); if (timer) send(); };
}
export default { render };
