// Of figures and charts the page shows everything at once without this script; it only chooses.

// Show, in a section, what matches the chosen technique, truth and so on.
function choose(section) {
  const chosen = {};
  for (const input of section.querySelectorAll("input[data-axis]:checked")) {
    chosen[input.dataset.axis] = input.value;
  }
  // An element names what it is shown with on an axis, apart by blanks; nothing is all of it.
  const matches = (element) =>
    Object.entries(chosen).every(([axis, value]) => {
      const own = element.dataset[axis] ?? "";
      return ["", value].includes(own) || own.split(" ").includes(value);
    });
  for (const element of section.querySelectorAll(".choice")) element.hidden = !matches(element);
  for (const row of section.querySelectorAll("tbody[id]")) row.classList.toggle("chosen", matches(row));
}

// The element that the address names, if any, and what is asked of it.
function addressed() {
  const [name, asked] = location.hash.slice(1).split("?");
  try {
    return [document.getElementById(decodeURIComponent(name)), asked];
  } catch {
    return [null, ""]; // no address at all
  }
}

// A link to a row, or to a view of its case, shows the pictures above its table.
function follow() {
  const [target, asked] = addressed();
  if (asked && target?.obey) {
    target.obey(new URLSearchParams(asked));
    target.scrollIntoView({ block: "start" });
  }
  const section = target && target.closest(".case");
  if (!section || (target === section && !asked)) return;
  const wanted = new URLSearchParams(asked);
  for (const axis of ["technique", "truth"]) {
    if (target !== section && !wanted.has(axis)) wanted.set(axis, target.dataset[axis]);
  }
  section.viewer.obey(wanted);
  section.scrollIntoView({ block: "start" });
}

// Points and lines take the places that the chosen meaning of time gives them.
function move(section) {
  const chosen = section.querySelector("input[data-axis=time]:checked");
  if (!chosen) return;
  for (const path of section.querySelectorAll("path[data-moves]")) {
    path.setAttribute("d", JSON.parse(path.dataset.moves)[chosen.value] ?? "");
  }
  for (const spot of section.querySelectorAll(".spots li")) {
    const state = JSON.parse(spot.dataset.moves)[chosen.value];
    spot.hidden = !state;
    if (!state) continue;
    const [x, low, high, time, standing, side] = state;
    for (const [name, at] of Object.entries({ x, low, high })) spot.style.setProperty(`--${name}`, at);
    spot.dataset.standing = standing;
    spot.querySelector(".time").textContent = time;
    spot.querySelector(".tag").dataset.side = side;
  }
  for (const spots of section.querySelectorAll(".spots")) stop(spots);
}

// A plot is one stop of the Tab key: the point last looked at, or the leftmost.
function stop(spots, last) {
  const at = (mark) => Number(mark.closest("li").style.getPropertyValue("--x"));
  const marks = [...spots.querySelectorAll("li:not([hidden]) a")].sort((a, b) => at(a) - at(b));
  for (const mark of spots.querySelectorAll("a")) mark.tabIndex = -1;
  const place = last ?? marks[0];
  if (place) place.tabIndex = 0;
  return marks;
}

for (const spots of document.querySelectorAll(".spots")) {
  stop(spots);
  spots.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const marks = stop(spots);
    const next = marks.at((marks.indexOf(document.activeElement) + step) % marks.length);
    stop(spots, next);
    next.focus();
  });
}

// A heading sorts its table: first upwards, then downwards, what is unknown last.
for (const button of document.querySelectorAll(".sortable thead button")) {
  button.addEventListener("click", () => {
    const head = button.closest("th");
    const heads = [...head.parentElement.children];
    const sign = head.ariaSort === "ascending" ? -1 : 1;
    for (const other of heads) other.ariaSort = null;
    head.ariaSort = sign === 1 ? "ascending" : "descending";
    const text = (row) => row.cells[heads.indexOf(head)].dataset.value;
    const key = (row) => (text(row) === "" ? Infinity : sign * Number(text(row)));
    const body = button.closest("table").tBodies[0];
    body.append(...[...body.rows].sort((a, b) => key(a) - key(b) || 0));
  });
}

for (const section of document.querySelectorAll("[data-group]")) {
  section.addEventListener("change", () => (choose(section), move(section)));
  choose(section);
}
async function copy(text, button, otherwise) {
  const said = button.textContent;
  const done = await navigator.clipboard?.writeText(text).then(() => true, () => false);
  if (done || otherwise) {
    button.textContent = done ? "Copied" : otherwise;
    setTimeout(() => (button.textContent = said), 2000);
  }
  return done;
}

for (const button of document.querySelectorAll("[data-copy]")) {
  button.addEventListener("click", async () => {
    const text = document.getElementById(button.dataset.copy);
    // A browser that forbids it still saves the aiming.
    if (!(await copy(text.textContent, button))) getSelection().selectAllChildren(text);
  });
}
addEventListener("hashchange", follow);
// A link to the row that is already in the address changes no hash.
document.addEventListener("click", (event) => {
  const link = event.target.closest('a[href^="#row"]');
  if (link && link.getAttribute("href") === location.hash) follow();
});
follow();
