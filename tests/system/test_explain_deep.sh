#!/usr/bin/env bash
# `pitviper explain` for pixels of all kinds, sensors with raw counts, lateral colour, and another table: test_explain.sh, whole.
# labels: deep
whole=true . "$(dirname "$0")/test_explain.sh"
