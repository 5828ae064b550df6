// The text of a layer: in the page, or in a file beside it that a script element can read.
const loading = {};
globalThis.shadeproof = { layer: (id, text) => loading[id].resolve(text) };
function layerText(id) {
  const element = document.getElementById(id);
  if (element) return element.textContent;
  if (!loading[id]) {
    const promise = new Promise((resolve, reject) => {
      loading[id] = { resolve };
      const script = document.createElement("script");
      script.src = `${document.body.dataset.layers}/${encodeURIComponent(id)}.js`;
      script.onerror = () => reject(new Error(`its file is not in the folder ${document.body.dataset.layers} beside the page`));
      document.head.append(script);
    });
    loading[id].promise = promise;
  }
  return loading[id].promise;
}
