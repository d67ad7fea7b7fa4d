// What figures to drag share: a drawing in metres, and handles for mouse, finger and arrow keys.
const GREY = "#949494", ORANGE = "#d55e00", BLUE = "#0072b2", BLACK = "#000000";
const KEY_STEP = 0.01; // metres; ten times as far with the shift key

function addPart(parent, name, attributes = {}) {
  const part = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const key in attributes) part.setAttribute(key, attributes[key]);
  parent.append(part);
  return part;
}

/** A drawing of [left, low, right, top], metres, y up, no higher than 60 % of the window. */
function addDrawing(el, [left, low, right, top], label) {
  const [width, height] = [right - left, top - low];
  const svg = addPart(el, "svg", {
    viewBox: `${left} ${-top} ${width} ${height}`, role: "group", "aria-label": label,
    style: `display:block; width:min(100%, 640px, ${(60 * width) / height}vh); background:#fff;`
      + "border:1px solid #ccc; touch-action:none; cursor:grab; user-select:none",
  });
  return addPart(svg, "g", { transform: "scale(1,-1)" });
}

/** A path that is drawn later, as wide as `width` metres. */
const addPath = (plane, stroke, width) =>
  addPart(plane, "path", { stroke, "stroke-width": width, "stroke-linecap": "round", fill: "none" });
const dots = (points) => points.map(([x, y]) => `M${x.toFixed(4)} ${y.toFixed(4)}h0`).join("");
const lines = (pairs) =>
  pairs.map(([a, b, c, d]) => `M${a.toFixed(4)} ${b.toFixed(4)}L${c.toFixed(4)} ${d.toFixed(4)}`).join("");

/** Buttons below the drawing, { words: what a click does }, and the text that says what is measured. */
function addControls(el, buttons) {
  const row = document.createElement("div");
  row.style.cssText = "display:flex; flex-wrap:wrap; gap:.6em; align-items:center; margin:.4em 0";
  for (const words in buttons) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = words;
    button.addEventListener("click", () => buttons[words](button));
    row.append(button);
  }
  const text = document.createElement("output");
  text.setAttribute("aria-live", "polite");
  row.append(text);
  el.append(row);
  return text;
}

/**
 * Handles { name, at: () => [x, y], to: ([x, y]) => moves it } on a drawing. A press takes the
 * nearest one within `reach` metres; farther away the first, where that is dragged `anywhere`.
 * Returns what draws them where they are now.
 */
function addHandles(plane, handles, { radius = 0.1, reach = 0.3, anywhere = false } = {}) {
  const svg = plane.ownerSVGElement;
  const place = ({ clientX, clientY }) => {
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(plane.getScreenCTM().inverse());
    return [x, y];
  };
  const away = (handle, [x, y]) => Math.hypot(handle.at()[0] - x, handle.at()[1] - y);
  for (const handle of handles) {
    handle.circle = addPart(plane, "circle", {
      r: radius, fill: handle.fill ?? "#fff", stroke: handle.fill ? BLACK : BLUE, "stroke-width": radius / 4, tabindex: 0,
      role: "button", "aria-label": `${handle.name}: arrow keys move it`,
      style: "cursor:pointer; outline:none", // whose width would be in metres
    });
    for (const [event, wide] of [["focus", 2], ["blur", 4]])
      handle.circle.addEventListener(event, () => handle.circle.setAttribute("stroke-width", radius / wide));
    handle.circle.addEventListener("keydown", (event) => {
      const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!way) return;
      event.preventDefault();
      event.stopPropagation(); // in Lab the arrow keys would leave the cell
      const step = KEY_STEP * (event.shiftKey ? 10 : 1), [x, y] = handle.at();
      handle.to([x + step * way[0], y + step * way[1]]);
    });
  }
  let dragged = null, offset = [0, 0];
  svg.addEventListener("pointerdown", (event) => {
    const from = place(event);
    const [nearest] = [...handles].sort((a, b) => away(a, from) - away(b, from));
    dragged = away(nearest, from) <= reach ? nearest : anywhere ? handles[0] : null;
    if (!dragged) return;
    const [x, y] = dragged.at();
    offset = [x - from[0], y - from[1]];
    dragged.circle.focus({ preventScroll: true });
    svg.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  svg.addEventListener("pointermove", (event) => {
    if (!dragged) return;
    const [x, y] = place(event);
    dragged.to([x + offset[0], y + offset[1]]);
  });
  for (const end of ["pointerup", "pointercancel"]) svg.addEventListener(end, () => { dragged = null; });
  return () => {
    for (const { circle, at } of handles) {
      const [x, y] = at();
      circle.setAttribute("cx", x);
      circle.setAttribute("cy", y);
    }
  };
}
