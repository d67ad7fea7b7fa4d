// A button that takes a file of the user's; of one that no message can carry only name and size go.
function render({ model, el }) {
  const button = document.createElement("button"), input = document.createElement("input");
  button.className = "jupyter-widgets jupyter-button widget-button";
  button.textContent = model.get("description");
  input.type = "file";
  button.onclick = () => input.click();
  input.onchange = async () => {
    const file = input.files[0];
    if (!file) return;
    const sent = file.size > model.get("most") ? [] : [await file.arrayBuffer()];
    model.send({ name: file.name, size: file.size }, undefined, sent);
    input.value = "";  // the same file may be chosen again
  };
  el.appendChild(button);
}

export default { render };
