// Two walls: their ends are dragged, and the measure D tells how far apart they are.

const ANGULAR = 0.66, ACROSS = 0.09, APART = 0.25; // what the three terms count
const PERPENDICULAR = 1e-9; // radians

const length = ([[ax, ay], [bx, by]]) => Math.hypot(bx - ax, by - ay);
const angle = ([[ax, ay], [bx, by]]) => Math.atan2(by - ay, bx - ax);

/** From b to a for lines without direction, in [-pi/2, pi/2). */
function axial(a, b) {
  const turn = (a - b + Math.PI / 2) % Math.PI;
  return (turn < 0 ? turn + Math.PI : turn) - Math.PI / 2;
}

/** The point of a segment that is nearest to p. */
function foot([px, py], [[ax, ay], [bx, by]]) {
  const [dx, dy] = [bx - ax, by - ay], square = dx * dx + dy * dy;
  const t = square > 0 ? Math.min(1, Math.max(0, ((px - ax) * dx + (py - ay) * dy) / square)) : 0;
  return [ax + t * dx, ay + t * dy];
}

/** The line midway in one direction: its terms *turned* and *shifted*, and where the latter is. */
function midway(u, v, direction) {
  const [dx, dy] = [Math.cos(direction), Math.sin(direction)], ends = [...u, ...v];
  const middle = [0, 1].map((k) => ends.reduce((sum, end) => sum + end[k], 0) / 4);
  const off = ends.map(([x, y]) => (y - middle[1]) * dx - (x - middle[0]) * dy);
  const worst = off.reduce((best, o, k) => (Math.abs(o) > Math.abs(off[best]) ? k : best), 0);
  const [x, y] = ends[worst], shift = [x, y, x + off[worst] * dy, y - off[worst] * dx];
  const turned = [u, v].reduce((sum, s) => sum + length(s) * Math.tan(Math.abs(axial(angle(s), direction))) / 2, 0);
  const shifted = Math.abs(off[worst]);
  return { middle, direction, turned, shifted, shift, cost: ANGULAR * turned + ACROSS * shifted };
}

/** The three terms and D of two walls, given by their four ends, metres. */
export function measure({ ends }) {
  const u = ends.slice(0, 2), v = ends.slice(2, 4), turn = axial(angle(v), angle(u));
  const both = Math.PI / 2 - Math.abs(turn) <= PERPENDICULAR ? [Math.PI / 4, -Math.PI / 4] : [turn / 2];
  const lines = both.map((half) => midway(u, v, angle(u) + half));
  const line = lines.reduce((best, other) => (other.cost < best.cost ? other : best));
  const gaps = [...u.map((p) => [p, v]), ...v.map((p) => [p, u])].map(([p, s]) => [...p, ...foot(p, s)]);
  const size = ([x, y, fx, fy]) => Math.hypot(x - fx, y - fy);
  const gap = gaps.reduce((best, other) => (size(other) < size(best) ? other : best));
  return { ...line, gap, apart: size(gap), distance: line.cost + APART * size(gap) };
}

function render({ model, el }) {
  const start = model.get("ends").map((end) => [...end]);
  const plane = addDrawing(el, model.get("view"), "Two walls whose ends can be dragged");
  const middle = addPath(plane, GREY, 0.015), orange = addPath(plane, ORANGE, 0.03);
  const walls = [addPath(plane, BLACK, 0.05), addPath(plane, BLUE, 0.05)];
  const move = (k, end) => {
    model.set("ends", model.get("ends").map((old, i) => (i === k ? end : old)));
    model.save_changes();
  };
  const names = ["first wall, one end", "first wall, other end", "second wall, one end", "second wall, other end"];
  const place = addHandles(plane, names.map((name, k) => ({
    name, at: () => model.get("ends")[k], to: (end) => move(k, end),
  })), { radius: 0.07 });
  const text = addControls(el, {
    "back to the start": () => { model.set("ends", start.map((end) => [...end])); model.save_changes(); },
  });
  const draw = () => {
    const ends = model.get("ends"), now = measure({ ends }), [x, y] = now.middle;
    const [dx, dy] = [9 * Math.cos(now.direction), 9 * Math.sin(now.direction)];
    walls.forEach((wall, k) => wall.setAttribute("d", lines([[...ends[2 * k], ...ends[2 * k + 1]]])));
    middle.setAttribute("d", lines([[x - dx, y - dy, x + dx, y + dy]]));
    orange.setAttribute("d", lines([now.shift, now.gap]));
    place();
    text.textContent = `D = ${ANGULAR} x ${now.turned.toFixed(2)} (turned) + ${ACROSS} x ${now.shifted.toFixed(2)} (shifted)`
      + ` + ${APART} x ${now.apart.toFixed(2)} (apart) = ${now.distance.toFixed(3)} m`;
  };
  model.on("change:ends", draw);
  draw();
}

export default { render };
