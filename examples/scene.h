/* scene.h: what the scenes share, over gxio.h and gxfem.h. Include it in place of both.

   A scene reads

       scene s;
       scene_sheet blade;
       scene_open(&s, &desc, argc, argv);               command line, mesh; s.body_desc and s.step are the papers'
       scene_make(&s);                                  the body
       blade = scene_flat_sheet(&s, ...);
       for (; s.frame < s.frames; scene_step(&s)) scene_advance(&s, &blade, 0.1, 0.9);
       scene_check(&s, s.view.fragment_count == 2, "fragments: %u (2)", ...);
       return scene_close(&s);

   contents
     >>types       scene, sheets, times
     >>failure     one line of text, exit code
     >>memory      an allocator that counts
     >>arguments   the command line
     >>body        mesh, body; closed surfaces, a body of them
     >>sheets      surfaces that advance strip by strip
     >>trace       the run as a file, for other programs to repeat
     >>cuts        a cut, and the record of all
     >>blade       an edge in space that cuts while the body moves
     >>skin        the visual surface: the one place that knows how gxfem.h gives it
     >>frames      steps, times, files, progress bar
     >>measures    what a scene is judged by
     >>report      checks, the line of the table

   Exit codes: 0 all checks hold; 1 one does not, or a cut or a step failed; 2 usage error, or a file that can't be
   written. */
#ifndef SCENE_H
#define SCENE_H

#include "gxio.h"

#ifndef GXFEM_LINKED /* make examples compiles the library once for all scenes */
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "gxfailure.h"

#ifdef _WIN32
#include <io.h>
#define SCENE_STDERR_IS_TERMINAL (_isatty(2) != 0)
#else
#include <unistd.h>
#define SCENE_STDERR_IS_TERMINAL (isatty(2) != 0)
#endif

/* --------------------------------------------------------------------------------------------- >>types */

typedef struct scene_desc {
    const char *name, *about;      /* about: one line */
    const char *mesh, *small_mesh; /* as gxio_mesh_load takes them; small_mesh NULL: the same; mesh NULL: none */
    int any_mesh;                  /* not 0: --mesh may name another, --shape a closed surface */
    uint32_t frames, small_frames;
    uint32_t cells, small_cells; /* of the grid of a body of its own; above 0: --cells may ask for others */
    int has_csv;                 /* not 0: --csv names a file for figures of the scene's own */
    uint32_t least_frames;       /* with fewer there is nothing to see; 0: any number will do */
} scene_desc;

/* Seconds of a frame, or their sums */
enum {
    SCENE_ARRANGEMENT,
    SCENE_ENRICHMENT,
    SCENE_INTEGRALS,
    SCENE_MODEL,
    SCENE_LINEARISE,
    SCENE_PREPARE,
    SCENE_SOLVE,
    SCENE_FORCES, /* energies and forces of the step: what is left of it */
    SCENE_SKIN,   /* view, skin, positions of its vertices */
    SCENE_PHASES
};

typedef struct scene_memory {
    size_t now, peak; /* bytes */
    uint32_t left;    /* above 0: that many calls for memory are left, the last of which fails */
} scene_memory;

/* A surface of (along + 1) x (across + 1) points, cut column by column: neighbouring strips have the same vertices, bit
 * by bit. */
typedef struct scene_sheet {
    double *vertices;    /* column by column, x 3 */
    uint32_t *triangles; /* of the whole sheet, 2 x along x across x 3 */
    uint32_t along, across;
    uint32_t done; /* columns cut so far */
} scene_sheet;

/* Where the sheet is at a (along) and b (across), both from 0 to 1 */
typedef void (*scene_point_fn)(const void *user, double a, double b, double *x);

/* A blade, and what its cuts were like */
typedef struct scene_blade {
    gx_blade *blade; /* the body's */
    size_t layers;   /* most at once */
    double deviation, min_link_ratio;
} scene_blade;

/* The body's surface as triangles, and where its vertices come from */
typedef struct scene_skin {
    gxio_triangles triangles;      /* as files take them */
    double *positions;             /* triangles.vertex_count x 3, deformed; owned */
    float *normals;                /* triangles.vertex_count x 3; owned */
    const uint32_t *vertex_point;  /* triangles.vertex_count */
    const uint32_t *vertex_copies; /* x 4 */
    const double *vertex_weights;  /* x 4 */
} scene_skin;

typedef struct scene {
    scene_desc desc;
    int small, quiet, help;
    uint32_t frame, frames, every; /* frame: of the next step */
    const char *mesh_name, *shape_name, *out, *format, *table, *csv, *trace;
    FILE *trace_stream; /* NULL: nothing traced yet */
    gx_region *regions; /* region_count, what is held; owned */
    size_t region_count;
    gxio_mesh mesh;         /* may be moved before scene_make */
    gxio_surface shape;     /* the closed surface that stands in its place, if it has triangles */
    uint32_t cells;         /* of the shape's grid along its longest side */
    double volume;          /* of the body before any cut, m3 */
    gx_step_report report;  /* of the last step */
    gx_body_desc body_desc; /* may be changed before scene_make */
    gx_step_desc step;      /* may be changed at any time */
    gx_body *body;
    gx_view view;
    scene_skin skin;  /* of the last step */
    int looked;       /* view and skin are those of the body as it is cut now */
    gx_surface *cuts; /* cut_count, every surface so far; they and their arrays owned */
    size_t cut_count;
    size_t first_copies, cut_triangles;
    unsigned long first_unknowns;
    scene_memory memory;
    double frame_seconds[SCENE_PHASES], frame_cut, sum[SCENE_PHASES], sum_frames, worst_frame;
    uint32_t clock_calls; /* in this step */
    double solver_start;  /* when the solver first looked at the clock in this step; below 0: not yet */
    uint32_t cut_frames, frames_written;
    gxio_page page;         /* of --format html */
    int has_page, has_mesh; /* the page is open; it has the triangles of the skin */
    int bar;                /* a progress bar stands on stderr */
    uint32_t checks, wrong;
    gx_failure failure; /* of the last call on the body that was given it */
    gxio_error error;
} scene;

/* ------------------------------------------------------------------------------------------- >>failure */

enum { SCENE_RIGHT = 0, SCENE_WRONG = 1, SCENE_MISUSED = 2 };

static inline void scene_end_bar(scene *s) {
    if (s->bar) fputc('\n', stderr);
    s->bar = 0;
}

/* Says what is in s->error and ends the program. */
static inline void scene_quit(scene *s, int code) {
    scene_end_bar(s);
    fprintf(stderr, "%s: %s\n", s->desc.name, s->error.text);
    exit(code);
}

static inline void scene_misuse(scene *s, const char *what, const char *cause) {
    gxio_fail(&s->error, what, 0, "%s", cause);
    scene_quit(s, SCENE_MISUSED);
}

/* Ends the program where a call on the body failed: "NAME: what: field index: cause" */
static inline void scene_must(scene *s, gx_result result, const char *what) {
    if (result == GX_OK) return;
    if (s->failure.result == result)
        gxio_fail(&s->error, what, 0, "%s", gxfailure_say(&s->failure, gx_result_text(result)).text);
    else
        gxio_fail(&s->error, what, 0, "%s", gx_result_text(result));
    scene_quit(s, SCENE_WRONG);
}

/* count x size bytes, zeroed, or the end of the program */
static inline void *scene_array(scene *s, size_t count, size_t size) {
    void *array = gxio_array(count, size);
    scene_must(s, array ? GX_OK : GX_ERROR_MEMORY, "memory");
    return memset(array, 0, count * size);
}

/* -------------------------------------------------------------------------------------------- >>memory */

static inline int scene_is_out_of_memory(scene_memory *memory) { return memory->left > 0 && --memory->left == 0; }

static inline void *scene_allocate(void *user, size_t size) {
    scene_memory *memory = (scene_memory *)user;
    void *bytes = scene_is_out_of_memory(memory) ? NULL : malloc(size);
    if (bytes) memory->now += size;
    if (memory->now > memory->peak) memory->peak = memory->now;
    return bytes;
}

static inline void scene_release(void *user, void *bytes, size_t size) {
    ((scene_memory *)user)->now -= size;
    free(bytes);
}

static inline void *scene_reallocate(void *user, void *bytes, size_t size, size_t larger) {
    scene_memory *memory = (scene_memory *)user;
    void *moved = scene_is_out_of_memory(memory) ? NULL : realloc(bytes, larger);
    if (moved) memory->now += larger - size;
    if (memory->now > memory->peak) memory->peak = memory->now;
    return moved;
}

/* ----------------------------------------------------------------------------------------- >>arguments */

static inline uint32_t scene_default_cells(const scene *s) { return s->desc.cells ? s->desc.cells : 16; }

static inline void scene_usage(const scene *s) {
    printf("usage: %s [options]\n\n%s\n\n", s->desc.name, s->desc.about);
    puts("  --small             a smaller scene, for tests");
    printf("  --frames N          steps and frames (%lu; %lu with --small)\n", (unsigned long)s->desc.frames,
           (unsigned long)s->desc.small_frames);
    if (s->desc.has_csv) puts("  --csv FILE          appends the scene's figures to it");
    if (s->desc.cells)
        printf("  --cells N           cubes of the grid along the body's longest side (%lu)\n",
               (unsigned long)scene_default_cells(s));
    if (s->desc.any_mesh)
        printf("  --mesh MESH         a file or a generated mesh, as gxcut takes them (%s)\n"
               "  --shape CUT         in its place: the body is all inside of a closed surface, as gxcut takes them\n"
               "  --cells N           cubes of the grid along the shape's longest side (%lu)\n",
               s->desc.mesh, (unsigned long)scene_default_cells(s));
    puts("  --out DIR           writes frames there\n"
         "  --every N           only each N-th of them (1)\n"
         "  --format vtu|obj|html\n"
         "                      frames for ParaView with a collection frames.pvd (default), Wavefront, or one page "
         "that a\n"
         "                      browser plays: --out then names that file\n"
         "  --table FILE        appends the scene's line of the table of all scenes\n"
         "  --trace FILE        writes mesh, material, state and cuts there, for bench/ to repeat\n"
         "  --quiet             prints only what is wrong\n"
         "  --help              this text");
}

static inline void scene_read_count(scene *s, const char *name, const char *value, uint32_t *count) {
    int64_t number;
    if (!gxio_parse_integer(value, value + strlen(value), &number) || number < 1 || number > 1000000)
        scene_misuse(s, name, "needs a count from 1 to 1000000");
    *count = (uint32_t)number;
}

static inline int scene_take_flag(scene *s, const char *name) {
    if (strcmp(name, "--small") == 0)
        s->small = 1;
    else if (strcmp(name, "--quiet") == 0)
        s->quiet = 1;
    else if (strcmp(name, "--help") == 0)
        s->help = 1;
    else
        return 0;
    return 1;
}

static inline int scene_take_value(scene *s, const char *name, const char *value) {
    if (strcmp(name, "--frames") == 0)
        scene_read_count(s, name, value, &s->frames);
    else if (strcmp(name, "--every") == 0)
        scene_read_count(s, name, value, &s->every);
    else if (strcmp(name, "--out") == 0)
        s->out = value;
    else if (strcmp(name, "--format") == 0)
        s->format = value;
    else if (strcmp(name, "--table") == 0)
        s->table = value;
    else if (strcmp(name, "--trace") == 0)
        s->trace = value;
    else if (strcmp(name, "--csv") == 0 && s->desc.has_csv)
        s->csv = value;
    else if (strcmp(name, "--mesh") == 0 && s->desc.any_mesh)
        s->mesh_name = value;
    else if (strcmp(name, "--shape") == 0 && s->desc.any_mesh)
        s->shape_name = value;
    else if (strcmp(name, "--cells") == 0 && (s->desc.any_mesh || s->desc.cells))
        scene_read_count(s, name, value, &s->cells);
    else
        return 0;
    return 1;
}

static inline int scene_is_format(const scene *s, const char *format) { return strcmp(s->format, format) == 0; }

static inline void scene_take_arguments(scene *s, int argc, char **argv) {
    int i;
    for (i = 1; i < argc; i++) {
        if (scene_take_flag(s, argv[i])) continue;
        if (!scene_take_value(s, argv[i], i + 1 < argc ? argv[i + 1] : "1"))
            scene_misuse(s, argv[i], "unknown option, see --help");
        if (++i >= argc) scene_misuse(s, argv[i - 1], "needs a value");
    }
    if (!scene_is_format(s, "vtu") && !scene_is_format(s, "obj") && !scene_is_format(s, "html"))
        scene_misuse(s, "--format", "must be vtu, obj or html");
    if (!s->cells) s->cells = s->small && s->desc.small_cells ? s->desc.small_cells : scene_default_cells(s);
    if (s->frames && s->frames < s->desc.least_frames) {
        gxio_fail(&s->error, "--frames", 0, "needs at least %lu", (unsigned long)s->desc.least_frames);
        scene_quit(s, SCENE_MISUSED);
    }
    if (!s->frames) s->frames = s->small ? s->desc.small_frames : s->desc.frames;
    if (s->mesh_name && s->shape_name) scene_misuse(s, "--shape", "stands in place of a mesh");
    if (!s->mesh_name && !s->shape_name)
        s->mesh_name = s->small && s->desc.small_mesh ? s->desc.small_mesh : s->desc.mesh;
}

/* ---------------------------------------------------------------------------------------------- >>body */

/* The parameters of GXFEM section 5 */
static inline void scene_set_defaults(scene *s) {
    s->body_desc.young = 1e6;
    s->body_desc.poisson = 0.4;
    s->body_desc.density = 1000.0;
    s->step.dt = 0.033;
    s->step.gravity[2] = -9.81;
    s->step.newton_iterations = 1;
}

/* Reads the command line and the mesh, or the surface in its place. */
static inline void scene_open(scene *s, const scene_desc *desc, int argc, char **argv) {
    const gxio_box unit = {{0, 0, 0}, {1, 1, 1}};
    memset(s, 0, sizeof *s);
    s->desc = *desc;
    s->every = 1;
    s->format = "vtu";
    scene_set_defaults(s);
    scene_take_arguments(s, argc, argv);
    if (s->help) {
        scene_usage(s);
        exit(SCENE_RIGHT);
    }
    if (s->mesh_name && !gxio_mesh_load(s->mesh_name, &s->mesh, &s->error)) scene_quit(s, SCENE_MISUSED);
    if (s->shape_name && !gxio_surface_load(s->shape_name, &unit, &s->shape, &s->error)) scene_quit(s, SCENE_MISUSED);
    if (s->out && !scene_is_format(s, "html") && !gxio_make_directory(s->out, &s->error)) scene_quit(s, SCENE_MISUSED);
    if (!s->quiet) printf("%s: %s\n", s->desc.name, s->desc.about);
}

/* Multiplies the coordinates of the mesh, or of the surface in its place. */
static inline void scene_scale(scene *s, double x, double y, double z) {
    const double factor[3] = {x, y, z};
    size_t i;
    for (i = 0; i < 3 * s->mesh.node_count; i++) s->mesh.positions[i] *= factor[i % 3];
    for (i = 0; i < 3 * s->shape.vertex_count; i++) s->shape.vertices[i] *= factor[i % 3];
}

/* The box around the mesh, or around the surface in its place */
static inline void scene_bounds(const scene *s, double low[3], double high[3]) {
    if (s->shape.vertex_count)
        gxio_bounds(s->shape.vertices, s->shape.vertex_count, low, high);
    else
        gxio_bounds(s->mesh.positions, s->mesh.node_count, low, high);
}

/* Nodes that elements use, in their order; the others go. */
static inline void scene_drop_nodes(scene *s) {
    uint32_t *number = (uint32_t *)scene_array(s, s->mesh.node_count, sizeof *number), count = 0;
    size_t i;
    for (i = 0; i < 4 * s->mesh.element_count; i++) number[s->mesh.elements[i]] = 1;
    for (i = 0; i < s->mesh.node_count; i++)
        if (number[i]) {
            memmove(s->mesh.positions + 3 * (size_t)count, s->mesh.positions + 3 * i, 3 * sizeof(double));
            number[i] = count++;
        }
    for (i = 0; i < 4 * s->mesh.element_count; i++) s->mesh.elements[i] = number[s->mesh.elements[i]];
    s->mesh.node_count = count;
    free(number);
}

/* Keeps the elements whose centre is wanted, and the nodes that they use. */
static inline void scene_keep(scene *s, int (*wanted)(const void *user, const double center[3]), const void *user) {
    size_t e, kept = 0, i, k;
    for (e = 0; e < s->mesh.element_count; e++) {
        const uint32_t *corner = s->mesh.elements + 4 * e;
        double center[3] = {0, 0, 0};
        for (i = 0; i < 4; i++)
            for (k = 0; k < 3; k++) center[k] += 0.25 * s->mesh.positions[3 * (size_t)corner[i] + k];
        if (wanted(user, center)) memmove(s->mesh.elements + 4 * kept++, corner, 4 * sizeof *corner);
    }
    s->mesh.element_count = kept;
    scene_drop_nodes(s);
}

static inline size_t scene_affine_copies(const scene *s) {
    size_t c, count = 0;
    for (c = 0; s->view.copy_affine && c < s->view.copy_count; c++) count += s->view.copy_affine[c];
    return count;
}

/* Displacements and, of affine copies, motions */
static inline unsigned long scene_unknowns(const scene *s) {
    return 3 * (unsigned long)s->view.copy_count + 9 * (unsigned long)scene_affine_copies(s);
}

static inline void scene_create(scene *s) {
    gx_body_desc *desc = &s->body_desc;
    desc->allocator.allocate = scene_allocate;
    desc->allocator.release = scene_release;
    desc->allocator.reallocate = scene_reallocate;
    desc->allocator.user = &s->memory;
    desc->clock = gxio_seconds;
    scene_must(s, gx_body_create(desc, &s->body, &s->failure), "body");
    scene_must(s, gx_body_view(s->body, &s->view, &s->failure), "view");
    s->first_copies = s->view.copy_count;
    s->first_unknowns = scene_unknowns(s);
    s->volume = s->view.volume;
}

typedef struct scene_face {
    uint32_t nodes[3], corners[3]; /* in order; as the element turns them, outward */
} scene_face;

static inline int scene_compare_faces(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(uint32_t)); /* equal ones beside each other, in any order */
}

/* The outer surface of a mesh: the faces that one element has */
static inline gxio_surface scene_surface_of(scene *s, const gxio_mesh *mesh) {
    static const int face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    const size_t count = 4 * mesh->element_count;
    scene_face *faces = (scene_face *)scene_array(s, count, sizeof *faces);
    uint32_t *vertex = (uint32_t *)scene_array(s, mesh->node_count, sizeof *vertex); /* + 1 */
    gxio_surface surface;
    size_t f;
    int i, k;
    memset(&surface, 0, sizeof surface);
    for (f = 0; f < count; f++)
        for (i = 0; i < 3; i++) {
            const uint32_t node = mesh->elements[f / 4 * 4 + (size_t)face[f % 4][i]];
            faces[f].corners[i] = node;
            for (k = i; k > 0 && faces[f].nodes[k - 1] > node; k--) faces[f].nodes[k] = faces[f].nodes[k - 1];
            faces[f].nodes[k] = node;
        }
    qsort(faces, count, sizeof *faces, scene_compare_faces);
    for (f = 0; f < count; f++) {
        const uint32_t *corner = faces[f].corners;
        if (f + 1 < count && scene_compare_faces(&faces[f], &faces[f + 1]) == 0) {
            f++;
            continue;
        }
        for (i = 0; i < 3; i++) {
            const double *x = mesh->positions + 3 * (size_t)corner[i];
            if (vertex[corner[i]]) continue;
            scene_must(s, gxio_add_vertex(&surface, x[0], x[1], x[2]) ? GX_OK : GX_ERROR_MEMORY, "surface");
            vertex[corner[i]] = (uint32_t)surface.vertex_count;
        }
        scene_must(s,
                   gxio_add_triangle(&surface, vertex[corner[0]] - 1, vertex[corner[1]] - 1, vertex[corner[2]] - 1, 0)
                       ? GX_OK
                       : GX_ERROR_MEMORY,
                   "surface");
    }
    free(vertex);
    free(faces);
    return surface;
}

/* Volume inside of a closed surface, m3 */
static inline double scene_volume_inside(const gxio_surface *surface) {
    double sum = 0.0;
    size_t t;
    for (t = 0; t < surface->triangle_count; t++) {
        const double *a = surface->vertices + 3 * (size_t)surface->triangles[3 * t],
                     *b = surface->vertices + 3 * (size_t)surface->triangles[3 * t + 1],
                     *c = surface->vertices + 3 * (size_t)surface->triangles[3 * t + 2];
        sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return sum / 6.0;
}

static inline gx_surface scene_given(const gxio_surface *surface, uint32_t material) {
    gx_surface given;
    memset(&given, 0, sizeof given);
    given.vertices = surface->vertices;
    given.vertex_count = surface->vertex_count;
    given.triangles = surface->triangles;
    given.triangle_count = surface->triangle_count;
    given.material = material;
    return given;
}

/* The body of closed surfaces, by s->body_desc: surface i is of material i, cells: along the longest side. s->mesh
   becomes its grid. */
static inline void scene_make_of(scene *s, const gxio_surface *surfaces, size_t count, uint32_t cells) {
    gx_surface *given = (gx_surface *)scene_array(s, count, sizeof *given);
    gx_shape shape;
    size_t i;
    if (s->trace) scene_misuse(s, "--trace", "is for scenes of a mesh");
    memset(&shape, 0, sizeof shape);
    for (i = 0; i < count; i++) given[i] = scene_given(&surfaces[i], (uint32_t)i);
    shape.surfaces = given;
    shape.surface_count = count;
    shape.cells = cells;
    s->body_desc.shape = &shape;
    scene_create(s);
    s->body_desc.shape = NULL;
    free(given);
    gxio_mesh_release(&s->mesh);
    s->mesh.node_count = s->view.node_count;
    s->mesh.element_count = s->view.element_count;
    s->mesh.positions = (double *)scene_array(s, s->mesh.node_count, 3 * sizeof(double));
    s->mesh.elements = (uint32_t *)scene_array(s, s->mesh.element_count, 4 * sizeof(uint32_t));
    memcpy(s->mesh.positions, s->view.positions, s->mesh.node_count * 3 * sizeof(double));
    memcpy(s->mesh.elements, s->view.elements, s->mesh.element_count * 4 * sizeof(uint32_t));
}

/* The body, of s->mesh or of the surface in its place, by s->body_desc */
static inline void scene_make(scene *s) {
    gx_body_desc *desc = &s->body_desc;
    if (s->shape.triangle_count) {
        scene_make_of(s, &s->shape, 1, s->cells);
        return;
    }
    desc->positions = s->mesh.positions;
    desc->node_count = s->mesh.node_count;
    desc->elements = s->mesh.elements;
    desc->element_count = s->mesh.element_count;
    scene_create(s);
}

/* Holds what lies in one of the regions. */
static inline void scene_hold_all(scene *s, const gx_region *regions, size_t count) {
    free(s->regions);
    s->regions = (gx_region *)scene_array(s, count, sizeof *regions);
    s->region_count = count;
    memcpy(s->regions, regions, count * sizeof *regions);
    scene_must(s, gx_body_hold(s->body, regions, count, &s->failure), "hold");
}

/* Holds what lies on one side (-1: below) of a plane across an axis. */
static inline void scene_hold(scene *s, uint32_t axis, int32_t side, double value) {
    const gx_region region = gx_region_half_space(axis, side, value);
    scene_hold_all(s, &region, 1);
}

/* -------------------------------------------------------------------------------------------- >>sheets */

static inline void scene_fill_triangles(scene_sheet *sheet) {
    const uint32_t row = sheet->across + 1;
    uint32_t i, j, *t = sheet->triangles;
    for (i = 0; i < sheet->along; i++)
        for (j = 0; j < sheet->across; j++, t += 6) {
            const uint32_t a = i * row + j, b = a + row;
            t[0] = a;
            t[1] = b;
            t[2] = b + 1;
            t[3] = a;
            t[4] = b + 1;
            t[5] = a + 1;
        }
}

static inline scene_sheet scene_make_sheet(scene *s, uint32_t along, uint32_t across, scene_point_fn point,
                                           const void *user) {
    scene_sheet sheet;
    uint32_t i, j;
    double *x;
    sheet.along = along;
    sheet.across = across;
    sheet.done = 0;
    x = sheet.vertices = (double *)scene_array(s, (size_t)(along + 1) * (across + 1), 3 * sizeof(double));
    sheet.triangles = (uint32_t *)scene_array(s, (size_t)along * across, 6 * sizeof(uint32_t));
    for (i = 0; i <= along; i++)
        for (j = 0; j <= across; j++, x += 3) point(user, (double)i / along, (double)j / across, x);
    scene_fill_triangles(&sheet);
    return sheet;
}

static inline void scene_drop_sheet(scene_sheet *sheet) {
    free(sheet->vertices);
    free(sheet->triangles);
    memset(sheet, 0, sizeof *sheet);
}

/* From -1 to 1, and the same for the same pair: the multiplications and shifts of a 32-bit hash */
static inline double scene_noise(uint32_t i, uint32_t j) {
    uint32_t h = i * 0x9E3779B1u ^ j * 0x85EBCA77u;
    h = (h ^ h >> 16) * 0x7FEB352Du;
    h = (h ^ h >> 15) * 0x846CA68Bu;
    return (h ^ h >> 16) / 2147483647.5 - 1.0;
}

/* corner + a u + b v; nine numbers */
static inline void scene_flat_point(const void *user, double a, double b, double *x) {
    const double *p = (const double *)user;
    int i;
    for (i = 0; i < 3; i++) x[i] = p[i] + a * p[3 + i] + b * p[6 + i];
}

/* A parallelogram in `along` strips from `corner` along u. Where u and v are 0, every vertex has exactly the corner's
 * coordinate. */
static inline scene_sheet scene_flat_sheet(scene *s, const double corner[3], const double u[3], const double v[3],
                                           uint32_t along) {
    double p[9];
    memcpy(p, corner, 3 * sizeof(double));
    memcpy(p + 3, u, 3 * sizeof(double));
    memcpy(p + 6, v, 3 * sizeof(double));
    return scene_make_sheet(s, along, 1, scene_flat_point, p);
}

/* --------------------------------------------------------------------------------------------- >>trace */

/* Opens a file to write to (mode "w") or append to ("a"), or ends the program; scene_close_file closes it so. */
static inline FILE *scene_open_file(scene *s, const char *path, const char *mode) {
    FILE *stream;
    errno = 0;
    stream = fopen(path, mode);
    if (stream) return stream;
    gxio_fail(&s->error, path, 0, "cannot be written: %s", strerror(errno ? errno : EIO));
    scene_quit(s, SCENE_MISUSED);
    return NULL;
}

static inline void scene_close_file(scene *s, const char *path, FILE *stream) {
    int good = !ferror(stream);
    errno = 0;
    if (fclose(stream) != 0) good = 0;
    if (good) return;
    gxio_fail(&s->error, path, 0, "cannot be written: %s", strerror(errno ? errno : EIO));
    scene_quit(s, SCENE_MISUSED);
}

/* What the first frame starts from; the body is not cut yet. Lines of numbers, each kind after its name and count:
   nodes: position, displacement, velocity; elements: nodes; regions: axis, side, value, see gx_region. */
static inline void scene_begin_trace(scene *s) {
    FILE *f = s->trace_stream = scene_open_file(s, s->trace, "w");
    const double *u = s->view.displacement, *v = s->view.velocity;
    size_t i, k;
    fprintf(f, "gxfem-trace 1\nmaterial %.17g %.17g %.17g\n", s->body_desc.young, s->body_desc.poisson,
            s->body_desc.density);
    fprintf(f, "step %.17g %.17g %.17g %.17g %lu\n", s->step.dt, s->step.gravity[0], s->step.gravity[1],
            s->step.gravity[2], (unsigned long)s->step.newton_iterations);
    fprintf(f, "nodes %lu\n", (unsigned long)s->mesh.node_count);
    for (i = 0; i < s->mesh.node_count; i++) {
        for (k = 0; k < 3; k++) fprintf(f, "%.17g ", s->mesh.positions[3 * i + k]);
        for (k = 0; k < 3; k++) fprintf(f, "%.17g ", u[3 * i + k]);
        for (k = 0; k < 3; k++) fprintf(f, "%.17g%c", v[3 * i + k], k < 2 ? ' ' : '\n');
    }
    fprintf(f, "elements %lu\n", (unsigned long)s->mesh.element_count);
    for (i = 0; i < 4 * s->mesh.element_count; i++)
        fprintf(f, "%lu%c", (unsigned long)s->mesh.elements[i], i % 4 < 3 ? ' ' : '\n');
    fprintf(f, "regions %lu\n", (unsigned long)s->region_count);
    for (i = 0; i < s->region_count; i++)
        fprintf(f, "%lu %ld %.17g\n", (unsigned long)s->regions[i].axis, (long)s->regions[i].side, s->regions[i].value);
    fprintf(f, "frames %lu\n", (unsigned long)s->frames);
}

/* Writes a cut by the triangles of a surface from `first` on; those before it are what of the same blade's path was cut
 * before. */
static inline void scene_trace_cut(scene *s, const gx_surface *surface, size_t first) {
    FILE *f = s->trace_stream;
    size_t i;
    if (!f) return;
    fprintf(f, "cut %lu %lu %lu %lu\n", (unsigned long)s->frame, (unsigned long)surface->vertex_count,
            (unsigned long)surface->triangle_count, (unsigned long)first);
    for (i = 0; i < 3 * surface->vertex_count; i++) fprintf(f, "%.17g%c", surface->vertices[i], i % 3 < 2 ? ' ' : '\n');
    for (i = 0; i < 3 * surface->triangle_count; i++)
        fprintf(f, "%lu%c", (unsigned long)surface->triangles[i], i % 3 < 2 ? ' ' : '\n');
}

/* ---------------------------------------------------------------------------------------------- >>cuts */

/* Remembers a surface: what it points to may go. */
static inline void scene_record(scene *s, const gx_surface *surface) {
    gx_surface *grown = (gx_surface *)realloc(s->cuts, (s->cut_count + 1) * sizeof *grown), *copy;
    double *vertices = (double *)scene_array(s, surface->vertex_count, 3 * sizeof(double));
    uint32_t *triangles = (uint32_t *)scene_array(s, surface->triangle_count, 3 * sizeof(uint32_t));
    scene_must(s, grown ? GX_OK : GX_ERROR_MEMORY, "memory");
    memcpy(vertices, surface->vertices, 3 * surface->vertex_count * sizeof(double));
    memcpy(triangles, surface->triangles, 3 * surface->triangle_count * sizeof(uint32_t));
    s->cuts = grown;
    copy = &s->cuts[s->cut_count++];
    *copy = *surface;
    copy->vertices = vertices;
    copy->triangles = triangles;
    s->cut_triangles += surface->triangle_count;
}

/* A cut, and what it took */
static inline void scene_take_cut(scene *s, const gx_cut_desc *desc) {
    const double start = gxio_seconds(NULL);
    gx_cut_report report;
    scene_must(s, gx_body_cut(s->body, desc, &report, &s->failure), "cut");
    s->frame_cut += gxio_seconds(NULL) - start;
    s->frame_seconds[SCENE_ARRANGEMENT] += report.seconds_arrangement;
    s->frame_seconds[SCENE_ENRICHMENT] += report.seconds_enrichment;
    s->frame_seconds[SCENE_INTEGRALS] += report.seconds_integrals;
    s->looked = 0;
}

static inline void scene_cut_body(scene *s, const gx_surface *surfaces, size_t count) {
    gx_cut_desc desc;
    size_t i;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = surfaces;
    desc.surface_count = count;
    scene_take_cut(s, &desc);
    for (i = 0; i < count; i++) scene_record(s, &surfaces[i]);
}

/* Separates a material from those that adjoin it. */
static inline void scene_peel(scene *s, uint32_t material) {
    const uint32_t pair[2] = {material, GX_ANY_MATERIAL};
    gx_cut_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.release = pair;
    desc.release_count = 1;
    scene_take_cut(s, &desc);
}

/* Cuts the body, now, by all surfaces at once. */
static inline void scene_cut(scene *s, const gx_surface *surfaces, size_t count) {
    size_t i;
    if (s->trace && !s->trace_stream) scene_begin_trace(s);
    for (i = 0; i < count; i++) scene_trace_cut(s, &surfaces[i], 0);
    scene_cut_body(s, surfaces, count);
}

/* Cuts the strips of a sheet up to a column. */
static inline void scene_cut_up_to(scene *s, scene_sheet *sheet, uint32_t column) {
    const size_t row = sheet->across + 1;
    gx_surface strip, path;
    if (column <= sheet->done) return;
    if (s->trace && !s->trace_stream) scene_begin_trace(s);
    memset(&path, 0, sizeof path);
    path.vertices = sheet->vertices;
    path.vertex_count = row * (column + 1);
    path.triangles = sheet->triangles;
    path.triangle_count = 2 * (size_t)sheet->across * column;
    scene_trace_cut(s, &path, 2 * (size_t)sheet->across * sheet->done);
    memset(&strip, 0, sizeof strip);
    strip.vertices = sheet->vertices + 3 * row * sheet->done;
    strip.vertex_count = row * (column - sheet->done + 1);
    strip.triangles = sheet->triangles;
    strip.triangle_count = 2 * (size_t)sheet->across * (column - sheet->done);
    scene_cut_body(s, &strip, 1);
    sheet->done = column;
}

/* The number of `count` things due in this frame, if the first is to begin at `from` and the last to end at `to`,
   shares of the run, whatever its length */
static inline uint32_t scene_due(const scene *s, double from, double to, uint32_t count) {
    const double share = ((s->frame + 1.0) / s->frames - from) / (to - from);
    return share >= 1.0 ? count : share <= 0.0 ? 0 : (uint32_t)(share * count + 1e-9);
}

/* The share of what begins at `from` and ends at `to`, shares of the run, that is over at the end of a frame */
static inline double scene_share(const scene *s, double frame, double from, double to) {
    return fmin(1.0, fmax(0.0, ((frame + 1.0) / s->frames - from) / (to - from)));
}

/* Cuts the strips that are due: the sheet's sweep takes the run from `from` to `to`. */
static inline void scene_advance(scene *s, scene_sheet *sheet, double from, double to) {
    scene_cut_up_to(s, sheet, scene_due(s, from, to, sheet->along));
}

/* Cuts a whole parallelogram at once. */
static inline void scene_cut_flat(scene *s, const double corner[3], const double u[3], const double v[3]) {
    scene_sheet sheet = scene_flat_sheet(s, corner, u, v, 1);
    scene_cut_up_to(s, &sheet, 1);
    scene_drop_sheet(&sheet);
}

/* Cuts the body through, across an axis at a coordinate. */
static inline void scene_cut_across(scene *s, uint32_t axis, double at) {
    double low[3], high[3], corner[3], u[3] = {0, 0, 0}, v[3] = {0, 0, 0};
    const uint32_t j = (axis + 1) % 3, k = (axis + 2) % 3;
    scene_bounds(s, low, high);
    corner[axis] = at;
    corner[j] = 2.0 * low[j] - high[j]; /* a body's width beyond it on each side, and the diagonal beside it */
    corner[k] = 2.0 * low[k] - high[k];
    u[j] = 4.0 * (high[j] - low[j]);
    v[k] = 4.0 * (high[k] - low[k]);
    scene_cut_flat(s, corner, u, v);
}

/* --------------------------------------------------------------------------------------------- >>blade */

/* desc: NULL: the library's defaults. No trace has its cuts: they are the body's, not the scene's. */
static inline scene_blade scene_make_blade(scene *s, const gx_blade_desc *desc) {
    scene_blade b = {NULL, 0, 0.0, 1.0};
    if (s->trace) scene_misuse(s, "--trace", "is for scenes that cut by surfaces, not by a blade");
    scene_must(s, gx_blade_create(s->body, desc, &b.blade, &s->failure), "blade");
    return b;
}

static inline void scene_count_blade(scene *s, scene_blade *b, const gx_blade_report *report, double seconds) {
    if (report->layer_count > b->layers) b->layers = report->layer_count;
    b->deviation = fmax(b->deviation, report->deviation);
    b->min_link_ratio = fmin(b->min_link_ratio, report->cut.min_link_ratio);
    s->frame_cut += seconds;
    s->frame_seconds[SCENE_ARRANGEMENT] += report->cut.seconds_arrangement;
    s->frame_seconds[SCENE_ENRICHMENT] += report->cut.seconds_enrichment;
    s->frame_seconds[SCENE_INTEGRALS] += report->cut.seconds_integrals;
    s->cut_triangles += report->triangle_count;
    if (report->triangle_count) s->looked = 0;
}

static inline void scene_move_blade(scene *s, scene_blade *b, const double *edge, size_t count) {
    const double start = gxio_seconds(NULL);
    gx_blade_report report;
    scene_must(s, gx_blade_move(b->blade, edge, count, NULL, 0, &report, &s->failure), "blade");
    scene_count_blade(s, b, &report, gxio_seconds(NULL) - start);
}

static inline void scene_lift_blade(scene *s, scene_blade *b) {
    const double start = gxio_seconds(NULL);
    gx_blade_report report;
    scene_must(s, gx_blade_lift(b->blade, &report, &s->failure), "blade");
    scene_count_blade(s, b, &report, gxio_seconds(NULL) - start);
}

/* Moves the edge to its place at `a` of its path; the edge has across + 1 points. */
static inline void scene_place_blade(scene *s, scene_blade *b, scene_point_fn point, const void *user, uint32_t across,
                                     double a) {
    double *edge = (double *)scene_array(s, (size_t)across + 1, 3 * sizeof(double));
    uint32_t j;
    for (j = 0; j <= across; j++) point(user, a, (double)j / across, edge + 3 * (size_t)j);
    scene_move_blade(s, b, edge, (size_t)across + 1);
    free(edge);
}

/* Moves the blade to where it is due: a stroke takes the run from `from` to `to`, its path is that of a sheet's
   columns, in space. After the stroke the blade is lifted. */
static inline void scene_stroke(scene *s, scene_blade *b, scene_point_fn point, const void *user, uint32_t across,
                                double from, double to) {
    const double before = scene_share(s, s->frame - 1.0, from, to), now = scene_share(s, s->frame, from, to);
    if (before >= 1.0 || now <= 0.0) return;
    if (before <= 0.0) scene_place_blade(s, b, point, user, across, 0.0);
    scene_place_blade(s, b, point, user, across, now);
    if (now >= 1.0) scene_lift_blade(s, b);
}

/* ---------------------------------------------------------------------------------------------- >>skin */

/* Takes the surface anew after a cut, and where it and its normals are now. */
static inline void scene_take_skin(scene *s) {
    const gx_skin_desc shading = {0.6, 1}; /* creases of 34 degrees and more stay sharp */
    gxio_triangles *triangles = &s->skin.triangles;
    gx_skin skin;
    if (!s->looked) {
        scene_must(s, gx_body_skin(s->body, &shading, &skin, &s->failure), "skin");
        free(s->skin.positions);
        free(s->skin.normals);
        s->has_mesh = 0;
        s->skin.positions = (double *)scene_array(s, skin.vertex_count, 3 * sizeof(double));
        s->skin.normals = (float *)scene_array(s, skin.vertex_count, 3 * sizeof(float));
        s->skin.vertex_point = skin.vertex_point;
        s->skin.vertex_copies = skin.vertex_copies;
        s->skin.vertex_weights = skin.vertex_weights;
        triangles->positions = s->skin.positions;
        triangles->normals = s->skin.normals;
        triangles->texture = skin.vertex_texture;
        triangles->vertex_count = skin.vertex_count;
        triangles->triangles = skin.triangles;
        triangles->triangle_count = skin.triangle_count;
        triangles->fragment = skin.triangle_fragment;
        triangles->fragment_count = s->view.fragment_count;
        triangles->surface = skin.triangle_surface;
        triangles->material = skin.triangle_material;
    }
    scene_must(s, gx_body_skin_positions(s->body, s->skin.positions, &s->failure), "skin");
    scene_must(s, gx_body_skin_vertices(s->body, NULL, NULL, s->skin.normals, &s->failure), "skin");
}

/* View and skin of the body as it is now */
static inline void scene_look(scene *s) {
    const double start = gxio_seconds(NULL);
    if (!s->looked) scene_must(s, gx_body_view(s->body, &s->view, &s->failure), "view");
    scene_take_skin(s);
    s->looked = 1;
    s->frame_seconds[SCENE_SKIN] += gxio_seconds(NULL) - start;
}

/* -------------------------------------------------------------------------------------------- >>frames */

static inline void scene_join_path(scene *s, const char *name, char path[GXIO_PATH_ROOM]) {
    const int length = snprintf(path, GXIO_PATH_ROOM, "%s/%s", s->out, name);
    if (length <= 0 || length >= GXIO_PATH_ROOM) scene_misuse(s, "--out", "the path is too long");
}

static inline int scene_write_file(scene *s) {
    char name[32], path[GXIO_PATH_ROOM];
    gxio_frame_name(name, sizeof name, s->frames_written, s->format);
    scene_join_path(s, name, path);
    return scene_is_format(s, "obj") ? gxio_write_obj(path, &s->skin.triangles, &s->error)
                                     : gxio_write_vtu(path, &s->skin.triangles, &s->error);
}

/* Up is against gravity. */
static inline int scene_write_to_page(scene *s) {
    const double up[3] = {-s->step.gravity[0], -s->step.gravity[1], -s->step.gravity[2]};
    if (!s->has_page && !gxio_page_open(&s->page, s->out, s->desc.name, up, &s->error)) return 0;
    s->has_page = 1;
    if (!s->has_mesh) gxio_page_mesh(&s->page, &s->skin.triangles, s->view.fragment_id);
    s->has_mesh = 1;
    gxio_page_frame(&s->page, &s->skin.triangles, s->step.dt * s->frame);
    return 1;
}

static inline void scene_write_frame(scene *s) {
    if (!(scene_is_format(s, "html") ? scene_write_to_page(s) : scene_write_file(s))) scene_quit(s, SCENE_MISUSED);
    s->frames_written++;
}

/* Completes the page, or writes the collection of the frames there are. */
static inline void scene_finish_frames(scene *s) {
    char path[GXIO_PATH_ROOM];
    if (s->has_page && !gxio_page_close(&s->page, 1, &s->error)) scene_quit(s, SCENE_MISUSED);
    s->has_page = 0;
    if (!s->frames_written || !scene_is_format(s, "vtu")) return;
    scene_join_path(s, "frames.pvd", path);
    if (!gxio_write_pvd(path, s->frames_written, s->step.dt * s->every, &s->error)) scene_quit(s, SCENE_MISUSED);
}

static inline void scene_draw_bar(scene *s) {
    const int width = 40, filled = (int)((double)width * s->frame / s->frames);
    int i;
    if (s->quiet || !SCENE_STDERR_IS_TERMINAL) return;
    fprintf(stderr, "\r%s [", s->desc.name);
    for (i = 0; i < width; i++) fputc(i < filled ? '#' : '.', stderr);
    fprintf(stderr, "] %lu/%lu, %lu unknowns ", (unsigned long)s->frame, (unsigned long)s->frames, scene_unknowns(s));
    fflush(stderr);
    s->bar = 1;
}

/* The step's clock. The body asks it first; then the solver does, when the body has made the solver's model. */
static inline double scene_step_clock(void *user) {
    scene *s = (scene *)user;
    const double now = gxio_seconds(NULL);
    if (s->clock_calls++ == 1) s->solver_start = now;
    return now;
}

/* The body's step, and what it took by phase */
static inline void scene_move(scene *s) {
    const double start = gxio_seconds(NULL);
    double *seconds = s->frame_seconds;
    gx_step_report *report = &s->report;
    gx_result result;
    memset(report, 0, sizeof *report);
    s->step.clock = scene_step_clock;
    s->step.clock_user = s;
    s->clock_calls = 0;
    s->solver_start = -1.0;
    result = gx_body_step(s->body, &s->step, report, &s->failure);
    if (result != GX_OK && s->out) scene_finish_frames(s); /* what there is can be looked at */
    scene_must(s, result, "step");
    seconds[SCENE_MODEL] = s->solver_start < 0.0 ? 0.0 : s->solver_start - start;
    seconds[SCENE_LINEARISE] = report->seconds_linearise;
    seconds[SCENE_PREPARE] = report->seconds_prepare;
    seconds[SCENE_SOLVE] = report->seconds_solve;
    seconds[SCENE_FORCES] = report->seconds - seconds[SCENE_MODEL] - seconds[SCENE_LINEARISE] - seconds[SCENE_PREPARE] -
                            seconds[SCENE_SOLVE];
}

/* Adds the frame's times to the run's. */
static inline void scene_count_frame(scene *s) {
    double frame = s->frame_cut;
    int i;
    for (i = 0; i < SCENE_PHASES; i++) {
        s->sum[i] += s->frame_seconds[i];
        if (i >= SCENE_MODEL) frame += s->frame_seconds[i];
        s->frame_seconds[i] = 0.0;
    }
    if (s->frame_cut > 0.0) s->cut_frames++;
    s->frame_cut = 0.0;
    s->sum_frames += frame;
    if (frame > s->worst_frame) s->worst_frame = frame;
}

/* Ends a frame: a step by s->step, a look at the body, the frame's file if it is due. */
static inline void scene_step(scene *s) {
    if (s->trace && !s->trace_stream) scene_begin_trace(s);
    scene_move(s);
    scene_look(s);
    scene_count_frame(s);
    s->frame++;
    if (s->out && s->frame % s->every == 0) scene_write_frame(s);
    scene_draw_bar(s);
    if (s->frame < s->frames) return;
    scene_end_bar(s);
    if (s->out) scene_finish_frames(s);
}

/* Brings the body to rest: balance of forces from where it is, without inertia. Returns the residual, see
 * gxs_step_report. */
static inline double scene_settle(scene *s, double tolerance) {
    const gx_step_desc kept = s->step;
    s->step.integrator = GXS_STATIC;
    s->step.dt = 0.0;
    s->step.newton_iterations = 1000;
    s->step.newton_tolerance = tolerance;
    scene_move(s);
    s->step = kept;
    scene_look(s);
    memset(s->frame_seconds, 0, sizeof s->frame_seconds);
    return s->report.residual;
}

/* ------------------------------------------------------------------------------------------ >>measures */

/* Volume of the mesh as it was given, m3 */
static inline double scene_mesh_volume(const scene *s) {
    double volume = 0.0;
    size_t e;
    for (e = 0; e < s->mesh.element_count; e++)
        volume += gxio_element_determinant(s->mesh.positions, s->mesh.elements + 4 * e) / 6.0;
    return volume;
}

/* Mass of the body as steps see it: the sum of all mass blocks, kg; compensated [Kahan 1965], so that a check to 1e-12
   sees the blocks and not their summation */
static inline double scene_mass(scene *s) {
    gxs_model model;
    double sum = 0.0, lost = 0.0;
    size_t e, i;
    scene_must(s, gx_body_model(s->body, &model, &s->failure), "model");
    for (e = 0; e < model.element_count; e++)
        for (i = 0; i < 10; i++) {
            const double once = i == 0 || i == 4 || i == 7 || i == 9 ? 1.0 : 2.0; /* diagonal or not */
            const double term = once * model.elements[e].mass[i] - lost, grown = sum + term;
            lost = grown - sum - term;
            sum = grown;
        }
    return sum;
}

/* |sum of the cells' volumes / volume of the mesh, or of the uncut body of a surface - 1| */
static inline double scene_volume_error(const scene *s) {
    double volume = 0.0;
    size_t c;
    for (c = 0; c < s->view.cell_count; c++) volume += s->view.cell_volume[c];
    return fabs(volume / (s->shape.triangle_count ? s->volume : scene_mesh_volume(s)) - 1.0);
}

/* Elements that cuts have divided */
static inline size_t scene_divided_elements(const scene *s) {
    size_t c, divided = 0;
    for (c = 1; c < s->view.cell_count; c++)
        divided += s->view.cell_element[c] == s->view.cell_element[c - 1] &&
                   (c < 2 || s->view.cell_element[c] != s->view.cell_element[c - 2]);
    return divided;
}

/* The node that a vertex of the surface is at, UINT32_MAX where it is at none */
static inline uint32_t scene_node_at(const scene *s, size_t vertex) {
    int k;
    for (k = 0; k < 4; k++)
        if (s->skin.vertex_weights[4 * vertex + (size_t)k] >= 1.0)
            return s->view.copy_node[s->skin.vertex_copies[4 * vertex + (size_t)k]];
    return UINT32_MAX;
}

/* The node of the surface nearest to a material point */
static inline uint32_t scene_nearest_node(const scene *s, const double x[3]) {
    double least = HUGE_VAL;
    uint32_t nearest = 0;
    size_t v, i;
    for (v = 0; v < s->skin.triangles.vertex_count; v++) {
        const uint32_t node = scene_node_at(s, v);
        double distance = 0.0;
        if (node == UINT32_MAX) continue;
        for (i = 0; i < 3; i++) distance += pow(s->mesh.positions[3 * (size_t)node + i] - x[i], 2.0);
        if (distance < least) {
            least = distance;
            nearest = node;
        }
    }
    return nearest;
}

/* Where a node of the surface that no cut passes through is now */
static inline const double *scene_place(const scene *s, uint32_t node) {
    size_t v;
    for (v = 0; v + 1 < s->skin.triangles.vertex_count && scene_node_at(s, v) != node;) v++;
    return s->skin.positions + 3 * v;
}

/* Fragments of at least a share of the body's volume */
static inline size_t scene_fragments_above(const scene *s, double share) {
    size_t f, count = 0;
    for (f = 0; f < s->view.fragment_count; f++) count += s->view.fragment_volume[f] >= share * s->view.volume;
    return count;
}

/* How far the two faces of the cuts are apart: the mean over the triangles' corners that have left their opposite, m.
   Fragments below a share of the body's volume are left out. */
static inline double scene_mean_gap(scene *s, double share) {
    const gxio_triangles *t = &s->skin.triangles;
    size_t *first, i, k, points = 0, count = 0; /* first: vertex + 1 where each point was first seen */
    double sum = 0.0;
    for (i = 0; i < t->vertex_count; i++)
        if (s->skin.vertex_point[i] >= points) points = (size_t)s->skin.vertex_point[i] + 1;
    first = (size_t *)scene_array(s, points, sizeof *first);
    for (i = 0; i < 3 * t->triangle_count; i++) {
        const size_t vertex = t->triangles[i], point = s->skin.vertex_point[vertex];
        double distance = 0.0;
        if (t->surface[i / 3] == GX_SKIN_OUTER || s->view.fragment_volume[t->fragment[i / 3]] < share * s->view.volume)
            continue;
        if (!first[point]) first[point] = vertex + 1;
        for (k = 0; k < 3; k++)
            distance += pow(t->positions[3 * vertex + k] - t->positions[3 * (first[point] - 1) + k], 2.0);
        sum += sqrt(distance);
        count += distance > 0.0;
    }
    free(first);
    return count ? sum / (double)count : 0.0;
}

/* The largest eigenvalue of a symmetric matrix, as 00 01 02 11 12 22: the largest root of its characteristic
   polynomial, by the cosine of a third of an angle [Smith, Eigenvalues of a symmetric 3x3 matrix, CACM 1961] */
static inline double scene_largest_eigenvalue(const double m[6]) {
    const double mean = (m[0] + m[3] + m[5]) / 3.0, x = m[0] - mean, y = m[3] - mean, z = m[5] - mean;
    const double p = sqrt((x * x + y * y + z * z + 2.0 * (m[1] * m[1] + m[2] * m[2] + m[4] * m[4])) / 6.0);
    double determinant;
    if (!(p > 0.0)) return mean;
    determinant = x * (y * z - m[4] * m[4]) - m[1] * (m[1] * z - m[4] * m[2]) + m[2] * (m[1] * m[4] - y * m[2]);
    return mean + 2.0 * p * cos(acos(fmax(-1.0, fmin(1.0, determinant / (2.0 * p * p * p)))) / 3.0);
}

/* The largest principal stretch of an element, at its centre of mass */
static inline double scene_element_stretch(const scene *s, const gxs_element *e) {
    static const int row[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    double f[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, c[6], at[4], mass = 0.0, x[3] = {0, 0, 0};
    int corner, i, j, k;
    for (corner = 0; corner < 4; corner++) {
        const double *place = s->mesh.positions + 3 * (size_t)s->view.copy_node[e->copy[corner]];
        for (k = 0, at[corner] = 0.0; k < 4; k++) at[corner] += e->mass[row[corner][k]];
        for (i = 0; i < 3; i++) x[i] += at[corner] * place[i];
        mass += at[corner];
    }
    for (corner = 0; corner < 4; corner++) {
        const size_t copy = e->copy[corner];
        const double *place = s->mesh.positions + 3 * (size_t)s->view.copy_node[copy];
        double u[3];
        memcpy(u, s->view.displacement + 3 * copy, sizeof u);
        for (k = 0; k < 3 && s->view.copy_affine && s->view.copy_affine[copy]; k++)
            for (i = 0; i < 3; i++) { /* the columns of A */
                const double a = s->view.affine[9 * copy + 3 * (size_t)k + (size_t)i];
                u[i] += a * (x[k] / mass - place[k]);
                f[i][k] += at[corner] / mass * a;
            }
        for (i = 0; i < 3; i++)
            for (j = 0; j < 3; j++) f[i][j] += u[i] * e->gradient[corner][j];
    }
    for (i = 0, corner = 0; i < 3; i++)
        for (j = i; j < 3; j++) c[corner++] = f[0][i] * f[0][j] + f[1][i] * f[1][j] + f[2][i] * f[2][j];
    return sqrt(scene_largest_eigenvalue(c));
}

/* The largest principal stretch of all parts: a part that drifted away from its neighbours would have a large one. */
static inline double scene_largest_stretch(scene *s) {
    gxs_model model;
    double largest = 0.0;
    size_t e;
    scene_must(s, gx_body_model(s->body, &model, &s->failure), "model");
    for (e = 0; e < model.element_count; e++) largest = fmax(largest, scene_element_stretch(s, &model.elements[e]));
    return largest;
}

/* The fragment of each copy, view.copy_count; to be freed by the caller. */
static inline uint32_t *scene_copy_fragments(scene *s) {
    uint32_t *fragment = (uint32_t *)scene_array(s, s->view.copy_count, sizeof *fragment);
    size_t i;
    for (i = 0; i < 4 * s->view.cell_count; i++) fragment[s->view.cell_copies[i]] = s->view.cell_fragment[i / 4];
    return fragment;
}

/* How a fragment moves */
static inline gx_motion scene_motion(scene *s, uint32_t fragment) {
    gx_motion *motions = (gx_motion *)scene_array(s, s->view.fragment_count, sizeof *motions), motion;
    scene_must(s, gx_body_motion(s->body, motions, s->view.fragment_count, &s->failure), "motion");
    motion = motions[fragment];
    free(motions);
    return motion;
}

typedef struct scene_corner {
    uint32_t point, copies[4], vertex;
} scene_corner;
typedef struct scene_edge {
    uint32_t low, high;
    int way;
} scene_edge;

static inline int scene_compare_words(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static inline int scene_compare_corners(const void *a, const void *b) {
    return memcmp(a, b, sizeof(scene_corner) - sizeof(uint32_t));
}

static inline int scene_compare_edges(const void *a, const void *b) {
    const scene_edge *p = (const scene_edge *)a, *q = (const scene_edge *)b;
    const int low = scene_compare_words(&p->low, &q->low);
    return low ? low : scene_compare_words(&p->high, &q->high);
}

/* Numbers of the surface's corners, triangles.vertex_count: vertices that are the same material point and follow the
   same copies (those of weight not 0) are one. To be freed by the caller. */
static inline uint32_t *scene_merge_vertices(scene *s) {
    const size_t n = s->skin.triangles.vertex_count;
    scene_corner *corners = (scene_corner *)scene_array(s, n, sizeof *corners);
    uint32_t *merged = (uint32_t *)scene_array(s, n, sizeof *merged), count = 0;
    size_t v, k;
    for (v = 0; v < n; v++) {
        corners[v].point = s->skin.vertex_point[v];
        corners[v].vertex = (uint32_t)v;
        for (k = 0; k < 4; k++)
            corners[v].copies[k] =
                fabs(s->skin.vertex_weights[4 * v + k]) > 0.0 ? s->skin.vertex_copies[4 * v + k] : UINT32_MAX;
        qsort(corners[v].copies, 4, sizeof(uint32_t), scene_compare_words);
    }
    qsort(corners, n, sizeof *corners, scene_compare_corners);
    for (v = 0; v < n; v++) {
        if (v > 0 && scene_compare_corners(&corners[v], &corners[v - 1]) != 0) count++;
        merged[corners[v].vertex] = count;
    }
    free(corners);
    return merged;
}

/* Edges of the surface that more triangles pass one way than the other: 0 where every fragment is watertight */
static inline size_t scene_open_edges(scene *s) {
    const size_t n = 3 * s->skin.triangles.triangle_count;
    uint32_t *merged = scene_merge_vertices(s);
    scene_edge *edges = (scene_edge *)scene_array(s, n, sizeof *edges);
    size_t i, j, open = 0;
    for (i = 0; i < n; i++) {
        const uint32_t *corner = s->skin.triangles.triangles + i / 3 * 3;
        const uint32_t a = merged[corner[i % 3]], b = merged[corner[(i + 1) % 3]];
        edges[i].low = a < b ? a : b;
        edges[i].high = a < b ? b : a;
        edges[i].way = a < b ? 1 : -1;
    }
    qsort(edges, n, sizeof *edges, scene_compare_edges);
    for (i = 0; i < n; i = j) {
        int balance = 0;
        for (j = i; j < n && scene_compare_edges(&edges[i], &edges[j]) == 0; j++) balance += edges[j].way;
        open += balance != 0;
    }
    free(merged);
    free(edges);
    return open;
}

/* The elements around a node as a mesh of their own, and what the cuts have in its box */
typedef struct scene_ring {
    double *positions, *vertices;            /* 3 per node; 9 per triangle */
    uint32_t *elements, *triangles, *number; /* number: of the mesh's nodes in the ring, UINT32_MAX elsewhere */
    uint32_t *nodes;                         /* of the mesh, node_count */
    size_t node_count, element_count, triangle_count;
    double low[3], high[3];
} scene_ring;

static inline void scene_fill_ring(const scene *s, scene_ring *ring, const uint32_t *around, size_t count) {
    size_t i, k;
    ring->node_count = ring->triangle_count = 0;
    ring->element_count = count;
    for (i = 0; i < 4 * count; i++) {
        const uint32_t node = s->mesh.elements[4 * (size_t)around[i / 4] + i % 4];
        if (ring->number[node] == UINT32_MAX) {
            for (k = 0; k < 3; k++) ring->positions[3 * ring->node_count + k] = s->mesh.positions[3 * (size_t)node + k];
            ring->nodes[ring->node_count] = node;
            ring->number[node] = (uint32_t)ring->node_count++;
        }
        ring->elements[i] = ring->number[node];
    }
    for (i = 0; i < ring->node_count; i++) ring->number[ring->nodes[i]] = UINT32_MAX;
    gxio_bounds(ring->positions, ring->node_count, ring->low, ring->high);
}

/* Does a triangle's box meet the ring's? */
static inline int scene_meets_ring(const scene_ring *ring, const double *a, const double *b, const double *c) {
    int i;
    for (i = 0; i < 3; i++)
        if (fmin(a[i], fmin(b[i], c[i])) > ring->high[i] || fmax(a[i], fmax(b[i], c[i])) < ring->low[i]) return 0;
    return 1;
}

/* Adds the triangles of a sheet that may meet the ring. */
static inline void scene_add_to_ring(scene_ring *ring, const gx_surface *sheet) {
    size_t t, k;
    for (t = 0; t < sheet->triangle_count; t++) {
        const double *x[3];
        for (k = 0; k < 3; k++) x[k] = sheet->vertices + 3 * (size_t)sheet->triangles[3 * t + k];
        if (!scene_meets_ring(ring, x[0], x[1], x[2])) continue;
        for (k = 0; k < 3; k++) memcpy(ring->vertices + 9 * ring->triangle_count + 3 * k, x[k], 3 * sizeof(double));
        ring->triangle_count++;
    }
}

/* Fragments of the ring alone, cut at once by all the sheets' triangles, by all solids and by the shape */
static inline size_t scene_ring_fragments(scene *s, const scene_ring *ring) {
    gx_surface *surfaces = (gx_surface *)scene_array(s, s->cut_count + 2, sizeof *surfaces);
    gx_body_desc desc;
    gx_cut_desc cut;
    gx_view view;
    gx_body *body;
    size_t i;
    memset(&desc, 0, sizeof desc);
    memset(&cut, 0, sizeof cut);
    desc.positions = ring->positions;
    desc.node_count = ring->node_count;
    desc.elements = ring->elements;
    desc.element_count = ring->element_count;
    desc.young = desc.density = 1.0;
    scene_must(s, gx_body_create(&desc, &body, &s->failure), "elements around a node");
    surfaces[0].vertices = ring->vertices;
    surfaces[0].vertex_count = 3 * ring->triangle_count;
    surfaces[0].triangles = ring->triangles;
    surfaces[0].triangle_count = ring->triangle_count;
    for (i = 0, cut.surface_count = ring->triangle_count > 0; i < s->cut_count; i++)
        if (s->cuts[i].kind == GX_SURFACE_SOLID) surfaces[cut.surface_count++] = s->cuts[i];
    if (s->shape.triangle_count) {
        surfaces[cut.surface_count] = scene_given(&s->shape, 0);
        surfaces[cut.surface_count++].kind = GX_SURFACE_KEEP;
    }
    cut.surfaces = surfaces;
    if (cut.surface_count) scene_must(s, gx_body_cut(body, &cut, NULL, &s->failure), "cut around a node");
    scene_must(s, gx_body_view(body, &view, &s->failure), "elements around a node");
    i = view.fragment_count;
    gx_body_destroy(body);
    free(surfaces);
    return i;
}

/* Elements around each node: those of node i are around[start[i]] to around[start[i + 1] - 1]. Both to be freed by the
 * caller. */
static inline void scene_list_around(scene *s, uint32_t **around, size_t **start) {
    const size_t corners = 4 * s->mesh.element_count, n = s->mesh.node_count;
    size_t i;
    *around = (uint32_t *)scene_array(s, corners, sizeof **around);
    *start = (size_t *)scene_array(s, n + 1, sizeof **start);
    for (i = 0; i < corners; i++) (*start)[s->mesh.elements[i]]++;
    for (i = 0; i < n; i++) (*start)[i + 1] += (*start)[i];
    for (i = corners; i-- > 0;) (*around)[--(*start)[s->mesh.elements[i]]] = (uint32_t)(i / 4);
}

/* The least number of copies: for each node the number of pieces that all cuts so far, made at once, leave of the
   elements around it and nothing else (GXFEM Eq. 18). Found by a body per node, from scratch. */
static inline size_t scene_least_copies(scene *s) {
    uint32_t *around;
    size_t *start, i, k, most = 1, least = 0;
    scene_ring ring;
    scene_list_around(s, &around, &start);
    for (i = 0; i < s->mesh.node_count; i++)
        if (start[i + 1] - start[i] > most) most = start[i + 1] - start[i];
    ring.positions = (double *)scene_array(s, 4 * most, 3 * sizeof(double));
    ring.elements = (uint32_t *)scene_array(s, 4 * most, sizeof(uint32_t));
    ring.nodes = (uint32_t *)scene_array(s, 4 * most, sizeof(uint32_t));
    ring.number = (uint32_t *)scene_array(s, s->mesh.node_count, sizeof(uint32_t));
    ring.vertices = (double *)scene_array(s, s->cut_triangles, 9 * sizeof(double));
    ring.triangles = (uint32_t *)scene_array(s, s->cut_triangles, 3 * sizeof(uint32_t));
    for (i = 0; i < s->mesh.node_count; i++) ring.number[i] = UINT32_MAX;
    for (i = 0; i < 3 * s->cut_triangles; i++) ring.triangles[i] = (uint32_t)i;
    for (i = 0; i < s->mesh.node_count; i++) {
        if (start[i] == start[i + 1]) continue;
        scene_fill_ring(s, &ring, around + start[i], start[i + 1] - start[i]);
        for (k = 0; k < s->cut_count; k++)
            if (s->cuts[k].kind == GX_SURFACE_SHEET) scene_add_to_ring(&ring, &s->cuts[k]);
        least += scene_ring_fragments(s, &ring);
    }
    free(ring.positions);
    free(ring.elements);
    free(ring.nodes);
    free(ring.number);
    free(ring.vertices);
    free(ring.triangles);
    free(around);
    free(start);
    return least;
}

/* -------------------------------------------------------------------------------------------- >>report */

/* A line of what one sees: "name: value (what it should be)", and whether it holds. */
static inline void scene_check(scene *s, int ok, const char *format, ...) {
    va_list arguments;
    s->checks++;
    if (!ok) s->wrong++;
    if (ok && s->quiet) return;
    scene_end_bar(s);
    fputs("  ", stdout);
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    puts(ok ? "  ok" : "  WRONG");
}

/* A line of what one sees that is no check */
static inline void scene_say(scene *s, const char *format, ...) {
    va_list arguments;
    if (s->quiet) return;
    scene_end_bar(s);
    fputs("  ", stdout);
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    putchar('\n');
}

/* What holds in every scene: no volume lost, no crack in the surface */
static inline void scene_check_whole(scene *s) {
    const double volume = scene_volume_error(s);
    const size_t open = scene_open_edges(s);
    scene_check(s, volume <= 1e-12, "volume of the cells against the %s: %.1e (at most 1e-12)",
                s->shape.triangle_count ? "uncut body's" : "mesh's", volume);
    scene_check(s, open == 0, "open edges of the surface: %lu (0)", (unsigned long)open);
}

/* What holds in every scene that cuts by surfaces: no copy too many or too few either */
static inline void scene_check_body(scene *s) {
    const size_t least = scene_least_copies(s);
    scene_check(s, s->view.copy_count == least, "unknowns: %lu, %+.1f %% of the uncut body's %lu (least possible: %lu)",
                3 * (unsigned long)s->view.copy_count,
                100.0 * ((double)s->view.copy_count / (double)s->first_copies - 1.0),
                3 * (unsigned long)s->first_copies, 3 * (unsigned long)least);
    if (scene_affine_copies(s) > 0)
        scene_say(s, "affine copies: %lu of %lu, with 9 unknowns more each", (unsigned long)scene_affine_copies(s),
                  (unsigned long)s->view.copy_count);
    scene_check_whole(s);
}

/* Milliseconds, to a microsecond */
static inline double scene_ms(double seconds) { return floor(1e6 * seconds + 0.5) / 1e3; }

/* Mean milliseconds per frame in which the phase happens: cuts in frames with a cut */
static inline double scene_phase_ms(const scene *s, int phase) {
    const uint32_t frames = phase < SCENE_MODEL ? s->cut_frames : s->frame;
    return frames ? scene_ms(s->sum[phase] / frames) : 0.0;
}

static inline double scene_mean_ms(const scene *s) { return s->frame ? scene_ms(s->sum_frames / s->frame) : 0.0; }

static inline void scene_print_times(scene *s) {
    scene_say(s,
              "cuts: %lu triangles in %lu of %lu frames; ms per frame with a cut: arrangement %.3g, enrichment %.3g, "
              "integrals %.3g",
              (unsigned long)s->cut_triangles, (unsigned long)s->cut_frames, (unsigned long)s->frame,
              scene_phase_ms(s, SCENE_ARRANGEMENT), scene_phase_ms(s, SCENE_ENRICHMENT),
              scene_phase_ms(s, SCENE_INTEGRALS));
    scene_say(s, "ms per frame: model %.3g, linearise %.3g, prepare %.3g, solve %.3g, forces %.3g, skin %.3g",
              scene_phase_ms(s, SCENE_MODEL), scene_phase_ms(s, SCENE_LINEARISE), scene_phase_ms(s, SCENE_PREPARE),
              scene_phase_ms(s, SCENE_SOLVE), scene_phase_ms(s, SCENE_FORCES), scene_phase_ms(s, SCENE_SKIN));
    scene_say(s, "frame: %.3g ms, worst %.3g ms, %.0f frames/s; the body's memory at its peak: %.3g MB",
              scene_mean_ms(s), scene_ms(s->worst_frame), s->frame / s->sum_frames, 1e-6 * (double)s->memory.peak);
}

/* The scene's line of the table of all scenes, in Markdown */
static inline void scene_print_row(const scene *s, FILE *stream) {
    int i;
    fprintf(stream, "| %s | %lu | %lu | %lu | %lu |", s->desc.name, (unsigned long)s->mesh.element_count,
            s->first_unknowns, scene_unknowns(s), (unsigned long)s->cut_triangles);
    for (i = 0; i < SCENE_PHASES; i++) fprintf(stream, " %.3g |", scene_phase_ms(s, i));
    fprintf(stream, " %.3g | %.3g | %.0f | %.3g | %lu of %lu |\n", scene_mean_ms(s), scene_ms(s->worst_frame),
            s->frame / s->sum_frames, 1e-6 * (double)s->memory.peak, (unsigned long)(s->checks - s->wrong),
            (unsigned long)s->checks);
}

/* Prints times, appends to the table, gives everything back. Returns the exit code. */
static inline int scene_close(scene *s) {
    size_t i;
    scene_print_times(s);
    if (s->table) {
        FILE *stream = scene_open_file(s, s->table, "a");
        scene_print_row(s, stream);
        scene_close_file(s, s->table, stream);
    }
    if (s->trace_stream) scene_close_file(s, s->trace, s->trace_stream);
    free(s->regions);
    for (i = 0; i < s->cut_count; i++) {
        free((void *)s->cuts[i].vertices);
        free((void *)s->cuts[i].triangles);
    }
    free(s->cuts);
    free(s->skin.positions);
    free(s->skin.normals);
    gx_body_destroy(s->body);
    gxio_mesh_release(&s->mesh);
    gxio_surface_release(&s->shape);
    return s->wrong ? SCENE_WRONG : SCENE_RIGHT;
}

#endif /* SCENE_H */
