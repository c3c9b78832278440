#!/usr/bin/env bash
# As test_regress_hostile.sh, with octets turned at more places of each file of a record. labels: deep
PITVIPER_TURNED_ALL=yes exec bash "$(dirname "$0")/test_regress_hostile.sh" "$@"
