#!/bin/sh
# Lines and branches of the headers that test programs have reached, counted once over all programs. `make coverage` builds and
# runs those with gcc --coverage, then calls this.
# usage: sh tests/coverage.sh FOLDER [LINES BRANCHES]
#     FOLDER            where the programs are; results go there too:
#                         coverage.txt   the table that is printed
#                         functions.txt  per function, what is not reached, most first
#                         unreached.txt  each line and branch that is not reached, and why
#                         rows.txt       rows for those that have none, without their reasons
#     LINES, BRANCHES   fails below these percentages (98, 92)
#     GCOV              gcov of the compiler that was used (gcov)
#     REASONS           why something is not reached (tests/unreached.txt)
#
# Programs that include the headers hold copies of the same functions. gcov counts each program; here the counts of a line, and of
# its branches in their order, are added up. A branch is one way out of a decision: an `if` has two, and each && or || two more.
#
# A line or branch that is not reached must be named in tests/unreached.txt, by a row
#     FUNCTION | TEXT | REASON
# FUNCTION is a name, several names, or * for any. TEXT is a piece of the line, or * for any. A piece that stands in one part of a
# condition of && and || names the branches of that part only, if the line is that condition and no more. The first row that fits
# counts. A row of which a function fits nothing is a failure too, so the file stays true.
set -u
[ $# -ge 1 ] || { echo "usage: $0 FOLDER [LINES BRANCHES]" >&2; exit 2; }
folder=$1
tests=$(dirname -- "$0")
GCOV=${GCOV:-gcov}
LC_ALL=C
export LC_ALL

find "$folder" -name '*.gcda' | sort >"$folder/programs"
[ -s "$folder/programs" ] || { echo "$0: no program with counts in $folder" >&2; exit 2; }
while read -r counts; do
    "$GCOV" -b -c -t "$counts" 2>/dev/null || { echo "$0: gcov fails at $counts" >&2; exit 2; }
done <"$folder/programs" >"$folder/counts" || exit 2

awk -v folder="$folder" -v reasons="${REASONS:-$tests/unreached.txt}" -v least_lines="${2:-98}" -v least_branches="${3:-92}" \
    -v programs="$(wc -l <"$folder/programs")" -f "$tests/coverage.awk" "$folder/counts"
