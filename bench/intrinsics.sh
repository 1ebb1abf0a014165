#!/bin/sh
# intrinsics.sh FILE NAME=PROGRAM... [--small] - builds of intrinsics.c beside each other. make bench-intrinsics runs it.
# Writes CSV to FILE and to stdout: for each workload and build the median of the processor's milliseconds in nine rounds, in each of
# which all builds run one after the other; the median of its ratios to the first build in the same round; likewise instructions, in
# millions, of the whole program, where perf or valgrind counts them. All builds must find the same topology.
# --small: one round, nothing counted
set -u
file=$1
shift
rounds=9
count=
if perf stat -x, -e instructions:u true 2>&1 | grep -q '^[0-9][0-9]*,'; then count=perf
elif command -v valgrind >/dev/null 2>&1; then count=valgrind; fi
names=
for argument in "$@"; do
    case $argument in
    --small) rounds=1 count= ;;
    *) names="$names ${argument%%=*}" ;;
    esac
done
program() { # NAME ARGUMENTS...: the program of that name
    for build in "$@"; do
        case $build in "$1="*) echo "${build#*=}" ;; esac
    done
}
instructions() { # PROGRAM WORKLOAD: in millions
    case $count in
    perf) perf stat -x, -e instructions:u "$@" 2>&1 >/dev/null | awk -F, '/instructions/ { printf "%.0f", $1 / 1e6 }' ;;
    valgrind) valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1 >/dev/null | awk '/Collected/ { printf "%.0f", $NF / 1e6 }' ;;
    esac
}

: >"$file.runs"
: >"$file.counts"
for workload in step contact cut boolean; do
    for round in $(seq $rounds); do
        for name in $names; do
            said=$("$(program "$name" "$@")" "$workload") || exit 1
            echo "$workload $name $round $said" >>"$file.runs"
        done
    done
    for name in $names; do echo "$workload $name $(instructions "$(program "$name" "$@")" "$workload")" >>"$file.counts"; done
done
if [ "$(awk '{ print $1, $5 }' "$file.runs" | sort -u | wc -l)" -ne 4 ]; then
    echo "$0: topologies differ: $file.runs" >&2
    exit 1
fi
awk '
    function median(list,    part, n, i, j, x) {
        n = split(list, part, " ")
        for (i = 2; i <= n; i++) for (j = i; j > 1 && part[j - 1] + 0 > part[j] + 0; j--) { x = part[j]; part[j] = part[j - 1]; part[j - 1] = x }
        return (part[int((n + 1) / 2)] + part[int((n + 2) / 2)]) / 2
    }
    FILENAME ~ /counts$/ { if (!($1 in base)) base[$1] = $3; number[$1, $2] = $3; next }
    { key = $1 SUBSEP $2 }
    !(key in times) { order[++rows] = key }
    { if (!(($1, $3) in first)) first[$1, $3] = $4; times[key] = times[key] " " $4; ratios[key] = ratios[key] " " $4 / first[$1, $3] }
    END {
        print "workload,build,ms,ratio,million_instructions,instruction_ratio"
        for (i = 1; i <= rows; i++) {
            key = order[i]
            split(key, part, SUBSEP)
            printf "%s,%s,%.1f,%.2f,%s,%s\n", part[1], part[2], median(times[key]), median(ratios[key]), number[key],
                number[key] != "" ? sprintf("%.2f", number[key] / base[part[1]]) : ""
        }
    }' "$file.counts" "$file.runs" >"$file"
cat "$file"
