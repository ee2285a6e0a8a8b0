// Can everybody use the page? By keyboard, by screen reader, on a phone, against light and dark.
import assert from "node:assert/strict";

// Roles that somebody can do something with, or that are pictures.
const named = new Set(["button", "textbox", "combobox", "slider", "spinbutton", "link", "checkbox", "canvas", "image", "img"]);

async function everythingHasAName(page) {
  await page.call("Accessibility.enable");
  const { nodes } = await page.call("Accessibility.getFullAXTree");
  const asked = nodes.filter(({ ignored, role }) => !ignored && named.has(role?.value.toLowerCase()));
  assert.ok(asked.length > 5, `only ${asked.length} controls`);
  // What a picture consists of is told by the picture's name.
  const byId = new Map(nodes.map((node) => [node.nodeId, node]));
  const isPart = ({ parentId }) => {
    const above = byId.get(parentId);
    return above && (/^(img|image)$/.test(above.role?.value) && above.name?.value ? true : isPart(above));
  };
  const nameless = asked.filter((node) => !node.name?.value.trim() && !isPart(node));
  assert.deepEqual(nameless.map(({ role, backendDOMNodeId }) => `${role.value} ${backendDOMNodeId}`), [], "without a name");
  return asked.length;
}

// In the page: texts whose contrast with what is behind them is less than AA asks for.
function pale() {
  const parse = (text) => {
    const [r, g, b, a = 1] = text.match(/[\d.]+/g).map(Number);
    return { r, g, b, a };
  };
  const over = (top, below) => {
    const mix = (name) => top[name] * top.a + below[name] * (1 - top.a);
    return { r: mix("r"), g: mix("g"), b: mix("b"), a: 1 };
  };
  const behind = (element) => {
    if (!element) return { r: 255, g: 255, b: 255, a: 1 };
    const own = parse(getComputedStyle(element).backgroundColor);
    return own.a === 1 ? own : over(own, behind(element.parentElement));
  };
  const light = ({ r, g, b }) => {
    const [x, y, z] = [r, g, b].map((c) => c / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
    return 0.2126 * x + 0.7152 * y + 0.0722 * z;
  };
  const found = [];
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  let looked = 0;
  while (texts.nextNode()) {
    const text = texts.currentNode.textContent.trim(), element = texts.currentNode.parentElement;
    // What is disabled may be pale, and options are drawn by the system.
    if (!text || !element.checkVisibility() || element.closest(":disabled, option, script, style")) continue;
    const style = getComputedStyle(element), ground = behind(element);
    const [low, high] = [light(over(parse(style.color), ground)), light(ground)].sort((a, b) => a - b);
    const size = parseFloat(style.fontSize), large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    const contrast = (high + 0.05) / (low + 0.05);
    ++looked;
    if (contrast < (large ? 3 : 4.5)) found.push(`${text.slice(0, 30)}: ${contrast.toFixed(2)}`);
  }
  return { looked, found };
}

async function textsStandOut(page, scheme) {
  await page.call("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: scheme }] });
  const { looked, found } = await page.evaluate(`(${pale})()`);
  assert.ok(looked > 10, `only ${looked} texts`);
  assert.deepEqual(found, [], `${scheme}: too pale`);
}

// By Tab from the top to the end: ids, each shown by an outline.
async function keyboard(page) {
  await page.evaluate("document.activeElement.blur(), window.scrollTo(0, 0)");
  const ids = [];
  for (let i = 0; i < 80; ++i) {
    for (const type of ["rawKeyDown", "keyUp"])
      await page.call("Input.dispatchKeyEvent", { type, key: "Tab", code: "Tab", windowsVirtualKeyCode: 9 });
    const { tag, id, outline } = await page.evaluate(`(() => {
      const at = document.activeElement;
      return { tag: at.tagName, id: at.id || at.getAttribute("name") || at.textContent.slice(0, 20), outline: getComputedStyle(at).outlineStyle };
    })()`);
    if (tag === "BODY" || (ids.length > 2 && id === ids[0])) break;
    assert.notEqual(outline, "none", `${id} has the focus, and nothing shows it`);
    ids.push(id);
  }
  return ids;
}

async function fitsAPhone(page) {
  await page.call("Emulation.setDeviceMetricsOverride", { width: 390, height: 844, deviceScaleFactor: 2, mobile: true });
  await new Promise((later) => setTimeout(later, 500));
  const widths = await page.evaluate("[document.documentElement.scrollWidth, innerWidth]");
  assert.ok(widths[0] <= 390 && widths[1] <= 390, `a phone must scroll sideways: ${widths}`);
  await page.call("Emulation.clearDeviceMetricsOverride");
}

// wanted: ids that the keyboard must come to.
export async function accessible(page, wanted) {
  const controls = await everythingHasAName(page);
  for (const scheme of ["light", "dark"]) await textsStandOut(page, scheme);
  await page.call("Emulation.setEmulatedMedia", { features: [] });
  const reached = await keyboard(page);
  for (const id of wanted) assert.ok(reached.includes(id), `${id} is not reached by Tab: ${reached}`);
  await fitsAPhone(page);
  return `${controls} controls have names, ${reached.length} are reached by Tab`;
}
