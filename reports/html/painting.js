// Colours of pixels, into the bytes of an image: pictures at an exposure, differences, and maps.
// A picture is its layer and the bits of its half floats (packing.js).
const painting = (() => {
  const { LINEAR, displayed: shown, srgb } = packing;
  const FAINT = 0.01; // of an object's mean light: darker pixels are divided by that
  const NO_NUMBER = [255, 0, 255];

  function rgb({ layer, numbers }, i) {
    return [0, 1, 2].map((c) => LINEAR[numbers[3 * i + c]] * layer.scale);
  }

  function light(picture, i) {
    const [r, g, b] = rgb(picture, i);
    return (r + g + b) / 3;
  }

  function displayed(to, { layer, numbers }, exposure) {
    const colours = shown(layer.scale * exposure);
    for (let i = 0, j = 0; i < numbers.length; i += 3, j += 4) {
      const known = Number.isFinite(LINEAR[numbers[i]] + LINEAR[numbers[i + 1]] + LINEAR[numbers[i + 2]]);
      for (let c = 0; c < 3; ++c) to[j + c] = known ? colours[numbers[i + c]] : NO_NUMBER[c];
      to[j + 3] = 255;
    }
  }

  function difference(to, a, b, exposure) {
    for (let i = 0, j = 0; i < a.numbers.length; i += 3, j += 4) {
      for (let c = 0; c < 3; ++c) {
        const apart = Math.abs(LINEAR[a.numbers[i + c]] * a.layer.scale - LINEAR[b.numbers[i + c]] * b.layer.scale);
        to[j + c] = Number.isFinite(apart) ? srgb(apart * exposure) : NO_NUMBER[c];
      }
      to[j + 3] = 255;
    }
  }

  // Candidate over reference, minus 1, on objects; of each 1 % of its mean light is the least to divide by.
  function signed(to, a, b, objects, { low, high, palette }) {
    const last = palette.length - 1, sum = new Float64Array(256), pixels = new Float64Array(256);
    for (let i = 0; i < (objects?.length ?? 0); ++i) {
      sum[objects[i]] += light(b, i);
      pixels[objects[i]] += 1;
    }
    for (let i = 0; i < (objects?.length ?? 0); ++i) {
      const object = objects[i];
      if (!object) continue;
      const truth = light(b, i);
      const error = (light(a, i) - truth) / Math.max(truth, (FAINT * sum[object]) / pixels[object], 1e-30);
      const share = Math.min(Math.max((error - low) / (high - low), 0), 1);
      colour(to, i, Number.isNaN(error) ? 1 : 2 + Math.round(share * (last - 2)), palette);
    }
  }

  function placed(to, places, palette) {
    for (let i = 0; i < places.length; ++i) colour(to, i, places[i], palette);
  }

  function colour(to, i, place, palette) {
    if (place) [to[4 * i], to[4 * i + 1], to[4 * i + 2], to[4 * i + 3]] = [...palette[place], 255];
  }

  return { rgb, light, displayed, difference, signed, placed };
})();
