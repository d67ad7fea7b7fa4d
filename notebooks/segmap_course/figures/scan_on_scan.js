// A scan on a scan: the second is dragged and turned, and each of its points pulls to its partner.

/** Points of the scan at its pose, pulls from each that has a partner, and their mean length. */
export function measure({ reference, across, scan, pose, reach, to_walls }) {
  const [x, y, turn] = pose, cos = Math.cos(turn), sin = Math.sin(turn);
  const points = scan.map(([u, v]) => [x + cos * u - sin * v, y + sin * u + cos * v]);
  const pulls = [];
  let sum = 0;
  for (const [px, py] of points) {
    let distance = reach, k = -1;
    for (let i = 0; i < reference.length; i++) {
      const d = Math.hypot(reference[i][0] - px, reference[i][1] - py);
      if (d < distance) [distance, k] = [d, i];
    }
    if (k < 0 || across[k] === null) continue;
    const [qx, qy] = reference[k], nx = Math.cos(across[k]), ny = Math.sin(across[k]);
    const r = nx * (px - qx) + ny * (py - qy);
    pulls.push(to_walls ? [px, py, px - r * nx, py - r * ny] : [px, py, qx, qy]);
    sum += to_walls ? Math.abs(r) : distance;
  }
  return { points, pulls, mean: pulls.length ? sum / pulls.length : NaN };
}

const ARM = 0.7; // metres from the robot to the handle that turns it

function render({ model, el }) {
  const names = ["reference", "across", "scan", "pose", "reach", "to_walls"];
  const state = () => Object.fromEntries(names.map((name) => [name, model.get(name)]));
  const start = [...model.get("pose")];
  const plane = addDrawing(el, model.get("view"), "Two laser scans, one on the other");
  addPath(plane, GREY, 0.05).setAttribute("d", dots(model.get("reference")));
  const residuals = addPath(plane, ORANGE, 0.018), points = addPath(plane, BLUE, 0.04);
  const arm = addPath(plane, BLUE, 0.025);
  const tip = ([x, y, turn]) => [x + ARM * Math.cos(turn), y + ARM * Math.sin(turn)];
  const move = (pose) => { model.set("pose", pose); model.save_changes(); };
  const robot = {
    name: "the robot at the second scan", fill: BLUE, at: () => model.get("pose").slice(0, 2),
    to: ([x, y]) => move([x, y, model.get("pose")[2]]),
  };
  const heading = {
    name: "its heading", at: () => tip(model.get("pose")),
    to: ([u, v]) => { const [x, y] = model.get("pose"); move([x, y, Math.atan2(v - y, u - x)]); },
  };
  const place = addHandles(plane, [robot, heading], { anywhere: true });
  const text = addControls(el, {
    "back to the start": () => move([...start]),
    "to walls or to points": () => { model.set("to_walls", !model.get("to_walls")); model.save_changes(); },
  });
  const draw = () => {
    const now = state(), { points: all, pulls, mean } = measure(now);
    residuals.setAttribute("d", lines(pulls));
    points.setAttribute("d", dots(all));
    arm.setAttribute("d", lines([[...now.pose.slice(0, 2), ...tip(now.pose)]]));
    place();
    text.textContent = `mean residual ${(100 * mean).toFixed(1)} cm to the ${now.to_walls ? "walls" : "points"}; `
      + `${pulls.length} of ${all.length} points have a partner`;
  };
  model.on("change:pose", draw);
  model.on("change:to_walls", draw);
  draw();
}

export default { render };
