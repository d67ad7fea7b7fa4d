// Figures to drag: the page carries the text of their modules, and the state that Python stored.
document.addEventListener("DOMContentLoaded", async () => {
  const modules = {};
  for (const place of document.querySelectorAll(".drag-figure")) {
    const state = JSON.parse(place.dataset.state), listeners = {};
    const model = {
      get: (name) => state[name],
      set: (name, value) => {
        state[name] = value;
        (listeners[`change:${name}`] ?? []).forEach((call) => call());
      },
      on: (event, call) => { (listeners[event] ??= []).push(call); },
      off() {}, save_changes() {}, send() {},
    };
    const name = place.dataset.module, picture = [...place.childNodes];
    try {
      const text = document.getElementById(name).textContent;
      modules[name] ??= import(URL.createObjectURL(new Blob([text], { type: "text/javascript" })));
      const { default: figure } = await modules[name];
      place.replaceChildren();
      figure.render({ model, el: place });
    } catch (problem) { // the picture stays
      place.replaceChildren(...picture);
      console.error(`a figure to drag: ${problem}`);
    }
  }
});

// Above an answer that is opened stands how far off the number was that the reader wrote.
document.addEventListener("DOMContentLoaded", () => {
  let field = null;
  for (const part of document.querySelectorAll(".predict input, details.reveal")) {
    if (part.matches("input")) {
      field = part;
      continue;
    }
    const own = field, answer = part.querySelector(".answer");
    if (!own || !answer) continue;
    const { answer: right, unit } = answer.dataset;
    const tell = () => {
      const off = Number(own.value) - Number(right), words = Math.abs(Number(off.toPrecision(3)));
      const judged = off === 0 ? "just that" : `${words} ${unit} too ${off > 0 ? "high" : "low"}`;
      answer.textContent = `The answer is ${right} ${unit}. `
        + (own.value === "" ? "You predicted nothing." : `You predicted ${own.value}: ${judged}.`);
    };
    part.addEventListener("toggle", tell);
    own.addEventListener("input", tell);
  }
});
