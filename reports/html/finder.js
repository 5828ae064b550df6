// Rows by what is chosen of them; the choice stands in the address.
for (const section of document.querySelectorAll(".finder")) {
  const form = section.querySelector("form"), rows = [...section.querySelectorAll("tbody tr")];
  const filter = () => {
    const { text, ...chosen } = Object.fromEntries(new FormData(form));
    const words = text.toLowerCase().split(/\s+/).filter(Boolean);
    for (const row of rows) {
      const own = Object.entries(chosen).every(([name, value]) => !value || row.dataset[name] === value);
      const whole = row.textContent.toLowerCase();
      row.hidden = !(own && words.every((word) => whole.includes(word)));
    }
    const count = rows.filter((row) => !row.hidden).length;
    form.querySelector("output").textContent = count === rows.length ? `${count} rows` : `${count} of ${rows.length} rows`;
  };
  form.addEventListener("input", () => {
    filter();
    const asked = new URLSearchParams([...new FormData(form)].filter(([, value]) => value));
    history.replaceState(null, "", `#rows${asked.size ? `?${asked}` : ""}`);
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => {
    for (const head of section.querySelectorAll("th[aria-sort]")) head.ariaSort = null;
    section.querySelector("tbody").append(...rows); // worst first again
    setTimeout(() => form.dispatchEvent(new Event("input")));
  });
  section.obey = (asked) => {
    for (const field of form.elements) if (field.name) field.value = asked.get(field.name) ?? "";
    // Of what there is none, no row is shown, and that is said.
    const unknown = [...form.querySelectorAll("select")].filter((s) => asked.has(s.name) && s.value !== asked.get(s.name));
    filter();
    if (!unknown.length) return;
    for (const row of rows) row.hidden = true;
    form.querySelector("output").textContent = `no row has ${unknown.map((s) => `${s.name} ${asked.get(s.name)}`).join(", ")}`;
  };
}
