#!/usr/bin/env bash
# A new Debian 12 with nothing but git, into which this commit is cloned, and in which a command of the README is executed.
#   ci/clean_root.sh run     ci/run.sh; more than 250 MB of packages fetched is an error
#   ci/clean_root.sh cold    the same without a compiler cache: its time is the one that the README states
#   ci/clean_root.sh test    ci/test.sh until its tests start
# With `run` and `test` the compiler cache of this computer is mounted, and ccache installed, if there is one; nothing else is.
# Exit status 77: no mmdebstrap, no right to mount, or not even an empty root can be made here, as without a mirror.
set -euo pipefail
cd "$(dirname "$0")/.."
[[ $# -eq 1 && $1 =~ ^(run|cold|test)$ ]] || { sed -n 2,7p "$0" >&2; exit 2; }
[[ $(id -u) -eq 0 ]] || { echo "skipped: not root"; exit 77; }
command -v mmdebstrap > /dev/null || { echo "skipped: mmdebstrap is not installed"; exit 77; }
unshare --mount --pid --fork mount -t proc proc /proc 2> /dev/null || { echo "skipped: no right to mount"; exit 77; }
fetched_max_mb=250
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
root=$scratch/root

cache=''
if [[ $1 != cold ]] && command -v ccache > /dev/null; then cache=$(ccache --get-config cache_dir); fi
mmdebstrap --quiet --variant=apt --mode=root --include="git${cache:+,ccache}" bookworm "$root" 2> "$scratch/root.log" ||
  { echo "skipped: no clean root can be made here: $(tail -n 1 "$scratch/root.log")"; exit 77; }
echo force-unsafe-io > "$root/etc/dpkg/dpkg.cfg.d/unsafe-io"  # nothing of this root has to survive a loss of power
git clone --quiet --no-hardlinks . "$root/vbar"
git -C "$root/vbar" checkout --quiet --detach "$(git rev-parse HEAD)"

cat > "$root/tmp/run.sh" << 'EOF'
cd /vbar
ci/run.sh
EOF
cp "$root/tmp/run.sh" "$root/tmp/cold.sh"
cat > "$root/tmp/test.sh" << 'EOF'
cd /vbar
ci/test.sh > /tmp/log 2>&1 & test=$!
while kill -0 $test 2> /dev/null; do
  if grep -q '^== tests (' /tmp/log; then cat /tmp/log; exit 0; fi
  sleep 2
done
cat /tmp/log
echo "ci/test.sh ended before its tests"
exit 1
EOF
started=$SECONDS
# A namespace of processes of its own: all of them end with the command.
unshare --mount --pid --fork --kill-child bash -ec '
  mount -t proc proc "$1/proc"
  mount --rbind /dev "$1/dev"
  if [[ -n $2 ]]; then mkdir "$1/ccache"; mount --bind "$2" "$1/ccache"; fi
  exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 CCACHE_DIR=/ccache chroot "$1" /bin/sh -e "/tmp/$3.sh"
' - "$root" "$cache" "$1"

fetched_kb=$((($(find "$root/var/cache/apt/archives" -name '*.deb' -printf '%s+')0) / 1000))
echo "ci/clean_root.sh $1: $((SECONDS - started)) s, $((fetched_kb / 1000)) MB of packages fetched"
if [[ $1 != test ]]; then
  ((fetched_kb <= fetched_max_mb * 1000)) || { echo "ci/run.sh fetches more than $fetched_max_mb MB of packages" >&2; exit 1; }
  for run in sil pil; do [[ -s $root/vbar/runs/ideal_navigation-$run/report.html ]]; done
fi
