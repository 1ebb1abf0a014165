#!/bin/sh
# Lines and branches of the headers that test programs have reached, counted once over all programs. `make coverage` builds and
# runs those with gcc --coverage, then calls this.
# usage: sh tests/coverage.sh FOLDER [LINES BRANCHES]
#     FOLDER            where the programs are; results go there too:
#                         coverage.txt   the table that is printed
#                         functions.txt  per function, what is not reached, most first
#                         unreached.txt  each line and branch that is not reached, and why if tests/unreached.txt says so
#     LINES, BRANCHES   fails below these percentages (98, 92)
#     GCOV              gcov of the compiler that was used (gcov)
#
# Programs that include the headers hold copies of the same functions. gcov counts each program; here the counts of a line, and of
# its branches in their order, are added up. A branch is one way out of a decision: an `if` has two, and each && or || two more.
set -u
[ $# -ge 1 ] || { echo "usage: $0 FOLDER [LINES BRANCHES]" >&2; exit 2; }
folder=$1
reasons=$(dirname -- "$0")/unreached.txt
GCOV=${GCOV:-gcov}
LC_ALL=C
export LC_ALL

find "$folder" -name '*.gcda' | sort >"$folder/programs"
[ -s "$folder/programs" ] || { echo "$0: no program with counts in $folder" >&2; exit 2; }
while read -r counts; do
    "$GCOV" -b -c -t "$counts" 2>/dev/null || { echo "$0: gcov fails at $counts" >&2; exit 2; }
done <"$folder/programs" >"$folder/counts"

awk -v folder="$folder" -v reasons="$reasons" -v least_lines="${2:-98}" -v least_branches="${3:-92}" -v programs="$(wc -l <"$folder/programs")" '
    function percent(part, all) { return all == 0 ? 100 : 100 * part / all }

    # Why something is not reached: the reason that tests/unreached.txt gives for the function and the text of the line, or nothing
    function reason_of(name, text, i) {
        for (i = 1; i <= reason_count; i++)
            if ((reason_function[i] == "*" || reason_function[i] == name) && index(text, reason_text[i])) { reason_used[i]++; return reason[i] }
        return ""
    }

    # Notes one unreached line or branch
    function miss(kind, h, n, what, why) {
        why = reason_of(of[h, n], source[h, n])
        if (why != "") named[kind]++
        missed[kind, of[h, n]]++
        sub(/^ +/, "", source[h, n])
        printf "%s:%d: %s: %s: %s%s\n", h, n, of[h, n], what, source[h, n], why == "" ? "" : "   [" why "]" >(folder "/unreached.txt")
    }

    BEGIN {
        header_count = split("gxfem.h gxfem_boolean.h gxfem_integrate.h gxfem_solve.h", headers, " ")
        for (i = 1; i <= header_count; i++) ours[headers[i]] = 1
        while ((getline line <reasons) > 0) {
            if (line ~ /^#/ || line ~ /^ *$/) continue
            if (split(line, field, / \| /) != 3) { print reasons ": not FUNCTION | TEXT | REASON: " line; wrong = 1; continue }
            reason_function[++reason_count] = field[1]
            reason_text[reason_count] = field[2]
            reason[reason_count] = field[3]
        }
    }

    # What gcov prints: "count:line:text" for a line, whose count is - without code and ##### without a visit; before it "function NAME
    # called ..." where one starts; after it "branch N taken COUNT" or "branch N never executed"
    /^ *-: *0:Source:/ { h = $0; sub(/.*[:\/]/, "", h); inside = h in ours; name = ""; next }
    !inside { next }
    /^function / { name = $2; next }
    /^branch / {
        b = branch[h, n] + 0
        branch[h, n] = b + 1
        if (b >= branches[h, n]) branches[h, n] = b + 1
        taken[h, n, b] += $3 == "taken" ? $4 : 0
        next
    }
    /^call / { next }
    /^ *[-#=0-9]+\*?: *[0-9]+:/ {
        split($0, field, ":")
        n = field[2] + 0
        if (n > last[h]) last[h] = n
        branch[h, n] = 0
        if (field[1] ~ /-/) next
        if (!((h, n) in source)) { source[h, n] = substr($0, length(field[1]) + length(field[2]) + 3); of[h, n] = name }
        executed[h, n] += field[1] ~ /[#=]/ ? 0 : field[1] + 0
    }

    END {
        printf "" >(folder "/unreached.txt")
        printf "%-20s %8s %8s %7s   %8s %8s %7s\n", "", "lines", "reached", "%", "branches", "reached", "%" >(folder "/coverage.txt")
        for (i = 1; i <= header_count; i++) {
            h = headers[i]
            lines = reached = ways = ways_taken = 0
            for (n = 1; n <= last[h]; n++) {
                if (!((h, n) in source)) continue
                lines++
                if (executed[h, n] > 0) reached++
                else miss("line", h, n, "line not reached")
                for (b = 0; b < branches[h, n]; b++) {
                    ways++
                    if (taken[h, n, b] > 0) ways_taken++
                    else if (executed[h, n] > 0) miss("branch", h, n, "branch " b + 1 " of " branches[h, n] " not taken")
                    else missed["branch", of[h, n]]++
                }
            }
            printf "%-20s %8d %8d %7.2f   %8d %8d %7.2f\n", h, lines, reached, percent(reached, lines), ways, ways_taken, percent(ways_taken, ways) >(folder "/coverage.txt")
            all_lines += lines; all_reached += reached; all_ways += ways; all_taken += ways_taken
        }
        printf "%-20s %8d %8d %7.2f   %8d %8d %7.2f\n", "all", all_lines, all_reached, percent(all_reached, all_lines), all_ways, all_taken, percent(all_taken, all_ways) >(folder "/coverage.txt")
        printf "%d programs; of what is not reached, tests/unreached.txt names %d lines and %d branches\n", programs, named["line"], named["branch"] >(folder "/coverage.txt")
        close(folder "/coverage.txt")
        for (key in missed) { split(key, field, SUBSEP); functions[field[2]] = 1 }
        for (f in functions) printf "%5d lines %5d branches  %s\n", missed["line", f], missed["branch", f], f | ("sort -k1,1nr -k3,3nr >" folder "/functions.txt")
        close("sort -k1,1nr -k3,3nr >" folder "/functions.txt")
        while ((getline line <(folder "/coverage.txt")) > 0) print line
        for (i = 1; i <= reason_count; i++)
            if (!reason_used[i]) { print "tests/unreached.txt names what is reached, or not there: " reason_function[i] " | " reason_text[i]; wrong = 1 }
        if (percent(all_reached, all_lines) < least_lines) { print "fewer than " least_lines " % of the lines are reached"; wrong = 1 }
        if (percent(all_taken, all_ways) < least_branches) { print "fewer than " least_branches " % of the branches are reached"; wrong = 1 }
        exit wrong
    }' "$folder/counts"
