#!/usr/bin/env bash
# Fetches the npm packages that the peer tests compare with into build/peers. Safe to run again.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
to="$here/../../../build/peers"
mkdir -p "$to"
cmp -s "$here/package.json" "$to/package.json" && [[ -d "$to/node_modules/cobs" ]] && exit 0
cp "$here/package.json" "$to/package.json"
npm install --prefix "$to" --no-package-lock --no-audit --no-fund --ignore-scripts --loglevel=error
