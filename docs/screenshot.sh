#!/usr/bin/env bash
# Makes docs/report.png, the picture in the README, from a report. Needs Chromium.
# Usage: docs/screenshot.sh [reports/out/report.html]
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
page=$(realpath "${1:-$here/../reports/out/report.html}")
profile=$(mktemp -d)
trap 'rm -rf "$profile"' EXIT
chromium --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --hide-scrollbars --user-data-dir="$profile" \
    --window-size=1280,960 --virtual-time-budget=5000 \
    --screenshot="$(realpath "$here")/report.png" "file://$page" 2>/dev/null
