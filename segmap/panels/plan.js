// A floor plan that a person mends: rooms, doors and walls by mouse, finger and keyboard.
// Python holds the plan and does the edits; this draws its state and tells what was pointed at.

const TOOLS = {
  Name: "click a room, type its name, press Enter",
  Join: "click two rooms that are one",
  Split: "draw a line across a room, from wall to wall; by keyboard: choose a room, press Enter",
  NewDoor: "draw a door along a wall, from jamb to jamb; by keyboard: choose a wall, press Enter",
  NoDoor: "click a door that is none",
  Wall: "click what is a wall, and no furniture",
  Furniture: "click a wall that is furniture, or the leaf of a door",
};
const LABELS = { NewDoor: "Door", NoDoor: "No door" };
const DRAWN = ["Split", "NewDoor"];
const RUNS = { NewDoor: ["wall"], Wall: ["wall", "clutter"], Furniture: ["wall"] }; // what is chosen
const TEXT_PX = 12, LEAST_TEXT_PX = 7, HIT_PX = 16, RUN_PX = 10, ZOOM = 1.25;
const STEP_M = 0.1, TURN_RAD = Math.PI / 36, DOOR_M = 0.9;
const DIGITS = 3; // places in millimetres

function made(name, attributes, ...children) {
  const svg = /^(svg|g|path|line|text|tspan|title)$/.test(name);
  const node = svg
    ? document.createElementNS("http://www.w3.org/2000/svg", name)
    : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

const ringPath = (rings) =>
  rings.map((ring) => "M" + ring.map(([x, y]) => `${x} ${-y}`).join("L") + "Z").join("");

const sizeOf = ([[ax, ay], [bx, by]]) => Math.hypot(bx - ax, by - ay);
const middleOf = ([[ax, ay], [bx, by]]) => [(ax + bx) / 2, (ay + by) / 2];

// A piece of a run that is so far along it from its middle, and so wide.
function pieceOf(ends, along, width) {
  const [x, y] = middleOf(ends), size = sizeOf(ends);
  const way = [0, 1].map((k) => (ends[1][k] - ends[0][k]) / size);
  return [along - width / 2, along + width / 2].map((off) => [x + off * way[0], y + off * way[1]]);
}

// The piece of a line that lies in a room, on both sides of a place in it: its ends.
function across(rings, [x, y], turn) {
  const [dx, dy] = [Math.cos(turn), Math.sin(turn)];
  let [low, high] = [-Infinity, Infinity];
  for (const ring of rings) {
    ring.forEach(([ax, ay], k) => {
      const [bx, by] = ring[(k + 1) % ring.length];
      const one = (ay - y) * dx - (ax - x) * dy, other = (by - y) * dx - (bx - x) * dy;
      if (one > 0 === other > 0) return;
      const share = one / (one - other);
      const along = (ax + share * (bx - ax) - x) * dx + (ay + share * (by - ay) - y) * dy;
      if (along < 0) low = Math.max(low, along);
      else high = Math.min(high, along);
    });
  }
  return [low, high].map((along) => [x + along * dx, y + along * dy]);
}

function render({ model, el }) {
  el.classList.add("segmap-plan");
  const status = made("div", { role: "status", class: "segmap-plan-status" });
  const entry = made("input", { type: "text", hidden: "", "aria-label": "name of the room" });
  const svg = made("svg", { role: "group", "aria-label": "floor plan", tabindex: -1 });
  const bar = made("div", { class: "segmap-plan-bar", role: "toolbar", "aria-label": "mend the plan" });
  const tools = {}, others = {};
  let tool = "Name", chosen = null, draft = null, view = null, naming = null, pressed = null;

  const send = (kind, ...values) => {
    chosen = draft = null;
    model.send({ edit: [kind, ...values.flat()].join(" ") });
  };
  const rounded = (place) => place.map((value) => Number(value.toFixed(DIGITS)));

  function button(name, label, tip, action) {
    const node = made("button", { type: "button", title: tip }, label);
    node.addEventListener("click", action);
    bar.append(node);
    return node;
  }
  for (const [name, tip] of Object.entries(TOOLS)) {
    tools[name] = button(name, LABELS[name] ?? name, tip, () => take(name));
  }
  others.undo = button("undo", "Undo", "take the last edit back", () => model.send({ undo: true }));
  others.redo = button("redo", "Redo", "do it again", () => model.send({ redo: true }));
  button("in", "+", "nearer (or turn the wheel)", () => zoom(1 / ZOOM));
  button("out", "\u2212", "farther", () => zoom(ZOOM));
  button("all", "All", "see the whole plan", () => { view = null; draw(); });
  bar.append(entry);

  function take(name) {
    [tool, chosen, draft, naming, entry.hidden] = [name, null, null, null, true];
    draw();
    status.textContent = TOOLS[name];
  }

  // ------------------------------------------------------------------ what is seen
  function shape() {
    if (!view) {
      const [left, low, right, high] = model.get("state").bounds;
      view = [left, -high, right - left, high - low];
    }
    svg.setAttribute("viewBox", view.join(" "));
    const box = svg.getBoundingClientRect();
    return Math.max(view[2] / (box.width || 800), view[3] / (box.height || 500)); // metres a pixel
  }

  function zoom(by, at = [view[0] + view[2] / 2, view[1] + view[3] / 2]) {
    view = [at[0] + (view[0] - at[0]) * by, at[1] + (view[1] - at[1]) * by, view[2] * by, view[3] * by];
    draw();
  }

  function placeOf(event) {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    return [at.x, -at.y];
  }

  function labelled(room, metres) {
    const lines = [room.name, `${room.area.toFixed(1)} m\u00b2`];
    const longest = Math.max(...lines.map((line) => line.length));
    const size = Math.min(TEXT_PX * metres, (2 * room.clear) / Math.max(2.4, 0.6 * longest));
    if (size < LEAST_TEXT_PX * metres) return [];
    const [x, y] = room.place;
    return [made("text", { x, y: -y, "font-size": size, "aria-hidden": true },
      ...lines.map((line, k) => made("tspan", { x, dy: k ? size * 1.15 : -size * 0.2 }, line)))];
  }

  function lineOf([[ax, ay], [bx, by]], attributes) {
    return made("line", { x1: ax, y1: -ay, x2: bx, y2: -by, ...attributes });
  }

  function element(node, words, action) {
    for (const [key, value] of [["tabindex", 0], ["role", "button"], ["aria-label", words]]) {
      node.setAttribute(key, value);
    }
    node.prepend(made("title", {}, words));
    node.addEventListener("click", action);
    node.addEventListener("keydown", (event) => {
      if (event.key === "Enter" || event.key === " ") {
        event.preventDefault();
        action(event);
      }
    });
    return node;
  }

  function draw() {
    const state = model.get("state"), metres = shape();
    const focused = svg.contains(document.activeElement) && document.activeElement.dataset.key;
    for (const [name, node] of Object.entries(tools)) node.setAttribute("aria-pressed", name === tool);
    [others.undo.disabled, others.redo.disabled] = [!state.undo, !state.redo];
    svg.dataset.tool = tool;
    const rooms = state.rooms.map((room, k) => {
      const words = `${room.name}, ${room.area.toFixed(1)} square metres`;
      const node = made("path", { d: ringPath(room.rings), class: "room", "data-key": `${room.place}` });
      if (chosen === k) node.classList.add("chosen");
      return element(node, words, (event) => roomChosen(k, event));
    });
    const runs = ["clutter", "wall"].flatMap((kind) => state[kind].map((ends) => {
      if (!RUNS[tool]?.includes(kind)) return lineOf(ends, { class: kind });
      const node = made("g", { class: "run", "data-key": `${ends}` },
        lineOf(ends, { class: "hit", "stroke-width": RUN_PX * metres }), lineOf(ends, { class: kind }));
      return element(node, `${kind}, ${sizeOf(ends).toFixed(2)} metres`, (event) => runChosen(ends, event));
    }));
    const doors = state.doors.map((ends) => {
      const words = `door, ${sizeOf(ends).toFixed(2)} metres`;
      const node = made("g", { class: "door", "data-key": `${ends}` },
        lineOf(ends, { class: "hit", "stroke-width": HIT_PX * metres }), lineOf(ends, { class: "leaf" }));
      return element(node, words, () => tool === "NoDoor" && send("NoDoor", rounded(middleOf(ends))));
    });
    const texts = state.rooms.flatMap((room) => labelled(room, metres));
    const cut = draft ? [lineOf(draft.ends, { class: "cut" })] : [];
    svg.replaceChildren(...rooms, ...runs, ...doors, ...texts, ...cut);
    if (focused) (svg.querySelector(`[data-key="${focused}"]`) ?? svg).focus(); // what was mended may be gone
  }

  // ------------------------------------------------------------------ what is done
  function roomChosen(k, event) {
    const room = model.get("state").rooms[k];
    if (tool === "Name") {
      [naming, entry.hidden, entry.value] = [k, false, room.name];
      entry.select();
      entry.focus();
    } else if (tool === "Join" && chosen !== null && chosen !== k) {
      send("Join", rounded(model.get("state").rooms[chosen].place), rounded(room.place));
    } else if (tool === "Join") {
      chosen = k;
      status.textContent = `${room.name} and which other room?`;
    } else if (tool === "Split" && event.type === "keydown") {
      if (draft?.room === k) return send("Split", ...draft.ends.map(rounded));
      const turn = model.get("state").axis;
      draft = { room: k, at: [...room.place], turn, ends: across(room.rings, room.place, turn) };
      status.textContent = "arrow keys move and turn the line, Enter cuts, Escape leaves it";
    }
    draw();
  }

  function runChosen(run, event) {
    if (tool !== "NewDoor") return send(tool, rounded(middleOf(run)));
    if (event.type !== "keydown") return;
    if (draft?.run === run) return send(tool, ...draft.ends.map(rounded));
    draft = { run, along: 0, width: DOOR_M, ends: pieceOf(run, 0, DOOR_M) };
    status.textContent = "arrow keys left and right move it, up and down change its width, Enter sets it";
    draw();
  }

  entry.addEventListener("keydown", (event) => {
    event.stopPropagation(); // else Lab takes letters for commands
    if (event.key === "Enter" && naming !== null && entry.value.trim()) {
      send("Name", rounded(model.get("state").rooms[naming].place), entry.value.trim());
    }
    if (event.key === "Enter" || event.key === "Escape") {
      const node = svg.querySelector(`[data-key="${model.get("state").rooms[naming]?.place}"]`);
      [naming, entry.hidden] = [null, true];
      node?.focus();
    }
  });

  svg.addEventListener("keydown", (event) => {
    event.stopPropagation();
    if (event.key === "Escape") [chosen, draft] = [null, null];
    else if ((draft?.run || draft?.room !== undefined) && event.key.startsWith("Arrow")) {
      event.preventDefault();
      const way = { ArrowLeft: 1, ArrowRight: -1, ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (draft.run) {
        if (event.key === "ArrowLeft" || event.key === "ArrowRight") draft.along -= way * STEP_M;
        else draft.width = Math.max(STEP_M, draft.width + way * STEP_M);
      } else if (event.key === "ArrowLeft" || event.key === "ArrowRight") draft.turn += way * TURN_RAD;
      else {
        draft.at[0] -= way * STEP_M * Math.sin(draft.turn);
        draft.at[1] += way * STEP_M * Math.cos(draft.turn);
      }
      draft.ends = draft.run ? pieceOf(draft.run, draft.along, draft.width)
        : across(model.get("state").rooms[draft.room].rings, draft.at, draft.turn);
      if (draft.run) status.textContent = `${draft.width.toFixed(2)} m`;
    } else return;
    draw();
  });

  svg.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    pressed = { at: placeOf(event), pixel: [event.clientX, event.clientY], view: [...view], moved: false };
    if (DRAWN.includes(tool)) svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", (event) => {
    if (draft?.from && !pressed) {
      draft.ends = [draft.from, placeOf(event)];
      draw();
    }
    if (!pressed) return;
    const off = [event.clientX - pressed.pixel[0], event.clientY - pressed.pixel[1]];
    if (!pressed.moved && Math.hypot(...off) < 4) return;
    pressed.moved = true;
    if (DRAWN.includes(tool)) {
      draft = { ends: [pressed.at, placeOf(event)] };
      status.textContent = `${sizeOf(draft.ends).toFixed(2)} m`;
    } else {
      const metres = shape();
      view = [pressed.view[0] - off[0] * metres, pressed.view[1] - off[1] * metres, view[2], view[3]];
    }
    draw();
  });
  const lifted = () => { // a line is dragged, or its two ends are clicked
    if (pressed && DRAWN.includes(tool)) {
      if (pressed.moved) send(tool, ...draft.ends.map(rounded));
      else if (draft?.from) send(tool, rounded(draft.from), rounded(pressed.at));
      else {
        draft = { from: pressed.at, ends: [pressed.at, pressed.at] };
        status.textContent = "and the other end?";
      }
    }
    pressed = null;
  };
  svg.addEventListener("pointerup", lifted);
  svg.addEventListener("pointercancel", () => { pressed = draft = null; draw(); });
  svg.addEventListener("wheel", (event) => {
    event.preventDefault();
    const [x, y] = placeOf(event);
    zoom(event.deltaY > 0 ? ZOOM : 1 / ZOOM, [x, -y]);
  }, { passive: false });

  const redrawn = () => {
    draw();
    status.textContent = model.get("state").words;
    svg.setAttribute("aria-label", `floor plan: ${status.textContent}`);
  };
  model.on("change:state", redrawn);
  const sized = new ResizeObserver(() => draw());
  el.replaceChildren(bar, svg, status);
  sized.observe(svg);
  redrawn();
  return () => {
    sized.disconnect();
    model.off("change:state", redrawn);
  };
}

export default { render };
