#!/usr/bin/env bash
# publish.exr_bits: floats of EXR files rounded to so many bits of mantissa, in less room; hashes stay those of the whole values. An
# independent reader compares the files.
. "$(dirname "$0")/common.sh"
judges python3.OpenEXR python3.numpy
exercise demo "$tmp/demo.pcap"
bare=("${quick[@]}")
few=(--from 1366 --to 1366 --bands lwir,optical --set exercise.host=observer)
replay "$tmp/demo.pcap" "$tmp/whole" "${few[@]}"
replay "$tmp/demo.pcap" "$tmp/eleven" "${few[@]}" --set publish.exr_bits=11
check "same hashes" same_hashes "$tmp/whole" "$tmp/eleven"
cat >"$tmp/judge.py" <<'PY'
import sys, glob, numpy as np, OpenEXR
whole, rounded = sys.argv[1:]
largest = 0
for path in sorted(glob.glob(whole + "/frames/*/*.exr")):
    a, b = OpenEXR.File(path).channels(), OpenEXR.File(path.replace(whole, rounded)).channels()
    assert a.keys() == b.keys(), path
    for name in a:
        x, y = a[name].pixels, b[name].pixels
        if x.dtype != np.float32: assert (x == y).all(), (path, name); continue
        assert (np.isfinite(x) == np.isfinite(y)).all() and (x[~np.isfinite(x)].tobytes() == y[~np.isfinite(x)].tobytes())
        f = np.isfinite(x) & (x != 0)
        off = np.abs(y[f].astype(float) / x[f] - 1).max() if f.any() else 0
        assert off <= 2.0 ** -12, (path, name, off)
        assert not (y.view(np.uint32)[np.isfinite(y)] & 0xfff).any(), (path, name)
        largest = max(largest, off)
assert largest > 2.0 ** -13, largest
PY
check "each value within half a step" python3 "$tmp/judge.py" "$tmp/whole" "$tmp/eleven"
check "not the whole values" not python3 "$tmp/judge.py" "$tmp/whole" "$tmp/whole" 2>/dev/null
octets() { cat "$1"/frames/*/*.exr | wc -c; }
check "in less than half of the room" [ $((2 * $(octets "$tmp/eleven"))) -lt "$(octets "$tmp/whole")" ]
finish
