// Maps side by side that are panned and zoomed together. Coordinates are metres about an origin.
const LIGHT = { ground: "#ffffff", map: "#000000", raw: "#8c8c8c", result: "#0072b2", chosen: "#b5478d",
  member: "#d55e00", way: "#009e73", free: "#e4e4e4", lines: "#d0d0d0" };
const DARK = { ground: "#161616", map: "#f2f2f2", raw: "#808080", result: "#56b4e9", chosen: "#e58fc4",
  member: "#ff8c42", way: "#2fc79b", free: "#303030", lines: "#484848" };
const KEYS = "Arrow keys move it, plus and minus zoom, 0 shows all of it, Enter measures from its middle.";
const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const PARTS = { bar: "run", steps: "steps", map: "map" };  // landmarks
const TOGGLES = ".widget-toggle-button, .widget-toggle-buttons button";
const GAP = 8, NEAR = 9, LABEL = 22;

function floats(model, name) {
  const bytes = model.get(name);
  if (!bytes || !bytes.byteLength) return new Float32Array(0);
  const start = bytes.byteOffset || 0;
  return new Float32Array((bytes.buffer || bytes).slice(start, start + bytes.byteLength));
}

function isDark() {  // as Lab's theme, or the page by itself, says
  return getComputedStyle(document.body).colorScheme === "dark" || document.body.dataset.jpThemeLight === "false";
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
  Object.assign(canvas.style, { position: "absolute", inset: "0", cursor: "grab", touchAction: "none" });
  for (const line of document.querySelectorAll(".segmap-state")) line.setAttribute("role", "status");
  Object.assign(el.style, { position: "relative", overflow: "hidden" });
  const where = document.createElement("div");  // the place that is under the pointer
  where.className = "segmap-where";
  el.append(canvas, where);
  let before, results, way, sure, loops, points, free, ink, view, panes = [], width = 0, height = 0;
  let asked = false, dragged = null, moved = false, corners = null, marks = [];

  function load() {
    const names = ["before", "way", "sure", "loops", "points", "free"];
    [before, way, sure, loops, points, free] = names.map(name => floats(model, name));
    results = [floats(model, "first"), floats(model, "second"), floats(model, "other")];
  }

  function lay() {  // as many panes as there are maps, in one row unless they would be too narrow
    width = Math.max(200, el.clientWidth || 640);
    height = Math.max(120, el.clientHeight || 360);
    const found = [1, 2, 3].filter(k => k === 1 || results[k - 1].length), shown = model.get("shown");
    const maps = model.get("growing") ? [0] : shown === "both" ? [0, ...found] : shown === "before" ? [0] : found;
    const columns = width / maps.length < 200 ? Math.ceil(maps.length / 2) : maps.length;
    const rows = Math.ceil(maps.length / columns), wide = (width - GAP * (columns - 1)) / columns;
    const high = (height - GAP * (rows - 1)) / rows;
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

  function squares(pane) {  // free space, as the leaves of the quadtree
    pen.fillStyle = ink.free;
    for (let i = 0; i < free.length; i += 3) {
      const [x, y] = place(pane, free[i], free[i + 1] + free[i + 2]), side = free[i + 2] * view.scale;
      pen.fillRect(x, y, side + 0.5, side + 0.5);
    }
  }

  function dots(pane, color) {
    pen.fillStyle = color;
    for (let i = 0; i < points.length; i += 2) {
      const [x, y] = place(pane, points[i], points[i + 1]);
      pen.fillRect(x - 0.75, y - 0.75, 1.5, 1.5);
    }
  }

  function grid(pane) {  // lines of the map's own coordinates
    const middle = model.get("middle"), ten = 10 ** Math.ceil(Math.log10(60 / view.scale));
    const step = [0.2, 0.5, 1].map(k => k * ten).find(m => m * view.scale >= 60);
    for (const k of [0, 1]) {
      const half = (k ? pane.h : pane.w) / 2 / view.scale, seen = (k ? view.y : view.x) + middle[k];
      for (let i = Math.ceil((seen - half) / step); i <= (seen + half) / step; i++) {
        const spot = place(pane, i * step - middle[0], i * step - middle[1])[k];
        pen.fillStyle = ink.lines;
        pen.fillRect(...(k ? [pane.x, spot, pane.w, 1] : [spot, pane.y, 1, pane.h]));
        const text = `${Number((i * step).toPrecision(9))}`;
        write(text, ...(k ? [pane.x + 3, spot - 3] : [spot + 3, pane.y + pane.h - 30]));
      }
    }
  }

  function path(pane) {  // where the robot went, the doubtful part in another colour
    for (const doubtful of [0, 1]) {
      pen.beginPath();
      for (let i = 0; i < way.length; i += 2) {
        const to = place(pane, way[i], way[i + 1]), k = i / 2;
        if (k && (sure.length && !sure[k] ? 1 : 0) === doubtful) pen.lineTo(...to);
        else pen.moveTo(...to);
      }
      pen.strokeStyle = doubtful ? ink.member : ink.way;
      pen.lineWidth = doubtful ? 3 : 1.5;
      pen.stroke();
    }
  }

  function robot(pane) {  // where it is now
    pen.beginPath();
    pen.arc(...place(pane, ...way.slice(-2)), 6, 0, 2 * Math.PI);
    pen.fillStyle = ink.member;
    pen.fill();
  }

  function marked(pane) {  // two scans of the way, the rectangle that is drawn, what is measured
    const ends = model.get("looked_at").filter(k => 2 * k < way.length)
      .map(k => place(pane, way[2 * k], way[2 * k + 1]));
    pen.beginPath();
    ends.forEach(end => { pen.lineTo(...end); });
    ends.forEach(([x, y]) => { pen.moveTo(x + 6, y); pen.arc(x, y, 6, 0, 2 * Math.PI); });
    if (corners) {
      const [x, y] = place(pane, ...corners[0]), [u, v] = place(pane, ...corners[1]);
      pen.rect(x, y, u - x, v - y);
    }
    const tool = model.get("tool"), spots = marks.map(mark => place(pane, mark.x, mark.y));
    spots.forEach(([x, y], k) => { k ? pen.lineTo(x, y) : pen.moveTo(x, y); });
    if (tool === "area" && spots.length > 2) pen.closePath();
    spots.forEach(([x, y]) => { pen.moveTo(x + 4, y); pen.arc(x, y, 4, 0, 2 * Math.PI); });
    const x = pane.x + pane.w / 2, y = pane.y + (pane.h + LABEL) / 2;
    if (tool !== "look" && document.activeElement === canvas) {  // where Enter measures
      [[8, 0], [0, 8]].forEach(([u, v]) => { pen.moveTo(x - u, y - v); pen.lineTo(x + u, y + v); });
    }
    pen.strokeStyle = ink.chosen;
    pen.lineWidth = 2.5;
    pen.stroke();
    const size = measured(tool, marks);
    if (size !== null) {
      const [u, v] = [0, 1].map(k => spots.reduce((sum, spot) => sum + spot[k], 0) / spots.length);
      write(`${size.toFixed(2)} m${tool === "area" ? "\u00b2" : ""}`, u + 8, v - 8, true);
    }
  }

  function bar(pane) {  // a length of 1, 2 or 5 times a power of ten, a quarter of the pane at most
    const most = pane.w / 4 / view.scale, ten = 10 ** Math.floor(Math.log10(most));
    const metres = [5, 2, 1].map(k => k * ten).find(m => m <= most), x = pane.x + 10, y = pane.y + pane.h - 10;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + metres * view.scale, y);
    pen.strokeStyle = ink.map;
    pen.lineWidth = 3;
    pen.lineCap = "butt";
    pen.stroke();
    write(`${Number(metres.toPrecision(1))} m`, x, y - 6);
  }

  function write(text, x, y, bold) {
    pen.font = `${bold ? "600 " : ""}13px sans-serif`;
    pen.lineWidth = 4;
    pen.strokeStyle = ink.ground;
    pen.lineJoin = "round";
    pen.strokeText(text, x, y);
    pen.fillStyle = ink.map;
    pen.fillText(text, x, y);
  }

  function draw() {
    asked = false;
    const fine = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * fine);
    canvas.height = Math.round(height * fine);
    Object.assign(canvas.style, { width: `${width}px`, height: `${height}px` });
    ink = isDark() ? DARK : LIGHT;
    where.style.color = ink.map;
    pen.setTransform(fine, 0, 0, fine, 0, 0);
    pen.fillStyle = ink.ground;
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
      const on = model.get("layers"), growing = model.get("growing");
      if (on.includes("free space")) squares(pane);
      if (on.includes("grid") && (before.length || growing)) grid(pane);
      if (growing || on.includes("points")) dots(pane, growing ? ink.map : ink.raw);
      if (k === 0) stroke(pane, before, ink.map, 1);
      else {
        if (k < 3) stroke(pane, before, ink.raw, 1);
        stroke(pane, results[k - 1], k < 3 ? ink.result : ink.member, 2);
      }
      if (which >= 0 && (k === 0 || k === which + 1)) {
        stroke(pane, before, ink.member, k === 0 ? 2.5 : 1.5, members);
        if (k > 0 && 4 * index < results[which].length) stroke(pane, results[which], ink.chosen, 4, [index]);
      }
      if (growing || on.includes("path") || model.get("looked_at").length) path(pane);
      if (growing && way.length) robot(pane);
      if (on.includes("loops")) stroke(pane, loops, ink.chosen, 1.5);
      marked(pane);
      write(titles[k] || "", pane.x + 8, pane.y + 16, true);
      if (before.length || growing) bar(pane);
      else write("Run draws the map here", pane.x + pane.w / 2 - 70, pane.y + pane.h / 2);
      pen.restore();
      pen.strokeStyle = ink.lines;
      pen.lineWidth = 1;
      pen.strokeRect(pane.x + 0.5, pane.y + 0.5, pane.w - 1, pane.h - 1);
    });
    canvas.dataset.tool = model.get("tool");
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
    if (!segments || k > 2) return best;
    for (let i = 0; i < segments.length; i += 4) {
      const [ax, ay, bx, by] = segments.subarray(i, i + 4), spot = foot([ax, ay, bx - ax, by - ay], x, y);
      const off = Math.hypot(x - spot.x, y - spot.y);
      if (off < least) [best, least] = [[k - 1, i / 4], off];
    }
    return best;
  }

  function mark(k, x, y) {  // one more place that is measured from
    const tool = model.get("tool"), parts = k > 0 && results[k - 1].length ? results[k - 1] : before;
    if (tool === "distance" && marks.length > 1) marks = [];
    marks.push(snapped(parts, x, y, NEAR / view.scale));
    const size = measured(tool, marks);
    if (size !== null) model.send({ measured: tool, size });
    ask();
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

  let pinned = false, waiting = null, focused = false;
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
    focused = document.activeElement === canvas;
    if (model.get("drawing")) corners = [at(event), at(event)].map(({ x, y }) => [x, y]);
    canvas.setPointerCapture(event.pointerId);
    canvas.style.cursor = "grabbing";
  });
  canvas.addEventListener("pointermove", event => {
    const here = at(event), middle = model.get("middle");
    where.textContent = before.length ? `x ${(here.x + middle[0]).toFixed(2)}, y ${(here.y + middle[1]).toFixed(2)} m` : "";
    if (!dragged) {
      clearTimeout(waiting);
      if (!pinned) waiting = setTimeout(() => point(nearest(event)), 60);
      return;
    }
    const dx = event.clientX - dragged.x, dy = event.clientY - dragged.y;
    dragged = { x: event.clientX, y: event.clientY, far: dragged.far + Math.abs(dx) + Math.abs(dy) };
    if (corners) {
      corners[1] = [here.x, here.y];
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
    } else if (dragged && dragged.far < 4 && model.get("tool") !== "look") {
      const { k, x, y } = at(event);
      mark(k, x, y);
    } else if (dragged && dragged.far < 4) {
      const found = nearest(event), row = model.get("looked_at").length ? scan(event) : -1;
      if (row >= 0) model.send({ scan: row });
      else if (found[0] >= 0 || focused) {  // else the click was for the keys
        pinned = found[0] >= 0;
        point(found);
      }
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
    else if (event.key === "Enter" && model.get("tool") !== "look") mark(panes[0].map, view.x, view.y);
    else if (event.key === "Escape") { marks = []; ask(); }
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
  model.on("change:before change:first change:second change:other change:titles", changed);
  model.on("change:size change:middle", () => { marks = []; model.get("growing") && moved ? changed() : another(); });
  model.on("change:shown change:growing", another);
  model.on("change:pointed change:members change:summary change:layers change:looked_at", ask);
  model.on("change:way change:sure change:loops change:points change:free", () => { load(); ask(); });
  model.on("change:tool", () => { marks = []; ask(); });
  canvas.addEventListener("focus", ask);
  canvas.addEventListener("blur", ask);
  model.on("msg:custom", (content, buffers) => {  // a file to keep
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob(buffers));
    link.download = content.name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  });
  const watch = new ResizeObserver(() => {
    if (!el.clientWidth || (el.clientWidth === width && el.clientHeight === height)) return;
    const before = panes[0].w;
    lay();
    if (moved) view.scale *= panes[0].w / before;
    else fit();
    ask();
  });
  watch.observe(el);
  const press = () => {  // a toggle tells what it is by its colour only, a part by its place
    for (const button of document.querySelectorAll(TOGGLES))
      button.setAttribute("aria-pressed", button.classList.contains("mod-active"));
    for (const [name, words] of Object.entries(PARTS)) {
      const part = document.querySelector(`.segmap-${name}`);
      part?.setAttribute("role", "region");
      part?.setAttribute("aria-label", words);
    }
    for (const part of document.querySelectorAll(".noUi-handle, .widget-readout")) {  // of a slider
      const row = part.closest(".jupyter-widgets"), name = row && row.querySelector(".widget-label");
      if (name) part.setAttribute("aria-label", name.textContent);
      if (part.isContentEditable) part.setAttribute("role", "textbox");
    }
  };
  const presses = new MutationObserver(press);
  presses.observe(document.body,
    { subtree: true, childList: true, attributes: true, attributeFilter: ["class"] });
  const clicked = event => {  // a button within a text: it copies what stands above it, or shows a run
    const button = event.target.closest(".segmap-copy, .segmap-run");
    if (!button) return;
    const { run, way } = button.dataset;
    if (run) model.send({ run: Number(run), beside: way === "beside" });
    else navigator.clipboard.writeText(button.previousElementSibling.textContent);
  };
  model.on("change:unsaved", () => { window.segmapUnsaved = model.get("unsaved"); });  // see _app.py
  document.addEventListener("click", clicked);
  press();
  another();
  return () => {
    watch.disconnect();
    presses.disconnect();
    document.removeEventListener("click", clicked);
    clearTimeout(waiting);
  };
}

export default { render };
