#!/bin/sh
# Compiles the headers in every way users do, by every compiler and standard there is, and fails on any warning.
# usage: sh tests/compile.sh DIRECTORY [HEADERS]
#     DIRECTORY   for objects and programs; made if needed
#     HEADERS     the folder that the headers are included from; without it, the repository's own
#     COMPILERS   those to try (gcc clang), each with its C++ front end
#     STANDARDS   those to try (c99 c11 c17 gnu99 c++11 c++14 c++17 c++20); c99 and c++11 are linked and run
#     JOBS        the number at a time (2)
#
# - tests/compile/*.c and *.cc: each header alone, all together, twice, implementation before and after plain inclusion
# - two translation units, C and C++ in all four combinations; two files with GXFEM_STATIC
# - a shared library by the user's GXFEM_API: it exports the public functions, no private one, and a program calls it
# - the example in each header's opening comment and the README's program, extracted, compiled and run, the latter as C++ too
# - the snippets of docs/RECIPES.md, as C and C++
# - examples/*.c, if HEADERS is not given
set -u
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit 2
warnings="-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror"

# ---- one job: LABEL COMMAND; silent if it succeeds
if [ "${1-}" = --job ]; then
    if output=$(sh -c "$3" 2>&1); then echo "$2" >>passed; else
        echo "$2" >>failed
        printf 'FAILED %s\n  %s\n%s\n' "$2" "$3" "$(printf '%s\n' "$output" | grep -E 'warning|error|undefined|differs|says' | head -n 12 || true)"
    fi
    exit 0
fi

# ---- what a shared library exports: public functions of each header, nothing private
if [ "${1-}" = --exports ]; then
    nm -D --defined-only "$2" | awk '{ print $NF }' >"$2.names" || exit 1
    for name in gx_body_cut gxb_orient2d gxi_monomial_count gxs_solver_step; do
        grep -qx $name "$2.names" || { echo "$name: undefined in $2"; exit 1; }
    done
    ! grep -E '^gx[bis]?p_' "$2.names" | sed 's/$/: private name exported, an error/' | grep .
    exit
fi

[ $# -eq 1 ] || [ $# -eq 2 ] || { echo "usage: $0 DIRECTORY [HEADERS]" >&2; exit 2; }
headers=$(CDPATH= cd -- "${2:-$root}" && pwd) || exit 2
mkdir -p "$1" && cd "$1" || exit 2
rm -rf ./*
: >passed
: >failed
: >jobs

cxx_of() { case $1 in gcc) echo g++ ;; clang) echo clang++ ;; *) echo "$1++" ;; esac; }

# job LABEL COMMAND: one line each, for xargs
job() { printf '%s\n%s\n' "$1" "$2" >>jobs; }

run_jobs() {
    tr '\n' '\0' <jobs | xargs -0 -P "${JOBS:-2}" -n 2 sh "$root/tests/compile.sh" --job
    : >jobs
}

# The program in a header's opening comment: from the first #define after the words "one minute" to the brace that closes main.
extract_example() {
    awk '
        { line = $0; sub(/^ \* ?/, "", line) }
        tolower(line) ~ /one minute/ { armed = 1 }
        armed && !inside && match(line, /^ *#define/) { inside = 1; indent = RLENGTH - 7 }
        inside { print substr(line, indent + 1) }
        inside && substr(line, indent + 1) == "}" { exit }' "$1"
}

extract_readme() { awk '/^```c$/ { inside = 1; next } /^```/ { if (inside) exit } inside' "$root/README.md"; }

for name in gxfem gxfem_boolean gxfem_integrate gxfem_solve; do extract_example "$root/$name.h" >"example_$name.c"; done
extract_readme >readme.c
{ echo '#define _POSIX_C_SOURCE 200112L'
  for name in math pthread stdio stdlib string time; do echo "#include <$name.h>"; done
  echo '#include "gxfem.h"'
  awk -f "$root/tests/recipes.awk" "$root/docs/RECIPES.md"; } >recipes.c
for file in example_*.c readme.c; do [ -s $file ] || { echo "FAILED no program found for $file"; echo $file >>failed; }; done

compilers=
for cc in ${COMPILERS:-gcc clang}; do
    if command -v "$cc" >/dev/null 2>&1; then compilers="$compilers $cc"; else echo "no $cc here: left out"; fi
done
[ -n "$compilers" ] || { echo "$0: no compiler" >&2; exit 2; }

# known_standards COMPILER c|c++: those to try that the compiler knows
known_standards() {
    compiler=$1 language=$2
    for std in ${STANDARDS:-c99 c11 c17 gnu99 c++11 c++14 c++17 c++20}; do
        case $language:$std in c:*++*) continue ;; c++:*++*) ;; c++:*) continue ;; esac
        if echo 'int main(void);' | $compiler -x "$language" -std="$std" -fsyntax-only - >/dev/null 2>&1; then echo "$std"; fi
    done
}

# output_of STANDARD OBJECT: objects of the oldest standards are linked below; for the others the warnings are enough
output_of() { case $1 in c99 | c++11) echo "-c -o $2" ;; *) echo "-fsyntax-only" ;; esac; }

# level_of STANDARD FILE: some warnings need the optimiser, in one standard only, and not again where HEADERS is given
level_of() { case $headers:$1:$2 in "$root":c99:together) echo -O2 ;; *) echo -O0 ;; esac; }

# tried_in STANDARD FILE: what is about linking and the order of inclusions is tried in the oldest standards alone
tried_in() {
    case $1:$2 in c99:* | c++11:* | *:gxfem* | *:together) return 0 ;; esac
    return 1
}

# What a shared library is compiled with: names are hidden unless GXFEM_API shows them.
flags_of() { [ "$1" != exported ] || echo "-fPIC -fvisibility=hidden"; }

for cc in $compilers; do
    cxx=$(cxx_of "$cc")
    widths=default
    printf '#include <stdio.h>\nint main(void) { return 0; }\n' >probe.c
    if $cc -m32 probe.c -o probe >/dev/null 2>&1; then widths="default m32"; else echo "$cc -m32 does not work here: left out"; fi
    for width in $widths; do
        wide=
        [ $width = m32 ] && wide=-m32
        for std in $(known_standards "$cc" c); do
            [ $width = m32 ] && [ $std != c99 ] && continue
            for file in "$root"/tests/compile/*.c; do
                base=$(basename "$file" .c)
                tried_in $std "$base" || continue
                level=$(level_of $std "$base")
                job "$cc $wide -std=$std $level tests/compile/$base.c" \
                    "$cc $wide -std=$std $level $warnings $(flags_of $base) -I$headers $root/tests/compile/$base.c $(output_of $std $base.$cc.$width.$std.o)"
            done
        done
        if ! command -v "$cxx" >/dev/null 2>&1; then echo "no $cxx here: left out"; continue; fi
        if [ $width = m32 ] && ! $cxx -m32 -x c++ probe.c -o probe >/dev/null 2>&1; then echo "$cxx -m32 does not work here: left out"; continue; fi
        for std in $(known_standards "$cxx" c++); do
            [ $width = m32 ] && [ $std != c++11 ] && continue
            for file in "$root"/tests/compile/*.cc; do
                base=$(basename "$file" .cc)
                tried_in $std "$base" || continue
                level=$(level_of $std "$base")
                job "$cxx $wide -std=$std $level tests/compile/$base.cc" \
                    "$cxx $wide -std=$std $level $warnings $(flags_of $base) -I$headers $root/tests/compile/$base.cc $(output_of $std $base.$cxx.$width.$std.o)"
            done
        done
    done
    for file in example_*.c readme.c; do
        program=${file%.c}.$cc
        says=
        [ $file = readme.c ] && says=" && { ./$program | grep -q ': 2 fragments' || { echo 'the program says something else'; exit 1; }; }"
        job "$cc -std=c99 $file" "$cc -std=c99 $warnings -I$headers $file -o $program -lm && ./$program$says"
    done
    job "$cc -std=c99 docs/RECIPES.md" "$cc -std=c99 $warnings -Wno-unused-function -I$headers -fsyntax-only recipes.c"
    for file in "$root"/examples/*.c; do # they include the repository's headers
        [ "$headers" = "$root" ] || break
        job "$cc -std=c99 examples/$(basename "$file")" "$cc -std=c99 $warnings -I$headers -fsyntax-only $file"
    done
    command -v "$cxx" >/dev/null 2>&1 || continue
    program=readme.$cxx
    job "$cxx -std=c++17 readme.c" "$cxx -std=c++17 $warnings -x c++ -I$headers readme.c -o $program -lm && ./$program | grep -q ': 2 fragments'"
    job "$cxx -std=c++17 docs/RECIPES.md" "$cxx -std=c++17 $warnings -Wno-unused-function -x c++ -I$root -fsyntax-only recipes.c"
done
run_jobs

# ---- linking what was compiled
for cc in $compilers; do
    cxx=$(cxx_of "$cc")
    for width in default m32; do
        wide=
        [ $width = m32 ] && wide=-m32
        c=$cc.$width.c99 cc11=$cxx.$width.c++11
        [ -f "unit.$c.o" ] || continue
        for name in gxfem gxfem_boolean gxfem_integrate gxfem_solve together plain_first implementation_first; do
            job "$name by $cc $wide" "$cc $wide $name.$c.o -o $name.$c -lm && ./$name.$c"
            [ -f "$name.$cc11.o" ] && job "$name by $cxx $wide" "$cxx $wide $name.$cc11.o -o $name.$cc11 -lm && ./$name.$cc11"
        done
        for one in "$c" "$cc11"; do
            [ $width = default ] && [ -f "exported.$one.o" ] || continue
            linker=$cc
            [ "$one" = "$cc11" ] && linker=$cxx
            library=libexported.$one.so
            job "shared library: $one" "$linker -shared exported.$one.o -o $library -lm && sh $root/tests/compile.sh --exports $library && \
$linker exported_user.$one.o ./$library -o exported.$one && ./exported.$one"
        done
        linker=$cc
        [ -f "unit.$cc11.o" ] && linker=$cxx
        for one in "$c" "$cc11"; do
            for two in "$c" "$cc11"; do
                [ -f "unit.$one.o" ] && [ -f "unit_user.$two.o" ] || continue
                job "two units: $one, $two" "$linker $wide unit.$one.o unit_user.$two.o -o unit.$one.$two -lm && ./unit.$one.$two"
                job "two static files: $one, $two" "$linker $wide static.$one.o static_other.$two.o -o static.$one.$two -lm && ./static.$one.$two"
            done
        done
    done
done
run_jobs

passed=$(wc -l <passed) failed=$(wc -l <failed)
echo "compile: $((passed)) passed, $((failed)) failed"
[ "$((failed))" -eq 0 ]
