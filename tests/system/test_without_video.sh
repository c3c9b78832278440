#!/usr/bin/env bash
# A program built without FFmpeg's libraries links: what other files need of sensor/publish/video/, video_absent.c has.
. "$(dirname "$0")/common.sh"
objects=$build/CMakeFiles
needs "$objects/sensor.dir (built by make or ninja)" test -d "$objects/sensor.dir/sensor/publish/video"

"${CC:-cc}" -std=gnu17 -D_GNU_SOURCE -I. -Ietc/include -c sensor/publish/video/video_absent.c -o "$tmp/absent.o"
check "it compiles" [ $? = 0 ]
defined() { nm --defined-only -g "$@" | awk 'NF == 3 { print $3 }' | sort -u; }
mapfile -t video < <(find "$objects/sensor.dir/sensor/publish/video" -name '*.o' | sort)
mapfile -t others < <(find "$objects/sensor.dir" "$objects/pitviper.dir" -name '*.o' -not -path '*/publish/video/*' | sort)
defined "${video[@]}" >"$tmp/video"
nm -u "${others[@]}" | awk 'NF == 2 { print $2 }' | sort -u | comm -12 - "$tmp/video" >"$tmp/needed"
check "others need some of it" [ -s "$tmp/needed" ]
missing() { comm -23 "$tmp/needed" <(defined "$1"); }
check "all of it is there; missing: $(missing "$tmp/absent.o" | tr '\n' ' ')" [ -z "$(missing "$tmp/absent.o")" ]

# its twin: one function less
sed '/^Status video_hosts_check/,/^}/d' sensor/publish/video/video_absent.c >"$tmp/less.c"
"${CC:-cc}" -std=gnu17 -D_GNU_SOURCE -I. -Ietc/include -c "$tmp/less.c" -o "$tmp/less.o"
check "its twin is noticed" [ "$(missing "$tmp/less.o")" = video_hosts_check ]
finish
