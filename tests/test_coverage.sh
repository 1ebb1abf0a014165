#!/bin/sh
# tests/coverage.sh can fail: counts of two made-up functions, with files of reasons that are right, lack a row, or have one too many.
# usage: sh tests/test_coverage.sh
set -u
tests=$(cd "$(dirname -- "$0")" && pwd) || exit 2
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
trap 'exit 2' HUP INT TERM
passed=0
failed=0

cat >"$work/gcov" <<'END'
#!/bin/sh
cat <<'COUNTS'
        -:    0:Source:gxfem.h
function gxp_first called 1 returned 100% blocks executed 50%
        1:    1:static int gxp_first(int a, int b) {
        1:    2:    if (a > 0 && b < 9) return 1;
branch  0 taken 1 (fallthrough)
branch  1 taken 0
branch  2 taken 0
branch  3 taken 1
        1:    3:    return a > 5 ? 2 : gxp_second(b);
branch  0 taken 0 (fallthrough)
branch  1 taken 1
        -:    4:}
function gxp_second called 1 returned 100% blocks executed 50%
        1:    5:static int gxp_second(int b) {
        1:    6:    if (b < 9) return 0;
branch  0 taken 1 (fallthrough)
branch  1 taken 0
    #####:    7:    return 3;
        -:    8:}
        -:    0:Source:/usr/include/other.h
    #####:    1:int other(void) { return 0; }
COUNTS
END
chmod +x "$work/gcov"
: >"$work/program.gcda"

cat >"$work/right" <<'END'
# comments and empty lines are passed over

gxp_first | a > 0 | callers ask for more
gxp_first gxp_second | b < 9 | too large for a test
gxp_first | ? | as before
* | return 3 | any function
END

# verdict NAME STATUS TEXT [SED-COMMAND [LINES BRANCHES]]: with the right file changed so, the script must exit so and print the text.
verdict() {
    sed "${4:-}" "$work/right" >"$work/reasons"
    GCOV=$work/gcov REASONS=$work/reasons sh "$tests/coverage.sh" "$work" "${5:-10}" "${6:-10}" >"$work/said" 2>&1
    status=$?
    if [ $status -eq "$2" ] && grep -qF -- "$3" "$work/said"; then passed=$((passed + 1)); else
        failed=$((failed + 1))
        echo "FAILED $1: status $status"
        cat "$work/said"
    fi
}

verdict 'everything is named' 0 'not reached: 1 lines, and 4 branches of others'
verdict 'a line without a row' 1 'gxfem.h:7: gxp_second: line not reached: return 3;' '/return 3/d'
verdict 'a branch without a row' 1 'gxfem.h:6: gxp_second: branch 2 of 2 not taken' 's/ gxp_second / /'
verdict 'a row names one part of a condition' 1 'gxfem.h:2: gxp_first: branch 3 of 4 not taken' 's/^gxp_first gxp_second/gxp_second/'
verdict 'a row that fits nothing' 1 'names what is reached, or not there: gxp_third | b < 9' 's/^gxp_first gxp_second/& gxp_third/'
verdict 'a row behind one that fits more' 1 'names what is reached, or not there: gxp_first | ?' 's/| a > 0 |/| * |/'
verdict 'a row without a reason' 1 'not FUNCTION | TEXT | REASON: * | return 3' 's/ | any function//'
verdict 'too few lines' 1 'fewer than 90 % of the lines are reached' '' 90
verdict 'too few branches' 1 'fewer than 60 % of the branches are reached' '' 10 60
verdict 'nothing is named' 1 'gxfem.h:7: gxp_second: line not reached: return 3;' d
sed 's/$/a reason/' "$work/rows.txt" >"$work/right"
verdict 'the rows that are proposed fit, one each' 0 'not reached: 1 lines, and 4 branches of others'

echo "coverage can fail: $passed passed, $failed failed"
[ $failed -eq 0 ]
