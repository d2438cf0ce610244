#!/usr/bin/env bash
# Runs the workflow, also after its controller was killed: Snakemake then leaves its lock behind, which is taken away
# where no controller lives. All arguments are Snakemake's; see Snakefile for --config. The folder it is started in holds
# Snakemake's own notes (.snakemake), so start it where the output is.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
mkdir -p .snakemake
exec 9> .snakemake/controller
if ! flock -n 9; then
    echo "another controller works in this folder; wait for it, or start in another folder" >&2
    exit 7
fi
if compgen -G '.snakemake/locks/*' > /dev/null; then
    snakemake --snakefile "$here/Snakefile" --quiet --unlock "$@" || true
fi
snakemake --snakefile "$here/Snakefile" --rerun-incomplete --rerun-triggers mtime --keep-going "$@"
