#!/bin/sh
# smallest.sh DIRECTORY - what the smallest program with the kernel (smallest.c) takes to compile and its size, alone and with GXFEM_STATIC, which
# leaves out what it does not call. Prints CSV, and writes it to DIRECTORY/smallest.csv: seconds of the processor, best of five, the two ways in
# turn; bytes of the stripped program.
#     CC   the compiler (cc)
set -u
cd "$(dirname -- "$0")/.." || exit 2
[ $# -eq 1 ] || { echo "usage: $0 DIRECTORY" >&2; exit 2; }
mkdir -p "$1" || exit 2
cc=${CC:-cc}
: >"$1/smallest.times"
for run in 1 2 3 4 5; do
    for way in alone static; do
        flag=
        [ $way = static ] && flag=-DGXFEM_STATIC
        # `times` prints the shell's own times, then those of its children: user and system, as 0m2.34s
        spent=$(sh -c "$cc -std=c99 -O2 -s $flag bench/smallest.c -o $1/smallest_$way -lm || exit 1; times") || exit 1
        echo "$spent" | awk -v way=$way 'NR == 2 { split($1, part, "m"); print way, 60 * part[1] + part[2] }' >>"$1/smallest.times"
    done
done
for way in alone static; do
    "$1/smallest_$way" >/dev/null || { echo "$0: $1/smallest_$way failed" >&2; exit 1; }
done
{
    echo "program,compiler,seconds,bytes"
    for way in alone static; do
        awk -v way=$way -v cc="$cc" -v bytes="$(wc -c <"$1/smallest_$way")" '$1 == way && (!n++ || $2 < least) { least = $2 }
            END { printf "%s,%s -O2,%.2f,%d\n", way, cc, least, bytes }' "$1/smallest.times"
    done
} >"$1/smallest.csv"
cat "$1/smallest.csv"
