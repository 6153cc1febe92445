#!/usr/bin/env bash
# The portable bundle vbar-VERSION-x86_64.tar.xz: programs, their libraries and loader, data, missions, documents. Unpacked anywhere,
# ./vbar flies on any x86-64 Linux, without installation.
#   ci/bundle.sh             makes it, in build/host
#   ci/bundle.sh --check     makes it elsewhere and flies it in a root with a shell only
#   ci/bundle.sh --check13   the same in a root of Debian 13, whose C library is another
# Bundles what build/host installs, and the image of build/zynq if it is there. Exit status 77: the check cannot be made here.
set -euo pipefail
cd "$(dirname "$0")/.."
check=${1-}
[[ $# -le 1 && ( -z $check || $check == --check || $check == --check13 ) ]] || { sed -n 2,7p "$0" >&2; exit 2; }
# Drivers of displays and cameras and calibrations are not portable: they need the libraries of the computer that they are on.
programs=(vbar vbar_flight vbar_grand_bench)
size_max_mb=60
if [[ -n $check ]]; then
  [[ $(id -u) -eq 0 ]] || { echo "skipped: not root"; exit 77; }
  unshare --mount mount -t proc proc /proc 2> /dev/null || { echo "skipped: no right to mount"; exit 77; }
  if [[ $check == --check ]]; then needed=busybox; else needed=mmdebstrap; fi
  command -v "$needed" > /dev/null || { echo "skipped: $needed is not installed"; exit 77; }
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

version=$(build/host/vbar --version | sed 's/^vbar \([^,]*\),.*/\1/')
name=vbar-$version-x86_64
bundle=$scratch/$name
lib=$bundle/lib/x86_64
cmake --install build/host --prefix "$bundle" --strip > "$scratch/install.log" || { cat "$scratch/install.log" >&2; exit 1; }
[[ ! -f build/zynq/vbar_zynq7000.elf ]] || cmake --install build/zynq --prefix "$bundle" >> "$scratch/install.log"
for program in "$bundle"/bin/*; do
  [[ " ${programs[*]} " == *" ${program##*/} "* ]] || rm "$program"
done
cp -r docs README.md CHANGELOG.md "$bundle/share/vbar/"

osmesa=$(ldconfig -p | sed -n 's/.*libOSMesa\.so\.8 .*x86-64.* => //p' | head -n 1)  # loaded for images
[[ -n $osmesa ]] || { echo "ci/bundle.sh: libOSMesa.so.8 is not installed (ci/install.sh images)" >&2; exit 1; }
# Mesa's rasteriser needs LLVM, and LLVM's other uses need libxml2 with ICU (manifests of Windows) and Z3 (Clang's analyser): a third
# of the bundle. Libraries with the symbols that LLVM names, each of which ends the process, stand in for them.
empty_library() {  # empty_library FILE USER: in $scratch/empty, with the symbols of FILE that USER names
  local name=${1##*/}
  local made=$scratch/empty/$name versions=()
  comm -12 <(nm -D --defined-only --with-symbol-versions "$1" | awk '{ sub("@@", "@", $3); print $3 }' | sort) \
    <(nm -D --undefined-only --with-symbol-versions "$2" | awk '{ print $2 }' | sort) > "$made.symbols"
  [[ -s $made.symbols ]]
  { sed 's/@.*//; s/.*/.globl &\n.type &, @function\n&:/' "$made.symbols"; echo 'ud2'; echo '.section .note.GNU-stack'; } > "$made.s"
  sed -n 's/\(.*\)@\(.*\)/\2 { \1; };/p' "$made.symbols" | sort |
    awk '{ if ($1 != last) { if (last) print "};"; print $1 " {" } last = $1; print $3 } END { if (last) print "};" }' > "$made.map"
  [[ ! -s $made.map ]] || versions=(-Wl,--version-script="$made.map")
  gcc -shared -nostdlib -Wl,-soname,"$name" "${versions[@]}" -o "$made" "$made.s"
}
mkdir "$scratch/empty"
llvm=$(ldd "$osmesa" | sed -n 's/.*libLLVM.* => \([^ ]*\) .*/\1/p')
for library in libxml2.so.2 libz3.so.4; do
  file=$(ldd "$osmesa" | sed -n "s/.*$library => \([^ ]*\) .*/\1/p")
  [[ -z $file ]] || empty_library "$file" "$llvm"
done

# Of a program or library: the files of all its libraries and of the loader.
libraries_of() {
  LD_LIBRARY_PATH=$scratch/empty ldd "$1" | sed -n -e 's/.* => \(\/[^ ]*\) .*/\1/p' -e 's/^[[:space:]]*\(\/[^ ]*\) .*/\1/p'
}
{ echo "$osmesa"; libraries_of "$osmesa"; for program in "${programs[@]}"; do libraries_of "$bundle/bin/$program"; done; } | sort -u > "$scratch/libraries"
mkdir -p "$lib" "$bundle/share/doc"
while read -r file; do
  cp -L "$file" "$lib/"
  [[ $file != "$scratch"/* ]] || continue
  # Debian's list names some files by /lib, others by /usr/lib; the one that it does not know is an error of dpkg-query.
  package=$({ dpkg-query --search "$file" "/usr$file" "${file#/usr}" 2> /dev/null || true; } | head -n 1 | cut -d: -f1)
  cp -Lf "/usr/share/doc/$package/copyright" "$bundle/share/doc/$package.copyright"
done < "$scratch/libraries"
[[ -x $lib/ld-linux-x86-64.so.2 ]]
ci/sbom.py "${programs[@]}" > "$bundle/share/doc/vbar.spdx.json"  # an error if NOTICE lacks a component
cat > "$bundle/vbar" << 'EOF'
#!/bin/sh
# vbar by the loader and the libraries of this folder.
here=$0
if [ -h "$here" ]; then here=$(readlink -f "$here"); fi
case $here in */*) here=${here%/*} ;; *) here=. ;; esac
here=$(cd "$here" && pwd) || exit 1
exec "$here/lib/x86_64/ld-linux-x86-64.so.2" --library-path "$here/lib/x86_64" "$here/bin/vbar" "$@"
EOF
chmod +x "$bundle/vbar"

tar --create --directory "$scratch" --sort=name --owner=0 --group=0 --numeric-owner "$name" |
  xz --threads=1 --x86 --lzma2=preset=6,dict=64MiB > "$scratch/$name.tar.xz"
size=$(stat -c %s "$scratch/$name.tar.xz")
echo "$name.tar.xz: $((size / 1000000)) MB, $(wc -l < "$scratch/libraries") libraries"
if [[ -z $check ]]; then
  mv "$scratch/$name.tar.xz" build/host/
  echo "bundle  build/host/$name.tar.xz"
  exit 0
fi
((size <= size_max_mb * 1000000)) || { echo "ci/bundle.sh: larger than $size_max_mb MB" >&2; exit 1; }

root=$scratch/root
if [[ $check == --check ]]; then
  mkdir -p "$root/bin" "$root/proc" "$root/dev"
  cp "$(command -v busybox)" "$root/bin/sh"
else
  mmdebstrap --quiet --variant=essential --mode=root trixie "$root" 2> "$scratch/root.log" ||
    { echo "skipped: no root of Debian 13 can be made here: $(tail -n 1 "$scratch/root.log")"; exit 77; }
fi
mkdir -p "$root/opt/a folder" "$root/tmp"
tar --extract --xz --file "$scratch/$name.tar.xz" --directory "$root/opt/a folder"
rm -rf "$bundle"

# Images (experiment 1), receivers, the flight software in a process of its own, and a campaign, whose workers are copies of vbar.
printf '[campaign]\nmission = "experiment3"\nseeds = "1..2"\nset = ["mission.duration_h=0.5"]\n' > "$root/tmp/bundled.toml"
cat > "$scratch/flights" << 'EOF'
experiment3 --set mission.duration_h=0.5
experiment1 --set mission.duration_h=0.5
ideal_navigation --set mission.duration_h=1 --set flight_computer.target=host_process
EOF
fly() {  # fly VBAR FOLDER: all flights, by number
  number=0
  while read -r flight; do
    number=$((number + 1))
    "$1" run $flight --quiet --out "$2/$number"
  done < "$3"
}
{ declare -f fly; echo 'vbar="/opt/a folder/'"$name"'/vbar"; "$vbar" --version; cd /tmp; fly "$vbar" /tmp/runs /tmp/flights; "$vbar" campaign run bundled.toml --jobs 1 --out /tmp/campaign'; } > "$root/tmp/fly.sh"
cp "$scratch/flights" "$root/tmp/"
unshare --mount sh -ec 'mount -t proc proc "$1/proc"; mount --rbind /dev "$1/dev"; exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp chroot "$1" /bin/sh -e /tmp/fly.sh' - "$root"

# The bits of the build that was bundled.
fly build/host/vbar "$scratch/here" "$scratch/flights"
hashes() { grep -ohE '"(commands|telemetry)_sha256": "[0-9a-f]{64}"' "$@"; }
[[ $(hashes "$scratch"/here/*/summary.json | wc -l) -eq 6 ]]
diff <(hashes "$scratch"/here/*/summary.json) <(hashes "$root"/tmp/runs/*/summary.json)
echo "flown with the bits of the build"
