"""Rewrite constants.toml from the spectra beside it."""

from scenes.optics import CONSTANTS, HEADER, derive, substances

text = HEADER
for name in substances():
    entry = derive(name)
    text += f"\n[{name}]\n"
    text += "".join(f"{key} = {entry[key]}\n" for key in ("eta", "k", "f0"))
    text += f'metal = {str(entry["metal"]).lower()}\nsource = "{entry["source"]}"\n'
CONSTANTS.write_text(text, encoding="utf-8")
