#!/bin/sh
# Can each rule of lint.sh fail? Builds a small house that keeps all rules, plants one violation after the other, and expects
# the rule that is broken to say where.
# usage: sh tests/test_lint.sh
set -u
tests=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd) || exit 2
house=$(mktemp -d) || exit 2
trap 'rm -rf "$house"' EXIT
trap 'exit 2' HUP INT TERM
passed=0
failed=0

# header NAME PUBLIC PRIVATE MACROS: one that keeps the rules
header() {
    cat <<END
/* SPDX-License-Identifier: MIT */
/* $1 - adds numbers. Part of gxfem 0.2.0.
 *
 * Contents: >>shared >>types >>first >>second
 */
#ifndef $4_INCLUDED
#define $4_INCLUDED
/* >>shared: this block is the same in every gxfem header */
#ifndef GXFEM_SHARED_INCLUDED
#define GXFEM_SHARED_INCLUDED
#define GXFEM_VERSION_MAJOR 0
#define GXFEM_VERSION_MINOR 2
#define GXFEM_VERSION_PATCH 0
#define GXFEM_API extern
#endif /* GXFEM_SHARED_INCLUDED */

/* >>types */

typedef struct $2_number {
    int value;
} $2_number;
GXFEM_API int $2_sum(const int *numbers, int count);
/* stop here for the API */
#endif

#ifdef $4_IMPLEMENTATION
#include <string.h>
#define $4P_LIMIT 8

/* >>first
   Numbers one by one. Comes in: two numbers. Goes out: what they add up to. It touches nothing else. */

static int $3_add(int a, int b) { return a + b; }

/* >>second ------------------------------------------------------------------------------------------------------- */

/* Arrays of numbers. Comes in: an array and how many there are. Goes out: the sum of the first few. */

#pragma GCC diagnostic push
int $2_sum(const int *numbers, int count) {
    int i, sum = 0;
    for (i = 0; i < count && i < $4P_LIMIT; i++) sum = $3_add(sum, numbers[i]);
    return sum;
}
#pragma GCC diagnostic pop
#undef $4P_LIMIT
#endif
END
}

build_house() {
    rm -rf "${house:?}"/*
    mkdir "$house/docs" "$house/examples" "$house/tests" "$house/bench"
    header gxfem.h gx gxp GX >"$house/gxfem.h"
    header gxfem_boolean.h gxb gxbp GXB >"$house/gxfem_boolean.h"
    header gxfem_integrate.h gxi gxip GXI >"$house/gxfem_integrate.h"
    header gxfem_solve.h gxs gxsp GXS >"$house/gxfem_solve.h"
    printf '/* Adds. */\n#include "gxfem.h"\nint main(void) { return 0; }\n' >"$house/examples/embed.c"
    {
        echo '`gx_sum` adds numbers, `gxsp_*` too, and `make check` says whether they do. See `docs/HOUSE.md`.'
        printf '\n```c\n#include "gxfem.h"\nint main(void) { return 0; }\n```\n'
    } >"$house/README.md"
    echo 'Sums are taken in the order of the array (`gx_number.value`). Look at a knob.' >"$house/docs/HOUSE.md"
    printf '# Changes\n\n## 0.2.0\n' >"$house/CHANGELOG.md"
    for name in gxfem.h gxfem_boolean.h gxfem_integrate.h gxfem_solve.h; do
        printf '| `%s` | |\n| --- | --- |\n| `>>first` `>>second` | sums |\n\n' $name
    done >"$house/docs/ARCHITECTURE.md"
    echo 'MIT License' >"$house/LICENSE"
    echo 'file(STRINGS gxfem.h version)' >"$house/CMakeLists.txt"
    echo 'Version: @VERSION@' >"$house/gxfem.pc.in"
    printf 'help check:\nformatted:\n\t@echo *.h examples/*.c\n' >"$house/Makefile"
    printf 'BasedOnStyle: LLVM\nColumnLimit: 120\nIndentWidth: 4\nAllowShortLoopsOnASingleLine: true\n' >"$house/.clang-format"
}

# edit FILE SED-SCRIPT
edit() { sed "$2" "$house/$1" >"$house/edited" && mv "$house/edited" "$house/$1"; }

# expect NAME TEXT RULE...: the rules that were named found something that contains the text; with no text, nothing at all.
# Each time, the house is built anew afterwards.
expect() {
    name=$1 text=$2
    shift 2
    said=$(sh "$tests/lint.sh" --root "$house" --all "$@" 2>&1)
    code=$?
    if [ -z "$text" ]; then wrong=$([ $code -eq 0 ] || echo yes); else
        wrong=$({ [ $code -eq 1 ] && printf '%s\n' "$said" | grep -qF -- "$text"; } || echo yes)
    fi
    if [ -z "$wrong" ]; then passed=$((passed + 1)); else
        failed=$((failed + 1))
        echo "FAILED $name: expected '$text' of $*, lint said:"
        printf '%s\n' "$said" | sed 's/^/  /'
    fi
    build_house
}

# lines COUNT TEXT: so many of them
lines() { awk -v n="$1" -v text="$2" 'BEGIN { while (n-- > 0) print text }'; }

build_house
expect "a house in order" ""

edit gxfem_solve.h 's/GXFEM_API extern/GXFEM_API/'
expect "another shared block" "gxfem_solve.h: its shared block" shared

edit gxfem.h 1d
expect "no SPDX line" "gxfem.h:1: no SPDX" licence
rm "$house/LICENSE"
expect "no licence" "LICENSE: not there" licence

edit CHANGELOG.md 's/0.2.0/0.1.9/'
expect "an old changelog" "CHANGELOG.md: its newest version is '0.1.9'" version
edit gxfem_boolean.h '2s/0.2.0/0.3.0/'
expect "another version in a title" "gxfem_boolean.h:2: its title says version '0.3.0'" version
echo 'project(gxfem VERSION 0.2.0)' >>"$house/CMakeLists.txt"
expect "a version in CMakeLists.txt" "a version of its own" version
echo 'Version: 0.2.0' >"$house/gxfem.pc.in"
expect "a version in gxfem.pc.in" "gxfem.pc.in: does not take" version

edit gxfem.h 's/^static int gxp_add(/static int add(/'
expect "a private name without prefix" "private name add" prefixes
edit gxfem_boolean.h 's/gxb_number/gx_number/g'
expect "a type with another prefix" "type name gx_number" prefixes

edit gxfem.h 's/int i, sum/int i, _sum/'
expect "a reserved name" "_sum" reserved

edit gxfem_solve.h 's/<string.h>/"gxfem_boolean.h"/'
expect "a lower header includes another" '"gxfem_boolean.h"' includes
edit gxfem.h 's/<string.h>/<unistd.h>/'
expect "a header that is not C's" "unistd.h" includes
edit gxfem.h 's/<string.h>/<emmintrin.h>/'
expect "intrinsics without their switch" "emmintrin.h" includes

edit gxfem.h 's/    return sum;/    printf("sum");&/'
expect "output" "gxfem.h:43" output

lines 115 '    i++;' >"$house/body"
edit gxfem.h "/int i, sum/r $house/body"
expect "a function of 120 lines" "" functions
lines 116 '    i++;' >"$house/body"
edit gxfem.h "/int i, sum/r $house/body"
expect "a long function" "gx_sum has 121 lines" functions

edit gxfem.h '/^#undef/d'
expect "a macro stays" "GXP_LIMIT stays defined" undefined

edit gxfem.h '/diagnostic pop/d'
expect "an open pragma" "1 pragmas pushed, 0 popped" pragmas

lines 615 '' >"$house/body"
edit gxfem.h "/^static int gxp_add/r $house/body"
expect "a section of 620 lines" "" sections
lines 616 '' >"$house/body"
edit gxfem.h "/^static int gxp_add/r $house/body"
expect "a long section" ">>first has 621 lines" sections
edit gxfem.h 's/   Numbers one by one.*/   Numbers. *\//'
expect "a banner without a paragraph" ">>first has no paragraph" sections
edit gxfem.h '/^\/\* Arrays of numbers/{n;d;}'
edit gxfem.h '/^#pragma GCC diagnostic push/d'
expect "a function's comment is no paragraph" ">>second has no paragraph" sections

edit gxfem.h 's/ >>second$//'
expect "a section that is not listed" ">>second is not in the contents" contents
edit gxfem.h 's/ >>second$/& >>third/'
expect "a section that is not there" "the contents list >>third" contents
edit gxfem.h 's/Arrays of numbers\./& See >>third./'
expect "a comment names a section that is not there" "a comment names >>third" contents
edit gxfem.h 's/>>second ---/>>first ---/'
expect "two sections of one name" ">>first a second time" contents

edit docs/ARCHITECTURE.md '7s/ `>>second`//'
expect "the guide lacks a section" "gxfem_boolean.h:35: >>second is not in docs/ARCHITECTURE.md" guide
edit docs/ARCHITECTURE.md '7s/>>second/>>third/'
expect "the guide lists a section that is not there" "docs/ARCHITECTURE.md:7: >>third is no section of gxfem_boolean.h" guide
edit docs/ARCHITECTURE.md '7s/>>second/>>first/'
expect "the guide lists a section twice" ">>first of gxfem_boolean.h a second time" guide
edit docs/ARCHITECTURE.md '5,7d'
expect "the guide has no table for a header" "no table of the sections of gxfem_boolean.h" guide

edit gxfem.h 's/{ return a + b; }/{ return gx_sum(\&a, 1) + b; }/'
expect "a call to a later section" "gxp_add (>>first) calls gx_sum (>>second)" calls

edit gxfem.h 's/gxp_add(sum/gxsp_add(sum/'
expect "a private name of another header" "gxsp_add is private to another header" borders
edit gxfem_solve.h 's/i < GXSP_LIMIT/i < GXP_LIMIT/'
expect "a private macro of another header" "GXP_LIMIT is private to another header" borders

if clang-format --version 2>/dev/null | grep -q 'version 14\.'; then
    edit gxfem.h 's/int i, sum = 0;/int i,sum = 0;/'
    expect "another layout" "gxfem.h:41: is laid out otherwise" layout
else
    echo "no clang-format 14 here: the rule of layout is not tried"
fi

edit gxfem.h 's/i++)/++i)/'
expect "a loop that counts by ++i" "for (i = 0" increments
edit gxfem.h 's/    return sum;/    --sum;\
&/'
expect "a statement --i" "--sum;" increments
edit gxfem.h 's/    return sum;/    if (sum > 1) ++sum;\
&/'
expect "a conditional ++i" "++sum;" increments
edit gxfem.h 's/    return sum;/    return ++sum;/'
expect "++i whose value is used" "" increments

edit gxfem.h 's/ \* Contents/ * A line of many words, of which there are so many that they do not fit into the columns that there are in this house. Contents/'
expect "a long line in a header" "gxfem.h:4:" columns
awk 'BEGIN { for (i = 0; i < 12; i++) printf "ten bytes "; print "and more" }' >>"$house/docs/HOUSE.md"
expect "a long line in prose" "docs/HOUSE.md:2: 128 columns" columns
awk 'BEGIN { printf "| "; for (i = 0; i < 12; i++) printf "ten bytes "; print "and more |" }' >>"$house/docs/HOUSE.md"
expect "a long line of a table" "" columns
awk 'BEGIN { for (i = 0; i < 60; i++) printf "\303\251\303\250"; print "" }' >>"$house/docs/HOUSE.md"
expect "120 columns of two bytes each" "" columns

echo 'See `gx_total`.' >>"$house/docs/HOUSE.md"
expect "a name that is not there" "docs/HOUSE.md:2: name gx_total" names
echo 'See `gx_number.total`.' >>"$house/docs/HOUSE.md"
expect "a field that is not there" "name total" names
echo 'See `gxbp_t*`.' >>"$house/docs/HOUSE.md"
expect "a beginning that no name has" "a name like gxbp_t*" names
echo 'See `make tea`.' >>"$house/docs/HOUSE.md"
expect "a target that is not there" "make target tea" names
echo 'See `tests/test_sum.c`.' >>"$house/docs/HOUSE.md"
expect "a file that is not there" "docs/HOUSE.md:2: file tests/test_sum.c" names
printf 'See `int x =\ngx_total(x)`.\n' >>"$house/docs/HOUSE.md"
expect "a name in backticks over two lines" "docs/HOUSE.md:3: name gx_total" names

edit gxfem.h 's/gxp_add/gxp_add_crumb/'
expect "a word given up in a name" "gxp_add_crumb: say speck" words
edit gxfem.h 's/gxp_add/gxp_add_knot/'
expect "another word given up" "gxp_add_knot: say polygon_vertex" words
edit gxfem.h 's/Arrays of numbers\./& They are relieved./'
expect "a word given up in a comment" "relieved: say rebalance" words
echo 'Take a last look.' >>"$house/docs/HOUSE.md"
expect "a word given up in prose" "docs/HOUSE.md:2:last look: say snapshot" words

echo 'TO''DO: subtract.' >>"$house/docs/HOUSE.md"
expect "something left to be done" "docs/HOUSE.md:2:" unfinished

edit README.md 's/return 0/return 1/'
expect "another program in the README" "README.md: its first program" readme

edit gxfem.h 's/i++)/++i)/'
echo 'increments | for (i = 0 | as an example' >"$house/tests/lint_exceptions.txt"
expect "an exception" "" increments
edit gxfem.h 's/i++)/++i)/'
echo 'increments | for (i = 0' >"$house/tests/lint_exceptions.txt"
expect "an exception without a reason" "an exception without a reason" increments
echo 'increments | for (i = 0 | as an example' >"$house/tests/lint_exceptions.txt"
expect "an exception that excuses nothing" "an exception that excuses nothing" increments

echo "lint can fail: $passed passed, $failed failed"
[ $failed -eq 0 ]
