// The pictures of a case, from their numbers: views of candidate and reference, and a pixel probe.
{
  const kinds = JSON.parse(document.getElementById("kinds")?.textContent ?? "{}");
  const COMPUTED = ["difference", "signed"]; // from the two pictures, here
  const MAPS = ["blocks", "ssim", "flip"];
  const NEAR = 14; // pixels from the divider that take hold of it
  const SHARP = 3; // pixels of the screen per pixel, from which on their edges are shown

  class Viewer {
    constructor(section) {
      this.section = section;
      this.root = section.querySelector(".viewer");
      const told = JSON.parse(this.root.querySelector("script").textContent);
      Object.assign(this, told); // width, height, exposure, objects, layers
      this.find = (name) => this.root.querySelector(`.${name}`);
      this.stage = this.find("stage");
      this.canvas = this.stage.querySelector("canvas");
      this.unpacked = new Map();
      this.drawn = new Map();
      this.stops = 0;
      this.split = 0.5;
      this.flipped = false;
      this.pinned = false;
      this.pixel = null;
      this.fit();
      this.listen();
    }

    fit() {
      this.zoom = 1;
      this.centre = [this.width / 2, this.height / 2];
    }

    chosen(axis) {
      return this.section.querySelector(`input[data-axis=${axis}]:checked`)?.value ?? "";
    }

    choose(axis, value) {
      const input = [...this.section.querySelectorAll(`input[data-axis=${axis}]`)].find((i) => i.value === value);
      if (!input || input.checked) return;
      input.checked = true;
      input.dispatchEvent(new Event("change", { bubbles: true }));
    }

    layer(kind) {
      const technique = this.chosen("technique"), truth = this.chosen("truth");
      const fits = (list, name) => !list.length || list.includes(name);
      return this.layers.find((l) => l.kind === kind && fits(l.techniques, technique) && fits(l.truths, truth));
    }

    async numbers(layer) {
      if (!layer) throw new Error("the run recorded none");
      if (layer.problem) throw new Error(layer.problem);
      if (!this.unpacked.has(layer.id)) {
        const text = await layerText(layer.id);
        const radiance = ["candidate", "truth"].includes(layer.kind);
        const made = radiance ? packing.radiance(text, this.width, this.height) : packing.inflated(text);
        this.unpacked.set(layer.id, await made);
      }
      return this.unpacked.get(layer.id);
    }

    // Read what is chosen and draw it; the last call wins.
    async show() {
      this.seen = true;
      const call = (this.call = (this.call ?? 0) + 1);
      const view = this.chosen("view");
      const problems = {}, read = {};
      for (const kind of ["candidate", "truth", "objects", ...MAPS]) {
        if (MAPS.includes(kind) && kind !== view && !this.probed) continue;
        try {
          read[kind] = { layer: this.layer(kind), numbers: await this.numbers(this.layer(kind)) };
        } catch (error) {
          problems[kind] = error.message;
        }
      }
      if (call !== this.call) return;
      const needed = MAPS.includes(view) ? [view] : ["candidate", "truth"];
      const lost = needed.filter((kind) => problems[kind]);
      const nothing = this.find("nothing");
      // One of two pictures can be looked at alone.
      nothing.hidden = !(lost.length === needed.length || (lost.length && COMPUTED.includes(view)));
      const said = lost.map((kind) => `${kinds[kind].title}: ${problems[kind]}`).join("; ");
      nothing.textContent = `No picture: ${said}`;
      this.note(lost.length && nothing.hidden ? nothing.textContent : "");
      this.read = read;
      this.stage.dataset.view = view;
      this.paint();
      this.probe();
    }

    note(text) {
      const note = this.find("note");
      note.hidden = !text;
      note.textContent = text;
    }

    // A picture or map as a canvas of its own size, made once for an exposure.
    bitmap(kind) {
      const { read } = this, pair = ["candidate", "truth"].map((k) => read[k]);
      const own = COMPUTED.includes(kind) ? pair : [read[kind]];
      if (own.some((one) => !one)) return null;
      const key = [kind, ...own.map((one) => one.layer.id), kind === "signed" || MAPS.includes(kind) ? "" : this.stops].join();
      if (this.drawn.has(key)) return this.drawn.get(key);
      const image = new ImageData(this.width, this.height);
      if (kind === "signed") painting.signed(image.data, ...own, read.objects?.numbers, kinds.signed);
      else if (kind === "difference") painting.difference(image.data, ...own, this.scale);
      else if (MAPS.includes(kind)) painting.placed(image.data, own[0].numbers, kinds[kind].palette);
      else painting.displayed(image.data, own[0], this.scale);
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [this.width, this.height];
      canvas.getContext("2d").putImageData(image, 0, 0);
      if (this.drawn.size > 7) this.drawn.delete(this.drawn.keys().next().value);
      this.drawn.set(key, canvas);
      return canvas;
    }

    get scale() {
      return this.exposure * 2 ** this.stops;
    }

    // Where pictures stand on the canvas: [kind, left, right, clip from, clip to].
    panes(width) {
      const view = this.stage.dataset.view, half = Math.round(width / 2), edge = this.split * width;
      if (view === "slide") return [["candidate", 0, width, 0, edge], ["truth", 0, width, edge, width]];
      if (view === "side") return [["candidate", 0, half, 0, half - 1], ["truth", half, width, half + 1, width]];
      const kind = view === "blink" ? (this.flipped ? "truth" : "candidate") : view;
      return [[kind, 0, width, 0, width]];
    }

    paint() {
      const view = this.stage.dataset.view;
      if (!this.read || !view) return;
      const across = view === "side" ? 2 : 1, wide = this.stage.clientWidth;
      this.stage.style.height = `${Math.round(Math.min((wide / across) * (this.height / this.width), 0.8 * innerHeight))}px`;
      const dense = devicePixelRatio || 1;
      const [width, height] = [wide, this.stage.clientHeight].map((n) => Math.max(Math.round(n * dense), 1));
      if (this.canvas.width !== width || this.canvas.height !== height) [this.canvas.width, this.canvas.height] = [width, height];
      const to = this.canvas.getContext("2d");
      to.clearRect(0, 0, width, height);
      for (const [kind, left, right, from, until] of this.panes(width)) {
        const bitmap = this.bitmap(kind);
        if (!bitmap) continue;
        const [scale, x, y] = this.place(left, right, height);
        to.save();
        to.beginPath();
        to.rect(from, 0, until - from, height);
        to.clip();
        to.imageSmoothingEnabled = scale < SHARP * dense;
        to.imageSmoothingQuality = "high";
        to.drawImage(bitmap, x, y, scale * this.width, scale * this.height);
        if (this.pixel) this.mark(to, x + scale * this.pixel[0], y + scale * this.pixel[1], Math.max(scale, 5 * dense));
        to.restore();
      }
      this.labels();
    }

    // Screen pixels per pixel, and where the picture's corner comes to lie.
    place(left, right, height) {
      const scale = this.zoom * Math.min((right - left) / this.width, height / this.height);
      return [scale, (left + right) / 2 - scale * this.centre[0], height / 2 - scale * this.centre[1]];
    }

    mark(to, x, y, side) {
      for (const [colour, wide] of [["#000", 3], ["#fff", 1]]) {
        to.strokeStyle = colour;
        to.lineWidth = wide;
        to.strokeRect(x, y, side, side);
      }
    }

    labels() {
      const view = this.stage.dataset.view;
      const named = { candidate: this.layer("candidate")?.name || this.chosen("technique"), truth: this.chosen("truth") };
      // An outside renderer's technique is just `candidate`.
      const label = (kind) => `${kinds[kind].title} ${named[kind] === kind ? "" : named[kind] ?? ""}`.trim();
      const [left, right] = this.stage.querySelectorAll(".named");
      const two = view === "slide" || view === "side";
      const alone = view === "blink" ? (this.flipped ? "truth" : "candidate") : view;
      left.textContent = label(two ? "candidate" : alone);
      right.textContent = two ? label("truth") : "";
      right.hidden = !two;
      const divider = this.find("divider");
      divider.hidden = view !== "slide";
      divider.style.left = `${100 * this.split}%`;
      this.find("split").hidden = view !== "slide";
      this.find("blink").hidden = view !== "blink";
      this.find("zoomed").textContent = `${Math.round(100 * this.zoom)} %`;
      this.find("stops").textContent = `${this.stops > 0 ? "+" : this.stops < 0 ? "−" : ""}${Math.abs(this.stops)} EV`;
      this.find("exposure").querySelector("input").value = this.stops;
      this.find("split").querySelector("input").value = 100 * this.split;
    }

    // The picture's pixel under a place on the stage, in CSS pixels; null outside.
    under(x, y) {
      const width = this.stage.clientWidth, height = this.stage.clientHeight;
      const side = this.stage.dataset.view === "side", half = width / 2;
      const [left, right] = !side ? [0, width] : x < half ? [0, half] : [half, width];
      const [scale, dx, dy] = this.place(left, right, height);
      const at = [Math.floor((x - dx) / scale), Math.floor((y - dy) / scale)];
      return at[0] >= 0 && at[1] >= 0 && at[0] < this.width && at[1] < this.height ? at : null;
    }

    probe() {
      const out = this.find("probe"), { read } = this;
      out.classList.toggle("blank", !this.pixel);
      if (!this.pixel || !read) return;
      if (!this.probed) {
        this.probed = true; // from now on with the maps' values
        this.show();
        return;
      }
      const [x, y] = this.pixel, i = y * this.width + x;
      const object = read.objects?.numbers[i];
      const set = (name, text) => (out.querySelector(`.${name}`).textContent = text);
      set("where", `x ${x}, y ${y}${object ? `, ${this.objects[object - 1]}` : ""}`);
      for (const kind of ["candidate", "truth"]) {
        const rgb = read[kind] ? painting.rgb(read[kind], i) : [NaN, NaN, NaN];
        rgb.forEach((value, c) => set(`${kind}-${"rgb"[c]}`, digits(value)));
      }
      const both = read.candidate && read.truth;
      const error = both ? painting.light(read.candidate, i) / painting.light(read.truth, i) - 1 : NaN;
      set("error", Number.isFinite(error) ? `${signedDigits(100 * error)} %` : "–");
      for (const kind of MAPS) {
        const place = read[kind]?.numbers[i] ?? 0, { low, high, palette } = kinds[kind];
        const value = low + ((place - 2) / (palette.length - 3)) * (high - low);
        const ended = place === 2 || place === palette.length - 1;
        const shown = kind === "blocks" ? `${signedDigits(100 * value)} %${ended ? " or more" : ""}` : value.toFixed(2);
        set(kind, place < 2 ? "–" : shown);
      }
      out.hidden = false;
      out.setAttribute("aria-live", this.pinned ? "polite" : "off"); // not at every move of a pointer
    }

    point(pixel, pin = this.pinned) {
      this.pixel = pixel;
      this.pinned = pin && Boolean(pixel);
      this.paint();
      this.probe();
    }

    rezoom(factor, x = this.stage.clientWidth / 2, y = this.stage.clientHeight / 2) {
      const before = this.zoom, side = this.stage.dataset.view === "side";
      this.zoom = Math.min(Math.max(before * factor, 1), 64);
      // What is under the pointer stays there.
      const width = this.stage.clientWidth, half = width / 2;
      const [left, right] = !side ? [0, width] : x < half ? [0, half] : [half, width];
      const fitted = Math.min((right - left) / this.width, this.stage.clientHeight / this.height);
      const moved = (1 / before - 1 / this.zoom) / fitted;
      this.pan((x - (left + right) / 2) * moved, (y - this.stage.clientHeight / 2) * moved);
    }

    // Move the middle by pixels of the picture, which stays on the stage.
    pan(dx, dy) {
      const limit = (value, size) => {
        const half = size / this.zoom / 2;
        return Math.min(Math.max(value, half), size - half);
      };
      this.centre = [limit(this.centre[0] + dx, this.width), limit(this.centre[1] + dy, this.height)];
      this.paint();
    }

    expose(stops) {
      this.stops = Math.min(Math.max(stops, -10), 10);
      this.paint();
    }

    slide(split) {
      this.split = Math.min(Math.max(split, 0), 1);
      this.paint();
    }

    blink() {
      if (this.chosen("view") === "blink") {
        this.flipped = !this.flipped;
        this.paint();
      } else {
        this.choose("view", "blink");
      }
    }

    // An address that shows just this.
    get address() {
      const row = [...this.section.querySelectorAll("tbody[id]")].find(
        (r) => r.dataset.technique === this.chosen("technique") && r.dataset.truth === this.chosen("truth"),
      );
      const asked = new URLSearchParams({ technique: this.chosen("technique"), truth: this.chosen("truth"), view: this.chosen("view") });
      if (this.stops) asked.set("ev", this.stops);
      if (this.zoom !== 1) asked.set("zoom", this.zoom.toFixed(2));
      if (this.zoom !== 1) asked.set("centre", this.centre.map((n) => n.toFixed(1)).join());
      if (this.chosen("view") === "slide" && this.split !== 0.5) asked.set("split", this.split.toFixed(3));
      if (this.chosen("view") === "blink" && this.flipped) asked.set("flipped", 1);
      if (this.pixel && this.pinned) asked.set("pixel", this.pixel.join());
      return `#${row ? row.id : this.section.id}?${asked}`;
    }

    // Show what an address asks for; what it leaves out is as at first.
    obey(asked) {
      this.fit();
      [this.stops, this.split, this.flipped, this.pixel, this.pinned] = [0, 0.5, asked.has("flipped"), null, false];
      for (const axis of ["technique", "truth", "view"]) if (asked.has(axis)) this.choose(axis, asked.get(axis));
      const numbers = (name) => (asked.get(name) ?? "").split(",").map(Number);
      if (asked.has("ev")) this.stops = Math.min(Math.max(Number(asked.get("ev")) || 0, -10), 10);
      if (asked.has("zoom")) this.zoom = Math.min(Math.max(Number(asked.get("zoom")) || 1, 1), 64);
      if (asked.has("centre") && numbers("centre").every(Number.isFinite)) this.centre = numbers("centre");
      if (asked.has("split")) this.split = Math.min(Math.max(Number(asked.get("split")) || 0, 0), 1);
      const [x, y] = numbers("pixel").map(Math.floor);
      if (asked.has("pixel") && x >= 0 && y >= 0 && x < this.width && y < this.height) {
        [this.pixel, this.pinned] = [[x, y], true];
      }
      this.pan(0, 0);
      this.show();
    }

    listen() {
      const { stage } = this;
      this.section.addEventListener("change", (event) => event.target.dataset.axis && this.show());
      this.find("exposure").querySelector("input").addEventListener("input", (e) => this.expose(Number(e.target.value)));
      this.find("split").querySelector("input").addEventListener("input", (e) => this.slide(e.target.value / 100));
      this.find("blink").addEventListener("click", () => this.blink());
      this.find("nearer").addEventListener("click", () => this.rezoom(2));
      this.find("farther").addEventListener("click", () => this.rezoom(0.5));
      this.find("fit").addEventListener("click", () => (this.fit(), this.paint()));
      this.find("link").addEventListener("click", (event) => {
        history.replaceState(null, "", this.address);
        copy(location.href, event.target, "It stands in the address");
      });
      stage.addEventListener("keydown", (event) => this.key(event));
      stage.addEventListener("pointerdown", (event) => this.grab(event));
      stage.addEventListener("pointermove", (event) => this.hover(event));
      stage.addEventListener("pointerleave", () => !this.pinned && !this.held && this.point(null));
      stage.addEventListener("dblclick", (event) => this.rezoom(2, event.offsetX, event.offsetY));
      // A pinch, or the wheel with Ctrl; the wheel alone scrolls the page.
      stage.addEventListener("wheel", (event) => {
        if (!event.ctrlKey) return;
        event.preventDefault();
        this.rezoom(2 ** (-event.deltaY / 100), event.offsetX, event.offsetY);
      }, { passive: false });
      new ResizeObserver(() => this.seen && this.paint()).observe(this.root);
      // Numbers are unpacked when their case comes near the window.
      new IntersectionObserver((entries, observer) => {
        if (!entries.some((e) => e.isIntersecting)) return;
        observer.disconnect();
        if (!this.seen) this.show();
      }, { rootMargin: "300px" }).observe(this.root);
    }

    key(event) {
      if (event.altKey || event.metaKey || event.ctrlKey) return;
      const step = event.shiftKey ? 10 : 1;
      const move = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] }[event.key];
      const views = [...this.section.querySelectorAll("input[data-axis=view]")];
      const act = {
        f: () => this.blink(),
        "+": () => this.rezoom(2), "=": () => this.rezoom(2), "-": () => this.rezoom(0.5),
        0: () => (this.fit(), this.paint()),
        "[": () => this.expose(this.stops - 0.5), "]": () => this.expose(this.stops + 0.5),
        ",": () => this.slide(this.split - 0.02), ".": () => this.slide(this.split + 0.02),
        Escape: () => this.point(null, false),
      }[event.key];
      const view = views[Number(event.key) - 1];
      if (move) this.step(move);
      else if (act) act();
      else if (view && /^[1-9]$/.test(event.key)) this.choose("view", view.value);
      else return;
      event.preventDefault();
    }

    step([dx, dy]) {
      const [x, y] = this.pixel ?? this.centre.map(Math.floor);
      const to = [Math.min(Math.max(x + dx, 0), this.width - 1), Math.min(Math.max(y + dy, 0), this.height - 1)];
      // What is probed stays in sight.
      const half = [this.width / this.zoom / 2, this.height / this.zoom / 2];
      const past = to.map((at, a) => Math.max(Math.abs(at + 0.5 - this.centre[a]) - half[a] + 1, 0) * Math.sign(at + 0.5 - this.centre[a]));
      if (this.zoom > 1 && (past[0] || past[1])) this.pan(...past);
      this.point(to, true);
    }

    grab(event) {
      if (event.button) return;
      const { stage } = this, from = [event.clientX, event.clientY], edge = this.split * stage.clientWidth;
      const divider = stage.dataset.view === "slide" && Math.abs(event.offsetX - edge) < NEAR;
      this.held = { divider, from, last: from, moved: false };
      stage.setPointerCapture(event.pointerId);
      const end = () => {
        const held = this.held;
        this.held = null;
        stage.removeEventListener("pointerup", end);
        stage.removeEventListener("pointercancel", end);
        if (!held.moved && !held.divider) this.point(this.under(event.offsetX, event.offsetY), true);
      };
      stage.addEventListener("pointerup", end);
      stage.addEventListener("pointercancel", end);
    }

    hover(event) {
      const { stage, held } = this, box = stage.getBoundingClientRect();
      const at = [event.clientX - box.left, event.clientY - box.top];
      if (!held) {
        const near = stage.dataset.view === "slide" && Math.abs(at[0] - this.split * stage.clientWidth) < NEAR;
        stage.classList.toggle("divides", near);
        if (!this.pinned) this.point(this.under(...at));
        return;
      }
      const moved = [event.clientX - held.last[0], event.clientY - held.last[1]];
      held.moved ||= Math.hypot(event.clientX - held.from[0], event.clientY - held.from[1]) > 3;
      held.last = [event.clientX, event.clientY];
      if (held.divider) return this.slide(at[0] / stage.clientWidth);
      const [scale] = this.place(0, stage.clientWidth / (stage.dataset.view === "side" ? 2 : 1), stage.clientHeight);
      if (held.moved) this.pan(-moved[0] / scale, -moved[1] / scale);
    }
  }

  // Three digits, as the page writes numbers.
  function digits(value) {
    if (Number.isNaN(value)) return "NaN";
    if (!Number.isFinite(value)) return value < 0 ? "−∞" : "∞";
    return Number(value.toPrecision(3)).toString().replace("-", "−");
  }

  function signedDigits(value) {
    return `${value > 0 ? "+" : ""}${digits(value)}`;
  }

  for (const section of document.querySelectorAll(".case")) {
    if (section.querySelector(".viewer")) section.viewer = new Viewer(section);
  }
}
