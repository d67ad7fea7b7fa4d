// Points that are dragged, and two lines through them: by distances, and by vertical distances.

/** Mean of the points, and the directions of both lines, radians. */
export function measure({ points }) {
  const centre = [0, 1].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);
  const off = points.map(([x, y]) => [x - centre[0], y - centre[1]]);
  const sum = (i, k) => off.reduce((total, d) => total + d[i] * d[k], 0);
  const [xx, xy, yy] = [sum(0, 0), sum(0, 1), sum(1, 1)];
  return { centre, total: Math.atan2(2 * xy, xx - yy) / 2, vertical: Math.atan2(xy, xx) };
}

/** The points, turned about their mean. */
function turned(points, angle) {
  const { centre: [x, y] } = measure({ points }), [c, s] = [Math.cos(angle), Math.sin(angle)];
  return points.map(([px, py]) => [x + c * (px - x) - s * (py - y), y + s * (px - x) + c * (py - y)]);
}

function render({ model, el }) {
  const start = model.get("points").map((point) => [...point]);
  const [left, low, right, top] = model.get("view"), width = (right - left) / 300;
  const plane = addDrawing(el, [left, low, right, top], "Points that can be dragged, and two lines through them");
  const away = [BLUE, ORANGE].map((color) => addPath(plane, color, width / 2));
  const line = [BLUE, ORANGE].map((color) => addPath(plane, color, 2 * width));
  const set = (points) => { model.set("points", points); model.save_changes(); };
  const place = addHandles(plane, start.map((_, k) => ({
    name: `point ${k + 1}`,
    at: () => model.get("points")[k],
    to: (point) => set(model.get("points").map((old, i) => (i === k ? point : old))),
  })), { radius: 4 * width, reach: 15 * width });
  const text = addControls(el, {
    "turn all points by 15 degrees": () => set(turned(model.get("points"), Math.PI / 12)),
    "back to the start": () => set(start.map((point) => [...point])),
  });
  const draw = () => {
    const points = model.get("points"), now = measure({ points }), [x, y] = now.centre, far = right - left;
    const [dx, dy] = [Math.cos(now.total), Math.sin(now.total)], slope = Math.tan(now.vertical);
    const across = points.map(([px, py]) => {
      const off = (py - y) * dx - (px - x) * dy;
      return [px, py, px + off * dy, py - off * dx];
    });
    away[0].setAttribute("d", lines(across));
    away[1].setAttribute("d", lines(points.map(([px, py]) => [px, py, px, y + slope * (px - x)])));
    [now.total, now.vertical].forEach((angle, k) => {
      const [ex, ey] = [far * Math.cos(angle), far * Math.sin(angle)];
      line[k].setAttribute("d", lines([[x - ex, y - ey, x + ex, y + ey]]));
    });
    place();
    const words = [now.total, now.vertical].map((angle) => `${((angle * 180) / Math.PI).toFixed(1)} degrees`);
    text.textContent = `${words[0]} by distances to the line (blue), ${words[1]} by vertical distances (orange)`;
  };
  model.on("change:points", draw);
  draw();
}

export default { render };
