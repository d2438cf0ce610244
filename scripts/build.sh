#!/usr/bin/env bash
# Configures and builds the release preset. Extra arguments go to CMake (-DGLOWWORM_WERROR=ON).
set -euo pipefail
cd "$(dirname "$0")/.."

export CCACHE_SLOPPINESS=pch_defines,time_macros
mkdir -p build
if ! cmake --preset release "$@" >build/configure.log 2>&1; then
    cat build/configure.log >&2
    exit 1
fi
cmake --build --preset release
