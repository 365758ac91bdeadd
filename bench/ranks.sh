#!/bin/sh
# How a flock scales over ranks: bench/ranks.sh [BIRDS [FRAMES [TIMES [MOST_RANKS]]]]
# scenes/birds.json with so many birds at the density of a million in 600 x 100 x 600 m, one thread a rank: strong scaling (the
# same flock over 1, 2, 4 ... ranks, as many as there are processors), weak (as many birds for each rank), and apart (so many runs
# at once that have nothing to do with each other: more these processors cannot), the least of so many TIMES, without the start;
# and a model fitted to that, of 10^9 birds on 64 machines. The tables of docs/machines.md come from here. The first
# lines say how busy the machine was: leave it alone while it runs. More ranks than processors say something about bits alone.
set -u
cd "$(dirname "$0")/.." || exit 2
birds=${1:-400000} frames=${2:-60} times=${3:-5} most=${4:-$(getconf _NPROCESSORS_ONLN)} skein=${SKEIN:-build/skein}
command -v mpirun >/dev/null || { echo "ranks.sh: mpirun is missing: 'tools/setup build' installs it" >&2; exit 2; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_ALLOW_RUN_AS_ROOT OMPI_ALLOW_RUN_AS_ROOT_CONFIRM

# value NAME: a number of the report, or 0
value() {
    sed -n "s/^ *\"$1\": *\\([-0-9.e+]*\\),*\$/\\1/p" "$folder/out/report.json" | head -n 1 | grep . || echo 0
}

# measure RANKS BIRDS: seconds a step, share of exchange, imbalance, bytes a step, most birds and most others of a rank
measure() {
    spread=$(awk -v n="$2" 'BEGIN { f = (n / 1e6) ^ (1 / 3); printf "[%.6g,%.6g,%.6g]", 600 * f, 100 * f, 600 * f }')
    try=0
    while [ $try -lt "$times" ]; do
        set -- "$1" "$2" "$skein" run scenes/birds.json --set bodies.0.side=0 --set "bodies.0.count=$2" --set \
            "bodies.0.spread=$spread" --set 'output=[]' --frames "$frames" --threads 1 --quiet --out "$folder/out"
        ranks=$1 count=$2
        shift 2
        [ "$ranks" = 1 ] || set -- mpirun --oversubscribe -n "$ranks" "$@"
        "$@" >"$folder/said" 2>&1 || { cat "$folder/said" >&2; exit 2; }
        ms=$(awk -v all="$(value run_seconds)" -v start="$(value start_seconds)" -v n="$frames" 'BEGIN { print 1000 * (all - start) / n }')
        echo "$ranks $count $ms $(value exchange_share) $(value imbalance) $(value bytes_per_step)" \
            "$(value most_own) $(value most_seen)"
        set -- "$ranks" "$count"
        try=$((try + 1))
    done | sort -g -k 3 | head -n 1
}

# apart PROCESSES BIRDS: the same of as many runs at once that have nothing to do with each other: what these processors can
apart() {
    spread=$(awk -v n="$2" 'BEGIN { f = (n / 1e6) ^ (1 / 3); printf "[%.6g,%.6g,%.6g]", 600 * f, 100 * f, 600 * f }')
    try=0
    while [ $try -lt "$times" ]; do
        process=0
        while [ $process -lt "$1" ]; do
            "$skein" run scenes/birds.json --set bodies.0.side=0 --set "bodies.0.count=$2" --set "bodies.0.spread=$spread" \
                --set 'output=[]' --frames "$frames" --threads 1 --quiet --out "$folder/apart-$process" &
            process=$((process + 1))
        done
        wait
        sed -n 's/^ *"ms_per_step": *\([-0-9.e+]*\),*$/\1/p' "$folder"/apart-*/report.json | sort -g | tail -n 1
        rm -rf "$folder"/apart-*
        try=$((try + 1))
    done | sort -g | head -n 1 | sed "s/.*/$1 $2 & 0 0 0 $2 0/"
}

: >"$folder/table"
echo "load $(cut -d' ' -f1 /proc/loadavg) of $(getconf _NPROCESSORS_ONLN) processors; $birds birds, $frames steps, the least of $times"
ranks=1
while [ $ranks -le "$most" ]; do
    measure $ranks "$birds" | sed 's/^/strong /' >>"$folder/table"
    [ $ranks = 1 ] || apart $ranks "$birds" | sed 's/^/apart /' >>"$folder/table"
    [ $ranks = 1 ] || measure $ranks $((birds * ranks)) | sed 's/^/weak /' >>"$folder/table"
    ranks=$((ranks * 2))
done
awk '
BEGIN { print "| | ranks | birds | ms a step | as fast | exchange | imbalance | kB a step | others a rank sees |\n|---|---|---|---|---|---|---|---|---|" }
{
    if ($2 == 1) one = $4 / 1000
    if ($1 == "apart") alone[$2] = $4 / 1000 / $3 # s a bird, where all processors are at work
    fast = one * ($1 != "strong" ? $2 : 1) / ($4 / 1000)
    printf "| %s | %d | %d | %.1f | %.2f | %.1f %% | %.1f %% | %.0f | %d |\n", $1, $2, $3, $4, fast, 100 * $5, 100 * $6, $7 / 1000, $9
    if ($2 == 1) a = one / $3
    else if ($1 != "apart") { waits += $5 * $4 / 1000; bytes += $7 / $2; uneven += $6; runs++; own[runs] = $8; seen_by[runs] = $9; worked[runs] = $4 / 1000 * (1 - $5); of[runs] = $2 }
}
END {
    if (!runs) exit
    for (i = 1; i <= runs; i++) { extra += worked[i] - alone[of[i]] * own[i]; all += seen_by[i]; a = alone[of[i]] }
    k = waits / bytes; g = all && extra > 0 ? extra / all : 0
    printf "\na bird %.3g us with all processors at work, one that is seen %.3g us, a byte that is sent %.3g ns of exchange and waiting\n", 1e6 * a, 1e6 * g, 1e9 * k
    n = 1e9 / 64; seen = 6 * 1.5 * (3 * 30 / (4 * 3.14159265)) ^ (1 / 3) * n ^ (2 / 3)
    work = a * n * 1.1 + g * seen; sends = 28 * seen * k; wire = 28 * seen * 8 / 1e10
    if (wire > sends) sends = wire
    printf "10^9 birds on 64 machines of one such processor: %.3g million each, %.2g million others seen, %.3g MB; %.3g s a step, %.1f %% of it exchange, %.0f times one machine\n",
        n / 1e6, seen / 1e6, 28 * seen / 1e6, work + sends, 100 * sends / (work + sends), a * 1e9 / (work + sends)
}' "$folder/table"
