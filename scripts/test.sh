#!/usr/bin/env bash
# Installs what is needed, builds the release preset and runs every test.
# Tests on real scans take their folder from GLOWWORM_DATA and are skipped, saying so, without it.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh
scripts/build.sh
ctest --preset release -j "$(nproc)" "$@"
