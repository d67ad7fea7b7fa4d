// The strip of Fusion over a few segments: what lies in it, and the chain through the longest.

const SAME = 1e-9; // metres

/** Shift, members and total length of the chain that the strip holds at a shift. */
function chainAt(u, v, lengths, first, shift, tolerance) {
  const half = tolerance + SAME;
  const inside = v.flatMap(([low, high], i) => (high - half <= shift && shift <= low + half ? [i] : []));
  const members = new Set([first]);
  for (const k of members)
    for (const i of inside)
      if (Math.min(...u[i]) <= Math.max(...u[k]) + SAME && Math.min(...u[k]) <= Math.max(...u[i]) + SAME)
        members.add(i);
  const chain = [...members].sort((a, b) => a - b);
  return { inside, chain, total: chain.reduce((sum, i) => sum + lengths[i], 0) };
}

/** What Fusion makes of the longest segment at this shift, and the greatest total of all shifts. */
export function measure({ segments, shift, tolerance }) {
  const lengths = segments.map(([a, b, c, d]) => Math.hypot(c - a, d - b));
  const longest = Math.max(...lengths) - SAME, first = lengths.findIndex((size) => size >= longest);
  const [a, b, c, d] = segments[first], x = (a + c) / 2, y = (b + d) / 2;
  const dx = (c - a) / lengths[first], dy = (d - b) / lengths[first];
  const ends = segments.map(([p, q, r, s]) => [[p - x, q - y], [r - x, s - y]]);
  const u = ends.map((two) => two.map(([p, q]) => p * dx + q * dy));
  const v = ends.map((two) => two.map(([p, q]) => q * dx - p * dy).sort((one, other) => one - other));
  const { inside, chain, total } = chainAt(u, v, lengths, first, shift, tolerance);
  const reach = chain.flatMap((i) => u[i]), at = (w, t) => [x - t * dy + w * dx, y + t * dx + w * dy];
  const span = (low, high, t) => [...at(low, t), ...at(high, t)];
  const wall = span(Math.min(...reach), Math.max(...reach), shift);
  const borders = v.flatMap(([low, high]) => [high - tolerance, low + tolerance]);
  const shifts = [0, ...borders.filter((t) => Math.abs(t) <= tolerance + SAME)];
  const most = Math.max(...shifts.map((t) => chainAt(u, v, lengths, first, t, tolerance).total));
  return { first, inside, chain, total, wall, most, across: [-dy, dx], middle: [x, y], span };
}

const HIGHER = 10; // times as high as wide, since a strip is thin

function render({ model, el }) {
  const names = ["segments", "shift", "tolerance"];
  const state = () => Object.fromEntries(names.map((name) => [name, model.get(name)]));
  const start = structuredClone(state());
  const [left, low, right, top] = model.get("view");
  const drawn = (pairs) => pairs.map(([a, b, c, d]) => [a, HIGHER * b, c, HIGHER * d]);
  const plane = addDrawing(el, [left, HIGHER * low, right, HIGHER * top], "A strip over segments of a wall");
  const strip = addPart(plane, "path", { fill: GREY, "fill-opacity": 0.35 });
  const result = addPath(plane, BLUE, 0.1);
  const others = addPath(plane, ORANGE, 0.035), members = addPath(plane, BLACK, 0.035);
  result.setAttribute("stroke-opacity", 0.5);
  const set = (values) => { for (const name in values) model.set(name, values[name]); model.save_changes(); };
  const middleOf = ([a, b, c, d]) => [(a + c) / 2, (HIGHER * (b + d)) / 2];
  /** How far a point of the drawing lies across the line of the longest, metres. */
  const offset = ([px, py]) => {
    const { middle: [x, y], across: [nx, ny] } = measure(state());
    return (px - x) * nx + (py / HIGHER - y) * ny;
  };
  const stripAt = (share, away) => () => {
    const { shift, tolerance } = state(), { span } = measure(state());
    const [a, b] = span(left + share * (right - left) - measure(state()).middle[0], 0, shift + away * tolerance);
    return [a, HIGHER * b];
  };
  const handles = [
    {
      name: "the strip", fill: BLUE, at: stripAt(0.03, 0),
      to: (place) => {
        const { tolerance } = state();
        set({ shift: Math.max(-tolerance, Math.min(tolerance, offset(place))) });
      },
    },
    {
      name: "its border", at: stripAt(0.97, 1),
      to: (place) => {
        const tolerance = Math.max(0.005, Math.min(0.1, offset(place) - state().shift));
        set({ tolerance, shift: Math.max(-tolerance, Math.min(tolerance, state().shift)) });
      },
    },
    ...start.segments.map((_, i) => ({
      name: `segment ${i + 1}`, at: () => middleOf(state().segments[i]),
      to: ([px, py]) => {
        const { segments } = state(), [x, y] = middleOf(segments[i]), by = [px - x, (py - y) / HIGHER];
        set({ segments: segments.map((s, k) => (k === i ? s.map((value, n) => value + by[n % 2]) : s)) });
      },
    })),
  ];
  const place = addHandles(plane, handles, { radius: 0.07, reach: 0.2 });
  const text = addControls(el, { "back to the start": () => set(start) });
  const draw = () => {
    const now = state(), { inside, chain, total, wall, most, middle, span } = measure(now);
    const [one, other] = [-1, 1].map((side) =>
      drawn([span(left - middle[0] - 9, right - middle[0] + 9, now.shift + side * now.tolerance)])[0]);
    strip.setAttribute("d", `M${one[0]} ${one[1]}L${one[2]} ${one[3]}L${other[2]} ${other[3]}L${other[0]} ${other[1]}Z`);
    members.setAttribute("d", lines(drawn(chain.map((i) => now.segments[i]))));
    others.setAttribute("d", lines(drawn(now.segments.filter((_, i) => !chain.includes(i)))));
    result.setAttribute("d", lines(drawn([wall])));
    place();
    text.textContent = `chain of ${total.toFixed(2)} m; the best shift has ${most.toFixed(2)} m; `
      + `shift ${(1000 * now.shift).toFixed(0)} mm, tolerance ${(1000 * now.tolerance).toFixed(0)} mm; `
      + `${inside.length} of ${now.segments.length} segments in the strip, ${chain.length} in the chain`;
  };
  for (const name of names) model.on(`change:${name}`, draw);
  draw();
}

export default { render };
