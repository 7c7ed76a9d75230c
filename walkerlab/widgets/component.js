// What the JavaScript of all pieces shares; it stands before that of each.

function make(name, traits = {}, ...children) { // an element with its properties, its attributes, and what is in it
  const { attributes = {}, ...own } = traits;
  const node = Object.assign(document.createElement(name), own);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

function own_keys(root) { // plain keys are for what has the focus; those with Ctrl, and Shift Enter, for the notebook
  const claim = ({ target, key, shiftKey, ctrlKey, metaKey, altKey }) => root.contains(target) &&
    target.toggleAttribute("data-lm-suppress-shortcuts", !(ctrlKey || metaKey || altKey || (shiftKey && key === "Enter")));
  window.addEventListener("keydown", claim, true);
  return () => window.removeEventListener("keydown", claim, true);
}

function drawn(svg) { // the element that a drawing, which comes as text, stands for
  return document.importNode(new DOMParser().parseFromString(svg, "image/svg+xml").documentElement, true);
}
