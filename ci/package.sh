#!/usr/bin/env bash
# The Debian package of the programs, installed into a root with nothing but Debian's essential packages, where a mission is flown from
# another folder. usage: ci/package.sh [--keep FOLDER]
# Packages what build/host installs, and build/zynq if it is there; both must be built.
# Exit status 77: no mmdebstrap, no right to mount, or not even an empty root can be made here, as without a mirror.
set -euo pipefail
cd "$(dirname "$0")/.."
[[ $# -eq 0 || ( $# -eq 2 && $1 == --keep ) ]] || { sed -n 2,5p "$0" >&2; exit 2; }
[[ $(id -u) -eq 0 ]] || { echo "skipped: not root"; exit 77; }
command -v mmdebstrap > /dev/null || { echo "skipped: mmdebstrap is not installed"; exit 77; }
unshare --mount mount -t proc proc /proc 2> /dev/null || { echo "skipped: no right to mount"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cpack --config build/host/CPackConfig.cmake -B "$scratch/package" > "$scratch/cpack.log" 2>&1 || { cat "$scratch/cpack.log" >&2; exit 1; }
package=$(find "$scratch/package" -maxdepth 1 -name '*.deb' -print -quit)
dpkg-deb --field "$package" Package Version Installed-Size Depends
[[ $# -eq 2 ]] && cp "$package" "$2/"

# --include takes the package's dependencies from the mirror with it.
mmdebstrap --quiet --variant=essential --mode=root --include="$package" --setup-hook="mkdir -p \"\$1\$(dirname $package)\"" \
  --setup-hook="cp $package \"\$1$package\"" bookworm "$scratch/root" 2> "$scratch/root.log" ||
  { if ! mmdebstrap --quiet --variant=essential --mode=root bookworm "$scratch/empty" 2> "$scratch/empty.log"; then
      echo "skipped: no clean root can be made here: $(tail -n 1 "$scratch/empty.log")"; exit 77; fi
    cat "$scratch/root.log" >&2; exit 1; }
# The program finds its data by /proc/self/exe.
cat > "$scratch/root/tmp/fly.sh" << 'END'
cd /tmp
vbar --version
vbar run experiment3 --quiet --out /tmp/run
grep -o '"commands_sha256": "[0-9a-f]*"' /tmp/run/summary.json
END
unshare --mount sh -ec 'mount -t proc proc "$1/proc"; exec chroot "$1" /bin/sh -e /tmp/fly.sh' - "$scratch/root" | tee "$scratch/flown"
# The bits of the build that was packaged.
build/host/vbar run experiment3 --quiet --out "$scratch/here"
grep -qF "$(grep -o '"commands_sha256": "[0-9a-f]*"' "$scratch/here/summary.json")" "$scratch/flown"
echo "installed and flown in a clean root"
