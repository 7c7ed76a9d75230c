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

function parseSvg(svg) { // converts the text of an SVG to an element
  return document.importNode(new DOMParser().parseFromString(svg, "image/svg+xml").documentElement, true);
}
