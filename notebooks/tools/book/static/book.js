// One button folds all code of a page, and all pages remember it.
document.addEventListener("DOMContentLoaded", () => {
  const cells = [...document.querySelectorAll("details.code-fold")];
  const title = document.querySelector("article h1");
  if (!cells.length || !title) return;
  const start = cells.map((cell) => cell.open);
  const button = document.createElement("button");
  button.className = "fold-all";
  button.type = "button";
  const kept = {
    get: () => { try { return localStorage.getItem("segmap-code"); } catch { return null; } },
    set: (value) => { try { localStorage.setItem("segmap-code", value); } catch { /* a file */ } },
  };
  const show = (state) => {
    cells.forEach((cell, k) => { cell.open = state === "all" || (state !== "none" && start[k]); });
    button.textContent = state === "none" ? "Show all code" : "Fold all code";
    button.dataset.state = state;
  };
  button.addEventListener("click", () => {
    const next = button.dataset.state === "none" ? "all" : "none";
    kept.set(next);
    show(next);
  });
  title.insertAdjacentElement("afterend", button);
  show(kept.get() || "some");
});

// Below each page that a search finds stands its claim: a page of a file cannot be fetched.
document.addEventListener("DOMContentLoaded", () => {
  const list = document.querySelector("#search-results");
  if (!list) return;
  const describe = (item) => {
    const link = item.querySelector(":scope > a");
    if (!link || item.querySelector("p") || link.hash) return;
    const page = Object.keys(SUMMARIES).find((name) => link.pathname.endsWith(`/${name}.html`));
    if (!page) return;
    const words = document.createElement("p");
    words.textContent = SUMMARIES[page];
    item.append(words);
  };
  const watch = new MutationObserver(() => list.querySelectorAll("li").forEach(describe));
  watch.observe(list, { childList: true, subtree: true });
});

// A panel's slider shows one of the pictures that lie one below the other in its file.
document.addEventListener("DOMContentLoaded", () => {
  for (const panel of document.querySelectorAll(".panel-states")) {
    const said = JSON.parse(panel.dataset.said);
    const [picture, slider, words] = panel.querySelector("figure").children;
    slider.addEventListener("input", () => {
      const k = Number(slider.value);
      picture.style.objectPosition = `0 ${(100 * k) / Math.max(1, said.length - 1)}%`;
      picture.alt = words.textContent = said[k];
    });
  }
});
