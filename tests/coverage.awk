# Adds up what gcov prints for several programs, and names what no program reaches. tests/coverage.sh calls it.
# In: the counts; variables folder, reasons, programs, least_lines, least_branches. Out: the table and the faults, and the files of
# tests/coverage.sh. Status 1: too little is reached, something is not reached and has no reason, or a reason fits nothing.

function percent(part, all) { return all == 0 ? 100 : 100 * part / all }

function fault(text) { print text; faults++ }

# Reads tests/unreached.txt into row_functions, row_text, row_why
function read_reasons(line, field) {
    while ((getline line <reasons) > 0) {
        if (line ~ /^#/ || line ~ /^ *$/) continue
        if (split(line, field, / \| /) != 3) { fault(reasons ": not FUNCTION | TEXT | REASON: " line); continue }
        row_functions[++rows] = field[1]
        row_text[rows] = field[2]
        row_why[rows] = field[3]
    }
}

# Divides the condition of a line with so many branches into part[1], part[2] ..., one for each pair of branches. Returns their number,
# or 0 if the line is not such a condition.
function divide(text, ways, part, n) {
    gsub(/\/\*[^*]*\*\//, "", text)
    sub(/(&&|\|\|) *$/, "", text)
    n = split(text, part, /&&|\|\||\?/)
    if (text ~ /\?/) n--
    return 2 * n == ways ? n : 0
}

# Does a row name this branch (from 0) of so many, or this line (ways is 0)?
function fits(row, name, text, branch, ways, part, n, i, stands_in_part) {
    if (row_functions[row] != "*" && !index(" " row_functions[row] " ", " " name " ")) return 0
    if (row_text[row] == "*") return 1
    if (!index(text, row_text[row])) return 0
    n = divide(text, ways, part)
    for (i = 1; i <= n; i++)
        if (index(part[i], row_text[row])) stands_in_part = 1
    return !stands_in_part || index(part[int(branch / 2) + 1], row_text[row]) > 0
}

# A piece of the line that names this branch (from 0) of so many, or this line (ways is 0)
function piece(text, branch, ways, part) {
    if (divide(text, ways, part) > 0 && index(text, part[int(branch / 2) + 1])) text = part[int(branch / 2) + 1]
    sub(/ \| .*/, "", text)
    gsub(/^ +| +$/, "", text)
    return text
}

# Notes a line, or a branch of a line that is reached
function miss(kind, header, n, what, branch, ways, name, text, row, where) {
    name = of[header, n]
    text = source[header, n]
    where = header ":" n ": " name ": " what ": " text
    for (row = 1; row <= rows && !fits(row, name, text, branch, ways); row++) {}
    missed[kind, name]++
    all_missed[kind]++
    if (row <= rows) used[row, row_functions[row] == "*" ? "*" : name] = 1
    else {
        nameless[++nameless_count] = where
        if (!(name " | " piece(text, branch, ways) in proposed)) print name " | " piece(text, branch, ways) " | " >(folder "/rows.txt")
        proposed[name " | " piece(text, branch, ways)] = 1
    }
    print where (row <= rows ? "   [" row_why[row] "]" : "") >(folder "/unreached.txt")
}

# One line of the table
function tell(name, lines, reached, ways, taken) {
    printf "%-20s %8d %8d %7.2f   %8d %8d %7.2f\n", name, lines, reached, percent(reached, lines), ways, taken, percent(taken, ways) >(folder "/coverage.txt")
}

# Counts the lines and branches of a header
function add_up(header, lines, reached, ways, taken, n, b) {
    for (n = 1; n <= last[header]; n++) {
        if (!((header, n) in source)) continue
        lines++
        if (executed[header, n] > 0) reached++
        else miss("line", header, n, "line not reached", 0, 0)
        for (b = 0; b < branches[header, n]; b++) {
            ways++
            if (went[header, n, b] > 0) taken++
            else if (executed[header, n] > 0) miss("branch", header, n, "branch " b + 1 " of " branches[header, n] " not taken", b, branches[header, n])
            else missed["branch", of[header, n]]++
        }
    }
    tell(header, lines, reached, ways, taken)
    all_lines += lines
    all_reached += reached
    all_ways += ways
    all_taken += taken
}

# Each function of a row must have something that the row names.
function check_rows(row, n, i, name) {
    for (row = 1; row <= rows; row++) {
        n = split(row_functions[row], name, / +/)
        for (i = 1; i <= n; i++)
            if (!((row, name[i]) in used)) fault("tests/unreached.txt names what is reached, or not there: " name[i] " | " row_text[row])
    }
}

# What is not reached by function, most first
function list_functions(key, field, names, name, sort) {
    sort = "sort -k1,1nr -k3,3nr >" folder "/functions.txt"
    for (key in missed) { split(key, field, SUBSEP); names[field[2]] = 1 }
    for (name in names) printf "%5d lines %5d branches  %s\n", missed["line", name], missed["branch", name], name | sort
    close(sort)
}

BEGIN {
    header_count = split("gxfem.h gxfem_boolean.h gxfem_integrate.h gxfem_solve.h", headers, " ")
    for (i = 1; i <= header_count; i++) ours[headers[i]] = 1
    read_reasons()
}

# What gcov prints: "count:line:text" for a line, whose count is - without code and ##### without a visit; before it "function NAME
# called ..." where one starts; after it "branch N taken COUNT" or "branch N never executed"
/^ *-: *0:Source:/ { h = $0; sub(/.*[:\/]/, "", h); inside = h in ours; name = ""; next }
!inside { next }
/^function / { name = $2; next }
/^branch / {
    b = branch[h, n]++ + 0
    if (b >= branches[h, n]) branches[h, n] = b + 1
    went[h, n, b] += $3 == "taken" ? $4 : 0
    next
}
/^call / { next }
/^ *[-#=0-9]+\*?: *[0-9]+:/ {
    split($0, field, ":")
    n = field[2] + 0
    if (n > last[h]) last[h] = n
    branch[h, n] = 0
    if (field[1] ~ /-/) next
    if (!((h, n) in source)) {
        text = substr($0, length(field[1]) + length(field[2]) + 3)
        sub(/^ +/, "", text)
        source[h, n] = text
        of[h, n] = name
    }
    executed[h, n] += field[1] ~ /[#=]/ ? 0 : field[1] + 0
}

END {
    printf "" >(folder "/unreached.txt")
    printf "" >(folder "/rows.txt")
    printf "%-20s %8s %8s %7s   %8s %8s %7s\n", "", "lines", "reached", "%", "branches", "reached", "%" >(folder "/coverage.txt")
    for (i = 1; i <= header_count; i++) add_up(headers[i])
    tell("all", all_lines, all_reached, all_ways, all_taken)
    printf "%d programs; not reached: %d lines, and %d branches of others\n", programs, all_missed["line"], all_missed["branch"] >(folder "/coverage.txt")
    close(folder "/coverage.txt")
    while ((getline line <(folder "/coverage.txt")) > 0) print line
    list_functions()
    if (nameless_count > 0) fault("not reached, and not named in tests/unreached.txt:")
    for (i = 1; i <= nameless_count; i++) print nameless[i]
    check_rows()
    if (percent(all_reached, all_lines) < least_lines) fault("fewer than " least_lines " % of the lines are reached")
    if (percent(all_taken, all_ways) < least_branches) fault("fewer than " least_branches " % of the branches are reached")
    exit faults > 0
}
