#!/usr/bin/env bash
# What `cmake --install` lays down runs by itself, with the sources hidden; a binary without its tables says which are missing,
# where it looked, and what to do.
. "$(dirname "$0")/common.sh"
source=$PWD
real=$(realpath "$build")
needs "$build/pitviper.1 (target manual; not in sanitized builds)" test -f "$build/pitviper.1"
needs "mount name space" unshare -rm bash -c 'mount -t tmpfs none "$1"' _ "$source/etc"
# a component: its list of files is not the one that test_install.sh reads
cmake --install "$build" --component Unspecified --prefix "$tmp/prefix" >"$tmp/said" 2>&1 || fail "cmake --install: $(tail -n 1 "$tmp/said")"

# hidden COMMAND: with an empty folder mounted over the sources' tables, in a name space of its own
hidden() {
    unshare -rm bash -c 'mount -t tmpfs none "$1" && shift && exec "$@"' _ "$source/etc" "$@" >"$tmp/stdout" 2>"$tmp/stderr"
    code=$?
}
cd "$tmp" || exit 1
hidden "$tmp/prefix/bin/pitviper" exercise demo -o "$tmp/demo.pcap"
check "the installed one: exercise demo" [ $code = 0 -a -s "$tmp/demo.pcap" ]
ln -s "$tmp/prefix/bin/pitviper" "$tmp/link" # modules and tables are found beside what it leads to
hidden "$tmp/link" -v replay "${bare[@]}" "${coarse[@]}" "$tmp/demo.pcap" --out "$tmp/out" --size 64x48 --only 0,1 --threads 1 \
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
check "alone, share put beside it, without its module: exit code" [ $code = 1 ]
check "alone: the module is named, and what to install" complained 'module pitviper-exr.so is missing: looked .*copy lib/pitviper'
touch "$tmp/a.tif"
hidden "$tmp/alone/bin/pitviper" terrain import "$tmp/a.tif" -o "$tmp/a.store"
check "alone: what reads rasters is named" complained 'module pitviper-rasters is missing: looked .*copy lib/pitviper'
cp -r "$tmp/prefix/lib" "$tmp/alone/"
for octets in 100 10000; do # a module of which only a part was copied
    head -c $octets "$tmp/prefix/lib/pitviper/pitviper-exr.so" >"$tmp/alone/lib/pitviper/pitviper-exr.so"
    hidden "$tmp/alone/bin/pitviper" replay "${bare[@]}" "${coarse[@]}" "$tmp/demo.pcap" --out "$tmp/out3" --size 64x48 --only 0 --threads 1
    check "a module of $octets octets: exit code" [ $code = 1 ]
    check "a module of $octets octets: is named, with what to do" complained 'pitviper-exr.so.* its module is broken: install the program again'
    check "a module of $octets octets: no picture is begun" [ -z "$(find "$tmp/out3" -type f 2>/dev/null)" ]
done
cp "$tmp/prefix/lib/pitviper/pitviper-exr.so" "$tmp/alone/lib/pitviper/"
hidden "$tmp/alone/bin/pitviper" terrain import "$tmp/a.tif" -o "$tmp/a.store"
check "with lib beside it, it is found" complained 'not recognized as a supported file format'
hidden "$tmp/alone/bin/pitviper" replay "${bare[@]}" "${coarse[@]}" "$tmp/demo.pcap" --out "$tmp/out2" --overwrite --size 64x48 --only 0 --threads 1
check "alone, share and lib put beside it: replay" [ $code = 0 ]
cd "$source" || exit 1
finish
