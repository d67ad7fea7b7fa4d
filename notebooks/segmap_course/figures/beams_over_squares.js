// A robot, the ends of its beams, and the squares of a quadtree that its beams cross.

/** Cells of a ray, both ends included (Bresenham). */
function rayCells([x0, y0], [x1, y1]) {
  if (Math.abs(y1 - y0) > Math.abs(x1 - x0)) return rayCells([y0, x0], [y1, x1]).map(([y, x]) => [x, y]);
  if (x1 < x0) return rayCells([x1, y1], [x0, y0]);
  const dx = x1 - x0, dy = Math.abs(y1 - y0), cells = [];
  let error = -Math.floor(dx / 2), y = y0;
  for (let x = x0; x <= x1; x++) {
    cells.push([x, y]);
    error += dy;
    if (error > 0) {
      y += y1 > y0 ? 1 : -1;
      error -= dx;
    }
  }
  return cells;
}

const holds = ([left, low, side], [x, y]) => left <= x && x < left + side && low <= y && y < low + side;

/** Leaves, cut where beams end, as [column, row, side, rays that crossed, ends]; and beams through cells of other ends. */
export function measure({ robot, ends, cells, resolution }) {
  const whole = (place) => place.map((x) => Math.min(cells - 1, Math.max(0, Math.floor(x / resolution))));
  const start = whole(robot), last = ends.map(whole), leaves = [];
  const add = (square, root) => {
    const [left, low, side] = square, half = side / 2;
    if (!root && (side === 1 || !last.some((end) => holds(square, end))))
      return leaves.push([...square, 0, last.filter((end) => holds(square, end)).length]);
    for (const x of [left, left + half]) for (const y of [low, low + half]) add([x, y, half], false);
  };
  add([0, 0, cells], true);
  for (const end of last) {
    const away = ([x, y]) => Math.max(Math.abs(x - end[0]), Math.abs(y - end[1])) > 1;
    const crossed = rayCells(start, end).filter(away);
    for (const leaf of leaves) leaf[3] += crossed.some((cell) => holds(leaf, cell));
  }
  leaves.sort((a, b) => a[0] - b[0] || a[1] - b[1] || a[2] - b[2]);
  const through = leaves.reduce((sum, [, , , rays, hits]) => sum + (hits ? rays : 0), 0);
  return { leaves, crossed: leaves.filter((leaf) => leaf[3]).length, through };
}

function render({ model, el }) {
  const names = ["robot", "ends", "cells", "resolution"];
  const state = () => Object.fromEntries(names.map((name) => [name, model.get(name)]));
  const begin = structuredClone(state()), side = begin.cells * begin.resolution;
  const plane = addDrawing(el, [0, 0, side, side], "A robot, its beams, and the squares that they cross");
  const [unknown, free, hit] = [GREY, "#fff", BLACK].map((fill) =>
    addPart(plane, "path", { fill, stroke: BLUE, "stroke-width": side / 500 }));
  const beams = addPath(plane, ORANGE, side / 300);
  const set = (values) => { for (const name in values) model.set(name, values[name]); model.save_changes(); };
  const within = (place) => place.map((x) => Math.min(side, Math.max(0, x)));
  const place = addHandles(plane, [
    { name: "the robot", fill: ORANGE, at: () => state().robot, to: (to) => set({ robot: within(to) }) },
    ...begin.ends.map((_, i) => ({
      name: `the end of beam ${i + 1}`, at: () => state().ends[i],
      to: (to) => set({ ends: state().ends.map((end, k) => (k === i ? within(to) : end)) }),
    })),
  ], { radius: side / 70, reach: side / 12, anywhere: true });
  const text = addControls(el, { "back to the start": () => set(begin) });
  const draw = () => {
    const now = state(), { leaves, crossed, through } = measure(now);
    const squares = (chosen) => leaves.filter(chosen).map(([x, y, size]) => {
      const [a, b, c] = [x, y, size].map((value) => value * now.resolution);
      return `M${a} ${b}h${c}v${c}h${-c}Z`;
    }).join("");
    unknown.setAttribute("d", squares(([, , , rays, hits]) => !rays && !hits));
    free.setAttribute("d", squares(([, , , rays, hits]) => rays && !hits));
    hit.setAttribute("d", squares(([, , , , hits]) => hits));
    beams.setAttribute("d", lines(now.ends.map((end) => [...now.robot, ...end])));
    place();
    text.textContent = `${crossed} of ${leaves.length} leaves are crossed; `
      + `${through} times a beam crosses a cell in which another ended`;
  };
  for (const name of names) model.on(`change:${name}`, draw);
  draw();
}

export default { render };
