# program.sh - shared by the tests of the examples' programs. Sourced: . program.sh PROGRAM enters an empty folder, which is removed
# at the end.
#     $program            the program's path
#     $passed, $failed    tests so far
#     check NAME WHY      counts a test, which failed if WHY is not empty
set -u
[ $# -eq 1 ] || { echo "usage: $0 PATH/TO/PROGRAM" >&2; exit 2; }
case $1 in /*) program=$1 ;; *) program=$(pwd)/$1 ;; esac
[ -x "$program" ] || { echo "$0: $1 is not a program" >&2; exit 2; }
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
trap 'exit 2' HUP INT TERM
cd "$work" || exit 2
passed=0
failed=0

check() {
    if [ -z "$2" ]; then passed=$((passed + 1)); else failed=$((failed + 1)); echo "FAILED $1: $2"; fi
}
