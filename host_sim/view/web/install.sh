#!/usr/bin/env bash
# Fetches three.js, uPlot and esbuild into build/view, as package-lock.json lists them with their checksums. Safe to run again.
# A build that is configured afterwards contains the page that `vbar view` writes.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
to="$here/../../../build/view"
mkdir -p "$to"
cmp -s "$here/package-lock.json" "$to/package-lock.json" && [[ -e "$to/node_modules/.package-lock.json" ]] && exit 0
cp "$here/package.json" "$here/package-lock.json" "$here/.npmrc" "$to/"
npm ci --prefix "$to" --loglevel=error
