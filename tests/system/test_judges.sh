#!/usr/bin/env bash
# What `etc/setup --tests` installs is here, in the versions of tests/judges.txt: also programs that tests in C call, which leave
# out a part without them.
. "$(dirname "$0")/common.sh"
judges python3 osgconv gdallocationinfo gdaltransform python3.numpy

cat >"$tmp/versions.py" <<'PY'
import importlib.metadata, re, sys
pins = re.findall(r"^([\w.-]+)==(\S+)", open(sys.argv[1]).read(), re.M)
def version(name):
    try: return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError: return "absent"
wrong = [f"{name} is {version(name)}, not {pin}" for name, pin in pins if version(name) != pin]
print("\n".join(wrong))
sys.exit(bool(wrong) or len(pins) < 20)
PY
check "build/judges is that of tests/judges.txt: etc/setup --tests" python3 "$tmp/versions.py" tests/judges.txt
sed 's/^numpy==.*/numpy==1.0/' tests/judges.txt >"$tmp/other.txt"
check "its twin: another version is noticed" not quiet python3 "$tmp/versions.py" "$tmp/other.txt"
finish
