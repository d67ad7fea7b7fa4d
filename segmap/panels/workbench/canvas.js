// Maps side by side that are panned and zoomed together. Coordinates are metres about an origin.
const RAW = "#8c8c8c", MAP = "#000000", RESULT = "#0072b2", CHOSEN = "#b5478d", MEMBER = "#d55e00";
const KEYS = "Arrow keys move it, plus and minus zoom, 0 shows all of it.";
const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const WAY = "#009e73", TOGGLES = ".widget-toggle-button, .widget-toggle-buttons button";
const GAP = 8, NEAR = 9, LABEL = 22;

function floats(model, name) {
  const bytes = model.get(name);
  if (!bytes || !bytes.byteLength) return new Float32Array(0);
  const start = bytes.byteOffset || 0;
  return new Float32Array((bytes.buffer || bytes).slice(start, start + bytes.byteLength));
}

function copy(event) {  // what stands above a button for it
  const button = event.target.closest(".segmap-copy");
  if (button) navigator.clipboard.writeText(button.previousElementSibling.textContent);
}

function render({ model, el }) {
  const canvas = document.createElement("canvas");
  const pen = canvas.getContext && canvas.getContext("2d");
  if (!pen) {
    el.textContent = "This browser draws no canvas: workbench.export writes the map to a file.";
    return;
  }
  canvas.className = "segmap-canvas";
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "application");
  canvas.setAttribute("aria-roledescription", "map");
  Object.assign(canvas.style, { display: "block", width: "100%", cursor: "grab", touchAction: "none" });
  for (const line of document.querySelectorAll(".segmap-state")) line.setAttribute("role", "status");
  el.style.width = "100%";
  el.appendChild(canvas);
  let before, results, way, view, panes = [], width = 0, height = 0;
  let asked = false, dragged = null, moved = false, corners = null;

  function load() {
    before = floats(model, "before");
    results = [floats(model, "first"), floats(model, "second")].filter(
      (part, k) => part.length || (k === 0 && before.length));
    way = floats(model, "way");
  }

  function lay() {  // as many panes as there are maps, in one row unless they would be too narrow
    width = Math.max(200, el.clientWidth || 640);
    const all = [0, 1, 2].slice(0, 1 + Math.max(1, results.length)), shown = model.get("shown");
    const maps = shown === "both" ? all : shown === "before" ? [0] : all.slice(1);
    const columns = width / maps.length < 200 ? Math.ceil(maps.length / 2) : maps.length;
    const rows = Math.ceil(maps.length / columns), wide = (width - GAP * (columns - 1)) / columns;
    const tall = rows === 1 && width > 600 ? 0.55 * window.innerHeight : 0;  // beside the steps
    const high = Math.round(Math.min(560, Math.max(230, 0.85 * wide, tall)));
    height = rows * high + GAP * (rows - 1);
    panes = maps.map((map, k) => ({ map,
      x: (k % columns) * (wide + GAP), y: Math.floor(k / columns) * (high + GAP), w: wide, h: high }));
  }

  function fit() {  // the whole map in each pane
    const [w, h] = model.get("size"), pane = panes[0];
    moved = false;
    view = { x: 0, y: 0, scale: 0.94 * Math.min(pane.w / Math.max(w, 0.1), (pane.h - LABEL) / Math.max(h, 0.1)) };
  }

  const place = (pane, x, y) => [
    pane.x + pane.w / 2 + (x - view.x) * view.scale,
    pane.y + (pane.h + LABEL) / 2 - (y - view.y) * view.scale];

  function stroke(pane, segments, color, thick, rows) {
    pen.beginPath();
    const count = rows ? rows.length : segments.length / 4;
    for (let k = 0; k < count; k++) {
      const i = 4 * (rows ? rows[k] : k);
      pen.moveTo(...place(pane, segments[i], segments[i + 1]));
      pen.lineTo(...place(pane, segments[i + 2], segments[i + 3]));
    }
    pen.strokeStyle = color;
    pen.lineWidth = thick;
    pen.lineCap = "round";
    pen.stroke();
  }

  function marked(pane) {  // the way, two scans on it, and the rectangle that is drawn
    pen.beginPath();
    for (let i = 0; i < way.length; i += 2) pen.lineTo(...place(pane, way[i], way[i + 1]));
    pen.strokeStyle = WAY;
    pen.lineWidth = 1.5;
    pen.stroke();
    const ends = model.get("looked_at").filter(k => 2 * k < way.length)
      .map(k => place(pane, way[2 * k], way[2 * k + 1]));
    pen.beginPath();
    ends.forEach(end => { pen.lineTo(...end); });
    ends.forEach(([x, y]) => { pen.moveTo(x + 6, y); pen.arc(x, y, 6, 0, 2 * Math.PI); });
    if (corners) {
      const [x, y] = place(pane, ...corners[0]), [u, v] = place(pane, ...corners[1]);
      pen.rect(x, y, u - x, v - y);
    }
    pen.strokeStyle = CHOSEN;
    pen.lineWidth = 2.5;
    pen.stroke();
  }

  function bar(pane) {  // a length of 1, 2 or 5 times a power of ten, a quarter of the pane at most
    const most = pane.w / 4 / view.scale, ten = 10 ** Math.floor(Math.log10(most));
    const metres = [5, 2, 1].map(k => k * ten).find(m => m <= most), x = pane.x + 10, y = pane.y + pane.h - 10;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + metres * view.scale, y);
    pen.strokeStyle = MAP;
    pen.lineWidth = 3;
    pen.lineCap = "butt";
    pen.stroke();
    write(`${Number(metres.toPrecision(1))} m`, x, y - 6);
  }

  function write(text, x, y, bold) {
    pen.font = `${bold ? "600 " : ""}13px sans-serif`;
    pen.lineWidth = 4;
    pen.strokeStyle = "white";
    pen.lineJoin = "round";
    pen.strokeText(text, x, y);
    pen.fillStyle = MAP;
    pen.fillText(text, x, y);
  }

  function draw() {
    asked = false;
    const dots = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * dots);
    canvas.height = Math.round(height * dots);
    canvas.style.height = `${height}px`;
    pen.setTransform(dots, 0, 0, dots, 0, 0);
    pen.fillStyle = "white";
    pen.fillRect(0, 0, width, height);
    const [which, index] = model.get("pointed"), members = model.get("members"), titles = model.get("titles");
    canvas.setAttribute("aria-label", `${titles.join(", ") || "no map yet"}. ${KEYS}`);
    canvas.setAttribute("aria-description", model.get("summary"));
    panes.forEach(pane => {
      const k = pane.map;
      pen.save();
      pen.beginPath();
      pen.rect(pane.x, pane.y, pane.w, pane.h);
      pen.clip();
      if (k === 0) stroke(pane, before, MAP, 1);
      else if (results[k - 1]) {
        stroke(pane, before, RAW, 1);
        stroke(pane, results[k - 1], RESULT, 2);
      }
      if (which >= 0 && (k === 0 || k === which + 1)) {
        stroke(pane, before, MEMBER, k === 0 ? 2.5 : 1.5, members);
        if (k > 0 && 4 * index < results[which].length) stroke(pane, results[which], CHOSEN, 4, [index]);
      }
      marked(pane);
      write(titles[k] || "", pane.x + 8, pane.y + 16, true);
      if (before.length) bar(pane);
      else write("Run draws the map here", pane.x + pane.w / 2 - 70, pane.y + pane.h / 2);
      pen.restore();
      pen.strokeStyle = "#d0d0d0";
      pen.lineWidth = 1;
      pen.strokeRect(pane.x + 0.5, pane.y + 0.5, pane.w - 1, pane.h - 1);
    });
    canvas.dataset.view = [view.x, view.y, view.scale].map(n => n.toFixed(4)).join(" ");
  }

  function ask() {
    if (!asked) requestAnimationFrame(draw);
    asked = true;
  }

  function at(event) {  // the pane under the mouse, and the place of the map there
    const box = canvas.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
    const k = panes.findIndex(p => x >= p.x && x <= p.x + p.w && y >= p.y && y <= p.y + p.h);
    const pane = panes[Math.max(k, 0)];
    return { k: k < 0 ? k : pane.map, x: view.x + (x - pane.x - pane.w / 2) / view.scale,
             y: view.y - (y - pane.y - (pane.h + LABEL) / 2) / view.scale };
  }

  function nearest(event) {  // the result's segment under the mouse: its map and its row
    const { k, x, y } = at(event), segments = results[k - 1];
    let best = [-1, -1], least = NEAR / view.scale;
    if (!segments) return best;
    for (let i = 0; i < segments.length; i += 4) {
      const ax = segments[i], ay = segments[i + 1], dx = segments[i + 2] - ax, dy = segments[i + 3] - ay;
      const t = Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
      const off = Math.hypot(x - ax - t * dx, y - ay - t * dy);
      if (off < least) [best, least] = [[k - 1, i / 4], off];
    }
    return best;
  }

  function scan(event) {  // the place of the way under the mouse: its row
    const { x, y } = at(event);
    let best = -1, least = 2 * NEAR / view.scale;
    for (let i = 0; i < way.length; i += 2) {
      const off = Math.hypot(x - way[i], y - way[i + 1]);
      if (off < least) [best, least] = [i / 2, off];
    }
    return best;
  }

  let pinned = false, waiting = null;
  function point(found) {
    if (String(found) === String(model.get("pointed"))) return;
    model.set("pointed", found);
    model.save_changes();
  }

  function zoom(factor, spot) {
    const scale = Math.min(1e5, Math.max(1e-3, view.scale * factor)), f = view.scale / scale;
    moved = true;
    view = { x: spot.x + (view.x - spot.x) * f, y: spot.y + (view.y - spot.y) * f, scale };
    ask();
  }

  canvas.addEventListener("pointerdown", event => {
    dragged = { x: event.clientX, y: event.clientY, far: 0 };
    if (model.get("drawing")) corners = [at(event), at(event)].map(({ x, y }) => [x, y]);
    canvas.setPointerCapture(event.pointerId);
    canvas.style.cursor = "grabbing";
  });
  canvas.addEventListener("pointermove", event => {
    if (!dragged) {
      clearTimeout(waiting);
      if (!pinned) waiting = setTimeout(() => point(nearest(event)), 60);
      return;
    }
    const dx = event.clientX - dragged.x, dy = event.clientY - dragged.y;
    dragged = { x: event.clientX, y: event.clientY, far: dragged.far + Math.abs(dx) + Math.abs(dy) };
    if (corners) {
      const { x, y } = at(event);
      corners[1] = [x, y];
      return ask();
    }
    moved = moved || dx !== 0 || dy !== 0;
    view = { ...view, x: view.x - dx / view.scale, y: view.y + dy / view.scale };
    ask();
  });
  canvas.addEventListener("pointerup", event => {
    if (corners && dragged.far > 4) {
      const [xs, ys] = [0, 1].map(k => corners.map(corner => corner[k]).sort((a, b) => a - b));
      model.send({ rectangle: [xs[0], ys[0], xs[1], ys[1]] });
    } else if (dragged && dragged.far < 4) {
      const found = nearest(event), row = scan(event);
      pinned = found[0] >= 0;
      if (row >= 0) model.send({ scan: row });
      else point(found);
    }
    dragged = corners = null;
    ask();
    canvas.style.cursor = "grab";
  });
  canvas.addEventListener("pointercancel", () => { dragged = corners = null; });
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    zoom(Math.exp(-0.0015 * event.deltaY), at(event));
  }, { passive: false });
  canvas.addEventListener("dblclick", () => { fit(); ask(); });
  canvas.addEventListener("keydown", event => {
    const factor = { "+": 1.25, "=": 1.25, "-": 0.8 }[event.key], move = MOVES[event.key];
    if (factor) zoom(factor, view);
    else if (move) {
      const step = panes[0].w / 8 / view.scale;
      moved = true;
      view = { ...view, x: view.x + step * move[0], y: view.y + step * move[1] };
      ask();
    }
    else if (event.key === "0") { fit(); ask(); }
    else return;
    event.preventDefault();
    event.stopPropagation();
  });

  function changed() {
    const count = panes.length;
    load();
    lay();
    if (!view || panes.length !== count) fit();
    ask();
  }
  function another() { load(); lay(); fit(); ask(); }
  model.on("change:before change:first change:second change:titles", changed);
  model.on("change:size change:shown", another);
  model.on("change:pointed change:members change:summary", ask);
  model.on("change:way change:looked_at", () => { load(); ask(); });
  model.on("msg:custom", (content, buffers) => {  // a file to keep
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob(buffers));
    link.download = content.name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  });
  const watch = new ResizeObserver(() => {
    if (!el.clientWidth || el.clientWidth === width) return;
    const before = panes[0].w;
    lay();
    if (moved) view.scale *= panes[0].w / before;
    else fit();
    ask();
  });
  watch.observe(el);
  const press = () => {  // a toggle tells what it is by its colour only
    for (const button of document.querySelectorAll(TOGGLES))
      button.setAttribute("aria-pressed", button.classList.contains("mod-active"));
    for (const part of document.querySelectorAll(".noUi-handle, .widget-readout")) {  // of a slider
      const row = part.closest(".jupyter-widgets"), name = row && row.querySelector(".widget-label");
      if (name) part.setAttribute("aria-label", name.textContent);
      if (part.isContentEditable) part.setAttribute("role", "textbox");
    }
  };
  const presses = new MutationObserver(press);
  presses.observe(document.body,
    { subtree: true, childList: true, attributes: true, attributeFilter: ["class"] });
  document.addEventListener("click", copy);
  press();
  another();
  return () => {
    watch.disconnect();
    presses.disconnect();
    document.removeEventListener("click", copy);
    clearTimeout(waiting);
  };
}

export default { render };
