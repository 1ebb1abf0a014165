/* gxfem.h - cuts deformable bodies: exact where others guess. Part of gxfem 0.1.
 *
 * A body is a tetrahedral mesh with a material. Cuts are triangle surfaces in material (rest) coordinates, any number of them,
 * crossing each other as they like. The mesh is never remeshed: where material separates, nodes get further copies of their
 * displacement (GXFEM Eq. 18), and every integral over a cut element is exact. Implicit time steps move it (gxfem_solve.h).
 *
 * One minute:
 *
 *     #define GXFEM_IMPLEMENTATION
 *     #include "gxfem.h"
 *     #include <stdio.h>
 *     int main(void) {
 *         const double x[12] = {0,0,0, 1,0,0, 0,1,0, 0,0,1}, s[9] = {-9,-9,.25, 9,-9,.25, 0,9,.25};
 *         const uint32_t tet[4] = {0, 1, 2, 3}, tri[3] = {0, 1, 2};
 *         gx_body_desc desc = {0};
 *         gx_surface sheet = {0};
 *         gx_cut_desc cut = {0};
 *         gx_step_desc step = {0};
 *         gx_view view;
 *         gx_body *body;
 *         desc.positions = x; desc.node_count = 4; desc.elements = tet; desc.element_count = 1;
 *         desc.young = 1e6; desc.poisson = 0.4; desc.density = 1000;
 *         if (gx_body_create(&desc, &body, NULL) != GX_OK) return 1;
 *         sheet.vertices = s; sheet.vertex_count = 3; sheet.triangles = tri; sheet.triangle_count = 1;
 *         cut.surfaces = &sheet; cut.surface_count = 1;
 *         if (gx_body_cut(body, &cut, NULL, NULL) != GX_OK) return 1;
 *         step.dt = 0.033; step.gravity[2] = -9.81;
 *         if (gx_body_step(body, &step, NULL, NULL) != GX_OK || gx_body_view(body, &view) != GX_OK) return 1;
 *         printf("%u fragments, %u unknowns\n", (unsigned)view.fragment_count, (unsigned)(3 * view.copy_count));
 *         gx_body_destroy(body);
 *         return 0;
 *     }
 *
 * Contents (search for >>name):
 *     >>shared     result codes, allocator
 *     >>body       create, destroy
 *     >>cut        surfaces, cuts, solidified sheets
 *     >>view       cells, copies, fragments
 *     >>step       held regions, time step
 *     >>skin       the visual surface
 *     >>hash       of the topology, of the state
 *     then, under GXFEM_IMPLEMENTATION: >>memory >>tree >>create >>transaction >>surfaces >>arrange >>solids >>links >>cells
 *     >>components >>integrals >>commit >>regions >>fragments >>parts >>boundary
 *
 * Words. Wall: a piece of a sheet inside the body or on an element face. Cell: a connected piece of one element after cutting
 * (GXFEM Eq. 20). Link: a piece of the face between two elements that no wall covers. Copy: a node's displacement for one
 * connected set of cells around the node (GXFEM Eq. 18). Fragment: a connected set of cells of the body.
 *
 * What is exact: which cells there are, what they are linked to, hence copies and fragments; decisions are signs of polynomials
 * in the given coordinates (gxfem_boolean.h). What is rounded, once: volumes, masses and vertices, as doubles.
 *
 * What it does not do (yet): contact between pieces, cuts given in the deformed state,
 * unknowns within a partly cut element (a sheet that ends inside an element separates nothing there until another completes it).
 *
 * Limits: 2^31 - 1 of each kind of object; coordinates within 2^-128 ... 2^128 of the body's size (GX_ERROR_RANGE);
 * one body is for one thread at a time; no global state, no output, no clock of its own.
 *
 * References: GXFEM = Ton-That, Kry, Andrews: Generalized eXtended Finite Element Method for Deformable Cutting via Boolean
 * Operations (2024). RXFEM = Koschier, Bender, Thuerey: Robust eXtended Finite Elements for Complex Cutting of Deformables (2017).
 */
#ifndef GXFEM_H
#define GXFEM_H

/* >>shared: this block is the same in every gxfem header; `make lint` compares the copies */
#ifndef GXFEM_SHARED_INCLUDED
#define GXFEM_SHARED_INCLUDED
#include <stddef.h>
#include <stdint.h>

/* GXFEM_STATIC makes every function private to the file that includes the headers */
#ifdef GXFEM_STATIC
#define GXFEM_API static inline
#else
#define GXFEM_API extern
#endif

/* What a function that can fail returns. On anything but GX_OK its inputs are as they were. */
typedef enum gx_result {
    GX_OK = 0,
    GX_ERROR_ARGUMENT,      /* a required pointer is NULL, a required field is zero or senseless */
    GX_ERROR_MEMORY,        /* the allocator returned NULL */
    GX_ERROR_NOT_FINITE,    /* a coordinate or parameter is NaN or infinite */
    GX_ERROR_RANGE,         /* a coordinate is too large or too small beside the others (see "limits") */
    GX_ERROR_INDEX,         /* an index points outside its array */
    GX_ERROR_EMPTY,         /* no elements, no nodes or no triangles */
    GX_ERROR_INVERTED,      /* an element has negative volume */
    GX_ERROR_FLAT,          /* an element has no volume */
    GX_ERROR_OVERLAP,       /* an element face is shared by more than two elements, or by two on one side */
    GX_ERROR_NOT_CLOSED,    /* a solid's surface has a boundary, or its triangles are not oriented alike */
    GX_ERROR_LIMIT,         /* more objects than 32-bit indices can name, or a caller's limit is reached */
    GX_ERROR_DIVERGED,      /* a time step found no finite state of lower energy */
    GX_ERROR_FREE           /* a static balance is asked of a piece that nothing holds */
} gx_result;

/* What went wrong, and where: index of the node, element, triangle or copy concerned. */
typedef struct gx_failure {
    gx_result result;
    size_t index;           /* SIZE_MAX: no single object is to blame */
    size_t surface;         /* of a cut: which of its surfaces; else SIZE_MAX */
} gx_failure;

/* Where memory comes from. Zero-initialised: malloc and free. */
typedef struct gx_allocator {
    void *(*allocate)(void *user, size_t size);             /* NULL when there is none; size is never 0 */
    void (*release)(void *user, void *memory, size_t size); /* size as it was allocated; memory is never NULL */
    void *user;
} gx_allocator;
/* How work is handed to the host's threads. Zero-initialised: the calling thread does it all. Results do not depend on it. */
typedef struct gx_jobs {
    /* Calls task(context, i) once for each i below count, on any threads, in any order, and returns when all have returned. */
    void (*parallel_for)(void *user, size_t count, void (*task)(void *context, size_t index), void *context);
    void *user;
} gx_jobs;
#endif /* GXFEM_SHARED_INCLUDED */

#include "gxfem_solve.h"

#ifdef __cplusplus
extern "C" {
#endif

/* >>body: units are the caller's, here SI ------------------------------------------------------------------------------ */

typedef struct gx_body gx_body;                     /* opaque */

typedef struct gx_material {
    gxs_material elastic;
    double density;             /* kg/m3, > 0 */
} gx_material;

typedef struct gx_body_desc {
    const double *positions;    /* node_count x 3, material coordinates, m */
    size_t node_count;
    const uint32_t *elements;   /* element_count x 4 node indices, positive volume: det(x1-x0, x2-x0, x3-x0) > 0 */
    size_t element_count;
    double young;               /* Pa, > 0: of one stable neo-Hookean material, if materials is NULL */
    double poisson;             /* 0 <= poisson < 0.5 */
    double density;             /* kg/m3, > 0 */
    const gx_material *materials; size_t material_count;
    const uint32_t *element_materials;  /* element_count, below material_count; NULL: all of materials[0] */
    double support_below;       /* copies with a smaller share of their node's volume follow others, see gx_body_step; 0: none does */
    gx_allocator allocator;     /* zero: malloc, free */
    double (*clock)(void *user);/* seconds, for the reports' timings; NULL: they are 0 */
    void *clock_user;
    gx_jobs jobs;               /* the host's threads, for the steps; zero: none */
} gx_body_desc;
/* Errors: ARGUMENT, EMPTY, INDEX, NOT_FINITE, RANGE, INVERTED, FLAT, OVERLAP (index: the node, element or material), LIMIT, MEMORY.
   The arrays of the description are copied. */
GXFEM_API gx_result gx_body_create(const gx_body_desc *desc, gx_body **body, gx_failure *failure /* or NULL */);
GXFEM_API void gx_body_destroy(gx_body *body);      /* NULL is fine */

/* >>cut ------------------------------------------------------------------------------------------------------------------ */

/* A sheet separates what lies on its two sides; it may be open, closed, curved, cross itself, be non-manifold. A solid is closed
   and consistently oriented; it removes the material around which it winds. */
enum { GX_SURFACE_SHEET = 0, GX_SURFACE_SOLID = 1 };
typedef struct gx_surface {
    const double *vertices;     /* vertex_count x 3, material coordinates */
    size_t vertex_count;
    const uint32_t *triangles;  /* triangle_count x 3 */
    size_t triangle_count;
    uint32_t kind;              /* GX_SURFACE_SHEET or GX_SURFACE_SOLID */
} gx_surface;
typedef struct gx_cut_desc {
    const gx_surface *surfaces; size_t surface_count;
    const uint32_t *scope_fragments; size_t scope_fragment_count;   /* 0: the whole body; ids of gx_view */
    const uint32_t *scope_cells; size_t scope_cell_count;           /* 0: the whole body; ids of gx_view */
    double sever_below;         /* links of a smaller share of their face are severed; 0: never */
} gx_cut_desc;
typedef struct gx_cut_report {
    size_t touched_elements, created_cells, removed_cells, created_copies, removed_copies;
    size_t ignored_triangles;   /* of zero area */
    size_t severed_links;
    double min_link_ratio;      /* smallest link area / face area among the faces that this cut divided; 1 if none */
    double removed_volume;
    double seconds_arrangement, seconds_enrichment, seconds_integrals;
} gx_cut_report;
/* Cuts by all surfaces at once. The displacement and velocity fields are the same functions of material points before and after.
   Errors: ARGUMENT, EMPTY, INDEX (triangle), NOT_FINITE and RANGE (vertex), NOT_CLOSED (triangle), LIMIT, MEMORY; the body is then
   exactly as it was. */
GXFEM_API gx_result gx_body_cut(gx_body *body, const gx_cut_desc *desc, gx_cut_report *report /* or NULL */, gx_failure *failure /* or NULL */);

/* A sheet made solid (GXFEM section 4.1): offset by thickness/2 to both sides along its vertex normals, rim closed.
   vertices: room for 2 x vertex_count x 3; triangles: room for 8 x triangle_count x 3. */
GXFEM_API gx_result gx_surface_solidify(const gx_surface *sheet, double thickness, double *vertices, size_t *vertex_count,
                                        uint32_t *triangles, size_t *triangle_count, const gx_allocator *allocator /* or NULL */);

/* >>view ----------------------------------------------------------------------------------------------------------------- */

/* Everything one reads off a body: arrays owned by the body, valid until the next cut or its destruction. */
typedef struct gx_view {
    size_t node_count, element_count;
    size_t cell_count;              /* kept cells, sorted by element */
    const uint32_t *cell_element;   /* cell_count */
    const uint32_t *cell_copies;    /* cell_count x 4 */
    const double *cell_volume;      /* cell_count, m3 */
    const uint32_t *cell_fragment;  /* cell_count */
    size_t copy_count;
    const uint32_t *copy_node;      /* copy_count */
    const uint8_t *copy_held;       /* copy_count, 1: held by a Dirichlet region */
    double *displacement;           /* copy_count x 3, m; the caller may write */
    double *velocity;               /* copy_count x 3, m/s; the caller may write */
    double *rest_time;              /* copy_count: for how long it has been slower than sleep_speed, s; the caller may write 0 to wake it */
    size_t fragment_count;
    const double *fragment_volume;  /* fragment_count, m3 */
    const double *fragment_mass;    /* kg */
    const double *fragment_center;  /* fragment_count x 3, centre of mass, material coordinates */
    double volume, mass;            /* of the body */
} gx_view;
/* Errors: ARGUMENT, MEMORY. */
GXFEM_API gx_result gx_body_view(gx_body *body, gx_view *view);

/* >>step ----------------------------------------------------------------------------------------------------------------- */

/* Half-space of material coordinates: X[axis] < value (side -1) or > value (side +1), strictly. */
typedef struct gx_region { uint32_t axis; int32_t side; double value; } gx_region;
/* Holds (Dirichlet) the copies of nodes in one of the regions whose own component has material there, at their present
   displacement, now and after later cuts. Replaces what was held before. */
GXFEM_API gx_result gx_body_hold(gx_body *body, const gx_region *regions, size_t region_count);

/* A step as the solver takes it; arrays are by copy, as in gx_view. previous_displacement, previous_velocity, previous_dt and rest_times
   are the body's own and not read. clock: where it is NULL, that of the body. A point of the skin is a gxs_point by its copies and
   weights. */
typedef gxs_step_desc gx_step_desc;
typedef gxs_step_report gx_step_report;
/* One time step (GXFEM Eq. 10). A cut wakes the fragments that it touches. Errors: those of gxs_solver_step, MEMORY; the body is then as
   it was.
   Copies below gx_body_desc.support_below (RXFEM Eq. 22) take the increment of the displacement field of a well supported element near
   them. Where a fragment has no element all of whose copies are well supported, its fullest element takes that part, if it is at least
   as full as support_below says; else the fragment moves as a point. */
GXFEM_API gx_result gx_body_step(gx_body *body, const gx_step_desc *desc, gx_step_report *report /* or NULL */, gx_failure *failure /* or NULL */);

/* What the solver sees of the body as it is cut now: for solvers of one's own. Arrays are the body's, valid until its next cut, hold or
   step. Errors: ARGUMENT, MEMORY. */
GXFEM_API gx_result gx_body_model(gx_body *body, gxs_model *model);

/* >>skin ----------------------------------------------------------------------------------------------------------------- */

/* Triangles of the surface of every cell group that moves as one: outer surface and both faces of every cut. */
typedef struct gx_skin {
    size_t vertex_count;
    const uint32_t *vertex_copies;  /* vertex_count x 4 */
    const double *vertex_weights;   /* vertex_count x 4, barycentric */
    const uint32_t *vertex_point;   /* vertex_count; equal: the same material point, exactly. Where the copies of weight not 0 are
                                       equal too, it is one corner of the surface: with corners so merged it is watertight */
    size_t triangle_count;
    const uint32_t *triangles;      /* triangle_count x 3, counter-clockwise from outside */
    const uint32_t *triangle_fragment;  /* triangle_count */
    const uint32_t *triangle_cut;   /* triangle_count; 0: outer surface of the mesh; 1: face of a cut */
} gx_skin;
GXFEM_API gx_result gx_body_skin(gx_body *body, gx_skin *skin);     /* arrays owned by the body, valid until the next cut */
GXFEM_API void gx_body_skin_positions(const gx_body *body, const gx_skin *skin, double *positions /* vertex_count x 3, deformed */);

/* >>hash ----------------------------------------------------------------------------------------------------------------- */

GXFEM_API uint64_t gx_body_topology_hash(gx_body *body, gx_result *result);   /* of the cell complex: same on every compiler */
GXFEM_API uint64_t gx_body_state_hash(const gx_body *body);                   /* of all that a failed call must leave alone */
GXFEM_API const char *gx_result_text(gx_result result);

#ifdef __cplusplus
}
#endif
#endif /* GXFEM_H: stop here for the interface */

#if defined(GXFEM_IMPLEMENTATION) && !defined(GXFEM_IMPLEMENTED)
#define GXFEM_IMPLEMENTED
#include "gxfem_boolean.h"
#include "gxfem_integrate.h"
#include "gxfem_solve.h"    /* again: now with its implementation */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* --- types --- */

#define GXP_NONE UINT32_MAX

typedef struct gxp_cell {       /* slot; slots 0 ... element_count-1 are the elements' first cells */
    uint32_t element;
    uint32_t copies[4];
    uint32_t first_leaf;        /* list through gxp_leaf.next; GXP_NONE: removed */
    uint32_t next;              /* next slot of the element, GXP_NONE: last */
    uint32_t kept;
    double volume;              /* m3 */
    double mass[10];            /* kg, order of gxs_element.mass */
} gxp_cell;

typedef struct gxp_leaf {       /* beside each leaf of the complex */
    uint32_t cell, next;
    uint32_t stamp;
    int32_t winding;            /* where stamp is the current solid's */
} gxp_leaf;

typedef struct gxp_box { double low[3], high[3]; uint32_t first, count; } gxp_box;     /* tree node; count 0: children first, first+1 */

enum { GXP_UNDO_CELL, GXP_UNDO_LEAF };
typedef struct gxp_undo { uint32_t kind, index; gxp_cell cell; gxp_leaf leaf; } gxp_undo;

typedef struct gxp_pair { uint32_t node, cell; } gxp_pair;

typedef struct gxp_words { uint32_t *data, count, capacity; } gxp_words;   /* growing array of indices */

struct gx_body {
    gx_allocator allocator;
    double (*clock)(void *user);
    void *clock_user;
    gxb_complex *complex;
    gxs_solver *solver;
    uint32_t node_count, element_count;
    gx_material *materials; uint32_t material_count;
    uint32_t *element_materials;    /* element_count */
    double support_below;
    double *positions;              /* node_count x 3 */
    uint32_t *node_start;           /* node_count + 1, into node_elements */
    uint32_t *node_elements;        /* element_count x 4: elements around each node */
    uint8_t *node_pinched;          /* node_count: bit 1: elements around it are not joined by faces; bit 2: one of its edges is pinched */
    uint8_t *edge_pinched;          /* mesh_edge_count: elements around it meet in the edge only */
    gxp_box *boxes; uint32_t box_count;
    uint32_t *box_elements;         /* element_count, in tree order */
    gxp_cell *cells; uint32_t cell_count, cell_capacity;
    gxp_leaf *leaves; uint32_t leaf_count, leaf_capacity;
    uint32_t *copy_node; uint32_t copy_count, copy_capacity;
    double *displacement, *velocity; uint32_t displacement_capacity, velocity_capacity;   /* copies, x 3 doubles */
    uint8_t *held; uint32_t held_capacity;
    double *rest_time; uint32_t rest_time_capacity;
    double *history[4]; uint32_t history_capacity[4];   /* displacement and velocity a step ago, x 3, and room for those of now; from the
                                                           first BDF2 step on */
    double previous_dt;                                 /* s; 0: there was none */
    gx_region *regions; uint32_t region_count;
    uint32_t label_count;           /* cut triangles so far */
    gxp_undo *undo; uint32_t undo_count, undo_capacity;
    uint32_t *cell_stamp; uint32_t cell_stamp_capacity;
    uint32_t stamp, scope_stamp;
    int held_stale, model_stale, view_stale;
    gxs_element *parts; uint32_t part_count, part_capacity;     /* there only while the solver's model is made; part_count stays */
    double *rest; uint32_t rest_capacity;               /* copies, x 3 doubles: where they are at rest, m; as long */
    gxs_material *elastic; uint32_t elastic_capacity;   /* materials for the solver; as long */
    gxs_constraint *constraints; uint32_t constraint_count, constraint_capacity;    /* as long */
    gxp_words view_cells, view_fragments;               /* slot of each kept cell; fragment of each */
    gxp_words copy_fragment, fragment_number, cell_element, cell_copies;
    double *cell_volume; uint32_t cell_volume_capacity;
    double *fragments; uint32_t fragment_capacity, fragment_count;  /* volume, mass, centre: 5 arrays of capacity fragment_capacity */
    double volume, mass;
    gxp_words skin_copies, skin_points, skin_triangles, skin_fragments, skin_cuts;
    double *skin_weights; uint32_t skin_weight_count, skin_weight_capacity;
    gxp_words point_slot;           /* of the complex's points, while a cell is integrated or drawn */
    double *lambdas; uint32_t lambda_capacity;          /* x 4 */
    gxp_words triangles;
    /* scratch of a cut */
    gxp_words touched, nodes, queue, seeds, faces;
    gxp_words fresh;                /* pieces of touched cells: their copies and integrals are to be found */
    gxp_words removed, dead, list;  /* leaves that solids removed, copies without cells */
    gxp_words pinches;              /* nodes at which sheets separated what meets there only */
    struct gxp_pair *pairs; uint32_t pair_count, pair_capacity;
};

/* >>memory -------------------------------------------------------------------------------------------------------------- */

static void *gxp_allocate(const gx_allocator *a, size_t size) { return a->allocate ? a->allocate(a->user, size) : malloc(size); }

static void gxp_release(const gx_allocator *a, void *memory, size_t size) {
    if (memory == NULL) return;
    if (a->release) a->release(a->user, memory, size);
    else free(memory);
}

/* Makes room for count + extra items; array is the address of the pointer. */
static gx_result gxp_reserve(const gx_allocator *a, void *array, size_t item, size_t count, uint32_t *capacity, size_t extra) {
    const size_t need = count + extra, room = need + need / 2 + 16;
    void *old, *memory;
    if (need <= *capacity) return GX_OK;
    if (room > INT32_MAX || room > SIZE_MAX / item) return GX_ERROR_LIMIT;
    memory = gxp_allocate(a, room * item);
    if (memory == NULL) return GX_ERROR_MEMORY;
    memcpy(&old, array, sizeof old);
    if (count > 0) memcpy(memory, old, count * item);
    gxp_release(a, old, (size_t)*capacity * item);
    memcpy(array, &memory, sizeof memory);
    *capacity = (uint32_t)room;
    return GX_OK;
}

static gx_result gxp_push(gx_body *body, gxp_words *words, uint32_t value) {
    const gx_result result = gxp_reserve(&body->allocator, &words->data, sizeof *words->data, words->count, &words->capacity, 1);
    if (result == GX_OK) words->data[words->count++] = value;
    return result;
}

static gx_result gxp_words_room(gx_body *body, gxp_words *words, size_t extra) {
    return gxp_reserve(&body->allocator, &words->data, sizeof *words->data, words->count, &words->capacity, extra);
}

static void gxp_words_free(gx_body *body, gxp_words *words) {
    gxp_release(&body->allocator, words->data, (size_t)words->capacity * sizeof *words->data);
}

static int gxp_compare_words(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

static void gxp_sort_unique(gxp_words *w) {
    uint32_t i, n = 0;
    if (w->count == 0) return;
    qsort(w->data, w->count, sizeof *w->data, gxp_compare_words);
    for (i = 0; i < w->count; i++) if (n == 0 || w->data[i] != w->data[n - 1]) w->data[n++] = w->data[i];
    w->count = n;
}

static gx_result gxp_fail(gx_failure *failure, gx_result result, size_t index, size_t surface) {
    if (failure != NULL) { failure->result = result; failure->index = index; failure->surface = surface; }
    return result;
}

static int gxp_is_finite(double x) {
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    return ((b >> 52) & 0x7ff) != 0x7ff;
}

static double gxp_seconds(const gx_body *body) { return body->clock ? body->clock(body->clock_user) : 0; }

/* >>tree: axis-aligned boxes over the elements, median split ------------------------------------------------------------- */

static void gxp_box_of(const gx_body *body, gxp_box *box) {
    uint32_t i;
    int k, n;
    for (i = box->first; i < box->first + box->count; i++) for (n = 0; n < 4; n++) {
        const double *x = body->positions + 3 * (size_t)body->complex->elements[4 * (size_t)body->box_elements[i] + (size_t)n];
        for (k = 0; k < 3; k++) {
            if ((i == box->first && n == 0) || x[k] < box->low[k]) box->low[k] = x[k];
            if ((i == box->first && n == 0) || x[k] > box->high[k]) box->high[k] = x[k];
        }
    }
}

static double gxp_element_key(const gx_body *body, uint32_t element, int axis) {
    const uint32_t *n = body->complex->elements + 4 * (size_t)element;
    const double *x = body->positions + axis;
    return x[3 * (size_t)n[0]] * 0.25 + x[3 * (size_t)n[1]] * 0.25 + x[3 * (size_t)n[2]] * 0.25 + x[3 * (size_t)n[3]] * 0.25;
}

/* Partial order: the element of rank middle stands at middle, smaller keys before it (Hoare's FIND). */
static void gxp_select(const gx_body *body, uint32_t *e, int64_t count, int64_t middle, int axis) {
    int64_t low = 0, high = count - 1;
    while (low < high) {
        const double pivot = gxp_element_key(body, e[middle], axis);
        int64_t i = low, j = high;
        while (i <= j) {
            while (gxp_element_key(body, e[i], axis) < pivot) i++;
            while (gxp_element_key(body, e[j], axis) > pivot) j--;
            if (i <= j) { const uint32_t t = e[i]; e[i++] = e[j]; e[j--] = t; }
        }
        if (j < middle) low = i;
        if (middle < i) high = j;
    }
}

static void gxp_build_boxes(gx_body *body) {
    uint32_t i, b;
    for (i = 0; i < body->element_count; i++) body->box_elements[i] = i;
    memset(&body->boxes[0], 0, sizeof body->boxes[0]);
    body->boxes[0].count = body->element_count;
    body->box_count = 1;
    for (b = 0; b < body->box_count; b++) {
        gxp_box *box = &body->boxes[b];
        const uint32_t first = box->first, count = box->count, half = count / 2;
        int axis = 0, k;
        gxp_box_of(body, box);
        if (count <= 4) continue;
        for (k = 1; k < 3; k++) if (box->high[k] - box->low[k] > box->high[axis] - box->low[axis]) axis = k;
        gxp_select(body, body->box_elements + first, count, half, axis);
        box->first = body->box_count;
        box->count = 0;
        memset(&body->boxes[body->box_count], 0, 2 * sizeof *body->boxes);
        body->boxes[body->box_count].first = first;
        body->boxes[body->box_count++].count = half;
        body->boxes[body->box_count].first = first + half;
        body->boxes[body->box_count++].count = count - half;
    }
}

/* May the triangle meet the box? Rounding only adds candidates: the margin of the plane test is far above its error. */
static int gxp_triangle_near_box(const double *const p[3], const double n[3], double scale, const gxp_box *box) {
    double s = 0, r = 0, far = 0;
    int k;
    for (k = 0; k < 3; k++) {
        const double low = fmin(p[0][k], fmin(p[1][k], p[2][k])), high = fmax(p[0][k], fmax(p[1][k], p[2][k]));
        const double c = 0.5 * box->low[k] + 0.5 * box->high[k], h = 0.5 * box->high[k] - 0.5 * box->low[k];
        if (low > box->high[k] || high < box->low[k]) return 0;
        s += n[k] * (c - p[0][k]);
        r += fabs(n[k]) * h;
        far += fabs(c - p[0][k]) + h + fabs(c) + fabs(p[0][k]);
    }
    return !gxp_is_finite(s) || fabs(s) <= r + 1e-12 * scale * far;     /* overflow: a candidate, which then is out of range */
}

/* Appends to found the elements whose boxes the triangle may meet. */
static gx_result gxp_find_elements(gx_body *body, const double *const p[3], gxp_words *found) {
    double a[3], b[3], n[3], scale;
    uint32_t stack[128], depth = 0, i;
    gx_result result = GX_OK;
    int k;
    for (k = 0; k < 3; k++) { a[k] = p[1][k] - p[0][k]; b[k] = p[2][k] - p[0][k]; }
    for (k = 0; k < 3; k++) n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    scale = (fabs(a[0]) + fabs(a[1]) + fabs(a[2])) * (fabs(b[0]) + fabs(b[1]) + fabs(b[2]));
    stack[depth++] = 0;
    while (depth > 0 && result == GX_OK) {
        const gxp_box *box = &body->boxes[stack[--depth]];
        if (!gxp_triangle_near_box(p, n, scale, box)) continue;
        if (box->count == 0) { stack[depth++] = box->first + 1; stack[depth++] = box->first; }
        for (i = 0; i < box->count && result == GX_OK; i++) result = gxp_push(body, found, body->box_elements[box->first + i]);
    }
    return result;
}

/* >>create --------------------------------------------------------------------------------------------------------------- */

static const uint8_t gxp_edge_nodes[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

static int gxp_local_node(const gx_body *body, uint32_t element, uint32_t node) {
    const uint32_t *n = body->complex->elements + 4 * (size_t)element;
    return n[0] == node ? 0 : n[1] == node ? 1 : n[2] == node ? 2 : n[3] == node ? 3 : -1;
}

static uint32_t gxp_neighbour(const gx_body *body, uint32_t element, uint32_t k) {
    const uint32_t *pair = body->complex->face_elements + 2 * (size_t)body->complex->element_faces[4 * (size_t)element + k];
    return pair[0] == element ? pair[1] : pair[0];
}

static void gxp_list_node_elements(gx_body *body) {
    const uint32_t *elements = body->complex->elements;
    uint32_t i;
    memset(body->node_start, 0, ((size_t)body->node_count + 1) * sizeof *body->node_start);
    for (i = 0; i < 4 * body->element_count; i++) body->node_start[elements[i] + 1]++;
    for (i = 0; i < body->node_count; i++) body->node_start[i + 1] += body->node_start[i];
    for (i = 0; i < 4 * body->element_count; i++) body->node_elements[body->node_start[elements[i]]++] = i / 4;
    for (i = body->node_count; i > 0; i--) body->node_start[i] = body->node_start[i - 1];
    body->node_start[0] = 0;
}

/* Walks from element to element through faces that contain the node, stamping; *reached: how many. */
static gx_result gxp_walk_around(gx_body *body, uint32_t start, uint32_t node, uint32_t *reached) {
    gx_result result = GX_OK;
    body->queue.count = 0;
    *reached = 0;
    body->cell_stamp[start] = body->stamp;
    result = gxp_push(body, &body->queue, start);
    while (*reached < body->queue.count && result == GX_OK) {
        const uint32_t e = body->queue.data[(*reached)++];
        uint32_t k;
        for (k = 0; k < 4 && result == GX_OK; k++) {
            const uint32_t other = gxp_neighbour(body, e, k), opposite = body->complex->elements[4 * (size_t)e + k];
            if (other == GXP_NONE || body->cell_stamp[other] == body->stamp || opposite == node) continue;
            body->cell_stamp[other] = body->stamp;
            result = gxp_push(body, &body->queue, other);
        }
    }
    return result;
}

/* Marks nodes and edges whose elements do not hang together through faces around them: there, edges and nodes link too. (An
   edge's elements come in as many fans as it has pairs of boundary faces.) */
static gx_result gxp_find_pinches(gx_body *body) {
    const gxb_complex *cx = body->complex;
    uint32_t i, j, k, reached;
    gx_result result = GX_OK;
    for (i = 0; i < body->node_count && result == GX_OK; i++) {
        const uint32_t first = body->node_start[i], count = body->node_start[i + 1] - first;
        if (count == 0) continue;
        body->stamp++;
        result = gxp_walk_around(body, body->node_elements[first], i, &reached);
        if (result != GX_OK || reached == count) continue;
        body->node_pinched[i] = 1;
    }
    /* an edge with one fan of elements has no or two boundary faces */
    for (i = 0; i < body->element_count; i++) for (k = 0; k < 4; k++) for (j = 0; j < 6; j++) {
        const uint32_t edge = cx->element_edges[6 * i + j];
        if (gxp_neighbour(body, i, k) != GXP_NONE || gxp_edge_nodes[j][0] == k || gxp_edge_nodes[j][1] == k) continue;
        if (body->edge_pinched[edge] < 3) body->edge_pinched[edge]++;
    }
    for (i = 0; i < cx->mesh_edge_count; i++) body->edge_pinched[i] = body->edge_pinched[i] > 2;
    for (i = 0; i < body->element_count; i++) for (j = 0; j < 6; j++) {
        if (!body->edge_pinched[cx->element_edges[6 * i + j]]) continue;
        body->node_pinched[cx->elements[4 * i + gxp_edge_nodes[j][0]]] |= 2;
        body->node_pinched[cx->elements[4 * i + gxp_edge_nodes[j][1]]] |= 2;
    }
    return result;
}

static void gxp_element_positions(const gx_body *body, uint32_t element, double x[12]) {
    int k;
    for (k = 0; k < 4; k++)
        memcpy(x + 3 * k, body->positions + 3 * (size_t)body->complex->elements[4 * (size_t)element + (size_t)k], 3 * sizeof *x);
}

static double gxp_element_volume(const gx_body *body, uint32_t element) {
    double x[12];
    gxp_element_positions(body, element, x);
    return gxi_tet_volume(x);
}

static double gxp_density(const gx_body *body, uint32_t element) { return body->materials[body->element_materials[element]].density; }

static void gxp_make_first_cells(gx_body *body) {
    uint32_t e;
    body->cell_count = body->leaf_count = body->element_count;
    for (e = 0; e < body->element_count; e++) {
        gxp_cell *cell = &body->cells[e];
        memset(cell, 0, sizeof *cell);
        cell->element = cell->first_leaf = e;
        memcpy(cell->copies, body->complex->elements + 4 * (size_t)e, sizeof cell->copies);
        cell->next = GXP_NONE;
        cell->kept = 1;
        cell->volume = gxp_element_volume(body, e);
        gxi_tet_mass(cell->volume, gxp_density(body, e), cell->mass);
        memset(&body->leaves[e], 0, sizeof body->leaves[e]);
        body->leaves[e].cell = e;
        body->leaves[e].next = GXP_NONE;
    }
}

/* A node that no element uses has no copy: copies are numbered over the used nodes. */
static void gxp_make_first_copies(gx_body *body) {
    uint32_t i, e;
    int k;
    body->copy_count = 0;
    for (i = 0; i < body->node_count; i++) {
        if (body->node_start[i] == body->node_start[i + 1]) continue;
        for (e = body->node_start[i]; e < body->node_start[i + 1]; e++) {
            k = gxp_local_node(body, body->node_elements[e], i);
            body->cells[body->node_elements[e]].copies[k] = body->copy_count;
        }
        body->copy_node[body->copy_count++] = i;
    }
    memset(body->displacement, 0, 3 * (size_t)body->copy_count * sizeof(double));
    memset(body->velocity, 0, 3 * (size_t)body->copy_count * sizeof(double));
    memset(body->rest_time, 0, body->copy_count * sizeof(double));
    memset(body->held, 0, body->copy_count);
}

static gx_result gxp_reserve_copies(gx_body *body, size_t extra) {
    const gx_allocator *a = &body->allocator;
    const size_t n = body->copy_count;
    int i;
    gx_result r = gxp_reserve(a, &body->copy_node, sizeof *body->copy_node, n, &body->copy_capacity, extra);
    if (r == GX_OK) r = gxp_reserve(a, &body->displacement, 3 * sizeof(double), n, &body->displacement_capacity, extra);
    if (r == GX_OK) r = gxp_reserve(a, &body->velocity, 3 * sizeof(double), n, &body->velocity_capacity, extra);
    if (r == GX_OK) r = gxp_reserve(a, &body->rest_time, sizeof(double), n, &body->rest_time_capacity, extra);
    for (i = 0; i < 4 && r == GX_OK && body->history[i] != NULL; i++)
        r = gxp_reserve(a, &body->history[i], 3 * sizeof(double), n, &body->history_capacity[i], extra);
    return r == GX_OK ? gxp_reserve(a, &body->held, 1, n, &body->held_capacity, extra) : r;
}

/* The state of one copy becomes that of another. */
static void gxp_copy_state(gx_body *body, uint32_t from, uint32_t to) {
    const size_t a = 3 * (size_t)from, b = 3 * (size_t)to, size = 3 * sizeof(double);
    int i;
    memcpy(body->displacement + b, body->displacement + a, size);
    memcpy(body->velocity + b, body->velocity + a, size);
    for (i = 0; i < 2 && body->previous_dt > 0; i++) memcpy(body->history[i] + b, body->history[i] + a, size);
    body->rest_time[to] = body->rest_time[from];
    body->held[to] = body->held[from];
}

static gx_result gxp_reserve_cells(gx_body *body, size_t extra) {
    const gx_allocator *a = &body->allocator;
    const uint32_t before = body->cell_stamp_capacity;
    gx_result r = gxp_reserve(a, &body->cells, sizeof *body->cells, body->cell_count, &body->cell_capacity, extra);
    if (r == GX_OK) r = gxp_reserve(a, &body->cell_stamp, sizeof *body->cell_stamp, before, &body->cell_stamp_capacity,
                                    body->cell_capacity > before ? body->cell_capacity - before : 0);
    if (body->cell_stamp_capacity > before)
        memset(body->cell_stamp + before, 0, (size_t)(body->cell_stamp_capacity - before) * sizeof *body->cell_stamp);
    return r;
}

static void *gxp_table(gx_body *body, size_t count, size_t item) {
    void *memory = gxp_allocate(&body->allocator, (count + 1) * item);
    if (memory != NULL) memset(memory, 0, (count + 1) * item);
    return memory;
}

/* The tables of fixed size; gx_body_destroy releases what there is. */
static gx_result gxp_allocate_tables(gx_body *body) {
    const size_t n = body->node_count, e = body->element_count;
    body->positions = (double *)gxp_table(body, 3 * n, sizeof(double));
    body->node_start = (uint32_t *)gxp_table(body, n, sizeof(uint32_t));
    body->node_elements = (uint32_t *)gxp_table(body, 4 * e, sizeof(uint32_t));
    body->node_pinched = (uint8_t *)gxp_table(body, n, 1);
    body->edge_pinched = (uint8_t *)gxp_table(body, body->complex->mesh_edge_count, 1);
    body->boxes = (gxp_box *)gxp_table(body, 2 * e, sizeof(gxp_box));
    body->box_elements = (uint32_t *)gxp_table(body, e, sizeof(uint32_t));
    body->element_materials = (uint32_t *)gxp_table(body, e, sizeof(uint32_t));
    body->materials = (gx_material *)gxp_table(body, body->material_count, sizeof *body->materials);
    return body->element_materials && body->materials && body->positions && body->node_start && body->node_elements && body->node_pinched && body->edge_pinched &&
           body->boxes && body->box_elements ? GX_OK : GX_ERROR_MEMORY;
}

static gx_result gxp_create_solver(gx_body *body, const gx_body_desc *desc) {
    gxs_solver_desc solver;
    memset(&solver, 0, sizeof solver);
    solver.allocator = body->allocator;
    solver.jobs = desc->jobs;
    return gxs_solver_create(&solver, &body->solver);
}

static void gxp_fill_materials(gx_body *body, const gx_body_desc *desc) {
    if (desc->materials != NULL) memcpy(body->materials, desc->materials, body->material_count * sizeof *body->materials);
    else {
        body->materials->elastic.young = desc->young; body->materials->elastic.poisson = desc->poisson;
        body->materials->density = desc->density;
    }
    if (desc->materials != NULL && desc->element_materials != NULL)
        memcpy(body->element_materials, desc->element_materials, body->element_count * sizeof(uint32_t));
}

static gx_result gxp_fill_body(gx_body *body, const gx_body_desc *desc) {
    gx_result result = gxp_allocate_tables(body);
    if (result == GX_OK) result = gxp_create_solver(body, desc);
    if (result == GX_OK) result = gxp_reserve_cells(body, body->element_count);
    if (result == GX_OK) result = gxp_reserve(&body->allocator, &body->leaves, sizeof *body->leaves, 0, &body->leaf_capacity, body->element_count);
    if (result == GX_OK) result = gxp_reserve_copies(body, body->node_count);
    if (result != GX_OK) return result;
    memcpy(body->positions, desc->positions, 3 * (size_t)body->node_count * sizeof(double));
    gxp_fill_materials(body, desc);
    gxp_list_node_elements(body);
    result = gxp_find_pinches(body);
    if (result != GX_OK) return result;
    gxp_make_first_cells(body);
    gxp_make_first_copies(body);
    gxp_build_boxes(body);
    body->model_stale = body->view_stale = 1;
    return GX_OK;
}

static gx_result gxp_check_material(double young, double poisson, double density) {
    if (!gxp_is_finite(young) || !gxp_is_finite(poisson) || !gxp_is_finite(density)) return GX_ERROR_NOT_FINITE;
    return young > 0 && density > 0 && poisson >= 0 && poisson < 0.5 ? GX_OK : GX_ERROR_ARGUMENT;
}

/* index: of the material or element to blame */
static gx_result gxp_check_body_desc(const gx_body_desc *desc, size_t *index) {
    gx_result result = GX_OK;
    size_t i;
    *index = SIZE_MAX;
    if ((desc->allocator.allocate == NULL) != (desc->allocator.release == NULL)) return GX_ERROR_ARGUMENT;
    if (!gxp_is_finite(desc->support_below)) return GX_ERROR_NOT_FINITE;
    if (desc->support_below < 0 || desc->support_below >= 1) return GX_ERROR_ARGUMENT;
    if (desc->materials == NULL) return gxp_check_material(desc->young, desc->poisson, desc->density);
    if (desc->material_count == 0 || desc->material_count >= INT32_MAX) return desc->material_count == 0 ? GX_ERROR_EMPTY : GX_ERROR_LIMIT;
    for (i = 0; i < desc->material_count && result == GX_OK; i++) {
        const gxs_material *m = &desc->materials[*index = i].elastic;
        result = gxp_check_material(m->young, m->poisson, desc->materials[i].density);
        if (result == GX_OK && !gxp_is_finite(m->damping)) result = GX_ERROR_NOT_FINITE;
        if (result == GX_OK && ((int)m->kind < 0 || m->kind > GXS_CUSTOM || m->damping < 0 || (m->kind == GXS_CUSTOM && m->energy == NULL)))
            result = GX_ERROR_ARGUMENT;
    }
    for (i = 0; i < desc->element_count && result == GX_OK && desc->element_materials != NULL; i++)
        if (desc->element_materials[*index = i] >= desc->material_count) result = GX_ERROR_INDEX;
    return result;
}

GXFEM_API gx_result gx_body_create(const gx_body_desc *desc, gx_body **out, gx_failure *failure) {
    gx_body *body;
    gxb_mesh mesh;
    gx_result result;
    size_t index;
    if (desc == NULL || out == NULL) return gxp_fail(failure, GX_ERROR_ARGUMENT, SIZE_MAX, SIZE_MAX);
    result = gxp_check_body_desc(desc, &index);
    if (result != GX_OK) return gxp_fail(failure, result, index, SIZE_MAX);
    body = (gx_body *)gxp_allocate(&desc->allocator, sizeof *body);
    if (body == NULL) return gxp_fail(failure, GX_ERROR_MEMORY, SIZE_MAX, SIZE_MAX);
    memset(body, 0, sizeof *body);
    body->allocator = desc->allocator;
    body->clock = desc->clock; body->clock_user = desc->clock_user;
    body->material_count = desc->materials != NULL ? (uint32_t)desc->material_count : 1;
    body->support_below = desc->support_below;
    mesh.positions = desc->positions; mesh.node_count = desc->node_count;
    mesh.elements = desc->elements; mesh.element_count = desc->element_count;
    result = gxb_complex_create(&mesh, &desc->allocator, &body->complex, failure);
    if (result != GX_OK) { gx_body_destroy(body); return result; }
    body->node_count = body->complex->node_count;
    body->element_count = body->complex->element_count;
    result = gxp_fill_body(body, desc);
    if (result != GX_OK) { gx_body_destroy(body); return gxp_fail(failure, result, SIZE_MAX, SIZE_MAX); }
    *out = body;
    return gxp_fail(failure, GX_OK, SIZE_MAX, SIZE_MAX);
}

/* What the solver has copied */
static void gxp_release_model(gx_body *body) {
    const gx_allocator *a = &body->allocator;
    gxp_release(a, body->parts, body->part_capacity * sizeof *body->parts);
    gxp_release(a, body->rest, (size_t)body->rest_capacity * 3 * sizeof(double));
    gxp_release(a, body->elastic, body->elastic_capacity * sizeof *body->elastic);
    gxp_release(a, body->constraints, body->constraint_capacity * sizeof *body->constraints);
    body->parts = NULL; body->rest = NULL; body->elastic = NULL; body->constraints = NULL;
    body->part_capacity = body->rest_capacity = body->elastic_capacity = body->constraint_capacity = 0;
}

GXFEM_API void gx_body_destroy(gx_body *body) {
    gx_allocator a;
    size_t n, e, i;
    if (body == NULL) return;
    a = body->allocator;
    n = body->node_count; e = body->element_count;
    gxp_release(&a, body->positions, (3 * n + 1) * sizeof(double));
    gxp_release(&a, body->node_start, (n + 1) * sizeof(uint32_t));
    gxp_release(&a, body->node_elements, (4 * e + 1) * sizeof(uint32_t));
    gxp_release(&a, body->node_pinched, n + 1);
    if (body->complex) gxp_release(&a, body->edge_pinched, (size_t)body->complex->mesh_edge_count + 1);
    gxp_release(&a, body->boxes, (2 * e + 1) * sizeof(gxp_box));
    gxp_release(&a, body->box_elements, (e + 1) * sizeof(uint32_t));
    gxp_release(&a, body->cells, body->cell_capacity * sizeof *body->cells);
    gxp_release(&a, body->cell_stamp, body->cell_stamp_capacity * sizeof *body->cell_stamp);
    gxp_release(&a, body->leaves, body->leaf_capacity * sizeof *body->leaves);
    gxp_release(&a, body->copy_node, body->copy_capacity * sizeof *body->copy_node);
    gxp_release(&a, body->displacement, (size_t)body->displacement_capacity * 3 * sizeof(double));
    gxp_release(&a, body->velocity, (size_t)body->velocity_capacity * 3 * sizeof(double));
    gxp_release(&a, body->held, body->held_capacity);
    gxp_release(&a, body->rest_time, body->rest_time_capacity * sizeof(double));
    for (i = 0; i < 4; i++) gxp_release(&a, body->history[i], (size_t)body->history_capacity[i] * 3 * sizeof(double));
    gxp_release(&a, body->materials, ((size_t)body->material_count + 1) * sizeof *body->materials);
    gxp_release(&a, body->element_materials, (e + 1) * sizeof(uint32_t));
    gxp_release_model(body);
    gxp_release(&a, body->regions, body->region_count * sizeof *body->regions);
    gxp_release(&a, body->undo, body->undo_capacity * sizeof *body->undo);
    gxp_release(&a, body->pairs, body->pair_capacity * sizeof *body->pairs);
    gxp_release(&a, body->cell_volume, body->cell_volume_capacity * sizeof(double));
    gxp_release(&a, body->fragments, (size_t)body->fragment_capacity * 5 * sizeof(double));
    gxp_release(&a, body->skin_weights, body->skin_weight_capacity * sizeof(double));
    gxp_release(&a, body->lambdas, (size_t)body->lambda_capacity * 4 * sizeof(double));
    {
        gxp_words *words[23];
        words[0] = &body->view_cells; words[1] = &body->view_fragments; words[2] = &body->copy_fragment; words[3] = &body->cell_element;
        words[4] = &body->cell_copies; words[5] = &body->skin_copies; words[6] = &body->skin_triangles; words[7] = &body->skin_fragments;
        words[8] = &body->skin_cuts; words[9] = &body->point_slot; words[10] = &body->triangles; words[11] = &body->touched;
        words[12] = &body->nodes; words[13] = &body->queue; words[14] = &body->seeds; words[15] = &body->faces;
        words[16] = &body->fresh; words[17] = &body->list;
        words[18] = &body->removed; words[19] = &body->dead;
        words[20] = &body->fragment_number; words[21] = &body->skin_points;
        words[22] = &body->pinches;
        for (i = 0; i < 23; i++) gxp_words_free(body, words[i]);
    }
    gxs_solver_destroy(body->solver);
    gxb_complex_destroy(body->complex);
    gxp_release(&a, body, sizeof *body);
}

/* >>transaction: a cut changes cells and leaves in place; an undo log, the counts and the complex's own log take it back ------- */

typedef struct gxp_counts { uint32_t cells, leaves, copies, labels; } gxp_counts;

/* What one cut works with. */
typedef struct gxp_cut {
    gx_body *body;
    const gx_cut_desc *desc;
    gxp_counts before;
    gx_cut_report report;
    gx_failure failure;
} gxp_cut;

static gx_result gxp_save_cell(gx_body *body, uint32_t cell) {
    const gx_result r = gxp_reserve(&body->allocator, &body->undo, sizeof *body->undo, body->undo_count, &body->undo_capacity, 1);
    if (r != GX_OK) return r;
    body->undo[body->undo_count].kind = GXP_UNDO_CELL;
    body->undo[body->undo_count].index = cell;
    body->undo[body->undo_count++].cell = body->cells[cell];
    return GX_OK;
}

static gx_result gxp_set_leaf(gx_body *body, uint32_t leaf, uint32_t cell, uint32_t next) {
    const gx_result r = gxp_reserve(&body->allocator, &body->undo, sizeof *body->undo, body->undo_count, &body->undo_capacity, 1);
    if (r != GX_OK) return r;
    body->undo[body->undo_count].kind = GXP_UNDO_LEAF;
    body->undo[body->undo_count].index = leaf;
    body->undo[body->undo_count++].leaf = body->leaves[leaf];
    body->leaves[leaf].cell = cell;
    body->leaves[leaf].next = next;
    return GX_OK;
}

static void gxp_begin(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxb_complex_begin(body->complex);
    body->undo_count = 0;
    cut->before.cells = body->cell_count; cut->before.leaves = body->leaf_count;
    cut->before.copies = body->copy_count; cut->before.labels = body->label_count;
}

static void gxp_rollback(gxp_cut *cut) {
    gx_body *body = cut->body;
    while (body->undo_count > 0) {
        const gxp_undo *undo = &body->undo[--body->undo_count];
        if (undo->kind == GXP_UNDO_CELL) body->cells[undo->index] = undo->cell;
        else body->leaves[undo->index] = undo->leaf;
    }
    body->cell_count = cut->before.cells; body->leaf_count = cut->before.leaves;
    body->copy_count = cut->before.copies; body->label_count = cut->before.labels;
    gxb_complex_rollback(body->complex);
}

/* >>surfaces: what the caller gave ------------------------------------------------------------------------------------------- */

typedef struct gxp_half_edge { uint32_t from, to, triangle, corner; } gxp_half_edge;

static int gxp_compare_half_edges(const void *a, const void *b) {
    const gxp_half_edge *p = (const gxp_half_edge *)a, *q = (const gxp_half_edge *)b;
    const uint32_t pl = p->from < p->to ? p->from : p->to, ph = p->from < p->to ? p->to : p->from;
    const uint32_t ql = q->from < q->to ? q->from : q->to, qh = q->from < q->to ? q->to : q->from;
    if (pl != ql) return pl < ql ? -1 : 1;
    if (ph != qh) return ph < qh ? -1 : 1;
    return p->triangle != q->triangle ? p->triangle < q->triangle ? -1 : 1 : 0;
}

typedef struct gxp_named_point { double x[3]; uint32_t index; } gxp_named_point;

static int gxp_compare_points(const void *a, const void *b) {
    const gxp_named_point *p = (const gxp_named_point *)a, *q = (const gxp_named_point *)b;
    int k;
    for (k = 0; k < 3; k++) if (p->x[k] != q->x[k]) return p->x[k] < q->x[k] ? -1 : 1;
    return p->index != q->index ? p->index < q->index ? -1 : 1 : 0;
}

/* One surface while it cuts: its triangles, the vertices and planes already in the complex, and which triangles meet at edges. */
typedef struct gxp_surface {
    const gx_surface *given;
    size_t number;                  /* among the cut's surfaces */
    uint32_t label;                 /* of its first triangle */
    uint32_t *point;                /* vertex_count: in the complex, or GXP_NONE */
    gxb_triangle *triangles;        /* triangle_count; plane GXP_NONE: not in the complex yet */
    uint8_t *flat;                  /* triangle_count: no area */
    gxp_half_edge *edges;           /* 3 x triangle_count, sorted: edges with the same ends stand together */
    uint32_t *merged;               /* vertex_count: the first vertex with the same coordinates */
} gxp_surface;

static void gxp_surface_free(gx_body *body, gxp_surface *s) {
    const size_t v = s->given->vertex_count, t = s->given->triangle_count;
    gxp_release(&body->allocator, s->point, v * sizeof *s->point);
    gxp_release(&body->allocator, s->triangles, t * sizeof *s->triangles);
    gxp_release(&body->allocator, s->flat, t);
    gxp_release(&body->allocator, s->edges, 3 * t * sizeof *s->edges);
    gxp_release(&body->allocator, s->merged, v * sizeof *s->merged);
}

static gx_result gxp_check_surface(gxp_cut *cut, const gx_surface *s, size_t number) {
    size_t i;
    cut->failure.surface = number;
    if (s->kind > GX_SURFACE_SOLID) return GX_ERROR_ARGUMENT;
    if (s->vertex_count == 0 || s->triangle_count == 0) return GX_ERROR_EMPTY;
    if (s->vertices == NULL || s->triangles == NULL) return GX_ERROR_ARGUMENT;
    if (s->vertex_count > INT32_MAX / 4 || s->triangle_count > INT32_MAX / 4) return GX_ERROR_LIMIT;
    for (i = 0; i < s->vertex_count; i++) {
        cut->failure.index = i;
        if (!gxp_is_finite(s->vertices[3 * i]) || !gxp_is_finite(s->vertices[3 * i + 1]) || !gxp_is_finite(s->vertices[3 * i + 2]))
            return GX_ERROR_NOT_FINITE;
    }
    for (i = 0; i < s->triangle_count; i++) {
        cut->failure.index = i;
        if (s->triangles[3 * i] >= s->vertex_count || s->triangles[3 * i + 1] >= s->vertex_count ||
            s->triangles[3 * i + 2] >= s->vertex_count) return GX_ERROR_INDEX;
    }
    cut->failure.index = SIZE_MAX;
    return GX_OK;
}

/* A triangle has no area where all its projections to coordinate planes have none. */
static int gxp_is_flat(const double *a, const double *b, const double *c) {
    int k;
    for (k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        double p[2], q[2], r[2];
        p[0] = a[i]; p[1] = a[j]; q[0] = b[i]; q[1] = b[j]; r[0] = c[i]; r[1] = c[j];
        if (gxb_orient2d(p, q, r) != 0) return 0;
    }
    return 1;
}

static gx_result gxp_merge_vertices(gx_body *body, gxp_surface *s) {
    const size_t n = s->given->vertex_count;
    gxp_named_point *named = (gxp_named_point *)gxp_allocate(&body->allocator, n * sizeof *named);
    size_t i;
    if (named == NULL) return GX_ERROR_MEMORY;
    for (i = 0; i < n; i++) {
        memcpy(named[i].x, s->given->vertices + 3 * i, sizeof named[i].x);
        named[i].index = (uint32_t)i;
    }
    qsort(named, n, sizeof *named, gxp_compare_points);
    for (i = 0; i < n; i++) {
        const int same = i > 0 && named[i].x[0] == named[i - 1].x[0] && named[i].x[1] == named[i - 1].x[1] && named[i].x[2] == named[i - 1].x[2];
        s->merged[named[i].index] = same ? s->merged[named[i - 1].index] : named[i].index;
    }
    gxp_release(&body->allocator, named, n * sizeof *named);
    return GX_OK;
}

static void gxp_sort_edges(gxp_surface *s) {
    uint32_t t, k;
    for (t = 0; t < s->given->triangle_count; t++) for (k = 0; k < 3; k++) {
        gxp_half_edge *e = &s->edges[3 * t + k];
        e->from = s->merged[s->given->triangles[3 * t + k]];
        e->to = s->merged[s->given->triangles[3 * t + (k + 1) % 3]];
        e->triangle = t; e->corner = k;
    }
    qsort(s->edges, 3 * s->given->triangle_count, sizeof *s->edges, gxp_compare_half_edges);
}

static int gxp_same_ends(const gxp_half_edge *a, const gxp_half_edge *b) {
    return (a->from == b->from && a->to == b->to) || (a->from == b->to && a->to == b->from);
}

/* A surface has no boundary where at each edge as many triangles go one way as the other. */
static gx_result gxp_check_closed(gxp_cut *cut, const gxp_surface *s) {
    const size_t n = 3 * s->given->triangle_count;
    size_t i, j;
    for (i = 0; i < n; i = j) {
        long balance = 0;
        for (j = i; j < n && gxp_same_ends(&s->edges[i], &s->edges[j]); j++) balance += s->edges[j].from < s->edges[j].to ? 1 : s->edges[j].from > s->edges[j].to ? -1 : 0;
        if (balance != 0) {
            cut->failure.index = s->edges[i].triangle;
            cut->failure.surface = s->number;
            return GX_ERROR_NOT_CLOSED;
        }
    }
    return GX_OK;
}

static gx_result gxp_surface_open(gxp_cut *cut, gxp_surface *s, const gx_surface *given, size_t number) {
    gx_body *body = cut->body;
    const size_t v = given->vertex_count, t = given->triangle_count;
    gx_result result;
    uint32_t i;
    memset(s, 0, sizeof *s);
    s->given = given; s->number = number; s->label = body->label_count;
    if (t > INT32_MAX - (size_t)body->label_count) return GX_ERROR_LIMIT;
    body->label_count += (uint32_t)t;
    s->point = (uint32_t *)gxp_allocate(&body->allocator, v * sizeof *s->point);
    s->triangles = (gxb_triangle *)gxp_allocate(&body->allocator, t * sizeof *s->triangles);
    s->flat = (uint8_t *)gxp_allocate(&body->allocator, t);
    s->edges = (gxp_half_edge *)gxp_allocate(&body->allocator, 3 * t * sizeof *s->edges);
    s->merged = (uint32_t *)gxp_allocate(&body->allocator, v * sizeof *s->merged);
    if (!s->point || !s->triangles || !s->flat || !s->edges || !s->merged) return GX_ERROR_MEMORY;
    memset(s->point, 0xff, v * sizeof *s->point);
    for (i = 0; i < t; i++) {
        const uint32_t *n = given->triangles + 3 * (size_t)i;
        s->triangles[i].plane = GXP_NONE;
        s->flat[i] = (uint8_t)gxp_is_flat(given->vertices + 3 * (size_t)n[0], given->vertices + 3 * (size_t)n[1], given->vertices + 3 * (size_t)n[2]);
        cut->report.ignored_triangles += s->flat[i];
    }
    result = gxp_merge_vertices(body, s);
    if (result != GX_OK) return result;
    gxp_sort_edges(s);
    return given->kind == GX_SURFACE_SOLID ? gxp_check_closed(cut, s) : GX_OK;
}

/* >>arrange: the surfaces go into the complex --------------------------------------------------------------------------------- */

/* A coplanar neighbour across an edge that already has a plane lends it. */
static int gxp_borrow_plane(gx_body *body, gxp_surface *s, uint32_t t) {
    gxb_triangle *own = &s->triangles[t];
    const size_t n = 3 * s->given->triangle_count;
    uint32_t k;
    for (k = 0; k < 3; k++) {
        gxp_half_edge key, *e;
        key.from = s->merged[s->given->triangles[3 * t + k]]; key.to = s->merged[s->given->triangles[3 * t + (k + 1) % 3]];
        key.triangle = t; key.corner = k;
        e = (gxp_half_edge *)bsearch(&key, s->edges, n, sizeof *s->edges, gxp_compare_half_edges);
        if (e == NULL) continue;
        while (e > s->edges && gxp_same_ends(e - 1, e)) e--;
        for (; e < s->edges + n && gxp_same_ends(e, &key); e++) {
            const gxb_triangle *other = &s->triangles[e->triangle];
            if (e->triangle == t || other->plane == GXP_NONE || s->flat[e->triangle]) continue;
            if (gxb_complex_side(body->complex, own->point[(k + 2) % 3], other->plane) != 0) continue;
            own->plane = other->plane;
            own->orientation = 0;       /* settled by gxp_settle_orientation */
            own->edge_plane[0] = own->edge_plane[1] = own->edge_plane[2] = GXB_NONE;
            return 1;
        }
    }
    return 0;
}

/* Does the triangle turn as the plane's own normal says? Seen along the plane's axis. */
static void gxp_settle_orientation(const gx_body *body, const gxp_surface *s, gxb_triangle *t, uint32_t index) {
    const gxb_cplane *plane = &body->complex->planes[t->plane];
    const int i = (int)(plane->axis + 1) % 3, j = (int)(plane->axis + 2) % 3;
    double p[3][2];
    int k;
    for (k = 0; k < 3; k++) {
        const double *x = s->given->vertices + 3 * (size_t)s->given->triangles[3 * (size_t)index + (size_t)k];
        p[k][0] = x[i]; p[k][1] = x[j];
    }
    t->orientation = gxb_orient2d(p[0], p[1], p[2]) * plane->axis_sign;
}

/* Gives the triangle its points and its plane in the complex, once. */
static gx_result gxp_prepare_triangle(gxp_cut *cut, gxp_surface *s, uint32_t index) {
    gx_body *body = cut->body;
    gxb_triangle *t = &s->triangles[index];
    uint32_t k;
    for (k = 0; k < 3; k++) {
        const uint32_t v = s->merged[s->given->triangles[3 * index + k]];
        if (s->point[v] == GXP_NONE) {
            const gx_result result = gxb_complex_add_point(body->complex, s->given->vertices + 3 * (size_t)v, &s->point[v]);
            cut->failure.index = v; cut->failure.surface = s->number;
            if (result != GX_OK) return result;
        }
        t->point[k] = s->point[v];
    }
    cut->failure.index = cut->failure.surface = SIZE_MAX;
    t->label = s->label + index;
    t->wall = s->given->kind == GX_SURFACE_SHEET;
    if (gxp_borrow_plane(body, s, index)) {
        gxp_settle_orientation(body, s, t, index);
        return GX_OK;
    }
    return gxb_complex_add_plane(body->complex, t);
}

static uint32_t gxp_old_leaf(const gx_body *body, uint32_t leaf) {
    while (leaf >= body->leaf_count) leaf = body->complex->leaves[leaf].parent;
    return leaf;
}

/* May the cut touch this leaf? Its cell (before the cut) is in scope where it is stamped. */
static int gxp_in_scope(void *user, uint32_t leaf) {
    const gx_body *body = (const gx_body *)user;
    return body->cell_stamp[body->leaves[gxp_old_leaf(body, leaf)].cell] == body->scope_stamp;
}

/* Has the element a cell that the cut may touch? */
static int gxp_element_in_scope(const gx_body *body, uint32_t element) {
    uint32_t cell;
    for (cell = element; cell != GXP_NONE; cell = body->cells[cell].next) if (body->cell_stamp[cell] == body->scope_stamp) return 1;
    return 0;
}

/* A sheet through an edge or node in which alone elements meet separates them there, even if it enters neither. */
static gx_result gxp_cover_pinches(gx_body *body, gxb_triangle *t, uint32_t element) {
    const gxb_complex *cx = body->complex;
    uint32_t k;
    gx_result result = GX_OK;
    for (k = 0; k < 4 && result == GX_OK; k++) {
        const uint32_t node = cx->elements[4 * element + k];
        int covered = 0;
        if (!(body->node_pinched[node] & 1)) continue;
        result = gxb_complex_cover_node(body->complex, t, node, &covered);
        if (covered && result == GX_OK) result = gxp_push(body, &body->pinches, node);
    }
    for (k = 0; k < 6 && result == GX_OK; k++) {
        int covered = 0;
        if (!body->edge_pinched[cx->element_edges[6 * element + k]]) continue;
        result = gxb_complex_cover_edge(body->complex, t, element, k, &covered);
        if (covered && result == GX_OK) result = gxp_push(body, &body->pinches, cx->elements[4 * element + gxp_edge_nodes[k][0]]);
        if (covered && result == GX_OK) result = gxp_push(body, &body->pinches, cx->elements[4 * element + gxp_edge_nodes[k][1]]);
    }
    return result;
}

static gx_result gxp_insert_triangle(gxp_cut *cut, gxp_surface *s, uint32_t index, int scoped) {
    gx_body *body = cut->body;
    const double *p[3];
    uint32_t k, i;
    gx_result result;
    for (k = 0; k < 3; k++) p[k] = s->given->vertices + 3 * (size_t)s->given->triangles[3 * index + k];
    body->list.count = 0;
    result = gxp_find_elements(body, p, &body->list);
    if (result == GX_OK && body->list.count > 0) result = gxp_prepare_triangle(cut, s, index);
    for (i = 0; i < body->list.count && result == GX_OK; i++) {
        const uint32_t element = body->list.data[i];
        result = gxb_complex_insert(body->complex, &s->triangles[index], element, scoped ? gxp_in_scope : NULL, body);
        if (result == GX_OK && s->triangles[index].wall && (!scoped || gxp_element_in_scope(body, element)))
            result = gxp_cover_pinches(body, &s->triangles[index], element);
    }
    return result;
}

/* Inserts the triangles in a shuffled order, always the same one: planes in random order make shallow trees. */
static gx_result gxp_insert_surface(gxp_cut *cut, gxp_surface *s, int scoped) {
    const uint32_t count = (uint32_t)s->given->triangle_count;
    gx_body *body = cut->body;
    uint64_t random = 0x9e3779b97f4a7c15u;
    uint32_t i;
    gx_result result;
    body->seeds.count = 0;
    result = gxp_words_room(body, &body->seeds, count);
    for (i = 0; i < count && result == GX_OK; i++) body->seeds.data[i] = i;
    for (i = count; i > 1 && result == GX_OK; i--) {
        uint32_t j, t;
        random = random * 6364136223846793005u + 1442695040888963407u;
        j = (uint32_t)((random >> 33) % i);
        t = body->seeds.data[i - 1]; body->seeds.data[i - 1] = body->seeds.data[j]; body->seeds.data[j] = t;
    }
    for (i = 0; i < count && result == GX_OK; i++)
        if (!s->flat[body->seeds.data[i]]) result = gxp_insert_triangle(cut, s, body->seeds.data[i], scoped);
    return result;
}

/* Stamps the cells that the cut may touch. */
static gx_result gxp_stamp_scope(gxp_cut *cut, int *scoped) {
    gx_body *body = cut->body;
    const gx_cut_desc *desc = cut->desc;
    gx_view view;
    gx_result result;
    size_t i, j;
    *scoped = desc->scope_fragment_count > 0 || desc->scope_cell_count > 0;
    if (!*scoped) return GX_OK;
    result = gx_body_view(body, &view);
    if (result != GX_OK) return result;
    body->scope_stamp = ++body->stamp;
    for (i = 0; i < desc->scope_cell_count; i++) {
        if (desc->scope_cells[i] >= view.cell_count) { cut->failure.index = i; return GX_ERROR_INDEX; }
        body->cell_stamp[body->view_cells.data[desc->scope_cells[i]]] = body->scope_stamp;
    }
    for (i = 0; i < desc->scope_fragment_count; i++) {
        if (desc->scope_fragments[i] >= view.fragment_count) { cut->failure.index = i; return GX_ERROR_INDEX; }
        for (j = 0; j < view.cell_count; j++)
            if (view.cell_fragment[j] == desc->scope_fragments[i]) body->cell_stamp[body->view_cells.data[j]] = body->scope_stamp;
    }
    return GX_OK;
}

/* see >>fragments */
static gx_result gxp_update_view(gx_body *body);
static uint32_t gxp_cell_fragment(gx_body *body, uint32_t cell);

/* >>solids: winding numbers of leaves ---------------------------------------------------------------------------------------- */

/* Room beside new leaves of the complex; new leaves start in their parent's cell, outside its list. */
static gx_result gxp_follow_leaves(gx_body *body) {
    const uint32_t count = body->complex->leaf_count;
    const gx_result result = gxp_reserve(&body->allocator, &body->leaves, sizeof *body->leaves, body->leaf_count, &body->leaf_capacity,
                                         count - body->leaf_count);
    if (result != GX_OK) return result;
    for (; body->leaf_count < count; body->leaf_count++) {
        gxp_leaf *leaf = &body->leaves[body->leaf_count];
        memset(leaf, 0, sizeof *leaf);
        leaf->cell = body->leaves[body->complex->leaves[body->leaf_count].parent].cell;
        leaf->next = GXP_NONE;
    }
    return GX_OK;
}

/* By how much the solid's winding number is larger behind the facet than in front: triangles that face its front count 1. */
static int32_t gxp_winding_step(const gx_body *body, const gxp_surface *s, uint32_t facet, int *labelled) {
    const gxb_complex *cx = body->complex;
    int32_t step = 0;
    uint32_t l;
    *labelled = 0;
    for (l = cx->facets[facet].labels; l != GXB_NONE; l = cx->labels[l].next) {
        if (cx->labels[l].triangle < s->label || cx->labels[l].triangle - s->label >= s->given->triangle_count) continue;
        *labelled = 1;
        step += cx->labels[l].orientation;
    }
    return step;
}

/* Collects the leaf's points in body->list. */
static gx_result gxp_leaf_points(gx_body *body, uint32_t leaf) {
    gxb_complex *cx = body->complex;
    uint32_t first, count = 0, i, j, e0, en;
    gx_result result = gxb_complex_open_element(cx, cx->leaves[leaf].element);
    body->list.count = 0;
    if (result == GX_OK) result = gxb_leaf_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        result = gxb_facet_edges(cx, cx->pool[first + i], &e0, &en);
        for (j = 0; j < en && result == GX_OK; j++) {
            const uint32_t e = cx->pool[e0 + j];
            result = gxp_push(body, &body->list, cx->edges[e >> 1].v[e & 1]);
        }
    }
    return result;
}

/* The winding number around a leaf: around one of its nodes that is off the surface, else around a point inside it. */
static gx_result gxp_ask_winding(gx_body *body, const gxp_surface *s, uint32_t leaf, int32_t *winding) {
    const gx_surface *g = s->given;
    uint32_t i;
    gx_result result = gxp_leaf_points(body, leaf);
    for (i = 0; i < body->list.count && result == GX_OK; i++) {
        int on_surface;
        if (body->list.data[i] >= body->node_count) continue;
        *winding = gxb_winding_number(g->vertices, g->triangles, g->triangle_count, body->positions + 3 * (size_t)body->list.data[i], &on_surface);
        if (!on_surface) return GX_OK;
    }
    if (result == GX_OK) *winding = gxb_complex_winding(body->complex, body->list.data, body->list.count, g->vertices, g->triangles, g->triangle_count);
    return result;
}

static int gxp_is_kept(const gx_body *body, uint32_t leaf) { return leaf != GXB_NONE && !body->complex->leaves[leaf].removed; }

static gx_result gxp_visit_winding(gx_body *body, uint32_t leaf, int32_t winding) {
    if (!gxp_is_kept(body, leaf) || body->leaves[leaf].stamp == body->stamp) return GX_OK;
    body->leaves[leaf].stamp = body->stamp;
    body->leaves[leaf].winding = winding;
    return gxp_push(body, &body->queue, leaf);
}

/* The neighbours of a leaf inside the solid know their winding numbers; of one outside, those across the solid's surface. What was removed before this cut was not divided by it and can't pass on anything. */
static gx_result gxp_spread_winding(gx_body *body, const gxp_surface *s, uint32_t leaf) {
    gxb_complex *cx = body->complex;
    const int32_t winding = body->leaves[leaf].winding;
    uint32_t first, count = 0, i;
    gx_result result = GX_OK;
    if (winding != 0) result = gxb_complex_open_element(cx, cx->leaves[leaf].element);
    if (result == GX_OK) result = gxb_leaf_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        const gxb_facet *f = &cx->facets[cx->pool[first + i]];
        const int front = f->leaf[0] == leaf;
        int labelled;
        const int32_t step = gxp_winding_step(body, s, cx->pool[first + i], &labelled);
        if (winding != 0 || labelled) result = gxp_visit_winding(body, f->leaf[front], winding + (front ? step : -step));
    }
    return result;
}

/* Works the queue off from where it stands. */
static gx_result gxp_flood_winding(gx_body *body, const gxp_surface *s, uint32_t *done) {
    gx_result result = GX_OK;
    while (*done < body->queue.count && result == GX_OK) result = gxp_spread_winding(body, s, body->queue.data[(*done)++]);
    return result;
}

/* Appends to seeds the leaves on both sides of the facets into which the labelled ones have been divided. */
static gx_result gxp_wall_leaves(gx_body *body, uint32_t facet, gxp_words *seeds) {
    const gxb_facet *f = &body->complex->facets[facet];
    gx_result result = GX_OK;
    if (f->child != GXB_NONE) {
        const uint32_t child = f->child;
        result = gxp_wall_leaves(body, child, seeds);
        return result == GX_OK ? gxp_wall_leaves(body, child + 1, seeds) : result;
    }
    if (f->leaf[0] != GXB_NONE) result = gxp_push(body, seeds, f->leaf[0]);
    if (f->leaf[1] != GXB_NONE && result == GX_OK) result = gxp_push(body, seeds, f->leaf[1]);
    return result;
}

/* Fragments (of before the cut) that the surface does not touch may lie in the solid as a whole: one leaf of each joins the seeds. */
static gx_result gxp_seed_untouched_fragments(gx_body *body) {
    gx_result result = gxp_update_view(body);
    uint32_t i;
    body->nodes.count = 0;
    if (result == GX_OK) result = gxp_words_room(body, &body->nodes, body->fragment_count);
    if (result != GX_OK) return result;
    if (body->fragment_count > 0) memset(body->nodes.data, 0, body->fragment_count * sizeof *body->nodes.data);
    for (i = 0; i < body->seeds.count; i++)
        if (gxp_is_kept(body, body->seeds.data[i])) body->nodes.data[gxp_cell_fragment(body, body->leaves[body->seeds.data[i]].cell)] = 1;
    for (i = 0; i < body->view_cells.count && result == GX_OK; i++) {
        if (body->nodes.data[body->view_fragments.data[i]]) continue;
        body->nodes.data[body->view_fragments.data[i]] = 1;
        result = gxp_push(body, &body->seeds, body->cells[body->view_cells.data[i]].first_leaf);
    }
    return result;
}

/* Finds the winding numbers of the seeds and of what they lead to: body->queue. */
static gx_result gxp_find_windings(gx_body *body, const gxp_surface *s) {
    uint32_t i, done = 0;
    gx_result result = GX_OK;
    body->queue.count = 0;
    body->stamp++;
    for (i = 0; i < body->seeds.count && result == GX_OK; i++) {
        const uint32_t leaf = body->seeds.data[i];
        int32_t winding = 0;
        if (!gxp_is_kept(body, leaf) || body->leaves[leaf].stamp == body->stamp) continue;
        result = gxp_ask_winding(body, s, leaf, &winding);
        if (result == GX_OK) result = gxp_visit_winding(body, leaf, winding);
        if (result == GX_OK) result = gxp_flood_winding(body, s, &done);
    }
    return result;
}

/* Appends to body->removed the leaves around which the solid winds. All surfaces of the cut are in the complex. */
static gx_result gxp_find_solid(gx_body *body, const gxp_surface *s, int scoped) {
    uint32_t i;
    gx_result result = GX_OK;
    body->seeds.count = 0;
    for (i = 0; i < body->complex->wall_count && result == GX_OK; i++) result = gxp_wall_leaves(body, body->complex->walls[i], &body->seeds);
    if (result == GX_OK) result = gxp_seed_untouched_fragments(body);
    if (result == GX_OK) result = gxp_find_windings(body, s);
    for (i = 0; i < body->queue.count && result == GX_OK; i++) {
        const uint32_t leaf = body->queue.data[i];
        if (body->leaves[leaf].winding != 0 && (!scoped || gxp_in_scope(body, leaf))) result = gxp_push(body, &body->removed, leaf);
    }
    return result;
}

/* --- exact sums for what doubles can't hold --- */

/* r += a b */
static void gxp_num_add_product(gxb_num *r, const gxb_num *a, const gxb_num *b) {
    GXB_NUM(p); GXB_NUM(s);
    gxb_num_mul(&p, a, b);
    gxb_num_add(&s, r, &p);
    r->sign = s.sign; r->exp = s.exp; r->n = s.n;
    memcpy(r->d, s.d, s.n * sizeof *s.d);
}

typedef struct gxp_fine_point { gxb_num c[4]; gxb_limb limbs[4][32]; } gxp_fine_point;

/* >>links: pieces of element faces that no wall covers ------------------------------------------------------------------------ */

/* Twice the area vector of the polygon of points in body->seeds, from their approximate positions; returns a bound for its error. */
static double gxp_rough_area(const gxb_complex *cx, const gxp_words *points, double area[3]) {
    const gxb_ball *o = &cx->points[points->data[0]].ball;
    double error = 0, a[3], b[3] = {0, 0, 0};
    uint32_t i;
    int k;
    area[0] = area[1] = area[2] = 0;
    for (i = 1; i < points->count; i++) {
        const gxb_ball *p = &cx->points[points->data[i]].ball;
        double size = 0;
        for (k = 0; k < 3; k++) { a[k] = b[k]; b[k] = p->x[k] - o->x[k]; size += fabs(a[k]) + fabs(b[k]); }
        for (k = 0; k < 3; k++) area[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        error += size * (size * 1e-15 + 4 * (p->error + o->error));
    }
    return error;
}

/* The polygon of the points in body->seeds as a share of the face opposite to node k, in numbers that hold any size: areas in the
   plane of two barycentric coordinates, where the face has 1. */
static double gxp_fine_share(gx_body *body, uint32_t element, uint32_t k) {
    gxp_fine_point p[3];
    unsigned axes[3];
    uint32_t i;
    int c;
    GXB_NUM(sum); GXB_NUM(one);
    gxi_part_axes(k, axes);
    gxb_num_set(&one, 1.0, 0);
    for (i = 0; i < 3; i++) for (c = 0; c < 4; c++) p[i].c[c].d = p[i].limbs[c];
    for (i = 0; i < body->seeds.count; i++) {
        gxp_fine_point *const a = &p[1 + i % 2], *const b = &p[1 + (i + 1) % 2];     /* a: this point, b: the one before */
        GXB_NUM(x); GXB_NUM(y); GXB_NUM(z); GXB_NUM(w); GXB_NUM(s); GXB_NUM(t); GXB_NUM(d);
        gxb_complex_barycentric_fine(body->complex, body->seeds.data[i], element, i == 0 ? p[0].c : a->c);
        if (i < 2) continue;
        gxb_num_sub(&x, &b->c[axes[1]], &p[0].c[axes[1]]); gxb_num_sub(&y, &b->c[axes[2]], &p[0].c[axes[2]]);
        gxb_num_sub(&z, &a->c[axes[1]], &p[0].c[axes[1]]); gxb_num_sub(&w, &a->c[axes[2]], &p[0].c[axes[2]]);
        gxb_num_mul(&s, &x, &w);
        gxb_num_mul(&t, &y, &z);
        gxb_num_sub(&d, &s, &t);
        gxp_num_add_product(&sum, &d, &one);
    }
    return fabs(gxb_num_to_double(&sum));
}

/* Collects the facet's corners in body->seeds. */
static gx_result gxp_facet_points(gx_body *body, uint32_t facet) {
    gxb_complex *cx = body->complex;
    uint32_t e0, en, i;
    gx_result result = gxb_facet_edges(cx, facet, &e0, &en);
    body->seeds.count = 0;
    for (i = 0; i < en && result == GX_OK; i++) result = gxp_push(body, &body->seeds, cx->edges[cx->pool[e0 + i] >> 1].v[cx->pool[e0 + i] & 1]);
    return result;
}

/* An element with the face, and the node of it that the face does not have. */
static uint32_t gxp_face_element(const gxb_complex *cx, uint32_t face, uint32_t *k) {
    const uint32_t element = cx->face_elements[2 * face] != GXB_NONE ? cx->face_elements[2 * face] : cx->face_elements[2 * face + 1];
    for (*k = 0; cx->element_faces[4 * element + *k] != face; ++*k) {}
    return element;
}

/* Area of a facet as a share of the mesh face that it is part of, roughly, with a bound for its error. */
static gx_result gxp_rough_share(gx_body *body, uint32_t facet, double *share, double *error) {
    uint32_t k, i;
    double part[3], whole[3], size;
    const uint32_t element = gxp_face_element(body->complex, body->complex->facets[facet].face, &k);
    gx_result result = GX_OK;
    body->seeds.count = 0;
    for (i = 0; i < 4 && result == GX_OK; i++) if (i != k) result = gxp_push(body, &body->seeds, body->complex->elements[4 * element + i]);
    if (result != GX_OK) return result;
    *error = gxp_rough_area(body->complex, &body->seeds, whole);
    size = sqrt(whole[0] * whole[0] + whole[1] * whole[1] + whole[2] * whole[2]);
    result = gxp_facet_points(body, facet);
    if (result != GX_OK) return result;
    *error += gxp_rough_area(body->complex, &body->seeds, part);
    *share = sqrt(part[0] * part[0] + part[1] * part[1] + part[2] * part[2]);
    if (!(*error < 0.5 * size) || !(*share < 8 * size)) { *share = 0; *error = 1; return GX_OK; }    /* nothing is known */
    *share /= size;
    *error = 4 * *error / size;
    return GX_OK;
}

/* Appends the facets into which this one has been divided. */
static gx_result gxp_push_pieces(gx_body *body, uint32_t facet, gxp_words *out) {
    const uint32_t child = body->complex->facets[facet].child;
    gx_result result;
    if (child == GXB_NONE) return gxp_push(body, out, facet);
    result = gxp_push_pieces(body, child, out);
    return result == GX_OK ? gxp_push_pieces(body, child + 1, out) : result;
}

/* Is the facet a link? */
static int gxp_is_link(const gx_body *body, uint32_t facet) {
    const gxb_facet *f = &body->complex->facets[facet];
    return !f->wall && gxp_is_kept(body, f->leaf[0]) && gxp_is_kept(body, f->leaf[1]);
}

/* Do both facets of a face belong to the link between the same two cells? */
static int gxp_same_link(const gx_body *body, uint32_t a, uint32_t b) {
    const gxb_facet *f = &body->complex->facets[a], *g = &body->complex->facets[b];
    return gxp_is_link(body, a) && gxp_is_link(body, b) && body->leaves[f->leaf[0]].cell == body->leaves[g->leaf[0]].cell &&
           body->leaves[f->leaf[1]].cell == body->leaves[g->leaf[1]].cell;
}

/* Share of the link that starts with facet first of body->list: roughly where it is certainly neither the smallest so far nor to be
   severed, else exactly. */
static gx_result gxp_weigh_link(gxp_cut *cut, uint32_t first, double *share) {
    gx_body *body = cut->body;
    double part = 0, error = 0, errors = 0;
    uint32_t i, k, element;
    gx_result result = GX_OK;
    *share = 0;
    for (i = first; i < body->list.count && result == GX_OK; i++) {
        if (!gxp_same_link(body, body->list.data[first], body->list.data[i])) continue;
        result = gxp_rough_share(body, body->list.data[i], &part, &error);
        *share += part;
        errors += error;
    }
    if (result != GX_OK || (*share - errors > cut->report.min_link_ratio && *share - errors > cut->desc->sever_below)) return result;
    element = gxp_face_element(body->complex, body->complex->facets[body->list.data[first]].face, &k);
    result = gxb_complex_open_element(body->complex, element);
    *share = 0;
    for (i = first; i < body->list.count && result == GX_OK; i++) {
        if (!gxp_same_link(body, body->list.data[first], body->list.data[i])) continue;
        result = gxp_facet_points(body, body->list.data[i]);
        if (result == GX_OK) *share += gxp_fine_share(body, element, k);
    }
    return result;
}

/* Shares of one face's links; links below the ratio are severed. All pieces between the same two cells count as one link. */
static gx_result gxp_weigh_links(gxp_cut *cut, uint32_t face) {
    gx_body *body = cut->body;
    uint32_t i, j;
    gx_result result;
    body->list.count = 0;
    result = gxp_push_pieces(body, body->complex->face_facet[face], &body->list);
    for (i = 0; i < body->list.count && result == GX_OK; i++) {
        const uint32_t facet = body->list.data[i];
        double share;
        if (!gxp_is_link(body, facet)) continue;
        for (j = 0; j < i && !gxp_same_link(body, body->list.data[j], facet); j++) {}
        if (j < i) continue;
        result = gxp_weigh_link(cut, i, &share);
        if (result != GX_OK) break;
        if (share < cut->report.min_link_ratio) cut->report.min_link_ratio = share;
        if (share >= cut->desc->sever_below) continue;
        cut->report.severed_links++;
        for (j = body->list.count; j-- > i && result == GX_OK;)
            if (gxp_same_link(body, facet, body->list.data[j])) result = gxb_complex_set_wall(body->complex, body->list.data[j]);
    }
    return result;
}

/* The links of all faces that this cut has divided. Only whole faces left alone by it are not looked at. */
static gx_result gxp_weigh_all_links(gxp_cut *cut, uint32_t first_facet) {
    gx_body *body = cut->body;
    uint32_t i;
    gx_result result = GX_OK;
    body->faces.count = 0;
    for (i = first_facet; i < body->complex->facet_count && result == GX_OK; i++) {
        const gxb_facet *f = &body->complex->facets[i];
        if (f->face != GXB_NONE && f->leaf[0] != GXB_NONE && f->leaf[1] != GXB_NONE && body->complex->face_facet[f->face] != i)
            result = gxp_push(body, &body->faces, f->face);
    }
    gxp_sort_unique(&body->faces);
    for (i = 0; i < body->faces.count && result == GX_OK; i++) result = gxp_weigh_links(cut, body->faces.data[i]);
    return result;
}

/* >>cells: the touched ones fall apart ---------------------------------------------------------------------------------------- */

/* Collects the cells on both sides of walls that this cut made. */
static gx_result gxp_collect_touched(gxp_cut *cut) {
    gx_body *body = cut->body;
    uint32_t i;
    gx_result result = GX_OK;
    body->seeds.count = 0;
    for (i = 0; i < body->complex->wall_count && result == GX_OK; i++)
        if (body->complex->facets[body->complex->walls[i]].wall) result = gxp_wall_leaves(body, body->complex->walls[i], &body->seeds);
    for (i = 0; i < body->seeds.count && result == GX_OK; i++)
        if (!body->complex->leaves[body->seeds.data[i]].removed) result = gxp_push(body, &body->touched, body->leaves[body->seeds.data[i]].cell);
    gxp_sort_unique(&body->touched);
    return result;
}

/* New leaves join the list of the cell from which they were split. */
static gx_result gxp_list_new_leaves(gxp_cut *cut) {
    gx_body *body = cut->body;
    uint32_t leaf;
    gx_result result = GX_OK;
    for (leaf = cut->before.leaves; leaf < body->leaf_count && result == GX_OK; leaf++) {
        const uint32_t parent = body->complex->leaves[leaf].parent, next = body->leaves[parent].next;
        body->leaves[leaf].next = next;         /* new leaves need no undo */
        result = gxp_set_leaf(body, parent, body->leaves[parent].cell, leaf);
    }
    return result;
}

static gx_result gxp_new_cell(gx_body *body, uint32_t like, uint32_t *slot) {
    gx_result result = gxp_reserve_cells(body, 1);
    if (result == GX_OK) result = gxp_save_cell(body, like);
    if (result != GX_OK) return result;
    *slot = body->cell_count++;
    body->cells[*slot] = body->cells[like];
    body->cells[like].next = *slot;
    body->cells[*slot].first_leaf = GXP_NONE;
    body->cell_stamp[*slot] = 0;
    return GX_OK;
}

/* Walks the leaves that open facets inside the element join to the first in the queue. */
static gx_result gxp_walk_leaves(gx_body *body, uint32_t start) {
    gxb_complex *cx = body->complex;
    uint32_t done = 0, first, count, i;
    gx_result result;
    body->queue.count = 0;
    body->leaves[start].stamp = body->stamp;
    result = gxp_push(body, &body->queue, start);
    while (done < body->queue.count && result == GX_OK) {
        const uint32_t leaf = body->queue.data[done++];
        result = gxb_leaf_facets(cx, leaf, &first, &count);
        for (i = 0; i < count && result == GX_OK; i++) {
            const uint32_t facet = cx->pool[first + i];
            const gxb_facet *f = &cx->facets[facet];
            const uint32_t other = f->leaf[f->leaf[0] == leaf];
            if (f->face != GXB_NONE || !gxp_is_link(body, facet) || body->leaves[other].stamp == body->stamp) continue;
            body->leaves[other].stamp = body->stamp;
            result = gxp_push(body, &body->queue, other);
        }
    }
    return result;
}

/* Gives the leaves in the queue to a cell, as its list. */
static gx_result gxp_give_leaves(gx_body *body, uint32_t cell) {
    uint32_t i;
    gx_result result = gxp_save_cell(body, cell);
    for (i = body->queue.count; i-- > 0 && result == GX_OK;)
        result = gxp_set_leaf(body, body->queue.data[i], cell, i + 1 < body->queue.count ? body->queue.data[i + 1] : GXP_NONE);
    body->cells[cell].first_leaf = body->queue.data[0];
    return result;
}

/* Divides one touched cell into its connected pieces; the first keeps the slot. */
static gx_result gxp_divide_cell(gxp_cut *cut, uint32_t cell) {
    gx_body *body = cut->body;
    uint32_t leaf, pieces = 0, i;
    gx_result result = GX_OK;
    body->seeds.count = 0;
    for (leaf = body->cells[cell].first_leaf; leaf != GXP_NONE && result == GX_OK; leaf = body->leaves[leaf].next)
        result = gxp_push(body, &body->seeds, leaf);
    body->stamp++;
    for (i = 0; i < body->seeds.count && result == GX_OK; i++) {
        uint32_t slot = cell;
        leaf = body->seeds.data[i];
        if (body->complex->leaves[leaf].removed || body->leaves[leaf].stamp == body->stamp) continue;
        result = gxp_walk_leaves(body, leaf);
        if (result == GX_OK && pieces++ > 0) {
            result = gxp_new_cell(body, cell, &slot);
            cut->report.created_cells++;
        }
        if (result == GX_OK) result = gxp_give_leaves(body, slot);
        if (result == GX_OK) result = gxp_push(body, &body->fresh, slot);
    }
    if (result == GX_OK && pieces == 0) {
        result = gxp_save_cell(body, cell);
        body->cells[cell].kept = 0;
        body->cells[cell].first_leaf = GXP_NONE;
        cut->report.removed_cells++;
    }
    return result;
}

/* Cells beside a removed leaf lost links. */
static gx_result gxp_touch_around(gx_body *body, uint32_t leaf) {
    gxb_complex *cx = body->complex;
    uint32_t first, count, i;
    gx_result result = gxb_leaf_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        const gxb_facet *f = &cx->facets[cx->pool[first + i]];
        const uint32_t other = f->leaf[f->leaf[0] == leaf];
        if (gxp_is_kept(body, other)) result = gxp_push(body, &body->touched, body->leaves[other].cell);
    }
    return result;
}

/* Severed links separate cells that may not have been touched before. */
static gx_result gxp_touch_severed(gxp_cut *cut) {
    gx_body *body = cut->body;
    gx_result result;
    uint32_t i, known = body->fresh.count;
    result = gxp_collect_touched(cut);
    for (i = 0; i < known; i++) body->cell_stamp[body->fresh.data[i]] = body->stamp + 1;
    body->stamp++;
    for (i = 0; i < body->touched.count && result == GX_OK; i++) {
        const uint32_t cell = body->touched.data[i];
        if (body->cells[cell].kept && body->cell_stamp[cell] != body->stamp) result = gxp_push(body, &body->fresh, cell);
    }
    return result;
}

/* Divides all touched cells. Leaves body->touched as it was and appends the pieces to body->fresh. */
static gx_result gxp_divide_cells(gxp_cut *cut) {
    gx_body *body = cut->body;
    uint32_t i, last = GXP_NONE;
    gx_result result = GX_OK;
    body->fresh.count = 0;
    for (i = 0; i < body->touched.count && result == GX_OK; i++) {
        const uint32_t element = body->cells[body->touched.data[i]].element;
        cut->report.touched_elements += element != last;
        last = element;
        result = gxp_divide_cell(cut, body->touched.data[i]);
    }
    return result;
}

/* >>components: nodal subdomains, and the copies that move them ---------------------------------------------------------------- */

static gx_result gxp_visit_cell(gx_body *body, uint32_t cell) {
    if (body->cell_stamp[cell] == body->stamp) return GX_OK;
    body->cell_stamp[cell] = body->stamp;
    return gxp_push(body, &body->queue, cell);
}

/* Visits what lies across one piece of an element's face. */
static gx_result gxp_cross_facet(gx_body *body, uint32_t facet, uint32_t leaf) {
    const gxb_facet *f = &body->complex->facets[facet];
    return gxp_is_link(body, facet) ? gxp_visit_cell(body, body->leaves[f->leaf[f->leaf[0] == leaf]].cell) : GX_OK;
}

/* Visits the cells that links join to the cell of a whole element across the face opposite to local node k. */
static gx_result gxp_cross_whole_face(gx_body *body, uint32_t element, uint32_t k) {
    gxb_complex *cx = body->complex;
    const uint32_t face = cx->element_faces[4 * element + k], other = gxp_neighbour(body, element, k);
    uint32_t i;
    gx_result result;
    if (other == GXP_NONE) return GX_OK;
    if (cx->face_facet[face] == GXB_NONE) return gxp_is_kept(body, other) ? gxp_visit_cell(body, body->leaves[other].cell) : GX_OK;
    body->list.count = 0;
    result = gxp_push_pieces(body, cx->face_facet[face], &body->list);
    for (i = 0; i < body->list.count && result == GX_OK; i++) result = gxp_cross_facet(body, body->list.data[i], element);
    return result;
}

/* Visits the cells around the node that links join to this one. */
static gx_result gxp_cross_faces(gx_body *body, uint32_t cell, uint32_t node) {
    gxb_complex *cx = body->complex;
    const uint32_t element = body->cells[cell].element;
    const uint32_t local = (uint32_t)gxp_local_node(body, element, node), opposite = cx->element_faces[4 * element + local];
    uint32_t leaf, first, count, i, k;
    gx_result result = GX_OK;
    for (leaf = body->cells[cell].first_leaf; leaf != GXP_NONE && result == GX_OK; leaf = body->leaves[leaf].next) {
        if (cx->leaves[leaf].facet_count == 0) {
            for (k = 0; k < 4 && result == GX_OK; k++) if (k != local) result = gxp_cross_whole_face(body, element, k);
            continue;
        }
        result = gxb_leaf_facets(cx, leaf, &first, &count);
        for (i = 0; i < count && result == GX_OK; i++) {
            const uint32_t facet = cx->pool[first + i], face = cx->facets[facet].face;
            if (face != GXB_NONE && face != opposite) result = gxp_cross_facet(body, facet, leaf);
        }
    }
    return result;
}

/* --- pinched nodes and edges: an edge piece or node that no wall touches joins the cells around it --- */

typedef struct gxp_joint { uint32_t point, edge; int found, walled; } gxp_joint;    /* a point, or an edge of the complex */

/* Does the leaf have the joint on its boundary, and does a wall touch it there? */
static gx_result gxp_look_for_joint(gx_body *body, uint32_t leaf, gxp_joint *joint) {
    gxb_complex *cx = body->complex;
    uint32_t first, count = 0, i, j, e0, en;
    gx_result result = gxb_complex_open_element(cx, cx->leaves[leaf].element);
    if (result == GX_OK) result = gxb_leaf_facets(cx, leaf, &first, &count);
    joint->found = 0;
    for (i = 0; i < count && result == GX_OK; i++) {
        const uint32_t facet = cx->pool[first + i];
        result = gxb_facet_edges(cx, facet, &e0, &en);
        for (j = 0; j < en && result == GX_OK; j++) {
            const uint32_t e = cx->pool[e0 + j];
            if (joint->point != GXB_NONE ? cx->edges[e >> 1].v[e & 1] != joint->point : e >> 1 != joint->edge) continue;
            joint->found = 1;
            joint->walled |= cx->facets[facet].wall != 0 || cx->leaves[leaf].removed != 0 ||
                             (joint->point != GXB_NONE ? cx->points[joint->point].wall : cx->edges[joint->edge].wall) != 0;
        }
    }
    return result;
}

/* Appends the leaves below a reference of an element's tree. */
static gx_result gxp_push_leaves(gx_body *body, uint32_t reference, gxp_words *out) {
    const gxb_node *node = &body->complex->nodes[reference >> 1];
    gx_result result;
    if (!(reference & 1)) return gxp_push(body, out, reference >> 1);
    result = gxp_push_leaves(body, node->child[0], out);
    return result == GX_OK ? gxp_push_leaves(body, node->child[1], out) : result;
}

/* Appends to found the cells around the node that have the joint on their boundary. Removed leaves count as walls. */
static gx_result gxp_find_joint(gx_body *body, uint32_t node, gxp_joint *joint, gxp_words *found) {
    uint32_t j, i;
    gx_result result = GX_OK;
    joint->walled = 0;
    body->triangles.count = 0;
    for (j = body->node_start[node]; j < body->node_start[node + 1] && result == GX_OK; j++)
        result = gxp_push_leaves(body, body->complex->root[body->node_elements[j]], &body->triangles);
    for (i = 0; i < body->triangles.count && result == GX_OK; i++) {
        const uint32_t leaf = body->triangles.data[i];
        result = gxp_look_for_joint(body, leaf, joint);
        if (joint->found && !body->complex->leaves[leaf].removed && result == GX_OK) result = gxp_push(body, found, body->leaves[leaf].cell);
    }
    return result;
}

/* Visits the cells that the joint joins to this cell. */
static gx_result gxp_cross_joint(gx_body *body, uint32_t cell, uint32_t node, uint32_t point, uint32_t edge) {
    gxp_joint joint;
    uint32_t i, member = 0;
    gx_result result;
    joint.point = point; joint.edge = edge; joint.walled = joint.found = 0;
    body->list.count = 0;
    result = gxp_find_joint(body, node, &joint, &body->list);
    for (i = 0; i < body->list.count; i++) member |= body->list.data[i] == cell;
    for (i = 0; i < body->list.count && result == GX_OK && member && !joint.walled; i++) result = gxp_visit_cell(body, body->list.data[i]);
    return result;
}

static gx_result gxp_push_edge_pieces(gx_body *body, uint32_t edge, gxp_words *out) {
    const uint32_t child = body->complex->edges[edge].child;
    gx_result result;
    if (child == GXB_NONE) return gxp_push(body, out, edge);
    result = gxp_push_edge_pieces(body, child, out);
    return result == GX_OK ? gxp_push_edge_pieces(body, child + 1, out) : result;
}

static gx_result gxp_cross_pinches(gx_body *body, uint32_t cell, uint32_t node) {
    const uint32_t element = body->cells[cell].element;
    gxb_complex *cx = body->complex;
    uint32_t k, i;
    gx_result result = gxb_complex_open_element(cx, element);
    if (result == GX_OK && (body->node_pinched[node] & 1)) result = gxp_cross_joint(body, cell, node, node, GXB_NONE);
    for (k = 0; k < 6 && result == GX_OK; k++) {
        const uint32_t edge = cx->element_edges[6 * element + k];
        const uint32_t a = cx->elements[4 * element + gxp_edge_nodes[k][0]], b = cx->elements[4 * element + gxp_edge_nodes[k][1]];
        if (!body->edge_pinched[edge] || (a != node && b != node)) continue;
        body->faces.count = 0;
        result = gxp_push_edge_pieces(body, cx->mesh_edge[edge], &body->faces);
        for (i = 0; i < body->faces.count && result == GX_OK; i++) result = gxp_cross_joint(body, cell, node, GXB_NONE, body->faces.data[i]);
    }
    return result;
}

/* The nodal component that contains the cell: body->queue, every cell stamped. */
static gx_result gxp_walk_component(gx_body *body, uint32_t cell, uint32_t node) {
    uint32_t done = 0;
    gx_result result;
    body->queue.count = 0;
    result = gxp_visit_cell(body, cell);
    while (done < body->queue.count && result == GX_OK) {
        const uint32_t c = body->queue.data[done++];
        result = gxp_cross_faces(body, c, node);
        if (result == GX_OK && body->node_pinched[node]) result = gxp_cross_pinches(body, c, node);
    }
    return result;
}

/* A further copy of a node's displacement, with the values of the one it comes from (GXFEM Algorithm 1, line 7). */
static gx_result gxp_new_copy(gx_body *body, uint32_t from, uint32_t *copy) {
    const gx_result result = gxp_reserve_copies(body, 1);
    if (result != GX_OK) return result;
    *copy = body->copy_count++;
    body->copy_node[*copy] = body->copy_node[from];
    gxp_copy_state(body, from, *copy);
    return GX_OK;
}

static gx_result gxp_set_copy(gx_body *body, uint32_t node, uint32_t copy) {
    uint32_t i;
    gx_result result = GX_OK;
    for (i = 0; i < body->queue.count && result == GX_OK; i++) {
        const uint32_t cell = body->queue.data[i];
        result = gxp_save_cell(body, cell);
        body->cells[cell].copies[gxp_local_node(body, body->cells[cell].element, node)] = copy;
    }
    return result;
}

static int gxp_compare_pairs(const void *a, const void *b) {
    const gxp_pair *p = (const gxp_pair *)a, *q = (const gxp_pair *)b;
    if (p->node != q->node) return p->node < q->node ? -1 : 1;
    return p->cell < q->cell ? -1 : p->cell > q->cell;
}

static gx_result gxp_push_pair(gx_body *body, uint32_t node, uint32_t cell) {
    const gx_result result = gxp_reserve(&body->allocator, &body->pairs, sizeof *body->pairs, body->pair_count, &body->pair_capacity, 1);
    if (result != GX_OK) return result;
    body->pairs[body->pair_count].node = node;
    body->pairs[body->pair_count++].cell = cell;
    return GX_OK;
}

static gx_result gxp_pair_cell(gx_body *body, uint32_t cell) {
    uint32_t k;
    gx_result result = GX_OK;
    for (k = 0; k < 4 && result == GX_OK; k++)
        result = gxp_push_pair(body, body->complex->elements[4 * body->cells[cell].element + k], cell);
    return result;
}

/* Every cell around a node. */
static gx_result gxp_pair_node(gx_body *body, uint32_t node) {
    uint32_t j, cell;
    gx_result result = GX_OK;
    for (j = body->node_start[node]; j < body->node_start[node + 1]; j++)
        for (cell = body->node_elements[j]; cell != GXP_NONE && result == GX_OK; cell = body->cells[cell].next)
            if (body->cells[cell].kept) result = gxp_push_pair(body, node, cell);
    return result;
}

/* Where to start walks: each touched cell around its nodes; around pinched nodes, where walls break joints that they only touch
   in a point, every cell. */
static gx_result gxp_collect_pairs(gx_body *body) {
    uint32_t i, n;
    gx_result result = GX_OK;
    body->pair_count = 0;
    for (i = 0; i < body->fresh.count && result == GX_OK; i++) result = gxp_pair_cell(body, body->fresh.data[i]);
    for (i = 0; i < body->touched.count && result == GX_OK; i++)
        if (!body->cells[body->touched.data[i]].kept) result = gxp_pair_cell(body, body->touched.data[i]);
    for (i = 0, n = body->pair_count; i < n && result == GX_OK; i++)
        if (body->node_pinched[body->pairs[i].node]) result = gxp_push(body, &body->pinches, body->pairs[i].node);
    gxp_sort_unique(&body->pinches);
    for (i = 0; i < body->pinches.count && result == GX_OK; i++) result = gxp_pair_node(body, body->pinches.data[i]);
    if (body->pair_count > 0) qsort(body->pairs, body->pair_count, sizeof *body->pairs, gxp_compare_pairs);
    return result;
}

static int gxp_contains(const gxp_words *words, uint32_t value) {
    uint32_t i;
    for (i = 0; i < words->count; i++) if (words->data[i] == value) return 1;
    return 0;
}

/* Around one node (pairs first ... end-1): the pieces of each old component get copies of their own, the first piece keeps the old
   one. Every piece of a component that fell apart contains a cell of a pair. Old copies that lost all cells join body->dead. */
static gx_result gxp_divide_node(gxp_cut *cut, uint32_t first, uint32_t end) {
    gx_body *body = cut->body;
    const uint32_t node = body->pairs[first].node;
    uint32_t i;
    gx_result result = GX_OK;
    body->seeds.count = 0;              /* old copies that a piece has kept */
    body->stamp++;
    for (i = first; i < end && result == GX_OK; i++) {
        const uint32_t cell = body->pairs[i].cell;
        const int k = gxp_local_node(body, body->cells[cell].element, node);
        const uint32_t old = body->cells[cell].copies[k];
        uint32_t copy;
        if (!body->cells[cell].kept || body->cell_stamp[cell] == body->stamp) continue;
        result = gxp_walk_component(body, cell, node);
        if (result == GX_OK && !gxp_contains(&body->seeds, old)) result = gxp_push(body, &body->seeds, old);
        else if (result == GX_OK) {
            result = gxp_new_copy(body, old, &copy);
            if (result == GX_OK) result = gxp_set_copy(body, node, copy);
            cut->report.created_copies++;
        }
    }
    for (i = first; i < end && result == GX_OK; i++) {
        const gxp_cell *cell = &body->cells[body->pairs[i].cell];
        const uint32_t old = cell->copies[gxp_local_node(body, cell->element, node)];
        if (!cell->kept && !gxp_contains(&body->seeds, old) && !gxp_contains(&body->dead, old)) result = gxp_push(body, &body->dead, old);
    }
    return result;
}

static gx_result gxp_divide_nodes(gxp_cut *cut) {
    gx_body *body = cut->body;
    uint32_t first, end;
    gx_result result = gxp_collect_pairs(body);
    body->dead.count = 0;
    for (first = 0; first < body->pair_count && result == GX_OK; first = end) {
        for (end = first; end < body->pair_count && body->pairs[end].node == body->pairs[first].node; end++) {}
        result = gxp_divide_node(cut, first, end);
    }
    return result;
}

/* >>integrals: volume and mass of a part, by its boundary triangles in barycentric coordinates ------------------------------------ */

/* The part's points and triangles: body->list has the points, body->lambdas 4 numbers for each, body->triangles the indices. */
static void gxp_clear_boundary(gx_body *body) { body->list.count = body->triangles.count = 0; }

static gx_result gxp_add_boundary_point(gx_body *body, uint32_t element, uint32_t point, uint32_t *index) {
    const uint32_t slot = point < body->point_slot.count ? body->point_slot.data[point] : GXP_NONE;
    gx_result result = GX_OK;
    if (slot < body->list.count && body->list.data[slot] == point) { *index = slot; return GX_OK; }
    if (point >= body->point_slot.count) {
        result = gxp_words_room(body, &body->point_slot, body->complex->point_count - body->point_slot.count);
        if (result != GX_OK) return result;
        memset(body->point_slot.data + body->point_slot.count, 0xff, (body->complex->point_count - body->point_slot.count) * sizeof(uint32_t));
        body->point_slot.count = body->complex->point_count;
    }
    result = gxp_reserve(&body->allocator, &body->lambdas, 4 * sizeof(double), body->list.count, &body->lambda_capacity, 1);
    *index = body->list.count;
    if (result == GX_OK) result = gxp_push(body, &body->list, point);
    if (result != GX_OK) return result;
    body->point_slot.data[point] = *index;
    gxb_complex_barycentric(body->complex, point, element, body->lambdas + 4 * (size_t)*index);
    return GX_OK;
}

/* Adds a facet as a fan of triangles, outward from the leaf. */
static gx_result gxp_add_boundary_facet(gx_body *body, uint32_t element, uint32_t facet, uint32_t leaf) {
    gxb_complex *cx = body->complex;
    const int inward = cx->facets[facet].leaf[0] == leaf;
    uint32_t e0, en, i, corner[3] = {0, 0, 0};
    gx_result result = gxb_facet_edges(cx, facet, &e0, &en);
    for (i = 0; i < en && result == GX_OK; i++) {
        const uint32_t e = cx->pool[e0 + i];
        result = gxp_add_boundary_point(body, element, cx->edges[e >> 1].v[e & 1], &corner[i < 2 ? i : 2]);
        if (i < 2 || result != GX_OK) continue;
        result = gxp_push(body, &body->triangles, corner[0]);
        if (result == GX_OK) result = gxp_push(body, &body->triangles, corner[inward ? 2 : 1]);
        if (result == GX_OK) result = gxp_push(body, &body->triangles, corner[inward ? 1 : 2]);
        corner[1] = corner[2];
    }
    return result;
}

/* Adds the leaf's facets; inner ones, with the same cell on both sides, cancel and are left out unless all is set. */
static gx_result gxp_add_boundary_leaf(gx_body *body, uint32_t leaf, int all) {
    gxb_complex *cx = body->complex;
    uint32_t first, count, i;
    gx_result result = gxb_leaf_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        const gxb_facet *f = &cx->facets[cx->pool[first + i]];
        const uint32_t other = f->leaf[f->leaf[0] == leaf];
        if (!all && f->face == GXB_NONE && gxp_is_kept(body, other) && body->leaves[other].cell == body->leaves[leaf].cell) continue;
        result = gxp_add_boundary_facet(body, cx->leaves[leaf].element, cx->pool[first + i], leaf);
    }
    return result;
}

/* --- parts so small that doubles can't hold their moments: the same sums in exact numbers --- */

typedef struct gxp_fine_sums { gxb_num c[10]; gxb_limb limbs[10][GXB_NUM_LIMBS]; } gxp_fine_sums;
/* det(a, b, c) */
static void gxp_fine_determinant(gxb_num *det, gxb_num *p[3][3]) {
    static const int cyclic[3][2] = {{1, 2}, {2, 0}, {0, 1}};
    int k;
    det->sign = det->exp = 0; det->n = 0;
    for (k = 0; k < 3; k++) {
        GXB_NUM(s); GXB_NUM(t); GXB_NUM(u);
        gxb_num_mul(&s, p[1][cyclic[k][0]], p[2][cyclic[k][1]]);
        gxb_num_mul(&t, p[1][cyclic[k][1]], p[2][cyclic[k][0]]);
        gxb_num_sub(&u, &s, &t);
        gxp_num_add_product(det, p[0][k], &u);
    }
}

/* Adds the cone of a triangle to the origin: with D = det(a,b,c), s = a+b+c: D, D s_i, D (s_i s_j + a_i a_j + b_i b_j + c_i c_j) */
static void gxp_fine_add(gxp_fine_sums *sums, gxb_num *p[3][3]) {
    gxb_limb limbs[3][GXB_NUM_LIMBS];
    gxb_num s[3];
    int i, j, k, slot = 4;
    GXB_NUM(det); GXB_NUM(one);
    gxp_fine_determinant(&det, p);
    gxb_num_set(&one, 1.0, 0);
    gxp_num_add_product(&sums->c[0], &det, &one);
    for (i = 0; i < 3; i++) {
        s[i].sign = s[i].exp = 0; s[i].n = 0; s[i].d = limbs[i];
        for (k = 0; k < 3; k++) gxp_num_add_product(&s[i], p[k][i], &one);
        gxp_num_add_product(&sums->c[1 + i], &det, &s[i]);
    }
    for (i = 0; i < 3; i++) for (j = i; j < 3; j++, slot++) {
        GXB_NUM(q);
        for (k = 0; k < 3; k++) gxp_num_add_product(&q, p[k][i], p[k][j]);
        gxp_num_add_product(&q, &s[i], &s[j]);
        gxp_num_add_product(&sums->c[slot], &det, &q);
    }
}

/* Moments of the collected boundary in the frame with origin k, from coordinates with 180 bits. */
static gx_result gxp_fine_moments(gx_body *body, uint32_t element, unsigned k, gxi_moments2 *m) {
    const size_t size = body->list.count * sizeof(gxp_fine_point);
    gxp_fine_point *points = (gxp_fine_point *)gxp_allocate(&body->allocator, size);
    gxp_fine_sums sums;
    unsigned axes[3];
    uint32_t i, t;
    int a, c;
    if (points == NULL) return GX_ERROR_MEMORY;
    for (i = 0; i < 10; i++) { sums.c[i].sign = sums.c[i].exp = 0; sums.c[i].n = 0; sums.c[i].d = sums.limbs[i]; }
    for (i = 0; i < body->list.count; i++) {
        for (a = 0; a < 4; a++) points[i].c[a].d = points[i].limbs[a];
        gxb_complex_barycentric_fine(body->complex, body->list.data[i], element, points[i].c);
    }
    gxi_part_axes(k, axes);
    for (t = 0; t + 2 < body->triangles.count; t += 3) {
        gxb_num *p[3][3];
        for (a = 0; a < 3; a++) for (c = 0; c < 3; c++) p[a][c] = &points[body->triangles.data[t + (uint32_t)a]].c[axes[c]];
        gxp_fine_add(&sums, p);
    }
    m->volume = gxb_num_to_double(&sums.c[0]) / 6;
    for (a = 0; a < 3; a++) m->first[a] = gxb_num_to_double(&sums.c[1 + a]) / 24;
    for (a = 0; a < 6; a++) m->second[a] = gxb_num_to_double(&sums.c[4 + a]) / 120;
    gxp_release(&body->allocator, points, size);
    return GX_OK;
}

#define GXP_CANCELLATION 1e-3   /* moments whose terms cancel to less than this share are summed in exact numbers: doubles lose 3 digits there */

/* Sum of |volume| over the cones from vertex k to the collected triangles: how large the terms are that make up the volume. */
static double gxp_cone_volumes(const gx_body *body, unsigned k) {
    unsigned axes[3];
    double sum = 0;
    uint32_t t;
    gxi_part_axes(k, axes);
    for (t = 0; t + 2 < body->triangles.count; t += 3) {
        const double *a = body->lambdas + 4 * (size_t)body->triangles.data[t], *b = body->lambdas + 4 * (size_t)body->triangles.data[t + 1];
        const double *c = body->lambdas + 4 * (size_t)body->triangles.data[t + 2];
        const unsigned x = axes[0], y = axes[1], z = axes[2];
        sum += fabs(a[x] * b[y] * c[z]) + fabs(a[x] * b[z] * c[y]) + fabs(a[y] * b[z] * c[x]) + fabs(a[y] * b[x] * c[z]) +
               fabs(a[z] * b[x] * c[y]) + fabs(a[z] * b[y] * c[x]);
    }
    return sum / 6;
}

/* Moments of the collected boundary; *k: the vertex of the element that is their frame's origin. */
static gx_result gxp_boundary_moments(gx_body *body, uint32_t element, unsigned *k, gxi_moments2 *m) {
    gx_result result = gxi_part_moments(body->lambdas, body->list.count, body->triangles.data, body->triangles.count / 3, k, m);
    if (result == GX_OK && m->volume < GXP_CANCELLATION * gxp_cone_volumes(body, *k)) result = gxp_fine_moments(body, element, *k, m);
    return result;
}

static gx_result gxp_integrate_cell(gx_body *body, uint32_t cell) {
    const uint32_t element = body->cells[cell].element;
    const double volume = gxp_element_volume(body, element);
    gxi_moments2 m;
    unsigned k;
    uint32_t leaf;
    gx_result result = gxb_complex_open_element(body->complex, element);
    gxp_clear_boundary(body);
    for (leaf = body->cells[cell].first_leaf; leaf != GXP_NONE && result == GX_OK; leaf = body->leaves[leaf].next)
        result = gxp_add_boundary_leaf(body, leaf, 0);
    if (result == GX_OK) result = gxp_boundary_moments(body, element, &k, &m);
    if (result == GX_OK) result = gxp_save_cell(body, cell);
    if (result != GX_OK) return result;
    body->cells[cell].volume = 6 * volume * m.volume;
    gxi_part_mass(&m, k, volume, gxp_density(body, body->cells[cell].element), body->cells[cell].mass);
    return GX_OK;
}

/* Volume of what the cut removed, leaf by leaf, so that a thin slab keeps its digits. */
static gx_result gxp_integrate_removed(gxp_cut *cut, const gxp_words *removed) {
    gx_body *body = cut->body;
    gx_result result = GX_OK;
    uint32_t i;
    for (i = 0; i < removed->count && result == GX_OK; i++) {
        const uint32_t leaf = removed->data[i], element = body->complex->leaves[leaf].element;
        gxi_moments2 m;
        unsigned k;
        gxp_clear_boundary(body);
        result = gxp_add_boundary_leaf(body, leaf, 1);
        if (result == GX_OK) result = gxp_boundary_moments(body, element, &k, &m);
        if (result == GX_OK) cut->report.removed_volume += 6 * m.volume * gxp_element_volume(body, element);
    }
    return result;
}

/* >>commit ------------------------------------------------------------------------------------------------------------------ */

/* Puts the last copy in the place of a dead one. */
static void gxp_drop_copy(gx_body *body, uint32_t copy) {
    const uint32_t last = --body->copy_count, node = body->copy_node[last];
    uint32_t j, cell;
    if (copy == last) return;
    for (j = body->node_start[node]; j < body->node_start[node + 1]; j++) {
        const uint32_t element = body->node_elements[j];
        const int k = gxp_local_node(body, element, node);
        for (cell = element; cell != GXP_NONE; cell = body->cells[cell].next)
            if (body->cells[cell].copies[k] == last) body->cells[cell].copies[k] = copy;
    }
    body->copy_node[copy] = node;
    gxp_copy_state(body, last, copy);
}

static void gxp_commit(gxp_cut *cut) {
    gx_body *body = cut->body;
    uint32_t i, k;
    for (i = 0; i < body->fresh.count; i++) /* what a cut touches wakes */
        for (k = 0; k < 4; k++) body->rest_time[body->cells[body->fresh.data[i]].copies[k]] = 0;
    cut->report.removed_copies = body->dead.count;
    gxp_sort_unique(&body->dead);
    for (i = body->dead.count; i-- > 0;) gxp_drop_copy(body, body->dead.data[i]);
    gxb_complex_commit(body->complex);
    body->undo_count = 0;
    body->held_stale = body->model_stale = body->view_stale = 1;
}

/* Removes what the solids have found. The cells of these leaves, and those beside them, are touched. */
static gx_result gxp_remove_leaves(gx_body *body) {
    uint32_t i;
    gx_result result = GX_OK;
    gxp_sort_unique(&body->removed);
    for (i = 0; i < body->removed.count && result == GX_OK; i++) {
        result = gxb_complex_set_removed(body->complex, body->removed.data[i]);
        if (result == GX_OK) result = gxp_push(body, &body->touched, body->leaves[body->removed.data[i]].cell);
    }
    for (i = 0; i < body->removed.count && result == GX_OK; i++) result = gxp_touch_around(body, body->removed.data[i]);
    return result;
}

static gx_result gxp_arrange_surfaces(gxp_cut *cut, gxp_surface *surfaces) {
    const size_t count = cut->desc->surface_count;
    size_t i;
    int scoped;
    gx_result result = gxp_stamp_scope(cut, &scoped);
    for (i = 0; i < count && result == GX_OK; i++) {
        result = gxp_surface_open(cut, &surfaces[i], &cut->desc->surfaces[i], i);
        if (result == GX_OK) result = gxp_insert_surface(cut, &surfaces[i], scoped);
    }
    if (result == GX_OK) result = gxp_follow_leaves(cut->body);
    for (i = 0; i < count && result == GX_OK; i++)
        if (surfaces[i].given->kind == GX_SURFACE_SOLID) result = gxp_find_solid(cut->body, &surfaces[i], scoped);
    return result;
}

static gx_result gxp_arrange(gxp_cut *cut) {
    gx_body *body = cut->body;
    const size_t count = cut->desc->surface_count;
    gxp_surface *surfaces = (gxp_surface *)gxp_allocate(&body->allocator, count * sizeof *surfaces);
    gx_result result;
    size_t i;
    if (surfaces == NULL) return GX_ERROR_MEMORY;
    memset(surfaces, 0, count * sizeof *surfaces);
    body->touched.count = body->removed.count = body->pinches.count = 0;
    result = gxp_arrange_surfaces(cut, surfaces);
    for (i = 0; i < count; i++) if (surfaces[i].given != NULL) gxp_surface_free(body, &surfaces[i]);
    gxp_release(&body->allocator, surfaces, count * sizeof *surfaces);
    if (result == GX_OK) result = gxp_list_new_leaves(cut);
    return result == GX_OK ? gxp_remove_leaves(body) : result;
}

static gx_result gxp_enrich(gxp_cut *cut, uint32_t first_facet) {
    gx_result result = gxp_collect_touched(cut);
    if (result == GX_OK) result = gxp_divide_cells(cut);
    if (result == GX_OK) result = gxp_weigh_all_links(cut, first_facet);
    if (result == GX_OK && cut->report.severed_links > 0) result = gxp_touch_severed(cut);
    return result == GX_OK ? gxp_divide_nodes(cut) : result;
}

static gx_result gxp_integrate(gxp_cut *cut) {
    gx_body *body = cut->body;
    uint32_t i;
    gx_result result = gxp_integrate_removed(cut, &body->removed);
    for (i = 0; i < body->fresh.count && result == GX_OK; i++) result = gxp_integrate_cell(body, body->fresh.data[i]);
    return result;
}

static gx_result gxp_check_cut(gxp_cut *cut) {
    const gx_cut_desc *desc = cut->desc;
    size_t i;
    gx_result result = GX_OK;
    if (desc->surfaces == NULL || (desc->scope_fragment_count > 0 && desc->scope_fragments == NULL) ||
        (desc->scope_cell_count > 0 && desc->scope_cells == NULL)) return GX_ERROR_ARGUMENT;
    if (desc->surface_count == 0) return GX_ERROR_EMPTY;
    if (!gxp_is_finite(desc->sever_below)) return GX_ERROR_NOT_FINITE;
    for (i = 0; i < desc->surface_count && result == GX_OK; i++) result = gxp_check_surface(cut, &desc->surfaces[i], i);
    if (result == GX_OK) cut->failure.surface = SIZE_MAX;
    return result;
}

GXFEM_API gx_result gx_body_cut(gx_body *body, const gx_cut_desc *desc, gx_cut_report *report, gx_failure *failure) {
    gxp_cut cut;
    uint32_t first_facet;
    double start;
    gx_result result;
    if (body == NULL || desc == NULL) return gxp_fail(failure, GX_ERROR_ARGUMENT, SIZE_MAX, SIZE_MAX);
    memset(&cut, 0, sizeof cut);
    cut.body = body; cut.desc = desc;
    cut.report.min_link_ratio = 1;
    cut.failure.index = cut.failure.surface = SIZE_MAX;
    result = gxp_check_cut(&cut);
    if (result != GX_OK) return gxp_fail(failure, result, cut.failure.index, cut.failure.surface);
    gxp_begin(&cut);
    first_facet = body->complex->facet_count;
    start = gxp_seconds(body);
    result = gxp_arrange(&cut);
    cut.report.seconds_arrangement = gxp_seconds(body) - start;
    if (result == GX_OK) result = gxp_enrich(&cut, first_facet);
    cut.report.seconds_enrichment = gxp_seconds(body) - start - cut.report.seconds_arrangement;
    if (result == GX_OK) result = gxp_integrate(&cut);
    cut.report.seconds_integrals = gxp_seconds(body) - start - cut.report.seconds_arrangement - cut.report.seconds_enrichment;
    if (result != GX_OK) {
        gxp_rollback(&cut);
        return gxp_fail(failure, result, cut.failure.index, cut.failure.surface);
    }
    gxp_commit(&cut);
    if (report != NULL) *report = cut.report;
    return gxp_fail(failure, GX_OK, SIZE_MAX, SIZE_MAX);
}

/* --- solidified sheets --- */

/* Sums of area normals at the vertices of the sheet go to normals; then each is scaled to half the thickness. */
static gx_result gxp_offset_vectors(const gx_surface *s, double half, double *normals) {
    size_t i;
    int k, c;
    memset(normals, 0, 3 * s->vertex_count * sizeof *normals);
    for (i = 0; i < s->triangle_count; i++) {
        const double *p[3];
        double n[3];
        for (c = 0; c < 3; c++) {
            if (s->triangles[3 * i + (size_t)c] >= s->vertex_count) return GX_ERROR_INDEX;
            p[c] = s->vertices + 3 * (size_t)s->triangles[3 * i + (size_t)c];
        }
        for (k = 0; k < 3; k++) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            n[k] = (p[1][a] - p[0][a]) * (p[2][b] - p[0][b]) - (p[1][b] - p[0][b]) * (p[2][a] - p[0][a]);
        }
        for (c = 0; c < 3; c++) for (k = 0; k < 3; k++) normals[3 * (size_t)s->triangles[3 * i + (size_t)c] + (size_t)k] += n[k];
    }
    for (i = 0; i < s->vertex_count; i++) {
        double *n = normals + 3 * i;
        const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (!gxp_is_finite(length)) return GX_ERROR_NOT_FINITE;
        for (k = 0; k < 3; k++) n[k] *= length > 0 ? half / length : 0;
    }
    return GX_OK;
}

/* Closes the rim: a quad for each half-edge whose edge has more triangles one way than the other. Appends to triangles. */
static gx_result gxp_close_solid(const gx_surface *s, const gx_allocator *a, uint32_t *triangles, size_t *count) {
    const size_t n = 3 * s->triangle_count, size = n * sizeof(gxp_half_edge);
    const uint32_t v = (uint32_t)s->vertex_count;
    gxp_half_edge *edges = (gxp_half_edge *)gxp_allocate(a, size);
    size_t i, j, k;
    if (edges == NULL) return GX_ERROR_MEMORY;
    for (i = 0; i < n; i++) {
        edges[i].from = s->triangles[i];
        edges[i].to = s->triangles[i % 3 == 2 ? i - 2 : i + 1];
        edges[i].triangle = (uint32_t)(i / 3); edges[i].corner = (uint32_t)(i % 3);
    }
    qsort(edges, n, sizeof *edges, gxp_compare_half_edges);
    for (i = 0; i < n; i = j) {
        long balance = 0;
        for (j = i; j < n && gxp_same_ends(&edges[i], &edges[j]); j++) balance += edges[j].from < edges[j].to ? 1 : -1;
        for (k = i; k < j && balance != 0; k++) {
            const uint32_t from = edges[k].from, to = edges[k].to;
            const long way = from < to ? 1 : -1;
            uint32_t *t = triangles + 3 * *count;
            if (way * balance < 0) continue;
            balance -= way;
            t[0] = to; t[1] = from; t[2] = from + v;
            t[3] = to; t[4] = from + v; t[5] = to + v;
            *count += 2;
        }
    }
    gxp_release(a, edges, size);
    return GX_OK;
}

GXFEM_API gx_result gx_surface_solidify(const gx_surface *sheet, double thickness, double *vertices, size_t *vertex_count,
                                        uint32_t *triangles, size_t *triangle_count, const gx_allocator *allocator) {
    gx_allocator none;
    size_t i, count;
    gx_result result;
    double *normals;
    memset(&none, 0, sizeof none);
    if (allocator == NULL) allocator = &none;
    if (!sheet || !vertices || !vertex_count || !triangles || !triangle_count) return GX_ERROR_ARGUMENT;
    if (!gxp_is_finite(thickness)) return GX_ERROR_NOT_FINITE;
    if (!(thickness > 0)) return GX_ERROR_ARGUMENT;
    if (sheet->vertex_count == 0 || sheet->triangle_count == 0) return GX_ERROR_EMPTY;
    if (sheet->vertices == NULL || sheet->triangles == NULL) return GX_ERROR_ARGUMENT;
    if (sheet->vertex_count > INT32_MAX / 2 || sheet->triangle_count > INT32_MAX / 8) return GX_ERROR_LIMIT;
    normals = (double *)gxp_allocate(allocator, 3 * sheet->vertex_count * sizeof *normals);
    if (normals == NULL) return GX_ERROR_MEMORY;
    result = gxp_offset_vectors(sheet, 0.5 * thickness, normals);
    count = 2 * sheet->triangle_count;
    if (result == GX_OK) result = gxp_close_solid(sheet, allocator, triangles, &count);
    for (i = 0; i < 3 * sheet->vertex_count && result == GX_OK; i++) {
        vertices[i] = sheet->vertices[i] + normals[i];
        vertices[3 * sheet->vertex_count + i] = sheet->vertices[i] - normals[i];
    }
    for (i = 0; i < 3 * sheet->triangle_count && result == GX_OK; i++) {
        triangles[i] = sheet->triangles[i];
        triangles[3 * sheet->triangle_count + i] = sheet->triangles[i - i % 3 + (3 - i % 3) % 3] + (uint32_t)sheet->vertex_count;
    }
    gxp_release(allocator, normals, 3 * sheet->vertex_count * sizeof *normals);
    if (result != GX_OK) return result;
    *vertex_count = 2 * sheet->vertex_count;
    *triangle_count = count;
    return GX_OK;
}

/* >>regions: which copies are held ---------------------------------------------------------------------------------------------- */

static int gxp_point_in_region(gx_body *body, uint32_t point, const gx_region *r) {
    if (point < body->node_count) {
        const double x = body->positions[3 * (size_t)point + r->axis];
        return r->side < 0 ? x < r->value : x > r->value;
    }
    return gxb_complex_compare(body->complex, point, (int)r->axis, r->value) * r->side > 0;
}

/* Has the cell material in the region? Leaves are convex: their points tell. */
static gx_result gxp_cell_in_region(gx_body *body, uint32_t cell, const gx_region *r, int *inside) {
    uint32_t leaf, i;
    gx_result result = GX_OK;
    *inside = 0;
    for (leaf = body->cells[cell].first_leaf; leaf != GXP_NONE && result == GX_OK && !*inside; leaf = body->leaves[leaf].next) {
        if (body->complex->leaves[leaf].facet_count == 0) {
            for (i = 0; i < 4; i++) *inside |= gxp_point_in_region(body, body->complex->elements[4 * body->cells[cell].element + i], r);
            continue;
        }
        result = gxp_leaf_points(body, leaf);
        for (i = 0; i < body->list.count && result == GX_OK && !*inside; i++) *inside = gxp_point_in_region(body, body->list.data[i], r);
    }
    return result;
}

static gx_result gxp_copy_in_region(gx_body *body, uint32_t copy, const gx_region *r, int *inside) {
    const uint32_t node = body->copy_node[copy];
    uint32_t j, cell;
    gx_result result = GX_OK;
    *inside = 0;
    if (!gxp_point_in_region(body, node, r)) return GX_OK;
    for (j = body->node_start[node]; j < body->node_start[node + 1] && !*inside; j++) {
        const int k = gxp_local_node(body, body->node_elements[j], node);
        for (cell = body->node_elements[j]; cell != GXP_NONE && result == GX_OK && !*inside; cell = body->cells[cell].next)
            if (body->cells[cell].kept && body->cells[cell].copies[k] == copy) result = gxp_cell_in_region(body, cell, r, inside);
    }
    return result;
}

static gx_result gxp_update_held(gx_body *body) {
    uint32_t c, r;
    gx_result result = GX_OK;
    if (!body->held_stale) return GX_OK;
    for (c = 0; c < body->copy_count && result == GX_OK; c++) {
        int held = 0;
        for (r = 0; r < body->region_count && result == GX_OK && !held; r++) result = gxp_copy_in_region(body, c, &body->regions[r], &held);
        body->held[c] = (uint8_t)held;
    }
    if (result == GX_OK) body->held_stale = 0;
    return result;
}

GXFEM_API gx_result gx_body_hold(gx_body *body, const gx_region *regions, size_t region_count) {
    gx_region *copy = NULL;
    size_t i;
    if (body == NULL || (region_count > 0 && regions == NULL)) return GX_ERROR_ARGUMENT;
    if (region_count > INT32_MAX) return GX_ERROR_LIMIT;
    for (i = 0; i < region_count; i++) {
        if (!gxp_is_finite(regions[i].value)) return GX_ERROR_NOT_FINITE;
        if (regions[i].axis > 2 || (regions[i].side != 1 && regions[i].side != -1)) return GX_ERROR_ARGUMENT;
    }
    if (region_count > 0) {
        copy = (gx_region *)gxp_allocate(&body->allocator, region_count * sizeof *copy);
        if (copy == NULL) return GX_ERROR_MEMORY;
        memcpy(copy, regions, region_count * sizeof *copy);
    }
    gxp_release(&body->allocator, body->regions, body->region_count * sizeof *body->regions);
    body->regions = copy;
    body->region_count = (uint32_t)region_count;
    body->held_stale = body->model_stale = 1;
    return GX_OK;
}

/* >>fragments: the view ----------------------------------------------------------------------------------------------------------- */

static uint32_t gxp_find(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) { parent[i] = parent[parent[i]]; i = parent[i]; }
    return i;
}

static void gxp_unite(uint32_t *parent, uint32_t i, uint32_t j) {
    i = gxp_find(parent, i); j = gxp_find(parent, j);
    if (i < j) parent[j] = i;
    else parent[i] = j;
}

static gx_result gxp_set_words(gx_body *body, gxp_words *words, size_t count) {
    words->count = 0;
    return gxp_words_room(body, words, count);
}

/* Lists the kept cells by element and joins copies that a cell moves by: cells of one fragment share copies from link to link. */
static gx_result gxp_list_cells(gx_body *body) {
    uint32_t e, cell, k, i;
    gx_result result = gxp_set_words(body, &body->view_cells, body->cell_count);
    if (result == GX_OK) result = gxp_set_words(body, &body->view_fragments, body->cell_count);
    if (result == GX_OK) result = gxp_set_words(body, &body->cell_element, body->cell_count);
    if (result == GX_OK) result = gxp_set_words(body, &body->cell_copies, 4 * (size_t)body->cell_count);
    if (result == GX_OK) result = gxp_set_words(body, &body->copy_fragment, body->copy_count);
    if (result == GX_OK) result = gxp_reserve(&body->allocator, &body->cell_volume, sizeof(double), 0, &body->cell_volume_capacity, body->cell_count);
    if (result != GX_OK) return result;
    for (i = 0; i < body->copy_count; i++) body->copy_fragment.data[i] = i;
    for (e = 0; e < body->element_count; e++) for (cell = e; cell != GXP_NONE; cell = body->cells[cell].next) {
        const gxp_cell *c = &body->cells[cell];
        if (!c->kept) continue;
        body->cell_volume[body->view_cells.count] = c->volume;
        body->view_cells.data[body->view_cells.count++] = cell;
        body->cell_element.data[body->cell_element.count++] = e;
        for (k = 0; k < 4; k++) body->cell_copies.data[body->cell_copies.count++] = c->copies[k];
        for (k = 1; k < 4; k++) gxp_unite(body->copy_fragment.data, c->copies[0], c->copies[k]);
    }
    return GX_OK;
}

/* Numbers fragments in the order of their first cells. */
static gx_result gxp_number_fragments(gx_body *body) {
    uint32_t i;
    gx_result result = gxp_set_words(body, &body->fragment_number, body->copy_count);
    if (result != GX_OK) return result;
    memset(body->fragment_number.data, 0xff, body->copy_count * sizeof *body->fragment_number.data);
    body->fragment_count = 0;
    for (i = 0; i < body->view_cells.count; i++) {
        const uint32_t copy = gxp_find(body->copy_fragment.data, body->cell_copies.data[4 * i]);
        if (body->fragment_number.data[copy] == GXP_NONE) body->fragment_number.data[copy] = body->fragment_count++;
        body->view_fragments.data[body->view_fragments.count++] = body->fragment_number.data[copy];
    }
    return GX_OK;
}

/* Fragment of a cell slot, by the view. */
static uint32_t gxp_cell_fragment(gx_body *body, uint32_t cell) {
    return body->fragment_number.data[gxp_find(body->copy_fragment.data, body->cells[cell].copies[0])];
}

/* Sum of a mass block's row: density * integral of lambda_i */
static double gxp_mass_row(const double mass[10], int i) {
    static const uint8_t at[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    return mass[at[i][0]] + mass[at[i][1]] + mass[at[i][2]] + mass[at[i][3]];
}

static gx_result gxp_sum_fragments(gx_body *body) {
    double *volume, *mass, *center;
    uint32_t i, f;
    int k, n;
    if (body->fragment_count > body->fragment_capacity) {
        const uint32_t room = body->fragment_count + body->fragment_count / 2 + 4;
        double *memory = (double *)gxp_allocate(&body->allocator, (size_t)room * 5 * sizeof *memory);
        if (memory == NULL) return GX_ERROR_MEMORY;
        gxp_release(&body->allocator, body->fragments, (size_t)body->fragment_capacity * 5 * sizeof(double));
        body->fragments = memory;
        body->fragment_capacity = room;
    }
    body->volume = body->mass = 0;
    if (body->fragment_count == 0) return GX_OK;
    memset(body->fragments, 0, (size_t)body->fragment_capacity * 5 * sizeof(double));
    volume = body->fragments; mass = volume + body->fragment_capacity; center = mass + body->fragment_capacity;
    for (i = 0; i < body->view_cells.count; i++) {
        const gxp_cell *c = &body->cells[body->view_cells.data[i]];
        f = body->view_fragments.data[i];
        volume[f] += c->volume;
        for (n = 0; n < 4; n++) {
            const double row = gxp_mass_row(c->mass, n);
            mass[f] += row;
            for (k = 0; k < 3; k++) center[3 * f + (uint32_t)k] += row * body->positions[3 * (size_t)body->complex->elements[4 * (size_t)c->element + (size_t)n] + (size_t)k];
        }
    }
    for (f = 0; f < body->fragment_count; f++) {
        body->volume += volume[f];
        body->mass += mass[f];
        for (k = 0; k < 3; k++) if (mass[f] > 0) center[3 * f + (uint32_t)k] /= mass[f];
    }
    return GX_OK;
}

static gx_result gxp_update_view(gx_body *body) {
    gx_result result;
    if (!body->view_stale) return GX_OK;
    result = gxp_list_cells(body);
    if (result == GX_OK) result = gxp_number_fragments(body);
    if (result == GX_OK) result = gxp_sum_fragments(body);
    if (result == GX_OK) body->view_stale = 0;
    return result;
}

GXFEM_API gx_result gx_body_view(gx_body *body, gx_view *view) {
    gx_result result;
    if (body == NULL || view == NULL) return GX_ERROR_ARGUMENT;
    result = gxp_update_view(body);
    if (result == GX_OK) result = gxp_update_held(body);
    if (result != GX_OK) return result;
    view->node_count = body->node_count; view->element_count = body->element_count;
    view->cell_count = body->view_cells.count;
    view->cell_element = body->cell_element.data; view->cell_copies = body->cell_copies.data;
    view->cell_volume = body->cell_volume; view->cell_fragment = body->view_fragments.data;
    view->copy_count = body->copy_count; view->copy_node = body->copy_node; view->copy_held = body->held;
    view->displacement = body->displacement; view->velocity = body->velocity; view->rest_time = body->rest_time;
    view->fragment_count = body->fragment_count;
    view->fragment_volume = body->fragments;
    view->fragment_mass = body->fragments ? body->fragments + body->fragment_capacity : NULL;
    view->fragment_center = body->fragments ? body->fragments + 2 * (size_t)body->fragment_capacity : NULL;
    view->volume = body->volume; view->mass = body->mass;
    return GX_OK;
}

/* >>parts: what the solver sees: the cells of an element whose four copies coincide are one --------------------------------------- */

static void gxp_add_part(gx_body *body, const gxp_cell *cell, uint32_t first, const double gradients[12]) {
    gxs_element *part;
    uint32_t i;
    int k;
    for (i = first; i < body->part_count; i++) if (memcmp(body->parts[i].copy, cell->copies, sizeof cell->copies) == 0) break;
    part = &body->parts[i];
    if (i == body->part_count) {
        memset(part, 0, sizeof *part);
        memcpy(part->copy, cell->copies, sizeof part->copy);
        memcpy(part->gradient, gradients, 12 * sizeof *gradients);
        part->material = body->element_materials[cell->element];
        body->part_count++;
    }
    part->weight += cell->volume;
    for (k = 0; k < 10; k++) part->mass[k] += cell->mass[k];
}

static gx_result gxp_make_parts(gx_body *body) {
    uint32_t e, cell;
    gx_result result = gxp_reserve(&body->allocator, &body->parts, sizeof *body->parts, 0, &body->part_capacity, body->cell_count);
    body->part_count = 0;
    for (e = 0; e < body->element_count && result == GX_OK; e++) {
        const uint32_t first = body->part_count;
        double x[12], gradients[12];
        gxp_element_positions(body, e, x);
        result = gxi_tet_gradients(x, gradients, NULL);
        for (cell = e; cell != GXP_NONE; cell = body->cells[cell].next)
            if (body->cells[cell].kept) gxp_add_part(body, &body->cells[cell], first, gradients);
    }
    return result;
}

/* --- copies with next to no support follow others --- */

/* What is found about copies on the way */
typedef struct gxp_supports {
    double *share;          /* copy_count: volume around it, as a share of its node's */
    uint32_t *part;         /* copy_count: the part whose field it shall follow; GXP_NONE: not known, or none */
    uint32_t *root;         /* copy_count: union-find over parts: fragments */
} gxp_supports;

static double gxp_part_volume(const gxs_element *part) {
    const double *g = part->gradient[1];
    const double det = g[0] * (g[4] * g[8] - g[5] * g[7]) + g[1] * (g[5] * g[6] - g[3] * g[8]) + g[2] * (g[3] * g[7] - g[4] * g[6]);
    return 1 / (6 * fabs(det));
}

/* Shares of all copies. node: node_count, scratch, zero: volumes of the elements around each node */
static void gxp_find_shares(const gx_body *body, gxp_supports *of, double *node) {
    uint32_t e, i;
    int k;
    for (e = 0; e < body->element_count; e++) {
        double x[12], gradients[12], volume = 0;
        gxp_element_positions(body, e, x);
        (void)gxi_tet_gradients(x, gradients, &volume);
        for (k = 0; k < 4; k++) node[body->complex->elements[4 * (size_t)e + (size_t)k]] += volume;
    }
    for (i = 0; i < body->part_count; i++)
        for (k = 0; k < 4; k++) of->share[body->parts[i].copy[k]] += body->parts[i].weight;
    for (i = 0; i < body->copy_count; i++) of->share[i] /= node[body->copy_node[i]];
}

static int gxp_low(const gx_body *body, const gxp_supports *of, uint32_t copy) { return of->share[copy] < body->support_below; }

/* Parts whose copies are all well supported are followed, by their own copies first, then from neighbour to neighbour. */
static void gxp_spread_supports(const gx_body *body, gxp_supports *of) {
    uint32_t i, changed = 1;
    int k, j;
    for (i = 0; i < body->part_count; i++) {
        const uint32_t *c = body->parts[i].copy;
        if (gxp_low(body, of, c[0]) || gxp_low(body, of, c[1]) || gxp_low(body, of, c[2]) || gxp_low(body, of, c[3])) continue;
        for (k = 0; k < 4; k++) if (of->part[c[k]] == GXP_NONE) of->part[c[k]] = i;
    }
    while (changed) {
        changed = 0;
        for (i = 0; i < body->part_count; i++) {
            const uint32_t *c = body->parts[i].copy;
            for (k = 0; k < 4 && of->part[c[k]] == GXP_NONE; k++) continue;
            for (j = 0; j < 4 && k < 4; j++)
                if (of->part[c[j]] == GXP_NONE) { of->part[c[j]] = of->part[c[k]]; changed = 1; }
        }
    }
}

/* Fragments that are left follow their fullest part. */
static void gxp_choose_fullest(const gx_body *body, gxp_supports *of) {
    uint32_t i;
    int k;
    for (i = 0; i < body->copy_count; i++) of->root[i] = i;
    for (i = 0; i < body->part_count; i++)
        for (k = 1; k < 4; k++) gxp_unite(of->root, body->parts[i].copy[0], body->parts[i].copy[k]);
    for (i = 0; i < body->part_count; i++) {
        const uint32_t root = gxp_find(of->root, body->parts[i].copy[0]), best = of->part[root];
        if (of->part[body->parts[i].copy[0]] != GXP_NONE && best == GXP_NONE) continue;
        if (best == GXP_NONE || body->parts[i].weight / gxp_part_volume(&body->parts[i]) > body->parts[best].weight / gxp_part_volume(&body->parts[best]))
            of->part[root] = i;
    }
    for (i = 0; i < body->copy_count; i++) if (of->part[i] == GXP_NONE) of->part[i] = of->part[gxp_find(of->root, i)];
}

/* The copy follows the field of its part at its node, or, where that part is all but empty, the part's best supported copy. */
static void gxp_add_constraint(gx_body *body, const gxp_supports *of, uint32_t copy) {
    const gxs_element *part = &body->parts[of->part[copy]];
    const double *x = body->positions + 3 * (size_t)body->copy_node[copy], *x0 = body->positions + 3 * (size_t)body->copy_node[part->copy[0]];
    gxs_constraint *constraint = &body->constraints[body->constraint_count];
    int k, best = 0, c;
    for (k = 1; k < 4; k++) if (of->share[part->copy[k]] > of->share[part->copy[best]]) best = k;
    constraint->copy = copy;
    for (k = 0; k < 4; k++) {
        const int point = part->weight < body->support_below * gxp_part_volume(part);
        constraint->master[k] = part->copy[k];
        constraint->weight[k] = point ? k == best : k == 0;
        for (c = 0; c < 3 && !point; c++) constraint->weight[k] += part->gradient[k][c] * (x[c] - x0[c]);
        if (part->copy[k] == copy && (!point || k == best)) return;   /* a master itself */
    }
    body->constraint_count++;
}

static gx_result gxp_make_constraints(gx_body *body) {
    const gx_allocator *a = &body->allocator;
    const size_t n = (size_t)body->copy_count + 1, node_bytes = ((size_t)body->node_count + 1) * sizeof(double);
    gxp_supports of;
    double *node;
    uint32_t i;
    gx_result result;
    body->constraint_count = 0;
    if (!(body->support_below > 0)) return GX_OK;
    result = gxp_reserve(a, &body->constraints, sizeof *body->constraints, 0, &body->constraint_capacity, body->copy_count);
    if (result != GX_OK) return result;
    of.share = (double *)gxp_allocate(a, n * sizeof(double));
    of.part = (uint32_t *)gxp_allocate(a, 2 * n * sizeof(uint32_t));
    node = (double *)gxp_allocate(a, node_bytes);
    if (of.share != NULL && of.part != NULL && node != NULL) {
        of.root = of.part + n;
        memset(of.share, 0, n * sizeof(double));
        memset(of.part, 0xff, n * sizeof(uint32_t));
        memset(node, 0, node_bytes);
        gxp_find_shares(body, &of, node);
        gxp_spread_supports(body, &of);
        gxp_choose_fullest(body, &of);
        for (i = 0; i < body->copy_count; i++) if (gxp_low(body, &of, i) && of.part[i] != GXP_NONE) gxp_add_constraint(body, &of, i);
    } else result = GX_ERROR_MEMORY;
    gxp_release(a, of.share, n * sizeof(double));
    gxp_release(a, of.part, 2 * n * sizeof(uint32_t));
    gxp_release(a, node, node_bytes);
    return result;
}

static gx_result gxp_make_model(gx_body *body, gxs_model *model) {
    const gx_allocator *a = &body->allocator;
    uint32_t i;
    gx_result result = gxp_make_parts(body);
    if (result == GX_OK) result = gxp_make_constraints(body);
    if (result == GX_OK) result = gxp_reserve(a, &body->rest, 3 * sizeof(double), 0, &body->rest_capacity, body->copy_count);
    if (result == GX_OK) result = gxp_reserve(a, &body->elastic, sizeof *body->elastic, 0, &body->elastic_capacity, body->material_count);
    if (result != GX_OK) return result;
    for (i = 0; i < body->copy_count; i++)
        memcpy(body->rest + 3 * (size_t)i, body->positions + 3 * (size_t)body->copy_node[i], 3 * sizeof(double));
    for (i = 0; i < body->material_count; i++) body->elastic[i] = body->materials[i].elastic;
    memset(model, 0, sizeof *model);
    model->copy_count = body->copy_count; model->positions = body->rest;
    model->elements = body->parts; model->element_count = body->part_count;
    model->materials = body->elastic; model->material_count = body->material_count;
    model->held = body->held;
    model->constraints = body->constraints; model->constraint_count = body->constraint_count;
    return GX_OK;
}

/* The solver's model, anew after a cut or a hold only. The solver copies it, so that it need not be kept. */
static gx_result gxp_update_model(gx_body *body) {
    gxs_model model;
    gx_result result = gxp_update_held(body);
    if (result == GX_OK && body->model_stale) {
        result = gxp_make_model(body, &model);
        if (result == GX_OK && body->part_count > 0) result = gxs_solver_set_model(body->solver, &model, NULL);
        if (result == GX_OK) body->model_stale = 0;
    }
    gxp_release_model(body);
    return result;
}

GXFEM_API gx_result gx_body_model(gx_body *body, gxs_model *model) {
    gx_result result;
    if (body == NULL || model == NULL) return GX_ERROR_ARGUMENT;
    result = gxp_update_held(body);
    return result == GX_OK ? gxp_make_model(body, model) : result;
}

/* The step with what is the body's own */
static gx_result gxp_complete_step(gx_body *body, const gx_step_desc *desc, gx_step_desc *step) {
    const int history = desc->integrator == GXS_BDF2;
    gx_result result = GX_OK;
    int i;
    *step = *desc;
    step->rest_times = body->rest_time;
    if (step->clock == NULL) { step->clock = body->clock; step->clock_user = body->clock_user; }
    for (i = 0; i < 4 && history && result == GX_OK; i++)
        if (body->history[i] == NULL)
            result = gxp_reserve(&body->allocator, &body->history[i], 3 * sizeof(double), 0, &body->history_capacity[i], body->copy_count);
    step->previous_displacement = history && body->previous_dt > 0 ? body->history[0] : NULL;
    step->previous_velocity = body->history[1];
    step->previous_dt = body->previous_dt;
    return result;
}

/* The solver's step, and what BDF2's next one needs of this one */
static gx_result gxp_step(gx_body *body, const gx_step_desc *step, gx_step_report *report, gx_failure *failure) {
    const size_t bytes = 3 * (size_t)body->copy_count * sizeof(double);
    const int history = step->integrator == GXS_BDF2;
    gx_result result;
    int i;
    if (history) {
        memcpy(body->history[2], body->displacement, bytes);
        memcpy(body->history[3], body->velocity, bytes);
    }
    result = gxs_solver_step(body->solver, step, body->displacement, body->velocity, report, failure);
    if (result != GX_OK) return result;
    body->previous_dt = history ? step->dt : 0;
    for (i = 0; i < 2 && history; i++) {
        double *now = body->history[i + 2];
        const uint32_t capacity = body->history_capacity[i + 2];
        body->history[i + 2] = body->history[i]; body->history_capacity[i + 2] = body->history_capacity[i];
        body->history[i] = now; body->history_capacity[i] = capacity;
    }
    return GX_OK;
}

GXFEM_API gx_result gx_body_step(gx_body *body, const gx_step_desc *desc, gx_step_report *report, gx_failure *failure) {
    const double start = body != NULL ? gxp_seconds(body) : 0;
    gx_step_desc step;
    gx_result result;
    if (body == NULL || desc == NULL) return gxp_fail(failure, GX_ERROR_ARGUMENT, SIZE_MAX, SIZE_MAX);
    result = gxp_update_model(body);
    if (result == GX_OK) result = gxp_complete_step(body, desc, &step);
    if (result == GX_OK && body->part_count == 0 && report != NULL) memset(report, 0, sizeof *report);
    if (result != GX_OK || body->part_count == 0) return gxp_fail(failure, result, SIZE_MAX, SIZE_MAX);    /* nothing left to move */
    result = gxp_step(body, &step, report, failure);
    if (result == GX_OK && report != NULL) report->seconds = gxp_seconds(body) - start;
    return result;
}

/* >>boundary: the skin ---------------------------------------------------------------------------------------------------------- */

/* Do two cells move apart at a common facet? In one element where any copy differs, else where a shared node's copies differ. */
static int gxp_cells_part(const gx_body *body, uint32_t a, uint32_t b) {
    const gxp_cell *p = &body->cells[a], *q = &body->cells[b];
    uint32_t k;
    if (p->element == q->element) return memcmp(p->copies, q->copies, sizeof p->copies) != 0;
    for (k = 0; k < 4; k++) {
        const int j = gxp_local_node(body, q->element, body->complex->elements[4 * p->element + k]);
        if (j >= 0 && p->copies[k] != q->copies[j]) return 1;
    }
    return 0;
}

/* -1: the facet is not seen from the leaf; 0: outer surface; 1: face of a cut */
static int gxp_visible(const gx_body *body, uint32_t facet, uint32_t leaf) {
    const gxb_facet *f = &body->complex->facets[facet];
    const uint32_t other = f->leaf[f->leaf[0] == leaf];
    if (other == GXB_NONE) return 0;
    if (body->complex->leaves[other].removed) return 1;
    return f->wall && gxp_cells_part(body, body->leaves[leaf].cell, body->leaves[other].cell) ? 1 : -1;
}

/* --- facets as triangles with area, so that they have normals: a facet's corners may stand in line with others --- */

/* May corner i be cut off the polygon of complex points? Its triangle has area, and so has what remains. */
static int gxp_is_ear(gx_body *body, const uint32_t *p, uint32_t n, uint32_t i, uint32_t plane) {
    const uint32_t before = p[(i + n - 1) % n], after = p[(i + 1) % n];
    uint32_t j;
    if (gxb_complex_turn(body->complex, before, p[i], after, plane) == 0) return 0;
    if (n == 3) return 1;
    for (j = 2; j < n - 1; j++) if (gxb_complex_turn(body->complex, before, after, p[(i + j) % n], plane) != 0) return 1;
    return 0;
}

static gx_result gxp_add_skin_triangle(gx_body *body, uint32_t element, const uint32_t point[3], int inward) {
    uint32_t c, corner[3];
    gx_result result = GX_OK;
    for (c = 0; c < 3 && result == GX_OK; c++) result = gxp_add_boundary_point(body, element, point[c], &corner[c]);
    for (c = 0; c < 3 && result == GX_OK; c++) result = gxp_push(body, &body->triangles, corner[inward ? 2 - c : c]);
    return result;
}

/* Adds a facet as triangles, outward from the leaf: ears are cut off its convex polygon, which stands in body->faces. */
static gx_result gxp_add_skin_facet(gx_body *body, uint32_t element, uint32_t facet, uint32_t leaf) {
    gxb_complex *cx = body->complex;
    const int inward = cx->facets[facet].leaf[0] == leaf;
    uint32_t *p, e0, en, i, n;
    gx_result result = gxb_facet_edges(cx, facet, &e0, &en);
    body->faces.count = 0;
    for (i = 0; i < en && result == GX_OK; i++) result = gxp_push(body, &body->faces, cx->edges[cx->pool[e0 + i] >> 1].v[cx->pool[e0 + i] & 1]);
    p = body->faces.data;
    for (n = body->faces.count, i = 0; n >= 3 && result == GX_OK; n--) {
        uint32_t triangle[3], tries = 0;
        for (i %= n; tries < n && !gxp_is_ear(body, p, n, i, cx->facets[facet].plane); i = (i + 1) % n) tries++;
        triangle[0] = p[(i + n - 1) % n]; triangle[1] = p[i]; triangle[2] = p[(i + 1) % n];
        result = gxp_add_skin_triangle(body, element, triangle, inward);
        memmove(p + i, p + i + 1, (n - 1 - i) * sizeof *p);
        i++;
    }
    return result;
}

static gx_result gxp_skin_leaf(gx_body *body, uint32_t leaf, uint32_t fragment) {
    gxb_complex *cx = body->complex;
    uint32_t first, count, i, t;
    gx_result result = gxb_leaf_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        const uint32_t facet = cx->pool[first + i], before = body->triangles.count;
        const int kind = gxp_visible(body, facet, leaf);
        if (kind < 0) continue;
        result = gxp_add_skin_facet(body, cx->leaves[leaf].element, facet, leaf);
        for (t = before; t < body->triangles.count && result == GX_OK; t += 3) {
            result = gxp_push(body, &body->skin_fragments, fragment);
            if (result == GX_OK) result = gxp_push(body, &body->skin_cuts, (uint32_t)kind);
        }
    }
    return result;
}

/* An element that no cut has touched shows its outer faces. */
static gx_result gxp_skin_whole(gx_body *body, uint32_t element, uint32_t fragment) {
    static const uint8_t outward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    uint32_t k, c, slot[4];
    gx_result result = GX_OK;
    memset(slot, 0xff, sizeof slot);
    for (k = 0; k < 4 && result == GX_OK; k++) {
        if (gxp_neighbour(body, element, k) != GXP_NONE) continue;
        for (c = 0; c < 3 && result == GX_OK; c++) {
            const uint32_t n = outward[k][c];
            if (slot[n] == GXP_NONE) {
                result = gxp_reserve(&body->allocator, &body->lambdas, 4 * sizeof(double), body->list.count, &body->lambda_capacity, 1);
                slot[n] = body->list.count;
                if (result == GX_OK) result = gxp_push(body, &body->list, body->complex->elements[4 * element + n]);
                if (result != GX_OK) return result;
                memset(body->lambdas + 4 * (size_t)slot[n], 0, 4 * sizeof(double));
                body->lambdas[4 * (size_t)slot[n] + n] = 1;
            }
            result = gxp_push(body, &body->triangles, slot[n]);
        }
        if (result == GX_OK) result = gxp_push(body, &body->skin_fragments, fragment);
        if (result == GX_OK) result = gxp_push(body, &body->skin_cuts, 0);
    }
    return result;
}

static int gxp_is_untouched(const gx_body *body, uint32_t element) {
    uint32_t k;
    for (k = 0; k < 4; k++) if (body->complex->face_facet[body->complex->element_faces[4 * element + k]] != GXB_NONE) return 0;
    return 1;
}

/* Collects what one cell shows and appends it to the skin. */
static gx_result gxp_skin_cell(gx_body *body, uint32_t cell, uint32_t fragment) {
    const uint32_t element = body->cells[cell].element;
    uint32_t leaf, i, k, base = body->skin_weight_count / 4;
    gx_result result = GX_OK;
    gxp_clear_boundary(body);
    if (gxp_is_untouched(body, element)) result = gxp_skin_whole(body, element, fragment);
    else {
        result = gxb_complex_open_element(body->complex, element);
        for (leaf = body->cells[cell].first_leaf; leaf != GXP_NONE && result == GX_OK; leaf = body->leaves[leaf].next)
            result = gxp_skin_leaf(body, leaf, fragment);
    }
    if (result == GX_OK) result = gxp_reserve(&body->allocator, &body->skin_weights, sizeof(double), body->skin_weight_count,
                                              &body->skin_weight_capacity, 4 * (size_t)body->list.count);
    for (i = 0; i < body->list.count && result == GX_OK; i++) for (k = 0; k < 4 && result == GX_OK; k++) {
        body->skin_weights[body->skin_weight_count++] = body->lambdas[4 * (size_t)i + k];
        result = gxp_push(body, &body->skin_copies, body->cells[cell].copies[k]);
    }
    for (i = 0; i < body->list.count && result == GX_OK; i++) result = gxp_push(body, &body->skin_points, body->list.data[i]);
    for (i = 0; i < body->triangles.count && result == GX_OK; i++) result = gxp_push(body, &body->skin_triangles, base + body->triangles.data[i]);
    return result;
}

GXFEM_API gx_result gx_body_skin(gx_body *body, gx_skin *skin) {
    uint32_t i;
    gx_result result;
    if (body == NULL || skin == NULL) return GX_ERROR_ARGUMENT;
    result = gxp_update_view(body);
    body->skin_copies.count = body->skin_points.count = body->skin_triangles.count = body->skin_fragments.count = body->skin_cuts.count = 0;
    body->skin_weight_count = 0;
    for (i = 0; i < body->view_cells.count && result == GX_OK; i++)
        result = gxp_skin_cell(body, body->view_cells.data[i], body->view_fragments.data[i]);
    if (result != GX_OK) return result;
    skin->vertex_count = body->skin_weight_count / 4;
    skin->vertex_copies = body->skin_copies.data;
    skin->vertex_weights = body->skin_weights;
    skin->vertex_point = body->skin_points.data;
    skin->triangle_count = body->skin_triangles.count / 3;
    skin->triangles = body->skin_triangles.data;
    skin->triangle_fragment = body->skin_fragments.data;
    skin->triangle_cut = body->skin_cuts.data;
    return GX_OK;
}

GXFEM_API void gx_body_skin_positions(const gx_body *body, const gx_skin *skin, double *positions) {
    size_t i;
    int k, n;
    for (i = 0; i < skin->vertex_count; i++) for (k = 0; k < 3; k++) {
        double x = 0;
        for (n = 0; n < 4; n++) {
            const size_t copy = skin->vertex_copies[4 * i + (size_t)n];
            x += skin->vertex_weights[4 * i + (size_t)n] *
                 (body->positions[3 * (size_t)body->copy_node[copy] + (size_t)k] + body->displacement[3 * copy + (size_t)k]);
        }
        positions[3 * i + (size_t)k] = x;
    }
}

/* --- hashes --- */

static uint64_t gxp_mix(uint64_t x) {   /* splitmix64's finaliser */
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

#define GXP_BESIDE_WALL 0xfffffff0u     /* neighbour across a wall inside the element */
#define GXP_ACROSS_WALL 0xfffffff1u     /* neighbour across a wall on a face */

/* Appends to pairs (face or kind, neighbour) for everything that a cell borders on. */
static gx_result gxp_push_neighbours(gx_body *body, uint32_t cell) {
    gxb_complex *cx = body->complex;
    const uint32_t element = body->cells[cell].element;
    uint32_t leaf, first, count, i;
    gx_result result = gxb_complex_open_element(cx, element);
    for (leaf = body->cells[cell].first_leaf; leaf != GXP_NONE && result == GX_OK; leaf = body->leaves[leaf].next) {
        result = gxb_leaf_facets(cx, leaf, &first, &count);
        for (i = 0; i < count && result == GX_OK; i++) {
            const gxb_facet *f = &cx->facets[cx->pool[first + i]];
            const uint32_t other = f->leaf[f->leaf[0] == leaf];
            if (!gxp_is_kept(body, other) || body->leaves[other].cell == cell) continue;
            result = gxp_push_pair(body, f->face == GXB_NONE ? GXP_BESIDE_WALL : f->wall ? GXP_ACROSS_WALL : f->face, body->leaves[other].cell);
        }
    }
    return result;
}

static uint64_t gxp_hash_neighbours(gx_body *body, const uint64_t *name) {
    uint64_t sum = 0;
    uint32_t i;
    if (body->pair_count > 0) qsort(body->pairs, body->pair_count, sizeof *body->pairs, gxp_compare_pairs);
    for (i = 0; i < body->pair_count; i++) {
        if (i > 0 && gxp_compare_pairs(&body->pairs[i], &body->pairs[i - 1]) == 0) continue;
        sum += gxp_mix(name[body->pairs[i].cell] ^ gxp_mix(body->pairs[i].node));
    }
    return sum;
}

/* Which nodes of the element are in the cell: its first name. */
static gx_result gxp_first_name(gx_body *body, uint32_t cell, uint64_t *name) {
    uint32_t leaf, i, mask = 0;
    gx_result result = GX_OK;
    for (leaf = body->cells[cell].first_leaf; leaf != GXP_NONE && result == GX_OK; leaf = body->leaves[leaf].next) {
        result = gxp_leaf_points(body, leaf);
        for (i = 0; i < body->list.count; i++) {
            const int k = gxp_local_node(body, body->cells[cell].element, body->list.data[i]);
            if (k >= 0) mask |= 1u << k;
        }
    }
    *name = gxp_mix((uint64_t)body->cells[cell].element << 4 | mask);
    return result;
}

/* Three rounds in which each cell's name takes in its neighbours' names (Weisfeiler-Lehman); sums do not depend on any order. */
static gx_result gxp_name_cells(gx_body *body, uint64_t *name, uint64_t *next) {
    uint32_t i, round;
    gx_result result = GX_OK;
    for (i = 0; i < body->view_cells.count && result == GX_OK; i++) result = gxp_first_name(body, body->view_cells.data[i], &name[body->view_cells.data[i]]);
    for (round = 0; round < 3 && result == GX_OK; round++) {
        for (i = 0; i < body->view_cells.count && result == GX_OK; i++) {
            const uint32_t cell = body->view_cells.data[i];
            body->pair_count = 0;
            result = gxp_push_neighbours(body, cell);
            next[cell] = gxp_mix(name[cell] * 3 + gxp_hash_neighbours(body, name));
        }
        memcpy(name, next, body->cell_count * sizeof *name);
    }
    return result;
}

/* Cells with their names, the copies they share, the counts. */
static uint64_t gxp_hash_names(const gx_body *body, const uint64_t *name, uint64_t *copies) {
    uint64_t sum = gxp_mix(body->copy_count) + gxp_mix((uint64_t)body->fragment_count << 32);
    uint32_t i, k;
    memset(copies, 0, body->copy_count * sizeof *copies);
    for (i = 0; i < body->view_cells.count; i++) {
        const uint32_t cell = body->view_cells.data[i];
        sum += gxp_mix(name[cell]);
        for (k = 0; k < 4; k++) copies[body->cells[cell].copies[k]] += gxp_mix(name[cell] + k);
    }
    for (i = 0; i < body->copy_count; i++) sum += gxp_mix(copies[i] ^ gxp_mix(body->copy_node[i]));
    return sum;
}

GXFEM_API uint64_t gx_body_topology_hash(gx_body *body, gx_result *result) {
    gx_result r;
    uint64_t *names, hash = 0;
    size_t words;
    if (body == NULL) { if (result != NULL) *result = GX_ERROR_ARGUMENT; return 0; }
    words = 2 * (size_t)body->cell_count + body->copy_count;
    r = gxp_update_view(body);
    names = (uint64_t *)gxp_allocate(&body->allocator, words * sizeof *names);
    if (r == GX_OK && names == NULL) r = GX_ERROR_MEMORY;
    if (r == GX_OK) {
        memset(names, 0, words * sizeof *names);
        r = gxp_name_cells(body, names, names + body->cell_count);
        if (r == GX_OK) hash = gxp_hash_names(body, names, names + 2 * (size_t)body->cell_count);
    }
    gxp_release(&body->allocator, names, words * sizeof *names);
    if (result != NULL) *result = r;
    return r == GX_OK ? hash : 0;
}

static uint64_t gxp_hash_doubles(uint64_t hash, const double *x, size_t count) {
    for (; count > 0; count--, x++) {
        uint64_t b;
        memcpy(&b, x, sizeof b);
        hash = gxp_mix(hash ^ b);
    }
    return hash;
}

GXFEM_API uint64_t gx_body_state_hash(const gx_body *body) {
    uint64_t hash = gxp_mix(body->cell_count);
    uint32_t i, k;
    for (i = 0; i < body->cell_count; i++) {
        const gxp_cell *c = &body->cells[i];
        hash = gxp_mix(hash ^ c->element ^ (uint64_t)c->kept << 32);
        for (k = 0; k < 4 && c->kept; k++) hash = gxp_mix(hash ^ c->copies[k]);
        if (c->kept) hash = gxp_hash_doubles(gxp_hash_doubles(hash, &c->volume, 1), c->mass, 10);
    }
    for (i = 0; i < body->complex->leaf_count; i++)
        hash = gxp_mix(hash ^ body->leaves[i].cell ^ (uint64_t)body->complex->leaves[i].removed << 32);
    hash = gxp_mix(hash ^ body->copy_count);
    for (i = 0; i < body->copy_count; i++) hash = gxp_mix(hash ^ body->copy_node[i]);
    hash = gxp_hash_doubles(hash, body->displacement, 3 * (size_t)body->copy_count);
    hash = gxp_hash_doubles(hash, body->velocity, 3 * (size_t)body->copy_count);
    hash = gxp_hash_doubles(hash, body->rest_time, body->copy_count);
    for (i = 0; i < 2 && body->previous_dt > 0; i++) hash = gxp_hash_doubles(hash, body->history[i], 3 * (size_t)body->copy_count);
    for (i = 0; i < body->region_count; i++)
        hash = gxp_hash_doubles(gxp_mix(hash ^ body->regions[i].axis ^ (uint64_t)(body->regions[i].side + 1) << 8), &body->regions[i].value, 1);
    return hash;
}

GXFEM_API const char *gx_result_text(gx_result result) {
    switch (result) {
    case GX_OK: return "no error";
    case GX_ERROR_ARGUMENT: return "a required argument is missing or senseless";
    case GX_ERROR_MEMORY: return "out of memory";
    case GX_ERROR_NOT_FINITE: return "a number is not finite";
    case GX_ERROR_RANGE: return "a coordinate is too large or too small beside the others";
    case GX_ERROR_INDEX: return "an index is out of range";
    case GX_ERROR_EMPTY: return "empty: no elements, nodes or triangles";
    case GX_ERROR_INVERTED: return "an element is inverted (negative volume)";
    case GX_ERROR_FLAT: return "an element is flat (no volume)";
    case GX_ERROR_OVERLAP: return "elements overlap: a face is shared by more than two elements, or by two on one side";
    case GX_ERROR_NOT_CLOSED: return "a solid's surface is not closed or not consistently oriented";
    case GX_ERROR_LIMIT: return "too many objects";
    case GX_ERROR_DIVERGED: return "the time step diverged";
    case GX_ERROR_FREE: return "a piece is held by nothing";
    }
    return "unknown result";
}

#ifdef __cplusplus
}
#endif
#endif /* GXFEM_IMPLEMENTED */
