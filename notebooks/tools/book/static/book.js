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
