// A wardrobe on its way round the corner of two corridors, and what is left beside the inner corner.

const TURNS = 901; // from along the first corridor to along the second

/** What is left at a turn, metres: below 0 the wardrobe would stand in the inner corner. */
const leftAt = ([first, second], [long, deep], turn) =>
  first * Math.cos(turn) + second * Math.sin(turn) - long * Math.sin(turn) * Math.cos(turn) - deep;

/** What is left here, and the least of all turns with its turn: metres, radians. */
export function measure({ widths, size, turn }) {
  let least = Infinity, tightest = 0;
  for (let k = 0; k < TURNS; k++) {
    const there = k * (Math.PI / 2 / (TURNS - 1)), left = leftAt(widths, size, there);
    if (left < least) [least, tightest] = [left, there];
  }
  return { here: leftAt(widths, size, turn), least, tightest };
}

function render({ model, el }) {
  const state = () => ({ widths: model.get("widths"), size: model.get("size"), turn: model.get("turn") });
  const begin = structuredClone(state()), [long, deep] = begin.size, far = 2.4;
  const plane = addDrawing(el, [-0.3, -far, far, 0.3], "A wardrobe between the walls of two corridors");
  const wardrobe = addPart(plane, "path", { fill: BLUE, "fill-opacity": 0.3 });
  const walls = addPath(plane, BLACK, 0.03), gap = addPath(plane, ORANGE, 0.03);
  const set = (values) => { for (const name in values) model.set(name, values[name]); model.save_changes(); };
  const within = (value, low, high) => Math.min(high, Math.max(low, value));
  const share = (metres) => within(metres / long, 0, 1);
  const place = addHandles(plane, [
    {
      name: "the front end, on the upper wall", at: () => [long * Math.sin(state().turn), 0],
      to: ([x]) => set({ turn: Math.asin(share(x)) }),
    },
    {
      name: "the back end, on the left wall", at: () => [0, -long * Math.cos(state().turn)],
      to: ([, y]) => set({ turn: Math.acos(share(-y)) }),
    },
    {
      name: "the inner corner", fill: ORANGE, at: () => [state().widths[0], -state().widths[1]],
      to: ([x, y]) => set({ widths: [within(x, deep, 2), within(-y, deep, 2)] }),
    },
  ], { radius: 0.06, reach: 0.25 });
  const text = addControls(el, {
    "tightest turn": () => set({ turn: measure(state()).tightest }),
    "back to the start": () => set({ widths: begin.widths, turn: begin.turn }),
  });
  const draw = () => {
    const { widths: [first, second], turn } = state(), { here, least, tightest } = measure(state());
    const way = [Math.sin(turn), Math.cos(turn)], out = [way[1], -way[0]]; // along it, and to the inner corner
    const back = [0, -long * way[1]], front = [long * way[0], 0];
    const beyond = ([x, y]) => [x + deep * out[0], y + deep * out[1]];
    wardrobe.setAttribute("d", `M${[back, front, beyond(front), beyond(back)].map((end) => end.join(" ")).join("L")}Z`);
    walls.setAttribute("d", lines([[0, -far, 0, 0], [0, 0, far, 0], [first, -far, first, -second], [first, -second, far, -second]]));
    gap.setAttribute("d", lines([[first, -second, first - here * out[0], -second - here * out[1]]]));
    place();
    const cm = (metres) => `${(100 * metres).toFixed(1)} cm`, degrees = (180 * tightest) / Math.PI;
    text.textContent = `corridors of ${first.toFixed(2)} and ${second.toFixed(2)} m: here ${cm(here)} are left, `
      + `the least is ${cm(least)} at ${degrees.toFixed(0)} degrees`;
  };
  for (const name of ["widths", "turn"]) model.on(`change:${name}`, draw);
  draw();
}

export default { render };
