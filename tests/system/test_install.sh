#!/usr/bin/env bash
# What `cmake --install` lays down: all that belongs there and nothing else, the manual page; all of it can be uninstalled. That
# it runs by itself: test_install_alone.sh.
. "$(dirname "$0")/common.sh"
real=$(realpath "$build")
needs "$build/pitviper.1 (target manual; not in sanitized builds)" test -f "$build/pitviper.1"
judges man
cmake --install "$build" --prefix "$tmp/prefix" >"$tmp/said" 2>&1 || fail "cmake --install: $(tail -n 1 "$tmp/said")"
for file in bin/pitviper bin/pitviper-bench lib/pitviper/pitviper-exr.so lib/pitviper/pitviper-images.so lib/pitviper/pitviper-rasters share/man/man1/pitviper.1 share/pitviper/catalog.csv share/pitviper/ADDING.md \
            include/pitviper_memory.h share/pitviper/examples/read_memory.c share/pitviper/examples/read_memory.py \
            share/pitviper/examples/recognise.py share/pitviper/examples/recognise_shape.py share/pitviper/examples/recognise_track.py share/pitviper/examples/recognise_hottest.c \
            share/pitviper/README.md share/pitviper/LICENSE share/pitviper/scenarios/demo.yaml share/pitviper/atmosphere/us1976/visibilities.csv; do
    check "installed: $file" [ -f "$tmp/prefix/$file" ]
done
check "no scripts, no measured tables" [ -z "$(find "$tmp/prefix/share/pitviper" -name make -o -name bench_all.csv)" ]
# every relative link of every installed page, [text](path) and ![text](path), leads to an installed file
links=0
while IFS= read -r page; do
    while IFS= read -r link; do
        links=$((links + 1))
        [ -e "$(dirname "$page")/$link" ] || fail "${page#"$tmp/prefix/"}: its link to $link leads nowhere"
    done < <(grep -oE '\]\([^)]+\)' "$page" | sed -E 's/^\]\(//; s/\)$//; s/#.*//' | grep -vE '^$|://' | sort -u)
done < <(find "$tmp/prefix" -name '*.md')
check "links were looked at" [ $links -gt 40 ]
check "the list that uninstalling goes by" grep -qF "$tmp/prefix/bin/pitviper" "$build/install_manifest.txt"
check "man -M" eval 'man -M "$tmp/prefix/share/man" pitviper 2>/dev/null | grep -q "sensor simulation"'
check "man -l" eval 'man -l "$build/pitviper.1" 2>/dev/null | grep -q "sensor simulation"'
# what takes 0.2 s to load is not loaded by every command: pitviper_library.h
ldd "$tmp/prefix/bin/pitviper" >"$tmp/libraries"
check "libraries loaded on demand are not linked" not grep -E 'OpenImageIO|OpenEXR|gdal|libav|assimp' "$tmp/libraries"
check "others are" grep -q embree "$tmp/libraries"
# uninstalled as etc/reference/commands.md says
xargs rm -f <"$real/install_manifest.txt"
check "uninstalled" [ -z "$(find "$tmp/prefix" -type f)" ]
finish
