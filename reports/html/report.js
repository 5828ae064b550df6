"use strict";
// The page works without this script, with everything shown at once; it only chooses.

// Show, in a section, what matches the chosen technique, truth and so on.
function choose(section) {
  const chosen = {};
  for (const input of section.querySelectorAll("input[data-axis]:checked")) {
    chosen[input.dataset.axis] = input.value;
  }
  const matches = (element) =>
    Object.entries(chosen).every(([axis, value]) => [value, "", undefined].includes(element.dataset[axis]));
  for (const element of section.querySelectorAll(".choice")) element.hidden = !matches(element);
  for (const row of section.querySelectorAll("tbody[id]")) row.classList.toggle("chosen", matches(row));
}

// A link to a row shows that row's pictures above its table.
function follow() {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  const section = target && target.closest(".case");
  if (!section || target === section) return;
  for (const axis of ["technique", "truth"]) {
    for (const input of section.querySelectorAll(`input[data-axis=${axis}]`)) {
      input.checked = input.value === target.dataset[axis];
    }
  }
  choose(section);
  section.querySelector(".pictures").scrollIntoView({ block: "start" });
}

for (const section of document.querySelectorAll("[data-group]")) {
  section.addEventListener("change", () => choose(section));
  choose(section);
}
for (const button of document.querySelectorAll("[data-copy]")) {
  button.addEventListener("click", async () => {
    const text = document.getElementById(button.dataset.copy);
    try {
      await navigator.clipboard.writeText(text.textContent);
      button.textContent = "Copied";
    } catch {
      getSelection().selectAllChildren(text); // a browser that forbids it still saves the aiming
    }
  });
}
addEventListener("hashchange", follow);
// A link to the row that is already in the address changes no hash.
document.addEventListener("click", (event) => {
  const link = event.target.closest('a[href^="#row"]');
  if (link && link.getAttribute("href") === location.hash) follow();
});
follow();
