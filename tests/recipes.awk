# The C snippets of a page, in their order, as one file; compilers name lines of the page.
# usage: awk -f tests/recipes.awk docs/RECIPES.md
/^```c$/ { inside = 1; printf("#line %d \"%s\"\n", FNR + 1, FILENAME); next }
/^```/ { inside = 0; next }
inside
