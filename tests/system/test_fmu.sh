#!/usr/bin/env bash
# The seeker as an FMU: its description and its functions as fmpy has them; and tools that repeat a time, go back, give no
# numbers, stop waiting, free without terminating, or are killed: nothing hangs, and no child is left.
. "$(dirname "$0")/common.sh"
judges python3.numpy python3.fmpy python3.pyproj python3.scipy
flight=$(dirname "$0")/../tools/fmu_flight.py
fmu() { python3 "$flight" "$build/pitviper_seeker.fmu" "$@" >"$tmp/stdout" 2>"$tmp/stderr" || { cat "$tmp/stdout"; grep -v ERROR "$tmp/stderr"; return 1; }; }

cd "$tmp" || exit 1
case $build in /*) ;; *) build=$OLDPWD/$build ;; esac
case $flight in /*) ;; *) flight=$OLDPWD/$flight ;; esac
check "the description and the functions" fmu describe
check "manners" fmu manners "$tmp"
check "what went wrong is said" grep -q 'fmu_ig: it is enough' "$tmp/stdout" "$tmp/stderr"
finish
