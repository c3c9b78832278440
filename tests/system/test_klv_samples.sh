#!/usr/bin/env bash
# The readers of test_klv.sh themselves, on packets that others made. labels: small
. "$(dirname "$0")/common.sh"
needs_data klv/st0903-jmisb.bin
judges python3.klvdata python3.stanag4609 python3.tstrans

check "the standard's example and samples of ST 0903" python3 tests/system/klv_test.py samples "$data/klv"
finish
