#!/usr/bin/env bash
# A program built without SDL2: it compiles without a warning, links with all that others need of it, and refuses projector.band in words
# that say what to install.
. "$(dirname "$0")/common.sh"
objects=$build/CMakeFiles/sensor.dir
needs "$objects (built by make or ninja)" test -d "$objects/sensor/publish/projector"
without() { # without SOURCE OBJECT
    "${CC:-cc}" -std=gnu17 -D_GNU_SOURCE -DPITVIPER_VERSION='"0"' -Wall -Wextra -Werror -I. -Ietc/include -c "$1" -o "$2"
}
defined() { nm --defined-only -g "$@" | awk 'NF == 3 { print $3 }' | sort -u; }
for source in sensor/publish/projector/display_window.c sensor/settings/projector_choice.c; do
    check "$source compiles" without $source "$tmp/without.o"
    check "$source has the same functions" [ "$(defined "$tmp/without.o")" = "$(defined "$objects/$source.o")" ]
    check "$source says what to install" grep -q 'built without SDL2; install libsdl2-dev' "$tmp/without.o"
done
run --verbose --version
check "the version says what it was built with" [ "$(grep -c '^frames on a display (SDL2): yes' "$tmp/stdout")" = "$(has_projector >/dev/null 2>&1 && echo 1 || echo 0)" ]
libraries() { ldd "$1" | grep -c SDL; }
check "the program itself is linked without SDL2" [ "$(libraries "$pitviper")" = 0 ]
finish
