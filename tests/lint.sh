#!/bin/sh
# The house rules, each by a name. What breaks one is a finding: a line "file:line: what". `make lint` runs all of them.
# usage: sh tests/lint.sh [--root FOLDER] [--all] [RULE...]
#     --root   the house to look at (the repository); tests/test_lint.sh plants violations in one of its own
#     --all    all findings; without it, the first 20 of each rule
#     RULE     these rules only
# To add a rule: a line in `rules`, a function rule_NAME that prints findings, a violation in tests/test_lint.sh.
set -u
LC_ALL=C
export LC_ALL

# Name, and what must hold
rules='
shared      the shared block is the same in every header
licence     every header starts with its SPDX line, and LICENSE is there
version     headers, CHANGELOG.md, CMakeLists.txt and gxfem.pc.in agree on the version; only the shared block defines it
prefixes    public and private names carry the prefixes of their header
reserved    no name is reserved by C
includes    only the C standard library and our own headers are included; the lower three include none of ours
output      the headers print nothing and end no program
functions   no function is longer than 120 lines
undefined   every private macro is undefined at the end of its header
pragmas     every pragma pushed is popped
sections    a section of an implementation has at most 620 lines and starts with a paragraph
contents    the contents on top list every section, and every section that a comment names is there
guide       docs/ARCHITECTURE.md lists every section of each implementation in the table of its header, and no other
calls       a function calls functions of its own section and of earlier ones
borders     no header uses a private name of another
layout      every C file is laid out by .clang-format (clang-format 14; left out where it is missing)
increments  a counter is counted by i++ where its value is not used
columns     headers and prose have at most 120 columns, tables and generated pages apart
names       names, targets and files that prose puts in backticks are there
words       words that were given up stay out of headers and prose
unfinished  nothing is marked as left to be done
readme      the program in README.md is examples/embed.c
'

# Exceptions are listed in tests/lint_exceptions.txt, each with its reason.
exceptions=tests/lint_exceptions.txt

headers="gxfem.h gxfem_boolean.h gxfem_integrate.h gxfem_solve.h"
longest_section=620
longest_function=120
columns=120

# Words given up: a pattern of one word in comments and prose, of one part of a name; and the word to use
words='
crumbs?            speck
knife|knives       splitter
rungs?             spine
umbrellas?         fan
seat|seats|seated  slot
relieve[sd]?       rebalance
looks?             snapshot
knots?             polygon_vertex
spots?             placement
'

fail_usage() { sed -n '3,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }

root=$(dirname -- "$0")/..
shown=20
only=
while [ $# -gt 0 ]; do
    case $1 in
    --root) root=${2:?} && shift ;;
    --all) shown=1000000 ;;
    -*) fail_usage ;;
    *) printf '%s' "$rules" | grep -q "^$1 " || fail_usage; only="$only $1" ;;
    esac
    shift
done
cd "$root" || exit 2
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
trap 'exit 2' HUP INT TERM

# ---- reading sources

# divide FILE CODE COMMENTS: a file as two of as many lines: comments and the insides of quotation marks taken out; only comments.
divide() {
    awk -v code="$2" -v comments="$3" '
        function put(a, b) { print a >code; print b >comments }
        !inside && /^ *# *include/ { put($0, ""); next }
        !inside && !/["\047\/]/ { put($0, ""); next }
        {
            a = b = ""
            rest = $0
            while (rest != "") {
                if (inside) {
                    end = index(rest, "*/")
                    b = b (end ? substr(rest, 1, end - 1) : rest)
                    rest = end ? substr(rest, end + 2) : ""
                    inside = !end
                } else if (match(rest, /"([^"\\]|\\.)*"|\047([^\047\\]|\\.)*\047|\/\*|\/\//)) {
                    found = substr(rest, RSTART, RLENGTH)
                    a = a substr(rest, 1, RSTART - 1)
                    rest = substr(rest, RSTART + RLENGTH)
                    if (found == "/*") { inside = 1; a = a " " }
                    else if (found == "//") { b = b rest; rest = "" }
                    else a = a substr(found, 1, 1) substr(found, 1, 1)
                } else { a = a rest; rest = "" }
            }
            put(a, b)
        }' "$1"
}

for header in $headers; do
    [ -f "$header" ] || { echo "$0: no $header in $root" >&2; exit 2; }
    divide "$header" "$work/$header.code" "$work/$header.comments"
done

prefixes_of() { # HEADER: its public and its private prefix
    case $1 in
    gxfem.h) echo gx gxp ;;
    gxfem_boolean.h) echo gxb gxbp ;;
    gxfem_integrate.h) echo gxi gxip ;;
    gxfem_solve.h) echo gxs gxsp ;;
    esac
}

block() { sed -n '/^\/\* >>shared:/,/^#endif \/\* GXFEM_SHARED_INCLUDED \*\//p' "$1"; }

interface_end() { grep -n -i 'stop here for the' "$1" | head -n 1 | cut -d : -f 1; } # the line, in HEADER

version_of() { # HEADER: the version that its shared block defines
    awk '/^#define GXFEM_VERSION_(MAJOR|MINOR|PATCH) / { v = v dot $3; dot = "." } END { print v }' "$1"
}

prose() { # all pages but those that programs write
    for page in *.md docs/*.md; do
        case $page in *'*'* | docs/BENCH.md | docs/SCENES.md) ;; *) echo "$page" ;; esac
    done
}

c_files() { MAKEFLAGS='' make -s formatted 2>/dev/null | tr ' ' '\n'; } # those that `make format` lays out

# Sections of a HEADER as "line name", in the implementation or, with "all", in all of it
sections() {
    awk -v all="${2:-}" '
        tolower($0) ~ /stop here for the/ { below = 1 }
        (all || below) && match($0, /^\/\* >>[a-z0-9_-]+/) { print NR, substr($0, 6, RLENGTH - 5) }' "$1"
}

# ---- rules

rule_shared() {
    block gxfem.h >"$work/block"
    [ -s "$work/block" ] || echo "gxfem.h: no shared block"
    for header in $headers; do block "$header" | cmp -s - "$work/block" || echo "$header: its shared block is not that of gxfem.h"; done
}

rule_licence() {
    for header in $headers; do
        [ "$(head -n 1 "$header")" = '/* SPDX-License-Identifier: MIT */' ] || echo "$header:1: no SPDX line"
    done
    grep -q 'MIT License' LICENSE 2>/dev/null || echo "LICENSE: not there, or not the MIT License"
}

rule_version() {
    version=$(version_of gxfem.h)
    [ -n "$version" ] || echo "gxfem.h: no GXFEM_VERSION_MAJOR, MINOR, PATCH"
    for header in $headers; do
        title=$(sed -n 2p "$header" | grep -oE '[0-9]+\.[0-9]+(\.[0-9]+)?' | head -n 1)
        [ "$title" = "$version" ] || echo "$header:2: its title says version '$title', GXFEM_VERSION_* '$version'"
    done
    newest=$(grep -oE '^## *\[?v?[0-9]+\.[0-9]+\.[0-9]+' CHANGELOG.md 2>/dev/null | head -n 1 | grep -oE '[0-9.]+$')
    [ "$newest" = "$version" ] || echo "CHANGELOG.md: its newest version is '$newest', GXFEM_VERSION_* say '$version'"
    grep -q 'file(STRINGS .*gxfem\.h' CMakeLists.txt 2>/dev/null || echo "CMakeLists.txt: does not read the version from gxfem.h"
    grep -nE 'VERSION +[0-9]+\.[0-9]+\.[0-9]+' CMakeLists.txt | sed 's/^/CMakeLists.txt:/; s/$/: a version of its own/'
    grep -qx 'Version: @VERSION@' gxfem.pc.in 2>/dev/null || echo "gxfem.pc.in: does not take the version as @VERSION@"
}

# Names that a line of code at file scope introduces: functions, types, enumerators, variables, macros. "line kind name"
introduced() {
    awk '
        function say(kind, name) { if (name != "") print NR, kind, name }
        /^ *# *define / { name = $0; sub(/^ *# *define +/, "", name); sub(/[^A-Za-z0-9_].*/, "", name); say("macro", name) }
        /^ *#/ { continued = /\\$/; next }
        continued { continued = /\\$/; next }
        depth == 0 && /^enum/ && /{/ {
            list = $0; sub(/^[^{]*{/, "", list); sub(/}.*/, "", list); n = split(list, part, ",")
            for (i = 1; i <= n; i++) { sub(/^ */, "", part[i]); sub(/[^A-Za-z0-9_].*/, "", part[i]); say("public", part[i]) } }
        depth == 0 && /^(static|GXFEM_API|__extension__|typedef|struct)/ {
            kind = /^GXFEM_API/ ? "public" : /^static/ ? "private" : "type"
            name = $0
            if (kind == "type" && /^(typedef )?struct [a-z0-9_]+/) {
                sub(/^(typedef )?struct /, "", name); sub(/[^A-Za-z0-9_].*/, "", name) }
            else if (kind == "type") {
                if (/\(\*/) { sub(/.*\(\* */, "", name); sub(/\).*/, "", name) }
                else { sub(/;.*/, "", name); sub(/.*[ *]/, "", name) } }
            else if (name ~ /\(/) { sub(/ *\(.*/, "", name); sub(/.*[ *]/, "", name) }
            else { sub(/ *(\[|=|;).*/, "", name); sub(/.*[ *]/, "", name) }
            if (name !~ /^{?$/) say(kind, name)
        }
        {
            s = $0; opens = gsub(/{/, "", s); closes = gsub(/}/, "", s)
            if ($0 !~ /^extern/) depth += opens - closes
            if (depth < 0) depth = 0
        }' "$1"
}

# The shared block's names are gx_; guards and switches are GXFEM_. Above "stop here" names are public, below private.
rule_prefixes() {
    for header in $headers; do
        stop=$(interface_end "$header")
        [ -n "$stop" ] || echo "$header: does not say where the interface stops"
        # shellcheck disable=SC2046
        set -- $(prefixes_of "$header")
        introduced "$work/$header.code" | awk -v public="$1" -v private="$2" -v stop="${stop:-0}" -v header="$header" \
            -v from="$(grep -n '>>shared: this' "$header" | cut -d : -f 1)" \
            -v to="$(grep -n '^#endif /\* GXFEM_SHARED_INCLUDED' "$header" | cut -d : -f 1)" '
            $1 >= from && $1 <= to || $3 ~ /^GXFEM_/ { next }
            {
                wanted = $1 < stop || $2 == "public" && $3 ~ /^[a-z]/ || $3 in declared ? public : private
                if ($1 < stop) declared[$3] = 1             # an opaque type is named above and defined below
                if (index(tolower($3), wanted "_") != 1 || ($2 == "macro" && $3 ~ /[a-z]/)) print header ":" $1 ": " $2 " name " $3
            }'
    done
}

# A leading underscore, two in a row. Names that compilers provide may be used.
provided='__cplusplus|__SIZEOF_INT128__|__extension__|__int128|__GNUC__|__clang__|_MSC_VER|__restrict|_Pragma|__attribute__|__declspec|__forceinline|__pragma'
provided="$provided|__asm__|__clang_major__|__SSE2_MATH__|__AVX__|__aarch64__|__arm__|__ARM_FP|__riscv_flen|__s390x__"
provided="$provided|__powerpc64__|__wasm__|__wasm_simd128__|__builtin_shufflevector|__builtin_convertvector"
provided="$provided|__builtin_prefetch|__builtin_fabs|__builtin_ia32_m(in|ax)ps|__builtin_wasm_pm(in|ax)_f32x4|_M_X64|_M_ARM64|__SSE2__|__m64|__m128d?|_mm_[a-z0-9_]+"
provided="$provided|_MM_SHUFFLE|_MM_HINT_T0|_umul128|__umulh"
rule_reserved() {
    for header in $headers; do
        sed 's/##[A-Za-z0-9_]*//g' "$work/$header.code" | grep -noE '\b(_[A-Za-z0-9_]*|[A-Za-z0-9_]*__[A-Za-z0-9_]*)\b' |
            grep -vE ":($provided)\$" | sed "s/^/$header:/"
    done
}

rule_includes() {
    for header in $headers; do
        ours='^$'
        [ $header = gxfem.h ] && ours='"gxfem_(boolean|integrate|solve)\.h"'
        grep -nE '^ *# *include' "$work/$header.code" | grep -vE "$ours" | sed "s/^/$header:/" |
            grep -vE '<(assert|ctype|errno|float|limits|math|stdarg|stddef|stdint|stdio|stdlib|string)\.h>' |
            grep -vE ':#include <(intrin|emmintrin|arm_neon)\.h>'
        # compilers' own headers, of intrinsics: behind their switch only
        awk -v header=$header '/# *include <(intrin|emmintrin|arm_neon)\.h>/ && before !~ /GXFEM_INTRINSICS/ { print header ":" FNR ":" $0 }
            { before = $0 }' "$work/$header.code"
    done
}

rule_output() {
    for header in $headers; do
        grep -nE '\b(printf|puts|fputs|putchar|fprintf|abort|exit) *\(' "$work/$header.code" | sed "s/^/$header:/"
    done
}

rule_functions() {
    for header in $headers; do
        functions "$work/$header.code" | awk -v header=$header -v most=$longest_function '
            $2 - $1 >= most { print header ":" $1 ": " $3 " has " $2 - $1 + 1 " lines" }'
    done
}

rule_undefined() {
    for header in $headers; do
        # shellcheck disable=SC2046
        set -- $(prefixes_of "$header" | tr a-z A-Z)
        grep -oE "^ *# *define $2_[A-Z0-9_]+" "$work/$header.code" | awk '{ print $NF }' | sort -u |
            while read -r macro; do grep -qE "^#undef $macro\$" "$work/$header.code" || echo "$header: $macro stays defined"; done
    done
}

rule_pragmas() {
    for header in $headers; do
        pushed=$(grep -c 'pragma.*push' "$work/$header.code") popped=$(grep -c 'pragma.*pop' "$work/$header.code")
        [ "$pushed" -eq "$popped" ] || echo "$header: $pushed pragmas pushed, $popped popped"
    done
}

# A paragraph: at least 12 words below the banner's line, in the banner's comment or in the next one. A comment that stands on a
# function without a blank line between is the function's, not the section's.
rule_sections() {
    for header in $headers; do
        sections "$header" | awk -v header=$header -v most=$longest_section '
            FNR == NR { name[$1] = $2; next }
            function close_section() {
                if (at && FNR - at > most) print header ":" at ": >>" name[at] " has " FNR - at " lines"
            }
            function judge() {
                if (words < 12) print header ":" at ": >>" name[at] " has no paragraph below its banner"
                state = ""
            }
            FNR in name { close_section(); at = FNR; words = 0; state = /\*\// ? "below" : "inside"; own = state == "inside"; next }
            state == "inside" { words += NF; if (/\*\//) state = "after"; next }
            state == "after" { if (!/^ *$/ && !/^#/ && !own) words = 0; judge(); next }
            state == "below" && /^ *$/ { next }
            state == "below" && /^\/\*/ { words = NF - 1; state = /\*\// ? "after" : "inside"; next }
            state == "below" { judge() }
            END { FNR++; close_section() }' - "$header"
    done
}

rule_contents() {
    for header in $headers; do sections "$header" all | awk '{ print $2 }'; done | sort -u >"$work/anchors"
    for header in $headers; do
        sections "$header" all | awk -v header=$header '
            FNR == NR { if ($2 in line) print header ":" $1 ": >>" $2 " a second time"; line[$2] = $1; next }
            /^#ifndef/ { exit }
            { while (match($0, />>[a-z][a-z0-9_-]*/)) { listed[substr($0, RSTART + 2, RLENGTH - 2)] = FNR; $0 = substr($0, RSTART + RLENGTH) } }
            END {
                for (a in line) if (!(a in listed)) print header ":" line[a] ": >>" a " is not in the contents"
                for (a in listed) if (!(a in line) && a != "name") print header ":" listed[a] ": the contents list >>" a ", which is not there"
            }' - "$header" | sort -t : -k 2n
        awk -v header=$header '
            FNR == NR { there[$1] = 1; next }
            { while (match($0, />>[a-z][a-z0-9_-]*/)) {
                a = substr($0, RSTART + 2, RLENGTH - 2); $0 = substr($0, RSTART + RLENGTH)
                if (!(a in there) && a != "name") print header ":" FNR ": a comment names >>" a ", which is in no header" } }' \
            "$work/anchors" "$work/$header.comments"
    done
}

# A table of sections begins with a row "| `HEADER` | ..." and ends at the next blank line.
rule_guide() {
    guide=docs/ARCHITECTURE.md
    for header in $headers; do
        sections "$header" | awk -v header=$header -v guide=$guide '
            FNR == NR { line[$2] = $1; next }
            index($0, "| `" header "` |") == 1 { inside = found = 1; next }
            /^ *$/ { inside = 0 }
            !inside { next }
            { while (match($0, />>[a-z][a-z0-9_-]*/)) {
                a = substr($0, RSTART + 2, RLENGTH - 2); $0 = substr($0, RSTART + RLENGTH)
                if (a in listed) print guide ":" FNR ": >>" a " of " header " a second time"
                listed[a] = 1
                if (!(a in line)) print guide ":" FNR ": >>" a " is no section of " header } }
            END {
                if (!found) print guide ": no table of the sections of " header
                for (a in line) if (!(a in listed)) print header ":" line[a] ": >>" a " is not in " guide }' - "$guide"
    done
}

# Functions that a file of code defines: "first-line last-line name". A definition is text with a name of ours and a parenthesis
# between the end of what is before and a brace.
functions() {
    awk '
        /^ *#/ || continued { continued = /\\$/; next }
        /^extern "" *{/ || /^}$/ && depth == 0 { head = ""; next }
        {
            line = $0
            while (match(line, /[{};]/)) {
                mark = substr(line, RSTART, 1)
                if (depth == 0) head = head " " substr(line, 1, RSTART - 1)
                if (depth == 0 && start == 0 && head ~ /[^ ]/) start = NR
                line = substr(line, RSTART + 1)
                if (mark == "{") {
                    if (depth++ == 0) {
                        name = ""
                        if (head !~ /=|^ *(typedef|struct|union|enum)/ && match(head, /gx[a-z]*_[a-z0-9_]+\(/)) name = substr(head, RSTART, RLENGTH - 1)
                        first = start
                    }
                } else if (mark == "}" && depth > 0) {
                    if (--depth == 0) { if (name != "") print first, NR, name; head = ""; start = 0 }
                } else if (depth == 0) { head = ""; start = 0 }
            }
            if (depth == 0) { head = head " " line; if (start == 0 && line ~ /[^ ]/) start = NR }
        }' "$1"
}

rule_calls() {
    for header in $headers; do
        sections "$header" >"$work/sections"
        functions "$work/$header.code" >"$work/functions"
        awk -v header=$header '
            FILENAME ~ /sections$/ { section_line[++sections] = $1; section[sections] = $2; next }
            FILENAME ~ /functions$/ { first[++n] = $1; last[n] = $2; name[n] = $3; number[$3] = n; next }
            FNR == 1 {
                for (i = 1; i <= n; i++) {
                    while (s < sections && section_line[s + 1] <= first[i]) s++
                    home[i] = s
                }
                i = 1
            }
            i <= n && FNR > last[i] { i++ }
            i <= n && FNR >= first[i] && !/^ *#/ {
                line = $0
                while (match(line, /gx[a-z]*_[a-z0-9_]+/)) {
                    called = substr(line, RSTART, RLENGTH); line = substr(line, RSTART + RLENGTH)
                    if (called in number && home[number[called]] > home[i] && !((i, called) in told)) {
                        told[i, called] = 1
                        print header ":" FNR ": " name[i] " (>>" section[home[i]] ") calls " called " (>>" section[home[number[called]]] ")"
                    }
                }
            }' "$work/sections" "$work/functions" "$work/$header.code"
    done
}

rule_borders() {
    for header in $headers; do
        others=
        for other in $headers; do
            [ $other = $header ] && continue
            # shellcheck disable=SC2046
            set -- $(prefixes_of "$other")
            others="$others|$2"
        done
        grep -noiE "\b(${others#|})_[a-z0-9_]+" "$work/$header.code" | sort -u -t : -k 2 | sort -n | sed "s/^/$header:/; s/\$/ is private to another header/"
    done
}

rule_layout() {
    if ! command -v clang-format >/dev/null 2>&1; then echo "no clang-format here: layout is left out" >&2; return; fi
    case $(clang-format --version) in *'version 14.'*) ;; *) echo "clang-format is not version 14: layout is left out" >&2; return ;; esac
    # shellcheck disable=SC2046
    clang-format --dry-run -Werror $(c_files) 2>&1 | grep -oE '^[^ :]+:[0-9]+:[0-9]+: error' | cut -d : -f 1,2 | sort -u -t : -k 1,1 |
        sed 's/$/: is laid out otherwise from here on; see "make format"/'
}

rule_increments() {
    for file in $(c_files); do
        divide "$file" "$work/code" "$work/comments"
        grep -nE '(^|[{}]|\) |\belse|\bdo) *(\+\+|--)[A-Za-z_(*]|\bfor \([^;]*;[^;]*;(.*,)? *(\+\+|--)|^[^(]*; *(\+\+|--)' "$work/code" |
            sed "s|^|$file:|"
    done
}

# Columns, not bytes: the bytes that continue a character are not counted.
rule_columns() {
    # shellcheck disable=SC2046
    awk -v most=$columns '
        FILENAME ~ /\.md$/ && /^ *\|/ { next }
        { line = $0; gsub(/[\200-\277]/, "", line) }
        length(line) > most { print FILENAME ":" FNR ": " length(line) " columns" }' $headers $(prose)
}

# Of what stands in backticks: names with our prefixes (name* is any that starts so), `make TARGET`, files with a folder or a
# header's name. NAME is a placeholder.
rule_names() {
    {
        for header in $headers; do cat "$work/$header.code"; done
        cat examples/*.[ch] tests/*.[ch] tests/*/*.[ch] bench/*.[ch] CMakeLists.txt 2>/dev/null
    } | awk '
        { while (match($0, /[A-Za-z_][A-Za-z0-9_]*/)) { word[substr($0, RSTART, RLENGTH)] = 1; $0 = substr($0, RSTART + RLENGTH) } }
        END { for (w in word) print "word", w }' >"$work/there"
    MAKEFLAGS='' make -pq help 2>/dev/null | sed -n 's/^\([A-Za-z0-9_.-]*\):.*/target \1/p' >>"$work/there"
    # shellcheck disable=SC2046
    awk '
        FILENAME ~ /\/there$/ { if ($1 == "word") { word[$2] = 1; if ($2 ~ /^gx/ || $2 ~ /^GX/) ours = ours " " $2 } else target[$2] = 1; next }
        function absent(what, kind) { print FILENAME ":" FNR ": " kind " " what " is not there" }
        function judge(span, n, i, part, w, dot) {
            if (span ~ /^make [a-z]/) {
                w = span; sub(/^make /, "", w); sub(/[^A-Za-z0-9_.-].*/, "", w)
                if (w ~ /NAME/) return
                if (!(w in target)) absent(w, "make target")
                return
            }
            n = split(span, part, /[^A-Za-z0-9_.*\/-]+/)
            for (i = 1; i <= n; i++) {
                w = part[i]; sub(/[.-]+$/, "", w)
                if (w ~ /NAME/) continue
                if (w ~ /^(gx|GX)[A-Za-z]*_[A-Za-z0-9_]*\*$/) { sub(/\*$/, "", w); if (index(ours, " " w) == 0) absent(w "*", "a name like") }
                else if (w ~ /^(gx(p|b|bp|i|ip|s|sp)?_[a-z0-9_]+|GX(P|B|BP|I|IP|S|SP|FEM)?_[A-Z0-9_]+)$/) { if (!(w in word)) absent(w, "name") }
                else if (w ~ /^gx(p|b|bp|i|ip|s|sp)?_[a-z0-9_]+\.[a-z0-9_]+$/ && w !~ /\.(h|c|sh|pc)$/) {
                    dot = index(w, ".")
                    if (!(substr(w, 1, dot - 1) in word)) absent(substr(w, 1, dot - 1), "name")
                    if (!(substr(w, dot + 1) in word)) absent(substr(w, dot + 1), "name")
                }
                else if (w ~ /^gxfem[a-z_]*\.(h|pc\.in)$/ || w ~ /^(docs|tests|bench|examples|\.ci)\// || w ~ /\/.*\.(c|h|sh|md|txt|awk)$/ && w !~ /^(build|\/|\.\.)/)
                    print "file", FILENAME ":" FNR, w
            }
        }
        FNR == 1 { fenced = open = 0; span = "" }
        /^ *```/ { fenced = !fenced; next }
        fenced { next }
        /^ *$/ { open = 0; span = "" }
        {
            n = split($0, piece, "`")
            for (k = 1; k <= n; k++) {
                if (open) { span = span (k == 1 && span != "" ? " " : "") piece[k]; if (k < n) { judge(span); open = 0; span = "" } }
                else if (k < n) { open = 1; span = "" }
            }
        }' "$work/there" $(prose) | while read -r kind where file rest; do
        if [ "$kind" != file ]; then echo "$kind $where $file $rest"; continue; fi
        [ "$file" = gxfem_all.h ] && continue           # made by `make amalgam`
        for path in $file docs/$file; do [ -e "$path" ] && continue 2; done
        echo "$where: file $file is not there"
    done
}

# As parts of names in code, as words in comments and prose. To look is a plain verb there: only the noun is given up.
rule_words() {
    printf '%s\n' "$words" | while read -r word instead; do
        [ -n "$word" ] || continue
        text="\\b($word)\\b"
        [ "$word" = 'looks?' ] && text="\\b(a|the|this|that|first|last|next|each|every|one|no) ($word)\\b"
        for header in $headers; do
            grep -noiE "\b(gx[a-z]*_)?([a-z0-9]+_)*($word)(_[a-z0-9]+)*\b" "$work/$header.code" | grep -viE 'look_up' | sed "s/^/$header:/; s/\$/: say $instead/"
            grep -noiE "$text" "$work/$header.comments" | sed "s/^/$header:/; s/\$/: say $instead/"
        done
        # shellcheck disable=SC2046
        grep -noiE "$text" $(prose) /dev/null | sed "s/\$/: say $instead/"
    done
}

rule_unfinished() {
    # shellcheck disable=SC2046
    grep -nE '\b(TODO|FIXME|XXX|HACK)\b' $headers $(find examples -type f) CMakeLists.txt Makefile $(prose) /dev/null
}

rule_readme() {
    awk '/^```c$/ { inside = 1; next } /^```/ { if (inside) exit } inside' README.md >"$work/readme"
    awk 'code || /^#/ { code = 1; print }' examples/embed.c | cmp -s - "$work/readme" ||
        echo "README.md: its first program is not examples/embed.c below the opening comment"
}

# ---- running them

# excuse RULE FINDINGS: those that no exception excuses; then exceptions that have no reason, or excuse nothing
excuse() {
    awk -v rule="$1" '
        FILENAME == ARGV[1] {
            if (/^#/ || split($0, field, / \| /) < 2 || field[1] != rule) next
            text[++count] = field[2]; entry[count] = $0
            if (field[3] ~ /^ *$/) print FILENAME ":" FNR ": an exception without a reason: " $0
            next
        }
        {
            for (i = 1; i <= count; i++) if (index($0, text[i])) { used[i] = 1; next }
            print
        }
        END { for (i = 1; i <= count; i++) if (!used[i]) print "an exception that excuses nothing: " entry[i] }' "$work/exceptions" "$2"
}

grep -s . "$exceptions" >"$work/exceptions"
passed=0
failed=0
printf '%s' "$rules" >"$work/rules"
while read -r rule what; do
    [ -n "$rule" ] || continue
    case " $only " in '  ' | *" $rule "*) ;; *) continue ;; esac
    rule_$rule >"$work/findings"
    excuse $rule "$work/findings" >"$work/left"
    if [ ! -s "$work/left" ]; then passed=$((passed + 1)); else
        failed=$((failed + 1))
        count=$(wc -l <"$work/left")
        echo "FAILED $rule: $what ($((count)))"
        head -n $shown "$work/left" | sed 's/^/  /'
        [ "$count" -le "$shown" ] || echo "  ... and $((count - shown)) more (--all)"
    fi
done <"$work/rules"
echo "lint: $passed passed, $failed failed; $(grep -c '^[a-z].* | ' "$work/exceptions") exceptions, each with its reason in $exceptions"
[ $failed -eq 0 ]
