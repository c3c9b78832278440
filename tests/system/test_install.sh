#!/usr/bin/env bash
# What `cmake --install` lays down runs by itself, with the sources hidden: the demo, the manual page; a binary without its
# tables says which are missing, where it looked, and what to do.
. "$(dirname "$0")/common.sh"
source=$PWD
real=$(realpath "$build")
[ -f "$build/pitviper.1" ] || { echo "skipped: no $build/pitviper.1 (target manual; not in sanitized builds)"; exit 77; }
cmake --install "$build" --prefix "$tmp/prefix" >"$tmp/said" 2>&1 || fail "cmake --install: $(tail -n 1 "$tmp/said")"
for file in bin/pitviper share/man/man1/pitviper.1 share/pitviper/catalog.csv share/pitviper/ADDING.md \
            include/pitviper_memory.h share/pitviper/examples/read_memory.c share/pitviper/examples/read_memory.py \
            share/pitviper/scenarios/demo.yaml share/pitviper/atmosphere/us1976/visibilities.csv; do
    check "installed: $file" [ -f "$tmp/prefix/$file" ]
done
check "no pictures, figures or scripts" [ -z "$(find "$tmp/prefix/share/pitviper" -name figures -o -name pictures -o -name make)" ]
check "the list that uninstalling goes by" grep -qF "$tmp/prefix/bin/pitviper" "$build/install_manifest.txt"
if command -v man >/dev/null; then
    check "man -M" eval 'man -M "$tmp/prefix/share/man" pitviper 2>/dev/null | grep -q "sensor simulation"'
    check "man -l" eval 'man -l "$build/pitviper.1" 2>/dev/null | grep -q "sensor simulation"'
fi

# hidden COMMAND: with an empty folder mounted over the sources' tables, in a name space of its own
hidden() {
    unshare -rm bash -c 'mount -t tmpfs none "$1" && shift && exec "$@"' _ "$source/etc" "$@" >"$tmp/stdout" 2>"$tmp/stderr"
    code=$?
}
if ! unshare -rm bash -c 'mount -t tmpfs none "$1"' _ "$source/etc" 2>/dev/null; then
    echo "skipped in part: no mount name space"
    finish
fi
cd "$tmp" || exit 1
hidden "$tmp/prefix/bin/pitviper" exercise demo -o "$tmp/demo.pcap"
check "the installed one: exercise demo" [ $code = 0 -a -s "$tmp/demo.pcap" ]
hidden "$tmp/prefix/bin/pitviper" -v replay "${bare[@]}" "${coarse[@]}" "$tmp/demo.pcap" --out "$tmp/out" --size 64x48 --only 0,1 --threads 1 \
    --set terrain.woods=on --set terrain.woods_half_m=100 --set terrain.woods_trees=200
check "the installed one: replay" [ $code = 0 -a "$(frames "$tmp/out")" = 2 ]
check "its tables are its own" eval 'grep -q "table: $tmp/prefix/bin/../share\|table: $tmp/prefix/share/pitviper/catalog.csv" "$tmp/stderr"'
check "and no others" not grep -q "table: $source" "$tmp/stderr"
mkdir -p "$tmp/alone/bin"
cp "$real/pitviper" "$tmp/alone/bin/"
for command in "replay $tmp/demo.pcap" "exercise demo -o $tmp/d.pcap" "model list" "inspect $tmp/demo.pcap"; do
    # shellcheck disable=SC2086
    hidden "$tmp/alone/bin/pitviper" $command
    check "alone: $command: exit code" [ $code = 1 ]
    check "alone: $command: names what is missing" complained 'missing: catalog.csv, materials.csv, .*atmosphere/bands.csv'
    check "alone: $command: and where it looked" complained "looked in $tmp/alone/share/pitviper, $source/etc and "
    check "alone: $command: and what to do" complained 'cmake --install .*PITVIPER_ETC'
done
hidden "$tmp/alone/bin/pitviper" replay --help
check "alone: help needs none" [ $code = 0 ]
hidden "$tmp/alone/bin/pitviper" check --default
check "alone: neither do the defaults" [ $code = 0 ]
cp -r "$tmp/prefix/share" "$tmp/alone/"
hidden "$tmp/alone/bin/pitviper" replay "${bare[@]}" "${coarse[@]}" "$tmp/demo.pcap" --out "$tmp/out2" --size 64x48 --only 0 --threads 1
check "alone, share put beside it: replay" [ $code = 0 ]
# uninstalled as etc/reference/commands.md says
xargs rm -f <"$real/install_manifest.txt"
check "uninstalled" [ -z "$(find "$tmp/prefix" -type f)" ]
cd "$source" || exit 1
finish
