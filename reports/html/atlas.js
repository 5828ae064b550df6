// The atlas: a pointer or the arrow keys read the figure of a cell; its slices lie side by side.
for (const atlas of document.querySelectorAll(".atlas")) {
  const axes = JSON.parse(atlas.dataset.axes);
  const across = axes.columns.length;
  const up = axes.rows.length;
  const boxes = [...atlas.querySelectorAll(".cells")];
  const figures = boxes.map((box) => box.dataset.cells.split(";"));
  const output = atlas.querySelector("output");
  const cursor = document.createElement("i");
  cursor.className = "cursor";
  let at = { slice: 0, x: 0, y: 0 };

  const tell = (place) => {
    at = place;
    const { slice, x, y } = place;
    const figure = figures[slice][y * across + x];
    const inputs = [axes.columns[x], axes.rows[y], axes.slices[slice]].map((v, i) => axes.names[i] && `${axes.names[i]} ${v}`).filter(Boolean);
    output.textContent = `${inputs.join(", ")}: ${figure || "not tried"}`;
    boxes[slice].append(cursor);
    cursor.style.cssText = `left: ${(100 * x) / across}%; bottom: ${(100 * y) / up}%; width: ${100 / across}%; height: ${100 / up}%`;
  };
  const clamp = (value, count) => Math.min(Math.max(value, 0), count - 1);

  boxes.forEach((box, slice) => {
    box.addEventListener("pointermove", (event) => {
      const frame = box.getBoundingClientRect();
      const x = Math.floor(((event.clientX - frame.left) / frame.width) * across);
      const y = Math.floor(((frame.bottom - event.clientY) / frame.height) * up);
      tell({ slice, x: clamp(x, across), y: clamp(y, up) });
    });
  });
  const slices = atlas.querySelector(".slices");
  slices.addEventListener("focus", () => tell(at));
  slices.addEventListener("keydown", (event) => {
    const step = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!step) return;
    event.preventDefault();
    const along = clamp(at.slice * across + at.x + step[0], boxes.length * across);
    tell({ slice: Math.floor(along / across), x: along % across, y: clamp(at.y + step[1], up) });
  });
}

// A link into what is folded unfolds it.
function unfold() {
  const [target] = addressed();
  for (let fold = target?.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
  if (target?.closest("details")) target.scrollIntoView({ block: "start" });
}
addEventListener("hashchange", unfold);
unfold();
