// Functions that all components share; this file precedes the script of each component.

function make(name, traits = {}, ...children) { // creates an element with properties, attributes and children
  const { attributes = {}, ...properties } = traits;
  const node = Object.assign(document.createElement(name), properties);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

function captureKeys(root) { // keeps plain keys from the notebook, except Shift Enter; returns a function that ends this
  const capture = ({ target, key, shiftKey, ctrlKey, metaKey, altKey }) => root.contains(target) &&
    target.toggleAttribute("data-lm-suppress-shortcuts", !(ctrlKey || metaKey || altKey || (shiftKey && key === "Enter")));
  window.addEventListener("keydown", capture, true);
  return () => window.removeEventListener("keydown", capture, true);
}

// Shift Enter selects the cell below and keeps it in view, so that a tall widget grows beyond the upper edge of the window.
// This scrolls to the start of the widget's cell, unless the user scrolls first.
function startInView(el) {
  const WAIT = 300; // ms without a change of height until the widget is complete
  const START_TIME = 20000; // ms after which the position remains, even if the widget is not complete
  const inputs = ["wheel", "keydown", "pointerdown", "touchstart"];
  let timer = 0;
  const reveal = () => {
    end();
    const cell = el.closest(".jp-Cell");
    const next = cell?.nextElementSibling;
    if (next?.classList.contains("jp-mod-active")) cell.scrollIntoView({ block: "start" });
  };
  const observer = new ResizeObserver(() => {
    const cell = el.closest(".jp-Cell"); // null before the widget is attached to the page
    if (cell) observer.observe(cell);
    clearTimeout(timer);
    timer = setTimeout(reveal, WAIT);
  });
  const deadline = setTimeout(() => end(), START_TIME);
  function end() {
    for (const one of [timer, deadline]) clearTimeout(one);
    observer.disconnect();
    for (const input of inputs) window.removeEventListener(input, end, true);
  }
  observer.observe(el);
  for (const input of inputs) window.addEventListener(input, end, true);
  return end;
}

function parseSvg(svg) { // converts the text of an SVG to an element
  return document.importNode(new DOMParser().parseFromString(svg, "image/svg+xml").documentElement, true);
}
