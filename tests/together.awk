# Makes one program of several tests, so that the headers are compiled once for all of them: compiling takes most of the tests' time.
#     awk -f tests/together.awk tests/test_a.c tests/test_b.c >both.c
# A test is a file whose first lines of code define an implementation and include its header. A name that two of them define is
# given the file's name in front; macros of a file end with it. The program runs the suites one after the other.

function define(name) {
    if (!((FILENAME, name) in defines)) {
        defines[FILENAME, name] = 1
        names[FILENAME] = names[FILENAME] " " name
        files[name]++
    }
}

FNR == 1 { order[++count] = FILENAME }
# What a line defines at the level of the file: a function, a test, a type, a constant, an array, a macro
/^static / {
    line = $0
    sub(/[\[(=;].*/, "", line)
    words = split(line, word, /[ *]+/)
    define(word[words] != "" ? word[words] : word[words - 1])
}
/^START_TEST\(/ { gsub(/^START_TEST\(|\).*/, ""); define($0); define($0 "_fn"); define($0 "_ttest") }
/^typedef struct [a-z_]+ \{/ { define($3) }
/^enum \{/ { line = $0; gsub(/^enum \{|\}.*/, "", line); words = split(line, word, /,/)
    for (i = 1; i <= words; i++) { sub(/=.*/, "", word[i]); gsub(/ /, "", word[i]); define(word[i]) } }
/^int main\(int/ { given[FILENAME] = "1, NULL" }
/^#define [A-Z_]+/ { line = $2; sub(/\(.*/, "", line); macros[FILENAME] = macros[FILENAME] " " line }

END {
    for (i = 1; i <= count; i++) {
        file = order[i]
        suite = file
        gsub(/.*\/|\.c$/, "", suite)
        words = split(names[file], word, " ")
        n = split(macros[file], macro, " ")
        print "#define main main_of_" suite
        for (k = 1; k <= words; k++) if (files[word[k]] > 1) print "#define " word[k] " " suite "_" word[k]
        print "#include \"" file "\""
        for (k = 1; k <= words; k++) if (files[word[k]] > 1) print "#undef " word[k]
        for (k = 1; k <= n; k++) if (macro[k] !~ /IMPLEMENTATION$/) print "#undef " macro[k]
        print "#undef main"
        calls = calls " | main_of_" suite "(" given[file] ")"
    }
    print "int main(void) { return" substr(calls, 3) "; }"
}
