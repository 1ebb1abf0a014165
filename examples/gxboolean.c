/* gxboolean: Booleans of closed triangle surfaces, and their splitting by sheets, with gxfem_boolean.h alone.

   gxboolean SURFACE [--union|--intersection|--difference|--symmetric|--split SURFACE]... [options], or, as a runner of
   the Open Boolean Benchmark, gxboolean --request FILE --result FILE [options]; `gxboolean --help` says the rest. Exit
   codes: 0 done; 1 the kernel refused a surface or failed; 2 usage error, or a file that can't be read or written. On 1
   and 2 one line on stderr says what, where and why.

   contents
     >>settings    the command line
     >>kernel      operands in, result out
     >>output      a table, a file, a benchmark's results */
#include "gxio.h"

#ifndef GXFEM_LINKED /* make examples compiles the library once for all */
#define GXFEM_BOOLEAN_IMPLEMENTATION
#endif
#include "../gxfem_boolean.h"
#include "gxfailure.h"
#include "gxrunner.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_MISUSED = 2 };

/* -------------------------------------------------------------------------------------------- >>settings */

typedef struct settings {
    const char **surfaces; /* count, as given */
    uint32_t *operations;  /* count, GXB_UNION ... */
    size_t count;
    const char *out;                       /* NULL: no file */
    const char *request, *result, *ending; /* of a benchmark; NULL: none */
    uint32_t rule;
    uint32_t triangulation;
    int fine, mend;
    int help;
} settings;

static const char usage[] =
    "usage: gxboolean SURFACE [OPERATION SURFACE]... [options]\n"
    "       gxboolean --request FILE.json --result FILE.json [options]\n"
    "\n"
    "Combines closed triangle surfaces exactly, one after the other; prints volume and Euler characteristic of each "
    "component.\n"
    "\n"
    "SURFACE  FILE.obj, FILE.off, FILE.stl, FILE.vtk, or box:X0,Y0,Z0,X1,Y1,Z1; to split by: also a file of an open "
    "surface,\n"
    "         plane:PX,PY,PZ,NX,NY,NZ or wave:PX,PY,PZ,NX,NY,NZ,AMPLITUDE,WAVELENGTH, across the first surface\n"
    "\n"
    "  --union SURFACE, --intersection SURFACE, --difference SURFACE, --symmetric SURFACE\n"
    "                      what the surface does to what there is\n"
    "  --split SURFACE     separates what lies on its two sides\n"
    "  --rule NAME         inside is where surfaces wind nonzero (default), positive, negative or odd times\n"
    "  --coarse            each source face in as few triangles as its outline allows\n"
    "  --merged            the same of faces beside each other in one plane\n"
    "  --fine              vertices are the doubles nearest to the exact points\n"
    "  --mend              the same, and triangles that this turns over are mended\n"
    "  --out FILE          writes the result as FILE.off, FILE.stl, or as FILE.obj with an object per component\n"
    "  --request FILE, --result FILE\n"
    "                      runs the operations of a request of the Open Boolean Benchmark, says in the result how they "
    "went\n"
    "  --format NAME       of the surfaces that a request makes: off (default), obj or stl\n"
    "  --help              this text\n";

/* GXB_UNION ... */
static const char *const operations[] = {"--union", "--intersection", "--difference", "--symmetric", "--split"};
/* GXB_NONZERO ... */
static const char *const rules[] = {"nonzero", "positive", "negative", "odd"};
/* What else takes a value */
static const char *const valued[] = {"--rule", "--out", "--request", "--result", "--format"};
static const char *const formats[] = {"off", "obj", "stl"};
static const char *const endings[] = {".off", ".obj", ".stl"};

/* Where a word stands in a list; the list's length if it does not. */
static uint32_t find_word(const char *word, const char *const *list, uint32_t count) {
    uint32_t i;
    for (i = 0; i < count && strcmp(word, list[i]) != 0; i++) {}
    return i;
}

static int take_flag(settings *set, const char *name) {
    if (strcmp(name, "--coarse") == 0)
        set->triangulation = GXB_COARSE;
    else if (strcmp(name, "--merged") == 0)
        set->triangulation = GXB_MERGED;
    else if (strcmp(name, "--fine") == 0)
        set->fine = 1;
    else if (strcmp(name, "--mend") == 0)
        set->mend = 1;
    else if (strcmp(name, "--help") == 0)
        set->help = 1;
    else
        return 0;
    return 1;
}

static int take_value(settings *set, const char *name, const char *value, gxio_error *error) {
    const uint32_t operation = find_word(name, operations, 5);
    uint32_t format;
    if (operation < 5) {
        if (set->count == 0) return gxio_fail(error, name, 0, "comes before the first surface");
        set->operations[set->count] = operation;
        set->surfaces[set->count++] = value;
        return 1;
    }
    switch (find_word(name, valued, 5)) {
    case 0:
        set->rule = find_word(value, rules, 4);
        return set->rule < 4 ? 1
                             : gxio_fail(error, name, 0, "'%s' is none of nonzero, positive, negative and odd", value);
    case 1:
        set->out = value;
        return gxio_is_surface_name(value)
                 ? 1
                 : gxio_fail(error, name, 0, "'%s' does not end in .off, .obj or .stl", value);
    case 2: set->request = value; return 1;
    case 3: set->result = value; return 1;
    default:
        format = find_word(value, formats, 3);
        if (format == 3) return gxio_fail(error, name, 0, "'%s' is none of off, obj and stl", value);
        set->ending = endings[format];
        return 1;
    }
}

/* A request, or surfaces, and no option of the other */
static int check_purpose(const settings *set, gxio_error *error) {
    if (set->help) return 1;
    if (!set->request && !set->result) {
        if (set->ending)
            return gxio_fail(error, "--format", 0, "belongs to --request; --out has its format by its name");
        if (set->count > 0) return 1;
        return gxio_fail(error, "usage", 0, "gxboolean SURFACE [OPERATION SURFACE]..., see gxboolean --help");
    }
    if (!set->request || !set->result)
        return gxio_fail(error, set->request ? "--request" : "--result", 0,
                         "needs the other of --request and --result");
    if (set->count > 0 || set->out)
        return gxio_fail(error, "--request", 0, "names all surfaces: none may stand beside it, nor --out");
    return 1;
}

static int take_arguments(settings *set, int argc, char **argv, gxio_error *error) {
    int i;
    for (i = 1; i < argc; i++) {
        const char *name = argv[i];
        if (name[0] != '-') {
            if (set->count > 0) return gxio_fail(error, name, 0, "has no operation before it");
            set->operations[set->count] = GXB_UNION;
            set->surfaces[set->count++] = name;
        } else if (!take_flag(set, name)) {
            if (find_word(name, operations, 5) == 5 && find_word(name, valued, 5) == 5)
                return gxio_fail(error, name, 0, "unknown option, see gxboolean --help");
            if (++i == argc || strncmp(argv[i], "--", 2) == 0) return gxio_fail(error, name, 0, "needs a value");
            if (!take_value(set, name, argv[i], error)) return 0;
        }
    }
    return check_purpose(set, error);
}

/* ---------------------------------------------------------------------------------------------- >>kernel */

/* Reads a surface and gives it to the Boolean, which copies it. first: the first surface, across which planes go;
 * empty: this is it. */
static int add_surface(const settings *set, size_t i, gxb_boolean *boolean, gxio_surface *first, gxio_error *error) {
    gxio_box body;
    gxio_surface surface;
    gxb_operand operand;
    gx_failure failure;
    gxio_bounds(first->vertices, first->vertex_count, body.low, body.high);
    if (i == 0 && (gxio_after(set->surfaces[0], "plane:") || gxio_after(set->surfaces[0], "wave:"))) {
        gxio_fail(error, set->surfaces[0], 0, "is not closed: it can only split");
        return EXIT_MISUSED;
    }
    if (!gxio_surface_load(set->surfaces[i], &body, &surface, error)) return EXIT_MISUSED;
    memset(&operand, 0, sizeof operand);
    operand.vertices = surface.vertices;
    operand.vertex_count = surface.vertex_count;
    operand.triangles = surface.triangles;
    operand.triangle_count = surface.triangle_count;
    operand.operation = set->operations[i];
    operand.rule = set->rule;
    if (gxb_boolean_add(boolean, &operand, &failure) != GX_OK) {
        const int known = failure.result == GX_ERROR_NOT_CLOSED && failure.index < surface.triangle_count;
        const char *cause = gxfailure_of_surfaces(failure.result);
        gxio_fail(error, set->surfaces[i], known ? surface.triangle_lines[failure.index] : 0, "%s",
                  known ? cause : gxfailure_say(&failure, cause).text);
    }
    if (i == 0)
        *first = surface;
    else
        gxio_surface_release(&surface);
    return failure.result == GX_OK ? EXIT_DONE : EXIT_FAILED;
}

/* A result, and what is known of it */
typedef struct answer {
    gxb_boolean_result result;
    gxb_components components;
    gxb_defects defects;
} answer;

static gx_result ask(gxb_boolean *boolean, answer *a, gx_failure *failure) {
    gx_result result = gxb_boolean_evaluate(boolean, &a->result, failure);
    if (result == GX_OK) result = gxb_boolean_components(boolean, &a->components, failure);
    return result == GX_OK ? gxb_boolean_defects(boolean, &a->defects, failure) : result;
}

static int combine(const settings *set, gxb_boolean **boolean, answer *a, gxio_error *error) {
    gxio_surface first;
    size_t i;
    int code = EXIT_DONE;
    gx_failure failure;
    gx_result failed = gxb_boolean_create(NULL, boolean, &failure);
    memset(&first, 0, sizeof first);
    if (failed == GX_OK) {
        gxb_boolean_set_triangulation(*boolean, set->triangulation, NULL);
        gxb_boolean_set_fine(*boolean, set->fine, NULL);
        gxb_boolean_set_mend(*boolean, set->mend, NULL);
    }
    for (i = 0; i < set->count && failed == GX_OK && code == EXIT_DONE; i++)
        code = add_surface(set, i, *boolean, &first, error);
    gxio_surface_release(&first);
    if (failed == GX_OK && code == EXIT_DONE) failed = ask(*boolean, a, &failure);
    if (failed == GX_OK) return code;
    gxio_fail(error, "Boolean", 0, "%s", gxfailure_say(&failure, gxfailure_of_surfaces(failed)).text);
    return EXIT_FAILED;
}

/* ---------------------------------------------------------------------------------------------- >>output */

static void print_table(const answer *a) {
    const size_t count = a->result.triangle_count;
    size_t c, t;
    printf("component  triangles  Euler  volume\n");
    for (c = 0; c < a->components.count; c++) {
        unsigned long triangles = 0;
        for (t = 0; t < count; t++) triangles += a->components.triangle[t] == c;
        printf("%9lu  %9lu  %5ld  %.17g\n", (unsigned long)c, triangles, (long)a->components.euler[c],
               a->components.volume[c]);
    }
    printf("      all  %9lu         %.17g\n", (unsigned long)count, a->components.total_volume);
    if (a->defects.mended_count > 0 || a->defects.count > 0)
        printf("turned over or flat by rounding: %lu; mended: %lu\n", (unsigned long)a->defects.count,
               (unsigned long)a->defects.mended_count);
}

static int write_answer(const char *path, const answer *a, gxio_error *error) {
    gxio_shell shell;
    memset(&shell, 0, sizeof shell);
    shell.vertices = a->result.vertices;
    shell.vertex_count = a->result.vertex_count;
    shell.triangles = a->result.triangles;
    shell.triangle_count = a->result.triangle_count;
    shell.component = a->components.triangle;
    shell.component_count = a->components.count;
    return gxio_write_surface(path, &shell, error) ? EXIT_DONE : EXIT_MISUSED;
}

/* Runs a request of the Open Boolean Benchmark. */
static int serve(const settings *set, gxio_error *error) {
    gxrunner_options options;
    options.request = set->request;
    options.result = set->result;
    options.ending = set->ending ? set->ending : ".off";
    options.rule = set->rule;
    options.triangulation = set->triangulation;
    options.fine = set->fine;
    options.mend = set->mend;
    switch (gxrunner_serve(&options, error)) {
    case GXRUNNER_DONE: return EXIT_DONE;
    case GXRUNNER_FAILED: gxio_fail(error, set->result, 0, "not all operations succeeded"); return EXIT_FAILED;
    default: return EXIT_MISUSED;
    }
}

int main(int argc, char **argv) {
    settings set;
    gxb_boolean *boolean = NULL;
    answer found;
    gxio_error error;
    int code = EXIT_MISUSED;
    memset(&set, 0, sizeof set);
    set.surfaces = (const char **)gxio_array((size_t)argc + 1, sizeof *set.surfaces);
    set.operations = (uint32_t *)gxio_array((size_t)argc + 1, sizeof *set.operations);
    if (!set.surfaces || !set.operations)
        gxio_fail(&error, "arguments", 0, "out of memory");
    else if (take_arguments(&set, argc, argv, &error))
        code = set.help ? EXIT_DONE : set.request ? serve(&set, &error) : combine(&set, &boolean, &found, &error);
    if (code == EXIT_DONE && set.help)
        fputs(usage, stdout);
    else if (code == EXIT_DONE && !set.request) {
        if (set.out) code = write_answer(set.out, &found, &error);
        if (code == EXIT_DONE) print_table(&found);
    }
    if (code != EXIT_DONE) fprintf(stderr, "gxboolean: %s\n", error.text);
    gxb_boolean_destroy(boolean);
    free(set.surfaces);
    free(set.operations);
    return code;
}
