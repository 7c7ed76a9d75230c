// Questions with a button for each choice; Python replies to each choice.
function render({ model, el }) {
  const questions = model.get("items").map(({ text, choices }, position) => {
    const legend = make("legend", { textContent: text });
    const buttons = choices.map((choice) => make("button", { type: "button", textContent: choice,
      onclick: () => choose(position, choice), attributes: { "aria-pressed": "false" } }));
    const reply = make("p", { attributes: { role: "status" } });
    const group = make("fieldset", {}, legend, make("div", { className: "choices" }, ...buttons), reply);
    return { group, buttons, choices, reply };
  });
  el.classList.add("wl-component", "wl-questions");
  el.classList.toggle("side-by-side", model.get("is_row"));
  const heading = make("h4", { textContent: model.get("heading"), hidden: !model.get("heading") });
  el.append(heading, ...questions.map(({ group }) => group));

  function choose(position, choice) {
    model.set("answers", model.get("answers").with(position, choice));
    model.save_changes();
  }
  function update() {
    const replies = model.get("replies");
    const answers = model.get("answers");
    questions.forEach(({ buttons, choices, reply }, position) => {
      const { state, text, sign } = replies[position];
      buttons.forEach((button, number) => {
        const isChosen = choices[number] === answers[position];
        button.setAttribute("aria-pressed", String(isChosen));
        button.className = isChosen ? state.replace(" ", "-") : "";
      });
      const words = text && `${sign} ${text}`;
      if (reply.textContent !== words) reply.textContent = words; // otherwise, a screen reader would repeat it
      reply.className = state.replace(" ", "-");
    });
  }
  model.on("change:replies", update);
  model.on("change:answers", update);
  update();
  return captureKeys(el);
}
export default { render };
