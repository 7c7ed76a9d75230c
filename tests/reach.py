"""Accessibility of a page: which controls are reached with the Tab key, and which have a name."""

import json

CONTROLS = "a[href], button, input, select, textarea, summary, [tabindex], [role=slider], [role=tab], [role=option]"

ROLES = {"button", "checkbox", "combobox", "link", "listbox", "option", "radio", "searchbox", "slider", "spinbutton"}
ROLES |= {"switch", "tab", "textbox"}

TAG = "element => element.cloneNode(false).outerHTML"

# Tab reaches one control of a group, and the arrow keys the others.
MISSED = """([controls, reached]) => {
    const group = element =>
        element.type === "radio" && element.name ? `radio ${element.name}`
        : element.closest("[role=tablist], [role=listbox], [role=radiogroup], [role=toolbar], [role=grid]");
    const groups = new Set(reached.map(group));
    return controls.filter(element => element.checkVisibility({ visibilityProperty: true })
        && !element.matches(":disabled") && !reached.includes(element)
        && !(group(element) && groups.has(group(element))));
}"""


def unnamed_controls(page, root):
    """Return the tags of the controls under an element (a CSS selector) that have no name, as Chromium computes it."""
    session = page.context.new_cdp_session(page)
    session.send("Accessibility.enable")
    found = session.send("Runtime.evaluate", {"expression": f"document.querySelector({json.dumps(root)})"})["result"]
    assert "objectId" in found, f"there is no {root}"
    nodes = session.send("Accessibility.queryAXTree", {"objectId": found["objectId"]})["nodes"]
    nameless = [node for node in nodes if is_control(node) and not node.get("name", {}).get("value", "").strip()]
    tags = [session.send("DOM.getOuterHTML", {"backendNodeId": node["backendDOMNodeId"]}) for node in nameless]
    session.detach()
    return [tag["outerHTML"].split(">")[0] + ">" for tag in tags]


def is_control(node):
    """Whether a node of the accessibility tree is one that people act on."""
    if node["ignored"]:
        return False
    role = node["role"]["value"]
    focusable = any(property["name"] == "focusable" and property["value"]["value"] for property in node["properties"])
    return role in ROLES or (focusable and role != "generic")  # what scrolls is focusable, and needs no name


START = """root => {
    const before = document.createElement("span"), focused = window.focusedByTab = [];
    before.tabIndex = 0;
    before.id = "before-the-root";
    document.querySelector(root).before(before);
    before.focus();
    const follow = ({ target }) => focused.push(target);
    document.addEventListener("focusin", follow, true);
    window.stopFollowing = () => {
        document.removeEventListener("focusin", follow, true);
        before.remove();
    };
}"""

LEFT = """root => {
    const inside = element => document.querySelector(root).contains(element);
    return !inside(document.activeElement) || focusedByTab.some(element => !inside(element));
}"""

REACHED = """root => {
    stopFollowing();
    const end = focusedByTab.findIndex(element => !document.querySelector(root).contains(element));
    return focusedByTab.slice(0, end < 0 ? undefined : end);
}"""

TABS_AT_ONCE = 10


def reached_by_keyboard(page, root):
    """Return a handle of the list of elements under an element (a CSS selector) that Tab reaches, in their order."""
    page.evaluate(START, root)
    for _ in range(500 // TABS_AT_ONCE):
        for _ in range(TABS_AT_ONCE):
            page.keyboard.press("Tab")
        if page.evaluate(LEFT, root):
            return page.evaluate_handle(REACHED, root)
    raise AssertionError("Tab does not leave the element")


def beyond_keyboard(page, root):
    """Return the tags of the visible and enabled controls under an element that no key reaches."""
    controls = page.locator(root).first.locator(CONTROLS).element_handles()
    return page.evaluate(
        f"([controls, reached]) => ({MISSED})([controls, reached]).map({TAG})",
        [controls, reached_by_keyboard(page, root)],
    )
