#!/bin/sh
# Writes docs/performance.md from the kept runs of the benchmark, bench/results/*.csv, and what others have published:
#     docs/make-performance.sh >docs/performance.md
set -u
cd "$(dirname "$0")/.." || exit 1

rows() { # FILE: a table row for each line of the kept file
    awk '
        function split_line(line,   n, k, c, quoted) { # fields in quotes may have commas
            n = 1; field[1] = ""
            for (k = 1; k <= length(line); k++) {
                c = substr(line, k, 1)
                if (c == "\"") quoted = !quoted
                else if (c == "," && !quoted) field[++n] = ""
                else field[n] = field[n] c
            }
            return n
        }
        /^#/ || /^case,/ { next }
        {
            split_line($0)
            ratio = field[7] == "" ? "" : field[7] (field[8] == "faster" ? " times as fast" : " times as long")
            bar = field[9] == "" ? "" : field[9] (field[10] == "yes" ? ": reached" : ": not reached")
            printf "| %s | %s | %s %s | %s | %s | %s |\n", field[1], field[2], field[3], field[4], \
                field[6] == "" ? "" : field[6] " " field[5], ratio, bar
        }' "$1"
}

cat <<'HEAD'
# Performance

Made by `docs/make-performance.sh >docs/performance.md` from the runs kept in `bench/results`; do not edit it by hand. What each
case does, who stands beside it and how it is timed is in [bench/README.md](../bench/README.md). `build/skein_bench` gives the same table for
your machine, and that is the one to decide by.

## Measured side by side

Each number here was timed in one process with what stands beside it, in turns, medians of five blocks, on a machine that did
nothing else. Times are of one thread unless it says otherwise.
HEAD
for file in bench/results/*.csv; do
    printf '\n### %s\n\n' "$(sed -n 's/^# processor: //p' "$file")"
    sed -n 's/^# \(compiler\|Skein\|Bullet\|ADOL-C\): /\1 /p' "$file" | paste -sd ';' | sed 's/;/; /g; s/$/./'
    printf '\n| case | size | Skein | beside it | ratio | bar |\n|---|---|---|---|---|---|\n'
    rows "$file"
done
cat <<'TAIL'

Cases that are newer than that run, and what they came to on other machines: the table and the text below it in
[bench/README.md](../bench/README.md). Writing 120 frames of a cloth of 100 x 100 (`skein_bench clips`) on an AMD EPYC of
two processors on which a dozen other programs ran: PC2 80 ms, MDD 72 ms, HDF5 126 ms, GLB 0.59 s, PLY 0.75 s, STL 0.79 s (a file for each frame of
the last two), OBJ 6.2 s and USD as text 6.2 s.

## Published by others, not measured side by side

Other machines, other scenes, other accuracy: these say which order of magnitude to expect, and not who is faster. In the right column is what
Skein takes for what comes nearest.

| who | what, as they say | they say | Skein, nearest |
|---|---|---|---|
| Zhang 2024 [1] | cloth of 35 x 35, 32 iterations a frame, a laptop | XPBD in Unity: 52.2 ms on the main thread, 2.2 ms with jobs and Burst; PBD 70.9 and 2.1; semi-implicit Euler in C++ 12.2 | 0.59 ms a frame: XPBD, 35 x 35, one substep of 32 iterations with all of a default cloth's constraints, one thread of an AMD EPYC, the least of five runs of 120 frames on a busy machine |
| Unity's own cloth, as measured by [1] | the same cloth | 0.2 ms | the same |
| Sung et al. 2025 [2] | mass and springs by WebGPU, on a graphics card | 640,000 nodes at 60 frames a second | 59.8 ns a particle and frame at 10^6 (10 substeps, one thread, table above): 38 ms for 640,000 |
| Lohr [3] | a flock of 1,024 by fragment shaders, GeForce 9600 GT | 140 frames a second, drawing included | 0.18 ms a step of the 1,024 birds of `scenes/birds.json` without drawing, the same thread, the least of five runs |
| MuJoCo 3.14 [4] | its `drape.xml`, 507 vertices with self-contact, a step of 2 ms | at least 27 ms a step, as the benchmark's README has it | 0.092 ms a step, the same drape in kind |

1. Ayin Zhang, *Unity Physics Simulation Method Environment Hodgepodge*, 2024:
   <https://ayinzhang.github.io/en/2024/11/25/2024-11-26-Unity%20Physics%20Simulation%20Method%20Environment%20Hodgepodge> (35 x 35 grid,
   stiffness 2000, 32 iterations, GTX 1650 laptop; "the specific values don't make much sense, but it's still okay to look at the trend").
2. N.-J. Sung, J. Ma, T. Kim, Y. Choi, M.-H. Choi, M. Hong, *Real-Time Cloth Simulation Using WebGPU: Evaluating Limits of High-Resolution
   Cloth Model*, 2025: <https://arxiv.org/abs/2507.11794>, the abstract.
3. C. Lohr, a film of a flock on a GeForce, with these words beside it: <https://www.youtube.com/watch?v=V7NvoJs_R6M>.
4. MuJoCo: <https://mujoco.readthedocs.io>; the case `broad` of the benchmark, which says what of it is the same.

Papers whose methods are used here have timings, too, of other hardware: see the [sources](methods.md#sources).
TAIL
