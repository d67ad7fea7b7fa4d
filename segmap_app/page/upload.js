// A button that takes a file of the user's and sends it in pieces, each when the one before has come.
const PIECE = 1 << 20;

function render({ model, el }) {
  const button = document.createElement("button"), input = document.createElement("input");
  button.className = "jupyter-widgets jupyter-button widget-button";
  button.textContent = model.get("description");
  button.style.width = "auto";
  input.type = "file";
  button.onclick = () => input.click();
  let file = null;
  async function send(start) {
    const small = file.size <= model.get("most"), end = Math.min(start + PIECE, file.size);
    const piece = small ? [await file.slice(start, end).arrayBuffer()] : [];
    model.send({ name: file.name, size: file.size, start }, undefined, piece);
  }
  input.onchange = () => {
    file = input.files[0];
    input.value = "";  // the same file may be chosen again
    if (file) send(0);
  };
  model.on("msg:custom", said => { if (said.next > 0) send(said.next); });
  el.appendChild(button);
}

export default { render };
