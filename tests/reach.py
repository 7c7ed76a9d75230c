"""Whoever has no mouse, or hears the page read out: which controls the Tab key comes to, and which have a name."""

import json

CONTROLS = "a[href], button, input, select, textarea, summary, [tabindex], [role=slider], [role=tab], [role=option]"

ROLES = {"button", "checkbox", "combobox", "link", "listbox", "option", "radio", "searchbox", "slider", "spinbutton"}
ROLES |= {"switch", "tab", "textbox"}

TAG = "element => element.cloneNode(false).outerHTML"

# Of a group, Tab comes to one, and the arrow keys to the others.
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


def reached_by_keyboard(page, root):
    """Return handles of the elements under an element (a CSS selector) that Tab comes to, one after the other."""
    page.evaluate(
        """root => {
            const before = document.createElement("span");
            before.tabIndex = 0;
            before.id = "before-the-root";
            document.querySelector(root).before(before);
            before.focus();
        }""",
        root,
    )
    reached = []
    focused = "root => document.querySelector(root).contains(document.activeElement) ? document.activeElement : null"
    page.keyboard.press("Tab")
    while element := page.evaluate_handle(focused, root).as_element():
        reached.append(element)
        assert len(reached) < 500, "Tab does not come out of it"
        page.keyboard.press("Tab")
    page.evaluate("document.getElementById('before-the-root').remove()")
    return reached


def beyond_keyboard(page, root):
    """Return the tags of the controls under an element that are shown and enabled, and that no key comes to."""
    controls = page.locator(root).first.locator(CONTROLS).element_handles()
    return page.evaluate(f"them => ({MISSED})(them).map({TAG})", [controls, reached_by_keyboard(page, root)])
