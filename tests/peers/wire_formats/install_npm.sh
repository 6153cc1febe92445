#!/usr/bin/env bash
# Fetches the npm packages that the peer tests compare with into build/peers. Safe to run again.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
to="$here/../../../build/peers"
mkdir -p "$to"
if ! cmp -s "$here/package.json" "$to/package.json" || [[ ! -d "$to/node_modules/cobs" ]]; then
  cp "$here/package.json" "$to/package.json"
  npm install --prefix "$to" --no-package-lock --no-audit --no-fund --ignore-scripts --loglevel=error
fi
if ! cmp -s "$here/../mcap/package-lock.json" "$to/mcap/package-lock.json" || [[ ! -e "$to/mcap/node_modules/.package-lock.json" ]]; then
  mkdir -p "$to/mcap"
  cp "$here/../mcap/package.json" "$here/../mcap/package-lock.json" "$here/../mcap/.npmrc" "$to/mcap/"
  npm ci --prefix "$to/mcap" --loglevel=error
fi
