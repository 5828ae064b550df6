"use strict";
// Unpacks what reports/html/packing.py packs.
const packing = (() => {
  // What each half float stands for, by its bits, before the layer's scale.
  const LINEAR = Float32Array.from({ length: 1 << 16 }, (_, bits) => {
    const exponent = (bits >> 10) & 31, digits = bits & 1023;
    if (exponent === 31) return digits ? NaN : bits >> 15 ? -Infinity : Infinity;
    const size = exponent ? (1 + digits / 1024) * 2 ** (exponent - 15) : digits * 2 ** -24;
    return bits >> 15 ? -size : size;
  });

  async function inflated(text) {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  // The bits of R, G and B, pixel by pixel.
  async function radiance(text, width, height) {
    const bytes = await inflated(text), count = width * height, low = 3 * count;
    const codes = new Uint16Array(3 * count);
    const place = [1, 0, 2]; // planes are G, R - G, B - G
    const plane = new Int32Array(count);
    for (let p = 0; p < 3; ++p) {
      for (let y = 0, i = 0; y < height; ++y) {
        for (let x = 0; x < width; ++x, ++i) {
          const zigzag = (bytes[p * count + i] << 8) | bytes[low + p * count + i];
          const left = x ? plane[i - 1] : 0, above = y ? plane[i - width] : 0;
          const off = (zigzag >>> 1) ^ -(zigzag & 1);
          plane[i] = ((off + ((left + above) >> 1)) << 16) >> 16; // planes have 16 bits
          codes[3 * i + place[p]] = plane[i] + (p ? codes[3 * i + 1] : 0); // in 16 bits again
        }
      }
    }
    return codes;
  }

  // The colour, 0 to 255, of every half float at an exposure: clipped, then the sRGB curve.
  function displayed(exposure) {
    return Uint8ClampedArray.from(LINEAR, (value) => srgb(value * exposure));
  }

  function srgb(linear) {
    const v = Math.min(Math.max(linear, 0), 1);
    return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
  }

  return { LINEAR, inflated, radiance, displayed, srgb };
})();
