/* gxboolean: Booleans of closed triangle surfaces, and their splitting by sheets, with gxfem_boolean.h alone.

   gxboolean SURFACE [--union|--intersection|--difference|--symmetric|--split SURFACE]... [options], or, as a runner of
   the Open Boolean Benchmark, gxboolean --request FILE --result FILE [options]; `gxboolean --help` says the rest. Exit
   codes: 0 done; 1 the kernel refused a surface or failed; 2 usage error, or a file that can't be read or written. On 1
   and 2 one line on stderr says what, where and why.

   contents
     >>settings    the command line
     >>kernel      operands in, result out
     >>output      a table, a file
     >>requests    what the Open Boolean Benchmark asks for */
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
    int last_only;
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
    "  --last-only         writes no surface that a later operation of the request takes\n"
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
    else if (strcmp(name, "--last-only") == 0)
        set->last_only = 1;
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
        if (set->last_only) return gxio_fail(error, "--last-only", 0, "belongs to --request");
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

static gxb_operand operand_of(const gxio_surface *surface) {
    gxb_operand operand;
    memset(&operand, 0, sizeof operand);
    operand.vertices = surface->vertices;
    operand.vertex_count = surface->vertex_count;
    operand.triangles = surface->triangles;
    operand.triangle_count = surface->triangle_count;
    return operand;
}

/* Creates a Boolean with the options of the command line. desc may be NULL. */
static gx_result create_boolean(const settings *set, const gxb_boolean_desc *desc, gxb_boolean **boolean,
                                gx_failure *failure) {
    gx_result result = gxb_boolean_create(desc, boolean, failure);
    if (result == GX_OK) result = gxb_boolean_set_triangulation(*boolean, set->triangulation, failure);
    if (result == GX_OK) result = gxb_boolean_set_fine(*boolean, set->fine, failure);
    return result == GX_OK ? gxb_boolean_set_mend(*boolean, set->mend, failure) : result;
}

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
    operand = operand_of(&surface);
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
    gx_result failed = create_boolean(set, NULL, boolean, &failure);
    memset(&first, 0, sizeof first);
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

/* --------------------------------------------------------------------------------------------- >>requests */
/* Solids of a request are exact: only what is written is rounded. So a solid is an expression of files' surfaces. A
   chain starts with a surface and combines it with further surfaces one by one: one Boolean is kept for all of it, and
   computes what is new. Any other expression gets a Boolean of its surfaces, and is evaluated point by point. */

typedef struct solid {
    int is_chain;         /* or a file */
    size_t before;        /* of a chain: the solid that it extends */
    size_t first;         /* of a chain: the argument that is that solid */
    gxb_boolean *boolean; /* of a chain that is extended later, and of the latest solid */
} solid;

/* What the engine has of a run */
typedef struct expressions {
    solid *solids;
    size_t *leaves; /* solids of files, by operand */
    size_t latest;  /* the solid of which `found` is the result */
    size_t expressed;
    unsigned char *needed, *inside; /* by solid */
    uint32_t rule;
    gxb_boolean_result found;
    /* the surface that is written: vertices that a triangle has */
    double *vertices;
    uint32_t *triangles, *number;
} expressions;

static expressions *expressions_of(const gxrunner_run *run) { return (expressions *)run->native; }

static const settings *settings_of(const gxrunner_run *run) { return (const settings *)run->engine->settings; }

static int is_file(const gxrunner_run *run, size_t i) { return run->solids[i].operation == GXRUNNER_LOAD; }

/* Does solid i extend a chain by files? Unions and intersections may take the chain as any of their arguments. */
static void find_chain(gxrunner_run *run, size_t i) {
    const gxrunner_solid *s = &run->solids[i];
    solid *own = &expressions_of(run)->solids[i];
    size_t k, others = 0;
    own->is_chain = s->operation == GXRUNNER_LOAD;
    if (s->arg_count == 0) return;
    for (k = 0; k < s->arg_count; k++)
        if (!is_file(run, s->args[k])) {
            others++;
            own->first = k;
        }
    own->before = s->args[own->first];
    own->is_chain = others <= 1 && (own->first == 0 || s->operation != GXRUNNER_DIFFERENCE) &&
                    expressions_of(run)->solids[own->before].is_chain;
}

static int start_run(gxrunner_run *run, gxrunner_outcome *o) {
    expressions *e = (expressions *)calloc(1, sizeof *e);
    size_t i;
    run->native = e;
    if (e) {
        e->rule = settings_of(run)->rule;
        e->solids = (solid *)calloc(run->count + 1, sizeof *e->solids);
        e->leaves = (size_t *)gxio_array(run->count + 1, sizeof *e->leaves);
        e->needed = (unsigned char *)malloc(run->count + 1);
        e->inside = (unsigned char *)malloc(run->count + 1);
    }
    if (!e || !e->solids || !e->leaves || !e->needed || !e->inside) {
        o->status = "crash";
        return gxio_fail(&o->error, "request", 0, "out of memory");
    }
    for (i = 0; i < run->count; i++) find_chain(run, i);
    return 1;
}

static void stop_run(gxrunner_run *run) {
    expressions *e = expressions_of(run);
    size_t i;
    for (i = 0; e->solids && i < run->count; i++) gxb_boolean_destroy(e->solids[i].boolean);
    free(e->solids);
    free(e->leaves);
    free(e->needed);
    free(e->inside);
    free(e->vertices);
    free(e->triangles);
    free(e->number);
    free(e);
}

static gx_result add_file(const gxrunner_run *run, gxb_boolean *boolean, size_t file, uint32_t operation,
                          gx_failure *failure) {
    gxb_operand operand = operand_of(&run->solids[file].surface);
    operand.operation = operation;
    operand.rule = expressions_of(run)->rule;
    return gxb_boolean_add(boolean, &operand, failure);
}

/* Adds what solid i adds to its chain. */
static gx_result extend_chain(const gxrunner_run *run, gxb_boolean *boolean, size_t i, gx_failure *failure) {
    /* by GXRUNNER_UNION ... */
    static const uint32_t kernel[] = {GXB_UNION, GXB_INTERSECTION, GXB_DIFFERENCE};
    const gxrunner_solid *s = &run->solids[i];
    const size_t first = expressions_of(run)->solids[i].first;
    gx_result result = GX_OK;
    size_t k;
    if (is_file(run, i)) return add_file(run, boolean, i, GXB_UNION, failure);
    for (k = 0; k < s->arg_count && result == GX_OK; k++)
        if (k != first) result = add_file(run, boolean, s->args[k], kernel[s->operation], failure);
    return result;
}

/* The Boolean of a chain: the one that the solid before has left, or one of all its surfaces */
static gx_result open_chain(gxrunner_run *run, size_t i, gx_failure *failure) {
    expressions *e = expressions_of(run);
    solid *own = &e->solids[i], *before = &e->solids[own->before];
    gx_result result;
    size_t at, count = 0;
    if (before->boolean) { /* solids that need it later start anew */
        own->boolean = before->boolean;
        before->boolean = NULL;
        return extend_chain(run, own->boolean, i, failure);
    }
    for (at = i; !is_file(run, at); at = e->solids[at].before) e->leaves[count++] = at;
    e->leaves[count++] = at;
    result = create_boolean(settings_of(run), NULL, &own->boolean, failure);
    if (result == GX_OK && run->solids[i].last_use > i) result = gxb_boolean_set_retained(own->boolean, 1, failure);
    while (count > 0 && result == GX_OK) result = extend_chain(run, own->boolean, e->leaves[--count], failure);
    return result;
}

static int counts_as_inside(int32_t winding, uint32_t rule) {
    switch (rule) {
    case GXB_POSITIVE: return winding > 0;
    case GXB_NEGATIVE: return winding < 0;
    case GXB_ODD: return winding & 1;
    default: return winding != 0;
    }
}

/* Is a point with these winding numbers inside the expressed solid? */
static int is_inside(void *user, const int32_t *winding, size_t operand_count) {
    const gxrunner_run *run = (const gxrunner_run *)user;
    const expressions *e = expressions_of(run);
    size_t i, k;
    for (i = 0; i < operand_count; i++) e->inside[e->leaves[i]] = (unsigned char)counts_as_inside(winding[i], e->rule);
    for (i = 0; i <= e->expressed; i++) {
        const gxrunner_solid *s = &run->solids[i];
        int inside;
        if (!e->needed[i] || is_file(run, i)) continue;
        inside = e->inside[s->args[0]];
        for (k = 1; k < s->arg_count; k++) {
            const int other = e->inside[s->args[k]];
            if (s->operation == GXRUNNER_UNION)
                inside = inside || other;
            else
                inside = inside && other == (s->operation == GXRUNNER_INTERSECTION);
        }
        e->inside[i] = (unsigned char)inside;
    }
    return e->inside[e->expressed];
}

static gx_result open_expression(gxrunner_run *run, size_t i, gx_failure *failure) {
    expressions *e = expressions_of(run);
    gxb_boolean_desc desc;
    gx_result result;
    size_t at, k, count = 0;
    memset(e->needed, 0, run->count);
    e->needed[i] = 1;
    for (at = i + 1; at-- > 0;) {
        if (!e->needed[at]) continue;
        if (is_file(run, at)) e->leaves[count++] = at;
        for (k = 0; k < run->solids[at].arg_count; k++) e->needed[run->solids[at].args[k]] = 1;
    }
    e->expressed = i;
    memset(&desc, 0, sizeof desc);
    desc.inside = is_inside;
    desc.user = run;
    result = create_boolean(settings_of(run), &desc, &e->solids[i].boolean, failure);
    for (k = 0; k < count && result == GX_OK; k++)
        result = add_file(run, e->solids[i].boolean, e->leaves[k], GXB_UNION, failure);
    return result;
}

static const char *status_of(gx_result result) {
    switch (result) {
    case GX_ERROR_NOT_CLOSED:
    case GX_ERROR_NOT_FINITE:
    case GX_ERROR_RANGE:
    case GX_ERROR_EMPTY: return "invalid_input";
    case GX_ERROR_LIMIT: return "unsupported";
    default: return "crash";
    }
}

static int combine_solids(gxrunner_run *run, size_t i, gxrunner_outcome *o) {
    expressions *e = expressions_of(run);
    gx_failure failure;
    gx_result result = e->solids[i].is_chain ? open_chain(run, i, &failure) : open_expression(run, i, &failure);
    if (!e->solids[e->latest].is_chain || run->solids[e->latest].last_use <= i) {
        gxb_boolean_destroy(e->solids[e->latest].boolean);
        e->solids[e->latest].boolean = NULL;
    }
    e->latest = i;
    if (result == GX_OK) result = gxb_boolean_evaluate(e->solids[i].boolean, &e->found, &failure);
    if (result == GX_OK) return 1;
    o->status = status_of(result);
    return gxio_fail(&o->error, "Boolean", 0, "%s", gxfailure_say(&failure, gxfailure_of_surfaces(result)).text);
}

/* A retained result may have vertices that no triangle has; the written surface has none of them. */
static int output_solid(gxrunner_run *run, size_t i, gxio_shell *shell, gxrunner_outcome *o) {
    expressions *e = expressions_of(run);
    const gxb_boolean_result *found = &e->found;
    const size_t corners = 3 * found->triangle_count;
    size_t k, count = 0;
    (void)i; /* the latest */
    free(e->vertices);
    free(e->triangles);
    free(e->number);
    e->vertices = (double *)gxio_array(found->vertex_count + 1, 3 * sizeof(double));
    e->triangles = (uint32_t *)gxio_array(corners + 1, sizeof(uint32_t));
    e->number = (uint32_t *)calloc(found->vertex_count + 1, sizeof(uint32_t));
    if (!e->vertices || !e->triangles || !e->number) {
        o->status = "crash";
        return gxio_fail(&o->error, "result", 0, "out of memory");
    }
    for (k = 0; k < corners; k++) e->number[found->triangles[k]] = 1;
    for (k = 0; k < found->vertex_count; k++) {
        if (!e->number[k]) continue;
        memcpy(e->vertices + 3 * count, found->vertices + 3 * k, 3 * sizeof(double));
        e->number[k] = (uint32_t)count++;
    }
    for (k = 0; k < corners; k++) e->triangles[k] = e->number[found->triangles[k]];
    shell->vertices = e->vertices;
    shell->vertex_count = count;
    shell->triangles = e->triangles;
    shell->triangle_count = found->triangle_count;
    return 1;
}

/* Runs a request of the Open Boolean Benchmark. */
static int serve(settings *set, gxio_error *error) {
    gxrunner_options options;
    gxrunner_engine engine;
    options.request = set->request;
    options.result = set->result;
    options.ending = set->ending ? set->ending : ".off";
    options.last_only = set->last_only;
    engine.settings = set;
    engine.start = start_run;
    engine.stop = stop_run;
    engine.load = NULL;
    engine.combine = combine_solids;
    engine.output = output_solid;
    switch (gxrunner_serve(&options, &engine, error)) {
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
