#!/bin/sh
# House rules of the headers.
# usage: sh tests/lint.sh HEADER...
#     the shared block is the same in all; names have their header's prefix, and no name is reserved; only the C standard
#     library and our own headers are included (the lower three include none of ours); no function is longer than 120 lines;
#     no pragma is left open and no helper macro defined, nothing is left to be done; the README's program is examples/embed.c
set -u
cd "$(dirname -- "$0")/.." || exit 2
[ $# -gt 0 ] || set -- gxfem.h gxfem_boolean.h gxfem_integrate.h gxfem_solve.h
failed=0
passed=0
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT

# rule NAME TEXT: the rule holds if the text is empty
rule() {
    if [ -z "$2" ]; then passed=$((passed + 1)); else
        failed=$((failed + 1))
        echo "FAILED $1"
        printf '%s\n' "$2" | sed 's/^/  /' | head -n 20
    fi
}

# The code of a file: comments and what stands in quotation marks taken out, lines kept.
code() {
    awk '
        !comment && /^ *# *include/ { print; next }
        {
            out = ""
            for (i = 1; i <= length($0); i++) {
                two = substr($0, i, 2); one = substr($0, i, 1)
                if (comment) { if (two == "*/") { comment = 0; i++ } }
                else if (quote != "") { if (one == "\\") i++; else if (one == quote) { quote = ""; out = out one } }
                else if (two == "/*") { comment = 1; i++; out = out " " }
                else if (two == "//") break
                else { if (one == "\"" || one == "\047") quote = one; out = out one }
            }
            print out
        }' "$1"
}

block() { sed -n '/^\/\* >>shared:/,/^#endif \/\* GXFEM_SHARED_INCLUDED \*\//p' "$1"; }

# Names that a line of code at file scope introduces: functions, types, enumerators, variables, macros. "line kind name"
names() {
    awk '
        function say(kind, name) { if (name != "") print NR, kind, name }
        /^ *# *define / { name = $0; sub(/^ *# *define +/, "", name); sub(/[^A-Za-z0-9_].*/, "", name); say("macro", name) }
        /^ *#/ { continued = /\\$/; next }
        continued { continued = /\\$/; next }
        depth == 0 && /^enum/ && /{/ { list = $0; sub(/^[^{]*{/, "", list); sub(/}.*/, "", list); n = split(list, part, ",")
            for (i = 1; i <= n; i++) { sub(/^ */, "", part[i]); sub(/[^A-Za-z0-9_].*/, "", part[i]); say("public", part[i]) } }
        depth == 0 && /^(static|GXFEM_API|__extension__|typedef|struct)/ {
            kind = /^GXFEM_API/ ? "public" : /^static/ ? "private" : "type"
            name = $0
            if (kind == "type" && /^(typedef )?struct [a-z0-9_]+/) { sub(/^(typedef )?struct /, "", name); sub(/[^A-Za-z0-9_].*/, "", name) }
            else if (kind == "type") { if (/\(\*/) { sub(/.*\(\* */, "", name); sub(/\).*/, "", name) } else { sub(/;.*/, "", name); sub(/.*[ *]/, "", name) } }
            else if (name ~ /\(/) { sub(/ *\(.*/, "", name); sub(/.*[ *]/, "", name) }
            else { sub(/ *(\[|=|;).*/, "", name); sub(/.*[ *]/, "", name) }
            if (name !~ /^{?$/) say(kind, name)
        }
        { s = $0; opens = gsub(/{/, "", s); closes = gsub(/}/, "", s); if ($0 !~ /^extern/) depth += opens - closes; if (depth < 0) depth = 0 }' "$1"
}

first=$1
block "$first" >"$work/block"
[ -s "$work/block" ] || rule "shared block of $first" "there is none"
for header in "$@"; do
    code "$header" >"$work/code"
    block "$header" | cmp -s - "$work/block"
    rule "$header: shared block as in $first" "$([ $? -eq 0 ] || echo 'differs')"

    case $header in
    gxfem.h) public=gx private=gxp ours=1 ;;
    gxfem_boolean.h) public=gxb private=gxbp ours=0 ;;
    gxfem_integrate.h) public=gxi private=gxip ours=0 ;;
    gxfem_solve.h) public=gxs private=gxsp ours=0 ;;
    *) echo "$0: no prefixes known for $header" >&2; exit 2 ;;
    esac
    # The shared block's names are gx_; guards and switches are GXFEM_. Above "stop here" names are public, below private.
    stop=$(grep -n -i 'stop here for the' "$header" | head -n 1 | cut -d : -f 1)
    rule "$header: says where the interface stops" "$([ -n "$stop" ] || echo 'does not')"
    names "$work/code" | awk -v public=$public -v private=$private -v stop="${stop:-0}" -v header="$header" \
        -v from="$(grep -n '>>shared: this' "$header" | cut -d : -f 1)" -v to="$(grep -n '^#endif /\* GXFEM_SHARED_INCLUDED' "$header" | cut -d : -f 1)" '
        $1 >= from && $1 <= to { next }
        $3 ~ /^GXFEM_/ { next }
        {
            wanted = $1 < stop || $2 == "public" && $3 ~ /^[a-z]/ || $3 in declared ? public : private
            if ($1 < stop) declared[$3] = 1             # an opaque type is named above and defined below
            if (index(tolower($3), wanted "_") != 1 || ($2 == "macro" && $3 ~ /[a-z]/)) print header ":" $1 ": " $2 " name " $3
        }' >"$work/names"
    rule "$header: prefixes $public"_" and $private"_ "$(cat "$work/names")"

    # Reserved: a leading underscore, two in a row. What compilers provide may be used.
    rule "$header: no reserved names" "$(sed 's/##[A-Za-z0-9_]*//g' "$work/code" | grep -noE '\b(_[A-Za-z0-9_]*|[A-Za-z0-9_]*__[A-Za-z0-9_]*)\b' |
        grep -vE ':(__cplusplus|__SIZEOF_INT128__|__extension__|__int128|__GNUC__|__clang__|_MSC_VER|__restrict|_Pragma|__attribute__|__asm__|__clang_major__|__SSE2_MATH__|__AVX__|__aarch64__|__arm__|__ARM_FP|__riscv_flen|__s390x__|__powerpc64__|__wasm__|__wasm_simd128__|__builtin_shufflevector|__builtin_convertvector|__builtin_prefetch|__builtin_fabs)$' | sed "s/^/$header:/")"

    rule "$header: includes only the C standard library$([ $ours = 1 ] && echo ' and the other headers')" "$(
        grep -nE '^ *# *include' "$work/code" | grep -vE '<(assert|ctype|errno|float|limits|math|stdarg|stddef|stdint|stdio|stdlib|string)\.h>' |
        if [ $ours = 1 ]; then grep -vE '"gxfem_(boolean|integrate|solve)\.h"'; else cat; fi | sed "s/^/$header:/")"
    rule "$header: no output" "$(grep -nE '\b(printf|puts|fputs|putchar|fprintf|abort|exit) *\(' "$work/code" | sed "s/^/$header:/")"

    rule "$header: no function above 120 lines" "$(awk -v header="$header" '
        /^[A-Za-z].*\) *\{ *$/ || (/^\{/ && before ~ /\)$/) { start = NR; name = /^\{/ ? before : $0 }
        /^}/ && start { if (NR - start > 120) print header ":" start ": " NR - start + 1 " lines: " name; start = 0 }
        { before = $0 }' "$work/code")"

    rule "$header: every helper macro is undefined at the end" "$(grep -oE '^ *# *define '"$(echo "$private" | tr a-z A-Z)"'_[A-Z0-9_]+' "$work/code" | awk '{ print $NF }' | sort -u |
        while read -r macro; do grep -qE "^#undef $macro\$" "$work/code" || echo "$header: $macro"; done)"

    rule "$header: every pragma pushed is popped" "$([ "$(grep -c 'pragma.*push' "$work/code")" -eq "$(grep -c 'pragma.*pop' "$work/code")" ] || echo 'not so')"
done
rule "nothing is left to be done" "$(grep -nE 'TODO|FIXME|XXX|HACK' "$@" examples/* README.md docs/*.md)"
awk '/^```c$/ { inside = 1; next } /^```/ { if (inside) exit } inside' README.md >"$work/readme"
awk 'code || /^#/ { code = 1; print }' examples/embed.c | cmp -s - "$work/readme"
rule "README's program is examples/embed.c" "$([ $? -eq 0 ] || echo 'differs below the opening comment')"
echo "lint: $passed passed, $failed failed"
[ $failed -eq 0 ]
