#!/bin/sh
# Runs the study of a flock's phases and draws the picture of docs/studies.md anew: docs/make-phases.sh [SKEIN]
# Half a minute on two processors; what was broken off goes on in out/phases.
set -u
cd "$(dirname "$0")/.." || exit 1
"${1:-build/skein}" study scenes/studies/flock_phases.json --out out/phases || exit 1
cp out/phases/plot.png docs/images/flock_phases.png
