// What is measured on a map: places that snap to ends, corners and walls. All in metres.
const PARALLEL = 0.17, MANY = 24;  // sine of ten degrees; so many walls may meet at a place

function cross(ax, ay, bx, by) { return ax * by - ay * bx; }

function foot(wall, x, y, beyond) {  // of a place on a wall, or on its line
  const [ax, ay, dx, dy] = wall, t = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1);
  const s = beyond ? t : Math.min(1, Math.max(0, t));
  return { x: ax + s * dx, y: ay + s * dy };
}

function snapped(segments, x, y, reach) {  // {x, y, wall}: an end or a corner before a wall
  const walls = [], points = [], far = p => Math.hypot(p.x - x, p.y - y);
  for (let i = 0; i < segments.length && walls.length < MANY; i += 4) {
    const wall = [segments[i], segments[i + 1], segments[i + 2] - segments[i], segments[i + 3] - segments[i + 1]];
    if (far(foot(wall, x, y)) > reach) continue;
    for (const [ax, ay, dx, dy] of walls) {  // corners with those before
      const turn = cross(dx, dy, wall[2], wall[3]);
      if (Math.abs(turn) < PARALLEL * Math.hypot(dx, dy) * Math.hypot(wall[2], wall[3])) continue;
      const t = cross(wall[0] - ax, wall[1] - ay, wall[2], wall[3]) / turn;
      points.push({ x: ax + t * dx, y: ay + t * dy });
    }
    walls.push(wall);
    points.push({ x: wall[0], y: wall[1] }, { x: wall[0] + wall[2], y: wall[1] + wall[3] });
  }
  const feet = walls.map(wall => ({ ...foot(wall, x, y), wall }));
  for (const found of [points.filter(p => far(p) <= reach), feet])
    if (found.length) return found.reduce((a, b) => far(b) < far(a) ? b : a);
  return { x, y };
}

function measured(tool, marks) {  // of two places, wall to wall square; or of a polygon
  if (tool === "distance" && marks.length === 2) {
    const [a, b] = marks, one = a.wall, two = b.wall;
    if (one && two && Math.abs(cross(one[2], one[3], two[2], two[3]))
        < PARALLEL * Math.hypot(one[2], one[3]) * Math.hypot(two[2], two[3]))
      marks[1] = { ...foot(two, a.x, a.y, true), wall: two };
    return Math.hypot(marks[1].x - a.x, marks[1].y - a.y);
  }
  if (tool !== "area" || marks.length < 3) return null;
  return Math.abs(marks.reduce((sum, p, k) => {
    const q = marks[(k + 1) % marks.length];
    return sum + cross(p.x, p.y, q.x, q.y) / 2;
  }, 0));
}
